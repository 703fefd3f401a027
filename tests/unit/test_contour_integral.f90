!> J on circles, from particles that carry exact fields: 8 in a cell of size 1, off the lattice of
!> the crack.
program test_contour_integral
   use xmpm_kinds, only: wp, pi
   use xmpm_crack, only: crack_t
   use xmpm_samples, only: sample_t
   use xmpm_front_points, only: front_points_t, list_points, window_length
   use xmpm_domain_integral, only: domain_shape_t
   use xmpm_material_drift, only: drift_sums, drift_of
   use xmpm_contour_integral, only: contour_sums_t, clear_contours, sum_moments, fit_circles, &
      sum_circles, contour_rate
   use xmpm_velocity_functions, only: elastic_constants_t, elastic_constants, velocity_functions, &
      release_rate
   use exact_cracks, only: make_penny, make_straight, fill_box, give_penny, give_running
   use testing, only: suite_t, check, check_close, finish
   implicit none
   type(suite_t) :: suite
   type(elastic_constants_t) :: e
   real(wp), parameter :: lambda = 1.5_wp, mu = 1.0_wp, density = 1.3_wp
   real(wp), parameter :: support = 1.6_wp

   suite%name = 'contour_integral'
   e = elastic_constants(lambda, mu, density)
   call penny()
   call runs(0.0_wp)
   call runs(0.6_wp)
   call finish(suite)

contains

   !> Penny of 10 cells. Eq. 49 alone has its known error, 0.038, 0.077 and 0.096 at R/a = 0.2, 0.4
   !> and 0.5; with the term out of the plane nothing of it is left.
   subroutine penny()
      real(wp), parameter :: radius(3) = [2.0_wp, 4.0_wp, 5.0_wp], bias(3) = [0.038_wp, 0.077_wp, &
         0.096_wp]
      real(wp), parameter :: centre(3) = [0.137_wp, 0.271_wp, 0.0831_wp], a = 10.0_wp
      type(crack_t) :: crack
      type(sample_t), allocatable :: samples(:)
      real(wp), allocatable :: k(:, :, :)
      real(wp) :: mean(2)
      integer :: i

      call make_penny(centre, a, 1.0_wp, crack)
      call fill_box(crack, centre(3), [-18.0_wp, -18.0_wp, -8.0_wp], [18.0_wp, 18.0_wp, 8.0_wp], &
         radius(3) + support, samples)
      do i = 1, size(samples)
         call give_penny(samples(i), centre, a, 1.0_wp, lambda, mu)
      end do
      call measure(crack, radius, samples, 0.0_wp, k)
      k = k/(2*sqrt(a/pi)) - 1
      do i = 1, 3
         mean = sum(k(:, i, :), 1)/real(size(k, 1), wp)
         ! the aim is 0.01; recorded 0.0019, 0.0021, 0.0022
         call check_close(suite, 'mean K of the contour', mean(1), 0.0_wp, 0.004_wp, 0.0_wp)
         ! recorded differences 0.0002, 0.0007, 0.0004
         call check_close(suite, 'mean K of eq. 49', mean(2), bias(i), 0.0015_wp, 0.0_wp)
      end do
      ! particles lie to the front as they happen to; recorded 0.0078, 0.0094, 0.0103
      call check(suite, 'K of the contour at every point', maxval(abs(k(:, :, 1))) < 0.012_wp)
   end subroutine penny

   !> A straight front that moves: both are right, and a body that flies adds nothing.
   subroutine runs(part)
      real(wp), intent(in) :: part   !! speed over the Rayleigh speed
      real(wp), parameter :: radius(3) = [2.0_wp, 4.0_wp, 5.0_wp]
      real(wp), parameter :: tip(3) = [0.137_wp, 0.1_wp, 0.0831_wp]
      type(crack_t) :: crack
      type(sample_t), allocatable :: samples(:)
      real(wp), allocatable :: k(:, :, :), flying(:, :, :)
      integer :: i, middle

      call make_straight(tip, 9.0_wp, 12.0_wp, 1.0_wp, crack)
      call fill_box(crack, tip(3), [-8.0_wp, -4.0_wp, -8.0_wp], [9.0_wp, 4.0_wp, 9.0_wp], &
         radius(3) + support, samples)
      do i = 1, size(samples)
         call give_running(samples(i), tip, part*e%rayleigh, lambda, mu, density)
      end do
      call measure(crack, radius, samples, part*e%rayleigh, k)
      middle = (size(k, 1) + 1)/2
      do i = 1, 3
         ! what the fit loses where the field bends most; recorded 0.00006, 0.000003, 0.000006
         call check_close(suite, 'K of the contour', k(middle, i, 1), 1.0_wp, 2e-4_wp, 0.0_wp)
         call check_close(suite, 'K of eq. 49', k(middle, i, 2), 1.0_wp, 2e-4_wp, 0.0_wp)
      end do
      do i = 1, size(samples)
         samples(i)%v = samples(i)%v + [0.2_wp, -0.1_wp, 0.3_wp]
      end do
      call measure(crack, radius, samples, part*e%rayleigh, flying)
      ! rounding
      call check(suite, 'K of the contour in a body that flies', &
         maxval(abs(flying(middle, :, 1) - k(middle, :, 1))) < 1e-12_wp)
   end subroutine runs

   !> K at each point and radius: contour, paper.
   subroutine measure(crack, radius, samples, speed, k)
      type(crack_t), intent(in) :: crack
      real(wp), intent(in) :: radius(3), speed
      type(sample_t), intent(in) :: samples(:)
      real(wp), allocatable, intent(out) :: k(:, :, :)
      type(front_points_t) :: points
      type(domain_shape_t) :: shape
      type(contour_sums_t) :: sums
      real(wp), allocatable :: drift(:, :), speeds(:)
      real(wp) :: both(3, 2)
      integer :: i

      call list_points(crack, points)
      shape%radius = radius
      shape%half_width = 2
      shape%reach = shape%half_width + radius(3)
      allocate (speeds(points%n), source=speed)
      drift = drift_of(drift_sums(samples, points, speeds))
      call clear_contours(sums, support, 3, points%n)
      call sum_moments(samples, crack%front, points, shape, sums)
      call fit_circles(sums)
      call sum_circles(samples, crack%front, points, shape, drift, sums)
      allocate (k(points%n, 3, 2))
      do i = 1, points%n
         call rates(sums, i, radius, window_length(crack%front, points, i, shape%half_width, &
            shape%reach), speed, drift(:, i), both)
         k(i, :, :) = both
      end do
   end subroutine measure

   subroutine rates(sums, i, radius, length, speed, drift, k)
      type(contour_sums_t), intent(in) :: sums
      integer, intent(in) :: i
      real(wp), intent(in) :: radius(3), length, speed, drift(3)
      real(wp), intent(out) :: k(3, 2)
      integer :: r

      do r = 1, 3
         k(r, 1) = contour_rate(sums, r, i, radius(r), length, density, .false., speed, drift)
         k(r, 2) = contour_rate(sums, r, i, radius(r), length, density, .true., speed, drift)
      end do
      ! there are no particles around the ends of a straight front
      k = sqrt(max(k, 0.0_wp)/release_rate(e, velocity_functions(e, speed), &
         [1.0_wp, 0.0_wp, 0.0_wp]))
   end subroutine rates
end program test_contour_integral
