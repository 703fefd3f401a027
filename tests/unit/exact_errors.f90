!> What the integrals at a front make of exact fields on particles, 8 in a cell of size 1 off the
!> lattice of the crack: for tests and for the verification.
module exact_errors
   use xmpm_kinds, only: wp, pi
   use xmpm_surface, only: refresh_geometry
   use xmpm_front, only: refresh_front
   use xmpm_crack, only: crack_t
   use xmpm_samples, only: sample_t, place_sample
   use xmpm_front_points, only: front_points_t, list_points, window_length
   use xmpm_domain_integral, only: domain_sums_t, domain_shape_t, sum_domains, clear_sums, &
      plateau_area, full
   use xmpm_velocity_functions, only: elastic_constants_t, elastic_constants, velocity_functions, &
      release_rate, fastest_front
   use xmpm_material_drift, only: drift_sums, drift_of
   use exact_cracks, only: make_penny, make_straight, fill_box, give_penny, give_running
   implicit none
   private

   public :: errors_t, penny_errors, compare_penny, running_k, worst_velocity_function, shape_of
   public :: plain, lambda, mu, density, worst_places

   integer, parameter :: quad = selected_real_kind(30)
   real(wp), parameter :: lambda = 1.5_wp, mu = 1.0_wp, density = 1.3_wp
   real(wp), parameter :: worst_places(2, 5) = reshape([0.137_wp, 0.0831_wp, 0.0_wp, 0.0_wp, &
      0.25_wp, 0.27_wp, 0.4_wp, 0.1_wp, 0.31_wp, 0.44_wp], [2, 5])   !! x, z of a front in its cell

   !> Errors along a front, over the exact K_I, for each radius.
   type :: errors_t
      real(wp) :: mean(3) = 0          !! of K from J
      real(wp) :: worst(3) = 0         !! of K from J at single points
      real(wp) :: interaction(3) = 0   !! mean of K_I from the interaction
      real(wp) :: others(2) = 0        !! largest K_II, K_III from the interaction, last radius
      real(wp) :: volume(3) = 0        !! of the domains
   end type errors_t

contains

   !> Domains with the program's inner radius and window, for cells of size h.
   pure function shape_of(radius, h) result(shape)
      real(wp), intent(in) :: radius(3), h
      type(domain_shape_t) :: shape

      shape%inner = 1.5_wp*h
      shape%radius = radius
      shape%half_width = 2*h
      shape%reach = shape%half_width + radius(3)
   end function shape_of

   !> Errors along a penny of radius a under tension, in a body that may have turned since.
   subroutine penny_errors(a, radius, e, turn, astray)
      real(wp), intent(in) :: a, radius(3)
      type(errors_t), intent(out) :: e
      real(wp), intent(in), optional :: turn(3, 3)     !! rotation of body, crack and field
      real(wp), intent(in), optional :: astray(3, 3)   !! rotation by which the turn of the front's
                                                       !! frame is off
      type(crack_t) :: crack
      type(front_points_t) :: points
      type(domain_shape_t) :: shape
      type(domain_sums_t) :: sums
      type(sample_t), allocatable :: samples(:)
      real(wp), parameter :: centre(3) = [0.137_wp, 0.271_wp, 0.0831_wp]
      real(wp), allocatable :: still(:), drift(:, :), length(:)
      real(wp) :: wide, high
      integer :: i

      call make_penny(centre, a, 1.0_wp, crack)
      call list_points(crack, points)
      shape = shape_of(radius, 1.0_wp)
      wide = real(ceiling(a + radius(3) + 1), wp)
      high = real(ceiling(radius(3) + 1), wp)
      call fill_box(crack, centre(3), [-wide, -wide, -high], [wide, wide, high], radius(3), samples)
      do i = 1, size(samples)
         call give_penny(samples(i), centre, a, 1.0_wp, lambda, mu)
      end do
      if (present(turn)) then
         call turn_body(turn, radius(3), crack, samples)
         call list_points(crack, points)
      end if
      if (present(astray)) then
         do i = 1, points%n
            points%turn(:, :, i) = matmul(astray, points%turn(:, :, i))
         end do
      end if
      call clear_sums(sums, 3, points%n)
      allocate (still(points%n), drift(3, points%n), source=0.0_wp)
      call sum_domains(samples, crack%front, points, shape, still, drift, sums)
      length = [(window_length(crack%front, points, i, shape%half_width, shape%reach), &
         i=1, points%n)]
      call compare_penny(a, shape, sums, length, e)
   end subroutine penny_errors

   !> Turn a crack and the particles around it about the origin, with all that they carry.
   subroutine turn_body(turn, reach, crack, samples)
      real(wp), intent(in) :: turn(3, 3), reach
      type(crack_t), intent(inout) :: crack
      type(sample_t), intent(inout) :: samples(:)
      real(wp) :: stress(3, 3)
      logical :: inside
      integer :: i

      crack%surface%up = matmul(turn, crack%surface%start) - crack%surface%start
      crack%surface%um = crack%surface%up
      call refresh_geometry(crack%surface)
      call refresh_front(crack%surface, crack%front)
      do i = 1, size(samples)
         associate (s => samples(i))
            s%x = matmul(turn, s%x)
            call place_sample(crack%front, reach, s, inside)
            stress = matmul(turn, matmul(full(s%stress), transpose(turn)))
            s%stress = [stress(1, 1), stress(2, 2), stress(3, 3), stress(1, 2), stress(2, 3), &
               stress(1, 3)]
            s%back = matmul(s%back, transpose(turn))
            s%pull = matmul(turn, s%pull)
         end associate
      end do
   end subroutine turn_body

   !> Errors of sums over domains at a penny under a unit tension.
   subroutine compare_penny(a, shape, sums, length, e)
      real(wp), intent(in) :: a, length(:)
      type(domain_shape_t), intent(in) :: shape
      type(domain_sums_t), intent(in) :: sums
      type(errors_t), intent(out) :: e
      real(wp) :: exact, f(3), k(3, size(length)), mode(3, size(length))
      integer :: i

      f = velocity_functions(elastic_constants(lambda, mu, 1.0_wp), 0.0_wp)
      exact = 2*sqrt(a/pi)
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
   end subroutine compare_penny

   !> K over the exact one at the middle of a straight front that moves, in a body that flies.
   subroutine running_k(part, place, flight, radius, k)
      real(wp), intent(in) :: part        !! speed over the Rayleigh speed
      real(wp), intent(in) :: place(2)    !! x, z of the front
      real(wp), intent(in) :: flight(3), radius(3)
      real(wp), intent(out) :: k(3)
      type(elastic_constants_t) :: e
      type(crack_t) :: crack
      type(front_points_t) :: points
      type(domain_shape_t) :: shape
      type(domain_sums_t) :: sums
      type(sample_t), allocatable :: samples(:)
      real(wp), allocatable :: speeds(:)
      real(wp) :: tip(3), wide
      integer :: i

      e = elastic_constants(lambda, mu, density)
      tip = [place(1), 0.1_wp, place(2)]
      call make_straight(tip, radius(3) + 3, 12.0_wp, 1.0_wp, crack)
      call list_points(crack, points)
      shape = shape_of(radius, 1.0_wp)
      wide = real(ceiling(radius(3) + 1), wp)
      call fill_box(crack, tip(3), [-wide, -4.0_wp, -wide], [wide + 1, 4.0_wp, wide + 1], &
         radius(3), samples)
      do i = 1, size(samples)
         call give_running(samples(i), tip, part*e%rayleigh, lambda, mu, density)
         samples(i)%v = samples(i)%v + flight
      end do
      call clear_sums(sums, 3, points%n)
      allocate (speeds(points%n), source=part*e%rayleigh)
      call sum_domains(samples, crack%front, points, shape, speeds, &
         drift_of(drift_sums(samples, points, speeds)), sums)
      i = minloc(abs(points%x(2, :) - tip(2)), 1)
      k = sqrt(sums%j(:, i)/window_length(crack%front, points, i, shape%half_width, shape%reach) &
         /release_rate(e, velocity_functions(e, part*e%rayleigh), [1.0_wp, 0.0_wp, 0.0_wp]))
   end subroutine running_k

   !> Largest relative error of A_M against eq. 51 as it stands with twice the digits, from almost
   !> at rest to the fastest front, for four Poisson's ratios.
   function worst_velocity_function() result(worst)
      real(wp), parameter :: poissons(4) = [0.0_wp, 0.2_wp, 0.298_wp, 0.45_wp]
      type(elastic_constants_t) :: e
      real(wp) :: worst, c, first
      integer :: i, k

      worst = 0
      do i = 1, size(poissons)
         first = 2*mu*poissons(i)/(1 - 2*poissons(i))
         e = elastic_constants(first, mu, density)
         do k = 0, 1020
            c = fastest_front*e%rayleigh*min(1.0_wp, 0.001_wp*real(k, wp))
            if (k > 1000) c = 0.5_wp**(k - 1000)*e%rayleigh
            if (.not. c > 0) cycle
            worst = max(worst, maxval(abs(real(real(velocity_functions(e, c), quad) &
               /plain(first, mu, density, c) - 1, wp))))
         end do
      end do
   end function worst_velocity_function

   !> A_M of equation 51, not rearranged.
   pure function plain(lambda, mu, density, c) result(a)
      real(wp), intent(in) :: lambda, mu, density, c
      real(quad) :: a(3), b1, b2, d

      b1 = sqrt(1 - real(c, quad)**2*real(density, quad)/(real(lambda, quad) + 2*real(mu, quad)))
      b2 = sqrt(1 - real(c, quad)**2*real(density, quad)/real(mu, quad))
      d = 4*b1*b2 - (1 + b2**2)**2
      a = [b1*(1 - b2**2)/d, b2*(1 - b2**2)/d, 1/b2]
   end function plain
end module exact_errors
