!> Checks of *CRACK: one shape with its keys, in no symmetry plane.
module xmpm_deck_cracks
   use xmpm_kinds, only: wp
   use xmpm_text, only: string_t, to_text
   use xmpm_keywords, only: split_words
   use xmpm_deck_data, only: deck_t, block_t, has, valid, real_of, reals_of, text_of, complain, &
      count_blocks, find_block
   use xmpm_deck_choices, only: exactly_one, refuse
   implicit none
   private

   public :: check_crack, check_symmetry_planes

   character(len=*), parameter :: shapes = 'rectangle disc ellipse polygon file'
   character(len=*), parameter :: shape_keys = &
      'centre along across width depth radius semi_axes points sector'

contains

   !> One shape, and the keys that it needs and no others.
   subroutine check_crack(deck, block)
      type(deck_t), intent(inout) :: deck    !! gets problems
      type(block_t), intent(in) :: block     !! a *CRACK
      character(len=:), allocatable :: shape, needed, allowed
      type(string_t), allocatable :: keys(:)
      integer :: i

      if (text_of(block, 'contact') == 'friction') then
         if (.not. has(block, 'friction')) then
            call complain(deck, block, 'contact', "contact with friction needs 'friction'")
         end if
      else
         call refuse(deck, block, 'friction', 'it belongs to contact = friction')
      end if
      call exactly_one(deck, block, shapes, shape)
      if (len(shape) == 0) return
      needed = needed_keys(shape)
      allowed = needed
      if (shape == 'disc' .or. shape == 'ellipse') allowed = needed//'sector '
      call split_words(shape_keys, keys)
      do i = 1, size(keys)
         if (index(needed, ' '//keys(i)%s//' ') > 0 .and. .not. has(block, keys(i)%s)) then
            call complain(deck, block, shape, "the key '"//keys(i)%s//"' is missing")
         else if (index(allowed, ' '//keys(i)%s//' ') == 0) then
            call refuse(deck, block, keys(i)%s, 'it is not a key of '//shape)
         end if
      end do
      call check_directions(deck, block)
      call check_sector(deck, block)
      if (valid(block, 'points')) call check_polygon(deck, block, reals_of(block, 'points'))
      if (shape == 'file') call check_file(deck, block)
   end subroutine check_crack

   pure function needed_keys(shape) result(keys)
      character(len=*), intent(in) :: shape
      character(len=:), allocatable :: keys     !! with blanks between and around

      select case (shape)
      case ('rectangle'); keys = ' centre along across width depth '
      case ('disc'); keys = ' centre along across radius '
      case ('ellipse'); keys = ' centre along across semi_axes '
      case ('polygon'); keys = ' points '
      case default; keys = ' '
      end select
   end function needed_keys

   subroutine check_directions(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      real(wp) :: along(3), across(3)

      if (.not. (valid(block, 'along') .and. valid(block, 'across'))) return
      along = reals_of(block, 'along')
      across = reals_of(block, 'across')
      if (norm2(along) <= 0.0_wp) then
         call complain(deck, block, 'along', 'the direction has no length')
      else if (norm2(across) <= 0.0_wp) then
         call complain(deck, block, 'across', 'the direction has no length')
      else if (norm2(cross(along/norm2(along), across/norm2(across))) < 1.0e-6_wp) then
         call complain(deck, block, 'across', &
            'it is parallel to along: the two must span the plane of the crack')
      end if
   end subroutine check_directions

   subroutine check_sector(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      real(wp) :: angles(2)

      if (.not. valid(block, 'sector')) return
      angles = reals_of(block, 'sector')
      if (angles(2) <= angles(1) .or. angles(2) - angles(1) > 360.0_wp) then
         call complain(deck, block, 'sector', &
         'it must go from a smaller to a greater angle, at most 360 degrees apart')
      end if
   end subroutine check_sector

   !> Corners in threes of numbers, in one plane, no two neighbours the same.
   subroutine check_polygon(deck, block, n)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      real(wp), intent(in) :: n(:)            !! as written [length]
      real(wp) :: normal(3), size_of
      integer :: i, corners

      corners = size(n)/3
      if (3*corners /= size(n)) then
         call complain(deck, block, 'points', 'three numbers a corner are needed; got ' &
            //to_text(size(n))//' numbers')
         return
      end if
      size_of = extent(n)
      normal = polygon_normal(n)
      if (norm2(normal) <= 1.0e-9_wp*size_of**2) then
         call complain(deck, block, 'points', 'the corners enclose no area')
         return
      end if
      normal = normal/norm2(normal)
      do i = 1, corners
         if (abs(dot_product(n(3*i - 2:3*i) - n(1:3), normal)) > 1.0e-6_wp*size_of) then
            call complain(deck, block, 'points', 'corner '//to_text(i) &
               //' lies outside of the plane of the others')
            return
         end if
      end do
   end subroutine check_polygon

   subroutine check_file(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      character(len=:), allocatable :: path

      path = text_of(block, 'file')
      if (path(index(path, '.', back=.true.) + 1:) == 'stl' .or. path(index(path, '.', &
         back=.true.) + 1:) == 'h5') return
      call complain(deck, block, 'file', "'"//path//"' is neither a .stl nor a .h5 file")
   end subroutine check_file

   !> A crack that lies in a symmetry plane has only one face: it cannot be modelled so.
   subroutine check_symmetry_planes(deck)
      type(deck_t), intent(inout) :: deck    !! gets problems
      type(block_t) :: crack, boundary
      integer :: i, j

      do i = 1, count_blocks(deck, 'crack')
         crack = find_block(deck, 'crack', i)
         do j = 1, count_blocks(deck, 'boundary')
            boundary = find_block(deck, 'boundary', j)
            if (text_of(boundary, 'type') /= 'symmetry' .or. .not. valid(boundary, 'plane')) cycle
            if (.not. lies_in_plane(crack, text_of(boundary, 'plane'), real_of(boundary, &
               'plane'))) cycle
            call complain(deck, crack, '', 'the crack lies in the symmetry plane ' &
               //text_of(boundary, 'plane')//' = ' &
               //to_text(real_of(boundary, 'plane')) &
               //': model both halves without that plane, or leave out the ' &
               //'crack and hold only the uncracked part of the plane (type = roller, box, ' &
               //'components)')
         end do
      end do
   end subroutine check_symmetry_planes

   !> Whether a crack from a shape lies in the plane where one coordinate has a value.
   pure function lies_in_plane(crack, axis, value) result(lies)
      type(block_t), intent(in) :: crack
      character(len=*), intent(in) :: axis
      real(wp), intent(in) :: value          !! [length]
      logical :: lies

      lies = .false.
      if (valid(crack, 'points')) then
         lies = polygon_lies(reals_of(crack, 'points'), index('xyz', axis), value)
      else if (valid(crack, 'centre') .and. valid(crack, 'along') .and. valid(crack, 'across')) then
         lies = plane_is(cross(reals_of(crack, 'along'), reals_of(crack, 'across')), &
            reals_of(crack, 'centre'), &
            maxval([real_of(crack, 'width'), real_of(crack, 'radius'), reals_of(crack, &
            'semi_axes')]), &
            index('xyz', axis), value)
      end if
   end function lies_in_plane

   pure function polygon_lies(n, k, value) result(lies)
      real(wp), intent(in) :: n(:)      !! corners, three numbers each [length]
      integer, intent(in) :: k          !! coordinate
      real(wp), intent(in) :: value     !! [length]
      logical :: lies

      lies = .false.
      if (size(n) >= 9) lies = plane_is(polygon_normal(n), n(1:3), extent(n), k, value)
   end function polygon_lies

   !> Whether the plane with a normal through a point is the one where coordinate k has a value.
   pure function plane_is(normal, point, length, k, value) result(is)
      real(wp), intent(in) :: normal(3)
      real(wp), intent(in) :: point(3)   !! [length]
      real(wp), intent(in) :: length     !! extent of the crack, for the tolerance [length]
      integer, intent(in) :: k
      real(wp), intent(in) :: value      !! [length]
      logical :: is

      is = norm2(normal) - abs(normal(k)) <= 1.0e-9_wp*norm2(normal) &
         .and. abs(point(k) - value) <= 1.0e-6_wp*length
   end function plane_is

   !> Twice the area of a plane polygon times its normal.
   pure function polygon_normal(n) result(normal)
      real(wp), intent(in) :: n(:)   !! corners, three numbers each
      real(wp) :: normal(3)
      integer :: i

      normal = 0.0_wp
      do i = 2, size(n)/3 - 1
         normal = normal + cross(n(3*i - 2:3*i) - n(1:3), n(3*i + 1:3*i + 3) - n(1:3))
      end do
   end function polygon_normal

   !> Longest edge of the box around points.
   pure function extent(n) result(length)
      real(wp), intent(in) :: n(:)   !! points, three numbers each
      real(wp) :: length

      length = max(maxval(n(1::3)) - minval(n(1::3)), maxval(n(2::3)) - minval(n(2::3)), &
         maxval(n(3::3)) - minval(n(3::3)))
   end function extent

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3)
      real(wp), intent(in) :: b(3)
      real(wp) :: c(3)

      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross
end module xmpm_deck_cracks
