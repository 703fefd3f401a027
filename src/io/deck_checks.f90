!> What keys and keywords of a deck ask of each other: references, choices, geometry.
module xmpm_deck_checks
   use xmpm_kinds, only: wp
   use xmpm_text, only: string_t, to_text, lower
   use xmpm_text_lists, only: append
   use xmpm_deck_data, only: deck_t, block_t, entry_t, has, given, valid, real_of, reals_of, &
      text_of, texts_of, complain, warn, count_blocks, find_block, add_entry
   use xmpm_deck_units, only: si_factor, sound_speed
   use xmpm_deck_growth, only: check_growth
   use xmpm_deck_cracks, only: check_crack, check_symmetry_planes
   use xmpm_deck_choices, only: exactly_one, refuse
   use xmpm_deck_references, only: resolve, resolve_list
   use xmpm_deck_contact, only: check_contact, check_rigid
   use xmpm_deck_loads, only: check_load, check_boundary, check_time_keys, check_box
   implicit none
   private

   public :: check_deck, fill_dependent_defaults

   character(len=*), parameter :: adding = 'box cylinder tube sphere'

contains

   !> Check every block against the others.
   subroutine check_deck(deck)
      type(deck_t), intent(inout) :: deck   !! gets problems and warnings
      type(block_t) :: block
      integer :: i

      do i = 1, size(deck%blocks)
         block = deck%blocks(i)
         select case (block%keyword)
         case ('job'); call check_job(deck, block)
         case ('material'); call check_material(deck, block)
         case ('body'); call check_body(deck, block)
         case ('set'); call check_set(deck, block)
         case ('contact'); call check_contact(deck, block)
         case ('crack'); call check_crack(deck, block)
         case ('curve'); call check_curve(deck, block)
         case ('load'); call check_load(deck, block)
         case ('gravity'); call check_time_keys(deck, block)
         case ('boundary'); call check_boundary(deck, block)
         case ('time'); call check_time(deck, block)
         case ('relax'); call check_relax(deck, block)
         case ('output'); call check_output(deck, block)
         case ('fracture'); call check_fracture(deck, block)
         case ('growth'); call check_growth(deck, block)
         case ('probe'); call check_probe(deck, block)
         end select
         deck%blocks(i) = block
      end do
      call check_symmetry_planes(deck)
   end subroutine check_deck

   !> Times, and cracks that exist.
   subroutine check_fracture(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block

      call resolve_list(deck, block, 'cracks', 'crack')
      if (count_blocks(deck, 'crack') == 0) then
         call complain(deck, block, '', 'there is no *CRACK whose fronts could be looked at')
      end if
      if (.not. (has(block, 'every') .or. has(block, 'at'))) then
         call complain(deck, block, '', "one of the keys 'every' and 'at' must say when")
      end if
   end subroutine check_fracture

   subroutine check_job(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block

      if (index(block%name, '/') > 0) then
         call complain(deck, block, '', 'the name heads the names of files and must not hold a /')
      end if
   end subroutine check_job

   subroutine check_material(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      real(wp) :: speed

      if (.not. (valid(block, 'young') .and. valid(block, 'poisson') .and. valid(block, &
         'density'))) return
      speed = sound_speed(real_of(block, 'young'), real_of(block, 'poisson'), real_of(block, &
         'density')) &
         *si_factor(deck, 'velocity')
      if (speed >= 10.0_wp .and. speed <= 20000.0_wp) return
      call warn(deck, block, '', 'under the units of the deck a wave runs at ' &
         //to_text(anint(speed)) &
         //' m/s, and in a solid it runs at 10 to 20000 m/s: do the numbers fit *UNITS?')
   end subroutine check_material

   subroutine check_body(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      integer :: i
      logical :: started

      call resolve(deck, block, 'material', 'material')
      call check_rigid(deck, block)
      started = .false.
      do i = 1, size(block%entries)
         associate (key => block%entries(i)%key)
            if (index(' '//adding//' ', ' '//key//' ') > 0) started = .true.
            if (index(key, 'without_') == 1 .and. .not. started) then
               call complain(deck, block, key, &
                  'there is nothing yet to cut from: write what is cut first')
               started = .true.
            end if
         end associate
         if (block%entries(i)%valid) call check_primitive(deck, block, i)
      end do
      if (has(block, 'file') .and. started) then
         call complain(deck, block, 'file', &
            'a body is from a file or from primitives, not from both')
      else if (.not. has(block, 'file') .and. .not. started) then
         call complain(deck, block, '', &
            'the body has no shape: give box, cylinder, tube, sphere or file')
      end if
      if (.not. has(block, 'file')) call refuse(deck, block, 'part', 'it needs a file')
   end subroutine check_body

   !> Extents of a primitive must be those of a solid.
   subroutine check_primitive(deck, block, i)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      integer, intent(in) :: i             !! place of the entry
      type(block_t) :: alone
      character(len=:), allocatable :: key, fault

      if (.not. allocated(block%entries(i)%numbers)) return
      key = block%entries(i)%key
      fault = primitive_fault(key(index(key, 'without_') + merge(8, 1, index(key, &
         'without_') > 0):), &
         block%entries(i)%numbers)
      if (len(fault) == 0) return
      alone%keyword = block%keyword
      alone%name = block%name
      alone%entries = block%entries(i:i)
      call complain(deck, alone, key, fault)
   end subroutine check_primitive

   !> What is wrong with the numbers of a shape; blank where nothing is.
   pure function primitive_fault(shape, n) result(fault)
      character(len=*), intent(in) :: shape   !! of a primitive; other keys have no faults
      real(wp), intent(in) :: n(:)            !! as in the deck [length]
      character(len=:), allocatable :: fault

      fault = ''
      select case (shape)
      case ('box')
         if (any(n(4:6) <= n(1:3))) then
            fault = 'the second corner must lie beyond the first in x, y and z'
         end if
      case ('cylinder', 'tube')
         if (norm2(n(4:6) - n(1:3)) <= 0.0_wp) fault = 'the two ends of the axis are the same point'
         if (n(7) < 0.0_wp .or. n(size(n)) <= 0.0_wp) fault = 'the radius must be greater than 0'
         if (shape == 'tube') then
            if (n(8) <= n(7)) fault = 'the inner radius must be smaller than the outer'
         end if
      case ('sphere')
         if (n(4) <= 0.0_wp) fault = 'the radius must be greater than 0'
      end select
   end function primitive_fault

   subroutine check_set(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block

      call resolve(deck, block, 'body', 'body')
      call check_box(deck, block)
   end subroutine check_set

   subroutine check_curve(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      real(wp), allocatable :: n(:)
      integer :: last

      if (lower(block%name) == 'step' .or. lower(block%name) == 'ramp') then
         call complain(deck, block, '', 'step and ramp are built in: take another name')
      end if
      if (.not. valid(block, 'table')) return
      n = reals_of(block, 'table')
      last = size(n)
      if (mod(last, 2) /= 0) then
         call complain(deck, block, 'table', 'pairs of time and factor are needed; got ' &
            //to_text(last)//' numbers')
      else if (any(n(3:last:2) <= n(1:last - 2:2))) then
         call complain(deck, block, 'table', 'each time must be later than the one before')
      end if
   end subroutine check_curve

   subroutine check_time(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block

      if (valid(block, 'cfl') .and. real_of(block, 'cfl') > 1.0_wp) then
         call warn(deck, block, 'cfl', 'a time step above the stability limit (cfl = 1) blows up')
      end if
      if (text_of(block, 'scheme') == 'usl') then
         call warn(deck, block, 'scheme', &
         'usl is unstable where a node carries little mass: musl is the safe choice')
      end if
      if (text_of(block, 'scheme') == 'usl' .and. text_of(block, 'inertia') == 'corrected') then
         call complain(deck, block, 'inertia', 'corrected inertia goes with musl and usf: '// &
            'usl does not smooth the velocity that strains')
      end if
      if (has(block, 'step') .and. given(block, 'cfl')) then
         call warn(deck, block, 'cfl', 'it is not used, since a fixed step is given')
      end if
   end subroutine check_time

   subroutine check_relax(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block

      if (text_of(block, 'method') == 'viscous' .and. .not. has(block, 'rate')) then
         call complain(deck, block, 'method', "viscous relaxation needs 'rate'")
      end if
      if (text_of(block, 'method') == 'kinetic') then
         call refuse(deck, block, 'rate', 'it belongs to method = viscous')
      end if
   end subroutine check_relax

   !> Fields are listed once, and none stands alone.
   subroutine check_output(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block

      call check_fields(deck, block, 'particles')
      call check_fields(deck, block, 'crack')
   end subroutine check_output

   subroutine check_fields(deck, block, key)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      character(len=*), intent(in) :: key
      type(string_t), allocatable :: fields(:)
      integer :: i, j

      if (.not. valid(block, key)) return
      fields = texts_of(block, key)
      do i = 1, size(fields)
         if (fields(i)%s == 'none' .and. size(fields) > 1) then
            call complain(deck, block, key, "'none' stands beside other fields")
         end if
         do j = 1, i - 1
            if (fields(i)%s /= fields(j)%s) cycle
            call complain(deck, block, key, "'"//fields(i)%s//"' is listed twice")
            return
         end do
      end do
   end subroutine check_fields

   subroutine check_probe(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block

      call exactly_one(deck, block, 'point section reaction')
      if (.not. has(block, 'point')) call refuse(deck, block, 'quantity', 'it belongs to a point')
      if (has(block, 'reaction')) call resolve(deck, block, 'reaction', 'boundary')
   end subroutine check_probe

   !> Defaults that are values of other keys: cell size, end of the run, interval of output.
   subroutine fill_dependent_defaults(deck)
      type(deck_t), intent(inout) :: deck   !! without problems
      type(block_t) :: block
      integer :: i

      do i = 1, size(deck%blocks)
         block = deck%blocks(i)
         select case (block%keyword)
         case ('crack')
            call give_number(block, 'element', real_of(find_block(deck, 'grid', 1), 'size'))
         case ('output')
            call give_number(block, 'every', real_of(find_block(deck, 'time', 1), 'end'))
            call give_number(block, 'history', real_of(block, 'every'))
         case ('boundary')
            if (index('fixed velocity acceleration', text_of(block, 'type')) > 0) then
               call give_text(block, 'components', 'xyz')
            end if
         case ('probe')
            if (has(block, 'point')) call give_text(block, 'quantity', 'displacement')
         end select
         deck%blocks(i) = block
      end do
   end subroutine fill_dependent_defaults

   subroutine give_number(block, key, value)
      type(block_t), intent(inout) :: block
      character(len=*), intent(in) :: key
      real(wp), intent(in) :: value

      if (has(block, key)) return
      call give_text(block, key, to_text(value))
      block%entries(size(block%entries))%numbers = [value]
   end subroutine give_number

   subroutine give_text(block, key, text)
      type(block_t), intent(inout) :: block
      character(len=*), intent(in) :: key
      character(len=*), intent(in) :: text
      type(entry_t) :: entry

      if (has(block, key)) return
      entry%key = key
      call append(entry%texts, text)
      entry%quoted = [.false.]
      entry%file = ''
      entry%given = .false.
      call add_entry(block%entries, entry)
   end subroutine give_text
end module xmpm_deck_checks
