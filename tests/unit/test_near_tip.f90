!> The near-tip fields of the three modes: they are elastic states of a cracked body.
program test_near_tip
   use xmpm_kinds, only: wp, pi
   use xmpm_near_tip, only: strain_of
   use near_tip_states, only: near_tip_fields
   use testing, only: suite_t, check, check_close, finish
   implicit none
   real(wp), parameter :: mu = 3.0_wp, poisson = 0.298_wp
   real(wp), parameter :: step = 1e-4_wp   !! of differences; error about step**2 of 1/r**2 = 1
   type(suite_t) :: suite

   suite%name = 'near_tip'
   call equilibrium()
   call compatibility()
   call release_rates()
   call faces()
   call branch()
   call intensities()
   call finish(suite)

contains

   !> s_ij,j = 0.
   subroutine equilibrium()
      real(wp) :: s1(6, 3), s2(6, 3), g(3, 3), pull(3, 3), worst
      integer :: i

      worst = 0
      do i = 1, 24
         call derivatives(angle(i), s1, s2, g)
         pull(1, :) = s1(1, :) + s2(4, :)
         pull(2, :) = s1(4, :) + s2(2, :)
         pull(3, :) = s1(6, :) + s2(5, :)
         worst = max(worst, maxval(abs(pull)))
      end do
      ! differences of second order: 1e-8 times third derivatives of order 1
      call check_close(suite, 'divergence of stress', worst, 0.0_wp, 1e-7_wp, 0.0_wp)
   end subroutine equilibrium

   !> The strain of the stress is that of u: e_11 at once, the others after one more derivative.
   subroutine compatibility()
      real(wp) :: s1(6, 3), s2(6, 3), g1(3, 3), g2(3, 3), s(6, 3), g(3, 3), e(6), e1(6), off(5)
      real(wp) :: worst, x(2)
      integer :: i, k

      worst = 0
      do i = 1, 24
         x = [cos(angle(i)), sin(angle(i))]
         call near_tip_fields(x(1), x(2), sign(1.0_wp, x(2)), mu, poisson, s, g)
         call derivatives(angle(i), s1, s2, g1, g2)
         do k = 1, 3
            e = strain_of(s(:, k), mu, poisson)
            e1 = strain_of(s1(:, k), mu, poisson)
            off = [e(1) - g(1, k), 2*e(6) - g(3, k), e1(2) - g2(2, k), &
               2*e1(4) - g2(1, k) - g1(2, k), 2*e1(5) - g2(3, k)]
            ! plane strain
            worst = max(worst, maxval(abs(off)), abs(e(3)))
         end do
      end do
      call check_close(suite, 'strain of stress and of displacement', worst, 0.0_wp, 1e-7_wp, &
         0.0_wp)
   end subroutine compatibility

   !> J on a circle: (1 - nu)/(2 mu) for I and II, 1/(2 mu) for III, and nothing between modes.
   subroutine release_rates()
      real(wp) :: j(3, 3), s(6, 3), g(3, 3), n(2), t(3, 3), exact(3, 3)
      integer :: i, k, m
      integer, parameter :: points = 24   !! exact: the integrand is a short Fourier sum

      j = 0
      do i = 1, points
         n = [cos(pi*(2*real(i, wp) - 1)/points - pi), sin(pi*(2*real(i, wp) - 1)/points - pi)]
         call near_tip_fields(2.5_wp*n(1), 2.5_wp*n(2), sign(1.0_wp, n(2)), mu, poisson, s, g)
         t(1, :) = s(1, :)*n(1) + s(4, :)*n(2)
         t(2, :) = s(4, :)*n(1) + s(2, :)*n(2)
         t(3, :) = s(6, :)*n(1) + s(5, :)*n(2)
         do k = 1, 3
            do m = 1, 3
               j(m, k) = j(m, k) + 2*pi*2.5_wp/points*(0.5_wp*work(s(:, m), s(:, k))*n(1) &
                  - 0.5_wp*(dot_product(t(:, m), g(:, k)) + dot_product(t(:, k), g(:, m))))
            end do
         end do
      end do
      exact = 0
      exact(1, 1) = 0.5_wp*(1 - poisson)/mu
      exact(2, 2) = exact(1, 1)
      exact(3, 3) = 0.5_wp/mu
      ! rounding
      call check_close(suite, 'J of the modes and between them', maxval(abs(j - exact)), 0.0_wp, &
         1e-15_wp, 0.0_wp)
   end subroutine release_rates

   !> Behind the front both faces are free.
   subroutine faces()
      real(wp) :: s(6, 3), g(3, 3)
      integer :: side

      do side = -1, 1, 2
         call near_tip_fields(-1.0_wp, 0.0_wp, real(side, wp), mu, poisson, s, g)
         call check_close(suite, 'tractions on the faces', maxval(abs(s([2, 4, 5], :))), 0.0_wp, &
            1e-15_wp, 0.0_wp)
      end do
   end subroutine faces

   !> Behind the front the side decides, even where x2 says otherwise; ahead it does not matter.
   subroutine branch()
      real(wp) :: s(6, 3, 2), g(3, 3, 2)
      real(wp), parameter :: near = 1e-9_wp
      real(wp), parameter :: even(6, 3) = reshape(real([1, 1, 1, -1, -1, 1, -1, -1, -1, 1, 1, -1, &
         1, 1, 1, 1, 1, -1], wp), [6, 3])

      call near_tip_fields(-1.0_wp, -near, 1.0_wp, mu, poisson, s(:, :, 1), g(:, :, 1))
      call near_tip_fields(-1.0_wp, near, 1.0_wp, mu, poisson, s(:, :, 2), g(:, :, 2))
      ! 2e-9 times slopes of order 1
      call check_close(suite, 'a particle above the crack, pressed through its plane', &
         maxval(abs(s(:, :, 1) - s(:, :, 2))), 0.0_wp, 1e-8_wp, 0.0_wp)
      call check_close(suite, 'its slope', maxval(abs(g(:, :, 1) - g(:, :, 2))), 0.0_wp, 1e-8_wp, &
         0.0_wp)
      call near_tip_fields(-1.0_wp, near, -1.0_wp, mu, poisson, s(:, :, 2), g(:, :, 2))
      ! modes I even, II odd; s_13 of mode III odd
      call check_close(suite, 'the other face', maxval(abs(s(:, :, 1)*even - s(:, :, 2))), 0.0_wp, &
         1e-8_wp, 0.0_wp)
      call check(suite, 'slope of the opening', g(2, 1, 1) < -0.01_wp .and. g(2, 1, 2) > 0.01_wp)
      call near_tip_fields(1.0_wp, 0.3_wp, 1.0_wp, mu, poisson, s(:, :, 1), g(:, :, 1))
      call near_tip_fields(1.0_wp, 0.3_wp, -1.0_wp, mu, poisson, s(:, :, 2), g(:, :, 2))
      call check_close(suite, 'ahead of the front', maxval(abs(s(:, :, 1) - s(:, :, 2))), 0.0_wp, &
         0.0_wp, 0.0_wp)
      call near_tip_fields(0.0_wp, 0.0_wp, 1.0_wp, mu, poisson, s(:, :, 1), g(:, :, 1))
      call check(suite, 'a particle on the front counts nothing', &
         .not. (any(abs(s(:, :, 1)) > 0) .or. any(abs(g(:, :, 1)) > 0)))
   end subroutine branch

   !> K is s_22, s_12, s_23 (2 pi r)**(1/2) ahead of the front.
   subroutine intensities()
      real(wp) :: s(6, 3), g(3, 3)

      call near_tip_fields(0.5_wp, 0.0_wp, 1.0_wp, mu, poisson, s, g)
      call check_close(suite, 'K_I', s(2, 1)*sqrt(pi), 1.0_wp, 1e-14_wp, 0.0_wp)
      call check_close(suite, 'K_II', s(4, 2)*sqrt(pi), 1.0_wp, 1e-14_wp, 0.0_wp)
      call check_close(suite, 'K_III', s(5, 3)*sqrt(pi), 1.0_wp, 1e-14_wp, 0.0_wp)
   end subroutine intensities

   !> Off the axes, where the branch is at stake, on all sides.
   pure function angle(i) result(theta)
      integer, intent(in) :: i
      real(wp) :: theta

      theta = 2*pi*(real(i, wp) - 0.5_wp)/24 - pi
   end function angle

   !> Central differences at radius 1.
   subroutine derivatives(theta, s1, s2, g1, g2)
      real(wp), intent(in) :: theta
      real(wp), intent(out) :: s1(6, 3), s2(6, 3), g1(3, 3)
      real(wp), intent(out), optional :: g2(3, 3)
      real(wp) :: s(6, 3, 4), g(3, 3, 4), x(2), side
      integer :: k
      real(wp), parameter :: move(2, 4) = step*reshape(real([1, 0, -1, 0, 0, 1, 0, -1], wp), [2, 4])

      side = sign(1.0_wp, sin(theta))
      do k = 1, 4
         x = [cos(theta), sin(theta)] + move(:, k)
         call near_tip_fields(x(1), x(2), side, mu, poisson, s(:, :, k), g(:, :, k))
      end do
      s1 = 0.5_wp/step*(s(:, :, 1) - s(:, :, 2))
      s2 = 0.5_wp/step*(s(:, :, 3) - s(:, :, 4))
      g1 = 0.5_wp/step*(g(:, :, 1) - g(:, :, 2))
      if (present(g2)) g2 = 0.5_wp/step*(g(:, :, 3) - g(:, :, 4))
   end subroutine derivatives

   !> s : e of two stresses.
   pure function work(s, other) result(w)
      real(wp), intent(in) :: s(6), other(6)
      real(wp) :: w, e(6)

      e = strain_of(other, mu, poisson)
      w = sum(s(:3)*e(:3)) + 2*sum(s(4:)*e(4:))
   end function work
end program test_near_tip
