!> The jump function H of a crack: a sign, or a sign that fades over a ramp at the front.
!>
!> u_p = sum N_I ((1 + H)/2 u+_I + (1 - H)/2 u-_I), so that its gradient has a part N_I grad H
!> beside H grad N_I.
module xmpm_ramp
   use xmpm_kinds, only: wp
   implicit none
   private

   public :: jump_weight, sharp_jump

contains

   !> Graded H = sign(psi) clamp((ramp_end - phi)/ramp, 0, 1) and its gradient.
   pure subroutine jump_weight(psi, phi, e1, ramp, ramp_end, weight, slope)
      real(wp), intent(in) :: psi         !! signed distance to the surface, or a side (1 or -1)
      real(wp), intent(in) :: phi         !! signed distance to the front [length]
      real(wp), intent(in) :: e1(3)       !! gradient of phi
      real(wp), intent(in) :: ramp        !! length of the ramp [length]
      real(wp), intent(in) :: ramp_end    !! phi where H has become 0 [length]
      real(wp), intent(out) :: weight     !! H, -1 to 1
      real(wp), intent(out) :: slope(3)   !! gradient of H, 0 outside the ramp [1/length]

      slope = 0.0_wp
      weight = sharp_jump(psi)
      if (phi <= ramp_end - ramp) return
      if (phi >= ramp_end) then
         weight = 0.0_wp
      else
         slope = -weight/ramp*e1
         weight = weight*(ramp_end - phi)/ramp
      end if
   end subroutine jump_weight

   !> Sharp H: 1 on the plus side, -1 on the minus side and on the surface itself (eq. 18 of the
   !> paper).
   elemental function sharp_jump(psi) result(weight)
      real(wp), intent(in) :: psi   !! signed distance to the surface [length]
      real(wp) :: weight            !! 1 or -1

      weight = merge(1.0_wp, -1.0_wp, psi > 0.0_wp)
   end function sharp_jump
end module xmpm_ramp
