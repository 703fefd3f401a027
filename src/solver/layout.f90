!> Where things are: blocks and their owners, rows, halo; and how that changes as bodies move.
module xmpm_layout
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t
   use xmpm_sort, only: sort_order, unique_sorted
   use xmpm_hash_map, only: value_of
   use xmpm_communicator, only: gather_all, sum_all
   use xmpm_partition, only: partition_blocks
   use xmpm_halo, only: make_halo
   use xmpm_lattice, only: block_key, block_of, bin_of, bins_per_block
   use xmpm_blocks, only: build_blocks, owner_of
   use xmpm_grid, only: size_rows
   use xmpm_sharing, only: list_shared_rows, mark_mine
   use xmpm_boundary, only: find_rows
   use xmpm_storage, only: renumber_blocks, c_x
   use xmpm_migration, only: unload_block, insert_own, exchange
   use xmpm_model, only: model_t
   implicit none
   private

   public :: lay_out, admit_blocks, repartition, count_unknown, fresh_rows, other_ranks

contains

   !> Blocks, rows and halo from the blocks that each rank owns; particles keep their chunks.
   !> Collective.
   subroutine lay_out(m, my_keys)
      type(model_t), intent(inout) :: m
      integer(i8), intent(in) :: my_keys(:)   !! blocks of this rank
      integer(i8), allocatable :: pairs(:), all(:), keys(:)
      integer, allocatable :: owners(:), old_place(:, :), order(:)
      integer :: i

      allocate (pairs(2*size(my_keys)))
      do i = 1, size(my_keys)
         pairs(2*i - 1) = my_keys(i)
         pairs(2*i) = int(m%comm%rank, i8)
      end do
      call gather_all(m%comm, pairs, all)
      order = sort_order(all(1::2))
      keys = all(2*order - 1)
      owners = int(all(2*order))
      if (allocated(m%grid%blocks%place)) then
         old_place = m%grid%blocks%place
         call build_blocks(m%grid%blocks, m%grid%lattice, keys, owners, m%comm%rank)
         call renumber_blocks(m%particles, old_place, m%grid%blocks)
      else
         call build_blocks(m%grid%blocks, m%grid%lattice, keys, owners, m%comm%rank)
      end if
      call size_rows(m%grid, 0)
      call list_shared_rows(m%grid, m%comm%rank, m%comm%size, m%sharing)
      m%sided%n = 0
      m%split_again = size(m%cracks) > 0 .or. m%bodies_meet
      m%contact%n = 0
      if (.not. m%split_again) call fresh_rows(m)
   end subroutine lay_out

   !> Halo, counted rows and rows of the conditions, for the rows as they are without split nodes.
   subroutine fresh_rows(m)
      type(model_t), intent(inout) :: m
      integer :: i

      call make_halo(m%halo, m%comm%rank, m%sharing%ranks, m%sharing%first, m%sharing%rows, &
         m%grid%n_rows)
      call mark_mine(m%grid, m%sharing, m%comm%rank)
      do i = 1, size(m%boundaries)
         call find_rows(m%boundaries(i), m%grid)
      end do
   end subroutine fresh_rows

   !> Number of particles in the outbox that are in blocks nobody owns.
   pure function count_unknown(m) result(n)
      type(model_t), intent(in) :: m
      integer :: n, i

      n = 0
      do i = 1, m%outbox%n
         if (owner_of(m%grid%blocks, outbox_block(m, i)) < 0) n = n + 1
      end do
   end function count_unknown

   pure function outbox_block(m, i) result(place)
      type(model_t), intent(in) :: m
      integer, intent(in) :: i
      integer :: place(3)

      place = block_of(bin_of(m%grid%lattice, m%outbox%records(i)%hot(c_x:c_x + 2)))
   end function outbox_block

   !> Make blocks where particles went: each goes to the lowest rank that needs it; blocks without
   !> particles are given up when they are many. Collective.
   subroutine admit_blocks(m)
      type(model_t), intent(inout) :: m
      integer(i8), allocatable :: wanted(:), pairs(:), all(:), keys(:)
      integer(i8) :: first
      integer :: i, n

      allocate (wanted(m%outbox%n))
      n = 0
      do i = 1, m%outbox%n
         if (owner_of(m%grid%blocks, outbox_block(m, i)) >= 0) cycle
         n = n + 1
         wanted(n) = block_key(outbox_block(m, i))
      end do
      wanted = unique_sorted(wanted(:n))
      allocate (pairs(2*size(wanted)))
      do i = 1, size(wanted)
         pairs(2*i - 1) = wanted(i)
         pairs(2*i) = int(m%comm%rank, i8)
      end do
      call gather_all(m%comm, pairs, all)
      keys = kept_keys(m)
      do i = 1, size(wanted)
         first = minval(all(2::2), mask=all(1::2) == wanted(i))
         if (first == int(m%comm%rank, i8)) keys = [keys, wanted(i)]
      end do
      call lay_out(m, keys)
      call insert_own(m%particles, m%grid, m%comm%rank, m%outbox)
   end subroutine admit_blocks

   !> Keys of this rank's blocks; without the empty ones where these are more than a quarter of all,
   !> counted over all ranks, so that the blocks do not depend on the number of these. Collective.
   function kept_keys(m) result(keys)
      type(model_t), intent(in) :: m
      integer(i8), allocatable :: keys(:)
      logical, allocatable :: full(:)
      real(wp) :: counts(2)
      integer :: b

      allocate (keys(m%grid%blocks%n), full(m%grid%blocks%n))
      do b = 1, m%grid%blocks%n
         keys(b) = block_key(m%grid%blocks%place(:, b))
         full(b) = any(m%particles%head(:, b) > 0)
      end do
      counts = real([count(full), size(full)], wp)
      call sum_all(m%comm, counts)
      if (4*counts(1) < 3*counts(2) - 32) keys = pack(keys, full)
   end function kept_keys

   !> Divide the blocks among the ranks anew by the particles they hold, and move these.
   !> Collective.
   subroutine repartition(m, error)
      type(model_t), intent(inout) :: m
      type(error_t), allocatable, intent(out) :: error
      integer(i8), allocatable :: pairs(:), all(:), keys(:)
      integer, allocatable :: weights(:), parts(:), previous(:), order(:)
      integer :: b, i, lost

      allocate (pairs(2*m%grid%blocks%n))
      do b = 1, m%grid%blocks%n
         pairs(2*b - 1) = block_key(m%grid%blocks%place(:, b))
         pairs(2*b) = int(particles_of_block(m, b), i8)
      end do
      call gather_all(m%comm, pairs, all)
      order = sort_order(all(1::2))
      keys = all(2*order - 1)
      weights = int(all(2*order))
      allocate (previous(size(keys)))
      do i = 1, size(keys)
         previous(i) = value_of(m%grid%blocks%owner, keys(i), -1)
      end do
      call partition_blocks(keys, weights, m%comm%size, previous, parts, error)
      if (allocated(error)) return
      do i = 1, size(keys)
         b = value_of(m%grid%blocks%find, keys(i), 0)
         if (b > 0 .and. parts(i) /= m%comm%rank) then
            call unload_block(m%particles, m%grid, b, m%outbox)
         end if
      end do
      call lay_out(m, pack(keys, parts == m%comm%rank))
      call exchange(m%particles, m%grid, m%comm, other_ranks(m), m%outbox, lost)
   end subroutine repartition

   !> All ranks but this one.
   pure function other_ranks(m) result(ranks)
      type(model_t), intent(in) :: m
      integer, allocatable :: ranks(:)
      integer :: r

      ranks = pack([(r, r=0, m%comm%size - 1)], [(r /= m%comm%rank, r=0, m%comm%size - 1)])
   end function other_ranks

   pure function particles_of_block(m, b) result(n)
      type(model_t), intent(in) :: m
      integer, intent(in) :: b
      integer :: n, k, c

      n = 0
      do k = 1, bins_per_block
         c = m%particles%head(k, b)
         do while (c > 0)
            n = n + m%particles%count(c)
            c = m%particles%next(c)
         end do
      end do
   end function particles_of_block
end module xmpm_layout
