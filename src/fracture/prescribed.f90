!> Fronts that go as the deck says, whatever the load: a speed, or a table of the way over time.
module xmpm_prescribed
   use xmpm_kinds, only: wp
   use xmpm_speed_law, only: speed_law_t, tip_t
   implicit none
   private

   public :: prescribed_t, prescribed_speed

   !> The way of every front point over time: linear between the rows, at rest before the first
   !> and, with `speed` zero, after the last.
   type, extends(speed_law_t) :: prescribed_t
      real(wp), allocatable :: time(:)   !! (n) rising [time]
      real(wp), allocatable :: way(:)    !! (n) never falling [length]
      real(wp) :: speed = 0.0_wp         !! after the last row [length/time]
   contains
      procedure :: advance => advance_as_told
   end type prescribed_t

contains

   !> A law with one speed from a time on.
   pure function prescribed_speed(speed, start) result(law)
      real(wp), intent(in) :: speed   !! [length/time]
      real(wp), intent(in) :: start   !! [time]
      type(prescribed_t) :: law

      law%needs_intensity = .false.
      law%needs_toughness = .false.
      law%time = [start]
      law%way = [0.0_wp]
      law%speed = speed
   end function prescribed_speed

   !> Length of a step: the difference of the way, so that the table is met at every time.
   pure function advance_as_told(law, tip) result(length)
      class(prescribed_t), intent(in) :: law
      type(tip_t), intent(in) :: tip   !! the front point
      real(wp) :: length               !! [length]

      length = way_at(law, tip%time + tip%dt) - way_at(law, tip%time)
   end function advance_as_told

   pure function way_at(law, t) result(way)
      type(prescribed_t), intent(in) :: law
      real(wp), intent(in) :: t
      real(wp) :: way
      integer :: i, n

      n = size(law%time)
      way = law%way(1)
      if (t <= law%time(1)) return
      way = law%way(n) + law%speed*max(0.0_wp, t - law%time(n))
      do i = 2, n
         if (t >= law%time(i)) cycle
         way = law%way(i - 1) + (law%way(i) - law%way(i - 1))*(t - law%time(i - 1)) &
            /(law%time(i) - law%time(i - 1))
         return
      end do
   end function way_at
end module xmpm_prescribed
