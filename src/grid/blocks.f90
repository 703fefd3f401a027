!> Blocks of bins that hold material, who owns them, and the rows of the nodes that they touch.
module xmpm_blocks
   use xmpm_kinds, only: i8
   use xmpm_hash_map, only: hash_map_t, clear_map, set_value, value_of
   use xmpm_lattice, only: lattice_t, block_key, key_place
   implicit none
   private

   public :: blocks_t, build_blocks, owner_of, local_block, node_place, touched_nodes
   public :: nodes_per_block

   integer, parameter :: nodes_per_block = 64

   !> The blocks of one rank, and the directory of all.
   !>
   !> Rows of ordinary nodes are numbered by node block: row = 64 (node block - 1) + place in it.
   type :: blocks_t
      integer :: n = 0                          !! blocks of this rank
      integer :: n_edge = 0                     !! the first of them share nodes with other ranks
      integer :: n_node_blocks = 0              !! blocks of nodes that these touch
      integer, allocatable :: place(:, :)       !! (3,n) lattice place of each block
      integer, allocatable :: tile(:, :)        !! (width**3,n) row of each node of a tile
      integer, allocatable :: node_block(:, :)  !! (3,n_node_blocks) lattice place
      integer(i8), allocatable :: touched(:)    !! (n_node_blocks) bit per node that this rank
                                                !! touches
      type(hash_map_t) :: find                  !! key to block of this rank
      type(hash_map_t) :: find_nodes            !! key to node block of this rank
      type(hash_map_t) :: owner                 !! key to rank, all blocks of the run
   end type blocks_t

contains

   !> Rank that owns a block, or -1 where there is no material yet.
   pure function owner_of(blocks, place) result(rank)
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: place(3)
      integer :: rank

      rank = value_of(blocks%owner, block_key(place), -1)
   end function owner_of

   !> Block of this rank at a lattice place, or 0.
   pure function local_block(blocks, place) result(b)
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: place(3)
      integer :: b

      b = value_of(blocks%find, block_key(place), 0)
   end function local_block

   !> Lattice place of an ordinary row's node.
   pure function node_place(blocks, row) result(place)
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: row
      integer :: place(3), k

      k = mod(row - 1, nodes_per_block)
      place = 4*blocks%node_block(:, 1 + (row - 1)/nodes_per_block) &
         + [iand(k, 3), iand(shifta(k, 2), 3), shifta(k, 4)]
   end function node_place

   !> Lay out the blocks of this rank and the rows of their nodes.
   subroutine build_blocks(blocks, lattice, keys, owners, rank)
      type(blocks_t), intent(inout) :: blocks    !! built anew
      type(lattice_t), intent(in) :: lattice
      integer(i8), intent(in) :: keys(:)         !! all blocks of the run, ascending
      integer, intent(in) :: owners(:)           !! rank of each
      integer, intent(in) :: rank                !! this rank
      integer :: i

      call clear_map(blocks%owner, size(keys))
      do i = 1, size(keys)
         call set_value(blocks%owner, keys(i), owners(i))
      end do
      call place_blocks(blocks, pack(keys, owners == rank), rank)
      call number_rows(blocks, lattice)
   end subroutine build_blocks

   !> Order the blocks: those beside other ranks first, then by key.
   subroutine place_blocks(blocks, keys, rank)
      type(blocks_t), intent(inout) :: blocks
      integer(i8), intent(in) :: keys(:)   !! blocks of this rank, ascending
      integer, intent(in) :: rank
      integer(i8), allocatable :: ordered(:)
      logical, allocatable :: edge(:)
      integer :: i

      allocate (edge(size(keys)))
      do i = 1, size(keys)
         edge(i) = beside_other_rank(blocks, key_place(keys(i)), rank)
      end do
      allocate (ordered(size(keys)))
      ordered(:count(edge)) = pack(keys, edge)
      ordered(count(edge) + 1:) = pack(keys, .not. edge)
      blocks%n = size(keys)
      blocks%n_edge = count(edge)
      if (allocated(blocks%place)) deallocate (blocks%place)
      allocate (blocks%place(3, blocks%n))
      call clear_map(blocks%find, blocks%n)
      do i = 1, blocks%n
         blocks%place(:, i) = key_place(ordered(i))
         call set_value(blocks%find, ordered(i), i)
      end do
   end subroutine place_blocks

   !> Whether a block of another rank touches nodes that this one touches.
   pure function beside_other_rank(blocks, place, rank) result(beside)
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: place(3), rank
      logical :: beside
      integer :: a, b, c, other

      beside = .false.
      do c = -1, 1
         do b = -1, 1
            do a = -1, 1
               other = owner_of(blocks, place + [a, b, c])
               if (other >= 0 .and. other /= rank) beside = .true.
            end do
         end do
      end do
   end function beside_other_rank

   !> Number the node blocks that the tiles touch and list each tile's rows.
   subroutine number_rows(blocks, lattice)
      type(blocks_t), intent(inout) :: blocks
      type(lattice_t), intent(in) :: lattice
      integer :: i

      call clear_map(blocks%find_nodes, 2*blocks%n)
      blocks%n_node_blocks = 0
      if (allocated(blocks%tile)) deallocate (blocks%tile)
      allocate (blocks%tile(lattice%width**3, blocks%n))
      if (allocated(blocks%node_block)) deallocate (blocks%node_block)
      allocate (blocks%node_block(3, 27*max(1, blocks%n)))
      do i = 1, blocks%n
         call list_tile(blocks, lattice, i)
      end do
      blocks%node_block = blocks%node_block(:, :blocks%n_node_blocks)
      blocks%touched = [(0_i8, i=1, blocks%n_node_blocks)]
      do i = 1, blocks%n
         call mark_touched(blocks, i)
      end do
   end subroutine number_rows

   subroutine list_tile(blocks, lattice, i)
      type(blocks_t), intent(inout) :: blocks
      type(lattice_t), intent(in) :: lattice
      integer, intent(in) :: i
      integer :: a, b, c, n, node(3), home, local

      n = 0
      do c = 0, lattice%width - 1
         do b = 0, lattice%width - 1
            do a = 0, lattice%width - 1
               n = n + 1
               node = 4*blocks%place(:, i) + lattice%low + [a, b, c]
               home = node_block_of(blocks, shifta(node, 2))
               local = 1 + iand(node(1), 3) + 4*iand(node(2), 3) + 16*iand(node(3), 3)
               blocks%tile(n, i) = nodes_per_block*(home - 1) + local
            end do
         end do
      end do
   end subroutine list_tile

   !> Number of a node block, given on first sight.
   function node_block_of(blocks, place) result(number)
      type(blocks_t), intent(inout) :: blocks
      integer, intent(in) :: place(3)
      integer :: number

      number = value_of(blocks%find_nodes, block_key(place), 0)
      if (number > 0) return
      number = blocks%n_node_blocks + 1
      blocks%n_node_blocks = number
      blocks%node_block(:, number) = place
      call set_value(blocks%find_nodes, block_key(place), number)
   end function node_block_of

   subroutine mark_touched(blocks, i)
      type(blocks_t), intent(inout) :: blocks
      integer, intent(in) :: i
      integer :: k, home

      do k = 1, size(blocks%tile, 1)
         home = 1 + (blocks%tile(k, i) - 1)/nodes_per_block
         blocks%touched(home) = ibset(blocks%touched(home), &
            mod(blocks%tile(k, i) - 1, nodes_per_block))
      end do
   end subroutine mark_touched

   !> Bits of the nodes of a node block that the block at `place` touches.
   pure function touched_nodes(lattice, place, node_block) result(bits)
      type(lattice_t), intent(in) :: lattice
      integer, intent(in) :: place(3)        !! of a block of bins
      integer, intent(in) :: node_block(3)   !! of a block of nodes
      integer(i8) :: bits
      integer :: a, b, c, low(3), high(3)

      bits = 0
      low = max(0, 4*place + lattice%low - 4*node_block)
      high = min(3, 4*place + lattice%low + lattice%width - 1 - 4*node_block)
      do c = low(3), high(3)
         do b = low(2), high(2)
            do a = low(1), high(1)
               bits = ibset(bits, a + 4*b + 16*c)
            end do
         end do
      end do
   end function touched_nodes
end module xmpm_blocks
