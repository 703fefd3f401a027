!> What growth asks of a speed law: how far a front point goes in a step. A new law is one file
!> that extends speed_law_t.
module xmpm_speed_law
   use xmpm_kinds, only: wp
   implicit none
   private

   public :: speed_law_t, tip_t

   !> What is known of a front point when it is asked how far it goes.
   type :: tip_t
      real(wp) :: intensity = 0.0_wp     !! K* of the criterion, filtered [stress sqrt(length)]
      real(wp) :: toughness = 0.0_wp     !! K_IC at the point [stress sqrt(length)]
      real(wp) :: rayleigh = 0.0_wp      !! Rayleigh wave speed there [length/time]
      real(wp) :: dilatational = 0.0_wp  !! dilatational wave speed there [length/time]
      real(wp) :: speed = 0.0_wp         !! of the point in the step before [length/time]
      real(wp) :: time = 0.0_wp          !! at the start of the step [time]
      real(wp) :: dt = 0.0_wp            !! the step [time]
   end type tip_t

   !> A law of the front's speed.
   type, abstract :: speed_law_t
      logical :: needs_intensity = .true.   !! whether K must be known
      logical :: needs_toughness = .true.   !! whether K_IC must be known
   contains
      procedure(advance_i), deferred :: advance
   end type speed_law_t

   abstract interface
      !> How far a front point goes in a step [length].
      pure function advance_i(law, tip) result(length)
         import :: speed_law_t, tip_t, wp
         class(speed_law_t), intent(in) :: law
         type(tip_t), intent(in) :: tip
         real(wp) :: length
      end function advance_i
   end interface
end module xmpm_speed_law
