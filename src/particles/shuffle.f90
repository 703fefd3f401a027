!> Transposition of small arrays in vector registers.
!>
!> Riffling the two halves of a list of 2**n numbers turns the n bits of a place by one. Three
!> riffles of 64 numbers therefore exchange the two indices of an 8 x 8 array, and each is one
!> instruction a vector.
module xmpm_shuffle
   use xmpm_kinds, only: wp
   implicit none
   private

   public :: turn, turn_4

contains

   !> Transpose an 8 x 8 array in place.
   pure subroutine turn(a)
      real(wp), intent(inout) :: a(64)   !! (8,8)
      real(wp) :: b(64), c(64)
      integer :: i

      do i = 1, 32
         b(2*i - 1) = a(i)
         b(2*i) = a(i + 32)
      end do
      do i = 1, 32
         c(2*i - 1) = b(i)
         c(2*i) = b(i + 32)
      end do
      do i = 1, 32
         a(2*i - 1) = c(i)
         a(2*i) = c(i + 32)
      end do
   end subroutine turn

   !> Transpose an 8 x 4 array.
   pure subroutine turn_4(a, b)
      real(wp), intent(in) :: a(32)    !! (8,4)
      real(wp), intent(out) :: b(32)   !! (4,8)
      real(wp) :: c(32)
      integer :: i

      do i = 1, 16
         c(2*i - 1) = a(i)
         c(2*i) = a(i + 16)
      end do
      do i = 1, 16
         b(2*i - 1) = c(i)
         b(2*i) = c(i + 16)
      end do
   end subroutine turn_4
end module xmpm_shuffle
