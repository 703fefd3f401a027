!> Particles of a set by id, each with its part of a loaded surface.
module xmpm_set_table
   use xmpm_kinds, only: wp, i8
   use xmpm_sort, only: sort_order
   implicit none
   private

   public :: load_table_t, build, find

   !> Ids in ascending order, each once.
   type :: load_table_t
      integer(i8), allocatable :: ids(:)     !! (n) ascending
      real(wp), allocatable :: area(:, :)    !! (3,n) outward area vectors [length^2]
      real(wp), allocatable :: offset(:, :)  !! (3,n) from particles to the face [length]
   end type load_table_t

contains

   !> Make a table; areas of an id that comes more than once are added, offsets averaged by area.
   pure subroutine build(table, ids, area, offset)
      type(load_table_t), intent(out) :: table         !! made
      integer(i8), intent(in) :: ids(:)                !! (n) in any order
      real(wp), intent(in) :: area(:, :)               !! (3,n) outward area vectors [length^2]
      real(wp), intent(in), optional :: offset(:, :)   !! (3,n) from particles to the face [length]
      integer, allocatable :: order(:)
      real(wp) :: sizes(size(ids)), own
      integer :: i, k, n

      allocate (order, source=sort_order(ids))
      allocate (table%ids(size(ids)), table%area(3, size(ids)))
      allocate (table%offset(3, size(ids)), source=0.0_wp)
      n = 0
      do i = 1, size(ids)
         k = order(i)
         own = norm2(area(:, k))
         if (n > 0) then
            if (table%ids(n) == ids(k)) then
               table%area(:, n) = table%area(:, n) + area(:, k)
               sizes(n) = sizes(n) + own
               if (present(offset)) table%offset(:, n) = table%offset(:, n) &
                  + own/max(sizes(n), tiny(1.0_wp))*(offset(:, k) - table%offset(:, n))
               cycle
            end if
         end if
         n = n + 1
         table%ids(n) = ids(k)
         table%area(:, n) = area(:, k)
         sizes(n) = own
         if (present(offset)) table%offset(:, n) = offset(:, k)
      end do
      table%ids = table%ids(:n)
      table%area = table%area(:, :n)
      table%offset = table%offset(:, :n)
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
end module xmpm_set_table
