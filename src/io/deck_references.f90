!> Keys that name other blocks of the deck: the block must exist.
module xmpm_deck_references
   use xmpm_text, only: string_t
   use xmpm_text_lists, only: append, upper
   use xmpm_keywords, only: split_words
   use xmpm_deck_data, only: deck_t, block_t, has, valid, text_of, texts_of, complain, find_block, &
      count_blocks, block_named, collect_names
   use xmpm_deck_choices, only: set_texts
   use xmpm_deck_hints, only: did_you_mean
   implicit none
   private

   public :: resolve, resolve_list, resolve_set, missing

contains

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

   !> A key that names a block of a keyword: it must exist; the name gets its case.
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

   !> A key that names several blocks of a keyword: each must exist.
   subroutine resolve_list(deck, block, key, keyword)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      character(len=*), intent(in) :: key
      character(len=*), intent(in) :: keyword
      type(string_t), allocatable :: names(:)
      integer :: i

      if (.not. valid(block, key)) return
      names = texts_of(block, key)
      do i = 1, size(names)
         if (block_named(deck, keyword, names(i)%s) > 0) cycle
         call complain(deck, block, key, missing(deck, keyword, names(i)%s))
      end do
   end subroutine resolve_list

   pure function missing(deck, keyword, name, also) result(text)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: keyword
      character(len=*), intent(in) :: name
      character(len=*), intent(in), optional :: also
      character(len=:), allocatable :: text
      type(string_t), allocatable :: names(:), words(:)
      integer :: i

      call collect_names(deck, keyword, names)
      if (present(also)) then
         call split_words(also, words)
         do i = 1, size(words)
            call append(names, words(i)%s)
         end do
      end if
      text = 'there is no *'//upper(keyword)//" '"//name//"'"//did_you_mean(name, names)
      if (size(names) == 0) text = text//' (none in the deck has a name)'
   end function missing
end module xmpm_deck_references
