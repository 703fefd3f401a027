!> The run: steps, and what is written, watched and said between them.
module xmpm_run
   use xmpm_kinds, only: wp, i8
   use xmpm_text, only: to_text
   use xmpm_error, only: error_t, raise, code_numerics
   use xmpm_deck, only: deck_t
   use xmpm_stage_clock, only: start_stage, stop_stage, stage_output
   use xmpm_log, only: log_t, log_message, log_warning
   use xmpm_progress, only: progress_t, run_state_t, start_progress, count_step, progress_due, &
      report_progress
   use xmpm_balance, only: balance_t
   use xmpm_results, only: results_t, write_fields, write_energy, write_probes, write_front_values
   use xmpm_stages, only: measure_fronts
   use xmpm_ledger, only: take_balance
   use xmpm_settle, only: settle, choose_step
   use xmpm_grow_cracks, only: judge_fronts, note_rates
   use xmpm_overlap, only: overlap_of_faces
   use xmpm_relax, only: relax
   use xmpm_fracture, only: fracture_t, release_range
   use xmpm_model, only: model_t
   implicit none
   private

   public :: run_model

   integer(i8), parameter :: watch_interval = 50   !! steps between looks at the energy balance

   !> When what is due.
   type :: agenda_t
      real(wp) :: fields = 0      !! time of the next files [time]
      real(wp) :: history = 0     !! time of the next rows [time]
      real(wp) :: fronts = 0      !! time of the next values at the fronts [time]
      type(balance_t) :: balance  !! the last one taken
      logical :: told = .false.   !! that faces of a crack overlap
   end type agenda_t

contains

   !> Relax if asked, then step to the end. On a failure the last state is written. Collective.
   subroutine run_model(m, deck, results, log, error)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(in) :: deck
      type(results_t), intent(inout) :: results
      type(log_t), intent(inout) :: log
      type(error_t), allocatable, intent(out) :: error   !! code_numerics or code_files
      type(agenda_t) :: agenda
      type(progress_t) :: progress
      type(error_t), allocatable :: late

      call relax(m, deck, log, error)
      if (allocated(error)) then
         call write_fields(results, m, late)
         return
      end if
      call start_progress(progress, log, m%time, m%options%end_time)
      if (.not. m%fracture%every > 0) agenda%fronts = &
         fronts_due(0.0_wp, m%fracture%at, -1.0_wp, 0.0_wp)
      call write_due(m, results, agenda, .false., error)
      do while (.not. allocated(error))
         if (m%time >= m%options%end_time .or. m%step >= int(m%options%most_steps, i8)) exit
         call choose_step(m, m%options%end_time, error)
         if (allocated(error)) exit
         call judge_fronts(m)
         call m%take_step(m, m%dt)
         call settle(m, error)
         call tell_growth(m, log)
         if (allocated(error)) exit
         call write_due(m, results, agenda, is_last(m), error)
         call watch_energy(m, agenda, log, error)
         call watch_faces(m, agenda, log)
         call count_step(progress, m%n_particles)
         if (progress_due(progress, log)) call report_progress(progress, log, state_of(m, agenda))
      end do
      call report_progress(progress, log, state_of(m, agenda), last=.true.)
      if (allocated(error)) call write_fields(results, m, late)
   end subroutine run_model

   !> Tell the log what the growth of cracks has met.
   subroutine tell_growth(m, log)
      type(model_t), intent(inout) :: m
      type(log_t), intent(inout) :: log
      integer :: g, i

      if (.not. allocated(m%growth)) return
      do g = 1, size(m%growth)
         do i = 1, size(m%growth(g)%news)
            call log_message(log, m%growth(g)%news(i)%s)
         end do
         if (size(m%growth(g)%news) == 0) cycle
         deallocate (m%growth(g)%news)
         allocate (m%growth(g)%news(0))
      end do
   end subroutine tell_growth

   pure function is_last(m) result(last)
      type(model_t), intent(in) :: m
      logical :: last

      last = m%time >= m%options%end_time .or. m%step >= int(m%options%most_steps, i8)
   end function is_last

   pure function state_of(m, agenda) result(state)
      type(model_t), intent(in) :: m
      type(agenda_t), intent(in) :: agenda
      type(run_state_t) :: state

      state%step = m%step
      state%time = m%time
      state%dt = m%dt_before
      state%energy_error = agenda%balance%relative_error
      state%imbalance = m%imbalance
      if (m%fracture%measured) state%release = release_range(m%fracture)
   end function state_of

   !> Write the files and rows that are due. Collective.
   subroutine write_due(m, results, agenda, last, error)
      type(model_t), intent(inout) :: m
      type(results_t), intent(inout) :: results
      type(agenda_t), intent(inout) :: agenda
      logical, intent(in) :: last
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: slack

      slack = 1e-9_wp*m%options%end_time
      if (is_due(m%fracture, m%time, agenda%fronts - slack, last)) then
         call measure_fronts(m)
         call note_rates(m)
         call write_front_values(results, m)
         agenda%fronts = fronts_due(m%fracture%every, m%fracture%at, m%time, slack)
      end if
      call start_stage(m%clock, stage_output)
      if (last .or. m%time >= agenda%history - slack) then
         call take_balance(m, .true., agenda%balance)
         call write_energy(results, m, agenda%balance)
         call write_probes(results, m)
         agenda%history = next_due(m%time, results%history_every, slack)
      end if
      if (last .or. m%time >= agenda%fields - slack) then
         call write_fields(results, m, error)
         agenda%fields = next_due(m%time, results%every, slack)
      end if
      call stop_stage(m%clock, stage_output)
   end subroutine write_due

   !> Whether values at the fronts are wanted now; those of an interval at the end in any case.
   pure function is_due(fracture, time, due, last) result(is)
      type(fracture_t), intent(in) :: fracture
      real(wp), intent(in) :: time, due
      logical, intent(in) :: last
      logical :: is

      is = size(fracture%cracks) > 0 .and. (time >= due .or. (last .and. fracture%every > 0))
   end function is_due

   !> Next time of values at the fronts: of the interval or of the list.
   pure function fronts_due(every, at, time, slack) result(due)
      real(wp), intent(in) :: every, at(:), time, slack
      real(wp) :: due

      due = huge(due)
      if (any(at > time + slack)) due = minval(at, at > time + slack)
      if (every > 0) due = min(due, next_due(time, every, slack))
   end function fronts_due

   pure function next_due(time, every, slack) result(due)
      real(wp), intent(in) :: time, every, slack
      real(wp) :: due

      due = every*(1 + real(floor((time + slack)/every), wp))
   end function next_due

   !> Give up where the energy balance is off by more than the deck's limit. Collective.
   subroutine watch_energy(m, agenda, log, error)
      type(model_t), intent(inout) :: m
      type(agenda_t), intent(inout) :: agenda
      type(log_t), intent(inout) :: log
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error)) return
      if (mod(m%step, watch_interval) /= 0) return
      call take_balance(m, .false., agenda%balance)
      if (.not. m%options%energy_limit > 0) return
      if (abs(agenda%balance%relative_error) <= m%options%energy_limit) return
      call raise(error, code_numerics, 'step '//to_text(m%step)//', time '//to_text(m%time)// &
         ': the energy balance is off by '//to_text(agenda%balance%relative_error)// &
         ' of the energy, more than the limit of '//to_text(m%options%energy_limit)// &
         ' (energy in *HEALTH; 0 for no limit)')
      call log_warning(log, error%message)
   end subroutine watch_energy

   !> Warn once where the faces of a crack without contact overlap. Collective.
   subroutine watch_faces(m, agenda, log)
      type(model_t), intent(in) :: m
      type(agenda_t), intent(inout) :: agenda
      type(log_t), intent(inout) :: log
      character(len=:), allocatable :: text

      if (agenda%told .or. size(m%cracks) == 0) return
      if (mod(m%step, watch_interval) /= 0 .and. .not. is_last(m)) return
      call overlap_of_faces(m, text)
      agenda%told = len(text) > 0
      if (agenda%told) call log_warning(log, text)
   end subroutine watch_faces
end module xmpm_run
