!> Reductions, gathering, broadcast and agreement on errors, on any number of ranks.
! ranks: 1 2 3
program test_communicator
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t, raise, code_files
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, sum_all, min_all, max_all, &
      gather_all, broadcast, offset_of, agree_on_error, any_error
   use xmpm_text, only: to_text
   use testing, only: suite_t, check, check_error, check_no_error, finish
   implicit none
   type(comm_t) :: comm
   type(suite_t) :: suite

   call start_parallel(comm)
   suite%name = 'communicator'
   call test_reductions(suite, comm)
   call test_gathering(suite, comm)
   call test_broadcast(suite, comm)
   call test_agreement(suite, comm)
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> All values are small whole numbers, so that equality is exact.
   subroutine test_reductions(suite, comm)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      real(wp) :: x, pair(2), table(2, 2)
      integer(i8) :: k, ks(2)
      integer :: n

      n = comm%size
      x = real(comm%rank + 1, wp)
      call sum_all(comm, x)
      call check(suite, 'ranks 1 to n sum to n(n+1)/2', nint(x) == n*(n + 1)/2)
      pair = [real(comm%rank, wp), -real(comm%rank, wp)]
      call min_all(comm, pair)
      call check(suite, 'the smallest is taken value by value', all(nint(pair) == [0, 1 - n]))
      pair = [real(comm%rank, wp), -real(comm%rank, wp)]
      call max_all(comm, pair)
      call check(suite, 'the largest is taken value by value', all(nint(pair) == [n - 1, 0]))
      table = real(comm%rank, wp)
      call sum_all(comm, table)
      call check(suite, 'tables sum too', all(nint(table) == n*(n - 1)/2))
      k = 2_i8**40
      call sum_all(comm, k)
      call check(suite, 'counts beyond 32 bits are summed', k == int(n, i8)*2_i8**40)
      ks = [int(comm%rank, i8), 7_i8]
      call max_all(comm, ks)
      call check(suite, 'integers have a largest', all(int(ks) == [n - 1, 7]))
      k = offset_of(comm, int(comm%rank + 1, i8))
      call check(suite, 'a slab begins behind those of the lower ranks', &
         int(k) == comm%rank*(comm%rank + 1)/2)
   end subroutine test_reductions

   !> Rank r gives r values, so that rank 0 gives none.
   subroutine test_gathering(suite, comm)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      integer(i8), allocatable :: all_ids(:)
      real(wp), allocatable :: values(:), table(:, :), columns(:, :)
      integer :: i, n

      n = comm%size*(comm%size - 1)/2
      call gather_all(comm, [(int(10*comm%rank + i, i8), i=1, comm%rank)], all_ids)
      call check(suite, 'parts of any length are gathered', size(all_ids) == n)
      call check(suite, 'gathered ids stand in rank order', all(all_ids(2:) > all_ids(:n - 1)))
      call gather_all(comm, [(real(comm%rank, wp), i=1, comm%rank)], values)
      call check(suite, 'gathered reals are those that were given', &
         nint(sum(values)) == sum([(i*i, i=0, comm%size - 1)]))
      table = reshape([(real(comm%rank, wp), i=1, 3*comm%rank)], [3, comm%rank])
      call gather_all(comm, table, columns)
      call check(suite, 'columns keep their length', all(shape(columns) == [3, n]))
   end subroutine test_gathering

   subroutine test_broadcast(suite, comm)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      character(len=:), allocatable :: text
      real(wp), allocatable :: table(:, :)
      integer(i8), allocatable :: ids(:)

      if (comm%rank == 0) then
         text = 'line 1'//new_line('a')//'line 2 '
         table = reshape([1.0_wp, 2.0_wp, 3.0_wp], [1, 3])
         allocate (ids(0))
      end if
      call broadcast(comm, text)
      call broadcast(comm, table)
      call broadcast(comm, ids)
      call check(suite, 'text arrives with its line ends and blanks', &
         text == 'line 1'//new_line('a')//'line 2 ' .and. len(text) == 14)
      call check(suite, 'tables arrive with their shape', all(shape(table) == [1, 3]))
      call check(suite, 'empty arrays arrive', size(ids) == 0)
   end subroutine test_broadcast

   subroutine test_agreement(suite, comm)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      type(error_t), allocatable :: error

      call check(suite, 'no rank sees an error where there is none', .not. any_error(comm, error))
      call agree_on_error(comm, error)
      call check_no_error(suite, 'ranks without errors agree on none', error)
      if (comm%rank == comm%size - 1) call raise(error, code_files, 'x.h5: no such file')
      call check(suite, 'every rank sees the error of one', any_error(comm, error))
      call agree_on_error(comm, error)
      call check_error(suite, 'all ranks get the message of one', error, 'x.h5: no such file')
      call check(suite, 'the error code comes along', error%code == code_files)
      call check(suite, 'the message names the rank where only some failed', &
         (index(error%message, 'rank ') == 1) .eqv. comm%size > 1)
      call raise(error, code_files, 'failed on rank '//to_text(comm%rank))
      call agree_on_error(comm, error)
      call check(suite, 'the lowest rank wins', error%message == 'failed on rank 0')
   end subroutine test_agreement
end program test_communicator
