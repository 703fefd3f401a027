!> Quantities that the deck wants over time: at a point, through a section, from a boundary.
module xmpm_probes
   use xmpm_kinds, only: wp, i8
   use xmpm_text, only: string_t, to_text, lower
   use xmpm_text_lists, only: append
   use xmpm_communicator, only: sum_all, min_all
   use xmpm_deck, only: deck_t, block_t, count_blocks, find_block, block_named, has, reals_of, &
      text_of, complain, unit_text
   use xmpm_storage, only: particles_t, c_x, c_v, c_s, c_vol
   use xmpm_model, only: model_t
   implicit none
   private

   public :: probe_t, read_probes, probe_values, probe_names, probe_units

   integer, parameter :: at_point = 1     !! of a particle
   integer, parameter :: at_section = 2   !! force through a plane
   integer, parameter :: at_boundary = 3  !! force of a boundary

   !> One probe.
   type :: probe_t
      character(len=:), allocatable :: name       !! from the deck
      character(len=:), allocatable :: quantity   !! displacement, velocity, stress or force
      integer :: kind = at_point                  !! what it looks at
      integer(i8) :: id = 0                       !! of the particle that is followed
      integer :: axis = 1                         !! normal of the section
      real(wp) :: coordinate = 0                  !! of the section [length]
      integer :: boundary = 0                     !! number of the boundary
   end type probe_t

contains

   !> Read *PROBE and find the particles to follow; problems go to the deck. Collective.
   subroutine read_probes(deck, m, probes)
      type(deck_t), intent(inout) :: deck
      type(model_t), intent(in) :: m                      !! with its particles and boundaries
      type(probe_t), allocatable, intent(out) :: probes(:)
      type(block_t) :: block
      real(wp), allocatable :: values(:)
      integer :: i

      allocate (probes(count_blocks(deck, 'probe')))
      do i = 1, size(probes)
         block = find_block(deck, 'probe', i)
         probes(i)%name = block%name
         probes(i)%quantity = 'force'
         if (has(block, 'point')) then
            probes(i)%quantity = text_of(block, 'quantity')
            call find_particle(deck, block, m, probes(i)%id)
         else if (has(block, 'section')) then
            values = reals_of(block, 'section')
            probes(i)%kind = at_section
            probes(i)%axis = index('xyz', lower(text_of(block, 'section')))
            probes(i)%coordinate = values(size(values))
         else
            probes(i)%kind = at_boundary
            probes(i)%boundary = block_named(deck, 'boundary', text_of(block, 'reaction'))
         end if
      end do
   end subroutine read_probes

   !> The particle nearest to a point, the one with the lowest number of several. Collective.
   subroutine find_particle(deck, block, m, id)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(model_t), intent(in) :: m
      integer(i8), intent(out) :: id
      real(wp) :: point(3), distance, least
      integer(i8) :: candidate

      point = reals_of(block, 'point')
      call nearest_here(m%particles, point, candidate, distance)
      least = distance
      call min_all(m%comm, least)
      id = huge(id)
      if (distance <= least) id = candidate
      call min_all(m%comm, id)
      if (least <= 1.5_wp*m%grid%lattice%size) return
      call complain(deck, block, 'point', 'there is no material here: the nearest particle is '// &
         to_text(least)//' away, more than one and a half cells')
   end subroutine find_particle

   !> The nearest particle of this rank.
   pure subroutine nearest_here(p, point, id, distance)
      type(particles_t), intent(in) :: p
      real(wp), intent(in) :: point(3)
      integer(i8), intent(out) :: id
      real(wp), intent(out) :: distance
      real(wp) :: d
      integer :: c, i

      id = huge(id)
      distance = huge(distance)
      do c = 1, p%n_chunks
         do i = 1, p%count(c)
            d = norm2(p%q(i, c_x:c_x + 2, c) - point)
            if (d > distance) cycle
            if (d < distance .or. p%id(i, c) < id) id = p%id(i, c)
            distance = d
         end do
      end do
   end subroutine nearest_here

   !> Names of the columns: the probe's name with _x _y _z, or _xx _yy _zz _xy _yz _xz for a stress.
   pure function probe_names(probes) result(names)
      type(probe_t), intent(in) :: probes(:)
      type(string_t), allocatable :: names(:)
      character(len=*), parameter :: tensor(6) = ['xx', 'yy', 'zz', 'xy', 'yz', 'xz']
      integer :: i, k

      allocate (names(0))
      do i = 1, size(probes)
         do k = 1, column_count(probes(i))
            if (column_count(probes(i)) == 6) then
               call append(names, in_header(probes(i)%name)//'_'//tensor(k))
            else
               call append(names, in_header(probes(i)%name)//'_'//'xyz' (k:k))
            end if
         end do
      end do
   end function probe_names

   !> Units of the columns.
   pure function probe_units(deck, probes) result(units)
      type(deck_t), intent(in) :: deck         !! with its *UNITS
      type(probe_t), intent(in) :: probes(:)
      type(string_t), allocatable :: units(:)
      character(len=:), allocatable :: dimension
      integer :: i, k

      allocate (units(0))
      do i = 1, size(probes)
         dimension = probes(i)%quantity
         if (dimension == 'displacement') dimension = 'length'
         do k = 1, column_count(probes(i))
            call append(units, unit_text(deck, dimension))
         end do
      end do
   end function probe_units

   pure function column_count(probe) result(n)
      type(probe_t), intent(in) :: probe
      integer :: n

      n = merge(6, 3, probe%quantity == 'stress')
   end function column_count

   !> A name as it can stand in a header of commas.
   pure function in_header(name) result(text)
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: text
      integer :: i

      text = name
      do i = 1, len(name)
         if (scan(name(i:i), ',"') > 0) text(i:i) = '_'
      end do
   end function in_header

   !> The values of all probes now, one behind the other, the same on all ranks. Collective.
   subroutine probe_values(probes, m, values)
      type(probe_t), intent(in) :: probes(:)
      type(model_t), intent(in) :: m
      real(wp), allocatable, intent(out) :: values(:)
      integer :: i, first, n

      n = 0
      do i = 1, size(probes)
         n = n + column_count(probes(i))
      end do
      allocate (values(n), source=0.0_wp)
      first = 1
      do i = 1, size(probes)
         n = column_count(probes(i))
         select case (probes(i)%kind)
         case (at_section)
            call section_force(m, probes(i), values(first:first + 2))
         case (at_boundary)
            values(first:first + 2) = m%boundaries(probes(i)%boundary)%reaction
         case default
            call look_at_particle(m%particles, probes(i), values(first:first + n - 1))
         end select
         first = first + n
      end do
      call sum_all(m%comm, values)
   end subroutine probe_values

   !> What is wanted of one particle; values stay as they are on ranks that do not hold it.
   pure subroutine look_at_particle(p, probe, values)
      type(particles_t), intent(in) :: p
      type(probe_t), intent(in) :: probe
      real(wp), intent(inout) :: values(:)
      integer :: c, i

      do c = 1, p%n_chunks
         if (p%count(c) == 0) cycle
         if (.not. any(p%id(:p%count(c), c) == probe%id)) cycle
         i = findloc_id(p%id(:p%count(c), c), probe%id)
         select case (probe%quantity)
         case ('velocity')
            values = p%q(i, c_v:c_v + 2, c)
         case ('stress')
            values = p%q(i, c_s:c_s + 5, c)
         case default
            values = p%q(i, c_x:c_x + 2, c) - p%x0(i, :, c)
         end select
         return
      end do
   end subroutine look_at_particle

   pure function findloc_id(ids, id) result(i)
      integer(i8), intent(in) :: ids(:), id
      integer :: i

      do i = 1, size(ids)
         if (ids(i) == id) return
      end do
   end function findloc_id

   !> Force that the material beyond a plane puts on the material before it, from this rank.
   !>
   !> The traction s n is averaged over a slab of one cell about the plane: sum of s n V w/h, where
   !> w is the part of a particle's width that lies in the slab. Exact for a uniform stress.
   pure subroutine section_force(m, probe, force)
      type(model_t), intent(in) :: m
      type(probe_t), intent(in) :: probe
      real(wp), intent(out) :: force(3)
      integer, parameter :: row(3, 3) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3], [3, 3])
      real(wp) :: h, half, x, share
      integer :: c, i

      force = 0
      h = m%grid%lattice%size
      associate (q => m%particles%q)
         do c = 1, m%particles%n_chunks
            if (m%particles%count(c) == 0) cycle
            half = m%bodies%half(m%particles%body(c))*h
            do i = 1, m%particles%count(c)
               x = q(i, probe%axis, c) - probe%coordinate
               share = (min(x + half, 0.5_wp*h) - max(x - half, -0.5_wp*h))/(2*half)
               if (share > 0) force = force &
                  + q(i, c_s - 1 + row(:, probe%axis), c)*q(i, c_vol, c)*share/h
            end do
         end do
      end associate
   end subroutine section_force
end module xmpm_probes
