!> The fall from 1 to 0 along a cosine.
program test_cosine_fall
   use xmpm_kinds, only: wp, pi
   use xmpm_cosine_fall, only: cosine_fall
   use testing, only: suite_t, check, check_close, finish
   implicit none
   integer, parameter :: n = 1001
   type(suite_t) :: suite
   real(wp) :: t(n), f(n), slope(n)
   integer :: i

   suite%name = 'cosine_fall'
   t = [(real(i, wp)/n, i=0, n - 1)]
   call cosine_fall(n, t, f, slope)
   ! series to the last digit
   call check_close(suite, 'it is that of the intrinsic', maxval(abs(f - 0.5_wp*(1 + cos(pi*t)))), &
      0.0_wp, 5e-16_wp, 0.0_wp)
   call check_close(suite, 'and so is its slope', maxval(abs(slope + 0.5_wp*pi*sin(pi*t))), &
      0.0_wp, 2e-15_wp, 0.0_wp)
   t(:4) = [-7.0_wp, 0.0_wp, 1.0_wp, 7.0_wp]
   call cosine_fall(4, t(:4), f(:4), slope(:4))
   call check(suite, 'it is exactly 1 before 0 and 0 from 1 on', &
      .not. any(abs(f(:4) - [1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp]) > 0))
   call check(suite, 'where it has no slope', .not. any(abs(slope(:4)) > 0))
   call finish(suite)
end program test_cosine_fall
