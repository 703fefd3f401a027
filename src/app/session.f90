!> One run from the deck's text to the closed files.
module xmpm_session
   use xmpm_kinds, only: wp, i8
   use xmpm_text, only: string_t
   use xmpm_error, only: error_t
   use xmpm_sha256, only: sha256
   use xmpm_communicator, only: comm_t, broadcast, agree_on_error, sum_all
   use xmpm_build_info, only: version, git_hash, compiler, flags, metis_version
   use xmpm_deck, only: deck_t, block_t, read_deck, parse_deck, deck_name, deck_echo, find_block, &
      text_of, warnings_of
   use xmpm_provenance, only: provenance_t, start_provenance
   use xmpm_file_system, only: make_folder
   use xmpm_log, only: log_t, open_log, close_log, log_header, log_message, log_warning, log_end, &
      log_to_file
   use xmpm_stage_clock, only: stage_table
   use xmpm_results, only: results_t, open_results, write_fields, close_results
   use xmpm_setup, only: set_up
   use xmpm_check_report, only: report_check
   use xmpm_run, only: run_model
   use xmpm_model, only: model_t
   use xmpm_command_line, only: options_t
   implicit none
   private

   public :: run_session

contains

   !> Read the deck, set up, run or check, and close. All ranks end with the same error.
   subroutine run_session(comm, options, error)
      type(comm_t), intent(in) :: comm
      type(options_t), intent(in) :: options
      type(error_t), allocatable, intent(out) :: error
      type(deck_t) :: deck
      type(provenance_t) :: provenance
      type(log_t) :: log
      type(block_t) :: job

      call start_provenance(provenance, comm)
      call get_deck(comm, options, deck, provenance, error)
      if (allocated(error)) return
      call make_folder(options%folder, error)
      call agree_on_error(comm, error)
      if (allocated(error)) return
      job = find_block(deck, 'job', 1)
      call open_log(log, comm, in_folder(options%folder, job%name//'.log'), options%quiet, error)
      call agree_on_error(comm, error)
      if (allocated(error)) return
      call log_header(log, provenance)
      call log_to_file(log, deck_echo(deck))
      call work(comm, options, deck, provenance, log, error)
      if (allocated(error)) then
         call log_end(log, 'stopped: '//error%message)
      else
         call log_end(log, 'finished')
      end if
      call close_log(log)
   end subroutine run_session

   !> Rank 0 reads the deck, all parse it.
   subroutine get_deck(comm, options, deck, provenance, error)
      type(comm_t), intent(in) :: comm
      type(options_t), intent(in) :: options
      type(deck_t), intent(out) :: deck
      type(provenance_t), intent(inout) :: provenance
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: text
      type(block_t) :: block

      text = ''
      if (comm%rank == 0) call read_deck(options%deck, text, error)
      call agree_on_error(comm, error)
      if (allocated(error)) return
      call broadcast(comm, text)
      call parse_deck(text, deck_name(options%deck), deck, error)
      call agree_on_error(comm, error)
      if (allocated(error)) return
      provenance%version = version
      provenance%git_hash = git_hash
      provenance%compiler = compiler
      provenance%flags = flags
      provenance%metis = metis_version
      provenance%deck_sha256 = sha256(text)
      block = find_block(deck, 'job', 1)
      provenance%job = block%name
      block = find_block(deck, 'units', 1)
      provenance%units = text_of(block, 'length')//' '//text_of(block, 'mass')//' '// &
         text_of(block, 'time')
   end subroutine get_deck

   pure function in_folder(folder, name) result(path)
      character(len=*), intent(in) :: folder, name
      character(len=:), allocatable :: path

      path = name
      if (len(folder) > 0) path = folder//'/'//name
   end function in_folder

   !> Set up, and run or check.
   subroutine work(comm, options, deck, provenance, log, error)
      type(comm_t), intent(in) :: comm
      type(options_t), intent(in) :: options
      type(deck_t), intent(inout) :: deck
      type(provenance_t), intent(in) :: provenance
      type(log_t), intent(inout) :: log
      type(error_t), allocatable, intent(out) :: error
      type(model_t) :: m
      type(results_t) :: results
      type(error_t), allocatable :: late
      character(len=:), allocatable :: table

      m%comm = comm
      call set_up(m, deck, error)
      call tell_warnings(deck, log)
      if (allocated(error)) return
      call open_results(results, m, deck, provenance, options%folder, provenance%job, error)
      call agree_on_error(comm, error)
      if (allocated(error)) return
      call report_check(m, deck, log)
      if (options%check) then
         call write_fields(results, m, error)
      else
         call run_model(m, deck, results, log, error)
         table = stage_table(m%clock, comm, real(m%n_particles, wp)*real(m%step, wp), bytes_of(m))
         call log_message(log, table)
      end if
      call close_results(results, m, late)
      if (.not. allocated(error) .and. allocated(late)) call move_alloc(late, error)
      call agree_on_error(comm, error)
   end subroutine work

   subroutine tell_warnings(deck, log)
      type(deck_t), intent(in) :: deck
      type(log_t), intent(inout) :: log
      type(string_t), allocatable :: list(:)
      integer :: i

      list = warnings_of(deck)
      do i = 1, size(list)
         call log_warning(log, list(i)%s)
      end do
   end subroutine tell_warnings

   !> Memory of particles and rows for each particle, over all ranks. Collective.
   function bytes_of(m) result(bytes)
      type(model_t), intent(in) :: m
      real(wp) :: bytes

      bytes = 8*(real(size(m%particles%q), wp) + real(size(m%particles%x0), wp) &
         + 2*real(size(m%particles%id), wp) + real(size(m%particles%near), wp) &
         + real(size(m%grid%node), wp) + real(size(m%grid%second), wp))
      call sum_all(m%comm, bytes)
      bytes = bytes/real(max(1_i8, m%n_particles), wp)
   end function bytes_of
end module xmpm_session
