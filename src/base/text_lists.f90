!> Growing lists of texts, and parts of texts.
module xmpm_text_lists
   use xmpm_text, only: string_t
   implicit none
   private

   public :: append, join, slice, upper, shown

contains

   !> Put one more text at the end of a list.
   pure subroutine append(list, text)
      type(string_t), allocatable, intent(inout) :: list(:)   !! made where it is not yet
      character(len=*), intent(in) :: text                    !! copied
      type(string_t), allocatable :: longer(:)
      integer :: i, n

      n = 0
      if (allocated(list)) n = size(list)
      allocate (longer(n + 1))
      do i = 1, n
         call move_alloc(list(i)%s, longer(i)%s)
      end do
      longer(n + 1)%s = text
      call move_alloc(longer, list)
   end subroutine append

   !> Texts one after the other.
   pure function join(list, between) result(text)
      type(string_t), intent(in) :: list(:)     !! in this order
      character(len=*), intent(in) :: between   !! for example ', '
      character(len=:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(list)
         if (i > 1) text = text//between
         text = text//list(i)%s
      end do
   end function join

   !> The characters from `first` to `last`; none where `last` is before `first`.
   pure function slice(text, first, last) result(part)
      character(len=*), intent(in) :: text   !! any
      integer, intent(in) :: first           !! at least 1
      integer, intent(in) :: last            !! at most the length of the text
      character(len=:), allocatable :: part

      part = text(first:last)
   end function slice

   !> A text as a message shows it: of a long one the start.
   pure function shown(text) result(short)
      character(len=*), intent(in) :: text   !! any
      character(len=:), allocatable :: short
      integer, parameter :: longest = 80

      short = text
      if (len(text) > longest) short = text(:longest)//'...'
   end function shown

   !> Upper-case copy of a text.
   pure function upper(text) result(up)
      character(len=*), intent(in) :: text   !! any
      character(len=:), allocatable :: up
      integer :: i

      up = text
      do i = 1, len(text)
         if (text(i:i) >= 'a' .and. text(i:i) <= 'z') up(i:i) = achar(iachar(text(i:i)) - 32)
      end do
   end function upper
end module xmpm_text_lists
