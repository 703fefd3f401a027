!> Sums over the rows that several ranks share.
!>
!> Every rank that shares a row gets the parts of all others and adds them in rank order, its own
!> part at its own place, so that all hold the same bits.
module xmpm_halo
   use mpi_f08, only: MPI_Comm, MPI_Request, MPI_DOUBLE_PRECISION, MPI_INTEGER, &
      MPI_STATUSES_IGNORE, &
      MPI_Irecv, MPI_Isend, MPI_Waitall
   use xmpm_kinds, only: wp
   use xmpm_communicator, only: comm_t
   implicit none
   private

   public :: halo_t, make_halo, start_sum, finish_sum, merge_bits, take_largest

   integer, parameter :: tag = 71

   !> Which rows are shared with whom.
   type :: halo_t
      integer :: n = 0                          !! neighbours
      integer :: rank = 0                       !! this rank
      integer, allocatable :: ranks(:)          !! (n) ranks, ascending
      integer, allocatable :: first(:)          !! (n+1) where each one's rows begin
      integer, allocatable :: rows(:)           !! rows by neighbour, in an order both agree on
      integer, allocatable :: shared(:)         !! every shared row once
      real(wp), allocatable :: own(:, :)        !! this rank's parts while a sum is under way
      real(wp), allocatable :: send(:, :)       !! what goes out, by place in `rows`
      real(wp), allocatable :: receive(:, :)    !! what comes in, by place in `rows`
      type(MPI_Request), allocatable :: requests(:)
   end type halo_t

contains

   !> A halo from the list of neighbours and the rows shared with each.
   subroutine make_halo(halo, rank, ranks, first, rows, n_rows)
      type(halo_t), intent(inout) :: halo   !! made anew
      integer, intent(in) :: rank           !! this rank
      integer, intent(in) :: ranks(:)       !! neighbours, ascending
      integer, intent(in) :: first(:)       !! (neighbours+1) where each one's rows begin
      integer, intent(in) :: rows(:)        !! rows by neighbour
      integer, intent(in) :: n_rows         !! rows of this rank
      logical, allocatable :: seen(:)
      integer :: i, n

      halo%n = size(ranks)
      halo%rank = rank
      halo%ranks = ranks
      halo%first = first
      halo%rows = rows
      allocate (seen(n_rows), source=.false.)
      n = 0
      if (allocated(halo%shared)) deallocate (halo%shared)
      allocate (halo%shared(size(rows)))
      do i = 1, size(rows)
         if (seen(rows(i))) cycle
         seen(rows(i)) = .true.
         n = n + 1
         halo%shared(n) = rows(i)
      end do
      halo%shared = halo%shared(:n)
      if (allocated(halo%requests)) deallocate (halo%requests)
      allocate (halo%requests(2*halo%n))
   end subroutine make_halo

   !> Send this rank's parts of some values of the shared rows.
   subroutine start_sum(halo, comm, values, low, high)
      type(halo_t), intent(inout) :: halo
      type(comm_t), intent(in) :: comm
      real(wp), intent(in) :: values(:, :)   !! (fields,rows)
      integer, intent(in) :: low, high       !! first and last field that is summed
      integer :: i, k, a, b, n

      if (halo%n == 0) return
      n = high - low + 1
      call fit(halo, n)
      do i = 1, size(halo%shared)
         halo%own(:, i) = values(low:high, halo%shared(i))
      end do
      do i = 1, size(halo%rows)
         halo%send(:, i) = values(low:high, halo%rows(i))
      end do
      do k = 1, halo%n
         a = halo%first(k)
         b = halo%first(k + 1) - 1
         call MPI_Irecv(halo%receive(:, a:b), n*(b - a + 1), MPI_DOUBLE_PRECISION, halo%ranks(k), &
            tag, comm%handle, halo%requests(k))
         call MPI_Isend(halo%send(:, a:b), n*(b - a + 1), MPI_DOUBLE_PRECISION, halo%ranks(k), &
            tag, comm%handle, halo%requests(halo%n + k))
      end do
   end subroutine start_sum

   !> Wait for the parts of the neighbours and add all parts in rank order.
   subroutine finish_sum(halo, values, low, high)
      type(halo_t), intent(inout) :: halo
      real(wp), intent(inout) :: values(:, :)   !! (fields,rows)
      integer, intent(in) :: low, high          !! as given to start_sum
      integer :: i, k

      if (halo%n == 0) return
      call MPI_Waitall(2*halo%n, halo%requests, MPI_STATUSES_IGNORE)
      do i = 1, size(halo%shared)
         values(low:high, halo%shared(i)) = 0
      end do
      do k = 1, halo%n
         if (halo%ranks(k) < halo%rank) call add_parts(halo, k, values, low, high)
      end do
      do i = 1, size(halo%shared)
         values(low:high, halo%shared(i)) = values(low:high, halo%shared(i)) + halo%own(:, i)
      end do
      do k = 1, halo%n
         if (halo%ranks(k) > halo%rank) call add_parts(halo, k, values, low, high)
      end do
   end subroutine finish_sum

   !> The largest value among all sharing ranks, field by field.
   subroutine take_largest(halo, comm, values)
      type(halo_t), intent(inout) :: halo
      type(comm_t), intent(in) :: comm
      real(wp), intent(inout) :: values(:, :)   !! (fields,rows)
      integer :: i

      if (halo%n == 0) return
      call start_sum(halo, comm, values, 1, size(values, 1))
      call MPI_Waitall(2*halo%n, halo%requests, MPI_STATUSES_IGNORE)
      do i = 1, size(halo%rows)
         values(:, halo%rows(i)) = max(values(:, halo%rows(i)), halo%receive(:, i))
      end do
   end subroutine take_largest

   pure subroutine add_parts(halo, k, values, low, high)
      type(halo_t), intent(in) :: halo
      integer, intent(in) :: k, low, high
      real(wp), intent(inout) :: values(:, :)
      integer :: i

      do i = halo%first(k), halo%first(k + 1) - 1
         values(low:high, halo%rows(i)) = values(low:high, halo%rows(i)) + halo%receive(:, i)
      end do
   end subroutine add_parts

   !> Buffers for `n` fields.
   pure subroutine fit(halo, n)
      type(halo_t), intent(inout) :: halo
      integer, intent(in) :: n

      if (allocated(halo%own)) then
         if (size(halo%own, 1) == n .and. size(halo%own, 2) == size(halo%shared) &
            .and. size(halo%send, 2) == size(halo%rows)) return
         deallocate (halo%own, halo%send, halo%receive)
      end if
      allocate (halo%own(n, size(halo%shared)))
      allocate (halo%send(n, size(halo%rows)), halo%receive(n, size(halo%rows)))
   end subroutine fit

   !> Or together the bits that all sharing ranks hold of the shared rows.
   subroutine merge_bits(halo, comm, bits)
      type(halo_t), intent(inout) :: halo
      type(comm_t), intent(in) :: comm
      integer, intent(inout) :: bits(:)   !! (rows)
      integer, allocatable :: out(:), in(:)
      integer :: i, k, a, b

      if (halo%n == 0) return
      allocate (out(size(halo%rows)), in(size(halo%rows)))
      out = bits(halo%rows)
      do k = 1, halo%n
         a = halo%first(k)
         b = halo%first(k + 1) - 1
         call MPI_Irecv(in(a:b), b - a + 1, MPI_INTEGER, halo%ranks(k), tag, comm%handle, &
            halo%requests(k))
         call MPI_Isend(out(a:b), b - a + 1, MPI_INTEGER, halo%ranks(k), tag, comm%handle, &
            halo%requests(halo%n + k))
      end do
      call MPI_Waitall(2*halo%n, halo%requests, MPI_STATUSES_IGNORE)
      do i = 1, size(halo%rows)
         bits(halo%rows(i)) = ior(bits(halo%rows(i)), in(i))
      end do
   end subroutine merge_bits
end module xmpm_halo
