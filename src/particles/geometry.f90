!> Bodies as ordered lists of shapes, each adding to or taking from what stands before it.
module xmpm_geometry
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t, raise, code_usage
   use xmpm_primitive, only: primitive_t, make_primitive, primitive_depth, primitive_region, &
      primitive_volume, shape_box, region_out, region_cut, region_in
   implicit none
   private

   public :: geometry_t, add_primitive, inside, bounds, exact_volume, region_of, flat_planes

   !> A body; its surface belongs to it, so that mirrored bodies hold mirrored points.
   type :: geometry_t
      type(primitive_t), allocatable :: part(:)   !! shapes in the order of evaluation
      real(wp) :: low(3) = 0.0_wp                 !! (3) lower corner of the bounds [length]
      real(wp) :: high(3) = 0.0_wp                !! (3) upper corner of the bounds [length]
      real(wp) :: tolerance = 0.0_wp              !! what counts as touching [length]
   end type geometry_t

contains

   !> Add a shape to a body, or take one away from what has been written so far.
   subroutine add_primitive(g, kind, values, subtract, error)
      type(geometry_t), intent(inout) :: g               !! extended
      character(len=*), intent(in) :: kind               !! box, cylinder, tube or sphere
      real(wp), intent(in) :: values(:)                  !! as in the deck [length]
      logical, intent(in) :: subtract                    !! take away
      type(error_t), allocatable, intent(out) :: error   !! wrong shape, or nothing to take from
      type(primitive_t) :: p
      logical :: first

      call make_primitive(p, kind, values, error)
      if (allocated(error)) return
      p%subtract = subtract
      first = .not. allocated(g%part)
      if (first .and. subtract) then
         call raise(error, code_usage, 'without_'//kind// &
            ' comes before any shape that it could be taken from')
         return
      end if
      if (first) then
         g%part = [p]
         g%low = p%low
         g%high = p%high
      else
         g%part = [g%part, p]
         call change_bounds(g, p)
      end if
      g%tolerance = max(g%tolerance, 1.0e-9_wp*maxval(p%high - p%low), &
         8*epsilon(1.0_wp)*max(maxval(abs(p%low)), maxval(abs(p%high))))
   end subroutine add_primitive

   !> Bounds grow with a shape that adds, and shrink where a box takes away a whole end.
   pure subroutine change_bounds(g, p)
      type(geometry_t), intent(inout) :: g
      type(primitive_t), intent(in) :: p
      logical :: covers(3)
      integer :: i

      if (.not. p%subtract) then
         g%low = min(g%low, p%low)
         g%high = max(g%high, p%high)
      else if (p%shape == shape_box) then
         do i = 1, 3
            covers = p%low <= g%low + g%tolerance .and. p%high >= g%high - g%tolerance
            covers(i) = .true.
            if (.not. all(covers)) cycle
            if (p%high(i) >= g%high(i) - g%tolerance) g%high(i) = min(g%high(i), p%low(i))
            if (p%low(i) <= g%low(i) + g%tolerance) g%low(i) = max(g%low(i), p%high(i))
            g%high(i) = max(g%high(i), g%low(i))
         end do
      end if
   end subroutine change_bounds

   !> Whether a point lies in the body or on its surface.
   pure function inside(g, x) result(holds)
      type(geometry_t), intent(in) :: g   !! the body
      real(wp), intent(in) :: x(3)        !! (3) point [length]
      logical :: holds
      real(wp) :: depth
      integer :: i

      holds = .false.
      if (.not. allocated(g%part)) return
      do i = 1, size(g%part)
         if (holds .neqv. g%part(i)%subtract) cycle
         depth = primitive_depth(g%part(i), x)
         if (g%part(i)%subtract) then
            holds = depth <= g%tolerance
         else
            holds = depth >= -g%tolerance
         end if
      end do
   end function inside

   !> A box that holds the body; where boxes cut whole ends off, without these.
   pure subroutine bounds(g, low, high)
      type(geometry_t), intent(in) :: g   !! the body
      real(wp), intent(out) :: low(3)     !! (3) lower corner [length]
      real(wp), intent(out) :: high(3)    !! (3) upper corner [length]

      low = g%low
      high = g%high
   end subroutine bounds

   !> Volume of a body of one shape; negative where no closed form is known.
   pure function exact_volume(g) result(volume)
      type(geometry_t), intent(in) :: g   !! the body
      real(wp) :: volume                  !! [length^3]

      volume = 0.0_wp
      if (.not. allocated(g%part)) return
      volume = -1.0_wp
      if (size(g%part) == 1) volume = primitive_volume(g%part(1))
   end function exact_volume

   !> Whether a box of space lies inside or outside the body, or may be cut by its surface.
   pure subroutine region_of(g, centre, half, region, cuts, last)
      type(geometry_t), intent(in) :: g    !! the body
      real(wp), intent(in) :: centre(3)    !! (3) centre of the region [length]
      real(wp), intent(in) :: half(3)      !! (3) half of its edges [length]
      integer, intent(out) :: region       !! region_out, region_cut or region_in
      integer, intent(out) :: cuts         !! number of shapes that cut the region
      integer, intent(out) :: last         !! the last of these, 0: none
      integer :: i, effect, found

      region = region_out
      cuts = 0
      last = 0
      if (.not. allocated(g%part)) return
      do i = 1, size(g%part)
         effect = merge(region_out, region_in, g%part(i)%subtract)
         if (region == effect) cycle
         found = primitive_region(g%part(i), centre, half, g%tolerance)
         if (found == region_in) then
            region = effect
            cuts = 0
            last = 0
         else if (found == region_cut) then
            region = region_cut
            cuts = cuts + 1
            last = i
         end if
      end do
   end subroutine region_of

   !> Where flat faces across one direction cut an interval, ascending and between its ends.
   pure function flat_planes(g, direction, low, high) result(planes)
      type(geometry_t), intent(in) :: g       !! the body
      integer, intent(in) :: direction        !! 1 2 3
      real(wp), intent(in) :: low             !! lower end [length]
      real(wp), intent(in) :: high            !! upper end [length]
      real(wp), allocatable :: planes(:)      !! coordinates [length]
      real(wp) :: next
      integer :: i, side

      allocate (planes(0))
      next = low
      do
         next = next + 0.5_wp*g%tolerance
         planes = [planes, high]
         do i = 1, size(g%part)
            associate (p => g%part(i))
               if (p%shape /= shape_box .and. p%along /= direction) cycle
               do side = 1, 2
                  associate (plane => merge(p%low(direction), p%high(direction), side == 1))
                     if (plane > next) planes(size(planes)) = min(planes(size(planes)), plane)
                  end associate
               end do
            end associate
         end do
         next = planes(size(planes))
         if (next >= high - 0.5_wp*g%tolerance) exit
      end do
      planes = planes(:size(planes) - 1)
   end function flat_planes
end module xmpm_geometry
