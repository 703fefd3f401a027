!> The static near-tip fields of a straight crack front in plane strain and antiplane shear, and
!> that of a line force: the auxiliary states of the interaction integral.
module xmpm_near_tip
   use xmpm_kinds, only: wp, pi
   implicit none
   private

   public :: unit_states, strain_of

   real(wp), parameter :: per_pi = 1/pi

contains

   !> Stress and u_i,1 at n places: of modes I and II, each for an intensity factor of one, and of a
   !> unit force per length along x1 on the front (Kfouri 1986), the auxiliary state of the
   !> T-stress; and of mode III.
   !>
   !> Williams' series, first term (for example Anderson, Fracture Mechanics, tables 2.1 and 2.2).
   !> Behind the front the side, not the sign of x2, tells which face is near. On the front itself
   !> there is no field: 0.
   pure subroutine unit_states(n, x1, x2, side, mu, poisson, plane, shear)
      integer, intent(in) :: n
      real(wp), intent(in) :: x1(n), x2(n)         !! ahead of and above the front [length]
      real(wp), intent(in) :: side(n)              !! 1 above, -1 below the crack
      real(wp), intent(in) :: mu(n), poisson(n)    !! shear modulus [stress], Poisson's ratio
      real(wp), intent(out) :: plane(n, 6, 3)      !! 11 22 33 12, u_1,1 u_2,1 of I, II, force
      real(wp), intent(out) :: shear(n, 3)         !! 23 13, u_3,1 of III
      real(wp) :: scale(n)
      real(wp) :: r, live, per_r, cosine, sine, ahead, a, b, c, s, c3, s3, f, kappa
      integer :: i

      !$omp simd private(r, live, per_r, cosine, sine, ahead, a, b, c, s, c3, s3, f, kappa)
      do i = 1, n
         r = sqrt(x1(i)*x1(i) + x2(i)*x2(i))
         live = 0.5_wp + sign(0.5_wp, r - tiny(r))
         per_r = live/(r + (1 - live))
         cosine = x1(i)*per_r + (1 - live)
         sine = x2(i)*per_r
         ahead = 0.5_wp + sign(0.5_wp, cosine)
         a = sqrt(0.5_wp*(1 + abs(cosine)))
         b = 0.5_wp*sine/a
         c = ahead*a + (1 - ahead)*side(i)*b
         s = ahead*b + (1 - ahead)*side(i)*a
         c3 = c*(4*c*c - 3)
         s3 = s*(3 - 4*s*s)
         f = sqrt(0.5_wp*per_pi*per_r)
         kappa = 3 - 4*poisson(i)
         scale(i) = 0.5_wp/mu(i)
         plane(i, 1, 1) = f*c*(1 - s*s3)
         plane(i, 2, 1) = f*c*(1 + s*s3)
         plane(i, 4, 1) = f*s*c*c3
         plane(i, 1, 2) = -f*s*(2 + c*c3)
         plane(i, 2, 2) = plane(i, 4, 1)
         plane(i, 4, 2) = plane(i, 1, 1)
         ! x1 derivative of r**(1/2) g(theta)/(2 mu (2 pi)**(1/2)), from g and dg/dtheta
         plane(i, 6, 1) = scale(i)*f*(0.5_wp*cosine*s*(kappa + 1 - 2*c*c) &
            - sine*(0.5_wp*c*(kappa + 1 - 2*c*c) + 2*s*s*c))
         plane(i, 6, 2) = -scale(i)*f*(0.5_wp*cosine*c*(kappa - 1 - 2*s*s) &
            + sine*(0.5_wp*s*(kappa - 1 - 2*s*s) + 2*s*c*c))
         shear(i, 1) = f*c
         shear(i, 2) = -f*s
         shear(i, 3) = -2*scale(i)*f*s
         f = -per_pi*per_r
         plane(i, 1, 3) = f*cosine*cosine*cosine
         plane(i, 2, 3) = f*cosine*sine*sine
         plane(i, 4, 3) = f*cosine*cosine*sine
         plane(i, 6, 3) = scale(i)*f*sine*(poisson(i) - sine*sine)
      end do
      call finish_plane(n, scale, poisson, plane)
   end subroutine unit_states

   !> Stress 33 and u_1,1 of states of plane strain.
   pure subroutine finish_plane(n, scale, poisson, plane)
      integer, intent(in) :: n
      real(wp), intent(in) :: scale(n), poisson(n)   !! 1/(2 mu) [1/stress], Poisson's ratio
      real(wp), intent(inout) :: plane(n, 6, 3)
      integer :: k, i

      do k = 1, 3
         !$omp simd
         do i = 1, n
            plane(i, 3, k) = poisson(i)*(plane(i, 1, k) + plane(i, 2, k))
            plane(i, 5, k) = scale(i)*(plane(i, 1, k) - plane(i, 3, k))
         end do
      end do
   end subroutine finish_plane

   !> Strain of a stress, tensor components in the order 11 22 33 12 23 13.
   pure function strain_of(stress, mu, poisson) result(strain)
      real(wp), intent(in) :: stress(6)       !! [stress]
      real(wp), intent(in) :: mu, poisson     !! shear modulus [stress], Poisson's ratio
      real(wp) :: strain(6)

      strain = 0.5_wp*stress/mu
      strain(:3) = strain(:3) - 0.5_wp*poisson/(mu*(1 + poisson))*sum(stress(:3))
   end function strain_of
end module xmpm_near_tip
