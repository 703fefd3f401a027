!> J, the stress intensity factors and their error bars at the points of a crack's fronts, from the
!> sums over the domains.
module xmpm_front_values
   use xmpm_kinds, only: wp
   use xmpm_front_points, only: front_points_t
   use xmpm_domain_integral, only: domain_sums_t, domain_shape_t, plateau_area
   use xmpm_velocity_functions, only: elastic_constants_t, elastic_constants, velocity_functions, &
      split_rate, release_rate
   use xmpm_rates, only: rates_t
   use xmpm_hoop_stress, only: hoop_stress_t
   use xmpm_opening, only: opening_behind
   use xmpm_crack, only: crack_t
   implicit none
   private

   public :: front_values_t, find_values, clear_values, t_stress
   public :: flag_leaves, flag_other, flag_held, flag_end, flag_closed, flag_smaller

   integer, parameter :: flag_leaves = 1     !! no domain fits into the material
   integer, parameter :: flag_other = 2      !! another front or crack is in the domain
   integer, parameter :: flag_held = 4       !! a boundary condition is in the domain
   integer, parameter :: flag_end = 8        !! the end of a front, where it meets a surface
   integer, parameter :: flag_closed = 16    !! the faces are closed: no mode I
   integer, parameter :: flag_smaller = 32   !! not all radii fit: the largest that does is used

   real(wp), parameter :: volume_error = 0.05_wp   !! a domain with less material leaves the body
   real(wp), parameter :: round = 1.05_wp          !! largest radius over that of the front's bend
   real(wp), parameter :: overlap = 1e-9_wp        !! of the faces, over the distance behind the
                                                   !! front, from which they are closed
   real(wp), parameter :: shear = 0.02_wp          !! opening over the whole jump up to which faces
                                                   !! may touch

   !> What is known at the points of one crack's fronts at one time.
   type :: front_values_t
      type(front_points_t) :: points
      real(wp), allocatable :: j(:)            !! (n) energy release rate [energy/length^2]
      real(wp), allocatable :: j_bar(:, :)     !! (2,n) its lowest and highest over radii
      real(wp), allocatable :: k(:, :)         !! (3,n) K_I, K_II, K_III [stress length^(1/2)]
      real(wp), allocatable :: k_bar(:, :, :)  !! (2,3,n) lowest and highest, radii and methods
      real(wp), allocatable :: t(:)            !! (n) T-stress [stress]
      real(wp), allocatable :: kink(:)         !! (n) angle of the largest hoop stress [rad]
      real(wp), allocatable :: k_star(:)       !! (n) K* in that direction
      real(wp), allocatable :: speed(:)        !! (n) of the front [length/time]
      real(wp), allocatable :: radius(:)       !! (n) of the domain [length]
      integer, allocatable :: flags(:)         !! (n) sums of flag_*
      type(elastic_constants_t), allocatable :: material(:)   !! (n)
   end type front_values_t

contains

   !> Room for the values of n points, all 0.
   pure subroutine clear_values(values, n)
      type(front_values_t), intent(inout) :: values   !! points are kept
      integer, intent(in) :: n

      allocate (values%j(n), values%j_bar(2, n), values%k(3, n), values%k_bar(2, 3, n), &
         values%t(n), values%kink(n), values%k_star(n), values%speed(n), values%radius(n), &
         source=0.0_wp)
      allocate (values%flags(n), source=0)
      allocate (values%material(n))
   end subroutine clear_values

   !> Values of all points from the sums of all ranks.
   subroutine find_values(crack, shape, sums, rates, behind, values)
      type(crack_t), intent(in) :: crack               !! gathered
      type(domain_shape_t), intent(in) :: shape
      type(domain_sums_t), intent(in) :: sums          !! of all ranks
      type(rates_t), intent(in) :: rates               !! J by all methods
      real(wp), intent(in) :: behind                   !! where openings are taken [length]
      type(front_values_t), intent(inout) :: values    !! points and speed are known
      integer :: i

      do i = 1, values%points%n
         if (values%points%at_end(i)) values%flags(i) = values%flags(i) + flag_end
         if (.not. sums%material(1, i) > 0) then
            values%flags(i) = values%flags(i) + flag_leaves
            cycle
         end if
         associate (s => sums%material(:, i))
            values%material(i) = elastic_constants(s(2)/s(1), s(3)/s(1), s(4)/s(1))
         end associate
         call values_of_point(crack, shape, sums, rates, behind, values, i)
      end do
   end subroutine find_values

   !> Values of one point: the largest domain that fits answers, all that fit make the bars.
   subroutine values_of_point(crack, shape, sums, rates, behind, values, i)
      type(crack_t), intent(in) :: crack
      type(domain_shape_t), intent(in) :: shape
      type(domain_sums_t), intent(in) :: sums
      type(rates_t), intent(in) :: rates
      real(wp), intent(in) :: behind
      type(front_values_t), intent(inout) :: values
      integer, intent(in) :: i
      real(wp) :: k(3, size(shape%radius), 0:size(rates%j, 2)), a(3), opening(3)
      logical :: touch   ! faces that press each other give the interaction integral a K_I
      integer :: fits, n, r, m

      call count_fitting(shape, sums%volume(:, i)/max(rates%length(i), tiny(1.0_wp)), fits)
      fits = min(fits, findloc([rates%found(:, i), .false.], .false., 1) - 1, &
         count(shape%radius <= round*values%points%bend(i)))
      n = max(fits, 1)
      if (fits < size(shape%radius)) values%flags(i) = values%flags(i) &
         + merge(flag_smaller, flag_leaves, fits > 0)
      associate (e => values%material(i), j => rates%j(:, :, i), length => rates%length(i))
         a = velocity_functions(e, values%speed(i))
         opening = opening_behind(crack, values%points, i, behind)
         if (opening(1) < -overlap*behind) values%flags(i) = values%flags(i) + flag_closed
         opening(1) = max(opening(1), 0.0_wp)
         touch = opening(1) <= shear*norm2(opening)
         do r = 1, n
            do m = 1, size(j, 2)
               k(:, r, m) = split_rate(e, a, j(r, m), opening)
            end do
            k(:, r, 0) = sums%interaction(:3, r, i)/length*e%mu/velocity_functions(e, 0.0_wp)
         end do
         values%j(i) = j(n, 1)
         values%j_bar(:, i) = [minval(j(:n, :)), maxval(j(:n, :))]
         values%t(i) = t_stress(e, sums%interaction(4, n, i)/length, sums%along(:, i))
      end associate
      if (touch) k(1, :, 0) = k(1, :, 1)
      if (values%speed(i) > 0) k(:, :, 0) = k(:, :, 1)
      values%k(:, i) = k(:, n, 1)
      if (.not. touch) values%k(:, i) = scaled_to_rate(values%material(i), a, rates%j(n, 1, i), &
         [0.5_wp*(k(:2, n, 1) + k(:2, n, 0)), k(3, n, 1)], k(:, n, 1))
      do r = 1, 3
         values%k_bar(:, r, i) = [min(minval(k(r, :n, :)), values%k(r, i)), &
            max(maxval(k(r, :n, :)), values%k(r, i))]
      end do
      values%radius(i) = shape%radius(n)
      call judge(values, i)
   end subroutine values_of_point

   !> Factors in the proportion of `k` with the energy release rate g; `otherwise` where `k` is 0.
   pure function scaled_to_rate(e, a, g, k, otherwise) result(scaled)
      type(elastic_constants_t), intent(in) :: e
      real(wp), intent(in) :: a(3)           !! velocity functions
      real(wp), intent(in) :: g              !! energy release rate [energy/length^2]
      real(wp), intent(in) :: k(3)           !! [stress length^(1/2)]
      real(wp), intent(in) :: otherwise(3)   !! [stress length^(1/2)]
      real(wp) :: scaled(3), rate

      scaled = otherwise
      rate = release_rate(e, a, k)
      if (rate > 0) scaled = k*sqrt(max(g, 0.0_wp)/rate)
   end function scaled_to_rate

   !> E/(1 - nu**2) (I + nu e_33) with the interaction I of a unit line force and the strain along
   !> the front at its points, of a fit.
   pure function t_stress(e, interaction, along) result(t)
      type(elastic_constants_t), intent(in) :: e
      real(wp), intent(in) :: interaction   !! [length^2/force]
      real(wp), intent(in) :: along(5)      !! sums of 1, g, g**2, e_33, g e_33
      real(wp) :: t, strain, determinant    !! [stress]

      strain = 0
      if (along(1) > 0) strain = along(4)/along(1)
      determinant = along(1)*along(3) - along(2)**2
      if (determinant > 1e-6_wp*along(1)*along(3)) then
         strain = (along(3)*along(4) - along(2)*along(5))/determinant
      end if
      t = 2*e%mu/(1 - e%poisson)*(interaction + e%poisson*strain)
   end function t_stress

   !> Number of radii, from the smallest on, whose domain is full of material.
   pure subroutine count_fitting(shape, area, fits)
      type(domain_shape_t), intent(in) :: shape
      real(wp), intent(in) :: area(:)   !! found of w, over the plane normal to the front [length^2]
      integer, intent(out) :: fits

      do fits = 0, size(area) - 1
         if (area(fits + 1) < (1 - volume_error) &
            *plateau_area(shape%inner, shape%radius(fits + 1))) return
      end do
   end subroutine count_fitting

   !> Kink angle and K* (eq. 57, 58).
   pure subroutine judge(values, i)
      type(front_values_t), intent(inout) :: values
      integer, intent(in) :: i
      type(hoop_stress_t) :: criterion
      real(wp) :: twist

      call criterion%judge(values%k(:, i), values%kink(i), twist, values%k_star(i))
   end subroutine judge
end module xmpm_front_values
