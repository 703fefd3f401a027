!> Checks for the unit tests: each test is a sentence; a suite that ran no check fails.
module testing
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_text, only: to_text
   implicit none
   private

   public :: suite_t, check, check_close, check_error, check_no_error, finish

   !> Counts of one suite.
   type :: suite_t
      character(len=:), allocatable :: name   !! shown in the closing line
      integer :: passed = 0                   !! checks that held
      integer :: failed = 0                   !! checks that did not
   end type suite_t

contains

   !> A condition that must hold.
   subroutine check(suite, sentence, holds)
      type(suite_t), intent(inout) :: suite     !! counts
      character(len=*), intent(in) :: sentence  !! what is claimed
      logical, intent(in) :: holds              !! whether it is so

      if (holds) then
         suite%passed = suite%passed + 1
      else
         suite%failed = suite%failed + 1
         print '(4a)', 'FAILED ', suite%name, ': ', sentence
      end if
   end subroutine check

   !> A number that must agree with another: |value - expected| <= absolute + relative |expected|.
   subroutine check_close(suite, sentence, value, expected, absolute, relative)
      type(suite_t), intent(inout) :: suite     !! counts
      character(len=*), intent(in) :: sentence  !! what is claimed
      real(wp), intent(in) :: value             !! computed
      real(wp), intent(in) :: expected          !! known
      real(wp), intent(in) :: absolute          !! absolute tolerance
      real(wp), intent(in) :: relative          !! relative tolerance

      call check(suite, sentence//' (got '//to_text(value)//', expected '//to_text(expected)//')', &
         abs(value - expected) <= absolute + relative*abs(expected))
   end subroutine check_close

   !> A failure that must have been reported, with a text in its message.
   subroutine check_error(suite, sentence, error, part)
      type(suite_t), intent(inout) :: suite                !! counts
      character(len=*), intent(in) :: sentence             !! what is claimed
      type(error_t), allocatable, intent(in) :: error      !! what was reported
      character(len=*), intent(in) :: part                 !! must stand in the message

      if (.not. allocated(error)) then
         call check(suite, sentence//' (no error was reported)', .false.)
      else
         call check(suite, sentence//' (message: '//error%message//')', &
            index(error%message, part) > 0)
      end if
   end subroutine check_error

   !> No failure may have been reported.
   subroutine check_no_error(suite, sentence, error)
      type(suite_t), intent(inout) :: suite             !! counts
      character(len=*), intent(in) :: sentence          !! what is claimed
      type(error_t), allocatable, intent(in) :: error   !! what was reported

      if (allocated(error)) then
         call check(suite, sentence//' (message: '//error%message//')', .false.)
      else
         call check(suite, sentence, .true.)
      end if
   end subroutine check_no_error

   !> Print the closing line; stop with 1 where a check failed or none ran.
   subroutine finish(suite)
      type(suite_t), intent(in) :: suite   !! counts

      print '(2a,i0,a,i0,a)', suite%name, ': ', suite%passed, ' passed, ', suite%failed, ' failed'
      if (suite%failed > 0 .or. suite%passed == 0) error stop 1
   end subroutine finish
end module testing
