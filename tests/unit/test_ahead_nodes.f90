!> GIMP at a crack's front at any angle: particles a few thousandths of a cell off their lattice
!> reach nodes with next to no weight, and these do not split the nodes ahead of the front.
! ranks: 1 2 3
program test_ahead_nodes
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, sum_all
   use xmpm_halo, only: start_sum, finish_sum
   use xmpm_deck, only: deck_t
   use xmpm_lattice, only: bin_corner, stencil_offsets
   use xmpm_storage, only: c_x, bin_of_chunk, n_near, near_crack, near_jump
   use xmpm_loads, only: rows_of_bin
   use xmpm_gimp_kernels, only: weights_gimp
   use xmpm_settle, only: renew_splits
   use xmpm_model, only: model_t
   use small_model, only: make_model, disturb
   use testing, only: suite_t, check, check_close, check_no_error, finish
   implicit none
   real(wp), parameter :: shift = 3e-3_wp   !! of particles off their lattice, at most [cells]
   !> A weight of corners alone: shift**2/(4 l) with l = 1/4, in one direction, for a dozen
   !> particles. The least weight at quarter points is (1/4)**3 = 0.016.
   real(wp), parameter :: corners = 12*shift**2
   type(comm_t) :: comm
   type(suite_t) :: suite
   type(model_t) :: m
   type(deck_t) :: deck
   type(error_t), allocatable :: error
   real(wp), allocatable :: reached(:, :)
   logical, allocatable :: split(:)
   real(wp) :: before, after

   call start_parallel(comm)
   suite%name = 'ahead nodes'
   call make_model(comm, '*JOB ahead|*UNITS length=mm mass=g time=ms|*TIME end=1|' &
      //'*GRID size=1 shape=gimp|*MATERIAL alloy density=8 young=100 poisson=0.25|' &
      //'*BODY a material=alloy box=-6 -6 -6 6 6 6|*CRACK c disc centre=0.13 0.27 0.41 ' &
      //'along=1 -1 0 across=1 1 -2 radius=3|', deck, m, error)
   call check_no_error(suite, 'the deck is set up', error)
   call find_split(m, split)
   before = number_of(split)
   call disturb(m, shift)
   call renew_splits(m, error)
   call check_no_error(suite, 'nodes are split again', error)
   call find_split(m, split)
   call find_reached(m, reached)
   after = number_of(split .and. reached(3, :) > 0.1_wp)
   call check(suite, 'nodes ahead of the front and beside the ramp are split', after > 50)
   call check(suite, 'some nodes there are reached by corners alone', &
      number_of(corner_alone(1) .or. corner_alone(2)) > 10)
   call check_close(suite, 'none of these is split', &
      number_of(split .and. (corner_alone(1) .or. corner_alone(2))), 0.0_wp, 0.0_wp, 0.0_wp)
   call check_close(suite, 'all others that both sides reach are split', &
      number_of(.not. split .and. minval(reached(:2, :), dim=1) > 0.015_wp), 0.0_wp, 0.0_wp, 0.0_wp)
   call check_close(suite, 'as many nodes are split as with the particles on the lattice', &
      number_of(split), before, 0.0_wp, 0.0_wp)
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> Nodes that fading particles reach well and those of one side with corners only.
   function corner_alone(side) result(is)
      integer, intent(in) :: side
      logical :: is(size(split))

      is = reached(3, :) > 0.1_wp .and. reached(side, :) > 0 .and. reached(side, :) < corners
   end function corner_alone

   !> Which ordinary rows belong to split nodes.
   subroutine find_split(m, split)
      type(model_t), intent(in) :: m
      logical, allocatable, intent(out) :: split(:)

      allocate (split(m%grid%n_plain), source=.false.)
      split(m%grid%parent) = .true.
   end subroutine find_split

   !> Number of nodes of all ranks, each once.
   function number_of(chosen) result(n)
      logical, intent(in) :: chosen(:)
      real(wp) :: n, total(1)

      total(1) = real(count(chosen .and. m%grid%mine(:size(chosen))), wp)
      call sum_all(m%comm, total)
      n = total(1)
   end function number_of

   !> Weights at the nodes of the particles with H > 0 (1), H < 0 (2), |H| < 1 (3).
   subroutine find_reached(m, reached)
      type(model_t), intent(inout) :: m
      real(wp), allocatable, intent(out) :: reached(:, :)
      real(wp) :: t(3), w(27), h
      integer :: c, k, rows(27)

      allocate (reached(3, m%grid%n_rows), source=0.0_wp)
      do c = 1, m%particles%n_chunks
         if (m%particles%count(c) == 0) cycle
         rows = rows_of_bin(m%grid, m%particles%bin(c), stencil_offsets(m%grid%lattice))
         do k = 1, m%particles%count(c)
            t = m%particles%q(k, c_x:c_x + 2, c) - bin_corner(m%grid%lattice, &
               bin_of_chunk(m%particles, m%grid%blocks, c)) - 0.5_wp
            w = weights_gimp(t, m%bodies%half(1))
            h = 0
            if (m%particles%attached(c) > 0) then
               associate (near => m%particles%near(k, :n_near, m%particles%attached(c)))
                  if (nint(near(near_crack)) == 1) h = near(near_jump)
               end associate
            end if
            if (h > 0) reached(1, rows) = reached(1, rows) + w
            if (h < 0) reached(2, rows) = reached(2, rows) + w
            if (abs(h) < 1) reached(3, rows) = reached(3, rows) + w
         end do
      end do
      call start_sum(m%halo, m%comm, reached, 1, 3)
      call finish_sum(m%halo, reached, 1, 3)
      reached = reached(:, :m%grid%n_plain)
   end subroutine find_reached
end program test_ahead_nodes
