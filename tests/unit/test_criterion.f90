!> Criteria of growth: exact angles and intensities, signs, the limits of pure modes.
program test_criterion
   use xmpm_kinds, only: wp, pi
   use xmpm_criterion, only: criterion_t, steepest_kink
   use xmpm_hoop_stress, only: hoop_stress_t, hoop_angle
   use xmpm_schoellmann, only: schoellmann_t
   use xmpm_straight, only: straight_t
   use testing, only: suite_t, check, check_close, finish
   implicit none
   type(suite_t) :: suite
   real(wp), parameter :: tight = 1.0e-14_wp    ! a few roundings of numbers of order one
   real(wp), parameter :: found = 1.0e-7_wp     ! an angle where a value is largest, by halving a
   ! derivative whose own rounding is 1e-16

   suite%name = 'criterion'
   call hoop_limits()
   call hoop_is_the_largest()
   call hoop_without_singularity()
   call schoellmann_limits()
   call schoellmann_is_the_largest()
   call both_scale()
   call straight_energy()
   call finish(suite)

contains

   !> Pure modes, and mode I with pressure on the faces.
   subroutine hoop_limits()
      real(wp) :: kink, twist, k
      type(hoop_stress_t) :: hoop

      call hoop%judge([3.0_wp, 0.0_wp, 7.0_wp], kink, twist, k)
      call check_close(suite, 'mode I goes straight', kink, 0.0_wp, 0.0_wp, 0.0_wp)
      call check_close(suite, 'K* of mode I is K_I', k, 3.0_wp, 0.0_wp, tight)
      call hoop%judge([0.0_wp, 2.0_wp, 0.0_wp], kink, twist, k)
      ! the textbook's 70.53 degrees: cos(theta) = 1/3
      call check_close(suite, 'mode II turns by -acos(1/3)', kink, -acos(1.0_wp/3.0_wp), tight, &
         0.0_wp)
      ! 3/2 cos(t/2) sin(t) = 2/sqrt(3) at that angle
      call check_close(suite, 'K* of mode II is 2/sqrt(3) K_II', k, 4.0_wp/sqrt(3.0_wp), 0.0_wp, &
         tight)
      call check_close(suite, 'the largest angle is that of mode II', hoop_angle(0.0_wp, -1.0_wp), &
         steepest_kink, tight, 0.0_wp)
      call check_close(suite, 'closed faces count as K_I = 0', hoop_angle(-5.0_wp, 1.0_wp), &
         -steepest_kink, tight, 0.0_wp)
      call check_close(suite, 'nothing gives no angle', hoop_angle(0.0_wp, 0.0_wp), 0.0_wp, &
         0.0_wp, 0.0_wp)
      call hoop%judge([-5.0_wp, 0.0_wp, 0.0_wp], kink, twist, k)
      call check_close(suite, 'and closed faces give no K*', k, 0.0_wp, 0.0_wp, 0.0_wp)
   end subroutine hoop_limits

   !> The angle is where the hoop stress is largest and the shear vanishes.
   subroutine hoop_is_the_largest()
      real(wp) :: kink, twist, k, t, shear, largest, mix
      type(hoop_stress_t) :: hoop
      integer :: i, j

      shear = 0
      largest = -huge(1.0_wp)
      do i = -8, 8
         mix = 0.19_wp*real(i, wp)
         call hoop%judge([cos(mix), sin(mix), 0.0_wp], kink, twist, k)
         shear = max(shear, abs(cos(mix)*sin(kink) + sin(mix)*(3*cos(kink) - 1)))
         do j = -179, 179
            t = real(j, wp)*pi/180
            largest = max(largest, cos(t/2)**3*cos(mix) - 1.5_wp*cos(t/2)*sin(t)*sin(mix) - k)
         end do
      end do
      call check_close(suite, 'the shear stress vanishes along the kink', shear, 0.0_wp, tight, &
         0.0_wp)
      call check(suite, 'no other direction has a larger hoop stress', largest < tight)
   end subroutine hoop_is_the_largest

   !> Eq. 57 as printed is 0/0 at K_II = 0 and loses digits near it; the series is -2 q.
   subroutine hoop_without_singularity()
      call check_close(suite, 'a tiny K_II turns by -2 K_II/K_I', hoop_angle(1.0_wp, 1.0e-12_wp), &
         -2.0e-12_wp, 0.0_wp, 1.0e-14_wp)
      call check_close(suite, 'numbers whose squares overflow are met', hoop_angle(1.0e200_wp, &
         1.0e200_wp), hoop_angle(1.0_wp, 1.0_wp), tight, 0.0_wp)
      ! tan(t/2) = -2/(1 + 3) where both are the same
      call check_close(suite, 'K_I = K_II turns by -2 atan(1/2)', hoop_angle(1.0_wp, 1.0_wp), &
         -2*atan(0.5_wp), tight, 0.0_wp)
   end subroutine hoop_without_singularity

   !> Pure modes of the three-mode criterion, and mode III of no size.
   subroutine schoellmann_limits()
      real(wp) :: kink, twist, k, angle
      type(schoellmann_t) :: law

      call law%judge([2.0_wp, 0.0_wp, 0.0_wp], kink, twist, k)
      call check_close(suite, 'three modes: mode I goes straight', kink, 0.0_wp, tight, 0.0_wp)
      call check_close(suite, 'three modes: mode I does not twist', twist, 0.0_wp, 0.0_wp, 0.0_wp)
      call check_close(suite, 'three modes: K* of mode I is K_I', k, 2.0_wp, 0.0_wp, tight)
      call law%judge([0.0_wp, 0.0_wp, 3.0_wp], kink, twist, k)
      call check_close(suite, 'mode III goes straight', kink, 0.0_wp, tight, 0.0_wp)
      call check_close(suite, 'mode III twists by 45 degrees', twist, pi/4, tight, 0.0_wp)
      call check_close(suite, 'K* of mode III is K_III', k, 3.0_wp, 0.0_wp, tight)
      call law%judge([0.0_wp, 0.0_wp, -3.0_wp], kink, twist, k)
      call check_close(suite, 'the twist has the sign of K_III', twist, -pi/4, tight, 0.0_wp)
      call law%judge([0.0_wp, -1.0_wp, 0.0_wp], kink, twist, k)
      call check_close(suite, 'three modes: mode II turns by 70.53 degrees', kink, steepest_kink, &
         found, 0.0_wp)
      call law%judge([1.0_wp, 0.4_wp, 0.0_wp], kink, twist, k)
      angle = hoop_angle(1.0_wp, 0.4_wp)
      call check_close(suite, 'without mode III the angle is that of the hoop stress', kink, &
         angle, &
         found, 0.0_wp)
      call law%judge([1.0_wp, 0.0_wp, 0.5_wp], kink, twist, k)
      ! (1 + sqrt(1 + 4/4))/2 and atan(2/2)/2 at t = 0
      call check_close(suite, 'K* of modes I and III is exact', k, 0.5_wp*(1 + sqrt(2.0_wp)), &
         0.0_wp, tight)
      call check_close(suite, 'the twist of modes I and III is exact', twist, pi/8, tight, 0.0_wp)
   end subroutine schoellmann_limits

   !> No other direction within the limit has a larger principal stress.
   subroutine schoellmann_is_the_largest()
      real(wp) :: kink, twist, k, t, s, z, worst, modes(3)
      type(schoellmann_t) :: law
      integer :: i, j

      worst = -huge(1.0_wp)
      do i = 1, 50
         t = real(i, wp)
         modes = [abs(sin(1.7_wp*t)), sin(2.3_wp*t + 1), sin(0.9_wp*t + 2)]
         call law%judge(modes, kink, twist, k)
         do j = -70, 70
            t = real(j, wp)*pi/180
            s = cos(t/2)*(modes(1)*cos(t/2)**2 - 1.5_wp*modes(2)*sin(t))
            z = modes(3)*cos(t/2)
            worst = max(worst, 0.5_wp*(s + sqrt(s*s + 4*z*z)) - k)
         end do
      end do
      call check(suite, 'three modes: the principal stress is the largest of all directions', &
         worst < tight)
   end subroutine schoellmann_is_the_largest

   !> A load twice as large turns no further, and its intensity is twice as large.
   subroutine both_scale()
      type(hoop_stress_t) :: hoop
      type(schoellmann_t) :: three

      call check(suite, 'the hoop stress criterion is homogeneous', scales(hoop))
      call check(suite, 'the three-mode criterion is homogeneous', scales(three))
   end subroutine both_scale

   function scales(law) result(does)
      class(criterion_t), intent(in) :: law
      logical :: does
      real(wp) :: kink(2), twist(2), k(2)

      call law%judge([0.8_wp, -0.5_wp, 0.3_wp], kink(1), twist(1), k(1))
      call law%judge([0.8e9_wp, -0.5e9_wp, 0.3e9_wp], kink(2), twist(2), k(2))
      does = abs(kink(2) - kink(1)) < found .and. abs(twist(2) - twist(1)) < found &
         .and. abs(k(2) - 1e9_wp*k(1)) < 1e9_wp*tight
   end function scales

   !> The intensity of a weak plane has the energy release rate of the three modes.
   subroutine straight_energy()
      real(wp) :: kink, twist, k
      type(straight_t) :: law

      law%poisson = 0.25_wp
      call law%judge([3.0_wp, 4.0_wp, 0.0_wp], kink, twist, k)
      call check_close(suite, 'a weak plane goes straight', kink, 0.0_wp, 0.0_wp, 0.0_wp)
      call check_close(suite, 'modes I and II add by energy', k, 5.0_wp, 0.0_wp, tight)
      call law%judge([0.0_wp, 0.0_wp, 3.0_wp], kink, twist, k)
      call check_close(suite, 'mode III weighs 1/(1 - nu)', k**2, 12.0_wp, 0.0_wp, tight)
   end subroutine straight_energy
end program test_criterion
