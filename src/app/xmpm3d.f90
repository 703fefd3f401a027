!> The program: arguments, deck, set-up, run, and the one place where it stops.
program xmpm3d
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel
   use xmpm_text, only: string_t
   use xmpm_command_line, only: options_t, get_arguments, parse_command_line
   use xmpm_front_desk, only: answer, complain_and_code
   use xmpm_session, only: run_session
   implicit none

   type(comm_t) :: comm
   type(options_t) :: options
   type(string_t), allocatable :: arguments(:)
   type(error_t), allocatable :: error
   logical :: answered

   call get_arguments(arguments)
   call parse_command_line(arguments, options, error)
   if (.not. allocated(error)) then
      call answer(options, answered)
      if (answered) stop
   end if
   call start_parallel(comm)
   if (.not. allocated(error)) call run_session(comm, options, error)
   call stop_parallel(comm, complain_and_code(comm, error))
end program xmpm3d
