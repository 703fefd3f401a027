!> The domain integrals on particles that carry exact fields: 8 in a cell of size 1, off the lattice
!> of the crack.
program test_domain_integral
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t
   use xmpm_surface, only: build_surface
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_disc, make_sector
   use xmpm_front, only: front_test_points, mark_front
   use xmpm_crack, only: crack_t
   use xmpm_samples, only: sample_t, place_sample
   use xmpm_front_points, only: front_points_t, list_points, end_points, window_length
   use xmpm_domain_integral, only: domain_sums_t, domain_shape_t, sum_domains, clear_sums, &
      plateau_area
   use xmpm_velocity_functions, only: elastic_constants_t, elastic_constants, velocity_functions
   use penny_field, only: penny_at
   use testing, only: suite_t, check, check_close, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   real(wp), parameter :: young = 20.0e3_wp, poisson = 0.298_wp, tension = 40.0_wp
   real(wp), parameter :: mu = young/(2*(1 + poisson)), lambda = 2*mu*poisson/(1 - 2*poisson)
   real(wp), parameter :: radii(3) = [3.0_wp, 4.0_wp, 5.0_wp]

   !> Errors of one crack, over the exact K_I, for each radius.
   type :: errors_t
      real(wp) :: mean(3) = 0          !! of K from J
      real(wp) :: worst(3) = 0         !! of K from J at single points
      real(wp) :: interaction(3) = 0   !! mean of K_I from the interaction
      real(wp) :: others(2) = 0        !! largest K_II, K_III from the interaction, radius 5
      real(wp) :: volume(3) = 0        !! of the domains
   end type errors_t

   suite%name = 'domain_integral'
   call penny()
   call converges()
   call quarter()
   call finish(suite)

contains

   !> J to K within 0.8 % at 3 h and 0.5 % at 4 h and 5 h: the aims for quadrature alone.
   subroutine penny()
      type(errors_t) :: e

      call measure(10.0_wp, 1.0_wp, radii, e)
      call check_close(suite, 'K from J, radius 3 h', e%mean(1), 0.0_wp, 0.008_wp, 0.0_wp)
      call check_close(suite, 'K from J, radius 4 h', e%mean(2), 0.0_wp, 0.005_wp, 0.0_wp)
      call check_close(suite, 'K from J, radius 5 h', e%mean(3), 0.0_wp, 0.005_wp, 0.0_wp)
      ! at single points particles lie to the front as they happen to; recorded 1.26, 0.95, 0.91 %
      call check(suite, 'K from J at every point', all(e%worst < [0.015_wp, 0.012_wp, 0.011_wp]))
      ! the straight auxiliary field leaves a part of the curvature; recorded 1.1, 0.6, 0.5 %
      call check(suite, 'K_I from the interaction', all(abs(e%interaction) < 0.012_wp))
      ! recorded 1.1 and 2.2 %: what quadrature makes of modes that are not there
      call check(suite, 'no other modes', all(e%others < [0.014_wp, 0.027_wp]))
      ! quadrature of a smooth function; recorded 0.3 %
      call check(suite, 'volume of the domains', all(abs(e%volume) < 0.005_wp))
   end subroutine penny

   !> At a fixed physical radius the error falls as cells shrink.
   subroutine converges()
      type(errors_t) :: coarse, fine

      call measure(6.0_wp, 1.0_wp, radii, coarse)
      call measure(12.0_wp, 1.0_wp, 2*radii, fine)
      ! recorded 0.53, 0.33, 0.29 % and 0.14, 0.13, 0.13 %
      call check(suite, 'K at a fixed radius has half the error on half the cells', &
         all(abs(fine%mean) < 0.5_wp*abs(coarse%mean)))
   end subroutine converges

   !> A quarter of the block between two planes of symmetry, the front ends on both: q must lie in
   !> the planes, though the front is curved.
   subroutine quarter()
      type(crack_t) :: crack
      type(crack_plane_t) :: plane
      type(front_points_t) :: points
      type(domain_shape_t) :: shape
      type(domain_sums_t) :: sums
      type(sample_t), allocatable :: samples(:), whole(:)
      type(errors_t) :: e
      type(error_t), allocatable :: error
      real(wp), parameter :: centre(3) = [0.0_wp, 0.0_wp, 0.0831_wp], a = 6.0_wp
      real(wp), allocatable :: x(:, :), test(:, :), still(:), drift(:, :), length(:)
      integer, allocatable :: tri(:, :)
      integer :: i

      call set_plane(centre, [1.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 1.0_wp, 0.0_wp], plane, error)
      call make_sector(plane, [a, a], [0.0_wp, 90.0_wp], 1.0_wp, x, tri, error)
      call build_surface(x, tri, crack%surface, error)
      call check_no_error(suite, 'a quarter of a disc', error)
      call front_test_points(crack%surface, 1.0_wp, test)
      call mark_front(crack%surface, norm2(test(:2, :), 1) > a, crack%front)
      call list_points(crack, points)
      call end_points(crack%front, points)
      shape%inner = 1.5_wp
      shape%radius = radii
      shape%half_width = 2
      shape%reach = shape%half_width + radii(3)
      call fill_samples(crack, centre, a, radii(3), whole)
      samples = pack(whole, whole%x(1) > 0 .and. whole%x(2) > 0)
      call clear_sums(sums, 3, points%n)
      allocate (still(points%n), drift(3, points%n), source=0.0_wp)
      call sum_domains(samples, crack%front, points, shape, still, drift, sums)
      length = [(window_length(crack%front, points, i, shape%half_width, shape%reach), &
         i=1, points%n)]
      call compare(a, shape, sums, length, e)
      ! as for the whole disc; recorded 0.77, 0.60, 0.55 %, and 4 to 6 % with e1 all through
      call check(suite, 'K at every point between planes of symmetry', all(e%worst < 0.011_wp))
   end subroutine quarter

   !> Errors along a penny of radius a in cells of size h = 1.
   subroutine measure(a, h, radius, e)
      real(wp), intent(in) :: a, h, radius(3)
      type(errors_t), intent(out) :: e
      type(crack_t) :: crack
      type(front_points_t) :: points
      type(domain_shape_t) :: shape
      type(domain_sums_t) :: sums
      type(sample_t), allocatable :: samples(:)
      real(wp), parameter :: centre(3) = [0.137_wp, 0.271_wp, 0.0831_wp]
      real(wp), allocatable :: still(:), drift(:, :), length(:)
      integer :: i

      call make_penny(centre, a, h, crack)
      call list_points(crack, points)
      shape%inner = 1.5_wp*h
      shape%radius = radius
      shape%half_width = 2*h
      shape%reach = shape%half_width + radius(3)
      call fill_samples(crack, centre, a, radius(3), samples)
      call clear_sums(sums, 3, points%n)
      allocate (still(points%n), drift(3, points%n), source=0.0_wp)
      call sum_domains(samples, crack%front, points, shape, still, drift, sums)
      length = [(window_length(crack%front, points, i, shape%half_width, shape%reach), &
         i=1, points%n)]
      call compare(a, shape, sums, length, e)
   end subroutine measure

   subroutine compare(a, shape, sums, length, e)
      real(wp), intent(in) :: a, length(:)
      type(domain_shape_t), intent(in) :: shape
      type(domain_sums_t), intent(in) :: sums
      type(errors_t), intent(out) :: e
      type(elastic_constants_t) :: material
      real(wp) :: exact, f(3), k(3, size(length)), mode(3, size(length))
      integer :: i

      material = elastic_constants(lambda, mu, 1.0_wp)
      f = velocity_functions(material, 0.0_wp)
      exact = 2*tension*sqrt(a/pi)
      do i = 1, size(length)
         k(:, i) = sqrt(sums%j(:, i)/length(i)*2*mu/f(1))/exact - 1
         mode(:, i) = sums%interaction(1, :, i)/length(i)*mu/f(1)/exact - 1
      end do
      e%mean = sum(k, dim=2)/real(size(length), wp)
      e%worst = maxval(abs(k), dim=2)
      e%interaction = sum(mode, dim=2)/real(size(length), wp)
      do i = 1, 2
         e%others(i) = maxval(abs(sums%interaction(1 + i, 3, :)/length))*mu/f(1 + i)/exact
      end do
      do i = 1, 3
         e%volume(i) = sum(sums%volume(i, :)) &
            /(plateau_area(shape%inner, shape%radius(i))*sum(length)) - 1
      end do
   end subroutine compare

   subroutine make_penny(centre, a, h, crack)
      real(wp), intent(in) :: centre(3), a, h
      type(crack_t), intent(out) :: crack
      type(crack_plane_t) :: plane
      type(error_t), allocatable :: error
      real(wp), allocatable :: x(:, :), test(:, :)
      integer, allocatable :: tri(:, :)
      logical, allocatable :: inside(:)

      call set_plane(centre, [1.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 1.0_wp, 0.0_wp], plane, error)
      call make_disc(plane, a, h, x, tri, error)
      call build_surface(x, tri, crack%surface, error)
      call check_no_error(suite, 'a disc', error)
      call front_test_points(crack%surface, h, test)
      allocate (inside(size(test, 2)), source=.true.)
      call mark_front(crack%surface, inside, crack%front)
   end subroutine make_penny

   !> Particles around the front, with the exact field.
   subroutine fill_samples(crack, centre, a, reach, samples)
      type(crack_t), intent(in) :: crack
      real(wp), intent(in) :: centre(3), a, reach
      type(sample_t), allocatable, intent(out) :: samples(:)
      integer :: ix, iy, iz, n, m, top
      logical :: inside

      m = 2*ceiling(a + reach + 1)
      top = 2*ceiling(reach + 1)
      allocate (samples((2*m + 1)**2*(2*top + 1)))
      n = 0
      do iz = -top, top
         do iy = -m, m
            do ix = -m, m
               samples(n + 1)%x = 0.25_wp + 0.5_wp*real([ix, iy, iz], wp)
               samples(n + 1)%side = sign(1.0_wp, samples(n + 1)%x(3) - centre(3))
               call place_sample(crack%front, reach, samples(n + 1), inside)
               if (.not. inside) cycle
               n = n + 1
               call give_field(samples(n), centre, a)
            end do
         end do
      end do
      samples = samples(:n)
   end subroutine fill_samples

   subroutine give_field(s, centre, a)
      type(sample_t), intent(inout) :: s
      real(wp), intent(in) :: centre(3), a
      real(wp) :: gradient(3, 3)
      integer :: i

      s%volume = 0.125_wp
      s%density = 1
      s%lambda = lambda
      s%mu = mu
      call penny_at(s%x - centre, a, tension, young, poisson, s%stress, gradient)
      s%back = -gradient
      do i = 1, 3
         s%back(i, i) = 1 - gradient(i, i)
      end do
      associate (t => s%stress)
         s%work = 0.5_wp*sum(reshape([t(1), t(4), t(6), t(4), t(2), t(5), t(6), t(5), t(3)], &
            [3, 3])*gradient)
      end associate
   end subroutine give_field
end program test_domain_integral
