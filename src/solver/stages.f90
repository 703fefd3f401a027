!> The stages of a step, each a few calls to the layers below.
module xmpm_stages
   use xmpm_kinds, only: wp
   use xmpm_halo, only: start_sum, finish_sum
   use xmpm_stage_clock, only: start_stage, stop_stage, stage_p2g, stage_grid, stage_g2p, &
      stage_stress, stage_halo, stage_crack, stage_fracture
   use xmpm_grid, only: clear_rows, f_velocity, f_change
   use xmpm_momentum, only: force_out_of_balance, advance_momentum, add_nodal_work, &
      impulse_energy, &
      blend_change, velocity_from_second, change_from_velocity, sharpen_rows
   use xmpm_boundary, only: apply_boundary, hold_boundary, region_set
   use xmpm_transfer, only: tally_t, particles_to_grid, update_velocity, update_stress, &
      advance_positions
   use xmpm_transfer_loss, only: note_flip, loss_of_transfer
   use xmpm_storage, only: lanes, c_m
   use xmpm_loads, only: apply_load, power_of_load, rows_of_bin, push_chunk
   use xmpm_lattice, only: stencil_offsets
   use xmpm_curves, only: curve_value
   use xmpm_crack, only: advance_crack
   use xmpm_fracture, only: measure_front
   use xmpm_front_flags, only: flag_conditions
   use xmpm_face_forces, only: faces_meet, find_face_forces, part_faces
   use xmpm_seen_loss, only: smooth, seen_loss, wants_seen_loss, look_interval
   use xmpm_meet, only: measure_contact, meet_bodies, meet_straining, meet_again
   use xmpm_model, only: model_t
   implicit none
   private

   public :: map_to_grid, advance_nodes, map_to_particles, strain_particles, move_particles
   public :: strain_before, advance_cracks, new_velocity_for_strain, finish_work, measure_fronts

contains

   !> Mass, momentum and force of all rows: eq. 6 to 8 and 23 to 28. Blocks beside other ranks come
   !> first, so that the halo travels while the inner ones are worked on.
   subroutine map_to_grid(m)
      type(model_t), intent(inout) :: m
      integer :: i

      if (m%mapped) then
         m%mapped = .false.
         return
      end if
      call start_stage(m%clock, stage_p2g)
      m%tally = tally_t()
      call clear_rows(m%grid)
      do i = 1, size(m%loads)
         call apply_load(m%loads(i), m%particles, m%kernels, m%sided, m%time, m%grid)
      end do
      if (associated(m%further_force)) call add_further_force(m)
      call particles_to_grid(m%particles, m%bodies, m%kernels, m%sided, 1, m%grid%blocks%n_edge, &
         m%grid)
      call start_sum(m%halo, m%comm, m%grid%node, 1, 7)
      call particles_to_grid(m%particles, m%bodies, m%kernels, m%sided, m%grid%blocks%n_edge + 1, &
         m%grid%blocks%n, m%grid)
      call stop_stage(m%clock, stage_p2g)
      call start_stage(m%clock, stage_halo)
      call finish_sum(m%halo, m%grid%node, 1, 7)
      call stop_stage(m%clock, stage_halo)
      if (m%bodies_meet) call measure_contact(m)
   end subroutine map_to_grid

   !> Body force that the caller of the library gives; its work is not in the ledger.
   subroutine add_further_force(m)
      type(model_t), intent(inout) :: m
      real(wp) :: force(lanes, 3)
      integer :: c, i

      do c = 1, m%particles%n_chunks
         if (m%particles%count(c) == 0) cycle
         call m%further_force(m%time, m%particles%x0(:, :, c), force)
         do i = 1, 3
            force(:, i) = force(:, i)*m%particles%q(:, c_m, c)
         end do
         call push_chunk(m%particles, c, m%bodies%half(m%particles%body(c)), m%kernels, m%sided, &
            force, m%grid)
      end do
   end subroutine add_further_force

   !> Nodal velocities after the step (eq. 4, 29) with damping and conditions; the energies that
   !> nodes see; and the share of PIC or XPIC in what particles will get.
   subroutine advance_nodes(m, dt)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: dt   !! from v(n-1/2) to v(n+1/2) [time]
      real(wp) :: body_force(3), rate, eta
      integer :: i

      call start_stage(m%clock, stage_grid)
      body_force = body_force_of(m)
      rate = damping_of(m)
      call advance_momentum(m%grid, dt, body_force, rate)
      do i = 1, size(m%boundaries)
         call set_velocity(m, i, dt)
         if (m%boundaries(i)%region == region_set) call rows_around_set(m, i)
      end do
      if (m%bodies_meet) call meet_bodies(m, f_velocity)
      do i = 1, size(m%boundaries)
         call apply_boundary(m%boundaries(i), m%grid, dt, .false.)
      end do
      if (m%options%sharp) call sharpen_change(m, dt)
      do i = 1, size(m%loads)
         m%loads(i)%work = m%loads(i)%work + 0.5_wp*dt*(power(m, i, 2) - power(m, i, 5))
      end do
      call add_nodal_work(m%grid, dt, body_force, rate, m%nodal_work)
      if (m%relaxing) m%force = force_out_of_balance(m%grid)/dt
      eta = pic_share(m)
      if (loses(m)) then
         call note_flip(m%particles, m%bodies%half, m%kernels, m%sided, m%grid, m%flip)
         m%impulses = impulse_energy(m%grid)
      end if
      if (eta > 0) call blend(m, eta)
      call stop_stage(m%clock, stage_grid)
   end subroutine advance_nodes

   !> The share of PIC or XPIC in the change of velocity, and what it takes from what nodes see.
   subroutine blend(m, eta)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: eta   !! share of the nodal velocity
      real(wp), allocatable :: change(:, :)

      if (wants_seen_loss(m)) change = m%grid%node(5:7, :)
      if (m%options%xpic) call smooth(m, f_velocity)
      call blend_change(m%grid, eta, m%options%xpic)
      if (.not. allocated(change)) return
      m%seen_loss = m%seen_loss + look_interval*seen_loss(m, eta, change)
   end subroutine blend

   !> All body forces of now.
   pure function body_force_of(m) result(force)
      type(model_t), intent(in) :: m
      real(wp) :: force(3)   !! [length/time^2]
      integer :: i

      force = 0
      do i = 1, size(m%gravity)
         force = force + curve_value(m%gravity(i)%curve, m%time)*m%gravity(i)%acceleration
      end do
   end function body_force_of

   !> Rate of nodal damping of now.
   pure function damping_of(m) result(rate)
      type(model_t), intent(in) :: m
      real(wp) :: rate   !! [1/time]

      rate = 0
      if (m%time < m%options%damped_until) rate = m%options%viscous
   end function damping_of

   !> Corrected inertia: the change of velocity gets back half of what a step's transfers and lumped
   !> masses slow.
   subroutine sharpen_change(m, dt)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: dt   !! [time]
      integer :: i

      call smooth(m, f_change)
      call sharpen_rows(m%grid, carry=.true.)
      if (m%bodies_meet) call meet_bodies(m, f_velocity)
      do i = 1, size(m%boundaries)
         call apply_boundary(m%boundaries(i), m%grid, dt, .true.)
      end do
   end subroutine sharpen_change

   !> Corrected inertia: the velocity that strains gets back the other half.
   subroutine sharpen_velocity(m)
      type(model_t), intent(inout) :: m
      integer :: i

      call smooth(m, f_change)
      call sharpen_rows(m%grid, carry=.false.)
      do i = 1, size(m%boundaries)
         call hold_boundary(m%boundaries(i), m%grid, 5)
      end do
      if (m%bodies_meet) call meet_bodies(m, f_change)
   end subroutine sharpen_velocity

   !> Power of a load with the velocity in three fields of the rows.
   function power(m, i, field)
      type(model_t), intent(in) :: m
      integer, intent(in) :: i, field
      real(wp) :: power   !! of this rank [energy/time]

      power = power_of_load(m%loads(i), m%particles, m%kernels, m%sided, m%time, m%grid, field)
   end function power

   !> Second half of the work of loads, with the velocity of fields 5:7 that strains the particles.
   subroutine finish_work(m, dt)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: dt   !! from v(n-1/2) to v(n+1/2) [time]
      integer :: i

      call start_stage(m%clock, stage_grid)
      do i = 1, size(m%loads)
         m%loads(i)%work = m%loads(i)%work + 0.5_wp*dt*power(m, i, 5)
      end do
      call stop_stage(m%clock, stage_grid)
   end subroutine finish_work

   !> Share of the nodal velocity in the particles' new one: 1 for XPIC, pic dt otherwise.
   pure function pic_share(m) result(eta)
      type(model_t), intent(in) :: m
      real(wp) :: eta

      eta = 0
      if (m%options%xpic) eta = 1
      if (m%options%pic > 0 .and. m%time < m%options%damped_until) then
         eta = min(1.0_wp, m%options%pic*m%dt)
      end if
   end function pic_share

   !> Whether the transfers of this step lose energy that has to be measured.
   pure function loses(m)
      type(model_t), intent(in) :: m
      logical :: loses

      loses = pic_share(m) > 0 .or. m%options%strain_by_nodes
   end function loses

   !> Velocity that a condition prescribes at the end of the velocity step.
   subroutine set_velocity(m, i, dt)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: i
      real(wp), intent(in) :: dt
      real(wp) :: factor

      associate (b => m%boundaries(i))
         factor = curve_value(m%boundary_curves(i), m%time)
         if (b%accelerates) then
            b%velocity = b%velocity + dt*factor*b%value
         else
            b%velocity = curve_value(m%boundary_curves(i), m%time + 0.5_wp*m%dt)*b%value
         end if
      end associate
   end subroutine set_velocity

   !> Rows of the nodes around the particles of a condition's set, where they are now.
   subroutine rows_around_set(m, i)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: i
      logical, allocatable :: near(:)
      integer :: c, k, offsets(m%grid%lattice%reach**3)

      offsets = stencil_offsets(m%grid%lattice)
      allocate (near(m%grid%n_rows), source=.false.)
      do c = 1, m%particles%n_chunks
         if (m%particles%count(c) == 0) cycle
         if (.not. btest(m%particles%any_set(c), m%boundaries(i)%set)) cycle
         near(rows_of_bin(m%grid, m%particles%bin(c), offsets)) = .true.
      end do
      do k = m%grid%n_plain + 1, m%grid%n_rows
         near(k) = near(m%grid%parent(k - m%grid%n_plain))
      end do
      m%boundaries(i)%rows = pack([(k, k=1, m%grid%n_rows)], near)
   end subroutine rows_around_set

   !> Particle velocities (eq. 43); with `remap` also MUSL's second map, whose velocity then stands
   !> in fields 5:7.
   subroutine map_to_particles(m, remap)
      type(model_t), intent(inout) :: m
      logical, intent(in) :: remap   !! whether the second map is wanted
      real(wp) :: keep
      integer :: i

      call start_stage(m%clock, stage_g2p)
      keep = 1 - pic_share(m)
      associate (edge => m%grid%blocks%n_edge)
         call update_velocity(m%particles, m%bodies, m%kernels, m%sided, 1, edge, keep, remap, &
            m%grid, m%tally)
         if (remap) call start_sum(m%halo, m%comm, m%grid%second, 1, 3)
         call update_velocity(m%particles, m%bodies, m%kernels, m%sided, edge + 1, &
            m%grid%blocks%n, keep, remap, m%grid, m%tally)
      end associate
      if (loses(m)) m%transfer_loss = m%transfer_loss &
         + loss_of_transfer(m%particles, m%flip, m%options%strain_by_nodes, m%impulses)
      call stop_stage(m%clock, stage_g2p)
      if (.not. remap) return
      call start_stage(m%clock, stage_halo)
      call finish_sum(m%halo, m%grid%second, 1, 3)
      call stop_stage(m%clock, stage_halo)
      call start_stage(m%clock, stage_grid)
      call velocity_from_second(m%grid)
      do i = 1, size(m%boundaries)
         call hold_boundary(m%boundaries(i), m%grid, 5)
      end do
      if (m%bodies_meet) call meet_again(m)
      if (m%options%sharp) call sharpen_velocity(m)
      call stop_stage(m%clock, stage_grid)
   end subroutine map_to_particles

   !> Take the new nodal velocity itself for the strain increment (USL).
   subroutine new_velocity_for_strain(m)
      type(model_t), intent(inout) :: m

      call change_from_velocity(m%grid, .false.)
   end subroutine new_velocity_for_strain

   !> Stress and volume from fields 5:7 (eq. 45, 46), positions from fields 2:4 (eq. 44).
   subroutine strain_particles(m, dt)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: dt   !! [time]

      call start_stage(m%clock, stage_stress)
      call fit_movers(m)
      call update_stress(m%particles, m%bodies, m%kernels, m%sided, m%grid, dt, dt, m%tally, &
         m%movers, m%n_movers)
      call stop_stage(m%clock, stage_stress)
   end subroutine strain_particles

   !> USF: stress from the velocity that the particles brought, before the forces are taken.
   subroutine strain_before(m, dt)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: dt   !! [time]
      integer :: i

      call map_to_grid(m)
      call start_stage(m%clock, stage_stress)
      call change_from_velocity(m%grid, .true.)
      do i = 1, size(m%boundaries)
         if (m%boundaries(i)%region == region_set) call rows_around_set(m, i)
         call hold_boundary(m%boundaries(i), m%grid, 5)
      end do
      if (m%bodies_meet) call meet_straining(m)
      if (m%options%sharp) call sharpen_velocity(m)
      call fit_movers(m)
      call update_stress(m%particles, m%bodies, m%kernels, m%sided, m%grid, dt, 0.0_wp, m%tally, &
         m%movers, m%n_movers)
      m%ledger%strain(2) = m%ledger%strain(2) + m%tally%work
      call stop_stage(m%clock, stage_stress)
   end subroutine strain_before

   !> USF: positions from the new nodal velocity.
   subroutine move_particles(m, dt)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: dt   !! [time]

      call start_stage(m%clock, stage_stress)
      call fit_movers(m)
      call advance_positions(m%particles, m%bodies, m%kernels, m%sided, m%grid, dt, m%tally, &
         m%movers, m%n_movers)
      call stop_stage(m%clock, stage_stress)
   end subroutine move_particles

   !> Room for every chunk in the list of movers.
   subroutine fit_movers(m)
      type(model_t), intent(inout) :: m

      m%n_movers = 0
      if (allocated(m%movers)) then
         if (size(m%movers) >= m%particles%n_chunks) return
         deallocate (m%movers)
      end if
      allocate (m%movers(m%particles%n_chunks + m%particles%n_chunks/8 + 64))
   end subroutine fit_movers

   !> J and stress intensity factors of now at the fronts that the deck asks for. What is mapped to
   !> the grid for them serves the next step as well.
   subroutine measure_fronts(m)
      type(model_t), intent(inout) :: m
      real(wp), allocatable :: speed(:), force(:, :), node(:, :)
      integer :: i, k

      call map_to_grid(m)
      m%mapped = .true.
      call start_stage(m%clock, stage_fracture)
      if (faces_meet(m)) then
         call find_face_forces(m, body_force_of(m), damping_of(m), force)
         node = m%grid%node
      end if
      do i = 1, size(m%fracture%cracks)
         if (allocated(node)) call part_faces(m, m%fracture%cracks(i), force)
         allocate (speed(m%cracks(m%fracture%cracks(i))%front%node_count), source=0.0_wp)
         if (allocated(m%growth)) then
            do k = 1, size(m%growth)
               if (m%growth(k)%crack == m%fracture%cracks(i)) speed = m%growth(k)%speed
            end do
         end if
         call measure_front(m%fracture, i, m%cracks, m%comm, m%halo, m%grid, m%particles, &
            m%bodies, m%kernels, m%sided, m%loads, m%time, speed)
         call flag_conditions(m%boundaries, m%comm, m%grid, m%fracture%values(i))
         if (allocated(node)) m%grid%node = node
         deallocate (speed)
      end do
      call stop_stage(m%clock, stage_fracture)
   end subroutine measure_fronts

   !> Move the faces of the cracks with the velocity of fields 5:7.
   subroutine advance_cracks(m, dt)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: dt   !! [time]
      integer :: i

      if (size(m%cracks) == 0) return
      call start_stage(m%clock, stage_crack)
      do i = 1, size(m%cracks)
         call advance_crack(m%cracks(i), i, m%grid, m%sided, dt)
      end do
      call stop_stage(m%clock, stage_crack)
   end subroutine advance_cracks
end module xmpm_stages
