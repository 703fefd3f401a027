!> Growth straight ahead in the plane of the crack, whatever the modes: a weak plane.
module xmpm_straight
   use xmpm_kinds, only: wp
   use xmpm_criterion, only: criterion_t
   implicit none
   private

   public :: straight_t

   !> Growth without a kink; the intensity is that of mode I with the same energy release rate.
   type, extends(criterion_t) :: straight_t
      real(wp) :: poisson = 0.0_wp   !! Poisson's ratio of the material
   contains
      procedure :: judge => judge_straight
   end type straight_t

contains

   !> No kink; K* = sqrt(K_I**2 + K_II**2 + K_III**2/(1 - nu)), K_I = max(K_I, 0).
   pure subroutine judge_straight(criterion, k, kink, twist, intensity)
      class(straight_t), intent(in) :: criterion
      real(wp), intent(in) :: k(3)         !! modes I II III [stress sqrt(length)]
      real(wp), intent(out) :: kink        !! none
      real(wp), intent(out) :: twist       !! none
      real(wp), intent(out) :: intensity   !! [stress sqrt(length)]

      kink = 0.0_wp
      twist = 0.0_wp
      intensity = norm2([max(k(1), 0.0_wp), k(2), k(3)/sqrt(1.0_wp - criterion%poisson)])
   end subroutine judge_straight
end module xmpm_straight
