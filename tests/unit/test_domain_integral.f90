!> The domain integrals on particles that carry exact fields.
program test_domain_integral
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t
   use xmpm_vectors, only: inverse, unit_vector, cross
   use xmpm_surface, only: build_surface
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_disc
   use xmpm_front, only: front_test_points, mark_front
   use xmpm_crack, only: crack_t
   use xmpm_samples, only: sample_t, place_sample
   use xmpm_front_points, only: front_points_t, list_points, window_length
   use xmpm_domain_integral, only: domain_sums_t, domain_shape_t, sum_domains, clear_sums, &
      plateau_area
   use xmpm_velocity_functions, only: elastic_constants_t, elastic_constants, velocity_functions
   use penny_field, only: penny_at
   use testing, only: suite_t, check, check_close, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   real(wp), parameter :: young = 20.0e3_wp, poisson = 0.298_wp, tension = 40.0_wp

   suite%name = 'domain_integral'
   call penny()
   call finish(suite)

contains

   subroutine penny()
      real(wp) :: k(3), worst(3)
      real(wp) :: spread_of(3)

      call penny_error(10.0_wp, [3.0_wp, 4.0_wp, 5.0_wp], k, spread_of, worst)
      print *, k, spread_of, worst
      call penny_error(6.0_wp, [3.0_wp, 4.0_wp, 5.0_wp], k, spread_of, worst)
      print *, k, spread_of, worst
   end subroutine penny

   !> Mean of K over its exact value, less 1, along a penny of radius a in cells of size 1.
   subroutine penny_error(a, radii, mean_error, scatter, mode_error)
      real(wp), intent(in) :: a, radii(:)
      real(wp), intent(out) :: mean_error(size(radii)), scatter(size(radii)), mode_error(size(radii))
      type(crack_t) :: crack
      type(crack_plane_t) :: plane
      type(error_t), allocatable :: error
      type(front_points_t) :: points
      type(domain_shape_t) :: shape
      type(domain_sums_t) :: sums
      type(sample_t), allocatable :: samples(:)
      type(elastic_constants_t) :: e
      real(wp), allocatable :: x(:, :), test(:, :), speed(:), drift(:, :), k(:, :), ki(:, :), length(:)
      real(wp) :: exact, a_m(3), lambda, mu
      integer, allocatable :: tri(:, :)
      logical, allocatable :: inside(:)
      integer :: i

      mu = young/(2*(1 + poisson))
      lambda = 2*mu*poisson/(1 - 2*poisson)
      e = elastic_constants(lambda, mu, 1.0_wp)
      a_m = velocity_functions(e, 0.0_wp)
      call set_plane([0.137_wp, 0.271_wp, 0.0831_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp], plane, error)
      call make_disc(plane, a, 1.0_wp, x, tri, error)
      call build_surface(x, tri, crack%surface, error)
      call check_no_error(suite, 'a disc', error)
      call front_test_points(crack%surface, 1.0_wp, test)
      allocate (inside(size(test, 2)), source=.true.)
      call mark_front(crack%surface, inside, crack%front)
      call list_points(crack, points)
      shape%inner = 1.5_wp
      shape%radius = radii
      shape%half_width = 2
      shape%reach = shape%half_width + radii(size(radii))
      call fill_samples(crack, plane%centre, a, radii(size(radii)), lambda, mu, samples)
      call clear_sums(sums, size(radii), points%n)
      allocate (speed(points%n), drift(3, points%n), source=0.0_wp)
      call sum_domains(samples, crack%front, points, shape, speed, drift, sums)
      allocate (length(points%n), k(size(radii), points%n), ki(size(radii), points%n))
      do i = 1, points%n
         length(i) = window_length(crack%front, points, i, shape%half_width, shape%reach)
         k(:, i) = sqrt(sums%j(:, i)/length(i)*2*mu/a_m(1))
         ki(:, i) = sums%interaction(1, :, i)/length(i)*mu/a_m(1)
      end do
      exact = 2*tension*sqrt(a/pi)
      mean_error = sum(k, dim=2)/(exact*points%n) - 1
      scatter = maxval(abs(k/exact - 1), dim=2)
      mode_error = sum(ki, dim=2)/(exact*points%n) - 1
      print *, 'volume', sum(sums%volume, dim=2)/[(plateau_area(1.5_wp, radii(i)), i=1, 3)]/sum(length)
      print *, 'modes', maxval(abs(sums%interaction(2, 3, :)))*mu/a_m(2)/exact/length(1), &
         maxval(abs(sums%interaction(3, 3, :)))*mu/exact/length(1)
   end subroutine penny_error

   !> Particles, 8 in a cell, around the front, with the exact field.
   subroutine fill_samples(crack, centre, a, reach, lambda, mu, samples)
      type(crack_t), intent(in) :: crack
      real(wp), intent(in) :: centre(3), a, reach, lambda, mu
      type(sample_t), allocatable, intent(out) :: samples(:)
      type(sample_t) :: s
      real(wp) :: gradient(3, 3)
      integer :: ix, iy, iz, n, m, i
      logical :: inside

      m = 2*ceiling(a + reach + 1)
      allocate (samples(8*m*m*m))
      n = 0
      do iz = -2*ceiling(reach + 1), 2*ceiling(reach + 1)
         do iy = -m, m
            do ix = -m, m
               s = sample_t()
               s%x = 0.25_wp + 0.5_wp*[ix, iy, iz]
               s%volume = 0.125_wp
               s%lambda = lambda
               s%mu = mu
               s%density = 1
               s%side = merge(1.0_wp, -1.0_wp, s%x(3) > centre(3))
               call place_sample(crack%front, reach, s, inside)
               if (.not. inside) cycle
               call penny_at(s%x - centre, a, tension, young, poisson, s%stress, gradient)
               s%back = -gradient
               do i = 1, 3
                  s%back(i, i) = 1 - gradient(i, i)
               end do
               s%work = 0.5_wp*sum(reshape([s%stress(1), s%stress(4), s%stress(6), s%stress(4), &
                  s%stress(2), s%stress(5), s%stress(6), s%stress(5), s%stress(3)], [3, 3])*gradient)
               n = n + 1
               samples(n) = s
            end do
         end do
      end do
      samples = samples(:n)
   end subroutine fill_samples
end program test_domain_integral
