!> The domain form of the dynamic J integral and of the interaction integral, as sums over
!> particles.
!>
!> With q = w(r) l(xi) e1, where r is the distance from the front and xi runs along e3 of the point,
!>
!>    G int l e1 . n ds = sum_p { V [s_ij u_i,k - W d_jk] q_k,j + f_i u_i,k q_k }
!>
!> holds for any front, straight or curved, since q is any field that is l e1 on the front and
!> tangent to the faces. f = V s_ij,j is what the nodes say, so that inertia, body forces, damping
!> and tractions on the faces need no terms of their own. For a front that moves at C > 0 the
!> kinetic energy adds - V E q_k,k - V rho v_i v_i,k q_k, v relative to the material at the front
!> (the two cancel in the sum at C = 0, where their quadrature would only add noise).
module xmpm_domain_integral
   use xmpm_kinds, only: wp, pi
   use xmpm_front, only: front_t
   use xmpm_samples, only: sample_t
   use xmpm_front_points, only: front_points_t, window_at, direction_at, same_part
   use xmpm_near_tip, only: near_tip_fields, line_force_field, strain_of
   implicit none
   private

   public :: domain_sums_t, domain_shape_t, sum_domains, plateau_area, clear_sums
   public :: points_near, full

   !> The field q.
   type :: domain_shape_t
      real(wp) :: inner = 0                    !! w = 1 up to here [length]
      real(wp), allocatable :: radius(:)       !! (nr) w = 0 from here, ascending [length]
      real(wp) :: half_width = 0               !! of the window along the front [length]
      real(wp) :: reach = 0                    !! particles at parts of the front further away
                                               !! than this do not count [length]
      real(wp) :: support = 0                  !! of the fits on circles [length]
   end type domain_shape_t

   !> Sums of this rank for each point.
   type :: domain_sums_t
      real(wp), allocatable :: j(:, :)               !! (nr,n) J times window length [energy/length]
      real(wp), allocatable :: interaction(:, :, :)  !! (4,nr,n) with unit modes I, II, III and
                                                     !! with a unit line force
      real(wp), allocatable :: volume(:, :)          !! (nr,n) integral of w l [length^3]
      real(wp), allocatable :: material(:, :)        !! (4,n) volume, and it times lambda, mu, rho
      real(wp), allocatable :: along(:, :)           !! (5,n) fit of the strain along the front
   end type domain_sums_t

contains

   !> Room for the sums of n points, all 0.
   pure subroutine clear_sums(sums, n_radii, n)
      type(domain_sums_t), intent(out) :: sums
      integer, intent(in) :: n_radii, n

      allocate (sums%j(n_radii, n), sums%interaction(4, n_radii, n), sums%volume(n_radii, n), &
                sums%material(4, n), sums%along(5, n), source=0.0_wp)
   end subroutine clear_sums

   !> Add all samples to the points near them.
   pure subroutine sum_domains(samples, front, points, shape, speed, drift, sums)
      type(sample_t), intent(in) :: samples(:)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      type(domain_shape_t), intent(in) :: shape
      real(wp), intent(in) :: speed(:)      !! (n) of the front at the points [length/time]
      real(wp), intent(in) :: drift(:, :)   !! (3,n) velocity of the material there [length/time]
      type(domain_sums_t), intent(inout) :: sums
      integer, allocatable :: near(:)
      integer :: i, k, n, m

      allocate (near(points%n))
      do i = 1, size(samples)
         call points_near(front, points, samples(i), shape%reach, near, n)
         do k = 1, n
            m = near(k)
            if (.not. same_part(front, points, m, samples(i)%edge)) cycle
            call add_sample(samples(i), points, m, shape, speed(m), drift(:, m), sums)
         end do
      end do
   end subroutine sum_domains

   !> Points within reach of a sample's place on the front, along the front to both sides.
   pure subroutine points_near(front, points, s, reach, near, n)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      type(sample_t), intent(in) :: s
      real(wp), intent(in) :: reach          !! [length]
      integer, intent(inout) :: near(:)      !! filled up to n
      integer, intent(out) :: n
      integer :: node, edge, way

      n = 0
      do way = 2, 1, -1
         node = front%edge_node(way, s%edge)
         do while (n < size(near))
            if (norm2(s%foot - points%x(:, node)) > reach) exit
            if (n > 0) then
               if (node == near(1) .and. way == 2) return
               if (way == 1 .and. any(near(:n) == node)) return
            end if
            n = n + 1
            near(n) = node
            edge = front%node_edge(way, node)
            if (edge == 0) exit
            node = front%edge_node(way, edge)
         end do
      end do
   end subroutine points_near

   !> Add one sample to one point.
   pure subroutine add_sample(s, points, m, shape, speed, drift, sums)
      type(sample_t), intent(in) :: s
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: m
      type(domain_shape_t), intent(in) :: shape
      real(wp), intent(in) :: speed, drift(3)
      type(domain_sums_t), intent(inout) :: sums
      real(wp) :: flux(3, 5), source(5), across(5), tilt(5), value(5), d(3), g(3)
      real(wp) :: l, dl, w, dw, fade
      integer :: k

      d = matmul(s%x - points%x(:, m), points%frame(:, :, m))
      if (abs(d(3)) >= shape%half_width) return
      call window_at(d(3), shape%half_width, l, dl)
      call direction_at(points, m, s%x, shape%half_width, g, fade)
      tilt = 0
      if (abs(fade) > 0) then
         call fluxes(s, points, m, d, points%outward(:, m), speed, drift, flux, source)
         tilt = fade*matmul(points%outward(:, m), flux)
      end if
      call fluxes(s, points, m, d, g, speed, drift, flux, source)
      across = matmul(matmul(s%away, points%frame(:, :, m)), flux)
      do k = size(shape%radius), 1, -1
         if (s%r >= shape%radius(k)) exit
         call profile(s%r, shape%inner, shape%radius(k), w, dw)
         value = s%volume*(dw*l*across + w*dl*flux(3, :) + w*l*tilt) + w*l*source
         sums%j(k, m) = sums%j(k, m) + value(1)
         sums%interaction(:, k, m) = sums%interaction(:, k, m) + value(2:)
         sums%volume(k, m) = sums%volume(k, m) + s%volume*w*l
      end do
      sums%material(:, m) = sums%material(:, m) + s%volume*[1.0_wp, s%lambda, s%mu, s%density]
      if (s%r < shape%inner) sums%along(:, m) = sums%along(:, m) + s%volume*l &
         *strain_along(s, points%frame(:, :, m), points%turn(:, :, m), d, shape%inner)
   end subroutine add_sample

   !> Products of a fit of the strain along the front, e_33 = a + b g: 1, g, g**2, e_33, g e_33.
   !>
   !> On a curved front u_1 of mode I, that grows with r**(1/2), is a strain along it; g has its
   !> form, and a is what is left at the front.
   pure function strain_along(s, e, turn, d, inner) result(products)
      type(sample_t), intent(in) :: s
      real(wp), intent(in) :: e(3, 3), turn(3, 3)   !! frame, turn of the material
      real(wp), intent(in) :: d(3), inner           !! place in the frame, length of g [length]
      real(wp) :: products(5), g, r, strain

      r = norm2(d(:2))
      g = 0
      if (r > 0) g = sqrt(0.5_wp*(r + d(1))/inner)*(2 - 2*s%lambda/(s%lambda + s%mu) + 1 - d(1)/r)
      strain = 1 - dot_product(e(:, 3), matmul(turn, matmul(s%back, e(:, 3))))
      products = [1.0_wp, g, g*g, strain, g*strain]
   end function strain_along

   !> Flux and source of J (1), of the interaction with modes I to III (2:4) and with a line force
   !> (5), in the frame, for a direction of q without a part along e2.
   pure subroutine fluxes(s, points, m, d, g, speed, drift, flux, source)
      type(sample_t), intent(in) :: s
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: m                      !! point
      real(wp), intent(in) :: d(3)                  !! place in the frame [length]
      real(wp), intent(in) :: g(3)                  !! direction in the frame
      real(wp), intent(in) :: speed, drift(3)       !! of the front, of the material [length/time]
      real(wp), intent(out) :: flux(3, 5)           !! [stress], interaction [stress/K]
      real(wp), intent(out) :: source(5)            !! [force], interaction [force/K]
      real(wp) :: e(3, 3), t(3, 3), h(3), f(3), unit_stress(6, 4), slope(3, 4), poisson, energy
      integer :: k

      e = points%frame(:, :, m)
      t = matmul(transpose(e), matmul(full(s%stress), e))
      h = g - matmul(matmul(points%turn(:, :, m), matmul(s%back, matmul(e, g))), e)
      f = matmul(s%pull, e)
      flux(:, 1) = matmul(t, h) - s%work*g
      source(1) = dot_product(f, h)
      if (speed > 0) call add_kinetic(s, matmul(e, g), g, drift, flux(:, 1), source(1))
      poisson = 0.5_wp*s%lambda/(s%lambda + s%mu)
      call near_tip_fields(d(1), d(2), s%side, s%mu, poisson, unit_stress(:, :3), slope(:, :3))
      call line_force_field(d(1), d(2), s%mu, poisson, unit_stress(:, 4), slope(:, 4))
      do k = 1, 4
         energy = product_of(t, strain_of(unit_stress(:, k), s%mu, poisson))
         flux(:, k + 1) = g(1)*matmul(t, slope(:, k)) + matmul(full(unit_stress(:, k)), h) &
            - energy*g
         source(k + 1) = g(1)*dot_product(f, slope(:, k))
      end do
   end subroutine fluxes

   !> Kinetic energy of a moving front: velocity relative to the material at the front.
   pure subroutine add_kinetic(s, along, g, drift, flux, source)
      type(sample_t), intent(in) :: s
      real(wp), intent(in) :: along(3), g(3)   !! direction of q in space, in the frame
      real(wp), intent(in) :: drift(3)
      real(wp), intent(inout) :: flux(3)       !! [stress]
      real(wp), intent(inout) :: source        !! [force]
      real(wp) :: v(3)

      v = s%v - drift
      flux = flux - 0.5_wp*s%density*sum(v*v)*g
      source = source - s%volume*s%density*dot_product(v, matmul(s%rate, along))
   end subroutine add_kinetic

   !> w and dw/dr: 1 up to the inner radius, then a cosine to 0.
   pure subroutine profile(r, inner, outer, w, dw)
      real(wp), intent(in) :: r, inner, outer   !! [length]
      real(wp), intent(out) :: w, dw            !! 0 to 1, [1/length]
      real(wp) :: z

      w = 1
      dw = 0
      if (r <= inner) return
      z = pi*(r - inner)/(outer - inner)
      w = 0.5_wp*(1 + cos(z))
      dw = -0.5_wp*pi/(outer - inner)*sin(z)
   end subroutine profile

   !> Integral of w over the plane normal to a front: what the volume is over the window length.
   pure function plateau_area(inner, outer) result(area)
      real(wp), intent(in) :: inner, outer   !! [length]
      real(wp) :: area, d                    !! [length^2]

      d = outer - inner
      area = pi*inner**2 + pi*(inner*d + d*d*(0.5_wp - 2/pi**2))
   end function plateau_area

   !> A symmetric tensor from its components 11 22 33 12 23 13.
   pure function full(s) result(t)
      real(wp), intent(in) :: s(6)
      real(wp) :: t(3, 3)

      t(:, 1) = [s(1), s(4), s(6)]
      t(:, 2) = [s(4), s(2), s(5)]
      t(:, 3) = [s(6), s(5), s(3)]
   end function full

   !> t : e for a symmetric e given as 11 22 33 12 23 13.
   pure function product_of(t, e) result(product)
      real(wp), intent(in) :: t(3, 3), e(6)
      real(wp) :: product

      product = t(1, 1)*e(1) + t(2, 2)*e(2) + t(3, 3)*e(3) &
                + 2*(t(1, 2)*e(4) + t(2, 3)*e(5) + t(1, 3)*e(6))
   end function product_of
end module xmpm_domain_integral
