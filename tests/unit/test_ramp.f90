!> The jump function: its values, its slope, its two sides.
program test_ramp
   use xmpm_kinds, only: wp
   use xmpm_front, only: fully_cracked, beyond_reach
   use xmpm_ramp, only: jump_weight, jump_slope, sharp_jump
   use testing, only: suite_t, check, check_close, finish
   implicit none
   type(suite_t) :: suite
   real(wp), parameter :: h = 0.25_wp, ramp = 0.5_wp, last = 0.4_wp, step = 1.0e-6_wp
   real(wp) :: phi, quotient, worst
   integer :: i

   suite%name = 'ramp'
   call check(suite, 'the sharp H is 1 on the plus side, else -1, also on the surface', &
      all(abs(sharp_jump([2.0_wp, 0.0_wp, -0.0_wp, -1.0e-300_wp]) - [1.0_wp, -1.0_wp, -1.0_wp, &
      -1.0_wp]) <= 0.0_wp))
   ! products and quotients of short decimals: rounding
   call check_close(suite, 'H is half way in the middle of the ramp', &
      jump_weight(1.0_wp, 0.15_wp*h, ramp, last, h), 0.5_wp, 1.0e-15_wp, 0.0_wp)
   call check(suite, 'H is whole behind the ramp and nothing ahead of it', &
      all(abs(jump_weight([1.0_wp, -1.0_wp, 1.0_wp], [-0.11_wp, -0.2_wp, 0.41_wp]*h, ramp, last, &
      h) &
      - [1.0_wp, -1.0_wp, 0.0_wp]) <= 0.0_wp))
   call check(suite, 'H is sharp where there is no front and nothing beyond reach', &
      all(abs(jump_weight([1.0_wp, 0.0_wp, 1.0_wp], [fully_cracked, fully_cracked, beyond_reach], &
      ramp, last, h) - [1.0_wp, -1.0_wp, 0.0_wp]) <= 0.0_wp))
   worst = 0.0_wp
   do i = -50, 50
      phi = 0.02_wp*real(i, wp)*h + 0.001_wp*h
      quotient = (jump_weight(1.0_wp, phi + step*h, ramp, last, h) &
         - jump_weight(1.0_wp, phi - step*h, ramp, last, h))/(2.0_wp*step*h)
      worst = max(worst, abs(quotient - jump_slope(1.0_wp, phi, ramp, last, h)), &
         abs(jump_slope(1.0_wp, phi, ramp, last, h) + jump_slope(0.0_wp, phi, ramp, last, h)))
   end do
   ! rounding of 1e-16 over a step of 2.5e-7; the function is linear, so the quotient has no other
   ! error
   call check_close(suite, 'the slope is the difference quotient of H, opposite on the sides', &
      worst, &
      0.0_wp, 1.0e-8_wp, 0.0_wp)
   call finish(suite)
end program test_ramp
