!> A manufactured solution for hypoelastic material (Wallstedt and Guilkey 2008, axis-aligned):
!> u_i = A sin(2 pi X_i) sin(c pi t), c = sqrt(E/rho), rollers on all faces of the unit cube.
!>
!> The body force that makes it exact is b_i = a_i + (2 pi)^2 u_i (lambda + 2 mu) J / (rho F_ii^2).
!> Without arguments coarse grids are run; `test_manufactured SHAPE AMPLITUDE N...` prints the rms
!> error of displacement over A for 1/h = N, the amplitude in cells.
program test_manufactured
   use xmpm_kinds, only: wp
   use xmpm_text, only: to_text
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel
   use xmpm_deck, only: deck_t
   use xmpm_model, only: model_t
   use xmpm_settle, only: settle, choose_step
   use small_model, only: make_model
   use manufactured, only: force_of_solution, motion, set_amplitude => amplitude_of
   use testing, only: suite_t, check, finish
   implicit none

   type(comm_t) :: comm
   type(suite_t) :: suite
   character(len=32) :: word
   integer :: i, n
   real(wp) :: coarse, fine, amplitude

   call start_parallel(comm)
   if (command_argument_count() >= 3) then
      call get_command_argument(2, word)
      read (word, *) amplitude
      do i = 3, command_argument_count()
         call get_command_argument(i, word)
         read (word, *) n
         call get_command_argument(1, word)
         print '(i0,1x,es12.4)', n, error_of(trim(word), amplitude, n)
      end do
      call stop_parallel(comm, 0)
   end if
   suite = suite_t('test_manufactured')
   ! The asymptotic order is 2; below 16 cells a wave the linear error still has other terms.
   coarse = error_of('gimp', 0.2_wp, 12)
   fine = error_of('gimp', 0.2_wp, 16)
   call check(suite, 'GIMP converges with second order at an amplitude of 0.2 h (errors '// &
      to_text(coarse)//' and '//to_text(fine)//')', log(coarse/fine)/log(16/12.0_wp) > 1.8_wp)
   coarse = error_of('linear', 1e-6_wp, 16)
   fine = error_of('linear', 1e-6_wp, 24)
   call check(suite, 'linear functions converge with second order at a small amplitude (errors '// &
      to_text(coarse)//' and '//to_text(fine)//')', log(coarse/fine)/log(24/16.0_wp) > 1.8_wp)
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> Rms error of displacement over the amplitude after three quarters of a period.
   function error_of(shape, cells, n) result(rms)
      character(len=*), intent(in) :: shape
      real(wp), intent(in) :: cells   !! amplitude in cells
      integer, intent(in) :: n        !! cells along an edge
      real(wp) :: rms, u(3), v(3), a
      type(deck_t) :: deck
      type(model_t) :: m
      type(error_t), allocatable :: error
      integer :: c, k, count

      a = cells/real(n, wp)
      call make_model(comm, '*JOB mms|*GRID size = 1/'//to_text(n)//', shape = '//shape// &
         '|*MATERIAL m|law = elastic, density = 1000, young = 1e7, poisson = 0.3|*BODY '// &
         'b|material = m'// &
         '|particles = 2, box = 0 0 0 1 1 1|*TIME end = 0.015, cfl = 0.4'// &
         '|*BOUNDARY|plane = x 0, type = roller|*BOUNDARY|plane = x 1, type = roller'// &
         '|*BOUNDARY|plane = y 0, type = roller|*BOUNDARY|plane = y 1, type = roller'// &
         '|*BOUNDARY|plane = z 0, type = roller|*BOUNDARY|plane = z 1, type = roller', deck, m, &
         error)
      if (allocated(error)) error stop 2
      call set_amplitude(a)
      m%further_force => force_of_solution
      do c = 1, m%particles%n_chunks
         do k = 1, m%particles%count(c)
            call motion(m%particles%x0(k, :, c), 0.0_wp, u, v)
            m%particles%q(k, 4:6, c) = v
         end do
      end do
      do while (m%time < m%options%end_time)
         call choose_step(m, m%options%end_time, error)
         if (allocated(error)) error stop 3
         call m%take_step(m, m%dt)
         call settle(m, error)
         if (allocated(error)) error stop 4
      end do
      rms = 0
      count = 0
      do c = 1, m%particles%n_chunks
         do k = 1, m%particles%count(c)
            call motion(m%particles%x0(k, :, c), m%time, u, v)
            rms = rms + sum((m%particles%q(k, 1:3, c) - m%particles%x0(k, :, c) - u)**2)
            count = count + 3
         end do
      end do
      rms = sqrt(rms/real(count, wp))/a
   end function error_of
end program test_manufactured
