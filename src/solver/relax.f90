!> Bringing the bodies to rest under the loads of t = 0, before the dynamics begin.
module xmpm_relax
   use xmpm_kinds, only: wp
   use xmpm_text, only: to_text, lower
   use xmpm_error, only: error_t, raise, code_numerics
   use xmpm_communicator, only: sum_all
   use xmpm_deck, only: deck_t, block_t, count_blocks, find_block, has, real_of, text_of
   use xmpm_log, only: log_t, log_message
   use xmpm_settle, only: settle, choose_step
   use xmpm_ledger, only: start_ledger
   use xmpm_model, only: model_t
   implicit none
   private

   public :: relax

contains

   !> Step with damping until the forces are in balance, then stop all motion at t = 0.
   !>
   !> Kinetic damping stops all motion at each peak of kinetic energy; viscous damping takes the
   !> rate of the deck. The residual is the sum over the nodes of |m a| over the largest that it
   !> had with the reactions. Loads stay those of t = 0. Collective.
   subroutine relax(m, deck, log, error)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(in) :: deck
      type(log_t), intent(inout) :: log
      type(error_t), allocatable, intent(out) :: error
      type(block_t) :: block
      real(wp) :: kinetic(2), limit, spent, residual, largest, viscous, wanted
      logical :: by_peaks
      integer :: peaks

      if (count_blocks(deck, 'relax') == 0) return
      block = find_block(deck, 'relax', 1)
      by_peaks = lower(text_of(block, 'method')) == 'kinetic'
      limit = real_of(block, 'limit')
      wanted = real_of(block, 'residual')
      viscous = m%options%viscous
      if (.not. by_peaks) m%options%viscous = real_of(block, 'rate')
      m%relaxing = .true.
      spent = 0
      kinetic = 0
      largest = 0
      peaks = 0
      residual = 1
      do
         call one_step(m, error)
         if (allocated(error)) return
         spent = spent + m%dt
         kinetic = [kinetic(2), m%tally%kinetic]
         call sum_all(m%comm, kinetic(2))
         if (by_peaks .and. kinetic(2) < kinetic(1)) then
            call stop_motion(m)
            kinetic = 0
            peaks = peaks + 1
         end if
         call measure(m, largest, residual)
         if (residual < wanted) exit
         if (spent < limit) cycle
         call raise(error, code_numerics, 'the bodies did not come to rest within the limit of '// &
            to_text(limit)//': the residual is '//to_text(residual)//', not '//to_text(wanted))
         return
      end do
      call log_message(log, 'at rest after '//to_text(m%step)//' steps, simulated time '// &
         to_text(spent)//', '//to_text(peaks)//' peaks of kinetic energy, residual '// &
         to_text(residual))
      m%options%viscous = viscous
      m%relaxing = .false.
      call stop_motion(m)
      m%step = 0
      m%time = 0
      m%dt_before = 0
      call start_ledger(m)
   end subroutine relax

   !> One step with the clock held at 0.
   subroutine one_step(m, error)
      type(model_t), intent(inout) :: m
      type(error_t), allocatable, intent(out) :: error

      m%time = 0
      call choose_step(m, huge(1.0_wp), error)
      if (allocated(error)) return
      call m%take_step(m, m%dt)
      call settle(m, error)
      m%time = 0
   end subroutine one_step

   !> Force out of balance over the largest force so far, reactions included. Collective.
   subroutine measure(m, largest, residual)
      type(model_t), intent(inout) :: m
      real(wp), intent(inout) :: largest    !! force out of balance and reactions, the most so far
      real(wp), intent(out) :: residual
      real(wp) :: force
      real(wp) :: reactions(3*size(m%boundaries))
      integer :: i

      reactions = [(m%boundaries(i)%reaction, i=1, size(m%boundaries))]
      call sum_all(m%comm, reactions)
      force = m%force
      call sum_all(m%comm, force)
      largest = max(largest, force + sum(abs(reactions)))
      residual = 0
      if (largest > 0) residual = force/largest
   end subroutine measure

   !> Set all velocities to zero.
   subroutine stop_motion(m)
      type(model_t), intent(inout) :: m
      integer :: c

      do c = 1, m%particles%n_chunks
         m%particles%q(:, 4:6, c) = 0
      end do
      m%dt_before = 0
   end subroutine stop_motion
end module xmpm_relax
