!> Checks that many keywords share: one key out of several, keys that do not belong.
module xmpm_deck_choices
   use xmpm_text, only: string_t
   use xmpm_text_lists, only: append, join
   use xmpm_keywords, only: split_words
   use xmpm_deck_data, only: deck_t, block_t, entry_place, text_of, has, complain
   implicit none
   private

   public :: exactly_one, refuse, set_texts

contains

   !> Exactly one of several keys must be given; a flag that is no counts as not given.
   subroutine exactly_one(deck, block, keys, chosen)
      type(deck_t), intent(inout) :: deck                                     !! gets the problem
      type(block_t), intent(in) :: block                                      !! with the keys
      character(len=*), intent(in) :: keys                                    !! with blanks between
      character(len=:), allocatable, intent(out), optional :: chosen   !! the one, or blank
      type(string_t), allocatable :: names(:), found(:)
      integer :: i

      call split_words(keys, names)
      allocate (found(0))
      do i = 1, size(names)
         if (has(block, names(i)%s) .and. text_of(block, &
            names(i)%s) /= 'no') call append(found, names(i)%s)
      end do
      if (present(chosen)) chosen = ''
      if (size(found) == 0) then
         call complain(deck, block, '', 'one of these must be given: '//join(names, ', '))
      else if (size(found) > 1) then
         call complain(deck, block, found(2)%s, 'only one of these can be given: '//join(names, &
            ', ') &
            //', but here are: '//join(found, ', '))
      else if (present(chosen)) then
         chosen = found(1)%s
      end if
   end subroutine exactly_one

   !> A key must not be given here.
   subroutine refuse(deck, block, key, reason)
      type(deck_t), intent(inout) :: deck        !! gets the problem
      type(block_t), intent(in) :: block         !! with or without the key
      character(len=*), intent(in) :: key        !! that does not belong
      character(len=*), intent(in) :: reason     !! why

      if (has(block, key)) call complain(deck, block, key, 'it does not belong here: '//reason)
   end subroutine refuse

   !> Replace the texts of a key.
   pure subroutine set_texts(block, key, text, second, third)
      type(block_t), intent(inout) :: block                 !! has the key
      character(len=*), intent(in) :: key                   !! to change
      character(len=*), intent(in) :: text                  !! the first new text
      character(len=*), intent(in), optional :: second      !! the second
      character(len=*), intent(in), optional :: third       !! the third
      type(string_t), allocatable :: texts(:)
      integer :: place

      place = entry_place(block, key)
      call append(texts, text)
      if (present(second)) call append(texts, second)
      if (present(third)) call append(texts, third)
      call move_alloc(texts, block%entries(place)%texts)
      block%entries(place)%quoted = spread(.false., 1, size(block%entries(place)%texts))
   end subroutine set_texts
end module xmpm_deck_choices
