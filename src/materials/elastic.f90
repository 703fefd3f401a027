!> Linear elasticity in rate form with the Jaumann rate (sec. 3.2.5 of 10.1002/nme.6653).
module xmpm_elastic
   use xmpm_kinds, only: wp
   use xmpm_law, only: law_t
   implicit none
   private

   public :: elastic_t, new_elastic

   !> Isotropic hypoelastic law.
   type, extends(law_t) :: elastic_t
      real(wp) :: lambda = 0   !! first Lame constant [stress]
      real(wp) :: mu = 0       !! shear modulus [stress]
   contains
      procedure :: update => update_elastic
      procedure :: wave_speed
      procedure :: strain_energy
   end type elastic_t

contains

   !> A law from Young's modulus and Poisson's ratio.
   pure function new_elastic(name, density, young, poisson) result(law)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: density   !! [mass/length^3]
      real(wp), intent(in) :: young     !! [stress]
      real(wp), intent(in) :: poisson   !! between -1 and 0.5
      type(elastic_t) :: law

      law%name = name
      law%density = density
      law%lambda = young*poisson/((1 + poisson)*(1 - 2*poisson))
      law%mu = young/(2*(1 + poisson))
   end function new_elastic

   !> Dilatational wave speed.
   pure function wave_speed(law) result(speed)
      class(elastic_t), intent(in) :: law
      real(wp) :: speed

      speed = sqrt((law%lambda + 2*law%mu)/law%density)
   end function wave_speed

   !> Elastic energy per volume: (s : s - lambda/(3 lambda + 2 mu) (tr s)**2)/(4 mu).
   pure function strain_energy(law, stress) result(energy)
      class(elastic_t), intent(in) :: law
      real(wp), intent(in) :: stress(6)   !! xx yy zz xy yz xz
      real(wp) :: energy                  !! [stress]

      energy = (sum(stress(:3)**2) + 2*sum(stress(4:)**2) &
         - law%lambda/(3*law%lambda + 2*law%mu)*sum(stress(:3))**2)/(4*law%mu)
   end function strain_energy

   !> Stress, volume and stress work of one step.
   !>
   !> s' = s + r + (W r - r W)/2 + C : D dt with r = dt (W s - s W): the rotation is exact to second
   !> order, so that |s| does not grow as the body turns. Stress power uses the mean of both
   !> stresses.
   pure subroutine update_elastic(law, gradient, dt, q, work)
      class(elastic_t), intent(in) :: law
      real(wp), intent(in) :: gradient(8, 9)
      real(wp), intent(in) :: dt
      real(wp), intent(inout) :: q(8, 14)
      real(wp), intent(inout) :: work(8)

      call update_lanes(law%lambda, law%mu, dt, gradient, q, work)
   end subroutine update_elastic

   pure subroutine update_lanes(lambda, mu, dt, l, q, work)
      real(wp), intent(in) :: lambda, mu, dt, l(8, 9)
      real(wp), intent(inout) :: q(8, 14), work(8)
      real(wp) :: d1, d2, d3, d4, d5, d6, a, b, c, tr, pressure, power
      real(wp) :: s1, s2, s3, s4, s5, s6, r1, r2, r3, r4, r5, r6, half
      integer :: p

      half = 0.5_wp*dt
      !$omp simd private(d1, d2, d3, d4, d5, d6, a, b, c, tr, pressure, power, &
      !$omp & s1, s2, s3, s4, s5, s6, r1, r2, r3, r4, r5, r6)
      do p = 1, 8
         d1 = dt*l(p, 1)
         d2 = dt*l(p, 5)
         d3 = dt*l(p, 9)
         d4 = half*(l(p, 2) + l(p, 4))
         d5 = half*(l(p, 6) + l(p, 8))
         d6 = half*(l(p, 3) + l(p, 7))
         a = half*(l(p, 2) - l(p, 4))
         b = half*(l(p, 6) - l(p, 8))
         c = half*(l(p, 3) - l(p, 7))
         tr = d1 + d2 + d3
         s1 = q(p, 9)
         s2 = q(p, 10)
         s3 = q(p, 11)
         s4 = q(p, 12)
         s5 = q(p, 13)
         s6 = q(p, 14)
         r1 = 2*(a*s4 + c*s6)
         r2 = 2*(b*s5 - a*s4)
         r3 = -2*(b*s5 + c*s6)
         r4 = a*(s2 - s1) + c*s5 + b*s6
         r5 = b*(s3 - s2) - a*s6 - c*s4
         r6 = c*(s3 - s1) + a*s5 - b*s4
         pressure = lambda*tr
         q(p, 9) = s1 + r1 + (a*r4 + c*r6) + pressure + 2*mu*d1
         q(p, 10) = s2 + r2 + (b*r5 - a*r4) + pressure + 2*mu*d2
         q(p, 11) = s3 + r3 - (b*r5 + c*r6) + pressure + 2*mu*d3
         q(p, 12) = s4 + r4 + 0.5_wp*(a*(r2 - r1) + c*r5 + b*r6) + 2*mu*d4
         q(p, 13) = s5 + r5 + 0.5_wp*(b*(r3 - r2) - a*r6 - c*r4) + 2*mu*d5
         q(p, 14) = s6 + r6 + 0.5_wp*(c*(r3 - r1) + a*r5 - b*r4) + 2*mu*d6
         power = (s1 + q(p, 9))*d1 + (s2 + q(p, 10))*d2 + (s3 + q(p, 11))*d3 &
            + 2*((s4 + q(p, 12))*d4 + (s5 + q(p, 13))*d5 + (s6 + q(p, 14))*d6)
         work(p) = work(p) + 0.5_wp*q(p, 8)*(1 + 0.5_wp*tr)*power
         q(p, 8) = q(p, 8)*(1 + tr*(1 + 0.5_wp*tr))
      end do
   end subroutine update_lanes
end module xmpm_elastic
