!> The schemes of a step. Velocities live half a step before positions and stresses (leapfrog, fig.
!> 6 of 10.1002/nme.6653): v(n+1/2) = v(n-1/2) + (dt(n-1/2) + dt(n+1/2))/2 a(n).
module xmpm_schemes
   use xmpm_kinds, only: wp
   use xmpm_stages, only: map_to_grid, advance_nodes, map_to_particles, strain_particles, &
      move_particles, strain_before, advance_cracks, new_velocity_for_strain, finish_work
   use xmpm_model, only: model_t
   implicit none
   private

   public :: step_musl, step_usf, step_usl

contains

   !> Stress last, with the velocity of a second map (Sulsky, Zhou and Schreyer 1995).
   subroutine step_musl(m, dt)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: dt   !! [time]

      call map_to_grid(m)                         ! mass, momentum, force: eq. 6-8, 23-28
      call advance_nodes(m, velocity_step(m, dt)) ! eq. 4, 29
      call map_to_particles(m, remap=.true.)      ! eq. 43 and the second map
      call finish_work(m, velocity_step(m, dt))
      call advance_cracks(m, dt)
      call strain_particles(m, dt)                ! eq. 45, 46, 44
   end subroutine step_musl

   !> Stress first, with the velocity that the particles brought.
   subroutine step_usf(m, dt)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: dt   !! [time]

      call strain_before(m, m%dt_before)
      call map_to_grid(m)
      call advance_nodes(m, velocity_step(m, dt))
      call map_to_particles(m, remap=.true.)      ! for work and cracks only
      call finish_work(m, velocity_step(m, dt))
      call advance_cracks(m, dt)
      call move_particles(m, dt)
   end subroutine step_usf

   !> Stress last, with the nodal velocity itself; not stable.
   subroutine step_usl(m, dt)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: dt   !! [time]

      call map_to_grid(m)
      call advance_nodes(m, velocity_step(m, dt))
      call map_to_particles(m, remap=size(m%cracks) > 0)
      call advance_cracks(m, dt)
      call new_velocity_for_strain(m)
      call finish_work(m, velocity_step(m, dt))
      call strain_particles(m, dt)
   end subroutine step_usl

   !> Time from v(n-1/2) to v(n+1/2); half a step at the start, where v is that of t = 0.
   pure function velocity_step(m, dt) result(span)
      type(model_t), intent(in) :: m
      real(wp), intent(in) :: dt   !! [time]
      real(wp) :: span             !! [time]

      span = 0.5_wp*(m%dt_before + dt)
   end function velocity_step
end module xmpm_schemes
