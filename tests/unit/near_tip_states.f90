!> The unit states of xmpm_near_tip at single places, for tests.
module near_tip_states
   use xmpm_kinds, only: wp
   use xmpm_near_tip, only: unit_states
   implicit none
   private

   public :: near_tip_fields, line_force_field

contains

   !> Stress, 11 22 33 12 23 13, and u_i,1 of modes I, II and III.
   pure subroutine near_tip_fields(x1, x2, side, mu, poisson, stress, gradient)
      real(wp), intent(in) :: x1, x2, side, mu, poisson
      real(wp), intent(out) :: stress(6, 3), gradient(3, 3)
      real(wp) :: plane(1, 6, 3), shear(1, 3)
      integer :: k

      call unit_states(1, [x1], [x2], [side], [mu], [poisson], plane, shear)
      stress = 0
      gradient = 0
      do k = 1, 2
         stress(:4, k) = plane(1, :4, k)
         gradient(:2, k) = plane(1, 5:, k)
      end do
      stress(5:, 3) = shear(1, :2)
      gradient(3, 3) = shear(1, 3)
   end subroutine near_tip_fields

   !> Those of a unit line force.
   pure subroutine line_force_field(x1, x2, mu, poisson, stress, slope)
      real(wp), intent(in) :: x1, x2, mu, poisson
      real(wp), intent(out) :: stress(6), slope(3)
      real(wp) :: plane(1, 6, 3), shear(1, 3)

      call unit_states(1, [x1], [x2], [1.0_wp], [mu], [poisson], plane, shear)
      stress = [plane(1, :4, 3), 0.0_wp, 0.0_wp]
      slope = [plane(1, 5:, 3), 0.0_wp]
   end subroutine line_force_field
end module near_tip_states
