!> Sets, loads, body forces and conditions from the deck.
module xmpm_setup_conditions
   use xmpm_kinds, only: wp, i8
   use xmpm_text, only: string_t, to_text, lower
   use xmpm_error, only: error_t
   use xmpm_communicator, only: sum_all, gather_all
   use xmpm_deck, only: deck_t, block_t, count_blocks, find_block, block_named, has, real_of, &
      reals_of, text_of, texts_of, complain
   use xmpm_boundary, only: boundary_t, region_plane, region_box, region_set
   use xmpm_curves, only: curve_t, step_curve, make_ramp, make_table
   use xmpm_faces, only: find_face, sum_areas, scale_areas
   use xmpm_face_total, only: face_total
   use xmpm_particle_file, only: particle_set_t, particle_units_t, read_particle_set
   use xmpm_set_table, only: load_table_t, build, find
   use xmpm_storage, only: particles_t, c_x, c_vol
   use xmpm_setup_bodies, only: body_plan_t
   use xmpm_loads, only: load_t
   use xmpm_model, only: model_t
   implicit none
   private

   public :: set_up_conditions

   integer, parameter :: most_sets = 62   !! bits of a particle's sets

   !> Named sets as they get their bits.
   type :: sets_t
      integer :: n = 0                         !! bits in use
      type(string_t) :: names(0:most_sets)     !! name of each bit, blank for a face
      type(load_table_t) :: tables(0:most_sets)  !! particles and areas, of sets from files
   end type sets_t

contains

   !> Read *SET, *LOAD, *GRAVITY and *BOUNDARY. Problems go to the deck. Collective.
   subroutine set_up_conditions(m, deck, plans)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(inout) :: deck
      type(body_plan_t), intent(in) :: plans(:)
      type(sets_t), allocatable :: sets
      type(block_t) :: block
      integer :: i

      allocate (sets)
      do i = 1, count_blocks(deck, 'set')
         block = find_block(deck, 'set', i)
         call mark_box(m%particles, block_named(deck, 'body', text_of(block, 'body')), &
            reals_of(block, 'box'), new_bit(deck, block, block%name, sets))
      end do
      allocate (m%gravity(count_blocks(deck, 'gravity')))
      do i = 1, size(m%gravity)
         block = find_block(deck, 'gravity', i)
         m%gravity(i)%acceleration = reals_of(block, 'acceleration')
         call read_curve(deck, block, m%gravity(i)%curve)
      end do
      allocate (m%loads(count_blocks(deck, 'load')))
      do i = 1, size(m%loads)
         block = find_block(deck, 'load', i)
         call read_load(m, deck, block, plans, sets, m%loads(i))
      end do
      allocate (m%boundaries(count_blocks(deck, 'boundary')))
      allocate (m%boundary_curves(size(m%boundaries)))
      do i = 1, size(m%boundaries)
         block = find_block(deck, 'boundary', i)
         call read_boundary(m, deck, block, plans, sets, m%boundaries(i))
         call read_curve(deck, block, m%boundary_curves(i))
      end do
   end subroutine set_up_conditions

   !> A bit for a new set.
   function new_bit(deck, block, name, sets) result(bit)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      character(len=*), intent(in) :: name
      type(sets_t), intent(inout) :: sets
      integer :: bit

      bit = min(sets%n, most_sets)
      if (sets%n > most_sets) then
         call complain(deck, block, '', 'more than '//to_text(most_sets + 1)// &
            ' sets and loaded faces')
      end if
      sets%n = sets%n + 1
      sets%names(bit)%s = name
   end function new_bit

   !> Mark the particles of a body in a box.
   subroutine mark_box(p, body, box, bit)
      type(particles_t), intent(inout) :: p
      integer, intent(in) :: body, bit
      real(wp), intent(in) :: box(6)
      integer :: c, i

      do c = 1, p%n_chunks
         if (p%body(c) /= body) cycle
         do i = 1, p%count(c)
            if (any(p%q(i, c_x:c_x + 2, c) < box(:3)) .or. &
               any(p%q(i, c_x:c_x + 2, c) > box(4:))) cycle
            call mark(p, i, c, bit)
         end do
      end do
   end subroutine mark_box

   subroutine mark(p, lane, chunk, bit)
      type(particles_t), intent(inout) :: p
      integer, intent(in) :: lane, chunk, bit

      p%sets(lane, chunk) = ibset(p%sets(lane, chunk), bit)
      p%any_set(chunk) = ibset(p%any_set(chunk), bit)
   end subroutine mark

   !> Bit of the set that a block names: known already, or read from the particle file of a body.
   function bit_of_set(m, deck, block, plans, sets) result(bit)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(body_plan_t), intent(in) :: plans(:)
      type(sets_t), intent(inout) :: sets
      integer :: bit
      character(len=:), allocatable :: name

      name = text_of(block, 'set')
      do bit = 0, min(sets%n, most_sets + 1) - 1
         if (sets%names(bit)%s == name) return
      end do
      bit = new_bit(deck, block, name, sets)
      call read_file_sets(m, deck, block, plans, name, sets%tables(bit))
      call mark_table(m%particles, sets%tables(bit), bit)
   end function bit_of_set

   !> The particles of a set out of the files of all bodies; one file at least must have it.
   subroutine read_file_sets(m, deck, block, plans, name, table)
      type(model_t), intent(in) :: m
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(body_plan_t), intent(in) :: plans(:)
      character(len=*), intent(in) :: name
      type(load_table_t), intent(out) :: table
      type(particle_set_t) :: set, whole
      type(error_t), allocatable :: failure
      character(len=:), allocatable :: message
      integer :: i

      message = 'there is no *SET '//name
      allocate (whole%place(0), whole%area(3, 0), whole%offset(3, 0))
      do i = 1, size(plans)
         if (.not. plans(i)%from_file) cycle
         call read_file_set(m, deck, i, name, set, failure)
         if (allocated(failure)) then
            if (message /= '') message = failure%message
            cycle
         end if
         message = ''
         whole%place = [whole%place, set%place + plans(i)%first_id + 1]
         whole%area = beside(whole%area, set%area, size(set%place))
         whole%offset = beside(whole%offset, set%offset, size(set%place))
      end do
      call build(table, whole%place, whole%area, whole%offset)
      if (message /= '') call complain(deck, block, 'set', message)
   end subroutine read_file_sets

   !> Vectors side by side; `n` of zero where there is none behind.
   pure function beside(first, second, n) result(both)
      real(wp), intent(in) :: first(:, :), second(:, :)
      integer, intent(in) :: n
      real(wp) :: both(3, size(first, 2) + n)

      both = 0
      both(:, :size(first, 2)) = first
      if (size(second, 2) == n) both(:, size(first, 2) + 1:) = second
   end function beside

   !> Mark the particles of a table.
   subroutine mark_table(p, table, bit)
      type(particles_t), intent(inout) :: p
      type(load_table_t), intent(in) :: table
      integer, intent(in) :: bit
      integer :: c, i

      do c = 1, p%n_chunks
         do i = 1, p%count(c)
            if (find(table, p%id(i, c)) > 0) call mark(p, i, c, bit)
         end do
      end do
   end subroutine mark_table

   !> A set from the file of a body.
   subroutine read_file_set(m, deck, body, name, set, error)
      type(model_t), intent(in) :: m
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: body
      character(len=*), intent(in) :: name
      type(particle_set_t), intent(out) :: set
      type(error_t), allocatable, intent(out) :: error
      type(block_t) :: units, block

      units = find_block(deck, 'units', 1)
      block = find_block(deck, 'body', body)
      call read_particle_set(text_of(block, 'file'), name, particle_units_t( &
         text_of(units, 'length'), text_of(units, 'time')), m%comm, set, error)
   end subroutine read_file_set

   !> The factor over time that a block asks for.
   subroutine read_curve(deck, block, curve)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(curve_t), intent(out) :: curve
      type(error_t), allocatable :: failure
      type(block_t) :: table
      character(len=:), allocatable :: name
      real(wp) :: start

      name = text_of(block, 'curve')
      start = real_of(block, 'start')
      select case (lower(name))
      case ('step')
         curve = step_curve(start)
      case ('ramp')
         if (.not. has(block, 'rise')) return
         call make_ramp(curve, real_of(block, 'rise'), start, failure)
      case default
         if (block_named(deck, 'curve', name) == 0) return
         table = find_block(deck, 'curve', block_named(deck, 'curve', name))
         call make_table(curve, reals_of(table, 'table'), start, failure)
      end select
      if (allocated(failure)) call complain(deck, block, 'curve', failure%message)
   end subroutine read_curve

   !> One *LOAD.
   subroutine read_load(m, deck, block, plans, sets, load)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(body_plan_t), intent(in) :: plans(:)
      type(sets_t), intent(inout) :: sets
      type(load_t), intent(out) :: load
      character(len=:), allocatable :: face
      integer :: body, colon

      if (has(block, 'traction')) load%traction = reals_of(block, 'traction')
      if (has(block, 'pressure')) load%pressure = real_of(block, 'pressure')
      call read_curve(deck, block, load%curve)
      if (has(block, 'face')) then
         face = text_of(block, 'face')
         colon = index(face, ':', back=.true.)
         body = block_named(deck, 'body', face(:colon - 1))
         if (body == 0) return
         if (plans(body)%from_file) then
            call complain(deck, block, 'face', 'the body '//face(:colon - 1)// &
               ' comes from a particle file: load one of its sets with set = NAME')
            return
         end if
         load%set = new_bit(deck, block, ' ', sets)
         call load_face(m, deck, block, body, plans(body), face(colon + 1:), load)
      else
         load%set = bit_of_set(m, deck, block, plans, sets)
         call check_areas(deck, block, sets%tables(load%set), load)
         call load_layer(m, sets%tables(load%set), load)
      end if
   end subroutine read_load

   !> Area vectors of the particles at a face of a body of shapes. Collective.
   subroutine load_face(m, deck, block, body, plan, name, load)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      integer, intent(in) :: body
      type(body_plan_t), intent(in) :: plan
      character(len=*), intent(in) :: name
      type(load_t), intent(inout) :: load
      type(error_t), allocatable :: failure
      real(wp), allocatable :: x(:, :), volume(:), area(:, :), offset(:, :)
      integer, allocatable :: lane(:, :)
      real(wp) :: found(4)
      integer :: i

      call list_body(m%particles, body, lane, x, volume)
      allocate (area(3, size(volume)), offset(3, size(volume)))
      call find_face(plan%geometry, name, x, volume, plan%spacing, area, offset, failure)
      if (allocated(failure)) then
         call complain(deck, block, 'face', failure%message)
         return
      end if
      found = sum_areas(area)
      call sum_all(m%comm, found)
      if (.not. found(1) > 0) then
         call complain(deck, block, 'face', 'no particle of the body lies at its face '//name)
         return
      end if
      call scale_areas(area, found, face_total(plan%geometry, name))
      do i = 1, size(volume)
         if (any(abs(area(:, i)) > 0)) call mark(m%particles, lane(1, i), lane(2, i), load%set)
      end do
      call gather_table(m, lane, area, offset, load)
   end subroutine load_face

   !> Particles of a body on this rank, in storage order.
   subroutine list_body(p, body, lane, x, volume)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: body
      integer, allocatable, intent(out) :: lane(:, :)     !! (2,n) lane and chunk
      real(wp), allocatable, intent(out) :: x(:, :), volume(:)
      integer :: c, i, n

      n = sum(p%count(:p%n_chunks), mask=p%body(:p%n_chunks) == body)
      allocate (lane(2, n), x(3, n), volume(n))
      n = 0
      do c = 1, p%n_chunks
         if (p%body(c) /= body) cycle
         do i = 1, p%count(c)
            n = n + 1
            lane(:, n) = [i, c]
            x(:, n) = p%q(i, c_x:c_x + 2, c)
            volume(n) = p%q(i, c_vol, c)
         end do
      end do
   end subroutine list_body

   !> The same table of loaded particles on all ranks. Collective.
   subroutine gather_table(m, lane, area, offset, load)
      type(model_t), intent(in) :: m
      integer, intent(in) :: lane(:, :)
      real(wp), intent(in) :: area(:, :), offset(:, :)
      type(load_t), intent(inout) :: load
      integer(i8), allocatable :: mine(:), ids(:)
      real(wp), allocatable :: some(:, :), apart(:, :), all_areas(:, :), all_offsets(:, :)
      integer :: i, n

      allocate (mine(size(area, 2)), some(3, size(area, 2)), apart(3, size(area, 2)))
      n = 0
      do i = 1, size(area, 2)
         if (.not. any(abs(area(:, i)) > 0)) cycle
         n = n + 1
         mine(n) = m%particles%id(lane(1, i), lane(2, i))
         some(:, n) = area(:, i)
         apart(:, n) = offset(:, i)
      end do
      call gather_all(m%comm, mine(:n), ids)
      call gather_all(m%comm, some(:, :n), all_areas)
      call gather_all(m%comm, apart(:, :n), all_offsets)
      call build(load%table, ids, all_areas, all_offsets)
   end subroutine gather_table

   !> A pressure needs areas, for their normals.
   subroutine check_areas(deck, block, table, load)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(load_table_t), intent(in) :: table
      type(load_t), intent(in) :: load
      logical :: has_areas

      has_areas = .false.
      if (allocated(table%area)) has_areas = any(abs(table%area) > 0)
      if (has_areas .or. .not. abs(load%pressure) > 0) return
      call complain(deck, block, 'pressure', 'the set has no areas in the particle file, and '// &
         'so no normal: give a traction')
   end subroutine check_areas

   !> A set as a surface layer: areas of the file, or one particle's cross section along the
   !> traction. Collective.
   subroutine load_layer(m, table, load)
      type(model_t), intent(in) :: m
      type(load_table_t), intent(in) :: table
      type(load_t), intent(inout) :: load
      integer, allocatable :: lane(:, :)
      real(wp), allocatable :: area(:, :), offset(:, :)
      integer :: c, i, n, at

      n = 0
      allocate (lane(2, sum(m%particles%count(:m%particles%n_chunks))))
      allocate (area(3, size(lane, 2)), source=0.0_wp)
      allocate (offset(3, size(lane, 2)), source=0.0_wp)
      do c = 1, m%particles%n_chunks
         do i = 1, m%particles%count(c)
            if (.not. btest(m%particles%sets(i, c), load%set)) cycle
            n = n + 1
            lane(:, n) = [i, c]
            at = 0
            if (allocated(table%ids)) at = find(table, m%particles%id(i, c))
            if (at > 0) then
               area(:, n) = table%area(:, at)
               offset(:, n) = table%offset(:, at)
            end if
            if (.not. norm2(area(:, n)) > 0) then
               area(:, n) = m%particles%q(i, c_vol, c)**(2.0_wp/3)*load%traction &
                  /max(norm2(load%traction), tiny(1.0_wp))
            end if
         end do
      end do
      call gather_table(m, lane(:, :n), area(:, :n), offset(:, :n), load)
   end subroutine load_layer

   !> One *BOUNDARY.
   subroutine read_boundary(m, deck, block, plans, sets, boundary)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(body_plan_t), intent(in) :: plans(:)
      type(sets_t), intent(inout) :: sets
      type(boundary_t), intent(out) :: boundary
      real(wp), allocatable :: values(:)

      boundary%name = block%name
      if (has(block, 'plane')) then
         boundary%region = region_plane
         boundary%axis = index('xyz', lower(text_of(block, 'plane')))
         values = reals_of(block, 'plane')
         boundary%coordinate = values(size(values))
         call check_plane(m, deck, block, boundary)
      else if (has(block, 'box')) then
         values = reals_of(block, 'box')
         boundary%region = region_box
         boundary%low = values(:3)
         boundary%high = values(4:)
      else
         boundary%region = region_set
         boundary%set = bit_of_set(m, deck, block, plans, sets)
         allocate (boundary%rows(0))
      end if
      call read_holds(block, boundary)
   end subroutine read_boundary

   !> A plane must be one of grid nodes; the side without material is found. Collective.
   subroutine check_plane(m, deck, block, boundary)
      type(model_t), intent(in) :: m
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(boundary_t), intent(inout) :: boundary
      real(wp) :: place, side(2)
      integer :: c, i

      associate (l => m%grid%lattice)
         place = (boundary%coordinate - l%origin(boundary%axis))/l%size
         if (abs(place - anint(place)) > 1e-6_wp) then
            call complain(deck, block, 'plane', &
               'the plane is not one of grid nodes; the nearest is '// &
               to_text(l%origin(boundary%axis) + l%size*anint(place)))
         end if
      end associate
      side = 0
      do c = 1, m%particles%n_chunks
         do i = 1, m%particles%count(c)
            if (m%particles%q(i, boundary%axis, c) > boundary%coordinate) then
               side(2) = side(2) + m%particles%q(i, c_vol, c)
            else
               side(1) = side(1) + m%particles%q(i, c_vol, c)
            end if
         end do
      end do
      call sum_all(m%comm, side)
      boundary%outward = merge(-1.0_wp, 1.0_wp, side(2) >= side(1))
   end subroutine check_plane

   !> Components and values of a condition.
   subroutine read_holds(block, boundary)
      type(block_t), intent(in) :: block
      type(boundary_t), intent(inout) :: boundary
      character(len=:), allocatable :: kind

      kind = lower(text_of(block, 'type'))
      select case (kind)
      case ('fixed')
         boundary%holds = .true.
      case ('roller', 'symmetry')
         if (boundary%region == region_plane) then
            boundary%holds(boundary%axis) = .true.
         else
            boundary%holds = .true.   ! those that the deck names
         end if
      case default
         boundary%accelerates = kind == 'acceleration'
         boundary%holds = components_of(block)
         if (.not. has(block, 'value')) return
         boundary%value = merge(reals_of(block, 'value'), 0.0_wp, boundary%holds)
      end select
      if (has(block, 'components')) boundary%holds = boundary%holds .and. components_of(block)
   end subroutine read_holds

   !> Directions that the deck names; all where it names none.
   function components_of(block) result(holds)
      type(block_t), intent(in) :: block
      logical :: holds(3)
      type(string_t), allocatable :: words(:)
      integer :: i, d

      holds = .true.
      if (.not. has(block, 'components')) return
      holds = .false.
      words = texts_of(block, 'components')
      do i = 1, size(words)
         do d = 1, 3
            if (index(words(i)%s, 'xyz' (d:d)) > 0) holds(d) = .true.
         end do
      end do
   end function components_of
end module xmpm_setup_conditions
