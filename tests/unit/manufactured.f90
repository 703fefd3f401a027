!> The manufactured solution and the body force that makes it exact; E = 1e7, nu = 0.3, rho = 1000.
module manufactured
   use xmpm_kinds, only: wp, pi
   implicit none
   private

   public :: force_of_solution, motion, amplitude_of

   real(wp), parameter :: young = 1e7_wp, poisson = 0.3_wp, density = 1000
   real(wp), parameter :: stiffness = young*(1 - poisson)/((1 + poisson)*(1 - 2*poisson))
   real(wp) :: amplitude = 0   !! A [length]; a pure force of a given shape has no other way in

contains

   !> Set the amplitude of what follows.
   subroutine amplitude_of(a)
      real(wp), intent(in) :: a   !! [length]

      amplitude = a
   end subroutine amplitude_of

   !> Displacement and velocity of a material point.
   pure subroutine motion(x0, time, u, v)
      real(wp), intent(in) :: x0(3), time   !! [length], [time]
      real(wp), intent(out) :: u(3), v(3)   !! [length], [length/time]
      real(wp) :: rate

      rate = pi*sqrt(young/density)
      u = amplitude*sin(2*pi*x0)*sin(rate*time)
      v = amplitude*sin(2*pi*x0)*rate*cos(rate*time)
   end subroutine motion

   !> b = a + (2 pi)^2 u (lambda + 2 mu) J / (rho F^2) for all lanes.
   pure subroutine force_of_solution(time, x0, force)
      real(wp), intent(in) :: time          !! [time]
      real(wp), intent(in) :: x0(8, 3)      !! [length]
      real(wp), intent(out) :: force(8, 3)  !! on a mass [length/time^2]
      real(wp) :: u(3), v(3), f(3), rate
      integer :: k

      rate = pi*sqrt(young/density)
      do k = 1, 8
         call motion(x0(k, :), time, u, v)
         f = 1 + 2*pi*amplitude*cos(2*pi*x0(k, :))*sin(rate*time)
         force(k, :) = -rate**2*u + (2*pi)**2*u*stiffness*product(f)/(density*f**2)
      end do
   end subroutine force_of_solution
end module manufactured
