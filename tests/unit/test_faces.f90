!> Surface layers: areas of faces, closed surfaces, and the messages about faces that are missing.
program test_faces
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t
   use xmpm_geometry, only: geometry_t, add_primitive, inside
   use xmpm_body_fill, only: sub_lattice_t, fill_bins, cell_range
   use xmpm_faces, only: find_face, faces_of, sum_areas, scale_areas
   use xmpm_face_total, only: face_total
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   real(wp), parameter :: edge = 0.25_wp   !! of all sub-cells here

   suite%name = 'faces'
   call test_box()
   call test_box_off_the_lattice()
   call test_plate_with_hole()
   call test_closed_surfaces()
   call test_shells()
   call test_trimmed_sphere()
   call test_names()
   call test_messages()
   call finish(suite)

contains

   subroutine put(g, kind, values, subtract)
      type(geometry_t), intent(inout) :: g
      character(len=*), intent(in) :: kind
      real(wp), intent(in) :: values(:)
      logical, intent(in), optional :: subtract
      type(error_t), allocatable :: error

      call add_primitive(g, kind, values, present(subtract), error)
      if (allocated(error)) call check(suite, error%message, .false.)
   end subroutine put

   function body(kind, values) result(g)
      character(len=*), intent(in) :: kind
      real(wp), intent(in) :: values(:)
      type(geometry_t) :: g

      call put(g, kind, values)
   end function body

   !> Area vectors of a face before and after scaling, and how many particles carry it.
   subroutine load(g, name, raw, scaled, carriers)
      type(geometry_t), intent(in) :: g
      character(len=*), intent(in) :: name
      real(wp), intent(out) :: raw(4), scaled(4)
      integer, intent(out) :: carriers
      type(sub_lattice_t) :: lattice
      type(error_t), allocatable :: error
      real(wp), allocatable :: x(:, :), volume(:), area(:, :), offset(:, :)
      real(wp) :: normal(3), plane
      integer :: low(3), high(3), i, d, misses

      lattice%spacing = 2*edge
      call cell_range(g, lattice, low, high)
      call fill_bins(g, lattice, low, high, x, volume)
      allocate (area(3, size(volume)), offset(3, size(volume)))
      call find_face(g, name, x, volume, edge, area, offset, error)
      call check_no_error(suite, 'the face '//name//' is found', error)
      misses = 0
      do i = 1, size(volume)
         if (.not. any(abs(area(:, i)) > 0.0_wp)) cycle
         if (scan(name, 'xyz') > 0) then
            d = index('xyz', name(2:2))
            plane = merge(g%high(d), g%low(d), name(1:1) == '+')
            if (abs(x(d, i) + offset(d, i) - plane) > 1e-12_wp) misses = misses + 1
         else
            normal = 1e-3_wp*edge*area(:, i)/norm2(area(:, i))
            if (.not. inside(g, x(:, i) + offset(:, i) - normal) &
                .or. inside(g, x(:, i) + offset(:, i) + normal)) misses = misses + 1
         end if
      end do
      call check(suite, 'the offsets end on the face '//name, misses == 0)
      carriers = count(norm2(area, dim=1) > 0.0_wp)
      raw = sum_areas(area)
      call scale_areas(area, raw, face_total(g, name))
      scaled = sum_areas(area)
   end subroutine load

   subroutine test_box()
      type(geometry_t) :: g
      real(wp) :: raw(4), scaled(4)
      integer :: n

      g = body('box', [0.0_wp, 0.0_wp, 0.0_wp, 2.0_wp, 1.0_wp, 3.0_wp])
      call load(g, '+y', raw, scaled, n)
      call check(suite, 'one layer of particles carries a face of a box', n == 96)
      ! areas of a box on the lattice are exact to rounding even before scaling
      call check(suite, 'and its whole area, outward', &
         maxval(abs(raw - [6.0_wp, 0.0_wp, 6.0_wp, 0.0_wp])) < 1.0e-13_wp)
      call load(g, '-z', raw, scaled, n)
      call check(suite, 'the lower face looks down', &
         maxval(abs(scaled - [2.0_wp, 0.0_wp, 0.0_wp, -2.0_wp])) < 1.0e-13_wp)
   end subroutine test_box

   !> One layer, and the exact area, wherever the face lies between lattice planes.
   subroutine test_box_off_the_lattice()
      type(geometry_t) :: g
      real(wp) :: raw(4), scaled(4), end
      integer :: n, i

      do i = 1, 60
         end = 1.0_wp + edge*real(i, wp)/30.0_wp
         g = body('box', [0.0_wp, 0.11_wp, 0.0_wp, end, 1.0_wp, 0.93_wp])
         call load(g, '+x', raw, scaled, n)
         call check(suite, 'one layer carries the face of a box off the lattice', n == 16)
         ! 2 d is exact for parts of boxes; rounding of depths of 1 % of a sub-cell
         call check(suite, 'and its whole area', &
            maxval(abs(raw - 0.89_wp*0.93_wp*[1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp])) < 1.0e-12_wp)
      end do
      g = body('box', [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp + 0.008_wp*edge, 1.0_wp, 1.0_wp])
      call load(g, '+x', raw, scaled, n)
      call check(suite, 'slivers leave the face to the layer below', n == 16)
      ! as above
      call check_close(suite, 'with its whole area', raw(2), 1.0_wp, 0.0_wp, 1.0e-12_wp)
   end subroutine test_box_off_the_lattice

   subroutine test_plate_with_hole()
      type(geometry_t) :: g
      real(wp) :: raw(4), scaled(4), total(4)
      integer :: n

      g = body('box', [-2.0_wp, -2.0_wp, -0.5_wp, 2.0_wp, 2.0_wp, 0.5_wp])
      call put(g, 'cylinder', [0.1_wp, 0.2_wp, -1.0_wp, 0.1_wp, 0.2_wp, 1.0_wp, 0.8_wp], &
         subtract=.true.)
      call load(g, '+z', raw, scaled, n)
      call check_close(suite, 'a hole takes its part of a face', raw(4), 16 - pi*0.64_wp, &
         0.0_wp, 1.0e-3_wp)   ! as accurate as the volumes of cut sub-cells
      call load(g, 'inside', raw, scaled, n)
      total = face_total(g, 'inside')
      ! 1024 points along a wall of which half bounds the body: one point at either end
      call check_close(suite, 'area of a hole that starts outside the body', total(1), 1.6_wp*pi, &
         0.0_wp, 2.0e-3_wp)
      call check(suite, 'a hole has no area vector', all(abs(total(2:4)) < 1.0e-12_wp))
      ! the shell of a radius of three sub-cells, its lower edge blurred
      call check_close(suite, 'particles around a hole carry about its area', raw(1), 1.6_wp*pi, &
         0.0_wp, 0.02_wp)
      ! the shift to a vanishing sum changes sizes in second order
      call check_close(suite, 'and exactly that once scaled', scaled(1), total(1), 0.0_wp, &
         1.0e-4_wp)
      call check(suite, 'with no resultant', all(abs(scaled(2:4)) < 1.0e-12_wp))   ! rounding
   end subroutine test_plate_with_hole

   !> The area vectors of all faces of a body sum to zero, and sizes to the exact surface.
   subroutine test_closed_surfaces()
      call check_closed(body('box', [0.03_wp, 0.1_wp, -0.3_wp, 1.1_wp, 0.9_wp, 0.77_wp]), &
         2*(1.07_wp*0.8_wp + 1.07_wp*1.07_wp + 0.8_wp*1.07_wp))
      call check_closed(body('sphere', [0.03_wp, 0.11_wp, -0.3_wp, 1.4_wp]), 4*pi*1.96_wp)
      call check_closed(body('cylinder', [0.0_wp, 0.1_wp, 0.2_wp, 3.0_wp, 0.1_wp, 0.2_wp, &
         0.9_wp]), &
         2*pi*0.81_wp + 5.4_wp*pi)
      call check_closed(body('tube', [0.1_wp, 0.2_wp, 0.0_wp, 0.1_wp, 0.2_wp, 2.0_wp, 0.7_wp, &
         1.3_wp]), &
         2*pi*(1.69_wp - 0.49_wp) + 4*pi*2.0_wp)
   end subroutine test_closed_surfaces

   subroutine check_closed(g, surface)
      type(geometry_t), intent(in) :: g
      real(wp), intent(in) :: surface
      character(len=:), allocatable :: names
      real(wp) :: raw(4), scaled(4), total(4)
      integer :: n, blank

      names = faces_of(g)//' '
      total = 0.0_wp
      do while (len(names) > 0)
         blank = index(names, ' ')
         call load(g, names(:blank - 1), raw, scaled, n)
         total = total + scaled
         names = names(blank + 1:)
      end do
      call check(suite, 'area vectors of a closed surface sum to zero', &
         all(abs(total(2:4)) < 1.0e-12_wp))   ! rounding
      ! the shift to the exact resultant changes sizes in second order
      call check_close(suite, 'areas sum to the surface', total(1), surface, 0.0_wp, 1.0e-4_wp)
   end subroutine check_closed

   !> Before scaling, curved faces are met within a per cent.
   subroutine test_shells()
      real(wp) :: raw(4), scaled(4)
      integer :: n

      ! shells with a blurred lower edge: the half sub-cell over the radius, squared, and scatter
      call load(body('sphere', [0.03_wp, 0.11_wp, -0.3_wp, 4.1_wp]), 'side', raw, scaled, n)
      call check_close(suite, 'shell of a sphere', raw(1), 4*pi*4.1_wp**2, 0.0_wp, 0.01_wp)
      call load(body('cylinder', [0.0_wp, 0.1_wp, 0.2_wp, 3.0_wp, 0.1_wp, 0.2_wp, 3.3_wp]), &
         'side', raw, scaled, n)
      call check_close(suite, 'shell of a cylinder', raw(1), 6*pi*3.3_wp, 0.0_wp, 0.01_wp)
      call load(body('tube', [0.0_wp, 0.1_wp, 0.2_wp, 0.0_wp, 0.1_wp, 3.2_wp, 2.4_wp, 3.3_wp]), &
         'inside', raw, scaled, n)
      call check_close(suite, 'shell of an inner wall', raw(1), 6*pi*2.4_wp, 0.0_wp, 0.01_wp)
   end subroutine test_shells

   subroutine test_trimmed_sphere()
      type(geometry_t) :: g
      real(wp) :: raw(4), scaled(4)
      integer :: n

      g = body('sphere', [0.0_wp, 0.0_wp, 0.0_wp, 2.0_wp])
      call put(g, 'box', [-3.0_wp, -3.0_wp, -3.0_wp, 3.0_wp, 3.0_wp, 0.1_wp], subtract=.true.)
      call check(suite, 'a sphere cut by a plane has that face', faces_of(g) == '-z side')
      call load(g, '-z', raw, scaled, n)
      ! the body leans inward behind the face: first order in the sub-cell over the radius
      call check_close(suite, 'the face of a cut sphere', raw(1), pi*3.99_wp, 0.0_wp, 0.03_wp)
      call load(g, 'side', raw, scaled, n)
      call check_close(suite, 'a cap has the area of its band', scaled(1), 2*pi*2*1.9_wp, 0.0_wp, &
         2.0e-3_wp)   ! 1024 points along, and the shift to the exact resultant
      call check_close(suite, 'and the resultant of its base', scaled(4), pi*3.99_wp, 0.0_wp, &
         2.0e-3_wp)   ! as before
   end subroutine test_trimmed_sphere

   subroutine test_names()
      type(geometry_t) :: g

      call check(suite, 'a box has six faces', faces_of(body('box', &
         [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, &
         1.0_wp, 1.0_wp])) == '-x +x -y +y -z +z')
      call check(suite, 'an oblique tube has walls only', faces_of(body('tube', [0.0_wp, 0.0_wp, &
         0.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, 0.2_wp, 0.4_wp])) == 'side inside')
      g = body('box', [0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 1.0_wp])
      call put(g, 'sphere', [1.0_wp, 0.5_wp, 0.5_wp, 0.3_wp])
      call check(suite, 'a bump hides the face behind it', faces_of(g) == '-x -y +y -z +z side')
      call check(suite, 'a body of nothing has no faces', faces_of(geometry_t()) == 'none')
   end subroutine test_names

   subroutine test_messages()
      type(geometry_t) :: g

      g = body('cylinder', [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp])
      call expect(g, '+x', 'the body has no face +x; it has: -z +z side')
      call expect(g, 'inside', 'the body has no face inside; it has: -z +z side')
      call expect(g, 'top', "'top' is not a face; the body has: -z +z side")
      call expect(g, '', "'' is not a face; the body has: -z +z side")
      call expect(g, 'z', "'z' is not a face; the body has: -z +z side")
      call expect(g, '-z +z', "'-z +z' is not a face")
   end subroutine test_messages

   subroutine expect(g, name, message)
      type(geometry_t), intent(in) :: g
      character(len=*), intent(in) :: name, message
      type(error_t), allocatable :: error
      real(wp) :: x(3, 0), volume(0), area(3, 0), offset(3, 0)

      call find_face(g, name, x, volume, edge, area, offset, error)
      call check_error(suite, "the face '"//name//"' is refused", error, message)
   end subroutine expect
end program test_faces
