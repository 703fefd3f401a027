!> Exact static field of a penny-shaped crack under remote tension, for tests.
!>
!> Sneddon's problem in closed form (complex-source potential): crack of radius a in z = 0, faces
!> free, tension p along z far away.
module penny_field
   use xmpm_kinds, only: wp, pi
   implicit none
   private

   public :: penny_at

contains

   !> Stress and displacement gradient at a point off the front.
   pure subroutine penny_at(x, a, p, young, poisson, stress, gradient)
      real(wp), intent(in) :: x(3)             !! from the crack's centre
      real(wp), intent(in) :: a, p             !! radius, tension
      real(wp), intent(in) :: young, poisson
      real(wp), intent(out) :: stress(6)       !! xx yy zz xy yz xz
      real(wp), intent(out) :: gradient(3, 3)  !! du_i/dx_j
      real(wp) :: r, z, way, mu, c, e(3, 3), g(3, 3), s(3, 3)
      real(wp) :: pz, pzz, pzzz, prz, przz, pr, prr, prrz
      complex(wp) :: w, root, l
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp), one = (1.0_wp, 0.0_wp)

      r = norm2(x(:2))
      z = abs(x(3))
      way = merge(-1.0_wp, 1.0_wp, x(3) < 0)
      mu = young/(2*(1 + poisson))
      w = cmplx(z, -a, wp)
      root = sqrt(cmplx(r*r, 0.0_wp, wp) + w*w)
      l = log(w + root)
      c = 2*p/pi
      pz = -c*(-aimag(root) + z*aimag(l))
      pzz = -c*(aimag(l) + a*aimag(i/root))
      pzzz = -c*(aimag(one/root) - a*aimag(i*w/root**3))
      prz = -c*r*(-aimag(one/root) + z*aimag(one/(root*(w + root))))
      przz = -c*r*(aimag(one/(root*(w + root))) - a*aimag(i/root**3))
      pr = c/r*(-0.5_wp*aimag(w*root) + 0.5_wp*r*r*aimag(l) + z*aimag(root))
      prr = -pr/r - pzz
      prrz = -prz/r - pzzz
      g = 0
      g(1, 1) = (1 - 2*poisson)*prr + z*prrz
      g(1, 3) = way*((2 - 2*poisson)*prz + z*przz)
      g(3, 1) = way*(-2*(1 - poisson)*prz + z*przz)
      g(3, 3) = -(1 - 2*poisson)*pzz + z*pzzz
      g(2, 2) = ((1 - 2*poisson)*pr + z*prz)/r
      g = g/(2*mu)
      g(1, 1) = g(1, 1) - poisson*p/young
      g(2, 2) = g(2, 2) - poisson*p/young
      g(3, 3) = g(3, 3) + p/young
      s = 0
      s(1, 1) = -2*poisson*pzz + (1 - 2*poisson)*prr + z*prrz
      s(2, 2) = -2*poisson*pzz + (1 - 2*poisson)*pr/r + z*prz/r
      s(3, 3) = -pzz + z*pzzz + p
      s(1, 3) = way*z*przz
      s(3, 1) = s(1, 3)
      e(:, 1) = [x(1)/r, x(2)/r, 0.0_wp]
      e(:, 2) = [-x(2)/r, x(1)/r, 0.0_wp]
      e(:, 3) = [0.0_wp, 0.0_wp, 1.0_wp]
      gradient = matmul(e, matmul(g, transpose(e)))
      s = matmul(e, matmul(s, transpose(e)))
      stress = [s(1, 1), s(2, 2), s(3, 3), s(1, 2), s(2, 3), s(1, 3)]
   end subroutine penny_at
end module penny_field
