!> The domain integral of J on particles that carry the exact field of a front that moves: 8 in a
!> cell of size 1, the front off the lattice.
program test_running_front
   use xmpm_kinds, only: wp, pi
   use near_tip_states, only: near_tip_fields
   use xmpm_velocity_functions, only: elastic_constants_t, elastic_constants
   use exact_errors, only: running_k, worst_places, lambda, mu, density
   use running_tip, only: tip_at
   use testing, only: suite_t, check_close, finish
   implicit none
   real(wp), parameter :: radii(3) = [3.0_wp, 4.0_wp, 5.0_wp]
   real(wp), parameter :: most(3) = [0.008_wp, 0.005_wp, 0.005_wp]   !! errors of K
   type(suite_t) :: suite
   type(elastic_constants_t) :: e

   suite%name = 'running_front'
   e = elastic_constants(lambda, mu, density)
   call check_field()
   call runs(0.0_wp)
   call runs(0.3_wp)
   call runs(0.6_wp)
   call finish(suite)

contains

   !> Tractions, intensity and opening of the field itself.
   subroutine check_field()
      real(wp) :: gradient(3, 3), s(6), second(3), g(3, 3), unit(6, 3)

      call tip_at(0.5_wp, 0.0_wp, 0.6_wp*e%rayleigh, lambda, mu, density, gradient, s, second)
      call check_close(suite, 'K_I of the field', s(2)*sqrt(pi), 1.0_wp, 1e-13_wp, 0.0_wp)
      call tip_at(-0.5_wp, 1e-12_wp, 0.6_wp*e%rayleigh, lambda, mu, density, gradient, s, second)
      call check_close(suite, 'traction on the face', maxval(abs(s([2, 4]))), 0.0_wp, 1e-11_wp, &
         0.0_wp)
      call tip_at(-0.3_wp, 0.4_wp, 1e-3_wp*e%rayleigh, lambda, mu, density, gradient, s, second)
      call near_tip_fields(-0.3_wp, 0.4_wp, 1.0_wp, mu, e%poisson, unit, g)
      ! the square of the speed
      call check_close(suite, 'the field at rest', maxval(abs(s - unit(:, 1))), 0.0_wp, 1e-5_wp, &
         0.0_wp)
   end subroutine check_field

   !> J to K within 0.8 % at 3 h and 0.5 % at 4 h and 5 h, the aims for quadrature alone, wherever
   !> the front lies in its cell and however the body flies.
   subroutine runs(part)
      real(wp), intent(in) :: part   !! speed over the Rayleigh speed
      character(len=4) :: at
      real(wp) :: k(3, size(worst_places, 2)), flying(3)
      integer :: i

      write (at, '(f4.1)') part
      do i = 1, size(k, 2)
         call running_k(part, worst_places(:, i), [0.0_wp, 0.0_wp, 0.0_wp], radii, k(:, i))
      end do
      ! recorded: the third place is the worst, 0.58, 0.25, 0.14 % at rest and 0.72, 0.29, 0.15 %
      ! at 0.6 c_R
      do i = 1, 3
         call check_close(suite, 'largest K from J at'//at//' c_R', maxval(k(i, :)), 1.0_wp, &
            most(i), 0.0_wp)
         call check_close(suite, 'smallest K from J at'//at//' c_R', minval(k(i, :)), 1.0_wp, &
            most(i), 0.0_wp)
      end do
      call running_k(part, worst_places(:, 1), [0.2_wp, -0.1_wp, 0.3_wp], radii, flying)
      ! rounding: the velocity of the body is taken out again
      call check_close(suite, 'K in a body that flies, at'//at//' c_R', &
         maxval(abs(flying - k(:, 1))), 0.0_wp, 1e-12_wp, 0.0_wp)
   end subroutine runs
end program test_running_front
