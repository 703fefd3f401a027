!> Which rows a rank shares with which other, found from the directory without a message.
module xmpm_sharing
   use xmpm_kinds, only: i8
   use xmpm_sort, only: sort_order
   use xmpm_lattice, only: lattice_t, block_key
   use xmpm_blocks, only: blocks_t, owner_of, touched_nodes, nodes_per_block
   use xmpm_grid, only: grid_t
   implicit none
   private

   public :: sharing_t, list_shared_rows, add_split_rows, mark_mine

   !> Shared rows by neighbour, in an order that both ranks find.
   type :: sharing_t
      integer, allocatable :: ranks(:)   !! (n) neighbours, ascending
      integer, allocatable :: first(:)   !! (n+1) where each one's rows begin
      integer, allocatable :: rows(:)    !! rows by neighbour
   end type sharing_t

contains

   !> Rows of ordinary nodes shared with each neighbour: node blocks by key, nodes by number.
   subroutine list_shared_rows(grid, rank, n_ranks, sharing)
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: rank, n_ranks
      type(sharing_t), intent(out) :: sharing
      integer, allocatable :: order(:), place(:)
      integer(i8), allocatable :: bits(:, :)
      integer :: i, k, b, n

      allocate (place(0:n_ranks - 1), source=0)
      call find_neighbours(grid%blocks, rank, place, sharing%ranks)
      allocate (bits(size(sharing%ranks), grid%blocks%n_node_blocks), source=0_i8)
      do i = 1, grid%blocks%n_node_blocks
         call mark_shared(grid%blocks, grid%lattice, i, rank, place, bits(:, i))
      end do
      order = key_order(grid%blocks)
      allocate (sharing%first(size(sharing%ranks) + 1), sharing%rows(sum(popcnt(bits))))
      n = 0
      do k = 1, size(sharing%ranks)
         sharing%first(k) = n + 1
         do i = 1, size(order)
            do b = 0, nodes_per_block - 1
               if (.not. btest(bits(k, order(i)), b)) cycle
               n = n + 1
               sharing%rows(n) = nodes_per_block*(order(i) - 1) + b + 1
            end do
         end do
      end do
      sharing%first(size(sharing%ranks) + 1) = n + 1
   end subroutine list_shared_rows

   !> Ranks that own a block beside one of ours; `place` gives each its number.
   subroutine find_neighbours(blocks, rank, place, ranks)
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: rank
      integer, intent(inout) :: place(0:)
      integer, allocatable, intent(out) :: ranks(:)
      integer :: i, a, b, c, r

      do i = 1, blocks%n_edge
         do c = -1, 1
            do b = -1, 1
               do a = -1, 1
                  r = owner_of(blocks, blocks%place(:, i) + [a, b, c])
                  if (r >= 0 .and. r /= rank) place(r) = 1
               end do
            end do
         end do
      end do
      allocate (ranks(sum(place)))
      i = 0
      do r = 0, ubound(place, 1)
         if (place(r) == 0) cycle
         i = i + 1
         place(r) = i
         ranks(i) = r
      end do
   end subroutine find_neighbours

   !> Nodes of one node block that each neighbour touches too.
   subroutine mark_shared(blocks, lattice, i, rank, place, bits)
      type(blocks_t), intent(in) :: blocks
      type(lattice_t), intent(in) :: lattice
      integer, intent(in) :: i, rank
      integer, intent(in) :: place(0:)
      integer(i8), intent(inout) :: bits(:)
      integer :: a, b, c, r, at(3)

      do c = -1, 1
         do b = -1, 1
            do a = -1, 1
               at = blocks%node_block(:, i) + [a, b, c]
               r = owner_of(blocks, at)
               if (r < 0 .or. r == rank) cycle
               if (place(r) == 0) cycle
               bits(place(r)) = ior(bits(place(r)), iand(blocks%touched(i), &
                  touched_nodes(lattice, at, blocks%node_block(:, i))))
            end do
         end do
      end do
   end subroutine mark_shared

   !> Node blocks in the order of their places.
   function key_order(blocks) result(order)
      type(blocks_t), intent(in) :: blocks
      integer, allocatable :: order(:)
      integer(i8), allocatable :: keys(:)
      integer :: i

      allocate (keys(blocks%n_node_blocks))
      do i = 1, blocks%n_node_blocks
         keys(i) = block_key(blocks%node_block(:, i))
      end do
      order = sort_order(keys)
   end function key_order

   !> Append to each neighbour's rows the further rows of the split nodes among them.
   pure subroutine add_split_rows(plain, first_extra, n_extra, sharing)
      type(sharing_t), intent(in) :: plain
      integer, intent(in) :: first_extra(:)   !! (plain rows) first further row of a node, or 0
      integer, intent(in) :: n_extra(:)       !! (plain rows) number of further rows
      type(sharing_t), intent(out) :: sharing
      integer :: i, k, n, j

      sharing%ranks = plain%ranks
      allocate (sharing%first(size(plain%first)))
      allocate (sharing%rows(size(plain%rows) + sum(n_extra(plain%rows))))
      n = 0
      do k = 1, size(plain%ranks)
         sharing%first(k) = n + 1
         do i = plain%first(k), plain%first(k + 1) - 1
            n = n + 1
            sharing%rows(n) = plain%rows(i)
            do j = 0, n_extra(plain%rows(i)) - 1
               n = n + 1
               sharing%rows(n) = first_extra(plain%rows(i)) + j
            end do
         end do
      end do
      sharing%first(size(plain%ranks) + 1) = n + 1
   end subroutine add_split_rows

   !> Mark the rows that this rank counts in sums: those not shared with a lower rank. The rows of a
   !> split node go with its ordinary one.
   subroutine mark_mine(grid, sharing, rank)
      type(grid_t), intent(inout) :: grid
      type(sharing_t), intent(in) :: sharing
      integer, intent(in) :: rank
      integer :: i, k

      if (allocated(grid%mine)) deallocate (grid%mine)
      allocate (grid%mine(grid%n_rows), source=.true.)
      if (allocated(grid%always)) deallocate (grid%always)
      allocate (grid%always(grid%blocks%n_node_blocks), source=.false.)
      grid%always(1 + (sharing%rows - 1)/nodes_per_block) = .true.
      do k = 1, size(sharing%ranks)
         if (sharing%ranks(k) > rank) cycle
         do i = sharing%first(k), sharing%first(k + 1) - 1
            grid%mine(sharing%rows(i)) = .false.
         end do
      end do
      do i = grid%n_plain + 1, grid%n_rows
         grid%mine(i) = grid%mine(grid%parent(i - grid%n_plain))
      end do
   end subroutine mark_mine
end module xmpm_sharing
