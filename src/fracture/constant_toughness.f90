!> The speed at which K* of the running crack equals a toughness that is the same at any speed.
module xmpm_constant_toughness
   use xmpm_kinds, only: wp
   use xmpm_speed_law, only: speed_law_t, tip_t
   implicit none
   private

   public :: constant_toughness_t

   !> K_ID = K_IC. K* was found at the present speed V, so the crack at rest would have K*/k(V),
   !> and the new speed C is that with k(C) K*/k(V) = K_IC; k(C) = (1 - C/C_R)/sqrt(1 - C/C_d)
   !> (Freund 1990, section 6.4, a close fit of the exact function).
   type, extends(speed_law_t) :: constant_toughness_t
   contains
      procedure :: advance => advance_constant
   end type constant_toughness_t

contains

   !> Length of a step.
   pure function advance_constant(law, tip) result(length)
      class(constant_toughness_t), intent(in) :: law
      type(tip_t), intent(in) :: tip   !! the front point
      real(wp) :: length               !! [length]
      real(wp) :: wanted, low, high, c
      integer :: i

      associate (unused => law)
      end associate
      length = 0.0_wp
      if (.not. tip%intensity > 0.0_wp) return
      wanted = universal(tip, min(tip%speed, 0.95_wp*tip%rayleigh))*tip%toughness/tip%intensity
      if (wanted >= 1.0_wp) return
      low = 0.0_wp
      high = tip%rayleigh
      do i = 1, 60
         c = 0.5_wp*(low + high)
         if (universal(tip, c) > wanted) then
            low = c
         else
            high = c
         end if
      end do
      length = tip%dt*c
   end function advance_constant

   pure function universal(tip, c) result(k)
      type(tip_t), intent(in) :: tip
      real(wp), intent(in) :: c
      real(wp) :: k

      k = (1.0_wp - c/tip%rayleigh)/sqrt(1.0_wp - c/tip%dilatational)
   end function universal
end module xmpm_constant_toughness
