!> The log says where a run comes from, how it goes and where its time went.
! ranks: 1 2
program test_log
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t
   use xmpm_text, only: to_text
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, wait_for_all
   use xmpm_log, only: log_t, open_log, close_log, log_header, log_message, log_warning, log_end
   use xmpm_progress, only: progress_t, run_state_t, start_progress, count_step, report_progress, &
      progress_due, clock_text
   use xmpm_provenance, only: provenance_t, start_provenance
   use xmpm_stage_clock, only: stage_clock_t, start_clock, start_stage, stop_stage, stage_table, &
      stage_seconds, stage_p2g, stage_halo, stage_crack
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none
   type(comm_t) :: comm
   type(suite_t) :: suite

   call start_parallel(comm)
   suite%name = 'log'
   call test_file(suite, comm)
   call test_progress(suite, comm)
   call test_clock(suite, comm)
   call test_failure(suite, comm)
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> Whether a line of a file holds a text.
   function file_has(path, part) result(found)
      character(len=*), intent(in) :: path, part
      logical :: found
      character(len=300) :: line
      integer :: unit, status

      found = .false.
      open (newunit=unit, file=path, status='old', action='read', iostat=status)
      do while (status == 0 .and. .not. found)
         read (unit, '(a)', iostat=status) line
         if (status == 0) found = index(line, part) > 0
      end do
      close (unit)
   end function file_has

   subroutine test_file(suite, comm)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      type(log_t) :: log
      type(provenance_t) :: provenance
      type(error_t), allocatable :: error

      call start_provenance(provenance, comm)
      provenance%version = '1.2.3'
      provenance%deck_sha256 = 'abc123'
      call open_log(log, comm, 'test.log', .true., error)
      call check_no_error(suite, 'a log opens', error)
      call log_header(log, provenance)
      call log_message(log, 'two'//new_line('a')//'lines')
      call log_warning(log, 'the wave speed is that of no solid')
      call log_end(log, 'finished')
      call close_log(log)
      call check(suite, 'warnings are counted', log%warnings == 1)
      call wait_for_all(comm)
      call check(suite, 'the header names the version', file_has('test.log', 'XMPM3D 1.2.3'))
      call check(suite, 'the header names the deck', file_has('test.log', 'abc123'))
      call check(suite, 'the header names the MPI library', file_has('test.log', provenance%mpi))
      call check(suite, 'the header counts the ranks', &
         file_has('test.log', 'ranks        '//to_text(comm%size)))
      call check(suite, 'a quiet log keeps its file whole', file_has('test.log', 'lines'))
      call check(suite, 'warnings say so', file_has('test.log', 'warning: the wave speed'))
      call check(suite, 'the end is there', file_has('test.log', 'finished'))
      call check(suite, 'what was not said is not there', .not. file_has('test.log', 'restart'))
   end subroutine test_file

   !> A quarter of the run is done: 25 %.
   subroutine test_progress(suite, comm)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      type(log_t) :: log
      type(progress_t) :: progress
      type(run_state_t) :: state
      type(error_t), allocatable :: error

      call open_log(log, comm, 'test_progress.log', .true., error)
      call start_progress(progress, log, 1.0_wp, 3.0_wp)
      call count_step(progress, 1000_i8)
      call count_step(progress, 500_i8)
      call check_close(suite, 'particle-steps are counted', &
         progress%work, 1500.0_wp, 0.0_wp, 0.0_wp)
      call check(suite, 'nothing is due at once', .not. progress_due(progress, log))
      state = run_state_t(123_i8, 1.5_wp, 2.0e-8_wp, 1.0e-4_wp, 1.25_wp)
      call report_progress(progress, log, state)
      call report_progress(progress, log, state, last=.true.)
      call close_log(log)
      call wait_for_all(comm)
      call check(suite, 'a line has step, time, time step and share done', &
         file_has('test_progress.log', '     123  1.50E+00  2.0E-08  25.0%'))
      call check(suite, 'it ends with energy error and imbalance', &
         file_has('test_progress.log', '1.E-04  1.25'))
      call check(suite, 'times are hours, minutes and seconds', &
         clock_text(3725.2_wp) == '  1:02:05')
      call check(suite, 'a clock needs no more than its columns', &
         clock_text(1.0e300_wp) == ' > 999 h ')
   end subroutine test_progress

   !> What a stage inside another takes is not counted twice.
   subroutine test_clock(suite, comm)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      type(stage_clock_t) :: clock
      character(len=:), allocatable :: table
      real(wp) :: inner, outer

      call start_clock(clock)
      call start_stage(clock, stage_p2g)
      call start_stage(clock, stage_halo)
      call spend(0.05_wp)
      call stop_stage(clock, stage_halo)
      call stop_stage(clock, stage_p2g)
      inner = stage_seconds(clock, stage_halo)
      outer = stage_seconds(clock, stage_p2g)
      call check(suite, 'a stage is charged with its time', inner >= 0.05_wp)
      ! half: the machine may take the processor away between two calls
      call check(suite, 'the stage around it is not', outer < 0.5_wp*inner)
      call check(suite, 'a stage that did not run took no time', &
         stage_seconds(clock, stage_crack) <= 0)
      table = stage_table(clock, comm, 1.0e6_wp, 320.0_wp)
      call check(suite, 'the table has all stages', &
         index(table, 'halo') > 0 .and. index(table, 'J and K') > 0 .and. index(table, 'total') > 0)
      call check(suite, 'the table names the share of the cracks', &
         index(table, 'share of the crack stages:   0.0%') > 0)
      call check(suite, 'the table has the bytes a particle', index(table, 'a particle: 320') > 0)
   end subroutine test_clock

   subroutine spend(seconds)
      real(wp), intent(in) :: seconds
      integer(i8) :: begun, now, rate

      call system_clock(begun, rate)
      now = begun
      do while (real(now - begun, wp) <= seconds*real(rate, wp))
         call system_clock(now)
      end do
   end subroutine spend

   subroutine test_failure(suite, comm)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      type(log_t) :: log
      type(error_t), allocatable :: error

      call open_log(log, comm, 'no/folder/x.log', .false., error)
      call check_error(suite, 'every rank hears that the log cannot be made', error, &
         'no/folder/x.log: the log cannot be created')
   end subroutine test_failure
end program test_log
