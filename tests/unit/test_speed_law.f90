!> Speed laws: eq. 59 and 60, constant toughness, tables, prescribed ways.
program test_speed_law
   use xmpm_kinds, only: wp
   use xmpm_speed_law, only: speed_law_t, tip_t
   use xmpm_running_toughness, only: running_toughness_t
   use xmpm_constant_toughness, only: constant_toughness_t
   use xmpm_toughness_table, only: toughness_table_t
   use xmpm_prescribed, only: prescribed_t, prescribed_speed
   use testing, only: suite_t, check, check_close, finish
   implicit none
   type(suite_t) :: suite
   real(wp), parameter :: tight = 1.0e-14_wp   ! a few roundings

   suite%name = 'speed_law'
   call running()
   call constant()
   call by_table()
   call prescribed()
   call finish(suite)

contains

   pure function point(intensity, speed) result(tip)
      real(wp), intent(in) :: intensity, speed
      type(tip_t) :: tip

      tip = tip_t(intensity, 20.0_wp, 3000.0_wp, 6000.0_wp, speed, 0.0_wp, 1.0e-6_wp)
   end function point

   !> At the speed of eq. 60 the toughness of eq. 59 is K*.
   subroutine running()
      type(running_toughness_t) :: law
      real(wp) :: c

      call check_close(suite, 'below the toughness nothing moves', law%advance(point(19.9_wp, &
         0.0_wp)), 0.0_wp, 0.0_wp, 0.0_wp)
      call check_close(suite, 'at the toughness nothing moves', law%advance(point(20.0_wp, &
         0.0_wp)), 0.0_wp, 0.0_wp, 0.0_wp)
      call check_close(suite, 'twice the toughness gives half the Rayleigh speed', &
         law%advance(point(40.0_wp, 0.0_wp)), 1.5e-3_wp, 0.0_wp, tight)
      c = law%advance(point(31.0_wp, 0.0_wp))*1.0e6_wp
      call check_close(suite, 'K_ID at the speed is K*', 20/(1 - c/3000), 31.0_wp, 0.0_wp, tight)
      call check(suite, 'no load is faster than the Rayleigh wave', law%advance(point(1e30_wp, &
         0.0_wp)) <= 3.0e-3_wp)
   end subroutine running

   !> The new speed has k(C) K*/k(V) = K_IC; the law is at rest with itself at that speed.
   subroutine constant()
      type(constant_toughness_t) :: law
      real(wp) :: c, k

      call check_close(suite, 'constant: below the toughness nothing moves', &
         law%advance(point(19.9_wp, 0.0_wp)), 0.0_wp, 0.0_wp, 0.0_wp)
      c = law%advance(point(40.0_wp, 0.0_wp))*1.0e6_wp
      k = (1 - c/3000)/sqrt(1 - c/6000)
      ! 60 halvings of an interval of the Rayleigh speed leave rounding
      call check_close(suite, 'constant: K of the running crack is K_IC', 40*k, 20.0_wp, 0.0_wp, &
         1.0e-13_wp)
      call check_close(suite, 'constant: once K* is K_IC the speed stays', &
         law%advance(point(20.0_wp, c))*1.0e6_wp, c, 0.0_wp, 1.0e-12_wp)
   end subroutine constant

   !> Linear between the rows, none below the first, the last speed beyond.
   subroutine by_table()
      type(toughness_table_t) :: law

      law%speed = [0.0_wp, 400.0_wp, 1000.0_wp]
      law%toughness = [20.0_wp, 25.0_wp, 50.0_wp]
      call check_close(suite, 'table: below its first row nothing moves', &
         law%advance(point(20.0_wp, 0.0_wp)), 0.0_wp, 0.0_wp, 0.0_wp)
      call check_close(suite, 'table: a row is met', law%advance(point(25.0_wp, 0.0_wp)), &
         400e-6_wp, 0.0_wp, tight)
      call check_close(suite, 'table: between two rows it is linear', law%advance(point(30.0_wp, &
         0.0_wp)), 520e-6_wp, 0.0_wp, tight)
      call check_close(suite, 'table: its last speed is the largest', law%advance(point(80.0_wp, &
         0.0_wp)), 1000e-6_wp, 0.0_wp, tight)
   end subroutine by_table

   !> Steps of any length add up to the way that is told.
   subroutine prescribed()
      type(prescribed_t) :: law
      type(tip_t) :: tip
      real(wp) :: way
      integer :: i

      law = prescribed_speed(500.0_wp, 2.0_wp)
      call check(suite, 'a prescribed front needs no K and no toughness', &
         .not. (law%needs_intensity .or. law%needs_toughness))
      tip%time = 1.5_wp
      tip%dt = 1.0_wp
      call check_close(suite, 'a step over the start counts from the start', law%advance(tip), &
         250.0_wp, 0.0_wp, tight)
      law%time = [1.0_wp, 2.0_wp, 4.0_wp]
      law%way = [0.0_wp, 3.0_wp, 4.0_wp]
      law%speed = 0
      tip = tip_t()
      way = 0
      do i = 1, 50
         tip%dt = 0.1_wp + 0.05_wp*sin(real(i, wp))
         way = way + law%advance(tip)
         tip%time = tip%time + tip%dt
         if (i == 20) call check_close(suite, 'a table is met at every time', way, &
            3 + (tip%time - 2)/2, 0.0_wp, 1.0e-13_wp)
      end do
      call check_close(suite, 'after a table nothing moves', way, 4.0_wp, 0.0_wp, 1.0e-13_wp)
   end subroutine prescribed
end program test_speed_law
