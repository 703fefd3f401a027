!> The static near-tip fields of a straight crack front in plane strain and antiplane shear, and
!> that of a line force: the auxiliary states of the interaction integral.
module xmpm_near_tip
   use xmpm_kinds, only: wp, pi
   implicit none
   private

   public :: near_tip_fields, line_force_field, strain_of

contains

   !> Stress and u_i,1 of the three modes at a point, each for an intensity factor of one.
   !>
   !> Williams' series, first term (for example Anderson, Fracture Mechanics, tables 2.1 and 2.2).
   !> Behind the front the side, not the sign of x2, tells which face is near. On the front itself
   !> there is no field: 0.
   pure subroutine near_tip_fields(x1, x2, side, mu, poisson, stress, gradient)
      real(wp), intent(in) :: x1, x2          !! ahead of and above the front [length]
      real(wp), intent(in) :: side            !! 1 above, -1 below the crack
      real(wp), intent(in) :: mu, poisson     !! shear modulus [stress], Poisson's ratio
      real(wp), intent(out) :: stress(6, 3)   !! 11 22 33 12 23 13 of modes I, II, III
      real(wp), intent(out) :: gradient(3, 3) !! u_i,1 of the modes
      real(wp) :: r, cosine, sine, c, s, c3, s3, f, kappa, scale

      stress = 0
      gradient = 0
      r = sqrt(x1*x1 + x2*x2)
      if (.not. r > 0) return
      cosine = x1/r
      sine = x2/r
      if (cosine > 0) then
         c = sqrt(0.5_wp*(1 + cosine))
         s = 0.5_wp*sine/c
      else
         s = sign(sqrt(0.5_wp*(1 - cosine)), side)
         c = 0.5_wp*sine/s
      end if
      c3 = c*(4*c*c - 3)
      s3 = s*(3 - 4*s*s)
      f = 1/sqrt(2*pi*r)
      kappa = 3 - 4*poisson
      stress(1, 1:2) = [f*c*(1 - s*s3), -f*s*(2 + c*c3)]
      stress(2, 1:2) = [f*c*(1 + s*s3), f*s*c*c3]
      stress(3, 1:2) = poisson*(stress(1, 1:2) + stress(2, 1:2))
      stress(4, 1:2) = [f*s*c*c3, f*c*(1 - s*s3)]
      stress(5, 3) = f*c
      stress(6, 3) = -f*s
      scale = 0.5_wp/mu
      gradient(1, 1:2) = scale*(stress(1, 1:2) - poisson*(stress(1, 1:2) + stress(2, 1:2)))
      gradient(2, 1) = slope(s*(kappa + 1 - 2*c*c), 0.5_wp*c*(kappa + 1 - 2*c*c) + 2*s*s*c)
      gradient(2, 2) = slope(-c*(kappa - 1 - 2*s*s), 0.5_wp*s*(kappa - 1 - 2*s*s) + 2*s*c*c)
      gradient(3, 3) = stress(6, 3)/mu

   contains

      !> x1 derivative of r**(1/2) g(theta)/(2 mu (2 pi)**(1/2)).
      pure function slope(g, dg) result(d)
         real(wp), intent(in) :: g, dg
         real(wp) :: d

         d = scale*f*(0.5_wp*cosine*g - sine*dg)
      end function slope
   end subroutine near_tip_fields

   !> Stress and u_i,1 of a unit force per length along x1 on the front, in plane strain: the
   !> auxiliary state of the T-stress (Kfouri 1986).
   pure subroutine line_force_field(x1, x2, mu, poisson, stress, slope)
      real(wp), intent(in) :: x1, x2          !! ahead of and above the front [length]
      real(wp), intent(in) :: mu, poisson     !! shear modulus [stress], Poisson's ratio
      real(wp), intent(out) :: stress(6)      !! 11 22 33 12 23 13 [1/length]
      real(wp), intent(out) :: slope(3)       !! u_i,1 [1/(length stress)]
      real(wp) :: r, c, s, f

      stress = 0
      slope = 0
      r = sqrt(x1*x1 + x2*x2)
      if (.not. r > 0) return
      c = x1/r
      s = x2/r
      f = -1/(pi*r)
      stress(1) = f*c**3
      stress(2) = f*c*s*s
      stress(3) = poisson*f*c
      stress(4) = f*c*c*s
      slope(1) = 0.5_wp/mu*f*c*(c*c - poisson)
      slope(2) = 0.5_wp/mu*f*s*(poisson - s*s)
   end subroutine line_force_field

   !> Strain of a stress, tensor components in the order 11 22 33 12 23 13.
   pure function strain_of(stress, mu, poisson) result(strain)
      real(wp), intent(in) :: stress(6)       !! [stress]
      real(wp), intent(in) :: mu, poisson     !! shear modulus [stress], Poisson's ratio
      real(wp) :: strain(6)

      strain = 0.5_wp*stress/mu
      strain(:3) = strain(:3) - 0.5_wp*poisson/(mu*(1 + poisson))*sum(stress(:3))
   end function strain_of
end module xmpm_near_tip
