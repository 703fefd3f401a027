!> The jump function: its values, its gradient, its two sides.
program test_ramp
   use xmpm_kinds, only: wp
   use xmpm_front, only: fully_cracked, beyond_reach
   use xmpm_ramp, only: jump_weight, sharp_jump
   use testing, only: suite_t, check, check_close, finish
   implicit none
   type(suite_t) :: suite
   real(wp), parameter :: h = 0.25_wp, ramp = 0.5_wp*h, last = 0.4_wp*h, step = 1.0e-6_wp*h
   real(wp), parameter :: e1(3) = [0.6_wp, 0.0_wp, -0.8_wp]

   suite%name = 'ramp'
   call check(suite, 'the sharp H is 1 on the plus side, else -1, also on the surface', &
      all(abs(sharp_jump([2.0_wp, 0.0_wp, -0.0_wp, -1.0e-300_wp]) &
      - [1.0_wp, -1.0_wp, -1.0_wp, -1.0_wp]) <= 0.0_wp))
   ! products and quotients of short decimals: rounding
   call check_close(suite, 'H is half way in the middle of the ramp', &
      weight_at(1.0_wp, 0.15_wp*h), 0.5_wp, 1.0e-15_wp, 0.0_wp)
   call check_close(suite, 'H is whole behind the ramp', weight_at(1.0_wp, -0.11_wp*h), 1.0_wp, &
      0.0_wp, 0.0_wp)
   call check_close(suite, 'the surface itself is minus', weight_at(0.0_wp, -0.2_wp*h), -1.0_wp, &
      0.0_wp, 0.0_wp)
   call check_close(suite, 'H is nothing ahead of the ramp', weight_at(-1.0_wp, 0.41_wp*h), &
      0.0_wp, &
      0.0_wp, 0.0_wp)
   call check_close(suite, 'H is sharp where there is no front', weight_at(-1.0_wp, &
      fully_cracked), &
      -1.0_wp, 0.0_wp, 0.0_wp)
   call check_close(suite, 'H is nothing beyond reach', weight_at(1.0_wp, beyond_reach), 0.0_wp, &
      0.0_wp, 0.0_wp)
   call gradients()
   call finish(suite)

contains

   function weight_at(psi, phi) result(weight)
      real(wp), intent(in) :: psi, phi
      real(wp) :: weight, slope(3)

      call jump_weight(psi, phi, e1, ramp, last, weight, slope)
   end function weight_at

   !> Along e1 phi grows by the way gone; the gradient is the difference quotient.
   subroutine gradients()
      real(wp) :: phi, quotient, worst, weight, slope(3), other(3)
      integer :: i

      worst = 0.0_wp
      do i = -50, 50
         phi = 0.02_wp*real(i, wp)*h + 0.001_wp*h
         quotient = (weight_at(1.0_wp, phi + step) - weight_at(1.0_wp, phi - step))/(2.0_wp*step)
         call jump_weight(1.0_wp, phi, e1, ramp, last, weight, slope)
         call jump_weight(-1.0_wp, phi, e1, ramp, last, weight, other)
         worst = max(worst, norm2(slope - quotient*e1), norm2(slope + other))
      end do
      ! rounding of 1e-16 over a step of 2.5e-7; H is linear, so the quotient has no other error
      call check_close(suite, &
         'the gradient is the difference quotient of H, opposite on the sides', &
         worst, 0.0_wp, 1.0e-8_wp, 0.0_wp)
   end subroutine gradients
end program test_ramp
