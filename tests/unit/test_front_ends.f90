!> Ends of fronts in bodies whose surfaces are normal to the front or slanted to it.
program test_front_ends
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel
   use xmpm_surface, only: build_surface
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_rectangle
   use xmpm_front, only: front_test_points, mark_front
   use xmpm_crack, only: crack_t
   use xmpm_samples, only: sample_t, place_sample
   use xmpm_front_points, only: front_points_t, list_points
   use xmpm_front_ends, only: find_ends
   use testing, only: suite_t, check, check_close, finish
   implicit none
   type(suite_t) :: suite
   type(comm_t) :: comm
   real(wp), parameter :: half = 5.0_wp   ! of the length of the front's line

   suite%name = 'front_ends'
   call start_parallel(comm)
   call normal_walls()
   call slanted_walls(0.4_wp)
   call slanted_walls(1.0_wp)
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> A front along y from -5 to 5 at x = 0; the wall at y = 4 - x tan(slant) and its twin at -4.
   subroutine ends_of(slant, points)
      real(wp), intent(in) :: slant   !! [rad]
      type(front_points_t), intent(out) :: points
      type(crack_t) :: crack
      type(crack_plane_t) :: plane
      type(error_t), allocatable :: error
      type(sample_t), allocatable :: samples(:)
      real(wp), allocatable :: x(:, :), test(:, :)
      integer, allocatable :: tri(:, :)

      call set_plane([-4.0_wp, 0.0_wp, 0.13_wp], [1.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 1.0_wp, &
         0.0_wp], plane, error)
      call make_rectangle(plane, [8.0_wp, 2*half], 1.0_wp, x, tri, error)
      call build_surface(x, tri, crack%surface, error)
      call front_test_points(crack%surface, 1.0_wp, test)
      call mark_front(crack%surface, test(1, :) > 0, crack%front)
      call list_points(crack, points)
      call fill(crack, slant, samples)
      call find_ends(crack%front, comm, 1.0_wp, samples, points)
   end subroutine ends_of

   !> Eight particles in a cell, between the walls.
   subroutine fill(crack, slant, samples)
      type(crack_t), intent(in) :: crack
      real(wp), intent(in) :: slant
      type(sample_t), allocatable, intent(out) :: samples(:)
      type(sample_t) :: s
      integer :: i, j, k, n
      logical :: inside

      allocate (samples(33*33*33))
      n = 0
      do k = -16, 16
         do j = -16, 16
            do i = -16, 16
               s%x = 0.25_wp + 0.5_wp*real([i, j, k], wp)
               if (abs(s%x(2) + s%x(1)*tan(slant)) > 4.0_wp) cycle
               s%volume = 0.125_wp
               s%side = sign(1.0_wp, s%x(3) - 0.13_wp)
               call place_sample(crack%front, 4.0_wp, s, inside)
               if (.not. inside) cycle
               n = n + 1
               samples(n) = s
            end do
         end do
      end do
      samples = samples(:n)
   end subroutine fill

   !> Nothing changes where the front is normal to the surface: q lies in the plane of its frame.
   subroutine normal_walls()
      type(front_points_t) :: points

      call ends_of(0.0_wp, points)
      call check_close(suite, 'the material ends a cell before the front', &
         maxval(abs(points%beyond + 1)), 0.0_wp, 1.0e-12_wp, 0.0_wp)
      call check_close(suite, 'the ends are put to the walls', maxval(points%x(2, :)) &
         - minval(points%x(2, :)), 8.0_wp, 1.0e-12_wp, 0.0_wp)
      call check_close(suite, 'across a wall q does not lean', &
         maxval(abs(points%outward(1:2, :))), 0.0_wp, 1.0e-12_wp, 0.0_wp)
   end subroutine normal_walls

   !> The wall's own normal counts, and the end is where the front itself meets it.
   subroutine slanted_walls(slant)
      real(wp), intent(in) :: slant
      type(front_points_t) :: points
      real(wp) :: way(2)
      integer :: i

      call ends_of(slant, points)
      do i = 1, points%n
         ! in the frame of the points x is e1, and e3 runs along +y or -y
         way(1) = atan2(points%outward(1, i), abs(points%outward(3, i)))
         ! a lattice cut at a slant is a staircase; 0.4 and 0.9 degrees recorded
         call check_close(suite, 'a slanted wall has its own normal', abs(way(1)), slant, &
            2.0_wp*pi/180, 0.0_wp)
      end do
      ! half a spacing is added to the outermost particle's place, which may lie on the wall
      call check_close(suite, 'the front ends where it meets the wall', &
         maxval(abs(points%beyond + 1)), 0.0_wp, 0.25_wp/cos(slant), 0.0_wp)
      i = count(points%outward(1, :) > 0)
      call check(suite, 'the walls lean to opposite sides', i > 1 .and. i < points%n - 1)
   end subroutine slanted_walls
end program test_front_ends
