!> Cracks from the deck.
module xmpm_setup_cracks
   use xmpm_kinds, only: wp
   use xmpm_text, only: lower
   use xmpm_error, only: error_t
   use xmpm_deck, only: deck_t, block_t, count_blocks, find_block, has, flag_of, real_of, &
      reals_of, &
      text_of, complain
   use xmpm_surface, only: build_surface
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_rectangle, make_polygon, make_disc, &
      make_ellipse, make_sector
   use xmpm_crack_file, only: read_crack_file
   use xmpm_crack, only: crack_t, rule_graded, rule_node, rule_full, rule_cut
   implicit none
   private

   public :: read_cracks

contains

   !> Surfaces and front rules of all *CRACK blocks; problems go to the deck.
   subroutine read_cracks(deck, size_of_cell, cracks)
      type(deck_t), intent(inout) :: deck
      real(wp), intent(in) :: size_of_cell   !! [length]
      type(crack_t), allocatable, intent(out) :: cracks(:)
      type(block_t) :: block
      integer :: i

      allocate (cracks(count_blocks(deck, 'crack')))
      do i = 1, size(cracks)
         block = find_block(deck, 'crack', i)
         cracks(i)%name = block%name
         cracks(i)%ramp = real_of(block, 'ramp')
         cracks(i)%ramp_end = real_of(block, 'ramp_end')
         select case (lower(text_of(block, 'front')))
         case ('node')
            cracks(i)%rule = rule_node
         case ('full')
            cracks(i)%rule = rule_full
         case ('cut')
            cracks(i)%rule = rule_cut
         case default
            cracks(i)%rule = rule_graded
         end select
         call read_surface(deck, block, size_of_cell, cracks(i))
      end do
   end subroutine read_cracks

   !> The triangles of one crack.
   subroutine read_surface(deck, block, size_of_cell, crack)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      real(wp), intent(in) :: size_of_cell
      type(crack_t), intent(inout) :: crack
      type(error_t), allocatable :: failure
      type(block_t) :: units
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      real(wp) :: element

      element = size_of_cell
      if (has(block, 'element')) element = real_of(block, 'element')
      if (has(block, 'file')) then
         units = find_block(deck, 'units', 1)
         call read_crack_file(text_of(block, 'file'), text_of(units, 'length'), x, tri, failure)
      else
         call make_shape(block, element, x, tri, failure)
      end if
      if (.not. allocated(failure)) call build_surface(x, tri, crack%surface, failure)
      if (allocated(failure)) call complain(deck, block, '', failure%message)
   end subroutine read_surface

   !> Triangles of a plane shape.
   subroutine make_shape(block, element, x, tri, error)
      type(block_t), intent(in) :: block
      real(wp), intent(in) :: element
      real(wp), allocatable, intent(out) :: x(:, :)
      integer, allocatable, intent(out) :: tri(:, :)
      type(error_t), allocatable, intent(out) :: error
      type(crack_plane_t) :: plane
      real(wp) :: axes(2)

      if (flag_of(block, 'polygon')) then
         associate (points => reals_of(block, 'points'))
            call make_polygon(reshape(points, [3, size(points)/3]), element, x, tri, error)
         end associate
         return
      end if
      call set_plane(reals_of(block, 'centre'), reals_of(block, 'along'), &
         reals_of(block, 'across'), plane, error)
      if (allocated(error)) return
      if (flag_of(block, 'rectangle')) then
         call make_rectangle(plane, [real_of(block, 'width'), real_of(block, 'depth')], element, &
            x, tri, error)
         return
      end if
      if (flag_of(block, 'disc')) then
         axes = real_of(block, 'radius')
      else
         axes = reals_of(block, 'semi_axes')
      end if
      if (has(block, 'sector')) then
         call make_sector(plane, axes, reals_of(block, 'sector'), element, x, tri, error)
      else if (flag_of(block, 'disc')) then
         call make_disc(plane, axes(1), element, x, tri, error)
      else
         call make_ellipse(plane, axes, element, x, tri, error)
      end if
   end subroutine make_shape
end module xmpm_setup_cracks
