!> Contact of bodies as a stage of the step.
module xmpm_meet
   use xmpm_kinds, only: wp
   use xmpm_grid, only: f_velocity
   use xmpm_contact, only: apply_impulses, note_loss, hold_side
   use xmpm_contact_gap, only: measure_gaps
   use xmpm_rigid, only: predict_motion, meet_rigid, move_rigid, hold_rigid
   use xmpm_model, only: model_t
   implicit none
   private

   public :: measure_contact, meet_bodies

contains

   !> Normals and gaps for the particles as they are. Collective.
   subroutine measure_contact(m)
      type(model_t), intent(inout) :: m

      call measure_gaps(m%contact, m%comm, m%particles, m%bodies%half, m%sided, m%grid)
   end subroutine measure_contact

   !> Impulses between bodies on three fields of the rows: on the velocity of the nodal update, with
   !> the motion of rigid bodies, or on a velocity that only strains. Collective.
   subroutine meet_bodies(m, field)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: field   !! f_velocity: after the nodal update; f_change: straining
      logical :: whole

      whole = field == f_velocity
      call note_conditions(m)
      if (whole .and. m%rigid%n > 0) call predict_motion(m%rigid, m%comm, m%grid)
      call hold_rigid(m%contact, m%grid, field)
      if (whole .and. m%rigid%n > 0) call meet_rigid(m%rigid, m%contact, m%comm, m%grid)
      call apply_impulses(m%contact, m%grid, field, whole)
      if (.not. whole) return
      if (m%rigid%n > 0) call move_rigid(m%rigid, m%contact, m%comm, m%grid)
      call note_loss(m%contact, m%grid, m%rigid%before)
   end subroutine meet_bodies

   !> What the conditions of the deck prescribe of the rows of pairs.
   subroutine note_conditions(m)
      type(model_t), intent(inout) :: m
      integer :: i, k, d

      m%contact%held = .false.
      if (m%contact%n == 0) return
      do i = 1, size(m%boundaries)
         do k = 1, size(m%boundaries(i)%rows)
            if (m%contact%many(m%boundaries(i)%rows(k)) == 0) cycle
            do d = 1, 3
               if (m%boundaries(i)%holds(d)) call hold_side(m%contact, m%boundaries(i)%rows(k), d, &
                  m%boundaries(i)%velocity(d))
            end do
         end do
      end do
   end subroutine note_conditions
end module xmpm_meet
