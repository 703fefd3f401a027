!> The opening of a crack a given distance behind its fronts, from the two faces of its surface.
module xmpm_opening
   use xmpm_kinds, only: wp
   use xmpm_surface_index, only: nearest_t, nearest_on_surface
   use xmpm_crack, only: crack_t
   use xmpm_vectors, only: cross
   use xmpm_front_points, only: front_points_t
   implicit none
   private

   public :: opening_behind

contains

   !> u+ - u- at a distance behind a point, along e2, e1 and e3 (modes I, II, III); that of the
   !> nearest point of the surface where the surface does not go so far.
   pure function opening_behind(crack, points, i, distance) result(opening)
      type(crack_t), intent(in) :: crack             !! gathered
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: i                       !! point
      real(wp), intent(in) :: distance               !! behind the front [length]
      real(wp) :: opening(3), jump(3), weight(3)     !! [length]
      type(nearest_t) :: nearest
      integer :: k

      opening = 0
      call nearest_on_surface(crack%index, crack%surface, &
         points%x(:, i) - distance*points%frame(:, 1, i), 4*distance, nearest, 0)
      if (nearest%triangle == 0) return
      associate (s => crack%surface, v => crack%surface%tri(:, nearest%triangle))
         weight = shares(s%x(:, v), nearest%point)
         jump = 0
         do k = 1, 3
            jump = jump + weight(k)*(s%up(:, v(k)) - s%um(:, v(k)))
         end do
      end associate
      opening = matmul(jump, points%frame(:, [2, 1, 3], i))
   end function opening_behind

   !> Shares of the three corners in a point of a triangle.
   pure function shares(corner, x) result(weight)
      real(wp), intent(in) :: corner(3, 3), x(3)   !! [length]
      real(wp) :: weight(3), normal(3)
      integer :: k, a, b

      normal = cross(corner(:, 2) - corner(:, 1), corner(:, 3) - corner(:, 1))
      do k = 1, 3
         a = 1 + mod(k, 3)
         b = 1 + mod(k + 1, 3)
         weight(k) = dot_product(cross(corner(:, a) - x, corner(:, b) - x), normal)
      end do
      weight = weight/sum(weight)
   end function shares
end module xmpm_opening
