!> The log of a run: what rank 0 says on standard output and in a file.
module xmpm_log
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: output_unit
   use xmpm_error, only: error_t, raise, code_files
   use xmpm_text, only: string_t
   use xmpm_communicator, only: comm_t, agree_on_error
   use xmpm_provenance, only: provenance_t, provenance_names, provenance_values
   implicit none
   private

   public :: log_t, open_log, close_log, log_header, log_message, log_warning, log_end
   public :: log_to_file, show_line

   !> An open log; on ranks other than 0 nothing is written.
   type :: log_t
      integer :: unit = -1            !! of the file; -1 where there is none
      integer :: warnings = 0         !! number of warnings so far
      logical :: active = .false.     !! rank 0
      logical :: quiet = .false.      !! standard output gets warnings and the end only
      logical :: terminal = .false.   !! standard output is a terminal
      logical :: line_open = .false.  !! a line that will be replaced stands on the terminal
   end type log_t

   interface
      function c_isatty(descriptor) result(answer) bind(c, name='isatty')
         import :: c_int
         implicit none
         integer(c_int), value :: descriptor
         integer(c_int) :: answer
      end function c_isatty
   end interface

contains

   !> Open the log; all ranks must call.
   subroutine open_log(log, comm, path, quiet, error)
      type(log_t), intent(out) :: log                      !! open on return
      type(comm_t), intent(in) :: comm                     !! rank 0 will write
      character(len=*), intent(in) :: path                 !! of the file; '' for none
      logical, intent(in) :: quiet                         !! keep standard output short
      type(error_t), allocatable, intent(out) :: error     !! the file cannot be created
      integer :: status

      log%active = comm%rank == 0
      log%quiet = quiet
      log%terminal = on_terminal()
      if (log%active .and. len(path) > 0) then
         open (newunit=log%unit, file=path, status='replace', action='write', iostat=status)
         if (status /= 0) then
            log%unit = -1
            call raise(error, code_files, path//': the log cannot be created')
         end if
      end if
      call agree_on_error(comm, error)
   end subroutine open_log

   !> Close the log's file.
   subroutine close_log(log)
      type(log_t), intent(inout) :: log   !! closed on return

      call end_line(log)
      if (log%unit /= -1) close (log%unit)
      log%unit = -1
   end subroutine close_log

   !> Write what the run was made by and from.
   subroutine log_header(log, provenance)
      type(log_t), intent(inout) :: log              !! written to
      type(provenance_t), intent(in) :: provenance   !! of the run
      character(len=11) :: names(12)
      type(string_t) :: values(12)
      integer :: i

      names = provenance_names()
      values = provenance_values(provenance)
      call log_message(log, values(1)%s)
      do i = 2, size(names)
         call log_message(log, '  '//names(i)//'  '//values(i)%s)
      end do
      call log_message(log, '')
   end subroutine log_header

   !> Write a line, or several split by new_line; left out on standard output of a quiet run.
   subroutine log_message(log, text)
      type(log_t), intent(inout) :: log      !! written to
      character(len=*), intent(in) :: text   !! what to say

      call log_to_file(log, text)
      if (.not. log%quiet) call say(log, text)
   end subroutine log_message

   !> Write a warning, quiet or not.
   subroutine log_warning(log, text)
      type(log_t), intent(inout) :: log      !! written to
      character(len=*), intent(in) :: text   !! what is doubtful, and what to do

      log%warnings = log%warnings + 1
      call log_to_file(log, 'warning: '//text)
      call say(log, 'warning: '//text)
   end subroutine log_warning

   !> Write how the run ended, quiet or not.
   subroutine log_end(log, text)
      type(log_t), intent(inout) :: log      !! written to
      character(len=*), intent(in) :: text   !! for example 'finished at step 120'

      call log_to_file(log, text)
      call say(log, text)
   end subroutine log_end

   !> Write a line to the file alone.
   subroutine log_to_file(log, text)
      type(log_t), intent(in) :: log         !! written to
      character(len=*), intent(in) :: text   !! what to say
      integer :: status

      if (log%unit == -1) return
      write (log%unit, '(a)', iostat=status) text   ! a full disk must not end the run here
      if (status == 0) flush (log%unit)
   end subroutine log_to_file

   !> Show a line on standard output alone; on a terminal it replaces the line shown before it.
   subroutine show_line(log, text)
      type(log_t), intent(inout) :: log      !! written to
      character(len=*), intent(in) :: text   !! one line

      if (log%quiet .or. .not. log%active) return
      if (log%terminal) then
         write (output_unit, '(3a)', advance='no') achar(13), text, achar(27)//'[K'
         flush (output_unit)
         log%line_open = .true.
      else
         call say(log, text)
      end if
   end subroutine show_line

   !> Write a line to standard output.
   subroutine say(log, text)
      type(log_t), intent(inout) :: log
      character(len=*), intent(in) :: text

      if (.not. log%active) return
      call end_line(log)
      write (output_unit, '(a)') text
      flush (output_unit)
   end subroutine say

   !> Leave the line that is being replaced where it is.
   subroutine end_line(log)
      type(log_t), intent(inout) :: log

      if (log%line_open) write (output_unit, '(a)') ''
      log%line_open = .false.
   end subroutine end_line

   !> Whether standard output is a terminal.
   !>
   !> Under mpirun it is a pseudo-terminal, whatever the user has sent its output to.
   function on_terminal() result(answer)
      logical :: answer
      character(len=20), parameter :: launchers(3) = &
         [character(len=20) :: 'OMPI_COMM_WORLD_SIZE', 'PMI_SIZE', 'PMIX_RANK']
      integer :: i, status

      answer = c_isatty(1_c_int) == 1
      do i = 1, size(launchers)
         call get_environment_variable(trim(launchers(i)), status=status)
         if (status == 0) answer = .false.
      end do
   end function on_terminal
end module xmpm_log
