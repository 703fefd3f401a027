!> Bodies from the deck: laws, particles from primitives or files, and their distribution.
module xmpm_setup_bodies
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t
   use xmpm_text, only: lower
   use xmpm_sort, only: sort_order
   use xmpm_hash_map, only: hash_map_t, clear_map, set_value, value_of
   use xmpm_communicator, only: gather_all, agree_on_error
   use xmpm_partition, only: partition_blocks
   use xmpm_deck, only: deck_t, block_t, count_blocks, find_block, block_named, has, given, &
      real_of, reals_of, integer_of, text_of, complain
   use xmpm_lattice, only: lattice_t, block_of, bin_of, block_key, key_place, block_width
   use xmpm_law, only: law_t
   use xmpm_elastic, only: new_elastic
   use xmpm_geometry, only: geometry_t, add_primitive
   use xmpm_body_fill, only: sub_lattice_t, fill_bins, cell_range
   use xmpm_particle_file, only: particle_data_t, particle_units_t, read_particles
   use xmpm_storage, only: record_t, new_record, clear_particles, c_v, c_s
   use xmpm_migration, only: put_into_outbox, insert_record, insert_own, exchange
   use xmpm_layout, only: lay_out, other_ranks
   use xmpm_model, only: model_t
   implicit none
   private

   public :: set_up_materials, set_up_bodies, body_plan_t

   !> How the particles of one body come to be.
   type :: body_plan_t
      type(geometry_t) :: geometry            !! shapes, where there is no file
      type(sub_lattice_t) :: sub_lattice      !! where its particles stand
      type(particle_data_t) :: data           !! this rank's part of a file
      logical :: from_file = .false.
      real(wp) :: spacing = 0                 !! between particles [length]
      real(wp) :: density = 0                 !! [mass/length^3]
      real(wp) :: velocity(3) = 0             !! [length/time]
      real(wp) :: spin(3) = 0, centre(3) = 0  !! angular velocity [1/time] and what it is about
      real(wp) :: stress(6) = 0               !! xx yy zz xy yz xz
      integer(i8) :: first_id = 0             !! of its particles, less one
      integer(i8), allocatable :: keys(:)     !! blocks of all ranks, ascending
      integer(i8), allocatable :: counts(:)   !! particles of each
   end type body_plan_t

contains

   !> Constitutive laws and which body has which.
   subroutine set_up_materials(m, deck)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(in) :: deck
      type(block_t) :: block
      integer :: i, n

      n = count_blocks(deck, 'material')
      allocate (m%bodies%laws(n))
      do i = 1, n
         block = find_block(deck, 'material', i)
         allocate (m%bodies%laws(i)%law, source=new_elastic(block%name, &
            real_of(block, 'density'), real_of(block, 'young'), real_of(block, 'poisson')))
      end do
      n = count_blocks(deck, 'body')
      allocate (m%bodies%law_of(n), m%bodies%half(n))
      do i = 1, n
         block = find_block(deck, 'body', i)
         m%bodies%law_of(i) = block_named(deck, 'material', text_of(block, 'material'))
         m%bodies%half(i) = 0.5_wp/real(integer_of(block, 'particles'), wp)
      end do
   end subroutine set_up_materials

   !> Particles of all bodies, on the ranks that METIS gives them. Collective.
   subroutine set_up_bodies(m, deck, plans, error)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(inout) :: deck
      type(body_plan_t), allocatable, intent(out) :: plans(:)
      type(error_t), allocatable, intent(out) :: error
      integer(i8), allocatable :: keys(:)
      integer, allocatable :: parts(:)
      integer :: i

      allocate (plans(count_blocks(deck, 'body')))
      do i = 1, size(plans)
         call plan_body(m, deck, i, plans(i), error)
         call agree_on_error(m%comm, error)
         if (allocated(error)) return
      end do
      do i = 1, size(plans)
         if (i > 1) plans(i)%first_id = plans(i - 1)%first_id + particles_of(plans(i - 1))
         call count_body(m, plans(i))
      end do
      call share_blocks(m, plans, keys, parts, error)
      call agree_on_error(m%comm, error)
      if (allocated(error)) return
      call lay_out(m, pack(keys, parts == m%comm%rank))
      call clear_particles(m%particles, m%grid%blocks%n, &
         expected(plans, keys, parts, m%comm%rank), &
         merge(3, 0, size(m%cracks) > 0), count_blocks(deck, 'fracture') > 0)
      do i = 1, size(plans)
         call fill_body(m, i, plans(i))
      end do
   end subroutine set_up_bodies

   !> Read one *BODY block.
   subroutine plan_body(m, deck, i, plan, error)
      type(model_t), intent(in) :: m
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: i
      type(body_plan_t), intent(out) :: plan
      type(error_t), allocatable, intent(out) :: error
      type(block_t) :: block, units
      character(len=:), allocatable :: part

      block = find_block(deck, 'body', i)
      plan%density = m%bodies%laws(m%bodies%law_of(i))%law%density
      plan%velocity = reals_of(block, 'velocity')
      plan%spin = reals_of(block, 'spin')
      plan%centre = reals_of(block, 'spin_centre')
      plan%stress = reals_of(block, 'stress')
      plan%spacing = m%grid%lattice%size/real(integer_of(block, 'particles'), wp)
      plan%sub_lattice = sub_lattice_t(m%grid%lattice%origin, m%grid%lattice%size, &
         integer_of(block, 'particles'))
      plan%from_file = has(block, 'file')
      if (plan%from_file) then
         part = ''
         if (has(block, 'part')) part = text_of(block, 'part')
         units = find_block(deck, 'units', 1)
         call read_particles(text_of(block, 'file'), part, &
            particle_units_t(text_of(units, 'length'), &
            text_of(units, 'time')), m%comm, plan%data, error)
      else
         call read_primitives(deck, block, plan%geometry)
      end if
   end subroutine plan_body

   !> The shapes of a body in written order.
   subroutine read_primitives(deck, block, geometry)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(geometry_t), intent(inout) :: geometry
      type(error_t), allocatable :: failure
      character(len=32) :: kind
      integer :: e
      logical :: subtract

      do e = 1, size(block%entries)
         kind = lower(block%entries(e)%key)
         subtract = index(kind, 'without_') == 1
         if (subtract) kind = kind(9:)
         if (all(kind /= [character(len=8) :: 'box', 'cylinder', 'tube', 'sphere'])) cycle
         if (.not. block%entries(e)%given) cycle
         call add_primitive(geometry, trim(kind), block%entries(e)%numbers, subtract, failure)
         if (allocated(failure)) call complain(deck, block, block%entries(e)%key, failure%message)
      end do
   end subroutine read_primitives

   !> Ids that a body takes up.
   function particles_of(plan) result(n)
      type(body_plan_t), intent(in) :: plan
      integer(i8) :: n

      n = plan%data%total
      if (.not. plan%from_file) n = sum(plan%counts)
   end function particles_of

   !> Count the particles of a body in each block; the ranks share the work. Collective.
   subroutine count_body(m, plan)
      type(model_t), intent(in) :: m
      type(body_plan_t), intent(inout) :: plan
      type(hash_map_t) :: map
      integer(i8), allocatable :: pairs(:), all(:)
      integer :: i, n, total
      integer, allocatable :: order(:)

      call clear_map(map, 64)
      if (plan%from_file) then
         do i = 1, size(plan%data%x, 2)
            call count_place(m%grid%lattice, plan%data%x(:, i), map)
         end do
      else
         call count_shapes(m, plan, map)
      end if
      allocate (pairs(2*map%count))
      n = 0
      do i = 0, size(map%keys) - 1
         if (map%values(i) == 0) cycle
         pairs(2*n + 1) = map%keys(i)
         pairs(2*n + 2) = int(map%values(i), i8)
         n = n + 1
      end do
      call gather_all(m%comm, pairs, all)
      order = sort_order(all(1::2))
      allocate (plan%keys(size(order)), plan%counts(size(order)))
      total = 0
      do i = 1, size(order)
         if (total > 0) then
            if (plan%keys(total) == all(2*order(i) - 1)) then
               plan%counts(total) = plan%counts(total) + all(2*order(i))
               cycle
            end if
         end if
         total = total + 1
         plan%keys(total) = all(2*order(i) - 1)
         plan%counts(total) = all(2*order(i))
      end do
      plan%keys = plan%keys(:total)
      plan%counts = plan%counts(:total)
   end subroutine count_body

   !> Count the particles of a body of shapes; every rank takes some of the blocks.
   subroutine count_shapes(m, plan, map)
      type(model_t), intent(in) :: m
      type(body_plan_t), intent(in) :: plan
      type(hash_map_t), intent(inout) :: map
      integer :: low(3), high(3), ix, iy, iz, n, i, cell(3)
      real(wp), allocatable :: x(:, :), volume(:)

      call cell_range(plan%geometry, plan%sub_lattice, low, high)
      low = block_of(low)
      high = block_of(high)
      n = 0
      do iz = low(3), high(3)
         do iy = low(2), high(2)
            do ix = low(1), high(1)
               n = n + 1
               if (mod(n, m%comm%size) /= m%comm%rank) cycle
               cell = block_width*[ix, iy, iz]
               call fill_bins(plan%geometry, plan%sub_lattice, cell, cell + block_width - 1, x, &
                  volume)
               do i = 1, size(volume)
                  call count_place(m%grid%lattice, x(:, i), map)
               end do
            end do
         end do
      end do
   end subroutine count_shapes

   subroutine count_place(lattice, x, map)
      type(lattice_t), intent(in) :: lattice
      real(wp), intent(in) :: x(3)
      type(hash_map_t), intent(inout) :: map
      integer(i8) :: key

      key = block_key(block_of(bin_of(lattice, x)))
      call set_value(map, key, value_of(map, key, 0) + 1)
   end subroutine count_place

   !> All blocks and the rank of each. Collective.
   subroutine share_blocks(m, plans, keys, parts, error)
      type(model_t), intent(in) :: m
      type(body_plan_t), intent(in) :: plans(:)
      integer(i8), allocatable, intent(out) :: keys(:)
      integer, allocatable, intent(out) :: parts(:)
      type(error_t), allocatable, intent(out) :: error
      type(hash_map_t) :: map
      integer, allocatable :: weights(:), order(:)
      integer :: i, k, n

      call clear_map(map, 64)
      do i = 1, size(plans)
         do k = 1, size(plans(i)%keys)
            call set_value(map, plans(i)%keys(k), value_of(map, plans(i)%keys(k), 0) &
               + int(plans(i)%counts(k)))
         end do
      end do
      allocate (keys(map%count), weights(map%count))
      n = 0
      do i = 0, size(map%keys) - 1
         if (map%values(i) == 0) cycle
         n = n + 1
         keys(n) = map%keys(i)
         weights(n) = map%values(i)
      end do
      order = sort_order(keys)
      keys = keys(order)
      weights = weights(order)
      call partition_blocks(keys, weights, m%comm%size, [(-1, i=1, n)], parts, error)
   end subroutine share_blocks

   !> Particles that this rank will hold.
   function expected(plans, keys, parts, rank) result(n)
      type(body_plan_t), intent(in) :: plans(:)
      integer(i8), intent(in) :: keys(:)
      integer, intent(in) :: parts(:), rank
      integer :: n, i, k
      type(hash_map_t) :: map

      call clear_map(map, size(keys))
      do i = 1, size(keys)
         call set_value(map, keys(i), parts(i))
      end do
      n = 0
      do i = 1, size(plans)
         do k = 1, size(plans(i)%keys)
            if (value_of(map, plans(i)%keys(k), -1) == rank) n = n + int(plans(i)%counts(k))
         end do
      end do
   end function expected

   !> Make the particles of one body that are in this rank's blocks. Collective for files.
   subroutine fill_body(m, number, plan)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: number
      type(body_plan_t), intent(in) :: plan
      type(record_t) :: record
      integer(i8) :: id
      integer :: i, k, lost

      if (plan%from_file) then
         do i = 1, size(plan%data%x, 2)
            record = new_record(plan%first_id + plan%data%place(i) + 1, number, plan%data%x(:, i), &
               plan%density*plan%data%volume(i), plan%data%volume(i))
            if (size(plan%data%velocity) > 0) record%hot(c_v:c_v + 2) = plan%data%velocity(:, i)
            call start_motion(plan, record)
            call put_into_outbox(m%outbox, record)
         end do
         call insert_own(m%particles, m%grid, m%comm%rank, m%outbox)
         call exchange(m%particles, m%grid, m%comm, other_ranks(m), m%outbox, lost)
         return
      end if
      id = plan%first_id
      do k = 1, size(plan%keys)
         if (value_of(m%grid%blocks%find, plan%keys(k), 0) > 0) then
            call fill_block(m, number, plan, plan%keys(k), id)
         end if
         id = id + plan%counts(k)
      end do
   end subroutine fill_body

   !> Make the particles of one body in one block; ids count from `id`.
   subroutine fill_block(m, number, plan, key, id)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: number
      type(body_plan_t), intent(in) :: plan
      integer(i8), intent(in) :: key, id
      real(wp), allocatable :: x(:, :), volume(:)
      type(record_t) :: record
      integer :: i, n, place(3)

      place = key_place(key)
      call fill_bins(plan%geometry, plan%sub_lattice, &
         block_width*place + m%grid%lattice%low, block_width*place + block_width - 1, x, volume)
      n = 0
      do i = 1, size(volume)
         if (any(block_of(bin_of(m%grid%lattice, x(:, i))) /= place)) cycle
         n = n + 1
         record = new_record(id + int(n, i8), number, x(:, i), plan%density*volume(i), volume(i))
         call start_motion(plan, record)
         call insert_record(m%particles, m%grid, record)
      end do
   end subroutine fill_block

   !> Velocity and stress at the start; the deck's velocity adds to that of a file.
   pure subroutine start_motion(plan, record)
      type(body_plan_t), intent(in) :: plan
      type(record_t), intent(inout) :: record
      real(wp) :: r(3)

      r = record%x0 - plan%centre
      record%hot(c_v:c_v + 2) = record%hot(c_v:c_v + 2) + plan%velocity &
         + [plan%spin(2)*r(3) - plan%spin(3)*r(2), plan%spin(3)*r(1) - plan%spin(1)*r(3), &
         plan%spin(1)*r(2) - plan%spin(2)*r(1)]
      record%hot(c_s:c_s + 5) = plan%stress
   end subroutine start_motion
end module xmpm_setup_bodies
