!> What the transfers between particles and nodes conserve, on any number of ranks.
! ranks: 1 2 3
program test_transfer
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_text, only: to_text
   use xmpm_vectors, only: cross
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, sum_all, max_all
   use xmpm_deck, only: deck_t
   use xmpm_lattice, only: bin_corner
   use xmpm_grid, only: node_position
   use xmpm_storage, only: bin_of_chunk, c_x, c_v, c_m, c_vol, c_s
   use xmpm_balance, only: momenta
   use xmpm_halo, only: start_sum, finish_sum
   use xmpm_loads, only: push_chunk
   use xmpm_stages, only: map_to_grid, advance_nodes, map_to_particles, strain_particles
   use xmpm_settle, only: settle, choose_step
   use xmpm_model, only: model_t
   use small_model, only: make_model, seed
   use testing, only: suite_t, check, check_close, check_no_error, finish
   implicit none
   character(len=*), parameter :: units = '*JOB t|*UNITS length=mm mass=g time=ms|'
   character(len=*), parameter :: block = '*MATERIAL alloy density=2 young=100 poisson=0.25|' &
      //'*BODY a material=alloy box=0.3 0.2 0.1 7.3 5.2 4.1 particles=2|'
   real(wp), parameter :: rounding = 1e-13_wp   !! sums of some thousand terms, eps 2e-16, over the
                                                !! sum of their magnitudes
   character(len=6), parameter :: shapes(2) = ['linear', 'gimp  ']
   type(comm_t) :: comm
   type(suite_t) :: suite
   integer :: i

   call start_parallel(comm)
   suite%name = 'transfer'
   do i = 1, 2
      call test_conservation('FLIP', '*TIME end=1|', trim(shapes(i)))
      call test_conservation('XPIC', '*TIME end=1 transfer=xpic|', trim(shapes(i)))
      call test_conservation('corrected', '*TIME end=1 inertia=corrected|', trim(shapes(i)))
      call test_rotation(trim(shapes(i)))
      call test_translation(trim(shapes(i)))
      call test_angular_drift(trim(shapes(i)))
   end do
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> A small block, its particles put at random places of their bins with random masses,
   !> velocities and stresses if asked for.
   subroutine make_block(shape, rest, random, m)
      character(len=*), intent(in) :: shape, rest
      logical, intent(in) :: random
      type(model_t), intent(out) :: m
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      real(wp) :: u(14)
      integer :: c, k

      call make_model(comm, units//'*GRID size=1 shape='//shape//'|'//block//rest, deck, m, error)
      call check_no_error(suite, 'the deck is set up', error)
      if (allocated(error)) error stop 'no model'
      call seed(77 + comm%rank)
      if (.not. random) return
      do c = 1, m%particles%n_chunks
         do k = 1, m%particles%count(c)
            call random_number(u)
            m%particles%q(k, :, c) = 2*u - 1
            m%particles%q(k, c_x:c_x + 2, c) = u(:3) &
               + bin_corner(m%grid%lattice, bin_of_chunk(m%particles, m%grid%blocks, c))
            m%particles%q(k, c_m:c_vol, c) = 0.2_wp + u(c_m:c_vol)
         end do
      end do
   end subroutine make_block

   !> Mass, momentum and angular momentum of the rows' fields 1 and 2:4; of values times mass if
   !> `velocity`, else of momenta.
   subroutine nodal_sums(m, values, velocity, mass, linear, angular)
      type(model_t), intent(in) :: m
      real(wp), intent(in) :: values(:, :)   !! (3,rows)
      logical, intent(in) :: velocity
      real(wp), intent(out) :: mass, linear(3), angular(3)
      real(wp) :: sums(7), p(3)
      integer :: i

      sums = 0
      do i = 1, m%grid%n_rows
         if (.not. m%grid%mine(i)) cycle
         p = values(:, i)
         if (velocity) p = m%grid%node(1, i)*values(:, i)
         sums = sums + [m%grid%node(1, i), p, cross(node_position(m%grid, i), p)]
      end do
      call sum_all(m%comm, sums)
      mass = sums(1)
      linear = sums(2:4)
      angular = sums(5:7)
   end subroutine nodal_sums

   !> Sums of particles' mass, of |m v| and of |x| |m v|.
   subroutine scales(m, mass, momentum, moment)
      type(model_t), intent(in) :: m
      real(wp), intent(out) :: mass, momentum, moment
      real(wp) :: sums(3), p
      integer :: c, k

      sums = 0
      do c = 1, m%particles%n_chunks
         do k = 1, m%particles%count(c)
            p = m%particles%q(k, c_m, c)*norm2(m%particles%q(k, c_v:c_v + 2, c))
            sums = sums + [m%particles%q(k, c_m, c), p, p*norm2(m%particles%q(k, c_x:c_x + 2, c))]
         end do
      end do
      call sum_all(m%comm, sums)
      mass = sums(1)
      momentum = sums(2)
      moment = sums(3)
   end subroutine scales

   !> One step, stage by stage.
   subroutine test_conservation(name, time, shape)
      character(len=*), intent(in) :: name, time, shape
      type(model_t) :: m
      real(wp) :: mass, m0, p0(3), l0(3), p(3), l(3), particle_mass, size_p, size_l, dt, torque(3)
      character(len=:), allocatable :: head

      head = shape//', '//name//': '
      call make_block(shape, time, .true., m)
      call scales(m, particle_mass, size_p, size_l)
      call momenta(m, p0, l0)
      dt = 0.02_wp
      m%dt = dt
      call map_to_grid(m)
      call nodal_sums(m, m%grid%node(2:4, :), .false., mass, p, l)
      m0 = mass
      call check_close(suite, head//'P2G keeps the mass', mass, particle_mass, 0.0_wp, rounding)
      call hold(head//'P2G keeps the linear momentum', p - p0, size_p)
      call hold(head//'P2G keeps the angular momentum', l - l0, size_l)
      call nodal_sums(m, m%grid%node(5:7, :), .false., mass, p, l)
      call hold(head//'internal forces add up to zero', p, largest_force(m))
      call hold(head//'internal forces have no moment', l, 10*largest_force(m))
      call advance_nodes(m, dt)
      call nodal_sums(m, m%grid%node(2:4, :), .true., mass, p, l)
      call hold(head//'the nodes keep the linear momentum', p - p0, size_p)
      if (name /= 'corrected') call hold(head//'the nodes keep the angular momentum', l - l0, &
         size_l)
      if (name == 'FLIP') torque = lost_torque(m)
      call map_to_particles(m, remap=.true.)
      call momenta(m, p, l)
      call hold(head//'G2P keeps the linear momentum', p - p0, size_p)
      if (name == 'FLIP') call hold(head//'G2P changes the angular momentum by the arms of '// &
         'the nodes', l - l0 - torque, size_l)
      if (comm%rank == 0) print '(3a,es9.2,a)', '   ', head, 'one G2P of random velocities ' &
         //'changes the angular momentum by', norm2(l - l0)/size_l, ' of sum |x| |m v|'
      call nodal_sums(m, m%grid%node(5:7, :), .true., mass, p, l)
      call hold(head//'the second map keeps the linear momentum', p - p0, size_p)
      call check_close(suite, head//'the mass stays', mass, m0, 0.0_wp, 0.0_wp)
   end subroutine test_conservation

   !> Sum over the nodes of (sum N m x - m_I x_I) cross the change of velocity in fields 5:7: what
   !> particles miss of the nodes' torque, since the mass of a node is not centred on it.
   function lost_torque(m) result(torque)
      type(model_t), intent(inout) :: m
      real(wp) :: torque(3), moment(8, 3)
      real(wp), allocatable :: change(:, :)
      integer :: c, i

      change = m%grid%node(5:7, :m%grid%n_rows)
      m%grid%node(5:7, :) = 0
      do c = 1, m%particles%n_chunks
         if (m%particles%count(c) == 0) cycle
         do i = 1, 3
            moment(:, i) = m%particles%q(:, c_m, c)*m%particles%q(:, c_x - 1 + i, c)
         end do
         call push_chunk(m%particles, c, m%bodies%half(m%particles%body(c)), m%kernels, &
            m%sided, moment, m%grid)
      end do
      call start_sum(m%halo, m%comm, m%grid%node, 5, 7)
      call finish_sum(m%halo, m%grid%node, 5, 7)
      torque = 0
      do i = 1, m%grid%n_rows
         if (m%grid%mine(i)) torque = torque + cross(m%grid%node(5:7, i) &
            - m%grid%node(1, i)*node_position(m%grid, i), change(:, i))
      end do
      m%grid%node(5:7, :m%grid%n_rows) = change
      call sum_all(m%comm, torque)
   end function lost_torque

   subroutine hold(sentence, difference, size)
      character(len=*), intent(in) :: sentence
      real(wp), intent(in) :: difference(3), size

      call check_close(suite, sentence, maxval(abs(difference))/size, 0.0_wp, rounding, 0.0_wp)
   end subroutine hold

   !> Sum of the magnitudes of the particles' forces.
   function largest_force(m) result(total)
      type(model_t), intent(in) :: m
      real(wp) :: total
      integer :: c, k

      total = 0
      do c = 1, m%particles%n_chunks
         do k = 1, m%particles%count(c)
            total = total + m%particles%q(k, c_vol, c)*norm2(m%particles%q(k, c_s:c_s + 5, c)) &
               /m%grid%lattice%size
         end do
      end do
      call sum_all(m%comm, total)
   end function largest_force

   !> Stress and volume after one update with the nodal velocity w x + v.
   subroutine strain(m, w, v, dt, stress, volume)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: w(3), v(3), dt
      real(wp), intent(out) :: stress, volume   !! largest stress, largest relative change of volume
      real(wp) :: worst(2), before
      integer :: i, c, k

      do i = 1, m%grid%n_rows
         m%grid%node(5:7, i) = cross(w, node_position(m%grid, i)) + v
         m%grid%node(2:4, i) = 0
      end do
      call strain_particles(m, dt)
      worst = 0
      do c = 1, m%particles%n_chunks
         do k = 1, m%particles%count(c)
            worst(1) = max(worst(1), maxval(abs(m%particles%q(k, c_s:c_s + 5, c))))
            before = m%particles%q(k, c_m, c)/m%bodies%laws(1)%law%density
            worst(2) = max(worst(2), abs(m%particles%q(k, c_vol, c)/before - 1))
         end do
      end do
      call max_all(m%comm, worst)
      stress = worst(1)
      volume = worst(2)
   end subroutine strain

   !> Stress of E eps |v|/h dt with |v| < 30 at the nodes: 100 2e-16 30 0.1 = 6e-14, some times
   !> over; a strain rate of even 1e-9 w would give 1e-8.
   subroutine test_rotation(shape)
      character(len=*), intent(in) :: shape
      type(model_t) :: m
      real(wp) :: stress, volume

      call make_block(shape, '*TIME end=1|', .false., m)
      call strain(m, [1.0_wp, -2.0_wp, 0.7_wp], [0.3_wp, 0.2_wp, 0.1_wp], 0.1_wp, stress, volume)
      call check_close(suite, shape//': a rotation at the nodes strains nothing', stress, 0.0_wp, &
         1e-12_wp, 0.0_wp)
      call check_close(suite, shape//': a rotation at the nodes keeps the volumes', volume, &
         0.0_wp, 1e-14_wp, 0.0_wp)
   end subroutine test_rotation

   subroutine test_translation(shape)
      character(len=*), intent(in) :: shape
      type(model_t) :: m
      real(wp) :: stress, volume

      call make_block(shape, '*TIME end=1|', .false., m)
      call strain(m, [0.0_wp, 0.0_wp, 0.0_wp], [3.0_wp, 2.0_wp, -1.0_wp], 0.1_wp, stress, volume)
      call check_close(suite, shape//': a translation at the nodes strains nothing', stress, &
         0.0_wp, 1e-13_wp, 0.0_wp)
   end subroutine test_translation

   !> A free cube spins: linear momentum stays to rounding, the angular momentum drifts, since
   !> particles take the nodes' change with the consistent mass while the nodes carry a lumped one.
   subroutine test_angular_drift(shape)
      character(len=*), intent(in) :: shape
      real(wp) :: coarse, fine

      call spin_cube(shape, '1', 100, coarse)
      call spin_cube(shape, '0.5', 200, fine)
      if (comm%rank == 0) print '(2a,2es10.2)', '   ', shape//': angular momentum is off after ' &
         //'0.24 rad, 4 and 8 cells across, by', coarse, fine
      ! The arms of surface nodes are wrong by a part of h, so the drift is of first order: half as
      ! much on half the cells, with room for terms of second order.
      call check(suite, shape//': the drift of the angular momentum falls with the cell size: ' &
         //to_text(coarse)//' to '//to_text(fine), fine < 0.6_wp*coarse)
   end subroutine test_angular_drift

   !> Spin a cube of 4 mm for some steps and take the relative change of its angular momentum.
   subroutine spin_cube(shape, h, steps, drift)
      character(len=*), intent(in) :: shape, h
      integer, intent(in) :: steps
      real(wp), intent(out) :: drift
      type(model_t) :: m
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      real(wp) :: p0(3), l0(3), p(3), l(3), mass, size_p, size_l
      integer :: step

      call make_model(comm, units//'*GRID shape='//shape//' size='//h//'|*TIME end=1000|' &
         //'*MATERIAL alloy density=2 young=100 poisson=0.25|' &
         //'*BODY b material=alloy box=0 0 0 4 4 4 particles=2 ' &
         //'spin=0.01 0.02 0.03 spin_centre=2 2 2|', deck, m, error)
      call check_no_error(suite, shape//': a spinning cube is set up', error)
      if (allocated(error)) return
      call momenta(m, p0, l0)
      call scales(m, mass, size_p, size_l)
      do step = 1, steps
         call choose_step(m, m%options%end_time, error)
         if (.not. allocated(error)) call m%take_step(m, m%dt)
         if (.not. allocated(error)) call settle(m, error)
         if (allocated(error)) exit
      end do
      call check_no_error(suite, shape//': a spinning cube runs', error)
      call momenta(m, p, l)
      call check_close(suite, shape//': all steps keep the linear momentum', &
         maxval(abs(p - p0))/size_p, 0.0_wp, real(steps, wp)*rounding, 0.0_wp)
      drift = norm2(l - l0)/norm2(l0)
   end subroutine spin_cube
end program test_transfer
