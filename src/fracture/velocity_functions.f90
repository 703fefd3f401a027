!> Elastic constants at a front, wave speeds, and the velocity functions A_M(C) that tie the
!> energy release rate to the stress intensity factors (eq. 50 to 55 of 10.1002/nme.6653).
module xmpm_velocity_functions
   use xmpm_kinds, only: wp
   implicit none
   private

   public :: elastic_constants_t, elastic_constants, velocity_functions, release_rate, split_rate
   public :: fastest_front

   real(wp), parameter :: fastest_front = 0.95_wp   !! largest front speed, over the Rayleigh speed

   !> An isotropic linear elastic material.
   type :: elastic_constants_t
      real(wp) :: mu = 1.0_wp          !! shear modulus [stress]
      real(wp) :: poisson = 0.3_wp     !! Poisson's ratio
      real(wp) :: dilatation = 1.0_wp  !! speed of dilatational waves [length/time]
      real(wp) :: shear = 1.0_wp       !! speed of shear waves [length/time]
      real(wp) :: rayleigh = 1.0_wp    !! speed of Rayleigh waves [length/time]
   end type elastic_constants_t

contains

   !> Constants and wave speeds from the Lame constants and the density.
   pure function elastic_constants(lambda, mu, density) result(e)
      real(wp), intent(in) :: lambda, mu   !! [stress]
      real(wp), intent(in) :: density      !! [mass/length^3]
      type(elastic_constants_t) :: e

      e%mu = mu
      e%poisson = 0.5_wp*lambda/(lambda + mu)
      e%dilatation = sqrt((lambda + 2*mu)/density)
      e%shear = sqrt(mu/density)
      e%rayleigh = e%shear*sqrt(rayleigh_root(mu/(lambda + 2*mu)))
   end function elastic_constants

   !> Zero between 0 and 1 of Rayleigh's cubic in s = (C/c_s)**2, by bisection to rounding.
   pure function rayleigh_root(k2) result(s)
      real(wp), intent(in) :: k2   !! (c_s/c_d)**2
      real(wp) :: s, low, high
      integer :: i

      low = 0
      high = 1
      do i = 1, 60
         s = 0.5_wp*(low + high)
         if (rayleigh_cubic(s, k2) > 0) then
            low = s
         else
            high = s
         end if
      end do
   end function rayleigh_root

   !> 16 (1 - k2) - (24 - 16 k2) s + 8 s**2 - s**3.
   pure function rayleigh_cubic(s, k2) result(r)
      real(wp), intent(in) :: s, k2
      real(wp) :: r

      r = 16*(1 - k2) - s*(24 - 16*k2 - s*(8 - s))
   end function rayleigh_cubic

   !> A_I, A_II, A_III at a front speed (eq. 51), 1 - nu, 1 - nu and 1 at rest.
   !>
   !> With s = (C/c_s)**2 the quotient (1 - beta_2**2)/D of eq. 51, 0/0 at rest, equals
   !> (4 beta_1 beta_2 + (2 - s)**2) over Rayleigh's cubic, which is not. Speeds above
   !> `fastest_front` of the Rayleigh speed count as that.
   pure function velocity_functions(e, speed) result(a)
      type(elastic_constants_t), intent(in) :: e
      real(wp), intent(in) :: speed   !! of the front [length/time]
      real(wp) :: a(3), s, k2, beta1, beta2, quotient

      s = (min(abs(speed), fastest_front*e%rayleigh)/e%shear)**2
      k2 = (e%shear/e%dilatation)**2
      beta1 = sqrt(1 - k2*s)
      beta2 = sqrt(1 - s)
      quotient = (4*beta1*beta2 + (2 - s)**2)/rayleigh_cubic(s, k2)
      a = [beta1*quotient, beta2*quotient, 1/beta2]
   end function velocity_functions

   !> Energy release rate of given intensity factors (eq. 50).
   pure function release_rate(e, a, k) result(g)
      type(elastic_constants_t), intent(in) :: e
      real(wp), intent(in) :: a(3)   !! velocity functions
      real(wp), intent(in) :: k(3)   !! K_I, K_II, K_III [stress length^(1/2)]
      real(wp) :: g                  !! [energy/length^2]

      g = sum(a*k**2)/(2*e%mu)
   end function release_rate

   !> K_I, K_II, K_III from the energy release rate and the opening behind the front (eq. 54, 55).
   pure function split_rate(e, a, g, opening) result(k)
      type(elastic_constants_t), intent(in) :: e
      real(wp), intent(in) :: a(3)         !! velocity functions
      real(wp), intent(in) :: g            !! energy release rate [energy/length^2]
      real(wp), intent(in) :: opening(3)   !! along e2, e1 and e3 [length]
      real(wp) :: k(3), total              !! [stress length^(1/2)]

      k = 0
      total = sum(opening**2/a)
      if (total > 0) k = opening/a*sqrt(2*e%mu*max(g, 0.0_wp)/total)
   end function split_rate
end module xmpm_velocity_functions
