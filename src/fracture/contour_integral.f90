!> J on circles in the planes normal to a front (section 4.1 of 10.1002/nme.6653).
!>
!> In the frame of a front point, with the circle C of radius R, its inside A and n out of it,
!>
!>    J = int_C [W n_1 - s_ij n_j u_i,1] ds + int_A f_i u_i,1 dA - int_A d(s_i3 u_i,1)/dx3 dA,
!>
!> f = s_ij,j. `paper` is eq. 49, which lacks the last integral: on a curved front it depends on
!> R. What is needed on the circle is fitted to the particles of the same side; the integrals over
!> A are sums over particles with a window along the front, as those of the domain form, which
!> turns d/dx3 to the window. At C > 0, and in eq. 49 always, kinetic energy adds E n_1 and
!> - rho v_i v_i,1.
module xmpm_contour_integral
   use xmpm_kinds, only: wp, pi
   use xmpm_front, only: front_t
   use xmpm_samples, only: sample_t
   use xmpm_front_points, only: front_points_t, window_at
   use xmpm_domain_integral, only: domain_shape_t, within, full
   use xmpm_edge_points, only: edge_points_t, list_edge_points
   use xmpm_moving_least_squares, only: monomials, fit_weight, add_moments, fit_coefficients, &
      n_monomials, n_moments
   implicit none
   private

   public :: contour_sums_t, clear_contours, sum_moments, fit_circles, sum_circles, contour_rate

   integer, parameter :: n_places = 32   !! places on a circle, none of them on a face
   integer, parameter :: n_fields = 12   !! s11 s22 s12 s23 s13, u_1,1 u_2,1 u_3,1, W, v

   !> Sums of this rank for each point.
   type :: contour_sums_t
      real(wp) :: support = 0                           !! of the fits [length]
      real(wp), allocatable :: moment(:, :, :, :)       !! (n_moments,n_places,nr,n)
      real(wp), allocatable :: coefficient(:, :, :, :)  !! (n_monomials,n_places,nr,n)
      real(wp), allocatable :: field(:, :, :, :)        !! (n_fields,n_places,nr,n)
      real(wp), allocatable :: area(:, :, :)            !! (4,nr,n) integrals over A times window
                                                        !! length: of f_i u_i,1; out of plane;
                                                        !! kinetic, of v and of v - drift
      logical, allocatable :: found(:, :)               !! (nr,n) there are particles all around
   end type contour_sums_t

contains

   !> Room for the sums of n points, all 0.
   pure subroutine clear_contours(sums, support, n_radii, n)
      type(contour_sums_t), intent(out) :: sums
      real(wp), intent(in) :: support            !! [length]
      integer, intent(in) :: n_radii, n

      sums%support = support
      allocate (sums%moment(n_moments, n_places, n_radii, n), &
         sums%coefficient(n_monomials, n_places, n_radii, n), &
         sums%field(n_fields, n_places, n_radii, n), sums%area(4, n_radii, n), source=0.0_wp)
      allocate (sums%found(n_radii, n), source=.false.)
   end subroutine clear_contours

   !> First sums: the moments of all fits.
   pure subroutine sum_moments(samples, front, points, shape, sums)
      type(sample_t), intent(in) :: samples(:)   !! within the largest radius and the support
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      type(domain_shape_t), intent(in) :: shape
      type(contour_sums_t), intent(inout) :: sums
      type(edge_points_t), allocatable :: near(:)
      real(wp) :: d(3)
      integer :: i, k, m, r

      call list_edge_points(front, points, shape%reach + sums%support, near)
      do i = 1, size(samples)
         do k = 1, size(near(samples(i)%edge)%point)
            m = near(samples(i)%edge)%point(k)
            if (.not. within(samples(i)%foot, points%x(:, m), shape%reach + sums%support)) cycle
            d = matmul(samples(i)%x - points%x(:, m), points%frame(:, :, m))
            do r = 1, size(shape%radius)
               if (.not. touches(d, shape%radius(r), sums%support)) cycle
               call add_to_moments(d, samples(i)%side, shape%radius(r), sums%support, &
                  sums%moment(:, :, r, m))
            end do
         end do
      end do
   end subroutine sum_moments

   !> Whether a particle counts anywhere on a circle.
   pure function touches(d, radius, support) result(yes)
      real(wp), intent(in) :: d(3), radius, support   !! [length]
      logical :: yes

      yes = abs(d(3)) < support .and. abs(norm2(d(:2)) - radius) < support
   end function touches

   pure subroutine add_to_moments(d, side, radius, support, moment)
      real(wp), intent(in) :: d(3), side, radius, support
      real(wp), intent(inout) :: moment(:, :)
      real(wp) :: away(3), w
      integer :: a

      do a = 1, n_places
         call weigh(d, side, radius, support, a, away, w)
         if (w > 0) call add_moments(w, monomials(away), moment(:, a))
      end do
   end subroutine add_to_moments

   !> Distance of a particle from a place on a circle, over the support, and its weight there:
   !> none across the crack. Ahead of the front nothing lies between the sides.
   pure subroutine weigh(d, side, radius, support, a, away, w)
      real(wp), intent(in) :: d(3), side, radius, support
      integer, intent(in) :: a                  !! number of the place
      real(wp), intent(out) :: away(3), w
      real(wp) :: n(2)

      n = normal(a)
      away = (d - [radius*n, 0.0_wp])/support
      w = 0
      if (side*n(2) < 0 .and. min(n(1), d(1)) < 0) return
      w = fit_weight(norm2(away))
   end subroutine weigh

   !> Unit vector to a place on a circle.
   pure function normal(a) result(n)
      integer, intent(in) :: a
      real(wp) :: n(2), theta

      theta = pi*(real(2*a - 1, wp)/n_places - 1)
      n = [cos(theta), sin(theta)]
   end function normal

   !> Solve all fits; the moments are those of all ranks.
   pure subroutine fit_circles(sums)
      type(contour_sums_t), intent(inout) :: sums
      integer :: a, r, m
      logical :: found(n_places)

      do m = 1, size(sums%found, 2)
         do r = 1, size(sums%found, 1)
            do a = 1, n_places
               call fit_coefficients(sums%moment(:, a, r, m), sums%coefficient(:, a, r, m), &
                  found(a))
            end do
            sums%found(r, m) = all(found)
         end do
      end do
   end subroutine fit_circles

   !> Second sums: the fields on the circles, and the integrals inside.
   pure subroutine sum_circles(samples, front, points, shape, drift, sums)
      type(sample_t), intent(in) :: samples(:)   !! within the largest radius and the support
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      type(domain_shape_t), intent(in) :: shape
      real(wp), intent(in) :: drift(:, :)        !! (3,n) velocity of the material [length/time]
      type(contour_sums_t), intent(inout) :: sums
      type(edge_points_t), allocatable :: near(:)
      integer :: i, k, m

      call list_edge_points(front, points, shape%reach + sums%support, near)
      do i = 1, size(samples)
         do k = 1, size(near(samples(i)%edge)%point)
            m = near(samples(i)%edge)%point(k)
            if (.not. within(samples(i)%foot, points%x(:, m), shape%reach + sums%support)) cycle
            call add_sample(samples(i), points, m, shape, drift(:, m), sums)
         end do
      end do
   end subroutine sum_circles

   !> Add one sample to the circles of one point.
   pure subroutine add_sample(s, points, m, shape, drift, sums)
      type(sample_t), intent(in) :: s
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: m
      type(domain_shape_t), intent(in) :: shape
      real(wp), intent(in) :: drift(3)
      type(contour_sums_t), intent(inout) :: sums
      real(wp) :: d(3), e(3, 3), t(3, 3), h(3), inside(4), inner
      integer :: r

      e = points%frame(:, :, m)
      d = matmul(s%x - points%x(:, m), e)
      if (abs(d(3)) >= max(shape%half_width, sums%support)) return
      t = matmul(transpose(e), matmul(full(s%stress), e))
      h = matmul(e(:, 1) - matmul(points%turn(:, :, m), matmul(s%back, e(:, 1))), e)
      inside = integrands(s, e, t, h, d(3), shape%half_width, drift)
      do r = 1, size(shape%radius)
         ! a particle is as wide as the cube of its volume
         inner = min(0.5_wp + (shape%radius(r) - norm2(d(:2)))/s%volume**(1/3.0_wp), 1.0_wp)
         if (inner > 0) sums%area(:, r, m) = sums%area(:, r, m) + inner*inside
         if (.not. touches(d, shape%radius(r), sums%support)) cycle
         call add_to_fields(d, s%side, shape%radius(r), sums%support, [t(1, 1), t(2, 2), t(1, 2), &
            t(2, 3), t(1, 3), h, s%work, s%v], sums%coefficient(:, :, r, m), sums%field(:, :, r, m))
      end do
   end subroutine add_sample

   !> What a particle adds to the integrals over A.
   pure function integrands(s, e, t, h, xi, half_width, drift) result(inside)
      type(sample_t), intent(in) :: s
      real(wp), intent(in) :: e(3, 3), t(3, 3), h(3)   !! frame, stress and u_i,1 in it
      real(wp), intent(in) :: xi, half_width           !! along the front, of the window [length]
      real(wp), intent(in) :: drift(3)
      real(wp) :: inside(4), l, window(1), slope(1), v1(3)

      call window_at(1, [xi], half_width, window, slope)
      l = window(1)
      v1 = matmul(s%rate, e(:, 1))
      inside(1) = l*dot_product(matmul(s%pull, e), h)
      inside(2) = s%volume*slope(1)*dot_product(t(:, 3), h)
      inside(3) = -s%volume*l*s%density*dot_product(s%v, v1)
      inside(4) = -s%volume*l*s%density*dot_product(s%v - drift, v1)
   end function integrands

   pure subroutine add_to_fields(d, side, radius, support, value, coefficient, field)
      real(wp), intent(in) :: d(3), side, radius, support, value(n_fields)
      real(wp), intent(in) :: coefficient(:, :)
      real(wp), intent(inout) :: field(:, :)
      real(wp) :: away(3), w
      integer :: a

      do a = 1, n_places
         call weigh(d, side, radius, support, a, away, w)
         if (.not. w > 0) cycle
         w = w*dot_product(coefficient(:, a), monomials(away))
         field(:, a) = field(:, a) + w*value
      end do
   end subroutine add_to_fields

   !> J at one point and radius from the sums of all ranks.
   pure function contour_rate(sums, r, m, radius, length, density, paper, speed, drift) result(j)
      type(contour_sums_t), intent(in) :: sums
      integer, intent(in) :: r, m              !! radius and point
      real(wp), intent(in) :: radius, length   !! of the circle, of the window [length]
      real(wp), intent(in) :: density          !! [mass/length^3]
      logical, intent(in) :: paper             !! eq. 49 as it stands
      real(wp), intent(in) :: speed, drift(3)  !! of the front, of the material [length/time]
      real(wp) :: j                            !! [energy/length^2]

      associate (f => sums%field(:, :, r, m), area => sums%area(:, r, m))
         j = radius*2*pi/n_places*around(f) + area(1)/length
         if (paper) then
            j = j + radius*2*pi/n_places*kinetic(f, density, 0*drift) + area(3)/length
         else
            j = j + area(2)/length
            if (speed > 0) j = j + radius*2*pi/n_places*kinetic(f, density, drift) &
               + area(4)/length
         end if
      end associate
   end function contour_rate

   !> Sum of W n_1 - s_ij n_j u_i,1 over the places.
   pure function around(f) result(total)
      real(wp), intent(in) :: f(n_fields, n_places)
      real(wp) :: total, n(2), t(3)
      integer :: a

      total = 0
      do a = 1, n_places
         n = normal(a)
         t = [f(1, a)*n(1) + f(3, a)*n(2), f(3, a)*n(1) + f(2, a)*n(2), f(5, a)*n(1) + f(4, a)*n(2)]
         total = total + f(9, a)*n(1) - dot_product(t, f(6:8, a))
      end do
   end function around

   !> Sum of E n_1 over the places.
   pure function kinetic(f, density, drift) result(total)
      real(wp), intent(in) :: f(n_fields, n_places), density, drift(3)
      real(wp) :: total, n(2)
      integer :: a

      total = 0
      do a = 1, n_places
         n = normal(a)
         total = total + 0.5_wp*density*sum((f(10:12, a) - drift)**2)*n(1)
      end do
   end function kinetic
end module xmpm_contour_integral
