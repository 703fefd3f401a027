!> Contact of bodies as a stage of the step.
module xmpm_meet
   use xmpm_kinds, only: wp
   use xmpm_grid, only: f_velocity, f_change
   use xmpm_contact, only: apply_impulses, hold_side, note_reach, note_pull, note_first, &
      note_second, note_again
   use xmpm_contact_gap, only: measure_gaps
   use xmpm_rigid, only: predict_motion, meet_rigid, move_rigid, hold_rigid
   use xmpm_model, only: model_t
   implicit none
   private

   public :: measure_contact, meet_bodies, meet_straining, meet_again, note_conditions

contains

   !> Normals and gaps for the particles as they are, with the forces on the rows. Collective.
   subroutine measure_contact(m)
      type(model_t), intent(inout) :: m

      call measure_gaps(m%contact, m%comm, m%particles, m%bodies%half, m%sided, m%grid)
      call note_pull(m%contact, m%grid, m%dt_before)
   end subroutine measure_contact

   !> Impulses between bodies on three fields of the rows: on the velocity of the nodal update, with
   !> the motion of rigid bodies, or on a velocity that only strains. Collective.
   subroutine meet_bodies(m, field)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: field   !! f_velocity: after the nodal update; f_change: straining
      logical :: whole

      whole = field == f_velocity
      call note_conditions(m)
      if (whole) call note_reach(m%contact, m%grid%lattice%size, m%dt)
      if (whole .and. m%rigid%n > 0) call predict_motion(m%rigid, m%comm, m%grid)
      call hold_rigid(m%contact, m%grid, field)
      if (whole .and. m%rigid%n > 0) call meet_rigid(m%rigid, m%contact, m%comm, m%grid)
      call apply_impulses(m%contact, m%grid, field, whole)
      if (.not. whole) return
      if (m%rigid%n > 0) call move_rigid(m%rigid, m%contact, m%comm, m%grid)
      call note_first(m%contact, m%grid, m%rigid%before)
      if (m%options%strain_by_nodes) call note_second(m%contact, m%grid, f_velocity)
   end subroutine meet_bodies

   !> Impulses between bodies on the velocity that strains them in MUSL and USF, with what stress
   !> does on the way that they change. Collective.
   subroutine meet_straining(m)
      type(model_t), intent(inout) :: m

      call meet_bodies(m, f_change)
      call note_again(m%contact, m%grid, m%dt)
   end subroutine meet_straining

   !> Impulses between bodies on the velocity of the second map, which tells what the impulses of
   !> the nodal update took. Collective.
   subroutine meet_again(m)
      type(model_t), intent(inout) :: m

      if (.not. m%options%strain_by_nodes) call note_second(m%contact, m%grid, f_change)
      if (m%options%strain_first .or. m%options%strain_by_nodes) then
         call meet_bodies(m, f_change)
         m%contact%again = 0   ! does not strain
      else
         call meet_straining(m)
      end if
   end subroutine meet_again

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
