!> The energy balance. Velocities are known half a step after positions and stresses; the balance of
!> time t(n) takes the mean of both neighbours for all that follows velocities.
module xmpm_ledger
   use xmpm_kinds, only: wp, i8
   use xmpm_communicator, only: sum_all
   use xmpm_balance, only: balance_t, momenta
   use xmpm_unseen, only: unseen_energy
   use xmpm_model, only: model_t
   implicit none
   private

   public :: note_energies, take_balance, start_ledger

contains

   !> Begin the balance with the velocities that the particles have.
   subroutine start_ledger(m)
      type(model_t), intent(inout) :: m
      real(wp) :: kinetic
      integer :: c

      kinetic = 0
      do c = 1, m%particles%n_chunks
         if (m%particles%count(c) == 0) cycle
         kinetic = kinetic + 0.5_wp*sum(m%particles%q(:, 7, c)*(m%particles%q(:, 4, c)**2 &
            + m%particles%q(:, 5, c)**2 + m%particles%q(:, 6, c)**2))
      end do
      m%ledger%kinetic = kinetic
      m%ledger%strain = 0
      m%ledger%external = 0
      m%ledger%damping = 0
      m%ledger%transfer = 0
      m%ledger%seen = 0
      m%ledger%contact = 0
      m%contact%lost = 0
      m%rigid%work = 0
      m%ledger%largest = 0
      m%ledger%unseen_start = 0
      m%ledger%time = m%time
      m%nodal_work%external = 0
      m%nodal_work%damping = 0
      m%transfer_loss = 0
      m%seen_loss = 0
      m%loads%work = 0
      m%boundaries%work = 0
      call sum_all(m%comm, kinetic)
      m%ledger%kinetic_start = kinetic
   end subroutine start_ledger

   !> Take over the energies of the step just done, before time moves on.
   subroutine note_energies(m)
      type(model_t), intent(inout) :: m

      associate (l => m%ledger)
         l%time = m%time
         l%kinetic = [l%kinetic(2), m%tally%kinetic]
         l%strain = [l%strain(2), l%strain(2) + m%tally%work]
         l%damping = [l%damping(2), m%nodal_work%damping]
         l%transfer = [l%transfer(2), m%transfer_loss]
         l%seen = [l%seen(2), m%seen_loss]
         l%contact = [l%contact(2), m%contact%lost]
         l%external = [l%external(2), m%nodal_work%external + sum(m%loads%work) &
            + sum(m%boundaries%work) + m%rigid%work]
      end associate
   end subroutine note_energies

   !> The balance of the start of the last step, over all ranks; momenta, and where cracks grow what
   !> nodes do not see, cost passes over the particles. Collective.
   subroutine take_balance(m, with_momenta, balance)
      type(model_t), intent(inout) :: m
      logical, intent(in) :: with_momenta   !! whether these are wanted
      type(balance_t), intent(out) :: balance
      real(wp) :: sums(7)

      associate (l => m%ledger)
         sums = [0.5_wp*sum(l%kinetic), l%strain(1), 0.5_wp*sum(l%external), &
            0.5_wp*sum(l%damping), 0.5_wp*sum(l%transfer), 0.5_wp*sum(l%contact), &
            0.5_wp*sum(l%seen)]
         call sum_all(m%comm, sums)
         balance%time = l%time
         balance%step = max(0_i8, m%step - 1)
         balance%dt = m%dt_before
         balance%kinetic = sums(1)
         balance%strain = sums(2)
         balance%external = sums(3)
         balance%damping = sums(4)
         balance%transfer = sums(5)
         if (allocated(m%growth)) balance%fracture = sum(m%growth%energy)
         balance%contact = sums(6)
         balance%transfer_seen = sums(7)
         balance%error = sums(1) - l%kinetic_start + sums(2) + sums(4) + sums(5) + sums(6) &
            - sums(3)
         l%largest = max(l%largest, sums(1), abs(sums(2)), abs(sums(3)), l%kinetic_start)
         balance%relative_error = 0
         if (l%largest > 0) balance%relative_error = balance%error/l%largest
      end associate
      if (.not. with_momenta) return
      call momenta(m, balance%linear, balance%angular)
      if (.not. allocated(m%growth)) return
      if (size(m%growth) > 0) call take_fracture(m, balance)
   end subroutine take_balance

   !> The balance of the energy that nodes see, with fracture. What a front releases stays in parts
   !> of the particles' fields that no node sees until the transfer takes it from there: since
   !> growth began, these parts and what the transfer took of them are not counted, and fracture is
   !> in their place. Collective.
   subroutine take_fracture(m, balance)
      type(model_t), intent(inout) :: m
      type(balance_t), intent(inout) :: balance
      real(wp) :: unseen

      balance%unresolved = unseen_energy(m)
      unseen = balance%unresolved + balance%transfer - balance%transfer_seen
      associate (l => m%ledger)
         if (.not. balance%fracture > 0) l%unseen_start = unseen
         if (l%largest > 0) balance%fracture_error = (balance%error - unseen + l%unseen_start &
            + balance%fracture)/l%largest
      end associate
   end subroutine take_fracture
end module xmpm_ledger
