!> The criterion of the largest principal stress on a cylinder around the front (Schoellmann,
!> Richard, Kullmer and Fulland 2002): all three modes, with kink and twist.
module xmpm_schoellmann
   use xmpm_kinds, only: wp
   use xmpm_criterion, only: criterion_t, steepest_kink
   implicit none
   private

   public :: schoellmann_t

   integer, parameter :: looks = 60   !! places of the first search, on each side of straight ahead

   !> Growth normal to the largest principal stress sigma_1' at the front.
   type, extends(criterion_t) :: schoellmann_t
   contains
      procedure :: judge => judge_schoellmann
   end type schoellmann_t

contains

   !> Kink angle, twist and equivalent intensity.
   !>
   !> With s = cos(t/2) (K_I cos(t/2)**2 - 3/2 K_II sin(t)) and z = K_III cos(t/2) the intensity is
   !> the largest (s + sqrt(s**2 + 4 z**2))/2 of all t, and the twist there is atan2(2 z, s)/2.
   pure subroutine judge_schoellmann(criterion, k, kink, twist, intensity)
      class(schoellmann_t), intent(in) :: criterion
      real(wp), intent(in) :: k(3)         !! modes I II III [stress sqrt(length)]
      real(wp), intent(out) :: kink        !! positive towards e2 [rad]
      real(wp), intent(out) :: twist       !! of the new face about the kinked direction [rad]
      real(wp), intent(out) :: intensity   !! equivalent to K_I [stress sqrt(length)]
      real(wp) :: modes(3), scale, s, z

      associate (unused => criterion)
      end associate
      kink = 0.0_wp
      twist = 0.0_wp
      intensity = 0.0_wp
      scale = maxval(abs(k))
      if (.not. scale > 0.0_wp) return
      modes = [max(k(1), 0.0_wp), k(2:3)]/scale
      kink = steepest_climb(modes)
      call stresses(modes, kink, s, z)
      if (abs(z) > 0.0_wp) twist = 0.5_wp*atan2(2.0_wp*z, s)
      intensity = 0.5_wp*scale*(s + sqrt(s*s + 4.0_wp*z*z))
   end subroutine judge_schoellmann

   !> The angle of the largest principal stress: the best of many, then its neighbourhood halved.
   pure function steepest_climb(modes) result(angle)
      real(wp), intent(in) :: modes(3)
      real(wp) :: angle, best, low, high, step
      integer :: i, k

      step = steepest_kink/real(looks, wp)
      angle = 0.0_wp
      best = principal(modes, 0.0_wp)
      do i = 1, looks
         do k = -1, 1, 2
            if (.not. principal(modes, real(k*i, wp)*step) > best) cycle
            angle = real(k*i, wp)*step
            best = principal(modes, angle)
         end do
      end do
      low = max(angle - step, -steepest_kink)
      high = min(angle + step, steepest_kink)
      do i = 1, 60
         angle = 0.5_wp*(low + high)
         if (slope(modes, angle) > 0.0_wp) then
            low = angle
         else
            high = angle
         end if
      end do
      if (abs(angle) < 1.0e-15_wp) angle = 0.0_wp
   end function steepest_climb

   pure subroutine stresses(modes, angle, s, z)
      real(wp), intent(in) :: modes(3), angle
      real(wp), intent(out) :: s, z
      real(wp) :: c

      c = cos(0.5_wp*angle)
      s = c*(modes(1)*c*c - 1.5_wp*modes(2)*sin(angle))
      z = modes(3)*c
   end subroutine stresses

   pure function principal(modes, angle) result(p)
      real(wp), intent(in) :: modes(3), angle
      real(wp) :: p, s, z

      call stresses(modes, angle, s, z)
      p = 0.5_wp*(s + sqrt(s*s + 4.0_wp*z*z))
   end function principal

   !> Derivative of the principal stress by the angle.
   pure function slope(modes, angle) result(d)
      real(wp), intent(in) :: modes(3), angle
      real(wp) :: d, s, z, ds, dz, c, n, root

      call stresses(modes, angle, s, z)
      c = cos(0.5_wp*angle)
      n = sin(0.5_wp*angle)
      ds = -1.5_wp*modes(1)*c*c*n + 1.5_wp*modes(2)*(0.5_wp*n*sin(angle) - c*cos(angle))
      dz = -0.5_wp*modes(3)*n
      root = sqrt(s*s + 4.0_wp*z*z)
      d = ds
      if (root > 0.0_wp) d = 0.5_wp*(ds + (s*ds + 4.0_wp*z*dz)/root)
   end function slope
end module xmpm_schoellmann
