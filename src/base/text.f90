!> Numbers to text, and small services on text.
module xmpm_text
   use, intrinsic :: iso_fortran_env, only: int64, real64
   implicit none
   private

   public :: to_text, lower, string_t

   !> One text of any length, so that texts can stand in arrays.
   type :: string_t
      character(len=:), allocatable :: s   !! the text
   end type string_t

   !> Shortest text of an integer, a real (17 significant digits at most) or a list of reals.
   interface to_text
      module procedure integer_to_text, long_to_text, real_to_text, reals_to_text
   end interface to_text

contains

   pure function integer_to_text(value) result(text)
      integer, intent(in) :: value
      character(len=:), allocatable :: text

      text = long_to_text(int(value, int64))
   end function integer_to_text

   pure function long_to_text(value) result(text)
      integer(int64), intent(in) :: value
      character(len=:), allocatable :: text
      character(len=24) :: buffer

      write (buffer, '(i0)') value
      text = trim(buffer)
   end function long_to_text

   !> A real in as few digits as give it back exactly when read again.
   pure function real_to_text(value) result(text)
      real(real64), intent(in) :: value
      character(len=:), allocatable :: text
      character(len=32) :: buffer
      real(real64) :: back
      integer :: digits, least, status
      character(len=16) :: form

      least = merge(17, 1, abs(value) > 1.0e308_real64)   ! fewer digits could round up to infinity
      do digits = least, 17
         write (form, '(a,i0,a)') '(es26.', digits - 1, 'e3)'
         write (buffer, form) value
         read (buffer, *, iostat=status) back
         if (status == 0 .and. back >= value .and. back <= value) exit
      end do
      text = plain_form(trim(adjustl(buffer)))
   end function real_to_text

   !> Write 1.25E+002 as 125 where that is short.
   pure function plain_form(buffer) result(text)
      character(len=*), intent(in) :: buffer
      character(len=:), allocatable :: text
      real(real64) :: value
      integer :: mark, power, status, digits
      character(len=32) :: fixed
      character(len=12) :: form

      text = buffer
      mark = index(buffer, 'E')
      if (mark == 0) return
      read (buffer(mark + 1:), *, iostat=status) power
      if (status /= 0) return
      if (power < -4 .or. power > 9) then
         text = trim_zero(buffer(:mark - 1))//'e'//long_to_text(int(power, int64))
         return
      end if
      read (buffer, *) value
      digits = max(0, digits_behind_point(trim_zero(buffer(:mark - 1))) - power)
      write (form, '(a,i0,a)') '(f32.', digits, ')'
      write (fixed, form) value
      text = trim_zero(trim(adjustl(fixed)))
      if (text(1:1) == '.') text = '0'//text
      if (len(text) > 1) then
         if (text(1:2) == '-.') text = '-0'//text(2:)
      end if
   end function plain_form

   pure function digits_behind_point(buffer) result(digits)
      character(len=*), intent(in) :: buffer
      integer :: digits

      digits = 0
      if (index(buffer, '.') > 0) digits = len(buffer) - index(buffer, '.')
   end function digits_behind_point

   !> Drop zeros behind the decimal point, and the point if nothing is left behind it.
   pure function trim_zero(buffer) result(text)
      character(len=*), intent(in) :: buffer
      character(len=:), allocatable :: text
      integer :: last

      last = len(buffer)
      if (index(buffer, '.') > 0) then
         do while (buffer(last:last) == '0')
            last = last - 1
         end do
         if (buffer(last:last) == '.') last = last - 1
      end if
      text = buffer(:last)
      if (len(text) == 0 .or. text == '-') text = '0'
   end function trim_zero

   pure function reals_to_text(values) result(text)
      real(real64), intent(in) :: values(:)
      character(len=:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(values)
         if (i > 1) text = text//' '
         text = text//real_to_text(values(i))
      end do
   end function reals_to_text

   !> Lower-case copy of a text.
   pure function lower(text) result(low)
      character(len=*), intent(in) :: text
      character(len=len(text)) :: low
      integer :: i, c

      do i = 1, len(text)
         c = iachar(text(i:i))
         if (c >= 65 .and. c <= 90) c = c + 32
         low(i:i) = achar(c)
      end do
   end function lower
end module xmpm_text
