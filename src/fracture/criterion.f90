!> What growth asks of a criterion: the direction in which a front point grows, and the intensity
!> that is held against the toughness. A new criterion is one file that extends criterion_t.
module xmpm_criterion
   use xmpm_kinds, only: wp
   implicit none
   private

   public :: criterion_t, steepest_kink

   !> Kink angle under pure mode II, the largest there is: 2 atan(1/sqrt(2)), 70.53 degrees [rad].
   real(wp), parameter :: steepest_kink = 1.2309594173407747_wp

   !> A criterion of growth.
   type, abstract :: criterion_t
   contains
      procedure(judge_i), deferred :: judge
   end type criterion_t

   abstract interface
      !> Direction and intensity at one front point.
      pure subroutine judge_i(criterion, k, kink, twist, intensity)
         import :: criterion_t, wp
         class(criterion_t), intent(in) :: criterion
         real(wp), intent(in) :: k(3)          !! stress intensity factors, modes I II III
                                               !! [stress sqrt(length)]
         real(wp), intent(out) :: kink         !! about e3, positive towards e2 [rad]
         real(wp), intent(out) :: twist        !! of the new face about the kinked direction [rad]
         real(wp), intent(out) :: intensity    !! K*, to be held against the toughness, never
                                               !! negative [stress sqrt(length)]
      end subroutine judge_i
   end interface
end module xmpm_criterion
