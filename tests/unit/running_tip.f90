!> Exact field near a mode I crack tip that moves at a constant speed along x (Freund 1990,
!> section 4.3), for tests.
!>
!> With z_d = x + i alpha_d y and z_s = x + i alpha_s y, fixed to the tip,
!>
!>    u_x = b Re[(1 + alpha_s**2) sqrt(z_d) - 2 alpha_d alpha_s sqrt(z_s)],
!>    u_y = b alpha_d Im[-(1 + alpha_s**2) sqrt(z_d) + 2 sqrt(z_s)].
module running_tip
   use xmpm_kinds, only: wp, pi
   implicit none
   private

   public :: tip_at

contains

   !> Displacement gradient, stress, and second derivatives by x for an intensity factor of one.
   pure subroutine tip_at(x, y, speed, lambda, mu, density, gradient, stress, second)
      real(wp), intent(in) :: x, y                   !! from the tip
      real(wp), intent(in) :: speed                  !! above 0, below the Rayleigh speed
      real(wp), intent(in) :: lambda, mu, density
      real(wp), intent(out) :: gradient(3, 3)        !! du_i/dx_j
      real(wp), intent(out) :: stress(6)             !! xx yy zz xy yz xz
      real(wp), intent(out) :: second(3)             !! d2 u_i/dx2
      real(wp) :: ad, as, b, c
      complex(wp) :: fd, fs, dd, ds
      complex(wp), parameter :: one = (1.0_wp, 0.0_wp)

      ad = sqrt(1 - speed**2*density/(lambda + 2*mu))
      as = sqrt(1 - speed**2*density/mu)
      c = 1 + as**2
      b = 1/(mu*sqrt(2*pi)*(4*ad*as - c**2))
      fd = one/sqrt(cmplx(x, ad*y, wp))
      fs = one/sqrt(cmplx(x, as*y, wp))
      dd = fd**3
      ds = fs**3
      gradient = 0
      gradient(1, 1) = b*(c*real(fd, wp) - 2*ad*as*real(fs, wp))
      gradient(1, 2) = b*(-c*ad*aimag(fd) + 2*ad*as**2*aimag(fs))
      gradient(2, 1) = b*ad*(-c*aimag(fd) + 2*aimag(fs))
      gradient(2, 2) = b*ad*(-c*ad*real(fd, wp) + 2*as*real(fs, wp))
      stress = 0
      stress(:3) = lambda*(gradient(1, 1) + gradient(2, 2))
      stress(1) = stress(1) + 2*mu*gradient(1, 1)
      stress(2) = stress(2) + 2*mu*gradient(2, 2)
      stress(4) = mu*(gradient(1, 2) + gradient(2, 1))
      second = -0.5_wp*b*[c*real(dd, wp) - 2*ad*as*real(ds, wp), ad*(-c*aimag(dd) + 2*aimag(ds)), &
         0.0_wp]
   end subroutine tip_at
end module running_tip
