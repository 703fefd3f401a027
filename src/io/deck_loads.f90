!> Checks of what acts on bodies over time: loads, gravity, boundaries.
module xmpm_deck_loads
   use xmpm_kinds, only: wp
   use xmpm_text, only: string_t, to_text, lower
   use xmpm_text_lists, only: append, join
   use xmpm_deck_data, only: deck_t, block_t, has, valid, reals_of, text_of, texts_of, &
      complain, find_block, block_named, entry_place
   use xmpm_deck_choices, only: exactly_one, refuse, set_texts
   use xmpm_deck_references, only: resolve, resolve_set, missing
   use xmpm_deck_hints, only: did_you_mean
   implicit none
   private

   public :: check_load, check_boundary, check_time_keys, check_box

contains

   subroutine check_load(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block

      call exactly_one(deck, block, 'face set')
      call exactly_one(deck, block, 'traction pressure')
      call resolve_set(deck, block)
      if (valid(block, 'set')) then
         if (block_named(deck, 'set', text_of(block, 'set')) > 0) call refuse(deck, block, &
            'pressure', 'it needs a face, or a set with areas from a particle file: a *SET '// &
            'has no normal')
      end if
      if (valid(block, 'face')) call check_face(deck, block)
      call check_time_keys(deck, block)
   end subroutine check_load

   !> body:face, where the body has such a face.
   subroutine check_face(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      character(len=*), parameter :: faces(8) = [character(len=6) :: '+x', '-x', '+y', '-y', &
         '+z', '-z', &
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
         call complain(deck, block, 'face', "'"//text &
            //"' is not BODY:FACE with a face out of "//join(names, ' '))
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
      if (face == 'inside' .and. .not. has(body, 'tube')) then
         call complain(deck, block, 'face', "only a tube has a face 'inside'")
      end if
      if (face == 'side' .and. .not. (has(body, 'tube') .or. has(body, &
         'cylinder') .or. has(body, 'sphere'))) then
         call complain(deck, block, 'face', "only a cylinder, a tube or a sphere has a face 'side'")
      end if
   end subroutine check_face

   subroutine check_boundary(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block

      call exactly_one(deck, block, 'plane box set')
      call resolve_set(deck, block)
      call check_box(deck, block)
      call check_components(deck, block)
      call check_time_keys(deck, block)
      if (.not. valid(block, 'type')) return
      call check_type(deck, block)
      if (valid(block, 'components')) then
         call set_texts(block, 'components', in_order(text_of(block, 'components')))
      end if
   end subroutine check_boundary

   !> The keys that each type needs, and no others.
   subroutine check_type(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      character(len=:), allocatable :: type

      type = text_of(block, 'type')
      if (type == 'velocity' .or. type == 'acceleration') then
         call check_value(deck, block)
         return
      end if
      call refuse(deck, block, 'value', 'it belongs to type = velocity and acceleration')
      if (text_of(block, 'curve') /= 'step') then
         call refuse(deck, block, 'curve', 'it belongs to type = velocity and acceleration')
      end if
      if (type == 'symmetry' .and. .not. has(block, 'plane')) then
         call complain(deck, block, 'type', &
         'symmetry is about a plane: give plane = x 0, for example')
      end if
      if (type == 'roller' .and. .not. has(block, 'plane') .and. &
         .not. has(block, 'components')) then
         call complain(deck, block, 'type', &
         'a roller away from a plane needs the components that it holds')
      end if
      if (type == 'symmetry' .or. (type == 'roller' .and. has(block, 'plane'))) then
         call refuse(deck, block, 'components', 'the plane says which component is held')
      end if
   end subroutine check_type

   !> Letters out of x y z, each once; kept as one text.
   subroutine check_components(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      character(len=:), allocatable :: all

      if (.not. valid(block, 'components')) return
      all = lower(join(texts_of(block, 'components'), ''))
      if (len(in_order(all)) /= len(all)) then
         call complain(deck, block, 'components', &
            "'"//all//"' is not made of the letters x, y, z, each once")
         block%entries(entry_place(block, 'components'))%valid = .false.
      else
         call set_texts(block, 'components', all)
      end if
   end subroutine check_components

   !> Those of the letters x, y, z that are in a text, in this order.
   pure function in_order(letters) result(sorted)
      character(len=*), intent(in) :: letters
      character(len=:), allocatable :: sorted
      integer :: i

      sorted = ''
      do i = 1, 3
         if (index(letters, 'xyz' (i:i)) > 0) sorted = sorted//'xyz' (i:i)
      end do
   end function in_order

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
         call complain(deck, block, 'value', &
            'three numbers are needed, or one for each of the components ' &
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

   subroutine check_box(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      real(wp) :: n(6)

      if (.not. valid(block, 'box')) return
      n = reals_of(block, 'box')
      if (any(n(4:6) < n(1:3))) then
         call complain(deck, block, 'box', &
         'the second corner must not lie before the first in x, y or z')
      end if
   end subroutine check_box
end module xmpm_deck_loads
