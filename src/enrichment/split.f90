!> Which nodes are split, their rows, and the bins that must tell sides apart.
!>
!> A node is split by a crack where particles with H > 0 and with H < 0 reach it; the sharp rules
!> ask besides that the node belong to the cells or places that they name, and with GIMP nodes
!> ahead of the front stay whole where hardly any particle with a side reaches them
!> (ahead_nodes.f90). It is split by contact where bodies of several contact groups reach it: each
!> group but the lowest has its own rows.
module xmpm_split
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t, raise, code_numerics
   use xmpm_text, only: to_text
   use xmpm_communicator, only: comm_t
   use xmpm_halo, only: halo_t, make_halo, merge_bits
   use xmpm_lattice, only: stencil_offsets, tile_base, bins_per_block, gimp_shape
   use xmpm_blocks, only: node_place
   use xmpm_grid, only: grid_t, size_rows, node_position
   use xmpm_sharing, only: sharing_t, add_split_rows
   use xmpm_storage, only: particles_t, n_near, near_crack, near_jump
   use xmpm_sided, only: sided_t, clear_sided, most_cracks
   use xmpm_loads, only: rows_of_bin
   use xmpm_crack, only: crack_t, rule_graded
   use xmpm_front_rules, only: allow_nodes
   use xmpm_ahead_nodes, only: keep_ahead_whole
   implicit none
   private

   public :: split_nodes, split_t, row_of_sides, sides_of_group

   integer, parameter, public :: most_groups = 31   !! contact groups, 0 to 30

   integer, parameter :: plus_bit = 0, minus_bit = 1, allowed_bit = 2

   !> Split nodes of this rank.
   type :: split_t
      integer :: n = 0                       !! split nodes
      integer, allocatable :: of(:)          !! (ordinary rows) number of the split node, 0 for none
      integer, allocatable :: row(:)         !! (n) ordinary row
      integer, allocatable :: n_cracks(:)    !! (n) cracks that split it
      integer, allocatable :: crack(:, :)    !! (3,n) which; less than 0: contact group
      integer, allocatable :: first(:)       !! (n) first further row
      integer, allocatable :: groups(:)      !! (ordinary rows) bit of each contact group that
                                             !! reaches
                                             !! the node; of size 0 without contact
   end type split_t

contains

   !> Find the split nodes, give them rows, list the sided bins, and extend the halo. Collective.
   subroutine split_nodes(cracks, comm, p, half, grid, sharing, halo, sided, split, error)
      type(crack_t), intent(in) :: cracks(:)
      type(comm_t), intent(in) :: comm
      type(particles_t), intent(in) :: p
      real(wp), intent(in) :: half(:)             !! (bodies) half a particle's width [cells]
      type(grid_t), intent(inout) :: grid         !! rows are added
      type(sharing_t), intent(in) :: sharing      !! shared rows of ordinary nodes
      type(halo_t), intent(inout) :: halo         !! made anew for all rows
      type(sided_t), intent(inout) :: sided       !! made anew
      type(split_t), intent(out) :: split
      type(error_t), allocatable, intent(out) :: error   !! too many cracks at a node
      type(sharing_t) :: whole
      integer, allocatable :: bits(:), first_extra(:), n_extra(:)
      integer :: i

      call size_rows(grid, 0)
      call make_halo(halo, comm%rank, sharing%ranks, sharing%first, sharing%rows, grid%n_rows)
      allocate (split%of(grid%n_plain), source=0)
      allocate (split%row(0), split%n_cracks(0), split%crack(most_cracks, 0))
      allocate (bits(grid%n_plain))
      do i = 1, size(cracks)
         bits = 0
         call mark_sides(p, grid, i, bits)
         if (cracks(i)%rule /= rule_graded) call allow_nodes(cracks(i), p, grid, allowed_bit, bits)
         call merge_bits(halo, comm, bits)
         if (fades_at_rest(cracks(i)) .and. grid%lattice%shape == gimp_shape) then
            call keep_ahead_whole(p, half, grid, i, comm, halo, bits)
         end if
         call note_split(cracks(i)%rule == rule_graded, i, bits, split, grid, error)
         if (allocated(error)) return
      end do
      allocate (split%groups(0))
      if (allocated(p%group)) call split_by_groups(comm, p, grid, halo, split, error)
      if (allocated(error)) return
      call number_further_rows(split, grid, first_extra, n_extra)
      call add_split_rows(sharing, first_extra, n_extra, whole)
      call make_halo(halo, comm%rank, whole%ranks, whole%first, whole%rows, grid%n_rows)
      call list_sided_bins(split, grid, sided, error)
   end subroutine split_nodes

   !> Whether H of a crack fades over a ramp that stays where it is in the material: where it moves,
   !> it takes nodes in between two looks.
   pure function fades_at_rest(crack) result(does)
      type(crack_t), intent(in) :: crack
      logical :: does

      does = crack%rule == rule_graded .and. .not. allocated(crack%offset)
   end function fades_at_rest

   !> Bits of the sides from which particles reach each node.
   subroutine mark_sides(p, grid, number, bits)
      type(particles_t), intent(in) :: p
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: number
      integer, intent(inout) :: bits(:)
      real(wp) :: jump
      integer :: c, i, k, found, offsets(grid%lattice%reach**3), rows(grid%lattice%reach**3)

      offsets = stencil_offsets(grid%lattice)
      do c = 1, p%n_chunks
         if (p%count(c) == 0 .or. p%attached(c) == 0) cycle
         found = 0
         do i = 1, p%count(c)
            do k = 0, p%slots - 1
               if (nint(p%near(i, n_near*k + near_crack, p%attached(c))) /= number) cycle
               jump = p%near(i, n_near*k + near_jump, p%attached(c))
               if (jump > 0) found = ibset(found, plus_bit)
               if (jump < 0) found = ibset(found, minus_bit)
            end do
         end do
         if (found == 0) cycle
         rows = rows_of_bin(grid, p%bin(c), offsets)
         bits(rows) = ior(bits(rows), found)
      end do
   end subroutine mark_sides

   !> Add the nodes that bodies of several contact groups reach to the list. Collective.
   subroutine split_by_groups(comm, p, grid, halo, split, error)
      type(comm_t), intent(in) :: comm
      type(particles_t), intent(in) :: p
      type(grid_t), intent(in) :: grid
      type(halo_t), intent(inout) :: halo
      type(split_t), intent(inout) :: split
      type(error_t), allocatable, intent(out) :: error
      integer :: c, row, g, offsets(grid%lattice%reach**3), rows(grid%lattice%reach**3)

      offsets = stencil_offsets(grid%lattice)
      deallocate (split%groups)
      allocate (split%groups(grid%n_plain), source=0)
      do c = 1, p%n_chunks
         if (p%count(c) == 0) cycle
         rows = rows_of_bin(grid, p%bin(c), offsets)
         split%groups(rows) = ibset(split%groups(rows), p%group(p%body(c)))
      end do
      call merge_bits(halo, comm, split%groups)
      do row = 1, grid%n_plain
         if (popcnt(split%groups(row)) < 2) cycle
         do g = trailz(split%groups(row)) + 1, most_groups - 1
            if (.not. btest(split%groups(row), g)) cycle
            call note_node(split, row, -g, grid, error)
            if (allocated(error)) return
         end do
      end do
   end subroutine split_by_groups

   !> Add the nodes that a crack splits to the list.
   subroutine note_split(graded, number, bits, split, grid, error)
      logical, intent(in) :: graded
      integer, intent(in) :: number, bits(:)
      type(split_t), intent(inout) :: split
      type(grid_t), intent(in) :: grid
      type(error_t), allocatable, intent(out) :: error
      integer :: row, wanted

      wanted = ibset(ibset(0, plus_bit), minus_bit)
      if (.not. graded) wanted = ibset(wanted, allowed_bit)
      do row = 1, grid%n_plain
         if (iand(bits(row), wanted) /= wanted) cycle
         call note_node(split, row, number, grid, error)
         if (allocated(error)) return
      end do
   end subroutine note_split

   !> A crack or a contact group splits a node.
   subroutine note_node(split, row, number, grid, error)
      type(split_t), intent(inout) :: split
      integer, intent(in) :: row, number
      type(grid_t), intent(in) :: grid
      type(error_t), allocatable, intent(out) :: error
      integer :: s

      if (split%of(row) == 0) call add_node(split, row)
      s = split%of(row)
      if (split%n_cracks(s) == most_cracks) then
         call raise(error, code_numerics, 'more than '//to_text(most_cracks)// &
            ' cracks (further bodies in contact count as cracks) meet at the grid node '// &
            to_text(node_position(grid, row)))
         return
      end if
      split%n_cracks(s) = split%n_cracks(s) + 1
      split%crack(split%n_cracks(s), s) = number
   end subroutine note_node

   subroutine add_node(split, row)
      type(split_t), intent(inout) :: split
      integer, intent(in) :: row
      integer, allocatable :: longer(:), wide(:, :)
      integer :: n, m

      n = split%n
      if (n == size(split%row)) then
         m = 2*n + 256
         allocate (longer(m))
         longer(:n) = split%row
         call move_alloc(longer, split%row)
         allocate (longer(m), source=0)
         longer(:n) = split%n_cracks
         call move_alloc(longer, split%n_cracks)
         allocate (wide(most_cracks, m), source=0)
         wide(:, :n) = split%crack
         call move_alloc(wide, split%crack)
      end if
      split%n = n + 1
      split%row(n + 1) = row
      split%of(row) = n + 1
   end subroutine add_node

   !> Number the rows behind the ordinary ones.
   subroutine number_further_rows(split, grid, first_extra, n_extra)
      type(split_t), intent(inout) :: split
      type(grid_t), intent(inout) :: grid
      integer, allocatable, intent(out) :: first_extra(:), n_extra(:)
      integer :: s, n, k

      allocate (first_extra(grid%n_plain), source=0)
      allocate (n_extra(grid%n_plain), source=0)
      allocate (split%first(split%n))
      n = 0
      do s = 1, split%n
         split%first(s) = grid%n_plain + n + 1
         k = 2**split%n_cracks(s) - 1
         first_extra(split%row(s)) = split%first(s)
         n_extra(split%row(s)) = k
         n = n + k
      end do
      call size_rows(grid, n)
      if (allocated(grid%parent)) deallocate (grid%parent)
      allocate (grid%parent(n))
      do s = 1, split%n
         k = split%first(s) - grid%n_plain
         grid%parent(k:k + 2**split%n_cracks(s) - 2) = split%row(s)
      end do
   end subroutine number_further_rows

   !> List every bin that touches a split node, with its rows for each set of sides.
   subroutine list_sided_bins(split, grid, sided, error)
      type(split_t), intent(in) :: split
      type(grid_t), intent(in) :: grid
      type(sided_t), intent(inout) :: sided
      type(error_t), allocatable, intent(out) :: error
      integer :: b, k, n, base(bins_per_block), offsets(grid%lattice%reach**3)
      logical, allocatable :: touched(:)

      base = tile_base(grid%lattice)
      offsets = stencil_offsets(grid%lattice)
      allocate (touched(grid%blocks%n))
      do b = 1, grid%blocks%n
         touched(b) = any(split%of(grid%blocks%tile(:, b)) > 0)
      end do
      n = 0
      do b = 1, grid%blocks%n
         if (.not. touched(b)) cycle
         do k = 1, bins_per_block
            if (any(split%of(grid%blocks%tile(base(k) + offsets, b)) > 0)) n = n + 1
         end do
      end do
      call clear_sided(sided, grid%blocks%n, n, size(offsets))
      do b = 1, grid%blocks%n
         if (.not. touched(b)) cycle
         do k = 1, bins_per_block
            call add_bin(split, grid%blocks%tile(base(k) + offsets, b), b, k, sided, error)
            if (allocated(error)) return
         end do
      end do
   end subroutine list_sided_bins

   !> Add a bin if one of its nodes is split.
   subroutine add_bin(split, rows, b, k, sided, error)
      type(split_t), intent(in) :: split
      integer, intent(in) :: rows(:), b, k
      type(sided_t), intent(inout) :: sided
      type(error_t), allocatable, intent(out) :: error
      integer :: cracks(most_cracks), n, i, j, s, set

      n = 0
      do i = 1, size(rows)
         s = split%of(rows(i))
         if (s == 0) cycle
         do j = 1, split%n_cracks(s)
            if (any(cracks(:n) == split%crack(j, s))) cycle
            if (n == most_cracks) then
               call raise(error, code_numerics, 'more than '//to_text(most_cracks)// &
                  ' cracks (further bodies in contact count as cracks) pass through the cells'// &
                  ' around one bin of particles')
               return
            end if
            n = n + 1
            cracks(n) = split%crack(j, s)
         end do
      end do
      if (n == 0) return
      sided%n = sided%n + 1
      sided%bin(k, b) = sided%n
      sided%n_cracks(sided%n) = n
      sided%crack(:n, sided%n) = cracks(:n)
      do set = 0, 2**n - 1
         do i = 1, size(rows)
            sided%rows(i, set, sided%n) = row_of_set(split, rows(i), cracks(:n), set)
         end do
      end do
   end subroutine add_bin

   !> Row of a node for a set of sides.
   pure function row_of_set(split, row, cracks, set) result(place)
      type(split_t), intent(in) :: split
      integer, intent(in) :: row, cracks(:), set
      integer :: place, s, j, k, sides

      place = row
      s = split%of(row)
      if (s == 0) return
      sides = 0
      do j = 1, split%n_cracks(s)
         do k = 1, size(cracks)
            if (cracks(k) == split%crack(j, s) .and. btest(set, k - 1)) sides = ibset(sides, j - 1)
         end do
      end do
      place = row_of_sides(split, s, sides)
   end function row_of_set

   !> Row of a split node for the sides of its own cracks: bit j - 1 for the plus side of the j-th.
   pure function row_of_sides(split, s, sides) result(row)
      type(split_t), intent(in) :: split
      integer, intent(in) :: s       !! split node
      integer, intent(in) :: sides
      integer :: row

      row = split%row(s)
      if (sides > 0) row = split%first(s) + sides - 1
   end function row_of_sides

   !> Sides of a split node's rows that serve a contact group, one for each set of sides of its true
   !> cracks, in the same order for all groups.
   pure function sides_of_group(split, s, group) result(sides)
      type(split_t), intent(in) :: split
      integer, intent(in) :: s       !! split node
      integer, intent(in) :: group
      integer, allocatable :: sides(:)
      integer :: j, k, chosen

      chosen = 0
      do j = 1, split%n_cracks(s)
         if (split%crack(j, s) == -group .and. group > 0) chosen = ibset(chosen, j - 1)
      end do
      allocate (sides(0))
      do k = 0, 2**split%n_cracks(s) - 1
         if (all([(btest(k, j - 1) .eqv. btest(chosen, j - 1), j=1, split%n_cracks(s))] .or. &
            split%crack(:split%n_cracks(s), s) > 0)) sides = [sides, k]
      end do
   end function sides_of_group
end module xmpm_split
