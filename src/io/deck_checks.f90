!> What keys and keywords of a deck ask of each other: references, choices, geometry, signs of trouble.
module xmpm_deck_checks
   use xmpm_kinds, only: wp
   use xmpm_text, only: string_t, to_text, lower
   use xmpm_text_lists, only: append, join, upper
   use xmpm_keywords, only: split_words
   use xmpm_deck_data, only: deck_t, block_t, entry_t, has, given, valid, real_of, reals_of, text_of, texts_of, &
      complain, warn, find_block, count_blocks, block_named, names_of_blocks, entry_place, add_entry
   use xmpm_deck_hints, only: did_you_mean
   use xmpm_deck_units, only: si_factor, sound_speed
   use xmpm_deck_cracks, only: check_crack, check_symmetry_planes
   use xmpm_deck_choices, only: exactly_one, refuse, set_texts
   implicit none
   private

   public :: check_deck, fill_dependent_defaults

   character(len=*), parameter :: adding = 'box cylinder tube sphere'

contains

   !> Check every block against the others.
   subroutine check_deck(deck)
      type(deck_t), intent(inout) :: deck   !! gets problems and warnings; names get their written case
      type(block_t) :: block
      integer :: i

      do i = 1, size(deck%blocks)
         block = deck%blocks(i)
         select case (block%keyword)
         case ('job'); call check_job(deck, block)
         case ('material'); call check_material(deck, block)
         case ('body'); call check_body(deck, block)
         case ('set'); call check_set(deck, block)
         case ('crack'); call check_crack(deck, block)
         case ('curve'); call check_curve(deck, block)
         case ('load'); call check_load(deck, block)
         case ('gravity'); call check_time_keys(deck, block)
         case ('boundary'); call check_boundary(deck, block)
         case ('time'); call check_time(deck, block)
         case ('relax'); call check_relax(deck, block)
         case ('output'); call check_output(deck, block)
         case ('probe'); call check_probe(deck, block)
         end select
         deck%blocks(i) = block
      end do
      call check_symmetry_planes(deck)
   end subroutine check_deck

   subroutine check_job(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block

      if (index(block%name, '/') > 0) &
         call complain(deck, block, '', 'the name heads the names of files and must not hold a /')
   end subroutine check_job

   subroutine check_material(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      real(wp) :: speed

      if (.not. (valid(block, 'young') .and. valid(block, 'poisson') .and. valid(block, 'density'))) return
      speed = sound_speed(real_of(block, 'young'), real_of(block, 'poisson'), real_of(block, 'density')) &
         *si_factor(deck, 'velocity')
      if (speed >= 10.0_wp .and. speed <= 20000.0_wp) return
      call warn(deck, block, '', 'under the units of the deck a wave runs at '//to_text(anint(speed)) &
         //' m/s, and in a solid it runs at 10 to 20000 m/s: do the numbers fit *UNITS?')
   end subroutine check_material

   subroutine check_body(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      integer :: i
      logical :: started

      call resolve(deck, block, 'material', 'material')
      started = .false.
      do i = 1, size(block%entries)
         associate (key => block%entries(i)%key)
            if (index(' '//adding//' ', ' '//key//' ') > 0) started = .true.
            if (index(key, 'without_') == 1 .and. .not. started) then
               call complain(deck, block, key, 'there is nothing yet to cut from: write what is cut first')
               started = .true.
            end if
         end associate
         if (block%entries(i)%valid) call check_primitive(deck, block, i)
      end do
      if (has(block, 'file') .and. started) then
         call complain(deck, block, 'file', 'a body is from a file or from primitives, not from both')
      else if (.not. has(block, 'file') .and. .not. started) then
         call complain(deck, block, '', 'the body has no shape: give box, cylinder, tube, sphere or file')
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
      fault = primitive_fault(key(index(key, 'without_') + merge(8, 1, index(key, 'without_') > 0):), &
         block%entries(i)%numbers)
      if (len(fault) == 0) return
      alone%keyword = block%keyword
      alone%name = block%name
      alone%entries = block%entries(i:i)
      call complain(deck, alone, key, fault)
   end subroutine check_primitive

   !> What is wrong with the numbers of a shape; blank where nothing is.
   pure function primitive_fault(shape, n) result(fault)
      character(len=*), intent(in) :: shape   !! box, cylinder, tube or sphere; others have no faults
      real(wp), intent(in) :: n(:)            !! as in the deck [length]
      character(len=:), allocatable :: fault

      fault = ''
      select case (shape)
      case ('box')
         if (any(n(4:6) <= n(1:3))) fault = 'the second corner must lie beyond the first in x, y and z'
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

   subroutine check_box(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      real(wp) :: n(6)

      if (.not. valid(block, 'box')) return
      n = reals_of(block, 'box')
      if (any(n(4:6) < n(1:3))) &
         call complain(deck, block, 'box', 'the second corner must not lie before the first in x, y or z')
   end subroutine check_box

   subroutine check_curve(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      real(wp), allocatable :: n(:)
      integer :: last

      if (lower(block%name) == 'step' .or. lower(block%name) == 'ramp') &
         call complain(deck, block, '', 'step and ramp are built in: take another name')
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

   !> curve, rise and start of all that acts over time.
   subroutine check_time_keys(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      character(len=:), allocatable :: curve

      if (.not. valid(block, 'curve')) return
      curve = lower(text_of(block, 'curve'))
      if (curve == 'step' .or. curve == 'ramp') then
         call set_texts(block, 'curve', curve)
      else
         call resolve(deck, block, 'curve', 'curve', 'step ramp')
      end if
      if (curve == 'ramp' .and. .not. has(block, 'rise')) then
         call complain(deck, block, 'curve', "the ramp needs 'rise', the time that it grows")
      else if (curve /= 'ramp') then
         call refuse(deck, block, 'rise', 'it belongs to curve = ramp')
      end if
   end subroutine check_time_keys

   subroutine check_load(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block

      call exactly_one(deck, block, 'face set')
      call exactly_one(deck, block, 'traction pressure')
      call resolve_set(deck, block)
      if (has(block, 'set')) call refuse(deck, block, 'pressure', 'it needs a face: a set has no normal')
      if (valid(block, 'face')) call check_face(deck, block)
      call check_time_keys(deck, block)
   end subroutine check_load

   !> body:face, where the body has such a face.
   subroutine check_face(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      character(len=*), parameter :: faces(8) = [character(len=6) :: '+x', '-x', '+y', '-y', '+z', '-z', &
         'side', 'inside']
      type(string_t), allocatable :: names(:)
      type(block_t) :: body
      character(len=:), allocatable :: text, face
      integer :: colon, i

      text = text_of(block, 'face')
      colon = index(text, ':', back=.true.)
      do i = 1, size(faces)
         call append(names, trim(faces(i)))
      end do
      if (colon == 0) then
         call complain(deck, block, 'face', "'"//text//"' is not BODY:FACE with a face out of "//join(names, ' '))
         return
      end if
      face = lower(text(colon + 1:))
      if (.not. any(faces == face) .or. len(face) == 0) then
         call complain(deck, block, 'face', "'"//face//"' is not a face"//did_you_mean(face, names))
         return
      end if
      i = block_named(deck, 'body', text(:colon - 1))
      if (i == 0) then
         call complain(deck, block, 'face', missing(deck, 'body', text(:colon - 1)))
         return
      end if
      body = find_block(deck, 'body', i)
      call set_texts(block, 'face', body%name//':'//face)
      if (face == 'inside' .and. .not. has(body, 'tube')) &
         call complain(deck, block, 'face', "only a tube has a face 'inside'")
      if (face == 'side' .and. .not. (has(body, 'tube') .or. has(body, 'cylinder') .or. has(body, 'sphere'))) &
         call complain(deck, block, 'face', "only a cylinder, a tube or a sphere has a face 'side'")
   end subroutine check_face

   subroutine check_boundary(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      character(len=:), allocatable :: type

      call exactly_one(deck, block, 'plane box set')
      call resolve_set(deck, block)
      call check_box(deck, block)
      call check_components(deck, block)
      call check_time_keys(deck, block)
      if (.not. valid(block, 'type')) return
      type = text_of(block, 'type')
      if (type == 'velocity' .or. type == 'acceleration') then
         call check_value(deck, block)
         return
      end if
      call refuse(deck, block, 'value', 'it belongs to type = velocity and acceleration')
      if (given(block, 'curve')) &
         call refuse(deck, block, 'curve', 'it belongs to type = velocity and acceleration')
      if (type == 'symmetry' .and. .not. has(block, 'plane')) &
         call complain(deck, block, 'type', 'symmetry is about a plane: give plane = x 0, for example')
      if (type == 'roller' .and. .not. has(block, 'plane') .and. .not. has(block, 'components')) &
         call complain(deck, block, 'type', 'a roller away from a plane needs the components that it holds')
      if (type == 'symmetry' .or. (type == 'roller' .and. has(block, 'plane'))) &
         call refuse(deck, block, 'components', 'the plane says which component is held')
   end subroutine check_boundary

   !> Letters out of x y z, each once; kept as one text in that order.
   subroutine check_components(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      character(len=:), allocatable :: all, sorted
      integer :: i

      if (.not. valid(block, 'components')) return
      all = lower(join(texts_of(block, 'components'), ''))
      sorted = ''
      do i = 1, 3
         if (index(all, 'xyz' (i:i)) > 0) sorted = sorted//'xyz' (i:i)
      end do
      if (len(sorted) /= len(all)) then
         call complain(deck, block, 'components', "'"//all//"' is not made of the letters x, y, z, each once")
         block%entries(entry_place(block, 'components'))%valid = .false.
      else
         call set_texts(block, 'components', sorted)
      end if
   end subroutine check_components

   !> One number for each component, or all three; kept as all three.
   subroutine check_value(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      character(len=:), allocatable :: components
      real(wp), allocatable :: given_values(:), values(:)
      integer :: i, place

      if (.not. has(block, 'value')) then
         call complain(deck, block, 'type', "the key 'value' is missing")
         return
      end if
      if (.not. valid(block, 'value')) return
      if (has(block, 'components') .and. .not. valid(block, 'components')) return
      components = 'xyz'
      if (has(block, 'components')) components = text_of(block, 'components')
      given_values = reals_of(block, 'value')
      if (size(given_values) == 3) return
      if (size(given_values) /= len(components)) then
         call complain(deck, block, 'value', 'three numbers are needed, or one for each of the components ' &
            //components//'; got '//to_text(size(given_values)))
         return
      end if
      allocate (values(3), source=0.0_wp)
      do i = 1, len(components)
         values(index('xyz', components(i:i))) = given_values(i)
      end do
      place = entry_place(block, 'value')
      call set_texts(block, 'value', to_text(values(1)), to_text(values(2)), to_text(values(3)))
      call move_alloc(values, block%entries(place)%numbers)
   end subroutine check_value

   subroutine check_time(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block

      if (valid(block, 'cfl') .and. real_of(block, 'cfl') > 1.0_wp) &
         call warn(deck, block, 'cfl', 'a time step above the stability limit (cfl = 1) blows up')
      if (text_of(block, 'scheme') == 'usl') &
         call warn(deck, block, 'scheme', 'usl is unstable where a node carries little mass: musl is the safe choice')
      if (has(block, 'step') .and. given(block, 'cfl')) &
         call warn(deck, block, 'cfl', 'it is not used, since a fixed step is given')
   end subroutine check_time

   subroutine check_relax(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block

      if (text_of(block, 'method') == 'viscous' .and. .not. has(block, 'rate')) &
         call complain(deck, block, 'method', "viscous relaxation needs 'rate'")
      if (text_of(block, 'method') == 'kinetic') &
         call refuse(deck, block, 'rate', 'it belongs to method = viscous')
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
         if (fields(i)%s == 'none' .and. size(fields) > 1) &
            call complain(deck, block, key, "'none' stands beside other fields")
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

   !> A set of the deck; sets of a particle file are not known here.
   subroutine resolve_set(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      integer :: i
      logical :: from_file

      if (.not. valid(block, 'set')) return
      from_file = .false.
      do i = 1, count_blocks(deck, 'body')
         from_file = from_file .or. has(find_block(deck, 'body', i), 'file')
      end do
      if (from_file .and. block_named(deck, 'set', text_of(block, 'set')) == 0) return
      call resolve(deck, block, 'set', 'set')
   end subroutine resolve_set

   !> A key that names a block of a keyword: the block must exist; the name gets the case it has there.
   subroutine resolve(deck, block, key, keyword, also)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      character(len=*), intent(in) :: key
      character(len=*), intent(in) :: keyword
      character(len=*), intent(in), optional :: also   !! words that the key may have as well
      type(block_t) :: found
      integer :: i

      if (.not. valid(block, key)) return
      i = block_named(deck, keyword, text_of(block, key))
      if (i == 0) then
         call complain(deck, block, key, missing(deck, keyword, text_of(block, key), also))
      else
         found = find_block(deck, keyword, i)
         call set_texts(block, key, found%name)
      end if
   end subroutine resolve

   pure function missing(deck, keyword, name, also) result(text)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: keyword
      character(len=*), intent(in) :: name
      character(len=*), intent(in), optional :: also
      character(len=:), allocatable :: text
      type(string_t), allocatable :: names(:)

      if (present(also)) then
         call split_words(also, names)
         names = [names_of_blocks(deck, keyword), names]
      else
         names = names_of_blocks(deck, keyword)
      end if
      text = 'there is no *'//upper(keyword)//" '"//name//"'"//did_you_mean(name, names)
      if (size(names) == 0) text = text//' (none in the deck has a name)'
   end function missing

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
            if (index('fixed velocity acceleration', text_of(block, 'type')) > 0) &
               call give_text(block, 'components', 'xyz')
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
