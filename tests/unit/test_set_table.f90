!> Tables of loaded particles: every id is found, no other is, areas stay with their ids.
program test_set_table
   use xmpm_kinds, only: wp, i8
   use xmpm_set_table, only: load_table_t, build, find
   use testing, only: suite_t, check, check_close, finish
   implicit none
   type(suite_t) :: suite

   suite%name = 'set_table'
   call test_search(0)
   call test_search(1)
   call test_search(1000)
   call test_large_ids()
   call test_repeated()
   call check(suite, 'a table that was not built holds nothing', find(load_table_t(), 1_i8) == 0)
   call finish(suite)

contains

   !> Ids 3, 10, 17, ... in an order that jumps about; the area tells the id.
   subroutine test_search(n)
      integer, intent(in) :: n
      type(load_table_t) :: table
      integer(i8) :: ids(n), id
      real(wp) :: area(3, n)
      integer :: i, wrong, place

      do i = 1, n
         ids(i) = int(3 + 7*modulo(389*i, n), i8)
         area(:, i) = real(ids(i), wp)*[1.0_wp, 2.0_wp, -1.0_wp]
      end do
      call build(table, ids, area)
      wrong = 0
      do id = -5_i8, 7_i8*int(n, i8) + 10
         place = find(table, id)
         if (place > 0) then
            if (abs(table%area(2, place) - 2*real(id, wp)) > 0.0_wp) wrong = wrong + 1
         end if
         if (any(ids == id) .neqv. place > 0) wrong = wrong + 1
      end do
      call check(suite, 'exactly the ids of the set are found, with their areas', wrong == 0)
      call check(suite, 'ids ascend', all(table%ids(2:) > table%ids(:n - 1)))
   end subroutine test_search

   subroutine test_large_ids()
      type(load_table_t) :: table

      call build(table, [9000000000_i8, 8000000000_i8], reshape([1.0_wp, 1.0_wp, 1.0_wp, 2.0_wp, &
         2.0_wp, 2.0_wp], [3, 2]))
      call check(suite, 'ids may pass 32 bits', find(table, 9000000000_i8) == 2)
   end subroutine test_large_ids

   subroutine test_repeated()
      type(load_table_t) :: table
      real(wp) :: offset(3, 3)

      call build(table, [4_i8, 2_i8, 4_i8], reshape([1.0_wp, 0.0_wp, 0.0_wp, 5.0_wp, 5.0_wp, &
         5.0_wp, 0.0_wp, 3.0_wp, 0.0_wp], [3, 3]))
      call check(suite, 'an id that comes twice stands once', size(table%ids) == 2)
      call check_close(suite, 'with the sum of its areas', sum(table%area(:, find(table, 4_i8))), &
         4.0_wp, 0.0_wp, 0.0_wp)
      call check(suite, 'without offsets they are zero', all(abs(table%offset) <= 0.0_wp))
      offset = reshape([4.0_wp, 0.0_wp, 0.0_wp, 7.0_wp, 7.0_wp, 7.0_wp, 0.0_wp, 8.0_wp, 0.0_wp], &
         [3, 3])
      call build(table, [4_i8, 2_i8, 4_i8], reshape([1.0_wp, 0.0_wp, 0.0_wp, 5.0_wp, 5.0_wp, &
         5.0_wp, 0.0_wp, 3.0_wp, 0.0_wp], [3, 3]), offset)
      call check(suite, 'an offset stays with its id', all(abs(table%offset(:, find(table, 2_i8)) &
         - 7.0_wp) <= 0.0_wp))
      call check(suite, 'offsets of an id are averaged by area: 1/4 of one, 3/4 of the other', &
         all(abs(table%offset(:, find(table, 4_i8)) - [1.0_wp, 6.0_wp, 0.0_wp]) <= 1.0e-14_wp))
   end subroutine test_repeated
end program test_set_table
