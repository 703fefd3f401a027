!> Checks of bodies that meet and of rigid bodies.
module xmpm_deck_contact
   use xmpm_kinds, only: wp
   use xmpm_text, only: string_t, lower
   use xmpm_text_lists, only: join
   use xmpm_deck_data, only: deck_t, block_t, has, valid, reals_of, texts_of, flag_of, complain, &
      block_named
   use xmpm_deck_choices, only: refuse, set_texts
   use xmpm_deck_references, only: missing
   implicit none
   private

   public :: check_contact, check_rigid

contains

   !> Two different bodies at least, or all; a normal that is a direction.
   subroutine check_contact(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(string_t), allocatable :: names(:)
      integer, allocatable :: bodies(:)
      integer :: i

      if (valid(block, 'normal')) then
         if (.not. norm2(reals_of(block, 'normal')) > 0.0_wp) then
            call complain(deck, block, 'normal', 'it has no direction')
         end if
      end if
      if (.not. valid(block, 'bodies')) return
      names = texts_of(block, 'bodies')
      if (size(names) == 1 .and. lower(names(1)%s) == 'all') return
      allocate (bodies(size(names)))
      do i = 1, size(names)
         bodies(i) = block_named(deck, 'body', names(i)%s)
         if (bodies(i) == 0) then
            call complain(deck, block, 'bodies', missing(deck, 'body', names(i)%s, 'all'))
         else if (any(bodies(:i - 1) == bodies(i))) then
            call complain(deck, block, 'bodies', "the body '"//names(i)%s//"' is named twice")
         end if
      end do
      if (size(names) == 1) then
         call complain(deck, block, 'bodies', 'contact needs two bodies at least, or all')
      end if
   end subroutine check_contact

   !> Keys that belong to rigid bodies, and those that do not.
   subroutine check_rigid(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      character(len=:), allocatable :: letters
      integer :: i

      if (.not. flag_of(block, 'rigid')) then
         call refuse(deck, block, 'mass', 'it belongs to a rigid body')
         call refuse(deck, block, 'held', 'it belongs to a rigid body')
         return
      end if
      if (valid(block, 'spin')) then
         if (any(abs(reals_of(block, 'spin')) > 0.0_wp)) then
            call complain(deck, block, 'spin', 'a rigid body moves without turning')
         end if
      end if
      if (.not. valid(block, 'held')) return
      letters = lower(join(texts_of(block, 'held'), ''))
      if (verify(letters, 'xyz') > 0 .or. any([(index(letters(i + 1:), letters(i:i)) > 0, &
         i=1, len(letters))])) then
         call complain(deck, block, 'held', "'"//letters// &
            "' is not made of the letters x, y, z, each once")
      else
         call set_texts(block, 'held', letters)
      end if
   end subroutine check_rigid
end module xmpm_deck_contact
