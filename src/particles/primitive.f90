!> The shapes that bodies are made of: box, cylinder, tube and sphere.
module xmpm_primitive
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t, raise, code_usage
   use xmpm_text, only: to_text
   implicit none
   private

   public :: primitive_t, make_primitive, primitive_depth, primitive_region, primitive_volume
   public :: axial_and_radial
   public :: shape_box, shape_cylinder, shape_tube, shape_sphere
   public :: region_out, region_cut, region_in

   integer, parameter :: shape_box = 1, shape_cylinder = 2, shape_tube = 3, shape_sphere = 4
   integer, parameter :: region_out = -1   !! the region lies outside
   integer, parameter :: region_cut = 0    !! the region may be cut by the surface
   integer, parameter :: region_in = 1     !! the region lies inside

   character(len=*), parameter :: names(4) = [character(len=8) :: &
      'box', 'cylinder', 'tube', 'sphere']
   character(len=*), parameter :: meanings(4) = [character(len=32) :: 'x0 y0 z0 x1 y1 z1', &
      'x0 y0 z0 x1 y1 z1 r', 'x0 y0 z0 x1 y1 z1 r_in r_out', 'x y z r']
   integer, parameter :: counts(4) = [6, 7, 8, 4]

   !> One shape; a cylinder is a tube whose hole has no radius.
   type :: primitive_t
      integer :: shape = shape_box        !! one of the shapes of this module
      logical :: subtract = .false.       !! takes material away instead of adding it
      real(wp) :: low(3) = 0.0_wp         !! (3) lower corner of its bounds [length]
      real(wp) :: high(3) = 0.0_wp        !! (3) upper corner of its bounds [length]
      real(wp) :: base(3) = 0.0_wp        !! (3) centre of a sphere, first end of an axis [length]
      real(wp) :: axis(3) = 0.0_wp        !! (3) unit vector from the first to the second end [-]
      real(wp) :: length = 0.0_wp         !! distance of the ends [length]
      real(wp) :: r_in = 0.0_wp           !! radius of the hole, 0: none [length]
      real(wp) :: r_out = 0.0_wp          !! outer radius, 0 for a box [length]
      integer :: along = 0                !! 1 2 3: axis along x y z; 0: oblique or none
   end type primitive_t

contains

   !> A shape from its name and numbers as they stand in the deck.
   subroutine make_primitive(p, name, values, error)
      type(primitive_t), intent(out) :: p                !! made
      character(len=*), intent(in) :: name               !! box, cylinder, tube or sphere
      real(wp), intent(in) :: values(:)                  !! points, then radii [length]
      type(error_t), allocatable, intent(out) :: error   !! wrong name, count, order or radius
      integer :: shape

      do shape = 1, size(names)
         if (names(shape) == name) exit
      end do
      if (shape > size(names)) then
         call raise(error, code_usage, "'"//trim(name)// &
            "' is not a shape; there are box, cylinder, tube and sphere")
         return
      end if
      call check_numbers(shape, values, error)
      if (allocated(error)) return
      p%shape = shape
      select case (shape)
      case (shape_box)
         call make_box(p, values, error)
      case (shape_sphere)
         call make_sphere(p, values, error)
      case default
         call make_tube(p, values, error)
      end select
   end subroutine make_primitive

   subroutine check_numbers(shape, values, error)
      integer, intent(in) :: shape
      real(wp), intent(in) :: values(:)
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      if (size(values) /= counts(shape)) then
         call raise(error, code_usage, trim(names(shape))//' takes '//to_text(counts(shape))// &
            ' numbers ('//trim(meanings(shape))//'), '//to_text(size(values))//' are given')
         return
      end if
      do i = 1, size(values)
         if (ieee_is_finite(values(i))) cycle
         call raise(error, code_usage, trim(names(shape))//': number '//to_text(i)//' of ('// &
            trim(meanings(shape))//') is not finite')
         return
      end do
   end subroutine check_numbers

   subroutine make_box(p, values, error)
      type(primitive_t), intent(inout) :: p
      real(wp), intent(in) :: values(6)
      type(error_t), allocatable, intent(out) :: error
      character(len=1), parameter :: letter(3) = ['x', 'y', 'z']
      integer :: i

      p%low = values(1:3)
      p%high = values(4:6)
      do i = 1, 3
         if (p%high(i) > p%low(i)) cycle
         call raise(error, code_usage, 'box runs from '//letter(i)//' = '//to_text(p%low(i))// &
            ' to '//to_text(p%high(i))//'; the second corner must lie above the first')
         return
      end do
   end subroutine make_box

   subroutine make_sphere(p, values, error)
      type(primitive_t), intent(inout) :: p
      real(wp), intent(in) :: values(4)
      type(error_t), allocatable, intent(out) :: error

      p%base = values(1:3)
      p%r_out = values(4)
      p%low = p%base - p%r_out
      p%high = p%base + p%r_out
      call check_radius(p, error)
   end subroutine make_sphere

   subroutine make_tube(p, values, error)
      type(primitive_t), intent(inout) :: p
      real(wp), intent(in) :: values(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: reach(3)
      integer :: i

      p%base = values(1:3)
      p%axis = values(4:6) - values(1:3)
      p%length = norm2(p%axis)
      if (p%shape == shape_tube) p%r_in = values(7)
      p%r_out = values(size(values))
      call check_radius(p, error)
      if (allocated(error)) return
      if (p%length <= epsilon(1.0_wp)*maxval(abs(values))) then
         call raise(error, code_usage, trim(names(p%shape))//': both ends are at ('// &
            to_text(p%base)//'); they must differ to give the axis')
         return
      end if
      p%axis = p%axis/p%length
      do i = 1, 3
         if (sum(abs(p%axis)) - abs(p%axis(i)) > 1.0e-10_wp) cycle
         p%along = i
         p%axis = 0.0_wp
         p%axis(i) = sign(1.0_wp, values(3 + i) - values(i))
      end do
      reach = p%r_out*sqrt(max(1.0_wp - p%axis**2, 0.0_wp))
      p%low = min(values(1:3), values(4:6)) - reach
      p%high = max(values(1:3), values(4:6)) + reach
   end subroutine make_tube

   subroutine check_radius(p, error)
      type(primitive_t), intent(in) :: p
      type(error_t), allocatable, intent(out) :: error

      if (p%shape == shape_tube) then
         if (p%r_in > 0.0_wp .and. p%r_in < p%r_out) return
         call raise(error, code_usage, 'tube has inner radius '//to_text(p%r_in)// &
            ' and outer radius '//to_text(p%r_out)//'; they must obey 0 < r_in < r_out')
      else if (p%r_out <= 0.0_wp) then
         call raise(error, code_usage, trim(names(p%shape))//' has radius '//to_text(p%r_out)// &
            '; it must be positive')
      end if
   end subroutine check_radius

   !> How far a point lies below the surface; negative outside.
   !>
   !> The smallest of the distances to the surface's sheets: exact inside, at most the true
   !> distance outside, and never steeper than 1.
   pure function primitive_depth(p, x) result(depth)
      type(primitive_t), intent(in) :: p   !! the shape
      real(wp), intent(in) :: x(3)         !! (3) point [length]
      real(wp) :: depth                    !! [length]
      real(wp) :: s, rho

      select case (p%shape)
      case (shape_box)
         depth = min(minval(x - p%low), minval(p%high - x))
      case (shape_sphere)
         depth = p%r_out - norm2(x - p%base)
      case default
         call axial_and_radial(p, x, s, rho)
         depth = min(s, p%length - s, p%r_out - rho)
         if (p%shape == shape_tube) depth = min(depth, rho - p%r_in)
      end select
   end function primitive_depth

   !> Place of a point along the axis of a cylinder or tube, and its distance from the axis.
   pure subroutine axial_and_radial(p, x, s, rho)
      type(primitive_t), intent(in) :: p   !! cylinder or tube
      real(wp), intent(in) :: x(3)         !! (3) point [length]
      real(wp), intent(out) :: s           !! from the first end [length]
      real(wp), intent(out) :: rho         !! from the axis [length]
      real(wp) :: r(3)

      r = x - p%base
      s = dot_product(r, p%axis)
      rho = norm2(r - s*p%axis)
   end subroutine axial_and_radial

   !> Whether a box of space lies inside or outside the shape, or may be cut by its surface.
   !>
   !> Exact for boxes and for the ends of cylinders along x, y or z; otherwise "cut" may be said
   !> of a region that only comes near the surface.
   pure function primitive_region(p, centre, half, tolerance) result(region)
      type(primitive_t), intent(in) :: p        !! the shape
      real(wp), intent(in) :: centre(3)         !! (3) centre of the region [length]
      real(wp), intent(in) :: half(3)           !! (3) half of its edges [length]
      real(wp), intent(in) :: tolerance         !! overlaps up to this do not count [length]
      integer :: region                         !! region_out, region_cut or region_in
      real(wp) :: least                         ! of depth minus reach over the sheets
      real(wp) :: most                          ! of depth plus reach over the sheets

      region = region_out
      if (any(centre + half <= p%low + tolerance)) return
      if (any(centre - half >= p%high - tolerance)) return
      select case (p%shape)
      case (shape_box)
         least = min(minval(centre - half - p%low), minval(p%high - centre - half))
         most = half(1)
      case (shape_sphere)
         least = p%r_out - norm2(centre - p%base) - norm2(half)
         most = least + 2*norm2(half)
      case default
         call tube_region(p, centre, half, least, most)
      end select
      if (least >= -tolerance) then
         region = region_in
      else if (most > tolerance) then
         region = region_cut
      end if
   end function primitive_region

   pure subroutine tube_region(p, centre, half, least, most)
      type(primitive_t), intent(in) :: p
      real(wp), intent(in) :: centre(3), half(3)
      real(wp), intent(out) :: least, most
      real(wp) :: s, rho, along, across, flat, round

      call axial_and_radial(p, centre, s, rho)
      along = sum(abs(p%axis)*half)
      across = sqrt(sum(half**2*max(1.0_wp - p%axis**2, 0.0_wp)))
      if (p%along == 0) across = norm2(half)
      flat = min(s, p%length - s)
      round = p%r_out - rho
      if (p%shape == shape_tube) round = min(round, rho - p%r_in)
      least = min(flat - along, round - across)
      most = min(flat + along, round + across)
   end subroutine tube_region

   !> Volume of the whole shape.
   pure function primitive_volume(p) result(volume)
      type(primitive_t), intent(in) :: p   !! the shape
      real(wp) :: volume                   !! [length^3]

      select case (p%shape)
      case (shape_box)
         volume = product(p%high - p%low)
      case (shape_sphere)
         volume = 4.0_wp/3.0_wp*pi*p%r_out**3
      case default
         volume = pi*(p%r_out**2 - p%r_in**2)*p%length
      end select
   end function primitive_volume
end module xmpm_primitive
