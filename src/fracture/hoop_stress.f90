!> The criterion of the maximum hoop stress (Erdogan and Sih 1963; eq. 57 and 58 of the paper).
module xmpm_hoop_stress
   use xmpm_kinds, only: wp
   use xmpm_criterion, only: criterion_t
   implicit none
   private

   public :: hoop_stress_t, hoop_angle

   !> Growth along the largest hoop stress; mode III does not count.
   type, extends(criterion_t) :: hoop_stress_t
   contains
      procedure :: judge => judge_hoop_stress
   end type hoop_stress_t

contains

   !> Kink angle and K* = cos(t/2)**3 K_I - 3/2 cos(t/2) sin(t) K_II (eq. 58).
   pure subroutine judge_hoop_stress(criterion, k, kink, twist, intensity)
      class(hoop_stress_t), intent(in) :: criterion
      real(wp), intent(in) :: k(3)         !! modes I II III [stress sqrt(length)]
      real(wp), intent(out) :: kink        !! positive towards e2 [rad]
      real(wp), intent(out) :: twist       !! none
      real(wp), intent(out) :: intensity   !! K* [stress sqrt(length)]

      associate (unused => criterion)
      end associate
      kink = hoop_angle(k(1), k(2))
      twist = 0.0_wp
      intensity = cos(0.5_wp*kink)**3*max(k(1), 0.0_wp) &
         - 1.5_wp*cos(0.5_wp*kink)*sin(kink)*k(2)
   end subroutine judge_hoop_stress

   !> Angle of the largest hoop stress, in a form without 0/0 and with the right branch.
   !>
   !> theta = 2 atan2(-2 K_II, K_I + sqrt(K_I**2 + 8 K_II**2)) with K_I = max(K_I, 0); 0 where both
   !> vanish, at most 70.53 degrees.
   elemental function hoop_angle(k1, k2) result(theta)
      real(wp), intent(in) :: k1   !! K_I [stress sqrt(length)]
      real(wp), intent(in) :: k2   !! K_II [stress sqrt(length)]
      real(wp) :: theta            !! positive towards e2 [rad]
      real(wp) :: scale, a, b

      scale = max(abs(k1), abs(k2))
      theta = 0.0_wp
      if (.not. scale > 0.0_wp) return
      a = max(k1, 0.0_wp)/scale
      b = k2/scale
      if (abs(b) > 0.0_wp) theta = 2.0_wp*atan2(-2.0_wp*b, a + sqrt(a*a + 8.0_wp*b*b))
   end function hoop_angle
end module xmpm_hoop_stress
