!> The trace of particles near a front: deformation gradient and work over a step.
program test_trace
   use xmpm_kinds, only: wp
   use xmpm_storage, only: particles_t, lanes, n_trace, trace_f, trace_work
   use xmpm_trace, only: start_trace, follow_chunk
   use testing, only: suite_t, check, check_close, finish
   implicit none
   real(wp), parameter :: dt = 0.1_wp
   type(suite_t) :: suite
   type(particles_t) :: p
   real(wp) :: gradient(lanes, 9), work(lanes)
   integer :: i, k

   suite%name = 'trace'
   allocate (p%near(lanes, n_trace, 2), source=0.0_wp)
   p%trace = 0
   p%attached = [2]
   do i = 1, lanes
      work(i) = real(i, wp)
      do k = 1, 9
         gradient(i, k) = sin(real(9*i + k, wp))
      end do
   end do
   ! the last lane is not traced
   do i = 1, lanes - 1
      call start_trace(p, i, 1, strain_of_lane(i), 10.0_wp)
   end do
   call follow_chunk(p, 1, gradient, dt, work)
   do i = 1, lanes - 1
      ! rounding of nine products of numbers of about 1
      call check_close(suite, 'F goes with (1 + dt L + (dt L)**2/2)', &
         maxval(abs(gradient_of(i) - expected(i))), 0.0_wp, 1e-14_wp, 0.0_wp)
      call check_close(suite, 'work adds up', p%near(i, trace_work, 2), 10 + work(i), 1e-14_wp, &
         0.0_wp)
   end do
   call check(suite, 'a lane without a trace keeps F = 0', .not. any(abs(gradient_of(lanes)) > 0))
   call check(suite, 'other records stay as they are', .not. any(abs(p%near(:, :, 1)) > 0))
   call finish(suite)

contains

   !> Strain with which a lane starts.
   pure function strain_of_lane(lane) result(strain)
      integer, intent(in) :: lane
      real(wp) :: strain(6)
      integer :: j

      strain = [(0.01_wp*real(lane + 10*j, wp), j=1, 6)]
   end function strain_of_lane

   !> Deformation gradient that the record holds.
   function gradient_of(lane) result(f)
      integer, intent(in) :: lane
      real(wp) :: f(3, 3)

      f = transpose(reshape(p%near(lane, trace_f:trace_f + 8, 2), [3, 3]))
   end function gradient_of

   !> The same from matrices.
   function expected(lane) result(f)
      integer, intent(in) :: lane
      real(wp) :: f(3, 3), l(3, 3), s(6)

      s = strain_of_lane(lane)
      f(:, 1) = [1 + s(1), s(4), s(6)]
      f(:, 2) = [s(4), 1 + s(2), s(5)]
      f(:, 3) = [s(6), s(5), 1 + s(3)]
      l = dt*transpose(reshape(gradient(lane, :), [3, 3]))
      f = f + matmul(l, f) + 0.5_wp*matmul(l, matmul(l, f))
   end function expected
end program test_trace
