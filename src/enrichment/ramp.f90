!> The jump function H of a crack: a sign, or a sign that fades over a ramp at the front.
!>
!> u_p = sum N_I ((1 + H)/2 u+_I + (1 - H)/2 u-_I), so that its gradient has a part N_I grad H
!> beside H grad N_I.
module xmpm_ramp
   use xmpm_kinds, only: wp
   implicit none
   private

   public :: jump_weight, jump_slope, sharp_jump

contains

   !> Graded H = sign(psi) clamp((ramp_end h - phi)/(ramp h), 0, 1).
   elemental function jump_weight(psi, phi, ramp, ramp_end, h) result(weight)
      real(wp), intent(in) :: psi        !! signed distance to the surface [length]
      real(wp), intent(in) :: phi        !! signed distance to the front [length]
      real(wp), intent(in) :: ramp       !! length of the ramp [cells]
      real(wp), intent(in) :: ramp_end   !! phi where H has become 0 [cells]
      real(wp), intent(in) :: h          !! cell size [length]
      real(wp) :: weight                 !! H, -1 to 1

      if (phi >= ramp_end*h) then
         weight = 0.0_wp
      else if (phi <= (ramp_end - ramp)*h) then
         weight = sharp_jump(psi)
      else
         weight = sharp_jump(psi)*(ramp_end*h - phi)/(ramp*h)
      end if
   end function jump_weight

   !> Derivative of the graded H by phi; the gradient of H is this times e1.
   elemental function jump_slope(psi, phi, ramp, ramp_end, h) result(slope)
      real(wp), intent(in) :: psi        !! signed distance to the surface [length]
      real(wp), intent(in) :: phi        !! signed distance to the front [length]
      real(wp), intent(in) :: ramp       !! length of the ramp [cells]
      real(wp), intent(in) :: ramp_end   !! phi where H has become 0 [cells]
      real(wp), intent(in) :: h          !! cell size [length]
      real(wp) :: slope                  !! dH/dphi [1/length]

      slope = 0.0_wp
      if (phi >= ramp_end*h .or. phi <= (ramp_end - ramp)*h) return
      slope = -sharp_jump(psi)/(ramp*h)
   end function jump_slope

   !> Sharp H: 1 on the plus side, -1 on the minus side and on the surface itself (eq. 18 of the
   !> paper).
   elemental function sharp_jump(psi) result(weight)
      real(wp), intent(in) :: psi   !! signed distance to the surface [length]
      real(wp) :: weight            !! 1 or -1

      weight = merge(1.0_wp, -1.0_wp, psi > 0.0_wp)
   end function sharp_jump
end module xmpm_ramp
