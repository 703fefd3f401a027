!> Tests of the strict reading of numbers.
program test_numbers
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use xmpm_kinds, only: wp, i8
   use xmpm_text, only: to_text
   use xmpm_numbers, only: parse_real, parse_integer, number_length, number_good, &
      number_garbage, number_range
   use testing, only: suite_t, check, finish
   implicit none
   type(suite_t) :: suite

   suite%name = 'numbers'
   call accepts_every_form()
   call refuses_garbage()
   call refuses_what_does_not_fit()
   call reads_integers()
   call finds_the_length_of_a_number()
   call gives_back_every_bit()
   call finish(suite)

contains

   subroutine accepts_every_form()
      call expect('200', 200.0_wp)
      call expect('2e9', 2.0e9_wp)
      call expect('2.d9', 2.0e9_wp)
      call expect('2e+9', 2.0e9_wp)
      call expect('2.E+09', 2.0e9_wp)
      call expect('-1D-3', -1.0e-3_wp)
      call expect('+.5', 0.5_wp)
      call expect('5.', 5.0_wp)
      call expect('007', 7.0_wp)
      call expect('0e-400', 0.0_wp)
      call expect('-0.0', 0.0_wp)
      call expect('0.1', 0.1_wp)
      call expect('1.7976931348623157d308', huge(1.0_wp))
      call expect('0.000000000000000000000000000000000000000000000000001e51', 1.0_wp)
   end subroutine accepts_every_form

   subroutine refuses_garbage()
      character(len=10), parameter :: garbage(26) = [character(len=10) :: '', '.', '-', '+', &
         'e5', '2e', &
         '2e+', '1.2.3', '1e5.', '3h', '1_000', '1,5', '0x10', '1f', '2e9x', '--1', '+-1', 'nan', &
         'NaN', 'inf', '-Infinity', '1/2', '2*3', '1e5e5', '1 2', '2d+']
      real(wp) :: value
      integer :: i, status

      do i = 1, size(garbage)
         call parse_real(trim(garbage(i)), value, status)
         call check(suite, "'"//trim(garbage(i))//"' is no number", status == number_garbage)
         call check(suite, "'"//trim(garbage(i))//"' leaves a zero", abs(value) <= 0.0_wp)
      end do
      call parse_real(' 1', value, status)
      call check(suite, 'a blank before a number is not part of one', status == number_garbage)
      call parse_real('1 ', value, status)
      call check(suite, 'a blank behind a number is not part of one', status == number_garbage)
   end subroutine refuses_garbage

   subroutine refuses_what_does_not_fit()
      character(len=12), parameter :: too_far(6) = [character(len=12) :: '1e309', '-1.8e308', &
         '1e-400', &
         '1e999999999', '1e-99999', '9d9999']
      real(wp) :: value
      integer :: i, status

      do i = 1, size(too_far)
         call parse_real(trim(too_far(i)), value, status)
         call check(suite, trim(too_far(i))//' is out of range', status == number_range)
      end do
   end subroutine refuses_what_does_not_fit

   subroutine reads_integers()
      integer :: value, status

      call parse_integer('2147483647', value, status)
      call check(suite, 'the largest integer is read', status == number_good .and. value == huge(1))
      call parse_integer('2147483648', value, status)
      call check(suite, 'a larger one is out of range', status == number_range .and. value == 0)
      call parse_integer('-3.0', value, status)
      call check(suite, 'a whole real is an integer', status == number_good .and. value == -3)
      call parse_integer('1e6', value, status)
      call check(suite, 'so is 1e6', status == number_good .and. value == 1000000)
      call parse_integer('2.5', value, status)
      call check(suite, 'a half is no integer', status == number_garbage)
      call parse_integer('two', value, status)
      call check(suite, 'a word is no integer', status == number_garbage)
   end subroutine reads_integers

   subroutine finds_the_length_of_a_number()
      call check(suite, 'a number ends at an operator', number_length('2.d9*h') == 4)
      call check(suite, 'an e without digits is no exponent', number_length('2em') == 1)
      call check(suite, 'a sign does not start a number here', number_length('-2') == 0)
      call check(suite, 'a point alone is none', number_length('.') == 0)
      call check(suite, 'a number may end with the text', number_length('1e+10') == 5)
      call check(suite, 'no text, no number', number_length('') == 0)
   end subroutine finds_the_length_of_a_number

   !> Random bit patterns survive the way to text and back without loss.
   subroutine gives_back_every_bit()
      integer(i8) :: bits
      real(wp) :: x, back
      integer :: i, status
      logical :: same

      bits = 88172645463325252_i8
      same = .true.
      do i = 1, 2000
         bits = ieor(bits, ishft(bits, 13))
         bits = ieor(bits, ishft(bits, -7))
         bits = ieor(bits, ishft(bits, 17))
         if (iand(ishft(bits, -52), 2047_i8) == 2047_i8) cycle   ! NaN and infinity
         x = transfer(bits, x)
         call parse_real(to_text(x), back, status)
         same = same .and. status == number_good .and. transfer(back, bits) == bits
      end do
      call check(suite, 'numbers arrive in full double precision', same)
      call check(suite, 'to_text keeps a fraction of one digit', to_text(0.5_wp) == '0.5')
      call check(suite, 'to_text writes the largest number', ieee_is_finite(huge(x)) .and. &
         to_text(huge(x)) == '1.7976931348623157e308')
   end subroutine gives_back_every_bit

   !> The value must be the nearest double: no tolerance.
   subroutine expect(text, value)
      character(len=*), intent(in) :: text
      real(wp), intent(in) :: value
      real(wp) :: got
      integer :: status

      call parse_real(text, got, status)
      call check(suite, text//' is a number', status == number_good)
      call check(suite, text//' has its exact value', got >= value .and. got <= value)
   end subroutine expect
end program test_numbers
