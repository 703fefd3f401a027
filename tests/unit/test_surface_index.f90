!> The spatial index against the plain search through all triangles.
program test_surface_index
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_surface, only: surface_t, build_surface, refresh_geometry
   use xmpm_crack_shapes, only: crack_plane_t, make_disc, make_rectangle
   use xmpm_surface_index, only: surface_index_t, nearest_t, build_index, refresh_index, &
      nearest_on_surface, &
      nearest_in_triangle, on_face, on_edge, on_vertex
   use testing, only: suite_t, check, check_close, finish
   implicit none
   type(suite_t) :: suite
   type(surface_t) :: surface
   type(surface_index_t) :: index
   type(error_t), allocatable :: error
   real(wp), allocatable :: x(:, :)
   integer, allocatable :: tri(:, :)
   integer :: v

   suite%name = 'surface_index'
   call named_features()
   call make_disc(crack_plane_t(), 1.0_wp, 0.1_wp, x, tri, error)
   do v = 1, size(x, 2)
      x(3, v) = 0.3_wp*sin(3.0_wp*x(1, v)) + 0.2_wp*abs(x(2, v))   ! curved, with a fold
   end do
   call build_surface(x, tri, surface, error)
   call build_index(surface, index)
   call compare('a folded disc')
   surface%up(1, :) = 0.3_wp*surface%x(2, :)**2
   surface%um(3, :) = -0.8_wp*surface%x(1, :)
   call refresh_geometry(surface)
   call refresh_index(surface, index)
   call compare('a disc that has moved')
   call finish(suite)

contains

   !> Random points: distance, triangle and point are those of the plain search.
   subroutine compare(name)
      character(len=*), intent(in) :: name
      integer, parameter :: n = 2000
      real(wp) :: p(3), best, q(3), d2, worst, reach
      type(nearest_t) :: nearest, hinted
      integer :: i, t, region, previous
      logical :: same, missed

      same = .true.
      missed = .false.
      worst = 0.0_wp
      reach = 0.5_wp
      previous = 0
      do i = 1, n
         p = 3.0_wp*[halton(i, 2), halton(i, 3), halton(i, 5)] - 1.5_wp
         best = reach**2
         do t = 1, surface%triangle_count
            call nearest_in_triangle(surface%x(:, surface%tri(:, t)), p, q, region)
            d2 = sum((p - q)**2)
            best = min(best, d2)
         end do
         call nearest_on_surface(index, surface, p, reach, nearest)
         call nearest_on_surface(index, surface, p, reach, hinted, previous)
         same = same .and. hinted%triangle == nearest%triangle
         same = same .and. all(abs(hinted%point - nearest%point) <= 0.0_wp)
         missed = missed .or. (nearest%triangle == 0 .and. best < (1.0_wp - 1.0e-12_wp)*reach**2)
         if (nearest%triangle == 0) cycle
         previous = nearest%triangle
         worst = max(worst, abs(nearest%distance - sqrt(best)), abs(norm2(p - nearest%point) &
            - sqrt(best)))
      end do
      call check(suite, name//': nothing within reach is missed', .not. missed)
      call check(suite, name// &
         ': a hint changes nothing', same)
      ! the same operations on the same numbers: rounding only
      call check_close(suite, name//': the same distance as by the plain search', worst, 0.0_wp, &
         1.0e-15_wp, 0.0_wp)
   end subroutine compare

   !> Points above a face, an edge, a corner of one triangle.
   subroutine named_features()
      type(nearest_t) :: nearest

      call make_rectangle(crack_plane_t(), [1.0_wp, 1.0_wp], 1.0_wp, x, tri, error)
      call build_surface(x, tri, surface, error)
      call build_index(surface, index)
      call nearest_on_surface(index, surface, [0.2_wp, -0.1_wp, 0.3_wp], 1.0_wp, nearest)
      call check(suite, 'above a face the face answers', nearest%feature == on_face .and. &
         nearest%part == nearest%triangle)
      call check_close(suite, 'the distance to a face is the height', nearest%distance, 0.3_wp, &
         1.0e-15_wp, 0.0_wp)
      call nearest_on_surface(index, surface, [0.9_wp, 0.1_wp, 0.3_wp], 1.0_wp, nearest)
      call check(suite, 'beside an edge the edge answers', nearest%feature == on_edge)
      call check_close(suite, 'the distance to an edge is that to its line', nearest%distance, &
         0.5_wp, 1.0e-15_wp, 0.0_wp)
      call check(suite, 'the edge is one of its triangle', any(surface%triangle_edge(:, &
         nearest%triangle) == nearest%part))
      call nearest_on_surface(index, surface, [-0.8_wp, -0.9_wp, 0.0_wp], 1.0_wp, nearest)
      call check(suite, 'beyond a corner the vertex answers', nearest%feature == on_vertex .and. &
         nearest%part == 1)
      call check_close(suite, 'the distance to a corner is that of two points', nearest%distance, &
         0.5_wp, 1.0e-15_wp, 0.0_wp)
      call nearest_on_surface(index, surface, [0.0_wp, 0.0_wp, 1.1_wp], 1.0_wp, nearest)
      call check(suite, 'beyond the reach nothing answers', nearest%triangle == 0)
   end subroutine named_features

   !> Low-discrepancy points in (0, 1).
   pure function halton(i, base) result(value)
      integer, intent(in) :: i, base
      real(wp) :: value, part
      integer :: rest

      value = 0.0_wp
      part = 1.0_wp
      rest = i
      do while (rest > 0)
         part = part/real(base, wp)
         value = value + part*real(modulo(rest, base), wp)
         rest = rest/base
      end do
   end function halton
end program test_surface_index
