!> The group of ranks: start and end, reductions, gathering, broadcast, and agreement on one error.
module xmpm_communicator
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
   use mpi_f08, only: MPI_Comm, MPI_Op, MPI_COMM_WORLD, MPI_IN_PLACE, MPI_SUM, MPI_MIN, MPI_MAX, &
      MPI_DOUBLE_PRECISION, MPI_INTEGER, MPI_INTEGER8, MPI_CHARACTER, MPI_Init, MPI_Finalize, &
      MPI_Comm_dup, MPI_Comm_free, MPI_Comm_rank, MPI_Comm_size, MPI_Barrier, MPI_Allreduce, &
      MPI_Allgather, MPI_Allgatherv, MPI_Bcast, MPI_Exscan
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t, raise
   use xmpm_text, only: to_text
   implicit none
   private

   public :: comm_t, start_parallel, stop_parallel, wait_for_all
   public :: sum_all, min_all, max_all, gather_all, broadcast, offset_of
   public :: agree_on_error, any_error

   !> A group of ranks that work together.
   type :: comm_t
      type(MPI_Comm) :: handle   !! a plain duplicate of the world communicator
      integer :: rank = 0        !! this rank, from 0
      integer :: size = 1        !! number of ranks
   end type comm_t

   !> Sum over all ranks, in place: `call sum_all(comm, x)`.
   interface sum_all
      module procedure sum_real, sum_reals, sum_table, sum_long, sum_longs
   end interface sum_all

   !> Smallest over all ranks, in place.
   interface min_all
      module procedure min_real, min_reals, min_long, min_longs
   end interface min_all

   !> Largest over all ranks, in place.
   interface max_all
      module procedure max_real, max_reals, max_long, max_longs
   end interface max_all

   !> Arrays of all ranks put together in rank order, the same on every rank.
   interface gather_all
      module procedure gather_reals, gather_longs, gather_integers, gather_columns
   end interface gather_all

   !> Give what rank 0 holds to all ranks; allocatable arguments are allocated as on rank 0.
   interface broadcast
      module procedure broadcast_text, broadcast_real, broadcast_reals, broadcast_columns, &
         broadcast_long, broadcast_longs, broadcast_integer, broadcast_integers
   end interface broadcast

   interface
      subroutine c_exit(code) bind(c, name='exit')
         import :: c_int
         implicit none
         integer(c_int), value :: code
      end subroutine c_exit
   end interface

contains

   !> Start MPI; the communicator is a duplicate of the world's, so that it is nobody else's.
   subroutine start_parallel(comm)
      type(comm_t), intent(out) :: comm   !! all ranks

      call MPI_Init()
      call MPI_Comm_dup(MPI_COMM_WORLD, comm%handle)
      call MPI_Comm_rank(comm%handle, comm%rank)
      call MPI_Comm_size(comm%handle, comm%size)
   end subroutine start_parallel

   !> Wait for all ranks, stop MPI and leave the program with an exit code; does not return.
   subroutine stop_parallel(comm, code)
      type(comm_t), intent(inout) :: comm   !! freed
      integer, intent(in) :: code           !! exit code, the same on every rank

      flush (output_unit)
      flush (error_unit)
      call MPI_Barrier(comm%handle)
      call MPI_Comm_free(comm%handle)
      call MPI_Finalize()
      call c_exit(int(code, c_int))
   end subroutine stop_parallel

   !> Return when every rank has come here.
   subroutine wait_for_all(comm)
      type(comm_t), intent(in) :: comm   !! ranks to wait for

      call MPI_Barrier(comm%handle)
   end subroutine wait_for_all

   !> Number of things that the lower ranks hold: where this rank's slab begins, from 0.
   function offset_of(comm, count) result(offset)
      type(comm_t), intent(in) :: comm     !! ranks
      integer(i8), intent(in) :: count     !! things on this rank
      integer(i8) :: offset

      offset = 0
      call MPI_Exscan(count, offset, 1, MPI_INTEGER8, MPI_SUM, comm%handle)
      if (comm%rank == 0) offset = 0   ! MPI leaves it undefined there
   end function offset_of

   !> Whether some rank holds an error; every rank gets the same answer.
   function any_error(comm, error) result(found)
      type(comm_t), intent(in) :: comm                  !! ranks
      type(error_t), allocatable, intent(in) :: error   !! this rank's failure, if any
      logical :: found
      integer(i8) :: count

      count = merge(1_i8, 0_i8, allocated(error))
      call sum_all(comm, count)
      found = count > 0
   end function any_error

   !> Make all ranks end with the same error, that of the lowest rank that has one, or with none.
   !>
   !> The message names the rank, except where every rank has an error (all read the same deck).
   subroutine agree_on_error(comm, error)
      type(comm_t), intent(in) :: comm                     !! ranks
      type(error_t), allocatable, intent(inout) :: error   !! own failure, then the common one
      character(len=:), allocatable :: message
      integer(i8) :: first, count
      integer :: code, root

      count = merge(1_i8, 0_i8, allocated(error))
      call sum_all(comm, count)
      if (count == 0) return
      first = int(merge(comm%rank, comm%size, allocated(error)), i8)
      call min_all(comm, first)
      root = int(first)
      message = ''
      code = 0
      if (comm%rank == root) then
         code = error%code
         message = error%message
         if (count < int(comm%size, i8)) message = 'rank '//to_text(root)//': '//message
      end if
      call MPI_Bcast(code, 1, MPI_INTEGER, root, comm%handle)
      call broadcast_text(comm, message, root)
      call raise(error, code, message)
   end subroutine agree_on_error

   subroutine sum_real(comm, value)
      type(comm_t), intent(in) :: comm
      real(wp), intent(inout) :: value

      call reduce_real(comm, value, MPI_SUM)
   end subroutine sum_real

   subroutine sum_reals(comm, values)
      type(comm_t), intent(in) :: comm
      real(wp), contiguous, intent(inout) :: values(:)   !! same size on every rank

      call reduce_reals(comm, values, size(values), MPI_SUM)
   end subroutine sum_reals

   subroutine sum_table(comm, values)
      type(comm_t), intent(in) :: comm
      real(wp), contiguous, intent(inout) :: values(:, :)   !! same shape on every rank

      call reduce_reals(comm, values, size(values), MPI_SUM)
   end subroutine sum_table

   subroutine sum_long(comm, value)
      type(comm_t), intent(in) :: comm
      integer(i8), intent(inout) :: value

      call reduce_long(comm, value, MPI_SUM)
   end subroutine sum_long

   subroutine sum_longs(comm, values)
      type(comm_t), intent(in) :: comm
      integer(i8), contiguous, intent(inout) :: values(:)   !! same size on every rank

      call reduce_longs(comm, values, MPI_SUM)
   end subroutine sum_longs

   subroutine min_real(comm, value)
      type(comm_t), intent(in) :: comm
      real(wp), intent(inout) :: value

      call reduce_real(comm, value, MPI_MIN)
   end subroutine min_real

   subroutine min_reals(comm, values)
      type(comm_t), intent(in) :: comm
      real(wp), contiguous, intent(inout) :: values(:)

      call reduce_reals(comm, values, size(values), MPI_MIN)
   end subroutine min_reals

   subroutine min_long(comm, value)
      type(comm_t), intent(in) :: comm
      integer(i8), intent(inout) :: value

      call reduce_long(comm, value, MPI_MIN)
   end subroutine min_long

   subroutine min_longs(comm, values)
      type(comm_t), intent(in) :: comm
      integer(i8), contiguous, intent(inout) :: values(:)

      call reduce_longs(comm, values, MPI_MIN)
   end subroutine min_longs

   subroutine max_real(comm, value)
      type(comm_t), intent(in) :: comm
      real(wp), intent(inout) :: value

      call reduce_real(comm, value, MPI_MAX)
   end subroutine max_real

   subroutine max_reals(comm, values)
      type(comm_t), intent(in) :: comm
      real(wp), contiguous, intent(inout) :: values(:)

      call reduce_reals(comm, values, size(values), MPI_MAX)
   end subroutine max_reals

   subroutine max_long(comm, value)
      type(comm_t), intent(in) :: comm
      integer(i8), intent(inout) :: value

      call reduce_long(comm, value, MPI_MAX)
   end subroutine max_long

   subroutine max_longs(comm, values)
      type(comm_t), intent(in) :: comm
      integer(i8), contiguous, intent(inout) :: values(:)

      call reduce_longs(comm, values, MPI_MAX)
   end subroutine max_longs

   subroutine reduce_real(comm, value, operation)
      type(comm_t), intent(in) :: comm
      real(wp), intent(inout) :: value
      type(MPI_Op), intent(in) :: operation

      call MPI_Allreduce(MPI_IN_PLACE, value, 1, MPI_DOUBLE_PRECISION, operation, comm%handle)
   end subroutine reduce_real

   subroutine reduce_reals(comm, values, n, operation)
      type(comm_t), intent(in) :: comm
      integer, intent(in) :: n
      real(wp), intent(inout) :: values(n)
      type(MPI_Op), intent(in) :: operation

      call MPI_Allreduce(MPI_IN_PLACE, values, n, MPI_DOUBLE_PRECISION, operation, comm%handle)
   end subroutine reduce_reals

   subroutine reduce_long(comm, value, operation)
      type(comm_t), intent(in) :: comm
      integer(i8), intent(inout) :: value
      type(MPI_Op), intent(in) :: operation

      call MPI_Allreduce(MPI_IN_PLACE, value, 1, MPI_INTEGER8, operation, comm%handle)
   end subroutine reduce_long

   subroutine reduce_longs(comm, values, operation)
      type(comm_t), intent(in) :: comm
      integer(i8), contiguous, intent(inout) :: values(:)
      type(MPI_Op), intent(in) :: operation

      call MPI_Allreduce(MPI_IN_PLACE, values, size(values), MPI_INTEGER8, operation, comm%handle)
   end subroutine reduce_longs

   subroutine gather_reals(comm, mine, all)
      type(comm_t), intent(in) :: comm
      real(wp), contiguous, intent(in) :: mine(:)       !! (n) this rank's part, any length
      real(wp), allocatable, intent(out) :: all(:)      !! parts of all ranks in rank order
      integer :: counts(comm%size), starts(comm%size)

      call share_counts(comm, size(mine), counts, starts)
      allocate (all(sum(counts)))
      call MPI_Allgatherv(mine, size(mine), MPI_DOUBLE_PRECISION, all, counts, starts, &
         MPI_DOUBLE_PRECISION, comm%handle)
   end subroutine gather_reals

   subroutine gather_columns(comm, mine, all)
      type(comm_t), intent(in) :: comm
      real(wp), contiguous, intent(in) :: mine(:, :)    !! (m,n) columns of this rank; m common
      real(wp), allocatable, intent(out) :: all(:, :)   !! (m,:) columns of all ranks
      integer :: counts(comm%size), starts(comm%size)

      call share_counts(comm, size(mine), counts, starts)
      allocate (all(size(mine, 1), sum(counts)/max(1, size(mine, 1))))
      call MPI_Allgatherv(mine, size(mine), MPI_DOUBLE_PRECISION, all, counts, starts, &
         MPI_DOUBLE_PRECISION, comm%handle)
   end subroutine gather_columns

   subroutine gather_longs(comm, mine, all)
      type(comm_t), intent(in) :: comm
      integer(i8), contiguous, intent(in) :: mine(:)    !! (n) this rank's part, any length
      integer(i8), allocatable, intent(out) :: all(:)   !! parts of all ranks in rank order
      integer :: counts(comm%size), starts(comm%size)

      call share_counts(comm, size(mine), counts, starts)
      allocate (all(sum(counts)))
      call MPI_Allgatherv(mine, size(mine), MPI_INTEGER8, all, counts, starts, &
         MPI_INTEGER8, comm%handle)
   end subroutine gather_longs

   subroutine gather_integers(comm, mine, all)
      type(comm_t), intent(in) :: comm
      integer, contiguous, intent(in) :: mine(:)     !! (n) this rank's part, any length
      integer, allocatable, intent(out) :: all(:)    !! parts of all ranks in rank order
      integer :: counts(comm%size), starts(comm%size)

      call share_counts(comm, size(mine), counts, starts)
      allocate (all(sum(counts)))
      call MPI_Allgatherv(mine, size(mine), MPI_INTEGER, all, counts, starts, &
         MPI_INTEGER, comm%handle)
   end subroutine gather_integers

   !> How many values each rank gives to a gathering, and where they begin.
   subroutine share_counts(comm, mine, counts, starts)
      type(comm_t), intent(in) :: comm
      integer, intent(in) :: mine
      integer, intent(out) :: counts(comm%size), starts(comm%size)
      integer :: i

      call MPI_Allgather(mine, 1, MPI_INTEGER, counts, 1, MPI_INTEGER, comm%handle)
      starts(1) = 0
      do i = 2, comm%size
         starts(i) = starts(i - 1) + counts(i - 1)
      end do
   end subroutine share_counts

   subroutine broadcast_text(comm, text, root)
      type(comm_t), intent(in) :: comm
      character(len=:), allocatable, intent(inout) :: text   !! of the root, then everybody's
      integer, intent(in), optional :: root                  !! default 0
      integer :: n, from

      from = 0
      if (present(root)) from = root
      n = 0
      if (comm%rank == from) n = len(text)
      call MPI_Bcast(n, 1, MPI_INTEGER, from, comm%handle)
      if (comm%rank /= from) then
         if (allocated(text)) deallocate (text)
         allocate (character(len=n) :: text)
      end if
      if (n > 0) call MPI_Bcast(text, n, MPI_CHARACTER, from, comm%handle)
   end subroutine broadcast_text

   subroutine broadcast_real(comm, value)
      type(comm_t), intent(in) :: comm
      real(wp), intent(inout) :: value

      call MPI_Bcast(value, 1, MPI_DOUBLE_PRECISION, 0, comm%handle)
   end subroutine broadcast_real

   subroutine broadcast_reals(comm, values)
      type(comm_t), intent(in) :: comm
      real(wp), allocatable, intent(inout) :: values(:)
      integer :: n

      n = 0
      if (comm%rank == 0) n = size(values)
      call MPI_Bcast(n, 1, MPI_INTEGER, 0, comm%handle)
      if (comm%rank /= 0) then
         if (allocated(values)) deallocate (values)
         allocate (values(n))
      end if
      call MPI_Bcast(values, n, MPI_DOUBLE_PRECISION, 0, comm%handle)
   end subroutine broadcast_reals

   subroutine broadcast_columns(comm, values)
      type(comm_t), intent(in) :: comm
      real(wp), allocatable, intent(inout) :: values(:, :)
      integer :: extent(2)

      extent = 0
      if (comm%rank == 0) extent = shape(values)
      call MPI_Bcast(extent, 2, MPI_INTEGER, 0, comm%handle)
      if (comm%rank /= 0) then
         if (allocated(values)) deallocate (values)
         allocate (values(extent(1), extent(2)))
      end if
      call MPI_Bcast(values, size(values), MPI_DOUBLE_PRECISION, 0, comm%handle)
   end subroutine broadcast_columns

   subroutine broadcast_long(comm, value)
      type(comm_t), intent(in) :: comm
      integer(i8), intent(inout) :: value

      call MPI_Bcast(value, 1, MPI_INTEGER8, 0, comm%handle)
   end subroutine broadcast_long

   subroutine broadcast_longs(comm, values)
      type(comm_t), intent(in) :: comm
      integer(i8), allocatable, intent(inout) :: values(:)
      integer :: n

      n = 0
      if (comm%rank == 0) n = size(values)
      call MPI_Bcast(n, 1, MPI_INTEGER, 0, comm%handle)
      if (comm%rank /= 0) then
         if (allocated(values)) deallocate (values)
         allocate (values(n))
      end if
      call MPI_Bcast(values, n, MPI_INTEGER8, 0, comm%handle)
   end subroutine broadcast_longs

   subroutine broadcast_integer(comm, value)
      type(comm_t), intent(in) :: comm
      integer, intent(inout) :: value

      call MPI_Bcast(value, 1, MPI_INTEGER, 0, comm%handle)
   end subroutine broadcast_integer

   subroutine broadcast_integers(comm, values)
      type(comm_t), intent(in) :: comm
      integer, allocatable, intent(inout) :: values(:)
      integer :: n

      n = 0
      if (comm%rank == 0) n = size(values)
      call MPI_Bcast(n, 1, MPI_INTEGER, 0, comm%handle)
      if (comm%rank /= 0) then
         if (allocated(values)) deallocate (values)
         allocate (values(n))
      end if
      call MPI_Bcast(values, n, MPI_INTEGER, 0, comm%handle)
   end subroutine broadcast_integers
end module xmpm_communicator
