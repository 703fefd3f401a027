!> The background grid: rows of nodal values.
!>
!> An ordinary node has one row. A node that cracks split has one row for each side: its ordinary
!> row serves the minus side of all cracks, further rows stand behind all ordinary ones.
module xmpm_grid
   use xmpm_kinds, only: wp
   use xmpm_lattice, only: lattice_t, make_lattice
   use xmpm_blocks, only: blocks_t, nodes_per_block, node_place
   implicit none
   private

   public :: grid_t, make_grid, size_rows, clear_rows, active_rows, parent_of, node_position
   public :: f_mass, f_velocity, f_change, row_fields

   integer, parameter :: row_fields = 8   !! values of a row
   integer, parameter :: f_mass = 1       !! mass
   integer, parameter :: f_velocity = 2   !! 2:4 momentum, then velocity after the update
   integer, parameter :: f_change = 5     !! 5:7 force, then change of velocity, then MUSL's
                                          !! velocity

   !> Rows and the blocks that name them.
   type :: grid_t
      type(lattice_t) :: lattice
      type(blocks_t) :: blocks
      integer :: n_plain = 0                   !! rows of ordinary nodes
      integer :: n_rows = 0                    !! all rows
      integer, allocatable :: parent(:)        !! (n_plain+1:) ordinary row of a split node's row
      real(wp), allocatable :: node(:, :)      !! (8,rows) mass, momentum or velocity, force or
                                               !! change
      real(wp), allocatable :: second(:, :)    !! (3,rows) momentum of MUSL's second map
      logical, allocatable :: active(:)        !! (node blocks) whether a row holds anything
      logical, allocatable :: always(:)        !! (node blocks) rows are shared: active in any case
      logical, allocatable :: mine(:)          !! (rows) whether this rank counts the row in sums
   end type grid_t

contains

   !> An empty grid on a lattice.
   pure function make_grid(size, origin, shape) result(grid)
      real(wp), intent(in) :: size, origin(3)   !! cell size and place of node 0 0 0 [length]
      integer, intent(in) :: shape              !! linear_shape or gimp_shape
      type(grid_t) :: grid

      grid%lattice = make_lattice(size, origin, shape)
   end function make_grid

   !> Make room for the ordinary rows and `extra` rows of split nodes.
   subroutine size_rows(grid, extra)
      type(grid_t), intent(inout) :: grid
      integer, intent(in) :: extra   !! rows behind the ordinary ones
      integer :: n

      grid%n_plain = nodes_per_block*grid%blocks%n_node_blocks
      n = grid%n_plain + extra
      grid%n_rows = n
      if (allocated(grid%active)) deallocate (grid%active)
      allocate (grid%active(grid%blocks%n_node_blocks), source=.true.)
      if (allocated(grid%node)) then
         if (size(grid%node, 2) >= n .and. size(grid%node, 2) <= 2*n + 4096) return
         deallocate (grid%node, grid%second)
      end if
      allocate (grid%node(row_fields, n + n/16), source=0.0_wp)
      allocate (grid%second(3, n + n/16), source=0.0_wp)
   end subroutine size_rows

   !> Set all rows to zero; only those that hold anything are touched.
   subroutine clear_rows(grid)
      type(grid_t), intent(inout) :: grid
      integer :: b, first, last

      do b = 1, grid%blocks%n_node_blocks + 1
         call active_rows(grid, b, first, last)
         call set_to_zero(row_fields*(last - first + 1), grid%node(:, first:last))
         call set_to_zero(3*(last - first + 1), grid%second(:, first:last))
      end do
      grid%active = grid%always
   end subroutine clear_rows

   !> Set a stretch of values to zero, as one.
   pure subroutine set_to_zero(n, values)
      integer, intent(in) :: n
      real(wp), intent(inout) :: values(n)

      values = 0
   end subroutine set_to_zero

   !> Rows of an active node block; last < first for one that holds nothing. The block behind the
   !> last one stands for the rows of split nodes.
   pure subroutine active_rows(grid, b, first, last)
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: b
      integer, intent(out) :: first, last

      first = nodes_per_block*(b - 1) + 1
      if (b > grid%blocks%n_node_blocks) then
         last = grid%n_rows
      else
         last = first - 1
         if (grid%active(b)) last = nodes_per_block*b
      end if
   end subroutine active_rows

   !> Ordinary row of the node that a row belongs to.
   pure function parent_of(grid, row) result(parent)
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: row
      integer :: parent

      parent = row
      if (row > grid%n_plain) parent = grid%parent(row - grid%n_plain)
   end function parent_of

   !> Place of a row's node [length].
   pure function node_position(grid, row) result(x)
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: row
      real(wp) :: x(3)

      x = grid%lattice%origin &
         + grid%lattice%size*real(node_place(grid%blocks, parent_of(grid, row)), wp)
   end function node_position
end module xmpm_grid
