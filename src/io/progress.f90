!> Progress of a run by the wall clock: how far, how fast, how long still.
module xmpm_progress
   use xmpm_kinds, only: wp, i8
   use xmpm_log, only: log_t, log_to_file, log_message, show_line
   implicit none
   private

   public :: progress_t, run_state_t, start_progress, count_step, progress_due, report_progress
   public :: elapsed_seconds, clock_text

   real(wp), parameter :: file_interval = 10.0_wp      !! between two lines of the file [s]
   real(wp), parameter :: terminal_interval = 1.0_wp   !! between two updates on a terminal [s]
   integer, parameter :: rows_a_head = 30              !! lines between two headings

   !> Where a run stands, as it is shown.
   type :: run_state_t
      integer(i8) :: step = 0           !! steps done
      real(wp) :: time = 0              !! simulated time
      real(wp) :: dt = 0                !! last step
      real(wp) :: energy_error = 0      !! balance error over the largest energy
      real(wp) :: imbalance = 1         !! most particles of a rank over the mean
      real(wp), allocatable :: release(:)   !! least and largest J of the fronts, where it is known
   end type run_state_t

   !> What has been done since the start, and since the last line.
   type :: progress_t
      real(wp) :: start_time = 0    !! simulated time at the start
      real(wp) :: end_time = 0      !! simulated time at the end
      real(wp) :: work = 0          !! particle-steps done
      real(wp) :: work_shown = 0    !! of them, done at the last update
      integer(i8) :: begun = 0      !! clock at the start
      integer(i8) :: shown = 0      !! clock at the last update
      integer(i8) :: filed = 0      !! clock at the last line of the file
      integer :: rows = 0           !! lines of the file so far
   end type progress_t

   character(len=*), parameter :: heading = &
      '    step      time       dt   done  elapsed     left  Mp/s   run  energy imbal'

contains

   !> Start the clock and write the heading.
   subroutine start_progress(progress, log, start_time, end_time)
      type(progress_t), intent(out) :: progress   !! at the start
      type(log_t), intent(inout) :: log           !! gets an explanation of the columns
      real(wp), intent(in) :: start_time          !! simulated time now
      real(wp), intent(in) :: end_time            !! simulated time at the end

      progress%start_time = start_time
      progress%end_time = end_time
      call system_clock(progress%begun)
      progress%shown = progress%begun
      progress%filed = progress%begun
      call log_message(log, 'Progress; Mp/s: million particle-steps a second since the last '// &
         'line; run: since the start')
      call log_message(log, heading)
   end subroutine start_progress

   !> Count a step.
   pure subroutine count_step(progress, particles)
      type(progress_t), intent(inout) :: progress   !! counts it
      integer(i8), intent(in) :: particles          !! of all ranks

      progress%work = progress%work + real(particles, wp)
   end subroutine count_step

   !> Whether it is time for `report_progress`; the answer steers nothing else.
   function progress_due(progress, log) result(due)
      type(progress_t), intent(in) :: progress   !! since when
      type(log_t), intent(in) :: log             !! a terminal is served more often
      logical :: due

      due = .false.
      if (.not. log%active) return
      due = seconds_since(progress%shown) >= &
         merge(terminal_interval, file_interval, log%terminal .and. .not. log%quiet)
   end function progress_due

   !> Show the state; rank 0 calls. On a terminal the line replaces the one before it.
   subroutine report_progress(progress, log, state, last)
      type(progress_t), intent(inout) :: progress   !! keeps when it was shown
      type(log_t), intent(inout) :: log             !! written to
      type(run_state_t), intent(in) :: state        !! shown
      logical, intent(in), optional :: last         !! the run is over: write it in any case
      character(len=:), allocatable :: line
      logical :: file_due

      file_due = seconds_since(progress%filed) >= file_interval
      if (present(last)) file_due = file_due .or. last
      line = progress_line(progress, state)
      call show_line(log, line)
      if (file_due) then
         progress%rows = progress%rows + 1
         if (mod(progress%rows, rows_a_head) == 0) call log_to_file(log, heading)
         call log_to_file(log, line)
         call system_clock(progress%filed)
      end if
      call system_clock(progress%shown)
      progress%work_shown = progress%work
   end subroutine report_progress

   !> Wall time since the start.
   function elapsed_seconds(progress) result(seconds)
      type(progress_t), intent(in) :: progress   !! since when
      real(wp) :: seconds                        !! [s]

      seconds = seconds_since(progress%begun)
   end function elapsed_seconds

   !> The columns of the heading.
   function progress_line(progress, state) result(line)
      type(progress_t), intent(in) :: progress
      type(run_state_t), intent(in) :: state
      character(len=:), allocatable :: line
      real(wp) :: done, elapsed, interval
      character(len=100) :: buffer

      done = (state%time - progress%start_time)/ &
         max(progress%end_time - progress%start_time, tiny(done))
      elapsed = seconds_since(progress%begun)
      interval = seconds_since(progress%shown)
      write (buffer, '(i8,es10.2,es9.1,f6.1,a,2a9,2a6,es8.0,f6.2)') &
         state%step, state%time, state%dt, 100*done, '%', clock_text(elapsed), &
         left_text(done, elapsed), speed_text(progress%work - progress%work_shown, interval), &
         speed_text(progress%work, elapsed), state%energy_error, state%imbalance
      line = trim(buffer)
      if (.not. allocated(state%release)) return
      write (buffer, '(a,es9.2,a,es9.2)') '  J', state%release(1), ' to', state%release(2)
      line = line//trim(buffer)
   end function progress_line

   function left_text(done, elapsed) result(text)
      real(wp), intent(in) :: done, elapsed
      character(len=9) :: text

      text = adjustr('?        ')
      if (done > 1.0e-6_wp) text = clock_text(elapsed*max(0.0_wp, 1 - done)/done)
   end function left_text

   !> Seconds as h:mm:ss.
   function clock_text(seconds) result(text)
      real(wp), intent(in) :: seconds   !! [s]
      character(len=9) :: text
      integer(i8) :: whole

      whole = nint(min(seconds, 3.5e7_wp), i8)
      write (text, '(i3,2(a,i2.2))') whole/3600, ':', mod(whole/60, 60_i8), ':', mod(whole, 60_i8)
      if (whole >= 999*3600) text = ' > 999 h '
   end function clock_text

   !> Million particle-steps a second, in five digits at most.
   function speed_text(work, seconds) result(text)
      real(wp), intent(in) :: work, seconds
      character(len=6) :: text
      real(wp) :: speed

      speed = 1.0e-6_wp*work/max(seconds, 1.0e-9_wp)
      if (speed < 99) then
         write (text, '(f6.2)') speed
      else
         write (text, '(i6)') nint(min(speed, 99999.0_wp))
      end if
   end function speed_text

   function seconds_since(count) result(seconds)
      integer(i8), intent(in) :: count
      real(wp) :: seconds
      integer(i8) :: now, rate

      call system_clock(now, rate)
      seconds = real(now - count, wp)/real(rate, wp)
   end function seconds_since
end module xmpm_progress
