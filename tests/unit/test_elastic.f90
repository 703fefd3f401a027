!> The elastic law: Hooke's stresses, the Jaumann rate, wave speed, work and energy.
program test_elastic
   use xmpm_kinds, only: wp
   use xmpm_elastic, only: elastic_t, new_elastic
   use testing, only: suite_t, check, check_close, finish
   implicit none
   real(wp), parameter :: young = 200e3_wp, poisson = 0.3_wp, density = 7.9e-3_wp
   real(wp), parameter :: mu = young/(2*(1 + poisson))
   real(wp), parameter :: lambda = young*poisson/((1 + poisson)*(1 - 2*poisson))
   real(wp), parameter :: rounding = 1e-13_wp   !! some dozen operations with eps 2e-16
   type(elastic_t) :: law
   type(suite_t) :: suite

   suite%name = 'elastic'
   law = new_elastic('alloy', density, young, poisson)
   call test_hooke(suite)
   call test_uniaxial(suite)
   call test_rotation(suite)
   call test_objectivity(suite)
   call test_work(suite)
   call test_empty(suite)
   call check_close(suite, 'the wave is dilatational', law%wave_speed(), &
      sqrt(young*(1 - poisson)/((1 + poisson)*(1 - 2*poisson)*density)), 0.0_wp, rounding)
   call finish(suite)

contains

   !> One step of all lanes with the same gradient from a stress.
   subroutine step(gradient, dt, q, work)
      real(wp), intent(in) :: gradient(3, 3), dt
      real(wp), intent(inout) :: q(8, 14), work(8)
      real(wp) :: lanes(8, 9)

      lanes = spread(reshape(transpose(gradient), [9]), 1, 8)
      call law%update(lanes, dt, q, work)
   end subroutine step

   pure function tensor(s) result(t)
      real(wp), intent(in) :: s(6)   !! xx yy zz xy yz xz
      real(wp) :: t(3, 3)

      t = reshape([s(1), s(4), s(6), s(4), s(2), s(5), s(6), s(5), s(3)], [3, 3])
   end function tensor

   !> From rest, any strain rate gives Hooke's stress, in every lane; the volume follows its trace.
   subroutine test_hooke(suite)
      type(suite_t), intent(inout) :: suite
      real(wp) :: l(3, 3), d(3, 3), s(3, 3), q(8, 14), work(8), tr
      integer :: i, p

      l = reshape([3.0_wp, -1.0_wp, 2.0_wp, 0.5_wp, -2.0_wp, 1.5_wp, 0.7_wp, -0.3_wp, 1.0_wp], &
         [3, 3])
      q = 0
      q(:, 8) = 2
      work = 0
      call step(l, 1e-3_wp, q, work)
      d = 0.5e-3_wp*(l + transpose(l))
      tr = d(1, 1) + d(2, 2) + d(3, 3)
      s = 2*mu*d
      do i = 1, 3
         s(i, i) = s(i, i) + lambda*tr
      end do
      do p = 1, 8
         call check_close(suite, 'stress from rest is that of Hooke', &
            maxval(abs(tensor(q(p, 9:14)) - s)), 0.0_wp, rounding*maxval(abs(s)), 0.0_wp)
         ! exp(tr) to second order: the next term is tr**3/6.
         call check_close(suite, 'the volume grows with the trace', q(p, 8), 2*exp(tr), 0.0_wp, &
            abs(tr)**3)
      end do
   end subroutine test_hooke

   !> A bar pulled with free sides has the stress E strain.
   subroutine test_uniaxial(suite)
      type(suite_t), intent(inout) :: suite
      real(wp) :: l(3, 3), q(8, 14), work(8)

      l = 0
      l(1, 1) = 1
      l(2, 2) = -poisson
      l(3, 3) = -poisson
      q = 0
      q(:, 8) = 1
      work = 0
      call step(l, 1e-3_wp, q, work)
      call check_close(suite, 'a bar has the stress E strain', q(3, 9), 1e-3_wp*young, 0.0_wp, &
         rounding)
      call check_close(suite, 'the sides of a bar are free', maxval(abs(q(3, 10:14))), 0.0_wp, &
         rounding*1e-3_wp*young, 0.0_wp)
   end subroutine test_uniaxial

   !> Stress after a rotation by an angle in some steps.
   subroutine turn(angle, steps, s)
      real(wp), intent(in) :: angle
      integer, intent(in) :: steps
      real(wp), intent(out) :: s(3, 3)
      real(wp) :: q(8, 14), work(8)
      integer :: i

      q = 0
      q(:, 8) = 1
      q(:, 9:14) = spread([100.0_wp, -50.0_wp, 20.0_wp, 30.0_wp, -10.0_wp, 15.0_wp], 1, 8)
      work = 0
      do i = 1, steps
         call step(spin(), angle/real(steps, wp), q, work)
      end do
      s = tensor(q(5, 9:14))
      call check_close(suite, 'a rotation does no work', maxval(abs(work)), 0.0_wp, 1e-12_wp, &
         0.0_wp)
      call check_close(suite, 'a rotation keeps the volume', q(5, 8), 1.0_wp, 0.0_wp, rounding)
   end subroutine turn

   !> Velocity gradient of a unit angular velocity about (1, -2, 2)/3.
   pure function spin() result(w)
      real(wp) :: w(3, 3)

      w = reshape([0.0_wp, 2.0_wp, 2.0_wp, -2.0_wp, 0.0_wp, 1.0_wp, -2.0_wp, -1.0_wp, 0.0_wp], &
         [3, 3])/3
   end function spin

   !> Rotation by an angle about the axis of `spin` (Rodrigues).
   pure function rotation(angle) result(r)
      real(wp), intent(in) :: angle
      real(wp) :: r(3, 3)
      integer :: i

      r = sin(angle)*spin() + (1 - cos(angle))*matmul(spin(), spin())
      do i = 1, 3
         r(i, i) = r(i, i) + 1
      end do
   end function rotation

   !> Stress turns with the body to second order in the angle of a step; its size grows by the
   !> fourth
   !> power of that angle only, so by the third over a whole turn.
   subroutine test_rotation(suite)
      type(suite_t), intent(inout) :: suite
      real(wp), parameter :: whole = 8*atan(1.0_wp)
      real(wp) :: s(3, 3), start(3, 3), error(2), growth(2), exact(3, 3)
      integer :: k

      call turn(0.0_wp, 1, start)
      exact = matmul(rotation(1.0_wp), matmul(start, transpose(rotation(1.0_wp))))
      do k = 1, 2
         call turn(1.0_wp, 20*k, s)
         error(k) = norm2(s - exact)/norm2(start)
         call turn(whole, 200*k, s)
         growth(k) = abs(norm2(s)/norm2(start) - 1)
      end do
      print '(a,2es10.2,a,2es10.2)', '   turned by 1 rad in 20 and 40 steps: error', error, &
         '; size of the stress after a turn in 200 and 400 steps: off by', growth
      ! The leading term is a third of step**2 (one eigenvalue 2 i): 20 steps of 0.05 lose below
      ! 4/3 1/400 = 3e-3; the ratio is 4 up to a tenth.
      call check(suite, 'a stress turns with the body', error(1) < 4.0_wp/3/400)
      call check_close(suite, 'its error falls with the square of the step', error(1)/error(2), &
         4.0_wp, 0.4_wp, 0.0_wp)
      call check_close(suite, 'its growth over a turn falls with the cube of the step', &
         growth(1)/growth(2), 8.0_wp, 0.8_wp, 0.0_wp)
   end subroutine test_rotation

   !> Stretch, turn, stretch back in the turned frame: no stress is left but of second order.
   subroutine test_objectivity(suite)
      type(suite_t), intent(inout) :: suite
      real(wp) :: q(8, 14), work(8), d(3, 3), r(3, 3), left(2)
      integer :: i, k

      d = reshape([1.0_wp, 0.4_wp, -0.2_wp, 0.4_wp, -0.5_wp, 0.3_wp, -0.2_wp, 0.3_wp, 0.6_wp], &
         [3, 3])
      r = rotation(0.9_wp)
      do k = 1, 2
         q = 0
         q(:, 8) = 1
         work = 0
         call step(d, 1e-3_wp, q, work)
         do i = 1, 20*k
            call step(spin(), 0.9_wp/real(20*k, wp), q, work)
         end do
         call step(-matmul(r, matmul(d, transpose(r))), 1e-3_wp, q, work)
         left(k) = maxval(abs(q(:, 9:14)))/(1e-3_wp*young)
      end do
      call check_close(suite, 'strain undone in the turned frame leaves an error of second order', &
         left(1)/left(2), 4.0_wp, 0.4_wp, 0.0_wp)
   end subroutine test_objectivity

   !> Stress work is the energy of the stress: exactly where the volume stays, else up to the
   !> strain.
   subroutine test_work(suite)
      type(suite_t), intent(inout) :: suite
      real(wp) :: q(8, 14), work(8), d(3, 3)
      integer :: i

      d = reshape([1.0_wp, 0.4_wp, -0.2_wp, 0.4_wp, -0.5_wp, 0.3_wp, -0.2_wp, 0.3_wp, -0.5_wp], &
         [3, 3])
      q = 0
      q(:, 8) = 3
      work = 0
      do i = 1, 10
         call step(real(i, wp)*d, 1e-4_wp, q, work)
      end do
      call check_close(suite, 'work at constant volume is the energy', work(2), &
         3*law%strain_energy(q(2, 9:14)), 0.0_wp, rounding)
      d(1, 1) = 2
      q = 0
      q(:, 8) = 3
      work = 0
      do i = 1, 10
         call step(d, 1e-6_wp, q, work)
      end do
      ! The volume grows by the trace, 1e-5; its work is that much more, at most.
      call check_close(suite, 'work with a change of volume is the energy', work(2), &
         3*law%strain_energy(q(2, 9:14)), 0.0_wp, 1e-5_wp)
      call check_close(suite, 'the energy of a bar is stress**2/(2 E)', &
         law%strain_energy([7.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]), 49/(2*young), &
         0.0_wp, &
         rounding)
      call check_close(suite, 'the energy of a shear is stress**2/(2 G)', &
         law%strain_energy([0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 7.0_wp, 0.0_wp]), 49/(2*mu), 0.0_wp, &
         rounding)
   end subroutine test_work

   !> Empty lanes have no volume and give no work.
   subroutine test_empty(suite)
      type(suite_t), intent(inout) :: suite
      real(wp) :: q(8, 14), work(8)

      q = 0
      work = 0
      call step(spin() + transpose(spin()) + 1, 1e-3_wp, q, work)
      call check(suite, 'an empty lane does no work', all(abs(work) <= 0))
      call check(suite, 'an empty lane keeps no volume', all(abs(q(:, 8)) <= 0))
   end subroutine test_empty
end program test_elastic
