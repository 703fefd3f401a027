!> The speed at which K* equals a toughness K_ID(C) given by a table.
module xmpm_toughness_table
   use xmpm_kinds, only: wp
   use xmpm_speed_law, only: speed_law_t, tip_t
   implicit none
   private

   public :: toughness_table_t

   !> K_ID over C, linear between the rows; at the last speed the table ends, and no crack is
   !> faster.
   type, extends(speed_law_t) :: toughness_table_t
      real(wp), allocatable :: speed(:)       !! (n) rising from 0 [length/time]
      real(wp), allocatable :: toughness(:)   !! (n) K_ID, rising [stress sqrt(length)]
   contains
      procedure :: advance => advance_by_table
   end type toughness_table_t

contains

   !> Length of a step: none below the first toughness.
   pure function advance_by_table(law, tip) result(length)
      class(toughness_table_t), intent(in) :: law
      type(tip_t), intent(in) :: tip   !! the front point
      real(wp) :: length               !! [length]
      integer :: i, n

      n = size(law%speed)
      length = 0.0_wp
      if (tip%intensity <= law%toughness(1)) return
      length = tip%dt*law%speed(n)
      do i = 2, n
         if (tip%intensity >= law%toughness(i)) cycle
         length = tip%dt*(law%speed(i - 1) + (law%speed(i) - law%speed(i - 1)) &
            *(tip%intensity - law%toughness(i - 1))/(law%toughness(i) - law%toughness(i - 1)))
         return
      end do
   end function advance_by_table
end module xmpm_toughness_table
