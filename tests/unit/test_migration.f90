!> Particles keep their identity and their values as they are stored, moved, sorted and exchanged.
! ranks: 1 2 3
program test_migration
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, sum_all, max_all
   use xmpm_deck, only: deck_t
   use xmpm_lattice, only: bin_of, block_of, local_bin, bin_corner, bins_per_block
   use xmpm_blocks, only: local_block
   use xmpm_storage, only: particles_t, record_t, lanes, count_particles, append_particle, &
      remove_lane, move_lane, read_record, take_records, bin_of_chunk, n_near, near_crack, c_x, c_v
   use xmpm_resort, only: resort_chunks
   use xmpm_migration, only: rebin, exchange
   use xmpm_layout, only: admit_blocks, count_unknown, other_ranks, repartition
   use xmpm_model, only: model_t
   use small_model, only: make_model
   use testing, only: suite_t, check, check_no_error, finish
   implicit none
   character(len=*), parameter :: text = '*JOB m|*UNITS length=mm mass=g time=ms|*TIME end=1|' &
      //'*GRID size=1|*MATERIAL alloy density=2 young=100 poisson=0.25|' &
      //'*BODY a material=alloy box=0 0 0 9 6 5 particles=2|' &
      //'*BODY b material=alloy box=9 0 0 12 6 5 particles=2|' &
      //'*CRACK c rectangle centre=4 3 2.6 along=1 0 0 across=0 1 0 width=4 depth=20|'
   type(comm_t) :: comm
   type(suite_t) :: suite

   call start_parallel(comm)
   suite%name = 'migration'
   call test_storage(suite)
   call test_resort(suite)
   call test_exchange(suite)
   call test_repartition(suite)
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> Every particle's velocity, stress and H slot say who it is.
   subroutine make(m)
      type(model_t), intent(out) :: m
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      integer :: c, k

      call make_model(comm, text, deck, m, error)
      call check_no_error(suite, 'the deck is set up', error)
      if (allocated(error)) error stop 'no model'
      associate (p => m%particles)
         do c = 1, p%n_chunks
            do k = 1, p%count(c)
               p%q(k, c_v:, c) = mark(p%id(k, c))
               p%sets(k, c) = 2*p%id(k, c)
               p%any_set(c) = ior(p%any_set(c), p%sets(k, c))
               if (p%attached(c) == 0) cycle
               if (nint(p%near(k, near_crack, p%attached(c))) == 1) then
                  p%near(k, 2:n_near, p%attached(c)) = mark(p%id(k, c))
               end if
            end do
         end do
      end associate
   end subroutine make

   elemental function mark(id) result(value)
      integer(i8), intent(in) :: id
      real(wp) :: value

      value = 1000 + real(id, wp)
   end function mark

   !> Number, sum of ids and of their squares of all ranks, and of the particles with a slot.
   subroutine census(m, sums)
      type(model_t), intent(in) :: m
      integer(i8), intent(out) :: sums(4)
      integer :: c, k

      sums = 0
      associate (p => m%particles)
         do c = 1, p%n_chunks
            do k = 1, p%count(c)
               sums(1:3) = sums(1:3) + [1_i8, p%id(k, c), p%id(k, c)**2]
               if (p%attached(c) == 0) cycle
               if (nint(p%near(k, near_crack, p%attached(c))) == 1) sums(4) = sums(4) + p%id(k, c)
            end do
         end do
      end associate
      call sum_all(comm, sums)
   end subroutine census

   !> Everything that must hold of the storage at any time.
   subroutine check_storage(m, sentence, expected)
      type(model_t), intent(in) :: m
      character(len=*), intent(in) :: sentence
      integer(i8), intent(in) :: expected(4)
      integer(i8) :: sums(4)

      call census(m, sums)
      call check(suite, sentence//': all particles are there once', all(sums(:3) == expected(:3)))
      call check(suite, sentence//': all crack slots are there once', sums(4) == expected(4))
      call check(suite, sentence//': values stay with their particle', values_hold(m))
      call check(suite, sentence//': every chunk is in its bin''s chain once', chains_hold(m))
      call check(suite, sentence//': empty lanes are empty', blanks_hold(m))
      call check(suite, sentence//': a bin has no more chunks than it needs', few_chunks(m))
   end subroutine check_storage

   pure function values_hold(m) result(hold)
      type(model_t), intent(in) :: m
      logical :: hold
      integer :: c, k

      hold = .true.
      associate (p => m%particles)
         do c = 1, p%n_chunks
            do k = 1, p%count(c)
               hold = hold .and. all(abs(p%q(k, c_v:, c) - mark(p%id(k, c))) <= 0) &
                  .and. p%sets(k, c) == 2*p%id(k, c) .and. iand(p%any_set(c), p%sets(k, &
                  c)) == p%sets(k, c)
               hold = hold .and. all(bin_of_chunk(p, m%grid%blocks, c) &
                  == bin_of(m%grid%lattice, p%q(k, c_x:c_x + 2, c)))
               ! The second body lies beyond x = 9 at the start.
               hold = hold .and. (p%body(c) == 2 .eqv. p%x0(k, 1, c) > 9)
               if (p%attached(c) == 0) cycle
               if (nint(p%near(k, near_crack, p%attached(c))) == 1) hold = hold .and. &
                  all(abs(p%near(k, 2:n_near, p%attached(c)) - mark(p%id(k, c))) <= 0)
            end do
         end do
      end associate
   end function values_hold

   pure function chains_hold(m) result(hold)
      type(model_t), intent(in) :: m
      logical :: hold
      integer :: seen(m%particles%n_chunks), b, k, c

      hold = size(m%particles%head, 2) == m%grid%blocks%n
      seen = 0
      associate (p => m%particles)
         do b = 1, size(p%head, 2)
            do k = 1, bins_per_block
               c = p%head(k, b)
               do while (c > 0)
                  seen(c) = seen(c) + 1
                  hold = hold .and. p%bin(c) == bins_per_block*(b - 1) + k .and. p%count(c) > 0
                  c = p%next(c)
               end do
            end do
         end do
         c = p%free
         do while (c > 0)
            seen(c) = seen(c) + 1
            hold = hold .and. p%count(c) == 0
            c = p%next(c)
         end do
      end associate
      hold = hold .and. all(seen == 1)
   end function chains_hold

   !> Whether of all chunks of a bin and body at most one has a free lane.
   pure function few_chunks(m) result(hold)
      type(model_t), intent(in) :: m
      logical :: hold
      integer :: open_chunks(size(m%particles%head), 2), c

      open_chunks = 0
      associate (p => m%particles)
         do c = 1, p%n_chunks
            if (p%count(c) == 0 .or. p%count(c) == lanes) cycle
            open_chunks(p%bin(c), p%body(c)) = open_chunks(p%bin(c), p%body(c)) + 1
         end do
      end associate
      hold = all(open_chunks <= 1)
   end function few_chunks

   pure function blanks_hold(m) result(hold)
      type(model_t), intent(in) :: m
      logical :: hold
      integer :: c, k, i

      hold = .true.
      associate (p => m%particles)
         do c = 1, p%n_chunks
            if (p%count(c) == 0) cycle
            do k = p%count(c) + 1, lanes
               hold = hold .and. all(abs(p%q(k, c_v:, c)) <= 0) .and. p%id(k, c) == 0 &
                  .and. all([(abs(p%q(k, i, c) - 0.5_wp - real(floor(p%q(k, i, c)), wp)) <= 0, &
                  i=1, 3)])
               if (p%attached(c) > 0) hold = hold .and. all(abs(p%near(k, :, p%attached(c))) <= 0)
            end do
         end do
      end associate
   end function blanks_hold

   !> Take every third particle out, put it back; move others to a bin beside theirs and back.
   subroutine test_storage(suite)
      type(suite_t), intent(inout) :: suite
      type(model_t) :: m
      type(record_t), allocatable :: out(:)
      integer(i8) :: sums(4), left(4)
      integer :: c, n, b, bin(3)

      call make(m)
      call census(m, sums)
      call check_storage(m, 'at the start', sums)
      associate (p => m%particles, blocks => m%grid%blocks)
         allocate (out(count_particles(p)))
         n = 0
         do c = p%n_chunks, 1, -3
            do while (p%count(c) > mod(c, 2)*4)
               n = n + 1
               call read_record(p, 1, c, out(n))
               call remove_lane(p, m%grid%lattice, blocks, 1, c)
            end do
         end do
         call census(m, left)
         call check_storage(m, 'with some taken out', left)
         do c = 1, n
            bin = bin_of(m%grid%lattice, out(c)%hot(c_x:c_x + 2))
            b = local_block(blocks, block_of(bin))
            call append_particle(p, m%grid%lattice, blocks, &
               bins_per_block*(b - 1) + local_bin(bin), &
               out(c))
         end do
         call check_storage(m, 'with all put back', sums)
         call take_records(p, out)
         call check(suite, 'the records are all particles', size(out) == count_particles(p) &
            .and. all(abs([(out(c)%hot(c_v), c=1, size(out))] - mark(out%id)) <= 0))
      end associate
   end subroutine test_storage

   !> Shake all particles to random places of the body; the bins follow, and sorting keeps all.
   subroutine test_resort(suite)
      type(suite_t), intent(inout) :: suite
      type(model_t) :: m
      integer(i8) :: sums(4)
      integer :: c, round, lost
      logical :: near_moved, ordered

      call make(m)
      call census(m, sums)
      do round = 1, 3
         call shake(m, [0.0_wp, 0.0_wp, 0.0_wp], [12.0_wp, 6.0_wp, 5.0_wp])
         near_moved = .false.
         call rebin(m%particles, m%grid, [(c, c=1, m%particles%n_chunks)], m%outbox, near_moved)
         call exchange(m%particles, m%grid, comm, other_ranks(m), m%outbox, lost)
         call check(suite, 'nobody is lost inside the blocks', lost == 0)
         call check_storage(m, 'shaken', sums)
         call resort_chunks(m%particles)
         call check_storage(m, 'sorted', sums)
         ordered = all(m%particles%bin(2:m%particles%n_chunks) &
            >= m%particles%bin(:m%particles%n_chunks - 1))
         call check(suite, 'sorted chunks stand in the order of the bins', ordered)
      end do
   end subroutine test_resort

   !> Put every particle at a random place of a box.
   subroutine shake(m, low, high)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: low(3), high(3)
      real(wp) :: u(3)
      integer :: c, k

      do c = 1, m%particles%n_chunks
         do k = 1, m%particles%count(c)
            call random_number(u)
            m%particles%q(k, c_x:c_x + 2, c) = low + (high - low)*u
         end do
      end do
   end subroutine shake

   !> Particles fly to where no block is yet: blocks are made, and all arrive, whoever owns them.
   subroutine test_exchange(suite)
      type(suite_t), intent(inout) :: suite
      type(model_t) :: m
      integer(i8) :: sums(4)
      integer :: c, lost, unknown(1)
      logical :: near_moved
      real(wp) :: worst

      call make(m)
      call census(m, sums)
      call shake(m, [-30.0_wp, -7.0_wp, 0.0_wp], [12.0_wp, 20.0_wp, 5.0_wp])
      near_moved = .false.
      call rebin(m%particles, m%grid, [(c, c=1, m%particles%n_chunks)], m%outbox, near_moved)
      unknown(1) = count_unknown(m)
      worst = real(unknown(1), wp)
      call max_all(comm, worst)
      call check(suite, 'some particles are where no block is', worst > 0)
      call check(suite, 'particles near the crack were seen to move', near_moved .or. comm%size > 1)
      call admit_blocks(m)
      call check(suite, 'afterwards every place has its block', count_unknown(m) == 0)
      call exchange(m%particles, m%grid, comm, other_ranks(m), m%outbox, lost)
      call check(suite, 'nobody is lost on the way', lost == 0)
      call check_storage(m, 'after the flight', sums)
   end subroutine test_exchange

   !> All particles gather in one corner; the work is divided anew and nobody is lost.
   subroutine test_repartition(suite)
      type(suite_t), intent(inout) :: suite
      type(model_t) :: m
      type(error_t), allocatable :: error
      integer(i8) :: sums(4)
      integer :: c, lost
      logical :: near_moved
      real(wp) :: most

      call make(m)
      call census(m, sums)
      call shake(m, [-20.0_wp, -20.0_wp, 0.0_wp], [12.0_wp, 20.0_wp, 5.0_wp])
      near_moved = .false.
      call rebin(m%particles, m%grid, [(c, c=1, m%particles%n_chunks)], m%outbox, near_moved)
      call admit_blocks(m)
      call exchange(m%particles, m%grid, comm, other_ranks(m), m%outbox, lost)
      call repartition(m, error)
      call check_no_error(suite, 'the work is divided anew', error)
      call check_storage(m, 'divided anew', sums)
      most = real(count_particles(m%particles), wp)
      call max_all(comm, most)
      ! METIS is allowed 1 % and some dozen blocks of a few per cent cannot be divided.
      call check(suite, 'the work is in balance', &
         most*real(comm%size, wp) < 1.2_wp*real(sums(1), wp))
   end subroutine test_repartition
end program test_migration
