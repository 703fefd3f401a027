!> Particles of a set by id, each with its part of a loaded surface.
module xmpm_set_table
   use xmpm_kinds, only: wp, i8
   implicit none
   private

   public :: load_table_t, build, find

   !> Ids in ascending order, each once.
   type :: load_table_t
      integer(i8), allocatable :: ids(:)     !! (n) ascending
      real(wp), allocatable :: area(:, :)    !! (3,n) outward area vectors [length^2]
   end type load_table_t

contains

   !> Make a table; areas of an id that comes more than once are added.
   pure subroutine build(table, ids, area)
      type(load_table_t), intent(out) :: table   !! made
      integer(i8), intent(in) :: ids(:)          !! (n) in any order
      real(wp), intent(in) :: area(:, :)         !! (3,n) outward area vectors [length^2]
      integer, allocatable :: order(:)
      integer :: i, n

      allocate (order, source=sorted_order(ids))
      allocate (table%ids(size(ids)), table%area(3, size(ids)))
      n = 0
      do i = 1, size(ids)
         if (n > 0) then
            if (table%ids(n) == ids(order(i))) then
               table%area(:, n) = table%area(:, n) + area(:, order(i))
               cycle
            end if
         end if
         n = n + 1
         table%ids(n) = ids(order(i))
         table%area(:, n) = area(:, order(i))
      end do
      table%ids = table%ids(:n)
      table%area = table%area(:, :n)
   end subroutine build

   !> Place of an id in the table, 0 where it is not in the set.
   pure function find(table, id) result(place)
      type(load_table_t), intent(in) :: table   !! searched
      integer(i8), intent(in) :: id             !! looked up
      integer :: place, low, high

      place = 0
      if (.not. allocated(table%ids)) return
      low = 1
      high = size(table%ids)
      do while (low <= high)
         place = low + (high - low)/2
         if (table%ids(place) == id) return
         if (table%ids(place) < id) then
            low = place + 1
         else
            high = place - 1
         end if
      end do
      place = 0
   end function find

   !> Order that sorts ids, equal ones staying in order: merging of runs of 1, 2, 4, ...
   pure function sorted_order(ids) result(order)
      integer(i8), intent(in) :: ids(:)
      integer, allocatable :: order(:)
      integer, allocatable :: merged(:)
      integer :: n, width, first, middle, last, i

      n = size(ids)
      order = [(i, i=1, n)]
      allocate (merged(n))
      width = 1
      do while (width < n)
         do first = 1, n, 2*width
            middle = min(first + width, n + 1)
            last = min(first + 2*width, n + 1)
            call merge_runs(ids, order(first:middle - 1), order(middle:last - 1), &
               merged(first:last - 1))
         end do
         order = merged
         width = 2*width
      end do
   end function sorted_order

   pure subroutine merge_runs(ids, left, right, merged)
      integer(i8), intent(in) :: ids(:)
      integer, intent(in) :: left(:), right(:)
      integer, intent(out) :: merged(:)
      integer :: i, l, r
      logical :: take_left

      l = 1
      r = 1
      do i = 1, size(merged)
         take_left = r > size(right)
         if (.not. take_left .and. l <= size(left)) take_left = ids(left(l)) <= ids(right(r))
         if (take_left) then
            merged(i) = left(l)
            l = l + 1
         else
            merged(i) = right(r)
            r = r + 1
         end if
      end do
   end subroutine merge_runs
end module xmpm_set_table
