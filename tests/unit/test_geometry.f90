!> Bodies: what lies inside, bounds, volumes, and every message about wrong shapes.
program test_geometry
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t
   use xmpm_geometry, only: geometry_t, add_primitive, inside, bounds, exact_volume, region_of, &
      flat_planes
   use xmpm_primitive, only: region_out, region_cut, region_in
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none
   type(suite_t) :: suite

   suite%name = 'geometry'
   call test_points()
   call test_order()
   call test_surface()
   call test_bounds()
   call test_volumes()
   call test_regions()
   call test_planes()
   call test_messages()
   call finish(suite)

contains

   !> A body of one shape.
   function body(kind, values) result(g)
      character(len=*), intent(in) :: kind
      real(wp), intent(in) :: values(:)
      type(geometry_t) :: g
      type(error_t), allocatable :: error

      call add_primitive(g, kind, values, .false., error)
      call check_no_error(suite, 'a valid '//kind//' is accepted', error)
   end function body

   subroutine take(g, kind, values)
      type(geometry_t), intent(inout) :: g
      character(len=*), intent(in) :: kind
      real(wp), intent(in) :: values(:)
      type(error_t), allocatable :: error

      call add_primitive(g, kind, values, .true., error)
      call check_no_error(suite, 'a valid '//kind//' can be taken away', error)
   end subroutine take

   subroutine test_points()
      type(geometry_t) :: g

      g = body('box', [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 3.0_wp])
      call check(suite, 'a box holds a point between its corners', &
         inside(g, [0.5_wp, 1.9_wp, 2.9_wp]))
      call check(suite, 'a box ends at its corner', .not. inside(g, [1.1_wp, 1.0_wp, 1.0_wp]))
      g = body('sphere', [1.0_wp, 1.0_wp, 1.0_wp, 2.0_wp])
      call check(suite, 'a sphere holds a point within its radius', &
         inside(g, [2.1_wp, 2.1_wp, 2.1_wp]))
      call check(suite, 'a sphere does not reach its corner', &
         .not. inside(g, [2.2_wp, 2.2_wp, 2.2_wp]))
      g = body('cylinder', [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.1_wp])
      call check(suite, 'an oblique cylinder holds its axis', inside(g, [0.7_wp, 0.7_wp, 0.0_wp]))
      call check(suite, 'a cylinder ends beside its axis', &
         .not. inside(g, [0.5_wp, 0.5_wp, 0.11_wp]))
      call check(suite, 'a cylinder ends flat', .not. inside(g, [1.01_wp, 1.01_wp, 0.0_wp]))
      g = body('tube', [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 4.0_wp, 1.0_wp, 2.0_wp])
      call check(suite, 'a tube holds its wall', inside(g, [0.0_wp, 1.5_wp, 1.0_wp]))
      call check(suite, 'a tube has a hole', .not. inside(g, [0.0_wp, 0.5_wp, 1.0_wp]))
      call check(suite, 'a body of nothing holds nothing', &
         .not. inside(geometry_t(), [0.0_wp, 0.0_wp, 0.0_wp]))
   end subroutine test_points

   subroutine test_order()
      type(geometry_t) :: g
      type(error_t), allocatable :: error

      g = body('box', [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 1.0_wp])
      call take(g, 'sphere', [0.5_wp, 0.5_wp, 0.5_wp, 0.4_wp])
      call check(suite, 'what is taken away is gone', .not. inside(g, [0.5_wp, 0.5_wp, 0.6_wp]))
      call add_primitive(g, 'sphere', [0.5_wp, 0.5_wp, 0.5_wp, 0.2_wp], .false., error)
      call check(suite, 'what is added later is there again', inside(g, [0.5_wp, 0.5_wp, 0.6_wp]))
      call check(suite, 'and only that', .not. inside(g, [0.5_wp, 0.5_wp, 0.8_wp]))
   end subroutine test_order

   !> Surfaces belong to the body on both sides, within 1e-9 of its size.
   subroutine test_surface()
      type(geometry_t) :: g

      g = body('box', [-1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp])
      call take(g, 'box', [-0.5_wp, -2.0_wp, -2.0_wp, 0.5_wp, 2.0_wp, 2.0_wp])
      call check(suite, 'both outer faces belong to the body', &
         inside(g, [-1.0_wp, 0.0_wp, 0.0_wp]) .and. inside(g, [1.0_wp, 0.0_wp, 0.0_wp]))
      call check(suite, 'both faces of a slot belong to the body', &
         inside(g, [-0.5_wp, 0.0_wp, 0.0_wp]) .and. inside(g, [0.5_wp, 0.0_wp, 0.0_wp]))
      call check(suite, 'rounding beside a face does not matter', &
         inside(g, [1.0_wp + 1.0e-10_wp, 0.0_wp, 0.0_wp]) .and. &
         inside(g, [0.5_wp - 1.0e-10_wp, 0.0_wp, 0.0_wp]))
      call check(suite, 'a millionth beside a face does', &
         .not. inside(g, [1.0_wp + 1.0e-6_wp, 0.0_wp, 0.0_wp]))
   end subroutine test_surface

   subroutine test_bounds()
      type(geometry_t) :: g
      real(wp) :: low(3), high(3), reach

      g = body('cylinder', [0.0_wp, 0.0_wp, 0.0_wp, 3.0_wp, 4.0_wp, 0.0_wp, 1.0_wp])
      call bounds(g, low, high)
      reach = sqrt(1.0_wp - 0.36_wp)   ! of a disc whose normal has the component 3/5
      call check_close(suite, 'an oblique cylinder reaches as far as its rim', high(1), &
         3.0_wp + reach, &
         0.0_wp, 1.0e-14_wp)   ! rounding
      call check_close(suite, 'on both sides', low(1), -reach, 0.0_wp, 1.0e-14_wp)   ! rounding
      ! rounding
      call check_close(suite, 'and across its plane', high(3), 1.0_wp, 0.0_wp, 1.0e-14_wp)
      g = body('box', [0.0_wp, 0.0_wp, 0.0_wp, 4.0_wp, 1.0_wp, 1.0_wp])
      call take(g, 'box', [3.0_wp, 0.0_wp, -1.0_wp, 5.0_wp, 1.0_wp, 2.0_wp])
      call take(g, 'box', [0.0_wp, 0.5_wp, 0.0_wp, 1.0_wp, 1.0_wp, 1.0_wp])
      call bounds(g, low, high)
      call check(suite, 'bounds end where a box takes a whole end, and only there', &
         all(abs(low) < 1.0e-15_wp) .and. all(abs(high - [3.0_wp, 1.0_wp, 1.0_wp]) < 1.0e-15_wp))
   end subroutine test_bounds

   subroutine test_volumes()
      type(geometry_t) :: g

      g = body('box', [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 3.0_wp])
      ! rounding
      call check_close(suite, 'volume of a box', exact_volume(g), 6.0_wp, 0.0_wp, 1.0e-15_wp)
      call take(g, 'sphere', [0.0_wp, 0.0_wp, 0.0_wp, 0.5_wp])
      call check(suite, 'no closed form for two shapes', exact_volume(g) < 0.0_wp)
      g = body('sphere', [0.0_wp, 0.0_wp, 0.0_wp, 3.0_wp])
      ! rounding
      call check_close(suite, 'volume of a sphere', exact_volume(g), 36*pi, 0.0_wp, 1.0e-15_wp)
      g = body('tube', [0.0_wp, 0.0_wp, 0.0_wp, 3.0_wp, 4.0_wp, 0.0_wp, 1.0_wp, 2.0_wp])
      ! rounding
      call check_close(suite, 'volume of a tube', exact_volume(g), 15*pi, 0.0_wp, 1.0e-15_wp)
      call check(suite, 'a body of nothing has no volume', &
         abs(exact_volume(geometry_t())) < tiny(1.0_wp))
   end subroutine test_volumes

   !> What region_of says of a box of space holds at random points of it.
   subroutine test_regions()
      type(geometry_t) :: g
      type(error_t), allocatable :: error
      real(wp) :: centre(3), half(3), r(3)
      integer :: i, j, region, cuts, last, wrong, seen(-1:1), seed_size

      call random_seed(size=seed_size)
      call random_seed(put=[(7919*i, i=1, seed_size)])   ! the same points in every run
      g = body('tube', [-1.0_wp, 0.0_wp, -0.3_wp, 1.0_wp, 0.4_wp, 0.2_wp, 0.4_wp, 0.9_wp])
      call take(g, 'sphere', [0.0_wp, 0.8_wp, 0.0_wp, 0.6_wp])
      call add_primitive(g, 'cylinder', [0.0_wp, 0.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.3_wp], &
         .false., error)
      wrong = 0
      seen = 0
      do i = 1, 10000
         call random_number(centre)
         call random_number(half)
         centre = 3*centre - 1.5_wp
         half = 0.2_wp*half
         call region_of(g, centre, half, region, cuts, last)
         seen(region) = seen(region) + 1
         if (region == region_cut) cycle
         do j = 1, 30
            call random_number(r)
            if (inside(g, centre + half*(2*r - 1)) .neqv. region == region_in) wrong = wrong + 1
         end do
      end do
      call check(suite, 'a region said to be in or out is so at every point', wrong == 0)
      call check(suite, 'all three answers come', all(seen > 50))
      call check(suite, 'regions outside are told', seen(region_out) > seen(region_in))
   end subroutine test_regions

   subroutine test_planes()
      type(geometry_t) :: g
      real(wp), allocatable :: planes(:)

      g = body('box', [0.0_wp, 0.0_wp, 0.0_wp, 4.0_wp, 1.0_wp, 1.0_wp])
      call take(g, 'cylinder', [3.0_wp, 0.5_wp, 0.5_wp, 1.0_wp, 0.5_wp, 0.5_wp, 0.2_wp])
      allocate (planes, source=flat_planes(g, 1, -1.0_wp, 4.0_wp))
      call check(suite, 'flat faces come in ascending order, the ends of the interval left out', &
         size(planes) == 3 .and. all(abs(planes - [0.0_wp, 1.0_wp, 3.0_wp]) < 1.0e-15_wp))
      call check(suite, 'a cylinder has no flat face beside its axis', &
         size(flat_planes(g, 2, 0.1_wp, 0.9_wp)) == 0)
   end subroutine test_planes

   subroutine test_messages()
      call expect('cone', [1.0_wp], &
         "'cone' is not a shape; there are box, cylinder, tube and sphere")
      call expect('box', [1.0_wp, 2.0_wp], 'box takes 6 numbers (x0 y0 z0 x1 y1 z1), 2 are given')
      call expect('sphere', [0.0_wp, ieee_value(0.0_wp, ieee_quiet_nan), 0.0_wp, 1.0_wp], &
         'sphere: number 2 of (x y z r) is not finite')
      call expect('box', [0.0_wp, 3.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 1.0_wp], &
         'box runs from y = 3 to 2; the second corner must lie above the first')
      call expect('box', [0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 2.0_wp, 1.0_wp], &
         'box runs from z = 1 to 1;')
      call expect('sphere', [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], &
         'sphere has radius 0; it must be positive')
      call expect('cylinder', [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, -2.0_wp], &
         'cylinder has radius -2; it must be positive')
      call expect('cylinder', [1.0_wp, 2.0_wp, 3.0_wp, 1.0_wp, 2.0_wp, 3.0_wp, 1.0_wp], &
         'cylinder: both ends are at (1 2 3); they must differ to give the axis')
      call expect('tube', [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 2.0_wp, 1.0_wp], &
         'tube has inner radius 2 and outer radius 1; they must obey 0 < r_in < r_out')
      call expect('tube', [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], &
         'tube has inner radius 0')
      call expect('box', [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 1.0_wp], &
         'without_box comes before any shape', subtract=.true.)
   end subroutine test_messages

   subroutine expect(kind, values, message, subtract)
      character(len=*), intent(in) :: kind, message
      real(wp), intent(in) :: values(:)
      logical, intent(in), optional :: subtract
      type(geometry_t) :: g
      type(error_t), allocatable :: error

      call add_primitive(g, kind, values, present(subtract), error)
      call check_error(suite, 'a wrong '//kind//' is refused', error, message)
      call check(suite, 'and leaves the body as it was', .not. allocated(g%part))
   end subroutine expect
end program test_geometry
