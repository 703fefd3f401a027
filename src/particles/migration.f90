!> Particles that leave their bin: to another bin of this rank, or to another rank.
module xmpm_migration
   use mpi_f08, only: MPI_Request, MPI_DOUBLE_PRECISION, MPI_INTEGER, MPI_INTEGER8, &
      MPI_STATUSES_IGNORE, MPI_Irecv, MPI_Isend, MPI_Waitall
   use xmpm_kinds, only: wp, i8
   use xmpm_communicator, only: comm_t
   use xmpm_lattice, only: bin_of, bin_corner, block_of, local_bin, bins_per_block
   use xmpm_blocks, only: local_block, owner_of
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, record_t, append_particle, read_record, remove_lane, &
      move_lane, new_to_bin, bin_of_chunk, n_hot, n_near, near_crack, c_x
   use xmpm_fetch_ahead, only: fetch_chunk
   implicit none
   private

   public :: outbox_t, rebin, put_into_outbox, insert_own, exchange, unload_block, insert_record

   integer, parameter :: n_whole = 3   !! integers of a packed particle: id, sets, body

   !> Particles on their way out of this rank.
   type :: outbox_t
      integer :: n = 0                           !! particles in it
      type(record_t), allocatable :: records(:)  !! the particles
   end type outbox_t

contains

   !> Put every particle of the listed chunks into the bin it is in; those of other ranks, or of
   !> blocks that nobody owns yet, go into the outbox.
   subroutine rebin(p, grid, movers, outbox, near_moved)
      type(particles_t), intent(inout) :: p
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: movers(:)          !! chunks that particles left
      type(outbox_t), intent(inout) :: outbox
      logical, intent(inout) :: near_moved      !! set where a particle near a crack changed its
                                                !! bin,
                                                !! or the first of a contact group came to a bin
      type(record_t) :: record
      real(wp) :: middle(3)
      integer :: i, c, lane, b, to

      do i = 1, size(movers)
         c = movers(i)
         if (i < size(movers)) call fetch_chunk(p, movers(i + 1))
         middle = bin_corner(grid%lattice, bin_of_chunk(p, grid%blocks, c)) &
            + 0.5_wp*grid%lattice%size
         lane = p%count(c)
         do while (lane > 0)
            if (is_within(p, lane, c, middle, 0.5_wp*grid%lattice%size)) then
               lane = lane - 1
               cycle
            end if
            call find_bin(p, grid, lane, c, b, to)
            if (to == p%bin(c)) then
               lane = lane - 1
               cycle
            end if
            if (knows_crack(p, lane, c)) near_moved = .true.
            if (b > 0) then
               if (allocated(p%group) .and. .not. near_moved) then
                  near_moved = new_to_bin(p, to, p%body(c))
               end if
               call move_lane(p, grid%lattice, grid%blocks, lane, c, to)
            else
               call read_record(p, lane, c, record)
               call put_into_outbox(outbox, record)
               call remove_lane(p, grid%lattice, grid%blocks, lane, c)
            end if
            lane = min(lane, p%count(c))   ! another particle of the bin may have taken the lane
         end do
      end do
   end subroutine rebin

   !> Whether a particle is inside its bin; most of those that share a chunk with one that left are.
   pure function is_within(p, lane, chunk, middle, reach) result(within)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: lane, chunk
      real(wp), intent(in) :: middle(3)   !! of the bin [length]
      real(wp), intent(in) :: reach       !! half the bin's width [length]
      logical :: within

      within = max(abs(p%q(lane, 1, chunk) - middle(1)), abs(p%q(lane, 2, chunk) - middle(2)), &
         abs(p%q(lane, 3, chunk) - middle(3))) < reach
   end function is_within

   !> Where a particle is now: block of this rank and bin, both 0 where the block is not its own.
   pure subroutine find_bin(p, grid, lane, chunk, b, to)
      type(particles_t), intent(in) :: p
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: lane, chunk
      integer, intent(out) :: b    !! block
      integer, intent(out) :: to   !! 64 (block - 1) + bin of the block
      integer :: bin(3), place(3)

      bin = bin_of(grid%lattice, p%q(lane, c_x:c_x + 2, chunk))
      place = block_of(bin)
      b = 1 + (p%bin(chunk) - 1)/bins_per_block
      if (any(place /= grid%blocks%place(:, b))) b = local_block(grid%blocks, place)
      to = 0
      if (b > 0) to = bins_per_block*(b - 1) + local_bin(bin)
   end subroutine find_bin

   !> Whether a particle is near a crack.
   pure function knows_crack(p, lane, chunk) result(knows)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: lane, chunk
      logical :: knows

      knows = .false.
      if (p%attached(chunk) == 0) return
      knows = any(p%near(lane, near_crack:n_near*p%slots:n_near, p%attached(chunk)) > 0)
   end function knows_crack

   !> Add a particle to the outbox.
   subroutine put_into_outbox(outbox, record)
      type(outbox_t), intent(inout) :: outbox
      type(record_t), intent(in) :: record
      type(record_t), allocatable :: longer(:)

      if (.not. allocated(outbox%records)) allocate (outbox%records(64))
      if (outbox%n == size(outbox%records)) then
         allocate (longer(2*outbox%n))
         longer(:outbox%n) = outbox%records
         call move_alloc(longer, outbox%records)
      end if
      outbox%n = outbox%n + 1
      outbox%records(outbox%n) = record
   end subroutine put_into_outbox

   !> Take all particles of a block into the outbox.
   subroutine unload_block(p, grid, b, outbox)
      type(particles_t), intent(inout) :: p
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: b               !! block of this rank
      type(outbox_t), intent(inout) :: outbox
      type(record_t) :: record
      integer :: k, c

      do k = 1, bins_per_block
         do while (p%head(k, b) > 0)
            c = p%head(k, b)
            call read_record(p, 1, c, record)
            call put_into_outbox(outbox, record)
            call remove_lane(p, grid%lattice, grid%blocks, 1, c)
         end do
      end do
   end subroutine unload_block

   !> Put a particle into the bin it is in, which must be this rank's.
   subroutine insert_record(p, grid, record)
      type(particles_t), intent(inout) :: p
      type(grid_t), intent(in) :: grid
      type(record_t), intent(in) :: record
      integer :: bin(3), b

      bin = bin_of(grid%lattice, record%hot(c_x:c_x + 2))
      b = local_block(grid%blocks, block_of(bin))
      call append_particle(p, grid%lattice, grid%blocks, &
         bins_per_block*(b - 1) + local_bin(bin), record)
   end subroutine insert_record

   !> Take back from the outbox what is this rank's after the blocks were laid out anew.
   subroutine insert_own(p, grid, rank, outbox)
      type(particles_t), intent(inout) :: p
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: rank
      type(outbox_t), intent(inout) :: outbox
      integer :: i, n

      n = 0
      do i = 1, outbox%n
         if (destination(grid, outbox%records(i)) == rank) then
            call insert_record(p, grid, outbox%records(i))
         else
            n = n + 1
            if (n < i) outbox%records(n) = outbox%records(i)
         end if
      end do
      outbox%n = n
   end subroutine insert_own

   !> Rank that owns the block a particle is in, or -1.
   pure function destination(grid, record) result(rank)
      type(grid_t), intent(in) :: grid
      type(record_t), intent(in) :: record
      integer :: rank

      rank = owner_of(grid%blocks, block_of(bin_of(grid%lattice, record%hot(c_x:c_x + 2))))
   end function destination

   !> Send the outbox to the partners and take in what they send, partner by partner.
   !> Collective over the partners; `lost` counts particles that no partner owns.
   subroutine exchange(p, grid, comm, partners, outbox, lost)
      type(particles_t), intent(inout) :: p
      type(grid_t), intent(in) :: grid
      type(comm_t), intent(in) :: comm
      integer, intent(in) :: partners(:)     !! ranks, ascending, this one not among them
      type(outbox_t), intent(inout) :: outbox
      integer, intent(out) :: lost
      integer, allocatable :: goal(:), first(:), incoming(:)
      real(wp), allocatable :: send(:, :), receive(:, :)
      integer(i8), allocatable :: send_whole(:, :), receive_whole(:, :)
      integer :: i, k, n, width

      allocate (goal(outbox%n), first(size(partners) + 1), incoming(size(partners)))
      do i = 1, outbox%n
         goal(i) = destination(grid, outbox%records(i))
      end do
      width = n_hot + 4 + size(p%near, 2)
      allocate (send(width, outbox%n), send_whole(n_whole, outbox%n))
      n = 0
      do k = 1, size(partners)
         first(k) = n + 1
         do i = 1, outbox%n
            if (goal(i) /= partners(k)) cycle
            n = n + 1
            call pack_record(outbox%records(i), send(:, n), send_whole(:, n))
         end do
      end do
      first(size(partners) + 1) = n + 1
      lost = outbox%n - n
      outbox%n = 0
      call trade_counts(comm, partners, first, incoming)
      allocate (receive(width, sum(incoming)), receive_whole(n_whole, sum(incoming)))
      call trade(comm, partners, first, incoming, send, send_whole, receive, receive_whole)
      do i = 1, size(receive, 2)
         call insert_record(p, grid, unpack_record(receive(:, i), receive_whole(:, i)))
      end do
   end subroutine exchange

   pure subroutine pack_record(record, values, whole)
      type(record_t), intent(in) :: record
      real(wp), intent(out) :: values(:)
      integer(i8), intent(out) :: whole(n_whole)

      values = 0
      values(:n_hot) = record%hot
      values(n_hot + 1:n_hot + 3) = record%x0
      if (allocated(record%near)) then
         values(n_hot + 4) = 1
         values(n_hot + 5:) = record%near
      end if
      whole = [record%id, record%sets, int(record%body, i8)]
   end subroutine pack_record

   pure function unpack_record(values, whole) result(record)
      real(wp), intent(in) :: values(:)
      integer(i8), intent(in) :: whole(n_whole)
      type(record_t) :: record

      record%hot = values(:n_hot)
      record%x0 = values(n_hot + 1:n_hot + 3)
      if (values(n_hot + 4) > 0) record%near = values(n_hot + 5:)
      record%id = whole(1)
      record%sets = whole(2)
      record%body = int(whole(3))
   end function unpack_record

   !> Tell each partner how many particles come.
   subroutine trade_counts(comm, partners, first, incoming)
      type(comm_t), intent(in) :: comm
      integer, intent(in) :: partners(:), first(:)
      integer, intent(out) :: incoming(:)
      type(MPI_Request) :: requests(2*size(partners))
      integer :: outgoing(size(partners)), k, n

      n = size(partners)
      do k = 1, n
         outgoing(k) = first(k + 1) - first(k)
         call MPI_Irecv(incoming(k), 1, MPI_INTEGER, partners(k), 72, comm%handle, requests(k))
         call MPI_Isend(outgoing(k), 1, MPI_INTEGER, partners(k), 72, comm%handle, requests(n + k))
      end do
      call MPI_Waitall(2*n, requests, MPI_STATUSES_IGNORE)
   end subroutine trade_counts

   !> Send the packed particles both ways.
   subroutine trade(comm, partners, first, incoming, send, send_whole, receive, receive_whole)
      type(comm_t), intent(in) :: comm
      integer, intent(in) :: partners(:), first(:), incoming(:)
      real(wp), intent(in) :: send(:, :)
      integer(i8), intent(in) :: send_whole(:, :)
      real(wp), intent(inout) :: receive(:, :)
      integer(i8), intent(inout) :: receive_whole(:, :)
      type(MPI_Request) :: requests(4*size(partners))
      integer :: k, n, a, b, w

      n = size(partners)
      w = size(send, 1)
      a = 1
      do k = 1, n
         b = a + incoming(k) - 1
         call MPI_Irecv(receive(:, a:b), w*incoming(k), MPI_DOUBLE_PRECISION, partners(k), 73, &
            comm%handle, requests(k))
         call MPI_Irecv(receive_whole(:, a:b), n_whole*incoming(k), MPI_INTEGER8, partners(k), 74, &
            comm%handle, requests(n + k))
         a = b + 1
      end do
      do k = 1, n
         a = first(k)
         b = first(k + 1) - 1
         call MPI_Isend(send(:, a:b), w*(b - a + 1), MPI_DOUBLE_PRECISION, partners(k), 73, &
            comm%handle, requests(2*n + k))
         call MPI_Isend(send_whole(:, a:b), n_whole*(b - a + 1), MPI_INTEGER8, partners(k), 74, &
            comm%handle, requests(3*n + k))
      end do
      call MPI_Waitall(4*n, requests, MPI_STATUSES_IGNORE)
   end subroutine trade
end module xmpm_migration
