!> Shapes of cracks: area, quality, normal, rim and messages.
program test_crack_shapes
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t
   use xmpm_vectors, only: unit_vector, cross, angle_between
   use xmpm_surface, only: surface_t, build_surface, surface_area
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_rectangle, make_polygon, &
      make_disc, make_ellipse, &
      make_sector
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   type(crack_plane_t) :: plane
   type(error_t), allocatable :: error

   suite%name = 'crack_shapes'
   call set_plane([1.0_wp, -2.0_wp, 0.5_wp], [2.0_wp, 1.0_wp, -0.5_wp], [-1.0_wp, 3.0_wp, &
      2.0_wp], plane, error)
   call check_no_error(suite, 'directions at right angles span a plane', error)
   call rectangles()
   call discs()
   call ellipses()
   call sectors()
   call polygons()
   call messages()
   call finish(suite)

contains

   !> Build the surface and check what holds for every shape.
   subroutine inspect(name, x, tri, area, slack, angle)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: x(:, :), area, slack, angle
      integer, intent(in) :: tri(:, :)
      type(surface_t) :: surface
      type(error_t), allocatable :: failure
      real(wp) :: normal(3)
      integer :: t

      call build_surface(x, tri, surface, failure)
      call check_no_error(suite, name//' is a sound surface', failure)
      if (allocated(failure)) return
      normal = cross(plane%along, plane%across)
      call check_close(suite, name//' has its area', surface_area(surface), area, 0.0_wp, slack)
      call check(suite, name//' has no angle under the limit', smallest_angle(surface) > angle)
      if (smallest_angle(surface) <= angle) print *, name, smallest_angle(surface)
      call check(suite, name//' has the normal along x across in each triangle', &
         all([(dot_product(surface%normal(:, t), normal) > 1.0_wp - 1.0e-12_wp, t=1, &
         surface%triangle_count)]))
      call check(suite, name//' has one boundary', size(surface%loop_offset) == 2)
      call check(suite, name//' has no hole (vertices - edges + triangles = 1)', &
         surface%vertex_count - surface%edge_count + surface%triangle_count == 1)
   end subroutine inspect

   !> Smallest angle of all triangles in degrees.
   pure function smallest_angle(surface) result(angle)
      type(surface_t), intent(in) :: surface
      real(wp) :: angle
      integer :: t, k

      angle = 180.0_wp
      do t = 1, surface%triangle_count
         do k = 0, 2
            associate (a => surface%x(:, surface%tri(k + 1, t)), b => surface%x(:, &
               surface%tri(modulo(k + 1, 3) + 1, t)), &
               c => surface%x(:, surface%tri(modulo(k + 2, 3) + 1, t)))
               angle = min(angle, angle_between(b - a, c - a)*180.0_wp/pi)
            end associate
         end do
      end do
   end function smallest_angle

   !> In-plane coordinates over the semi-axes of the boundary vertices: radius 1 on the rim.
   function rim_error(x, tri, semi_axes) result(worst)
      real(wp), intent(in) :: x(:, :), semi_axes(2)
      integer, intent(in) :: tri(:, :)
      real(wp) :: worst, d(3)
      type(surface_t) :: surface
      type(error_t), allocatable :: failure
      integer :: v

      call build_surface(x, tri, surface, failure)
      worst = 0.0_wp
      do v = 1, surface%vertex_count
         if (.not. surface%on_boundary(v)) cycle
         d = surface%x(:, v) - plane%centre
         worst = max(worst, abs(hypot(dot_product(d, plane%along)/semi_axes(1), &
            dot_product(d, plane%across)/semi_axes(2)) - 1.0_wp))
      end do
   end function rim_error

   subroutine rectangles()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      real(wp), parameter :: sizes(2, 4) = reshape([40.0_wp, 12.0_wp, 7.3_wp, 0.3_wp, 1.0_wp, &
         50.0_wp, 0.1_wp, 0.1_wp], [2, 4])
      integer :: k
      character(len=1) :: digit

      do k = 1, 4
         write (digit, '(i1)') k
         call make_rectangle(plane, sizes(:, k), 2.0_wp, x, tri, error)
         call check_no_error(suite, 'rectangle '//digit//' is made', error)
         ! planar pieces fill it without gap: rounding only
         call inspect('rectangle '//digit, x, tri, product(sizes(:, k)), 1.0e-12_wp, 20.0_wp)
      end do
   end subroutine rectangles

   subroutine discs()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      type(surface_t) :: surface
      real(wp) :: error_of(2)
      integer :: k

      do k = 1, 2
         call make_disc(plane, 3.0_wp, 3.0_wp/real(8*k, wp), x, tri, error)
         ! 48 chords in a circle leave out (2 pi/48)**2/6 = 0.29 % of its area
         call inspect('disc', x, tri, 9.0_wp*pi, 0.005_wp, 30.0_wp)
         call build_surface(x, tri, surface, error)
         error_of(k) = 9.0_wp*pi - surface_area(surface)
      end do
      ! halving the element quarters the error of the area; the next term of the series is 0.1 %
      ! of it
      call check_close(suite, 'the area of a disc converges with order two', &
         error_of(1)/error_of(2), 4.0_wp, 0.02_wp, 0.0_wp)
      ! rounding of a sine and a sum
      call check(suite, 'the rim of a disc lies on the circle', rim_error(x, tri, &
         [3.0_wp, 3.0_wp]) < 1.0e-14_wp)
   end subroutine discs

   subroutine ellipses()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      real(wp), parameter :: axes(2, 4) = reshape([2.0_wp, 1.0_wp, 1.0_wp, 3.0_wp, 1.0_wp, &
         1.0_wp, 4.0_wp, 1.0_wp], [2, 4])
      integer :: k

      do k = 1, 4
         call make_ellipse(plane, axes(:, k), 0.1_wp, x, tri, error)
         ! chords of 0.1 in the sharpest curve met (radius 1/4) leave out (0.4)**2/6 of a tenth of
         ! the rim's share: < 0.5 %
         call inspect('ellipse', x, tri, pi*product(axes(:, k)), 0.005_wp, 20.0_wp)
         call check(suite, 'the rim of an ellipse lies on the curve', rim_error(x, tri, &
            axes(:, k)) < 1.0e-14_wp)
      end do
   end subroutine ellipses

   subroutine sectors()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      real(wp), parameter :: spans(2, 7) = reshape([-90.0_wp, 270.0_wp, 0.0_wp, 180.0_wp, &
         -30.0_wp, 60.0_wp, 90.0_wp, 360.0_wp, &
         200.0_wp, 500.0_wp, -180.0_wp, 0.0_wp, 10.0_wp, 55.0_wp], [2, 7])
      integer :: k

      do k = 1, 7
         call make_sector(plane, [2.0_wp, 2.0_wp], spans(:, k), 0.2_wp, x, tri, error)
         call check_no_error(suite, 'a sector is made', error)
         ! chords of 0.2 in radius 2 leave out 0.1**2/6 = 0.17 %
         call inspect('sector of a disc', x, tri, 2.0_wp*(spans(2, k) - spans(1, k))*pi/180.0_wp, &
            0.002_wp, 20.0_wp)
      end do
      call make_sector(plane, [3.0_wp, 1.5_wp], [0.0_wp, 180.0_wp], 0.2_wp, x, tri, error)
      ! chords of 0.2 in a radius of curvature from 0.75 to 6: under 0.5 %
      call inspect('half an ellipse', x, tri, 0.5_wp*pi*4.5_wp, 0.005_wp, 20.0_wp)
      call make_sector(plane, [3.0_wp, 1.5_wp], [90.0_wp, 180.0_wp], 0.1_wp, x, tri, error)
      call inspect('a quarter of an ellipse', x, tri, 0.25_wp*pi*4.5_wp, 0.005_wp, 20.0_wp)
   end subroutine sectors

   subroutine polygons()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      real(wp), parameter :: ell(2, 6) = reshape([0.0_wp, 0.0_wp, 4.0_wp, 0.0_wp, 4.0_wp, 1.0_wp, &
         1.0_wp, 1.0_wp, &
         1.0_wp, 3.0_wp, 0.0_wp, 3.0_wp], [2, 6])
      real(wp), parameter :: comb(2, 8) = reshape([0.0_wp, 0.0_wp, 6.0_wp, 0.0_wp, 6.0_wp, &
         4.0_wp, 4.0_wp, 4.0_wp, &
         4.0_wp, 1.0_wp, 2.0_wp, 1.0_wp, 2.0_wp, 4.0_wp, 0.0_wp, 4.0_wp], [2, 8])
      real(wp), parameter :: kite(2, 3) = reshape([0.0_wp, 0.0_wp, 5.0_wp, 0.2_wp, 2.0_wp, &
         4.0_wp], [2, 3])

      call make_polygon(in_space(ell), 0.25_wp, x, tri, error)
      call check_no_error(suite, 'an L is made', error)
      call inspect('an L', x, tri, 6.0_wp, 1.0e-12_wp, 20.0_wp)
      call make_polygon(in_space(comb), 0.3_wp, x, tri, error)
      call inspect('a U', x, tri, 18.0_wp, 1.0e-12_wp, 20.0_wp)
      call make_polygon(in_space(comb), 30.0_wp, x, tri, error)
      call inspect('a U of elements larger than itself', x, tri, 18.0_wp, 1.0e-12_wp, 10.0_wp)
      call make_polygon(in_space(kite), 0.2_wp, x, tri, error)
      call inspect('a triangle', x, tri, 9.8_wp, 1.0e-12_wp, 20.0_wp)
   end subroutine polygons

   function in_space(flat) result(points)
      real(wp), intent(in) :: flat(:, :)
      real(wp) :: points(3, size(flat, 2))
      integer :: i

      do i = 1, size(flat, 2)
         points(:, i) = plane%centre + flat(1, i)*plane%along + flat(2, i)*plane%across
      end do
   end function in_space

   subroutine messages()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      real(wp) :: corners(3, 4)
      type(crack_plane_t) :: other

      call set_plane([0.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 1.0_wp, &
         0.0_wp], other, error)
      call check_error(suite, 'a direction without length is refused', error, &
         'must both have a length')
      call set_plane([0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 1.0_wp, &
         0.0_wp], other, error)
      call check_error(suite, 'directions that are not at right angles are refused', error, &
         'right angles')
      call make_rectangle(plane, [1.0_wp, -1.0_wp], 1.0_wp, x, tri, error)
      call check_error(suite, 'a negative depth is refused', error, 'must be positive')
      call make_disc(plane, 1.0_wp, 0.0_wp, x, tri, error)
      call check_error(suite, 'an element of no size is refused', error, 'element = 0')
      call make_sector(plane, [1.0_wp, 1.0_wp], [30.0_wp, 20.0_wp], 0.1_wp, x, tri, error)
      call check_error(suite, 'a sector that runs backwards is refused', error, 'by 360 at most')
      call make_polygon(in_space(reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], [2, 2])), 0.1_wp, x, &
         tri, error)
      call check_error(suite, 'a polygon of two points is refused', error, &
         'at least 3 are needed')
      corners = in_space(reshape([0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 2.5_wp, &
         3.0_wp], [2, 4]))
      call make_polygon(corners, 0.1_wp, x, tri, error)
      call check_error(suite, 'a polygon that crosses itself is refused', error, &
         'it must be simple')
      corners = in_space(reshape([0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 2.0_wp, 1.0_wp, 0.0_wp, &
         1.0_wp], [2, 4]))
      corners(:, 3) = corners(:, 3) + 0.1_wp*cross(plane%along, plane%across)
      call make_polygon(corners, 0.1_wp, x, tri, error)
      call check_error(suite, 'a bent polygon is refused', error, 'off the plane')
      corners(:, 3) = corners(:, 2)
      call make_polygon(corners, 0.1_wp, x, tri, error)
      call check_error(suite, 'a point named twice is refused', error, 'name each once')
      call make_polygon(in_space(reshape([0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 4.0_wp, 0.0_wp], &
         [2, 3])), 0.1_wp, x, tri, error)
      call check_error(suite, 'points on a line are refused', error, 'enclose no area')
   end subroutine messages
end program test_crack_shapes
