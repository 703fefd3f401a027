!> Averages over the neighbours of front nodes: what is linear stays, what alternates goes.
program test_front_average
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_surface, only: surface_t
   use xmpm_front, only: front_t
   use xmpm_front_average, only: average_along
   use growing_surface, only: tube_t, make_cut
   use testing, only: suite_t, check, check_close, check_no_error, finish
   implicit none
   real(wp), parameter :: rounding = 1e-12_wp   !! of sums of a few numbers up to ten
   type(suite_t) :: suite

   suite%name = 'front_average'
   call open_front()
   call closed_front()
   call slab_of_one_cell()
   call finish(suite)

contains

   !> A straight front of segments of one, from wall to wall.
   subroutine straight(y, front)
      real(wp), intent(in) :: y(2)
      type(front_t), intent(out) :: front
      type(surface_t) :: surface
      type(error_t), allocatable :: error

      call make_cut([8.0_wp, 10.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp], tube_t(outer=5.0_wp, y=y), surface, front, error)
      call check_no_error(suite, 'the cut is a surface', error)
   end subroutine straight

   subroutine open_front()
      type(front_t) :: front
      real(wp), allocatable :: v(:, :), a(:, :)
      logical, allocatable :: known(:)
      integer :: i, n

      call straight([-3.6_wp, 3.6_wp], front)
      n = front%chain_offset(2) - 1
      call check(suite, 'the front is open and long enough to tell', &
         .not. front%closed(1) .and. n > 6)
      allocate (known(front%node_count), source=.true.)
      v = front%x
      a = average_along(front, known, v)
      call check_close(suite, 'what is linear along the front stays', &
         maxval(abs(a(:, 2:n - 1) - v(:, 2:n - 1))), 0.0_wp, rounding, 0.0_wp)
      v = reshape([((-1.0_wp)**i, i=1, front%node_count)], [1, front%node_count])
      a = average_along(front, known, v)
      call check_close(suite, 'what alternates from node to node goes, at the ends too', &
         maxval(abs(a(1, :n))), 0.0_wp, rounding, 0.0_wp)
      known(3) = .false.
      v = reshape([(real(i*i, wp), i=1, front%node_count)], [1, front%node_count])
      a = average_along(front, known, v)
      call check_close(suite, 'an unknown node keeps what it has', a(1, 3), 9.0_wp, rounding, &
         0.0_wp)
      call check_close(suite, 'the node before it has one neighbour', a(1, 2), 2.5_wp, rounding, &
         0.0_wp)
      call check_close(suite, 'the node behind it has the other one', a(1, 4), 20.5_wp, rounding, &
         0.0_wp)
   end subroutine open_front

   subroutine closed_front()
      type(front_t) :: front
      type(surface_t) :: surface
      type(error_t), allocatable :: error
      real(wp), allocatable :: v(:, :), a(:, :)
      logical, allocatable :: known(:)
      integer :: i

      call make_cut([8.0_wp, 10.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp], tube_t(), surface, front, error)
      call check_no_error(suite, 'the cut is a surface', error)
      allocate (known(front%node_count), source=.true.)
      v = reshape([((-1.0_wp)**i, i=1, front%node_count)], [1, front%node_count])
      a = average_along(front, known, v)
      call check(suite, 'the front is closed', front%closed(1))
      call check_close(suite, 'around a closed front every node has two neighbours', &
         maxval(abs(a)), 0.0_wp, rounding, 0.0_wp)
   end subroutine closed_front

   !> Both nodes of a front across one cell get the same value: it cannot tilt.
   subroutine slab_of_one_cell()
      type(front_t) :: front
      real(wp), allocatable :: v(:, :), a(:, :)
      logical, allocatable :: known(:)

      call straight([-0.9_wp, 0.9_wp], front)
      allocate (known(front%node_count), source=.false.)
      known(1:2) = .true.
      allocate (v(1, front%node_count), source=7.0_wp)
      v(1, 1:2) = [3.0_wp, 5.0_wp]
      a = average_along(front, known, v)
      call check_close(suite, 'the first node has the mean', a(1, 1), 4.0_wp, rounding, 0.0_wp)
      call check_close(suite, 'and so has the second', a(1, 2), 4.0_wp, rounding, 0.0_wp)
   end subroutine slab_of_one_cell
end program test_front_average
