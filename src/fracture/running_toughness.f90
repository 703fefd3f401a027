!> The speed at which K* equals the toughness of a running crack (eq. 59 and 60 of the paper).
module xmpm_running_toughness
   use xmpm_kinds, only: wp
   use xmpm_speed_law, only: speed_law_t, tip_t
   implicit none
   private

   public :: running_toughness_t

   !> K_ID(C) = K_IC/(1 - C/C_R), so that C = C_R (1 - K_IC/K*) where K* > K_IC, else 0.
   type, extends(speed_law_t) :: running_toughness_t
   contains
      procedure :: advance => advance_running
   end type running_toughness_t

contains

   !> Length of a step by eq. 60.
   pure function advance_running(law, tip) result(length)
      class(running_toughness_t), intent(in) :: law
      type(tip_t), intent(in) :: tip   !! the front point
      real(wp) :: length               !! [length]

      associate (unused => law)
      end associate
      length = 0.0_wp
      if (tip%intensity <= tip%toughness) return
      length = tip%dt*tip%rayleigh*(1.0_wp - tip%toughness/tip%intensity)
   end function advance_running
end module xmpm_running_toughness
