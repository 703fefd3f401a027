!> Fronts that run into the surface of their own crack, without any mechanics.
program test_own_surface
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_surface, only: surface_t, build_surface
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_rectangle
   use xmpm_front, only: front_t
   use xmpm_front_search, only: find_front
   use xmpm_own_surface, only: find_own_surface
   use growing_surface, only: tube_t
   use testing, only: suite_t, check, finish
   implicit none
   type(suite_t) :: suite
   type(surface_t) :: surface
   type(front_t) :: front
   type(tube_t) :: everywhere

   suite%name = 'own_surface'
   call wall_stops_a_front()
   call facing_fronts_meet()
   call kinked_crack_goes_on()
   call finish(suite)

contains

   !> A square of 10 by 10 in z = 0 with its front at x = 5, and another square of the same crack.
   subroutine make(centre, along, across)
      real(wp), intent(in) :: centre(3), along(3), across(3)
      type(crack_plane_t) :: plane
      type(error_t), allocatable :: error
      real(wp), allocatable :: a(:, :), b(:, :)
      integer, allocatable :: tri(:, :), more(:, :)

      call set_plane([0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 1.0_wp, 0.0_wp], &
         plane, error)
      call make_rectangle(plane, [10.0_wp, 10.0_wp], 1.0_wp, a, tri, error)
      call set_plane(centre, along, across, plane, error)
      call make_rectangle(plane, [10.0_wp, 10.0_wp], 1.0_wp, b, more, error)
      call build_surface(reshape([a, b], [3, size(a, 2) + size(b, 2)]), &
         reshape([tri, more + size(a, 2)], [3, size(tri, 2) + size(more, 2)]), surface, error)
      call find_front(surface, surface%edge(:, surface%boundary), 1.0_wp, everywhere, front)
   end subroutine make

   !> Which nodes of the front at x = 5, off its corners, meet the surface within a way along x.
   function met(way) result(meets)
      real(wp), intent(in) :: way
      logical :: meets(2)   !! any, all
      logical :: at(front%node_count), mine(front%node_count)
      real(wp) :: advance(3, front%node_count)
      integer :: i

      do i = 1, front%node_count
         mine(i) = abs(front%x(1, i) - 5) < 1e-9_wp .and. abs(front%x(3, i)) < 1e-9_wp &
            .and. abs(front%x(2, i)) < 4.5_wp
         advance(:, i) = merge(way, 0.0_wp, mine(i))*[1.0_wp, 0.0_wp, 0.0_wp]
      end do
      call find_own_surface(surface, front, advance, 1.0_wp, at)
      meets = [any(at), count(at) == count(mine)]
   end function met

   !> A wall three cells ahead that faces half of the front.
   subroutine wall_stops_a_front()
      real(wp), parameter :: y(3) = [0.0_wp, 1.0_wp, 0.0_wp], z(3) = [0.0_wp, 0.0_wp, 1.0_wp]

      call make([8.0_wp, 0.0_wp, 0.0_wp], y, z)
      call check(suite, 'a wall is far', .not. any(met(1.9_wp)))
      call check(suite, 'a wall within a cell stops all nodes', all(met(2.1_wp)))
      call make([8.0_wp, 6.0_wp, 0.0_wp], y, z)
      call check(suite, 'it stops the nodes before it', any(met(2.1_wp)))
      call check(suite, 'and no others', .not. all(met(2.1_wp)))
      call make([4.0_wp, 0.0_wp, 6.5_wp], y, z)
      call check(suite, 'a surface that is left behind stops none', .not. any(met(0.5_wp)))
   end subroutine wall_stops_a_front

   !> Fronts that come head-on in one plane are not stopped: they are to be joined.
   subroutine facing_fronts_meet()
      call make([11.5_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 1.0_wp, 0.0_wp])
      call check(suite, 'fronts that face each other are not stopped', .not. any(met(0.8_wp)))
   end subroutine facing_fronts_meet

   !> What is connected with the front nearby is its own surface, at whatever angle.
   subroutine kinked_crack_goes_on()
      integer :: v

      call make([0.0_wp, 0.0_wp, 90.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 1.0_wp, 0.0_wp])
      do v = 1, surface%vertex_count
         if (surface%x(3, v) > 1 .or. surface%x(1, v) > 3.5_wp) cycle
         surface%x(:, v) = [7 - surface%x(1, v), surface%x(2, v), 0.8_wp*(3.5_wp - surface%x(1, v))]
      end do
      call check(suite, 'a sharp kink behind the front does not stop it', .not. any(met(0.5_wp)))
   end subroutine kinked_crack_goes_on
end program test_own_surface
