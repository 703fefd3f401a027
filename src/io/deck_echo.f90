!> The deck as it was understood: every default filled in, every expression a number, itself a deck.
module xmpm_deck_echo
   use xmpm_text, only: to_text
   use xmpm_text_lists, only: upper
   use xmpm_deck_data, only: deck_t, entry_t
   implicit none
   private

   public :: deck_echo

   character(len=1), parameter :: nl = new_line('a')

contains

   !> A deck with the same meaning as the one that was read.
   pure function deck_echo(deck) result(text)
      type(deck_t), intent(in) :: deck            !! parsed, without problems
      character(len=:), allocatable :: text       !! lines split by new_line
      integer :: i, j

      text = ''
      if (allocated(deck%parameters%names)) then
         do i = 1, size(deck%parameters%names)
            text = text//'! parameter '//deck%parameters%names(i)%s//' = ' &
               //to_text(deck%parameters%values(i))//nl
         end do
      end if
      do i = 1, size(deck%blocks)
         text = text//'*'//upper(deck%blocks(i)%keyword)
         if (len(deck%blocks(i)%name) > 0) text = text//' '//quote(deck%blocks(i)%name)
         text = text//nl
         do j = 1, size(deck%blocks(i)%entries)
            text = text//'   '//deck%blocks(i)%entries(j)%key//' = ' &
               //values_text(deck%blocks(i)%entries(j))//nl
         end do
      end do
      text = text//'*END'//nl
   end function deck_echo

   !> The values of an entry; long lists of numbers go on over lines.
   pure function values_text(entry) result(text)
      type(entry_t), intent(in) :: entry
      character(len=:), allocatable :: text
      integer :: i, numbers

      text = ''
      numbers = 0
      if (allocated(entry%numbers)) numbers = size(entry%numbers)
      do i = 1, size(entry%texts)
         if (i > 1) text = text//' '
         if (i > 1 .and. mod(i - 1, 6) == 0 .and. size(entry%texts) > 8) text = text//nl//'      '
         if (i > size(entry%texts) - numbers) then
            text = text//to_text(entry%numbers(i - size(entry%texts) + numbers))
         else
            text = text//quote(entry%texts(i)%s)
         end if
      end do
   end function values_text

   !> A text in quotes where it would not be read as one value without them.
   pure function quote(text) result(quoted)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: quoted
      integer :: i
      character(len=1) :: mark

      quoted = text
      if (len(text) > 0) then
         if (scan(text, ' ,=!$()"''*#'//achar(9)) == 0) return
      end if
      quoted = '"'
      mark = '"'
      do i = 1, len(text)
         if (text(i:i) == mark) then   ! close, and go on with the other mark
            quoted = quoted//mark
            mark = merge("'", '"', mark == '"')
            quoted = quoted//mark
         end if
         quoted = quoted//text(i:i)
      end do
      quoted = quoted//mark
   end function quote
end module xmpm_deck_echo
