!> Points and fields of this rank's particles, as the deck asks for them.
module xmpm_particle_fields
   use xmpm_kinds, only: wp, i8
   use xmpm_text, only: string_t
   use xmpm_deck, only: deck_t, unit_text
   use xmpm_vtkhdf, only: field_t
   use xmpm_storage, only: particles_t, count_particles, c_x, c_v, c_s, n_near, near_crack, &
      near_side, near_psi, near_phi
   use xmpm_model, only: model_t
   implicit none
   private

   public :: collect_particles, particle_unit

   real(wp), parameter :: farthest = 10   !! phi is cut at this distance from a front [cells]

contains

   !> Unit of a field.
   pure function particle_unit(deck, name) result(unit)
      type(deck_t), intent(in) :: deck         !! with its *UNITS
      character(len=*), intent(in) :: name     !! a word of *OUTPUT, particles
      character(len=:), allocatable :: unit

      select case (name)
      case ('displacement', 'psi', 'phi')
         unit = unit_text(deck, 'length')
      case ('velocity')
         unit = unit_text(deck, 'velocity')
      case ('stress', 'energy')
         unit = unit_text(deck, 'stress')
      case default
         unit = '1'
      end select
   end function particle_unit

   !> Positions and fields of all particles of this rank, in storage order.
   subroutine collect_particles(m, names, units, points, fields)
      type(model_t), intent(in) :: m
      type(string_t), intent(in) :: names(:)                !! words of *OUTPUT, particles
      type(string_t), intent(in) :: units(:)                !! of each
      real(wp), allocatable, intent(out) :: points(:, :)    !! (3,n) [length]
      type(field_t), allocatable, intent(out) :: fields(:)  !! one for each name
      integer :: i

      call read_columns(m%particles, c_x, 3, points)
      allocate (fields(size(names)))
      do i = 1, size(names)
         fields(i)%name = names(i)%s
         fields(i)%unit = units(i)%s
         call fill_field(m, points, fields(i))
      end do
   end subroutine collect_particles

   !> Values of one field.
   subroutine fill_field(m, points, field)
      type(model_t), intent(in) :: m
      real(wp), intent(in) :: points(:, :)
      type(field_t), intent(inout) :: field

      select case (field%name)
      case ('displacement')
         call fill_displacement(m%particles, points, field%values)
      case ('velocity')
         call read_columns(m%particles, c_v, 3, field%values)
      case ('stress')
         call read_columns(m%particles, c_s, 6, field%values)
      case ('energy')
         call fill_energy(m, field%values)
      case ('psi', 'phi')
         call fill_distance(m, field%name, field%values)
      case default
         call fill_number(m, field%name, field%ids)
      end select
   end subroutine fill_field

   !> Neighbouring components of all particles.
   pure subroutine read_columns(p, first, n, values)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: first, n    !! first component and how many
      real(wp), allocatable, intent(out) :: values(:, :)
      integer :: c, i, k

      allocate (values(n, count_particles(p)))
      k = 0
      do c = 1, p%n_chunks
         do i = 1, p%count(c)
            k = k + 1
            values(:, k) = p%q(i, first:first + n - 1, c)
         end do
      end do
   end subroutine read_columns

   !> Way from the first position.
   pure subroutine fill_displacement(p, points, values)
      type(particles_t), intent(in) :: p
      real(wp), intent(in) :: points(:, :)
      real(wp), allocatable, intent(out) :: values(:, :)
      integer :: c, i, k

      allocate (values(3, size(points, 2)))
      k = 0
      do c = 1, p%n_chunks
         do i = 1, p%count(c)
            k = k + 1
            values(:, k) = points(:, k) - p%x0(i, :, c)
         end do
      end do
   end subroutine fill_displacement

   !> Elastic energy per volume.
   pure subroutine fill_energy(m, values)
      type(model_t), intent(in) :: m
      real(wp), allocatable, intent(out) :: values(:, :)
      real(wp) :: stress(6)
      integer :: c, i, k

      allocate (values(1, count_particles(m%particles)))
      k = 0
      do c = 1, m%particles%n_chunks
         if (m%particles%count(c) == 0) cycle
         associate (law => m%bodies%laws(m%bodies%law_of(m%particles%body(c)))%law)
            do i = 1, m%particles%count(c)
               k = k + 1
               stress = m%particles%q(i, c_s:c_s + 5, c)
               values(1, k) = law%strain_energy(stress)
            end do
         end associate
      end do
   end subroutine fill_energy

   !> psi or phi of the nearest crack; 0 far from all cracks. phi is cut at 10 cells, since a
   !> particle beside a crack that has no front near it has no finite one.
   pure subroutine fill_distance(m, name, values)
      type(model_t), intent(in) :: m
      character(len=*), intent(in) :: name   !! psi or phi
      real(wp), allocatable, intent(out) :: values(:, :)
      real(wp) :: limit
      integer :: c, i, k, at

      allocate (values(1, count_particles(m%particles)))
      limit = farthest*m%grid%lattice%size
      k = 0
      do c = 1, m%particles%n_chunks
         do i = 1, m%particles%count(c)
            k = k + 1
            at = nearest_slot(m%particles, i, c)
            values(1, k) = 0
            if (at < 0) cycle
            associate (near => m%particles%near(i, :, m%particles%attached(c)))
               if (name == 'psi') then
                  values(1, k) = near(at + near_psi)
               else
                  values(1, k) = max(-limit, min(limit, near(at + near_phi)))
               end if
            end associate
         end do
      end do
   end subroutine fill_distance

   !> A whole number: material and body from 1 in the order of the deck, side -1, 0 (far from all
   !> cracks) or 1, number for life, rank.
   pure subroutine fill_number(m, name, values)
      type(model_t), intent(in) :: m
      character(len=*), intent(in) :: name   !! material, body, side, id or rank
      integer(i8), allocatable, intent(out) :: values(:)
      integer :: c, i, k, at

      allocate (values(count_particles(m%particles)), source=int(m%comm%rank, i8))
      if (name == 'rank') return
      k = 0
      do c = 1, m%particles%n_chunks
         do i = 1, m%particles%count(c)
            k = k + 1
            select case (name)
            case ('id')
               values(k) = m%particles%id(i, c)
            case ('body')
               values(k) = int(m%particles%body(c), i8)
            case ('material')
               values(k) = int(m%bodies%law_of(m%particles%body(c)), i8)
            case ('side')
               values(k) = 0
               at = nearest_slot(m%particles, i, c)
               if (at >= 0) values(k) = nint(m%particles%near(i, at + near_side, &
                  m%particles%attached(c)), i8)
            end select
         end do
      end do
   end subroutine fill_number

   !> Where the slot of the nearest crack begins, less one; -1 far from all cracks.
   pure function nearest_slot(p, lane, chunk) result(at)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: lane, chunk
      integer :: at, k
      real(wp) :: distance

      at = -1
      if (p%attached(chunk) == 0) return
      distance = huge(distance)
      do k = 0, n_near*(p%slots - 1), n_near
         associate (near => p%near(lane, :, p%attached(chunk)))
            if (nint(near(k + near_crack)) == 0) cycle
            if (.not. abs(near(k + near_psi)) < distance) cycle
            distance = abs(near(k + near_psi))
            at = k
         end associate
      end do
   end function nearest_slot
end module xmpm_particle_fields
