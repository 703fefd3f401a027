!> The part of a small box that lies inside a body: its volume and first moment.
module xmpm_cut_cell
   use xmpm_kinds, only: wp
   use xmpm_geometry, only: geometry_t, inside, region_of, flat_planes
   use xmpm_primitive, only: primitive_t, primitive_depth, region_out, region_cut, region_in
   implicit none
   private

   public :: cut_cell

   integer, parameter :: coarsest = 2   !! halvings that every curved cut gets
   integer, parameter :: finest = 6     !! halvings that even a small radius gets
   integer, parameter :: samples = 4    !! points a direction where several shapes cut a leaf

contains

   !> Volume and first moment of what a body has in a box.
   !>
   !> The box is split along the flat faces that stand across x, y or z, which are thus exact, and
   !> halved down to small leaves at all others.
   pure subroutine cut_cell(g, centre, half, volume, moment)
      type(geometry_t), intent(in) :: g    !! the body
      real(wp), intent(in) :: centre(3)    !! (3) centre of the box [length]
      real(wp), intent(in) :: half(3)      !! (3) half of its edges [length]
      real(wp), intent(out) :: volume      !! inside the body [length^3]
      real(wp), intent(out) :: moment(3)   !! (3) of this volume about the box's centre [length^4]
      real(wp), allocatable :: ex(:), ey(:), ez(:)
      integer :: region, cuts, last, i, j, k

      volume = 0.0_wp
      moment = 0.0_wp
      call region_of(g, centre, half, region, cuts, last)
      if (region == region_out) return
      if (region == region_in) then
         volume = 8*product(half)
         return
      end if
      ex = edges(1)
      ey = edges(2)
      ez = edges(3)
      do k = 1, size(ez) - 1
         do j = 1, size(ey) - 1
            do i = 1, size(ex) - 1
               call measure(g, centre, 0.5_wp*[ex(i) + ex(i + 1), ey(j) + ey(j + 1), &
                  ez(k) + ez(k + 1)], 0.5_wp*[ex(i + 1) - ex(i), ey(j + 1) - ey(j), &
                  ez(k + 1) - ez(k)], 0, volume, moment)
            end do
         end do
      end do

   contains

      pure function edges(direction) result(list)
         integer, intent(in) :: direction
         real(wp), allocatable :: list(:)
         real(wp) :: low, high

         low = centre(direction) - half(direction)
         high = centre(direction) + half(direction)
         list = [low, flat_planes(g, direction, low, high), high]
      end function edges
   end subroutine cut_cell

   !> Add what the body has in one piece of the box.
   pure recursive subroutine measure(g, origin, centre, half, level, volume, moment)
      type(geometry_t), intent(in) :: g         !! the body
      real(wp), intent(in) :: origin(3)         !! (3) point that moments are about [length]
      real(wp), intent(in) :: centre(3)         !! (3) centre of the piece [length]
      real(wp), intent(in) :: half(3)           !! (3) half of its edges [length]
      integer, intent(in) :: level              !! halvings done
      real(wp), intent(inout) :: volume         !! added to [length^3]
      real(wp), intent(inout) :: moment(3)      !! (3) added to [length^4]
      real(wp) :: part
      integer :: region, cuts, last, i, j, k

      call region_of(g, centre, half, region, cuts, last)
      if (region == region_out) return
      if (region == region_in) then
         part = 1.0_wp
      else if (is_leaf(g%part(last), half, level)) then
         part = leaf_part(g, centre, half, cuts, last)
      else
         do k = -1, 1, 2
            do j = -1, 1, 2
               do i = -1, 1, 2
                  call measure(g, origin, centre + 0.5_wp*half*real([i, j, k], wp), 0.5_wp*half, &
                     level + 1, volume, moment)
               end do
            end do
         end do
         return
      end if
      part = part*8*product(half)
      volume = volume + part
      moment = moment + part*(centre - origin)
   end subroutine measure

   !> Pieces are small enough once they see one surface, and that as nearly flat.
   pure function is_leaf(p, half, level) result(holds)
      type(primitive_t), intent(in) :: p   !! a shape that cuts the piece
      real(wp), intent(in) :: half(3)      !! (3) [length]
      integer, intent(in) :: level         !! halvings done
      logical :: holds
      real(wp) :: radius

      holds = level >= finest
      if (level < coarsest .or. holds) return
      radius = p%r_out
      if (p%r_in > 0.0_wp) radius = min(p%r_in, p%r_out - p%r_in)
      if (p%length > 0.0_wp) radius = min(radius, p%length)
      holds = 8*maxval(half) <= radius
   end function is_leaf

   !> Part of a leaf that is inside: by the mean depth below one surface, else by points.
   pure function leaf_part(g, centre, half, cuts, last) result(part)
      type(geometry_t), intent(in) :: g   !! the body
      real(wp), intent(in) :: centre(3)   !! (3) centre of the leaf [length]
      real(wp), intent(in) :: half(3)     !! (3) half of its edges [length]
      integer, intent(in) :: cuts         !! number of shapes that cut it
      integer, intent(in) :: last         !! the last of these
      real(wp) :: part                    !! 0 to 1
      real(wp) :: x(3)
      integer :: i, j, k, found

      if (cuts == 1) then
         part = part_below(g%part(last), centre, half)
         if (g%part(last)%subtract) part = 1.0_wp - part
         return
      end if
      found = 0
      do k = 1, samples
         do j = 1, samples
            do i = 1, samples
               x = centre + half*(real(2*[i, j, k] - 1, wp)/real(samples, wp) - 1.0_wp)
               if (inside(g, x)) found = found + 1
            end do
         end do
      end do
      part = real(found, wp)/samples**3
   end function leaf_part

   !> Part of a leaf below one surface, which is taken as a plane at the mean depth in the leaf.
   pure function part_below(p, centre, half) result(part)
      type(primitive_t), intent(in) :: p   !! the shape
      real(wp), intent(in) :: centre(3)    !! (3) centre of the leaf [length]
      real(wp), intent(in) :: half(3)      !! (3) half of its edges [length]
      real(wp) :: part                     !! 0 to 1
      real(wp) :: depth, mean, change(3), ahead, behind, step(3)
      integer :: i

      depth = primitive_depth(p, centre)
      mean = depth
      do i = 1, 3
         step = 0.0_wp
         step(i) = half(i)
         ahead = primitive_depth(p, centre + step)
         behind = primitive_depth(p, centre - step)
         change(i) = abs(ahead - behind)
         mean = mean + (ahead - 2*depth + behind)/6.0_wp
      end do
      part = part_above_zero(mean, change, 1.0e-3_wp*maxval(half))
   end function part_below

   !> Part of a cube where a linear function is positive.
   !>
   !> The function is the mean and three uniform deviations; two of these are integrated in closed
   !> form, with p(x) = max(x, 0)**2, and the smallest by three Gauss points.
   pure function part_above_zero(mean, change, least) result(part)
      real(wp), intent(in) :: mean        !! value at the centre
      real(wp), intent(in) :: change(3)   !! (3) differences over the edges, none negative
      real(wp), intent(in) :: least       !! smallest difference that counts
      real(wp) :: part                    !! 0 to 1
      real(wp), parameter :: points(3) = [-1.0_wp, 0.0_wp, 1.0_wp]*sqrt(0.15_wp)
      real(wp), parameter :: weights(3) = [5.0_wp, 8.0_wp, 5.0_wp]/18.0_wp
      real(wp) :: a, b, c, t(3)

      a = max(maxval(change), least)
      c = minval(change)
      b = max(sum(change) - maxval(change) - c, 1.0e-3_wp*a)
      t = mean + c*points
      part = sum(weights*(max(t + 0.5_wp*(a + b), 0.0_wp)**2 - max(t + 0.5_wp*(a - b), 0.0_wp)**2 &
         - max(t - 0.5_wp*(a - b), 0.0_wp)**2 + max(t - 0.5_wp*(a + b), 0.0_wp)**2))/(2*a*b)
      part = min(max(part, 0.0_wp), 1.0_wp)
   end function part_above_zero
end module xmpm_cut_cell
