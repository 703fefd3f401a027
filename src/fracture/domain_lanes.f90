!> The integrands of the domain form for several samples at once, as one point of a front sees
!> them: what is in the lanes of an array is in the frame of the point.
module xmpm_domain_lanes
   use xmpm_kinds, only: wp
   use xmpm_samples, only: sample_t
   use xmpm_front_points, only: front_points_t
   use xmpm_near_tip, only: unit_states
   implicit none
   private

   public :: width, view_t, look, aim, flux_along, strain_along

   integer, parameter :: width = 16   !! lanes: two vectors of 8, so that one need not wait for its
                                      !! own roots and series

   !> Samples in the lanes. Directions of q have no part along e2.
   type :: view_t
      real(wp) :: d(width, 3)          !! place [length]
      real(wp) :: r(width)             !! distance from the front [length]
      real(wp) :: away(width, 3)       !! unit vector from the front
      real(wp) :: stress(width, 6)     !! 11 22 33 12 23 13 [stress]
      real(wp) :: strain(width, 6)     !! that goes with it, 12 23 13 twice
      real(wp) :: pull(width, 3)       !! force of the divergence of stress [force]
      real(wp) :: work(width)          !! stress work [stress]
      real(wp) :: back(width, 3, 3)    !! inverse of the deformation gradient, in space
      real(wp) :: volume(width)        !! [length^3], 0 in lanes without a sample
      real(wp) :: poisson(width)       !! Poisson's ratio
      real(wp) :: mean(width, 4)       !! volume, and it times lambda, mu, density
      real(wp) :: plane(width, 6, 3)   !! 11 22 33 12, u_1,1 u_2,1 of modes I, II, a line force
      real(wp) :: shear(width, 3)      !! 23 13, u_3,1 of mode III
      real(wp) :: g(width, 3)          !! direction of q
      real(wp) :: h(width, 3)          !! u_i,k g_k
      real(wp) :: energy(width)        !! of stress work and relative motion [stress]
      real(wp) :: source(width, 5)     !! of J, of interactions I to III and force [force, force/K]
   end type view_t

contains

   !> See samples from a point.
   pure subroutine look(samples, chosen, points, m, view)
      type(sample_t), intent(in) :: samples(:)
      integer, intent(in) :: chosen(:)               !! samples for the first lanes; at least one
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: m                       !! point
      type(view_t), intent(out) :: view              !! without what `aim` adds
      real(wp) :: e(3, 3), x(width, 3), away(width, 3), s(width, 6), pull(width, 3)
      real(wp) :: side(width), lambda(width), mu(width)
      integer :: i

      e = points%frame(:, :, m)
      do i = 1, width
         associate (p => samples(chosen(min(i, size(chosen)))))
            x(i, :) = p%x - points%x(:, m)
            view%r(i) = p%r
            away(i, :) = p%away
            s(i, :) = p%stress
            pull(i, :) = p%pull
            view%back(i, :, :) = p%back
            view%work(i) = p%work
            view%volume(i) = p%volume
            side(i) = p%side
            lambda(i) = p%lambda
            mu(i) = p%mu
            view%mean(i, 4) = p%volume*p%density
         end associate
      end do
      view%volume(size(chosen) + 1:) = 0
      view%mean(size(chosen) + 1:, 4) = 0
      pull(size(chosen) + 1:, :) = 0
      view%mean(:, 1) = view%volume
      view%mean(:, 2) = view%volume*lambda
      view%mean(:, 3) = view%volume*mu
      view%poisson = 0.5_wp*lambda/(lambda + mu)
      call turn_vectors(e, x, view%d)
      call turn_vectors(e, away, view%away)
      call turn_vectors(e, pull, view%pull)
      call turn_tensors(e, s, view%stress)
      call find_strain(view%stress, mu, view%poisson, view%strain)
      call unit_states(width, view%d(:, 1), view%d(:, 2), side, mu, view%poisson, view%plane, &
         view%shear)
   end subroutine look

   !> Components of vectors in a frame.
   pure subroutine turn_vectors(e, x, d)
      real(wp), intent(in) :: e(3, 3), x(width, 3)
      real(wp), intent(out) :: d(width, 3)
      integer :: i, k

      do k = 1, 3
         !$omp simd
         do i = 1, width
            d(i, k) = e(1, k)*x(i, 1) + e(2, k)*x(i, 2) + e(3, k)*x(i, 3)
         end do
      end do
   end subroutine turn_vectors

   !> Components of symmetric tensors, 11 22 33 12 23 13, in a frame.
   pure subroutine turn_tensors(e, s, t)
      real(wp), intent(in) :: e(3, 3), s(width, 6)
      real(wp), intent(out) :: t(width, 6)
      real(wp) :: a, b, c
      integer :: i, k
      integer, parameter :: place(3, 3) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3], [3, 3])

      do k = 1, 3
         !$omp simd private(a, b, c)
         do i = 1, width
            a = s(i, 1)*e(1, k) + s(i, 4)*e(2, k) + s(i, 6)*e(3, k)
            b = s(i, 4)*e(1, k) + s(i, 2)*e(2, k) + s(i, 5)*e(3, k)
            c = s(i, 6)*e(1, k) + s(i, 5)*e(2, k) + s(i, 3)*e(3, k)
            t(i, place(1, k)) = e(1, 1)*a + e(2, 1)*b + e(3, 1)*c
            t(i, place(2, k)) = e(1, 2)*a + e(2, 2)*b + e(3, 2)*c
            t(i, place(3, k)) = e(1, 3)*a + e(2, 3)*b + e(3, 3)*c
         end do
      end do
   end subroutine turn_tensors

   !> Strain of stress; 12 23 13 twice.
   pure subroutine find_strain(t, mu, poisson, e)
      real(wp), intent(in) :: t(width, 6), mu(width), poisson(width)
      real(wp), intent(out) :: e(width, 6)
      real(wp) :: pressure, half
      integer :: i

      !$omp simd private(pressure, half)
      do i = 1, width
         half = 0.5_wp/mu(i)
         pressure = poisson(i)/(1 + poisson(i))*(t(i, 1) + t(i, 2) + t(i, 3))
         e(i, 1) = half*(t(i, 1) - pressure)
         e(i, 2) = half*(t(i, 2) - pressure)
         e(i, 3) = half*(t(i, 3) - pressure)
         e(i, 4) = 2*half*t(i, 4)
         e(i, 5) = 2*half*t(i, 5)
         e(i, 6) = 2*half*t(i, 6)
      end do
   end subroutine find_strain

   !> What depends on the direction view%g of q.
   pure subroutine aim(samples, chosen, points, m, speed, drift, view)
      type(sample_t), intent(in) :: samples(:)
      integer, intent(in) :: chosen(:), m            !! as for `look`
      type(front_points_t), intent(in) :: points
      real(wp), intent(in) :: speed, drift(3)        !! of the front, of the material [length/time]
      type(view_t), intent(inout) :: view            !! g is known
      real(wp) :: e(3, 3), t(3, 3), back_e(3, 3), along(width, 3), x(width, 3), g1, v(3)
      integer :: i, k

      e = points%frame(:, :, m)
      back_e = transpose(e)
      t = points%turn(:, :, m)
      t = matmul(transpose(t), e)
      call turn_vectors(back_e, view%g, along)
      do k = 1, 3
         !$omp simd
         do i = 1, width
            x(i, k) = view%back(i, k, 1)*along(i, 1) + view%back(i, k, 2)*along(i, 2) &
               + view%back(i, k, 3)*along(i, 3)
         end do
      end do
      call turn_vectors(t, x, view%h)
      view%h = view%g - view%h
      view%energy = view%work
      !$omp simd private(g1)
      do i = 1, width
         g1 = view%g(i, 1)
         view%source(i, 1) = view%pull(i, 1)*view%h(i, 1) + view%pull(i, 2)*view%h(i, 2) &
            + view%pull(i, 3)*view%h(i, 3)
         view%source(i, 2) = g1*(view%pull(i, 1)*view%plane(i, 5, 1) &
            + view%pull(i, 2)*view%plane(i, 6, 1))
         view%source(i, 3) = g1*(view%pull(i, 1)*view%plane(i, 5, 2) &
            + view%pull(i, 2)*view%plane(i, 6, 2))
         view%source(i, 4) = g1*view%pull(i, 3)*view%shear(i, 3)
         view%source(i, 5) = g1*(view%pull(i, 1)*view%plane(i, 5, 3) &
            + view%pull(i, 2)*view%plane(i, 6, 3))
      end do
      if (.not. speed > 0) return
      do i = 1, size(chosen)
         associate (s => samples(chosen(i)))
            v = s%v - drift
            view%energy(i) = view%energy(i) + 0.5_wp*s%density*sum(v*v)
            view%source(i, 1) = view%source(i, 1) - s%volume*s%density &
               *dot_product(v, matmul(s%rate, matmul(e, view%g(i, :))))
         end associate
      end do
   end subroutine aim

   !> Components along c, in the frame, of the flux of J (1), of the interaction with modes I to III
   !> (2:4) and with a line force (5).
   pure subroutine flux_along(view, c, flux)
      type(view_t), intent(in) :: view
      real(wp), intent(in) :: c(width, 3)
      real(wp), intent(out) :: flux(width, 5)        !! [stress], interaction [stress/K]
      real(wp) :: t(width, 3), p(width, 6), g1, c1, c2, c3, h1, h2, h3, cg
      integer :: i, k
      integer, parameter :: place(3) = [2, 3, 5]   !! in flux

      !$omp simd private(c1, c2, c3, h1, h2, h3, cg)
      do i = 1, width
         c1 = c(i, 1)
         c2 = c(i, 2)
         c3 = c(i, 3)
         h1 = view%h(i, 1)
         h2 = view%h(i, 2)
         h3 = view%h(i, 3)
         t(i, 1) = view%stress(i, 1)*c1 + view%stress(i, 4)*c2 + view%stress(i, 6)*c3
         t(i, 2) = view%stress(i, 4)*c1 + view%stress(i, 2)*c2 + view%stress(i, 5)*c3
         t(i, 3) = view%stress(i, 6)*c1 + view%stress(i, 5)*c2 + view%stress(i, 3)*c3
         cg = c1*view%g(i, 1) + c2*view%g(i, 2) + c3*view%g(i, 3)
         flux(i, 1) = t(i, 1)*h1 + t(i, 2)*h2 + t(i, 3)*h3 - view%energy(i)*cg
         p(i, 1) = c1*h1 - cg*view%strain(i, 1)
         p(i, 2) = c2*h2 - cg*view%strain(i, 2)
         p(i, 3) = c3*h3 - cg*view%strain(i, 3)
         p(i, 4) = c1*h2 + c2*h1 - cg*view%strain(i, 4)
         p(i, 5) = c2*h3 + c3*h2 - cg*view%strain(i, 5)
         p(i, 6) = c1*h3 + c3*h1 - cg*view%strain(i, 6)
      end do
      do k = 1, 3
         !$omp simd private(g1)
         do i = 1, width
            g1 = view%g(i, 1)
            flux(i, place(k)) = g1*(t(i, 1)*view%plane(i, 5, k) &
               + t(i, 2)*view%plane(i, 6, k)) &
               + p(i, 1)*view%plane(i, 1, k) + p(i, 2)*view%plane(i, 2, k) &
               + p(i, 3)*view%plane(i, 3, k) + p(i, 4)*view%plane(i, 4, k)
         end do
      end do
      !$omp simd
      do i = 1, width
         flux(i, 4) = view%g(i, 1)*t(i, 3)*view%shear(i, 3) + p(i, 5)*view%shear(i, 1) &
            + p(i, 6)*view%shear(i, 2)
      end do
   end subroutine flux_along

   !> Products of a fit of the strain along the front, e_33 = a + b g: 1, g, g**2, e_33, g e_33,
   !> times the volume.
   !>
   !> On a curved front u_1 of mode I, that grows with r**(1/2), is a strain along it; g has its
   !> form, and a is what is left at the front.
   pure subroutine strain_along(view, points, m, inner, products)
      type(view_t), intent(in) :: view
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: m
      real(wp), intent(in) :: inner                  !! length of g [length]
      real(wp), intent(out) :: products(width, 5)
      real(wp) :: e(3), t(3), r, live, g, strain, v
      integer :: i

      e = points%frame(:, 3, m)
      t = matmul(e, points%turn(:, :, m))
      !$omp simd private(r, live, g, strain, v)
      do i = 1, width
         v = view%volume(i)
         r = sqrt(view%d(i, 1)*view%d(i, 1) + view%d(i, 2)*view%d(i, 2))
         live = 0.5_wp + sign(0.5_wp, r - tiny(r))
         g = sqrt(0.5_wp*(r + max(view%d(i, 1), -r))/inner) &
            *(3 - 4*view%poisson(i) - view%d(i, 1)/(r + (1 - live)))
         strain = 1 - t(1)*(view%back(i, 1, 1)*e(1) + view%back(i, 1, 2)*e(2) &
            + view%back(i, 1, 3)*e(3)) - t(2)*(view%back(i, 2, 1)*e(1) &
            + view%back(i, 2, 2)*e(2) + view%back(i, 2, 3)*e(3)) - t(3)*(view%back(i, 3, 1)*e(1) &
            + view%back(i, 3, 2)*e(2) + view%back(i, 3, 3)*e(3))
         products(i, 1) = v
         products(i, 2) = v*g
         products(i, 3) = v*g*g
         products(i, 4) = v*strain
         products(i, 5) = v*g*strain
      end do
   end subroutine strain_along
end module xmpm_domain_lanes
