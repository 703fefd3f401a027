!> Strict reading of numbers: a whole text in full double precision, or refusal.
module xmpm_numbers
   use, intrinsic :: ieee_arithmetic, only: ieee_get_halting_mode, ieee_set_halting_mode, &
      ieee_set_flag, ieee_is_finite
   use, intrinsic :: ieee_exceptions, only: ieee_usual
   use xmpm_kinds, only: wp
   implicit none
   private

   public :: parse_real, parse_integer, number_length
   public :: number_good, number_garbage, number_range

   integer, parameter :: number_good = 0      !! the text is a number
   integer, parameter :: number_garbage = 1   !! the text is no number
   integer, parameter :: number_range = 2     !! a number too large or too small to hold

   character(len=*), parameter :: digits = '0123456789'

contains

   !> Read a real in any Fortran or C decimal form: 200, 2e9, 2.d9, 2E+09, .5, 5., -1D-3.
   subroutine parse_real(text, value, status)
      character(len=*), intent(in) :: text   !! without blanks around it
      real(wp), intent(out) :: value         !! 0 where the text is refused
      integer, intent(out) :: status         !! number_good, number_garbage or number_range
      integer :: start

      value = 0.0_wp
      status = number_garbage
      if (len(text) == 0) return
      start = 1
      if (scan(text(1:1), '+-') == 1) start = 2
      if (number_length(text(start:)) /= len(text) - start + 1) return
      if (start > len(text)) return
      call convert(text, value, status)
   end subroutine parse_real

   !> Read an integer; a real form with a whole value (2.0, 1e6) is one too.
   subroutine parse_integer(text, value, status)
      character(len=*), intent(in) :: text   !! without blanks around it
      integer, intent(out) :: value          !! 0 where the text is refused
      integer, intent(out) :: status         !! number_good, number_garbage or number_range
      real(wp) :: x

      value = 0
      call parse_real(text, x, status)
      if (status /= number_good) return
      if (abs(x) > real(huge(value), wp)) then
         status = number_range
      else if (abs(x - anint(x)) > 0.0_wp) then
         status = number_garbage
      else
         value = nint(x)
      end if
   end subroutine parse_integer

   !> How many characters at the start of a text form an unsigned decimal number; 0 where none do.
   pure function number_length(text) result(n)
      character(len=*), intent(in) :: text   !! for example '2.d9*h'
      integer :: n                           !! for example 4
      integer :: whole, fraction, first

      whole = digits_at(text, 1)
      n = whole
      fraction = 0
      if (n < len(text)) then
         if (text(n + 1:n + 1) == '.') then
            fraction = digits_at(text, n + 2)
            n = n + 1 + fraction
         end if
      end if
      if (whole + fraction == 0) then
         n = 0
      else if (n < len(text)) then
         if (scan(text(n + 1:n + 1), 'eEdD') == 1) then
            first = n + 2
            if (first < len(text)) first = first + scan(text(first:first), '+-')
            if (digits_at(text, first) > 0) n = first + digits_at(text, first) - 1
         end if
      end if
   end function number_length

   pure function digits_at(text, first) result(n)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first
      integer :: n

      n = 0
      if (first > len(text)) return
      n = verify(text(first:), digits) - 1
      if (n < 0) n = len(text) - first + 1
   end function digits_at

   !> Convert a text known to have the form of a number; what overflows or vanishes is out of range.
   subroutine convert(text, value, status)
      character(len=*), intent(in) :: text
      real(wp), intent(out) :: value
      integer, intent(out) :: status
      character(len=:), allocatable :: buffer
      logical :: halting(size(ieee_usual))
      integer :: mark, io

      buffer = text
      mark = scan(buffer, 'dD')
      if (mark > 0) buffer(mark:mark) = 'e'
      call ieee_get_halting_mode(ieee_usual, halting)
      call ieee_set_halting_mode(ieee_usual, .false.)
      read (buffer, *, iostat=io) value
      call ieee_set_flag(ieee_usual, .false.)
      call ieee_set_halting_mode(ieee_usual, halting)
      status = number_good
      if (io /= 0) value = huge(value)
      if (io /= 0 .or. .not. ieee_is_finite(value) .or. vanished(buffer, value)) then
         status = number_range
         value = 0.0_wp
      end if
   end subroutine convert

   !> Whether a number that is not zero was rounded to zero.
   pure function vanished(text, value) result(lost)
      character(len=*), intent(in) :: text
      real(wp), intent(in) :: value
      logical :: lost
      integer :: mark

      mark = scan(text, 'eE')
      if (mark == 0) mark = len(text) + 1
      lost = abs(value) <= 0.0_wp .and. scan(text(:mark - 1), '123456789') > 0
   end function vanished
end module xmpm_numbers
