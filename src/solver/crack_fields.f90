!> The surfaces of all cracks with their fronts and fields, as the deck asks for them.
module xmpm_crack_fields
   use xmpm_kinds, only: wp, i8
   use xmpm_text, only: string_t
   use xmpm_front, only: front_t
   use xmpm_crack, only: crack_t, gather_crack
   use xmpm_fracture, only: fracture_t
   use xmpm_vtkhdf, only: field_t, drawn_t => surface_t
   use xmpm_model, only: model_t
   implicit none
   private

   public :: collect_cracks, crack_fields, add_front_fields

   character(len=5), parameter :: front_fields(4) = [character(len=5) :: 'J', 'K_I', 'K_II', &
      'K_III']

contains

   !> Names of the fields that a list of words stands for: the number of the crack comes first, an
   !> opening brings its component along the normal.
   pure subroutine crack_fields(words, length, names, units)
      type(string_t), intent(in) :: words(:)                !! of *OUTPUT, crack
      character(len=*), intent(in) :: length                !! unit of length
      type(string_t), allocatable, intent(out) :: names(:)  !! of the fields
      type(string_t), allocatable, intent(out) :: units(:)  !! of each
      integer :: i

      names = [string_t('crack')]
      units = [string_t('1')]
      do i = 1, size(words)
         names = [names, words(i)]
         units = [units, string_t(length)]
         if (words(i)%s == 'normal') units(size(units))%s = '1'
         if (words(i)%s /= 'opening') cycle
         names = [names, string_t('opening_normal')]
         units = [units, string_t(length)]
      end do
   end subroutine crack_fields

   !> Fields that *FRACTURE brings: the values at the front points as they were measured last, 0
   !> elsewhere.
   pure subroutine add_front_fields(release_rate, toughness, names, units)
      character(len=*), intent(in) :: release_rate, toughness    !! units
      type(string_t), allocatable, intent(inout) :: names(:)     !! of the fields
      type(string_t), allocatable, intent(inout) :: units(:)     !! of each
      integer :: i

      do i = 1, size(front_fields)
         names = [names, string_t(trim(front_fields(i)))]
         units = [units, string_t(toughness)]
      end do
      units(size(units) - 3)%s = release_rate
   end subroutine add_front_fields

   !> All cracks as one surface. The model's own cracks stay as they are, so that a run does not
   !> depend on its output. Collective.
   subroutine collect_cracks(m, names, units, drawn, fields)
      type(model_t), intent(in) :: m
      type(string_t), intent(in) :: names(:)                !! from crack_fields
      type(string_t), intent(in) :: units(:)                !! of each
      type(drawn_t), intent(out) :: drawn                   !! triangles and fronts
      type(field_t), allocatable, intent(out) :: fields(:)  !! one for each name
      type(crack_t), allocatable :: cracks(:)
      integer :: i, k, first

      cracks = m%cracks
      call start_drawing(cracks, names, units, drawn, fields)
      first = 0
      do i = 1, size(cracks)
         call gather_crack(cracks(i), m%comm, m%grid, .true.)
         do k = 1, size(fields)
            if (any(front_fields == fields(k)%name)) then
               call fill_front_field(m%fracture, cracks(i), i, first, fields(k))
            else
               call fill_field(cracks(i), i, first, fields(k))
            end if
         end do
         associate (s => cracks(i)%surface)
            drawn%points(:, first + 1:first + s%vertex_count) = s%x
            drawn%triangles = reshape([drawn%triangles, s%tri + first], &
               [3, size(drawn%triangles, 2) + s%triangle_count])
            call add_fronts(cracks(i)%front, first, drawn)
            first = first + s%vertex_count
         end associate
      end do
   end subroutine collect_cracks

   !> Room for the points and fields; no triangles and fronts yet.
   pure subroutine start_drawing(cracks, names, units, drawn, fields)
      type(crack_t), intent(in) :: cracks(:)
      type(string_t), intent(in) :: names(:), units(:)
      type(drawn_t), intent(out) :: drawn
      type(field_t), allocatable, intent(out) :: fields(:)
      integer :: k, n

      n = sum(cracks%surface%vertex_count)
      allocate (drawn%points(3, n), drawn%triangles(3, 0), drawn%fronts(0), fields(size(names)))
      drawn%front_start = [1]
      do k = 1, size(fields)
         fields(k)%name = names(k)%s
         fields(k)%unit = units(k)%s
         select case (names(k)%s)
         case ('crack')
            allocate (fields(k)%ids(n))
         case ('opening_normal', 'J', 'K_I', 'K_II', 'K_III')
            allocate (fields(k)%values(1, n), source=0.0_wp)
         case default
            allocate (fields(k)%values(3, n))
         end select
      end do
   end subroutine start_drawing

   !> Values of one field at the vertices of one crack.
   pure subroutine fill_field(crack, number, first, field)
      type(crack_t), intent(in) :: crack
      integer, intent(in) :: number              !! of the crack
      integer, intent(in) :: first               !! vertices of the cracks before
      type(field_t), intent(inout) :: field
      integer :: n

      n = crack%surface%vertex_count
      associate (s => crack%surface)
         select case (field%name)
         case ('crack')
            field%ids(first + 1:first + n) = int(number, i8)
         case ('opening')
            field%values(:, first + 1:first + n) = s%up - s%um
         case ('opening_normal')
            field%values(1, first + 1:first + n) = sum((s%up - s%um)*s%vertex_normal, dim=1)
         case ('displacement')
            field%values(:, first + 1:first + n) = 0.5_wp*(s%up + s%um)
         case ('normal')
            field%values(:, first + 1:first + n) = s%vertex_normal
         end select
      end associate
   end subroutine fill_field

   !> Last values at the front points of one crack.
   pure subroutine fill_front_field(fracture, crack, number, first, field)
      type(fracture_t), intent(in) :: fracture
      type(crack_t), intent(in) :: crack
      integer, intent(in) :: number              !! of the crack
      integer, intent(in) :: first               !! vertices of the cracks before
      type(field_t), intent(inout) :: field
      integer :: at, mode

      at = findloc(fracture%cracks, number, 1)
      if (at == 0) return
      if (.not. allocated(fracture%values(at)%j)) return
      if (size(fracture%values(at)%j) /= crack%front%node_count) return
      associate (v => fracture%values(at), vertex => first + crack%front%vertex)
         mode = findloc(front_fields, field%name, 1) - 1
         if (mode == 0) then
            field%values(1, vertex) = v%j
         else
            field%values(1, vertex) = v%k(mode, :)
         end if
      end associate
   end subroutine fill_front_field

   !> Each chain of a front becomes a line; a closed one ends at its first point.
   pure subroutine add_fronts(front, first, drawn)
      type(front_t), intent(in) :: front
      integer, intent(in) :: first               !! vertices of the cracks before
      type(drawn_t), intent(inout) :: drawn
      integer :: c, from, to

      do c = 1, front%chain_count
         from = front%chain_offset(c)
         to = front%chain_offset(c + 1) - 1
         drawn%fronts = [drawn%fronts, front%vertex(from:to) + first]
         if (front%closed(c)) drawn%fronts = [drawn%fronts, front%vertex(from) + first]
         drawn%front_start = [drawn%front_start, size(drawn%fronts) + 1]
      end do
   end subroutine add_fronts
end module xmpm_crack_fields
