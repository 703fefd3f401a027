!> A vortex in hypoelastic material with the Jaumann rate, and the body force that makes it exact.
!>
!> Circles turn about the z axis by the angle alpha(R, t) = g(t) (1 - R^2)^3 for R < 1, with g =
!> A (1 - cos(2 pi t))/2; what lies outside is at rest. Seen from a particle this is simple shear by
!> gamma = R dalpha/dR, so that in polar directions s_rt = mu sin(gamma), s_tt = -s_rr =
!> mu (1 - cos(gamma)), and the momentum balance in r and theta gives the body force.
module vortex
   use xmpm_kinds, only: wp, pi
   implicit none
   private

   public :: turn_of, force_of_vortex, shear_modulus, amplitude

   real(wp), parameter :: amplitude = 1                           !! A [rad]
   real(wp), parameter :: shear_modulus = 1000/(2*1.3_wp)         !! E = 1000, nu = 0.3 [stress]
   real(wp), parameter :: density = 1000

contains

   !> Angle of a circle, its derivatives by R, and by time.
   pure subroutine turn_of(r, time, angle, slope, bend, rate, acceleration)
      real(wp), intent(in) :: r, time        !! [length], [time]
      real(wp), intent(out) :: angle         !! alpha [rad]
      real(wp), intent(out) :: slope, bend   !! dalpha/dR, d2alpha/dR2
      real(wp), intent(out) :: rate          !! [rad/time]
      real(wp), intent(out) :: acceleration  !! [rad/time^2]
      real(wp) :: g, q

      q = max(0.0_wp, 1 - r**2)
      g = 0.5_wp*amplitude*(1 - cos(2*pi*time))
      angle = g*q**3
      slope = -6*g*r*q**2
      bend = g*(24*r**2*q - 6*q**2)
      rate = amplitude*pi*sin(2*pi*time)*q**3
      acceleration = 2*amplitude*pi**2*cos(2*pi*time)*q**3
   end subroutine turn_of

   !> Body force of all lanes, on a mass.
   pure subroutine force_of_vortex(time, x0, force)
      real(wp), intent(in) :: time          !! [time]
      real(wp), intent(in) :: x0(8, 3)      !! [length]
      real(wp), intent(out) :: force(8, 3)  !! [length/time^2]
      real(wp) :: r, angle, slope, bend, rate, acceleration, shear, change, along(2), c
      integer :: k

      c = shear_modulus/density
      force = 0
      do k = 1, 8
         r = hypot(x0(k, 1), x0(k, 2))
         if (.not. (r > 0 .and. r < 1)) cycle
         call turn_of(r, time, angle, slope, bend, rate, acceleration)
         shear = r*slope
         change = slope + r*bend
         along(1) = -r*rate**2 + c*(change*sin(shear) + 2*(1 - cos(shear))/r)
         along(2) = r*acceleration - c*(change*cos(shear) + 2*sin(shear)/r)
         angle = angle + atan2(x0(k, 2), x0(k, 1))
         force(k, 1) = along(1)*cos(angle) - along(2)*sin(angle)
         force(k, 2) = along(1)*sin(angle) + along(2)*cos(angle)
      end do
   end subroutine force_of_vortex
end module vortex
