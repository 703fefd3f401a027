!> The kinetic energy of a step is accounted for: work of forces with the mean velocity, and losses.
! ranks: 1 2 3
program test_transfer_loss
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, sum_all
   use xmpm_deck, only: deck_t
   use xmpm_lattice, only: bin_corner
   use xmpm_grid, only: clear_rows
   use xmpm_halo, only: start_sum, finish_sum
   use xmpm_loads, only: apply_load
   use xmpm_storage, only: bin_of_chunk, c_x, c_m, c_vol
   use xmpm_stages, only: map_to_grid, advance_nodes, map_to_particles, finish_work
   use xmpm_resolved, only: resolve_fields
   use xmpm_seen_loss, only: seen_loss
   use xmpm_model, only: model_t
   use small_model, only: make_model, seed
   use testing, only: suite_t, check, check_close, check_no_error, finish
   implicit none
   character(len=*), parameter :: block = '*JOB t|*UNITS length=mm mass=g time=ms|' &
      //'*MATERIAL alloy density=2 young=100 poisson=0.25|' &
      //'*BODY a material=alloy box=0.3 0.2 0.1 7.3 5.2 4.1 particles=2|' &
      //'*LOAD face=a:+x traction=30 20 10|'
   character(len=*), parameter :: crack = '*CRACK c rectangle centre=3.1 2.4 2.2 along=1 1 0 ' &
      //'across=0 0 1 width=4 depth=2.5|'
   real(wp), parameter :: rounding = 1e-13_wp   !! sums of some thousand terms, eps 2e-16, over the
                                                !! sum of their magnitudes
   real(wp), parameter :: dt = 0.02_wp
   type(comm_t) :: comm
   type(suite_t) :: suite

   call start_parallel(comm)
   suite%name = 'transfer_loss'
   call try_shape('linear')
   call try_shape('gimp')
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   subroutine try_shape(shape)
      character(len=*), intent(in) :: shape

      call test_step(shape//', FLIP', shape, '*TIME end=1|', 0.0_wp)
      call test_step(shape//', FLIP, crack', shape, crack//'*TIME end=1|', 0.0_wp)
      call test_step(shape//', PIC, crack', shape, crack//'*TIME end=1|*DAMPING pic=20|', 0.05_wp)
      call test_step(shape//', XPIC', shape, '*TIME end=1 transfer=xpic|', 0.05_wp)
      call test_step(shape//', XPIC, crack', shape, crack//'*TIME end=1 transfer=xpic|', 0.05_wp)
      call test_seen(shape//', PIC, crack', shape, crack//'*TIME end=1|*DAMPING pic=10|', 0.2_wp)
      call test_seen(shape//', XPIC, crack', shape, crack//'*TIME end=1 transfer=xpic|', 1.0_wp)
      call test_pulled(shape//', PIC, crack', shape, crack//'*TIME end=1|*DAMPING pic=10|', 0.2_wp)
      call test_pulled(shape//', XPIC, crack', shape, crack//'*TIME end=1 transfer=xpic|', 1.0_wp)
      call test_usl(shape//', USL', shape, crack//'*TIME end=1 scheme=usl|')
   end subroutine try_shape

   !> A small block, its particles put at random places of their bins with random masses,
   !> velocities and stresses.
   subroutine make_block(shape, rest, m)
      character(len=*), intent(in) :: shape, rest
      type(model_t), intent(out) :: m
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      real(wp) :: u(14)
      integer :: c, k

      call make_model(comm, block//'*GRID size=1 shape='//shape//'|'//rest, deck, m, error)
      call check_no_error(suite, 'the deck is set up', error)
      if (allocated(error)) error stop 'no model'
      call seed(77 + comm%rank)
      do c = 1, m%particles%n_chunks
         do k = 1, m%particles%count(c)
            call random_number(u)
            m%particles%q(k, :, c) = 10*(2*u - 1)
            m%particles%q(k, c_x:c_x + 2, c) = u(:3) &
               + bin_corner(m%grid%lattice, bin_of_chunk(m%particles, m%grid%blocks, c))
            m%particles%q(k, c_m:c_vol, c) = 0.2_wp + u(c_m:c_vol)
         end do
      end do
      m%dt = dt
   end subroutine make_block

   !> Kinetic energy of this rank's particles.
   function kinetic(m)
      type(model_t), intent(in) :: m
      real(wp) :: kinetic
      integer :: i

      kinetic = 0
      do i = 4, 6
         kinetic = kinetic + 0.5_wp*sum(m%particles%q(:, c_m, :m%particles%n_chunks) &
            *m%particles%q(:, i, :m%particles%n_chunks)**2)
      end do
   end function kinetic

   !> Sum of a.b over the rows that this rank counts.
   function dot_rows(m, a, b)
      type(model_t), intent(in) :: m
      real(wp), intent(in) :: a(:, :), b(:, :)   !! (3,rows)
      real(wp) :: dot_rows
      integer :: i

      dot_rows = 0
      do i = 1, m%grid%n_rows
         if (m%grid%mine(i)) dot_rows = dot_rows + dot_product(a(:, i), b(:, i))
      end do
   end function dot_rows

   !> Velocity of the rows from their momentum, before nodes are advanced.
   function velocity_of(m) result(v)
      type(model_t), intent(in) :: m
      real(wp) :: v(3, m%grid%n_rows)
      integer :: i

      v = 0
      do i = 1, m%grid%n_rows
         if (m%grid%node(1, i) > 0) v(:, i) = m%grid%node(2:4, i)/m%grid%node(1, i)
      end do
   end function velocity_of

   !> A step of MUSL: what the particles gain is the work of all nodal forces with the mean of the
   !> velocities before and after, less the loss; and so is the work of the load.
   subroutine test_step(head, shape, rest, least)
      character(len=*), intent(in) :: head, shape, rest
      real(wp), intent(in) :: least   !! part of the kinetic energy that must be lost; 0: nothing
      type(model_t) :: m
      real(wp), allocatable :: load(:, :), force(:, :), v(:, :)
      real(wp) :: sums(5)

      call make_block(shape, rest, m)
      call clear_rows(m%grid)
      call apply_load(m%loads(1), m%particles, m%kernels, m%sided, 0.0_wp, m%grid)
      call start_sum(m%halo, m%comm, m%grid%node, 1, 7)
      call finish_sum(m%halo, m%grid%node, 1, 7)
      load = m%grid%node(5:7, :m%grid%n_rows)
      call map_to_grid(m)
      force = m%grid%node(5:7, :m%grid%n_rows)
      v = velocity_of(m)
      sums(1) = kinetic(m)
      call advance_nodes(m, dt)
      call map_to_particles(m, remap=.true.)
      v = 0.5_wp*(v + m%grid%node(5:7, :m%grid%n_rows))
      call finish_work(m, dt)
      sums(2:) = [kinetic(m), m%transfer_loss, dt*dot_rows(m, force, v), &
         m%loads(1)%work - dt*dot_rows(m, load, v)]
      call sum_all(comm, sums)
      call check_close(suite, head//': gain and loss are the work of the forces', &
         (sums(2) - sums(1) + sums(3) - sums(4))/sums(1), 0.0_wp, rounding, 0.0_wp)
      call check_close(suite, head//': the load works with the mean velocity', sums(5)/sums(1), &
         0.0_wp, rounding, 0.0_wp)
      if (least > 0) then
         call check(suite, head//': random velocities lose much', sums(3) > least*sums(1))
      else
         call check(suite, head//': nothing is lost', .not. abs(sums(3)) > 0)
      end if
   end subroutine test_step

   !> What the transfer takes from the velocities that nodes see is what the kinetic energy of the
   !> resolved velocities loses, where no force acts.
   subroutine test_seen(head, shape, rest, eta)
      character(len=*), intent(in) :: head, shape, rest
      real(wp), intent(in) :: eta   !! share of the nodal velocity in a step
      type(model_t) :: m
      real(wp) :: sums(4), part

      call make_block(shape, rest, m)
      m%particles%q(:, 9:14, :) = 0
      m%particles%q(:, c_vol, :) = m%particles%q(:, c_m, :)   ! volumes weigh resolved fields
      call clear_rows(m%grid)
      deallocate (m%loads)
      allocate (m%loads(0))
      sums(1) = kinetic(m)
      sums(2) = resolved_energy(m)
      call map_to_grid(m)
      call advance_nodes(m, dt)
      part = seen_loss(m, eta, 0*m%grid%node(5:7, :))
      call map_to_particles(m, remap=.true.)
      sums(3:4) = [m%transfer_loss, part]
      sums(1) = sums(1) - kinetic(m) - sums(3)
      sums(2) = sums(2) - resolved_energy(m) - sums(4)
      call sum_all(comm, sums)
      call check_close(suite, head//': the loss is that of the particles', sums(1)/sums(3), &
         0.0_wp, 1e-11_wp, 0.0_wp)
      ! differences of sums some hundred times as large
      call check_close(suite, head//': the part that nodes see is that of what they resolve', &
         sums(2)/sums(4), 0.0_wp, 1e-10_wp, 0.0_wp)
      call check(suite, head//': nodes see a part of it', sums(4) > 0 .and. sums(4) < sums(3))
   end subroutine test_seen

   !> The same where forces act: what the transfer takes, d, works with the mean of old and new
   !> velocity, both as the grid resolves them.
   subroutine test_pulled(head, shape, rest, eta)
      character(len=*), intent(in) :: head, shape, rest
      real(wp), intent(in) :: eta   !! share of the nodal velocity in a step
      type(model_t) :: m
      real(wp), allocatable :: u(:, :), dv(:, :), v(:, :, :), d(:, :, :)
      real(wp) :: sums(3)
      integer, allocatable :: chunks(:)
      integer :: c, i

      call make_block(shape, rest, m)
      m%particles%q(:, c_vol, :) = m%particles%q(:, c_m, :)   ! volumes weigh resolved fields
      chunks = pack([(c, c=1, m%particles%n_chunks)], m%particles%count(:m%particles%n_chunks) > 0)
      call clear_rows(m%grid)
      call map_to_grid(m)
      u = velocity_of(m)
      v = m%particles%q(:, 4:6, chunks)
      call advance_nodes(m, dt)
      allocate (dv(3, size(m%grid%node, 2)), source=0.0_wp)
      dv(:, :m%grid%n_rows) = m%grid%node(2:4, :m%grid%n_rows) - u
      sums(1) = seen_loss(m, eta, dv)
      d = v + m%flip%change(:, :, chunks)
      call map_to_particles(m, remap=.true.)
      d = d - m%particles%q(:, 4:6, chunks)
      v = 0.5_wp*(v + m%particles%q(:, 4:6, chunks))
      call resolve(m, chunks, d)
      call resolve(m, chunks, v)
      sums(2:3) = 0
      do i = 1, 3
         sums(2) = sums(2) + sum(m%particles%q(:, c_m, chunks)*d(:, i, :)*v(:, i, :))
         sums(3) = sums(3) + sum(m%particles%q(:, c_m, chunks)*v(:, i, :)**2)
      end do
      call sum_all(comm, sums)
      ! over the energy, since with forces the loss may have either sign; sums as in test_seen
      call check_close(suite, head//', pulled: nodes lose what is taken from what they see', &
         (sums(1) - sums(2))/sums(3), 0.0_wp, 1e-12_wp, 0.0_wp)
      call check(suite, head//', pulled: it is not nothing', abs(sums(2)) > 1e-3_wp*sums(3))
   end subroutine test_pulled

   subroutine resolve(m, chunks, v)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: chunks(:)
      real(wp), intent(inout) :: v(:, :, :)   !! (8,3,chunks)

      call resolve_fields(chunks, m%comm, m%halo, m%grid, m%particles, m%bodies, m%kernels, &
         m%sided, v)
   end subroutine resolve

   !> Kinetic energy of the velocities that the grid resolves, of this rank. Collective.
   function resolved_energy(m) result(energy)
      type(model_t), intent(inout) :: m
      real(wp) :: energy
      real(wp), allocatable :: v(:, :, :)
      integer, allocatable :: chunks(:)
      integer :: c, i

      chunks = pack([(c, c=1, m%particles%n_chunks)], m%particles%count(:m%particles%n_chunks) > 0)
      v = m%particles%q(:, 4:6, chunks)
      call resolve(m, chunks, v)
      energy = 0
      do i = 1, 3
         energy = energy + 0.5_wp*sum(m%particles%q(:, c_m, chunks)*v(:, i, :)**2)
      end do
   end function resolved_energy

   !> A step of USL: the loss is that of the nodes' own velocity against the second map's.
   subroutine test_usl(head, shape, rest)
      character(len=*), intent(in) :: head, shape, rest
      type(model_t) :: m
      real(wp), allocatable :: v(:, :), impulse(:, :)
      real(wp) :: sums(2)
      integer :: i

      call make_block(shape, rest, m)
      call map_to_grid(m)
      v = velocity_of(m)
      call advance_nodes(m, dt)
      impulse = m%grid%node(2:4, :m%grid%n_rows) - v
      do i = 1, m%grid%n_rows
         impulse(:, i) = m%grid%node(1, i)*impulse(:, i)
      end do
      call map_to_particles(m, remap=.true.)
      sums = [m%transfer_loss, dot_rows(m, impulse, m%grid%node(2:4, :m%grid%n_rows) &
         - m%grid%node(5:7, :m%grid%n_rows))]
      call sum_all(comm, sums)
      call check_close(suite, head//': the loss is that of its velocity', sums(1), sums(2), &
         0.0_wp, 1e-11_wp)   ! differences of sums some ten times as large
      call check(suite, head//': it is a loss', sums(1) > 0)
   end subroutine test_usl
end program test_transfer_loss
