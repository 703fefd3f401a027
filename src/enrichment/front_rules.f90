!> The sharp front rules: which nodes a crack may split, from level sets at the corners of cells.
module xmpm_front_rules
   use xmpm_kinds, only: wp
   use xmpm_grid, only: grid_t, node_position
   use xmpm_storage, only: particles_t
   use xmpm_loads, only: rows_of_bin
   use xmpm_lattice, only: stencil_offsets
   use xmpm_level_sets, only: evaluate_level_sets
   use xmpm_front, only: beyond_reach
   use xmpm_cell_rules, only: cell_is_crossed, cell_is_touched, cell_is_completely_cut, &
      node_is_behind_front
   use xmpm_crack, only: crack_t, near_reach, rule_node, rule_full
   implicit none
   private

   public :: allow_nodes

contains

   !> Set a bit at every node that the crack's rule allows to be split.
   subroutine allow_nodes(crack, p, grid, bit, bits)
      type(crack_t), intent(in) :: crack
      type(particles_t), intent(in) :: p
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: bit
      integer, intent(inout) :: bits(:)   !! (ordinary rows)
      integer :: c, last, rows(grid%lattice%reach**3), offsets(grid%lattice%reach**3)
      integer :: a, b, d, n, cell(8)

      offsets = stencil_offsets(grid%lattice)
      n = grid%lattice%reach
      last = 0
      do c = 1, p%n_chunks
         if (p%count(c) == 0 .or. p%attached(c) == 0 .or. p%bin(c) == last) cycle
         last = p%bin(c)
         rows = rows_of_bin(grid, last, offsets)
         do d = 0, n - 2
            do b = 0, n - 2
               do a = 0, n - 2
                  cell = rows(1 + a + n*(b + n*d) + &
                     [0, 1, n, n + 1, n*n, n*n + 1, n*n + n, n*n + n + 1])
                  call judge_cell(crack, grid, cell, bit, bits)
               end do
            end do
         end do
      end do
   end subroutine allow_nodes

   !> Judge one cell by its corners.
   subroutine judge_cell(crack, grid, cell, bit, bits)
      type(crack_t), intent(in) :: crack
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: cell(8)      !! rows of the corners, x fastest
      integer, intent(in) :: bit
      integer, intent(inout) :: bits(:)
      real(wp) :: x(3, 8), psi(8), phi(8), e1(3, 8)
      integer :: k

      do k = 1, 8
         x(:, k) = node_position(grid, cell(k))
      end do
      call evaluate_level_sets(crack%surface, crack%index, crack%front, &
         2*near_reach(grid%lattice), &
         x, psi, phi, e1)
      if (any(psi >= 0.5_wp*beyond_reach)) return
      if (.not. cell_is_crossed(psi)) return
      select case (crack%rule)
      case (rule_node)
         do k = 1, 8
            if (node_is_behind_front(phi(k), grid%lattice%size)) then
               bits(cell(k)) = ibset(bits(cell(k)), bit)
            end if
         end do
      case (rule_full)
         if (cell_is_completely_cut(psi, phi)) bits(cell) = ibset(bits(cell), bit)
      case default
         if (cell_is_touched(psi, phi)) bits(cell) = ibset(bits(cell), bit)
      end select
   end subroutine judge_cell
end module xmpm_front_rules
