!> Curves of time: values, integrals and messages.
program test_curves
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_curves, only: curve_t, step_curve, make_ramp, make_table, curve_value, curve_integral
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   real(wp), parameter :: rounding = 1.0e-14_wp   !! all values here are of size 1

   suite%name = 'curves'
   call test_step()
   call test_ramp()
   call test_table()
   call test_integrals()
   call test_messages()
   call finish(suite)

contains

   subroutine test_step()
      type(curve_t) :: curve

      call check_close(suite, 'no curve is 1', curve_value(curve, -3.0_wp), 1.0_wp, 0.0_wp, 0.0_wp)
      curve = step_curve(2.0_wp)
      call check_close(suite, 'a step is 0 before', curve_value(curve, 1.999_wp), 0.0_wp, 0.0_wp, &
         0.0_wp)
      call check_close(suite, 'a step is 1 at its start', curve_value(curve, 2.0_wp), 1.0_wp, &
         0.0_wp, 0.0_wp)
      call check_close(suite, 'a step is 1 after', curve_value(curve, 9.0_wp), 1.0_wp, 0.0_wp, &
         0.0_wp)
   end subroutine test_step

   subroutine test_ramp()
      type(curve_t) :: curve
      type(error_t), allocatable :: error

      call make_ramp(curve, 4.0_wp, 1.0_wp, error)
      call check_no_error(suite, 'a ramp is accepted', error)
      call check_close(suite, 'a ramp is 0 before', curve_value(curve, 0.5_wp), 0.0_wp, 0.0_wp, &
         0.0_wp)
      call check_close(suite, 'a ramp is half way up', curve_value(curve, 3.0_wp), 0.5_wp, &
         rounding, 0.0_wp)
      call check_close(suite, 'a ramp stays at 1', curve_value(curve, 7.0_wp), 1.0_wp, rounding, &
         0.0_wp)
   end subroutine test_ramp

   subroutine test_table()
      type(curve_t) :: curve
      type(error_t), allocatable :: error

      call make_table(curve, [1.0_wp, 5.0_wp, 2.0_wp, -1.0_wp, 4.0_wp, 3.0_wp], 10.0_wp, error)
      call check_no_error(suite, 'a table is accepted', error)
      call check_close(suite, 'constant before', curve_value(curve, 0.0_wp), 5.0_wp, rounding, &
         0.0_wp)
      call check_close(suite, 'exact at a point', curve_value(curve, 12.0_wp), -1.0_wp, rounding, &
         0.0_wp)
      call check_close(suite, 'linear between', curve_value(curve, 13.0_wp), 1.0_wp, rounding, &
         0.0_wp)
      call check_close(suite, 'constant after', curve_value(curve, 20.0_wp), 3.0_wp, rounding, &
         0.0_wp)
      call make_table(curve, [1.0_wp, 5.0_wp], 0.0_wp, error)
      call check_close(suite, 'one pair is a constant', curve_value(curve, -2.0_wp), 5.0_wp, &
         rounding, 0.0_wp)
   end subroutine test_table

   !> The integral is that of the trapezoidal rule on fine steps, exact where these meet the points.
   subroutine test_integrals()
      type(curve_t) :: curve
      type(error_t), allocatable :: error

      call check_close(suite, 'integral of no curve', curve_integral(curve, 1.0_wp, 4.0_wp), &
         3.0_wp, &
         rounding, 0.0_wp)
      call check_close(suite, 'integral of a step', &
         curve_integral(step_curve(2.0_wp), 0.0_wp, 5.0_wp), &
         3.0_wp, rounding, 0.0_wp)
      call check_close(suite, 'integral before a step', &
         curve_integral(step_curve(2.0_wp), 0.0_wp, 1.0_wp), 0.0_wp, 0.0_wp, 0.0_wp)
      call make_ramp(curve, 4.0_wp, 1.0_wp, error)
      call check_close(suite, 'integral of a ramp', curve_integral(curve, 0.0_wp, 6.0_wp), 3.0_wp, &
         rounding, 0.0_wp)
      call make_table(curve, [1.0_wp, 5.0_wp, 2.0_wp, -1.0_wp, 4.0_wp, 3.0_wp], 0.0_wp, error)
      call check_close(suite, 'integral of a table', curve_integral(curve, -1.0_wp, 6.0_wp), &
         trapezoids(curve, -1.0_wp, 6.0_wp), 1.0e-12_wp, 0.0_wp)   ! sum of 700 rounded terms
      call check_close(suite, 'integrals add up', curve_integral(curve, 0.3_wp, 1.7_wp) + &
         curve_integral(curve, 1.7_wp, 3.1_wp), curve_integral(curve, 0.3_wp, 3.1_wp), &
         10*rounding, 0.0_wp)
   end subroutine test_integrals

   function trapezoids(curve, from, to) result(total)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: from, to
      real(wp) :: total, dt
      integer :: i

      dt = (to - from)/700
      total = 0.0_wp
      do i = 1, 700
         total = total + 0.5_wp*dt*(curve_value(curve, from + real(i - 1, wp)*dt) + &
            curve_value(curve, from + real(i, wp)*dt))
      end do
   end function trapezoids

   subroutine test_messages()
      type(curve_t) :: curve
      type(error_t), allocatable :: error

      call make_ramp(curve, 0.0_wp, 1.0_wp, error)
      call check_error(suite, 'a ramp without rise', error, &
         'a ramp has rise = 0; it must be positive')
      call make_ramp(curve, -1.0_wp, 1.0_wp, error)
      call check_error(suite, 'a ramp that falls', error, &
         'a ramp has rise = -1; it must be positive')
      call make_table(curve, [1.0_wp, 2.0_wp, 3.0_wp], 0.0_wp, error)
      call check_error(suite, 'an odd count', error, &
         'a table takes pairs t1 f1 t2 f2 ..., 3 numbers')
      call make_table(curve, [real(wp) ::], 0.0_wp, error)
      call check_error(suite, 'an empty table', error, &
         'a table takes pairs t1 f1 t2 f2 ..., 0 numbers')
      call make_table(curve, [0.0_wp, 1.0_wp, 0.0_wp, 2.0_wp], 0.0_wp, error)
      call check_error(suite, 'times that stand still', error, &
         'the times of a table must increase, but 0 follows 0')
      call make_table(curve, [0.0_wp, 1.0_wp, 3.0_wp, 2.0_wp, 2.5_wp, 0.0_wp], 0.0_wp, error)
      call check_error(suite, 'times that run back', error, 'but 2.5 follows 3')
      call make_table(curve, [0.0_wp, ieee_value(0.0_wp, ieee_quiet_nan)], 0.0_wp, error)
      call check_error(suite, 'not a number', error, 'a table holds a number that is not finite')
   end subroutine test_messages
end program test_curves
