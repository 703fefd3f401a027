!> Stable sorting of 64-bit keys.
module xmpm_sort
   use xmpm_kinds, only: i8
   implicit none
   private

   public :: sort_order, unique_sorted

contains

   !> Order in which keys ascend; equal keys keep their order (merge sort).
   pure function sort_order(keys) result(order)
      integer(i8), intent(in) :: keys(:)
      integer :: order(size(keys))
      integer :: spare(size(keys)), n, width, low, middle, high

      n = size(keys)
      order = [(low, low=1, n)]
      width = 1
      do while (width < n)
         do low = 1, n, 2*width
            middle = min(low + width, n + 1)
            high = min(low + 2*width, n + 1)
            call merge_runs(keys, order, spare, low, middle, high)
         end do
         order = spare
         width = 2*width
      end do
   end function sort_order

   !> Merge the ascending runs low:middle-1 and middle:high-1.
   pure subroutine merge_runs(keys, order, spare, low, middle, high)
      integer(i8), intent(in) :: keys(:)
      integer, intent(in) :: order(:), low, middle, high
      integer, intent(inout) :: spare(:)
      integer :: a, b, n
      logical :: take_a

      a = low
      b = middle
      do n = low, high - 1
         take_a = b >= high
         if (.not. take_a .and. a < middle) take_a = keys(order(a)) <= keys(order(b))
         if (take_a) then
            spare(n) = order(a)
            a = a + 1
         else
            spare(n) = order(b)
            b = b + 1
         end if
      end do
   end subroutine merge_runs

   !> The different keys, ascending.
   pure function unique_sorted(keys) result(unique)
      integer(i8), intent(in) :: keys(:)
      integer(i8), allocatable :: unique(:)
      integer(i8), allocatable :: sorted(:)
      integer :: i, n

      allocate (sorted(size(keys)))
      sorted = keys(sort_order(keys))
      n = 0
      do i = 1, size(sorted)
         if (i > 1) then
            if (sorted(i) == sorted(n)) cycle
         end if
         n = n + 1
         sorted(n) = sorted(i)
      end do
      unique = sorted(:n)
   end function unique_sorted
end module xmpm_sort
