!> The domain integral of J on particles that carry the exact field of a front that moves: 8 in a
!> cell of size 1, the front off the lattice.
program test_running_front
   use xmpm_kinds, only: wp, pi
   use xmpm_crack, only: crack_t
   use xmpm_samples, only: sample_t
   use xmpm_front_points, only: front_points_t, list_points, window_length
   use xmpm_domain_integral, only: domain_sums_t, domain_shape_t, sum_domains, clear_sums
   use near_tip_states, only: near_tip_fields
   use xmpm_velocity_functions, only: elastic_constants_t, elastic_constants, velocity_functions, &
      release_rate
   use xmpm_material_drift, only: drift_sums, drift_of
   use exact_cracks, only: make_straight, fill_box, give_running
   use running_tip, only: tip_at
   use testing, only: suite_t, check, check_close, finish
   implicit none
   real(wp), parameter :: lambda = 1.5_wp, mu = 1.0_wp, density = 1.3_wp
   real(wp), parameter :: radii(3) = [3.0_wp, 4.0_wp, 5.0_wp]
   real(wp), parameter :: most(3) = [0.008_wp, 0.005_wp, 0.005_wp]   !! errors of K
   real(wp), parameter :: places(2, 5) = reshape([0.137_wp, 0.0831_wp, 0.0_wp, 0.0_wp, &
      0.25_wp, 0.27_wp, 0.4_wp, 0.1_wp, 0.31_wp, 0.44_wp], [2, 5])   !! x, z of the front
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
      real(wp) :: k(3, size(places, 2)), flying(3)
      integer :: i

      write (at, '(f4.1)') part
      do i = 1, size(places, 2)
         call measure(part*e%rayleigh, places(:, i), [0.0_wp, 0.0_wp, 0.0_wp], k(:, i))
      end do
      ! recorded: the third place is the worst, 0.58, 0.25, 0.14 % at rest and 0.72, 0.29, 0.15 %
      ! at 0.6 c_R
      do i = 1, 3
         call check_close(suite, 'largest K from J at'//at//' c_R', maxval(k(i, :)), 1.0_wp, &
            most(i), 0.0_wp)
         call check_close(suite, 'smallest K from J at'//at//' c_R', minval(k(i, :)), 1.0_wp, &
            most(i), 0.0_wp)
      end do
      call measure(part*e%rayleigh, places(:, 1), [0.2_wp, -0.1_wp, 0.3_wp], flying)
      ! rounding: the velocity of the body is taken out again
      call check_close(suite, 'K in a body that flies, at'//at//' c_R', &
         maxval(abs(flying - k(:, 1))), 0.0_wp, 1e-12_wp, 0.0_wp)
   end subroutine runs

   !> K over the exact one at the middle of a straight front.
   subroutine measure(speed, place, flight, k)
      real(wp), intent(in) :: speed, place(2), flight(3)
      real(wp), intent(out) :: k(3)
      type(crack_t) :: crack
      type(front_points_t) :: points
      type(domain_shape_t) :: shape
      type(domain_sums_t) :: sums
      type(sample_t), allocatable :: samples(:)
      real(wp), allocatable :: speeds(:)
      real(wp) :: tip(3)
      integer :: i

      tip = [place(1), 0.1_wp, place(2)]
      call make_straight(tip, 8.0_wp, 12.0_wp, 1.0_wp, crack)
      call list_points(crack, points)
      shape%inner = 1.5_wp
      shape%radius = radii
      shape%half_width = 2
      shape%reach = shape%half_width + radii(3)
      call fill_box(crack, tip(3), [-6.0_wp, -4.0_wp, -6.0_wp], [7.0_wp, 4.0_wp, 7.0_wp], &
         radii(3), &
         samples)
      do i = 1, size(samples)
         call give_running(samples(i), tip, speed, lambda, mu, density)
         samples(i)%v = samples(i)%v + flight
      end do
      call clear_sums(sums, 3, points%n)
      allocate (speeds(points%n), source=speed)
      call sum_domains(samples, crack%front, points, shape, speeds, &
         drift_of(drift_sums(samples, points, speeds)), sums)
      i = minloc(abs(points%x(2, :) - tip(2)), 1)
      k = sqrt(sums%j(:, i)/window_length(crack%front, points, i, shape%half_width, shape%reach) &
         /release_rate(e, velocity_functions(e, speed), [1.0_wp, 0.0_wp, 0.0_wp]))
   end subroutine measure

end program test_running_front
