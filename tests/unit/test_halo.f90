!> Sums over shared rows are whole, and the same bits on every rank that holds the row.
! ranks: 1 2 3
program test_halo
   use xmpm_kinds, only: wp, i8
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, gather_all
   use xmpm_halo, only: halo_t, make_halo, start_sum, finish_sum, merge_bits
   use testing, only: suite_t, check, finish
   implicit none
   integer, parameter :: n = 40            !! nodes of the whole
   type(comm_t) :: comm
   type(suite_t) :: suite
   type(halo_t) :: halo
   real(wp), allocatable :: part(:, :, :)   !! (rank,node,field) what each rank brings
   integer :: round

   call start_parallel(comm)
   suite%name = 'halo'
   call share_rows(halo)
   call make_parts()
   do round = 1, 3
      call test_sum(suite, round)
   end do
   call test_bits(suite)
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> Whether a rank holds a node: all hold multiples of 4, and each some of the others.
   pure function holds(rank, node) result(is)
      integer, intent(in) :: rank, node
      logical :: is

      is = mod(node, 4) == 0 .or. mod(node, comm%size) == rank .or. mod(node, 7) == rank
   end function holds

   !> Row of a node: the nodes of a rank are numbered backwards, so that rows differ between ranks.
   pure function row_of(rank, node) result(row)
      integer, intent(in) :: rank, node
      integer :: row, i

      row = count([(holds(rank, i), i=node, n)])
   end function row_of

   subroutine share_rows(halo)
      type(halo_t), intent(inout) :: halo
      integer, allocatable :: ranks(:), first(:), rows(:)
      integer :: r, i

      ranks = pack([(r, r=0, comm%size - 1)], [(r /= comm%rank, r=0, comm%size - 1)])
      allocate (rows(0))
      first = [1]
      do r = 1, size(ranks)
         do i = 1, n
            if (holds(comm%rank, i) .and. holds(ranks(r), i)) rows = [rows, row_of(comm%rank, i)]
         end do
         first = [first, size(rows) + 1]
      end do
      call make_halo(halo, comm%rank, ranks, first, rows, row_of(comm%rank, 1))
   end subroutine share_rows

   !> Parts of all ranks, of magnitudes that make the order of summation count.
   subroutine make_parts()
      integer :: r, i, f

      allocate (part(0:comm%size - 1, n, 5))
      do f = 1, 5
         do i = 1, n
            do r = 0, comm%size - 1
               part(r, i, f) = real(mod(7919*(i + 41*r + 301*f), 10007) - 5003, wp)/7 &
                  *10.0_wp**(mod(5*r + i, 9) - 4)
            end do
         end do
      end do
   end subroutine make_parts

   !> Fields 2 to 2 + width of five; the others stay.
   subroutine test_sum(suite, width)
      type(suite_t), intent(inout) :: suite
      integer, intent(in) :: width
      real(wp), allocatable :: values(:, :)
      integer(i8), allocatable :: bits(:), everyone(:)
      real(wp) :: expected
      integer :: i, r, f, high
      logical :: whole, untouched, same

      high = 1 + width
      allocate (values(5, row_of(comm%rank, 1)), source=0.0_wp)
      allocate (bits(n*width))
      do i = 1, n
         if (.not. holds(comm%rank, i)) cycle
         values(:, row_of(comm%rank, i)) = part(comm%rank, i, :)
      end do
      call start_sum(halo, comm, values, 2, high)
      call finish_sum(halo, values, 2, high)
      whole = .true.
      untouched = .true.
      bits = 0
      do i = 1, n
         if (.not. holds(comm%rank, i)) cycle
         do f = 1, 5
            associate (value => values(f, row_of(comm%rank, i)))
               if (f < 2 .or. f > high) then
                  untouched = untouched .and. abs(value - part(comm%rank, i, f)) <= 0
                  cycle
               end if
               ! In rank order, which is the order that the sum promises: equal to the bit.
               expected = 0
               do r = 0, comm%size - 1
                  if (holds(r, i)) expected = expected + part(r, i, f)
               end do
               whole = whole .and. abs(value - expected) <= 0
               bits(width*(i - 1) + f - 1) = transfer(value, 0_i8)
            end associate
         end do
      end do
      call check(suite, 'shared rows hold the sum over ranks, in rank order', whole)
      call check(suite, 'other fields stay', untouched)
      call gather_all(comm, bits, everyone)
      same = .true.
      do r = 0, comm%size - 1
         do i = 1, n
            if (.not. (holds(r, i) .and. holds(comm%rank, i))) cycle
            same = same .and. all(everyone(r*n*width + width*(i - 1) + 1:r*n*width + width*i) &
               == bits(width*(i - 1) + 1:width*i))
         end do
      end do
      call check(suite, 'all ranks hold the same bits', same)
   end subroutine test_sum

   !> Bits are joined over all ranks that share a row.
   subroutine test_bits(suite)
      type(suite_t), intent(inout) :: suite
      integer, allocatable :: bits(:)
      integer :: i, r, expected
      logical :: joined

      allocate (bits(row_of(comm%rank, 1)))
      bits = ibset(0, comm%rank)
      call merge_bits(halo, comm, bits)
      joined = .true.
      do i = 1, n
         if (.not. holds(comm%rank, i)) cycle
         expected = 0
         do r = 0, comm%size - 1
            if (holds(r, i)) expected = ibset(expected, r)
         end do
         joined = joined .and. bits(row_of(comm%rank, i)) == expected
      end do
      call check(suite, 'bits are joined over the ranks that share a row', joined)
   end subroutine test_bits
end program test_halo
