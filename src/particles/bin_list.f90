!> The bins of one block that hold particles, in the order in which transfers visit them.
module xmpm_bin_list
   use xmpm_kinds, only: wp
   use xmpm_lattice, only: bin_corner, bins_per_block, block_width
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t
   use xmpm_frame, only: frame_t
   use xmpm_sided, only: sided_t
   implicit none
   private

   public :: bin_list_t, list_bins

   !> Bins of a block that hold particles.
   type :: bin_list_t
      integer :: n = 0                            !! bins in the list
      integer :: first(bins_per_block + 2) = 0    !! first chunk of each, then 0
      integer :: sided(bins_per_block) = 0        !! number of the sided bin, 0 for most
      type(frame_t) :: frame(bins_per_block)      !! place and scale
   end type bin_list_t

contains

   !> List the bins of a block.
   pure subroutine list_bins(p, sided, grid, b, bins)
      type(particles_t), intent(in) :: p
      type(sided_t), intent(in) :: sided
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: b                    !! block
      type(bin_list_t), intent(inout) :: bins
      real(wp) :: corner(3), h
      integer :: k, n, at(3)

      h = grid%lattice%size
      at = block_width*grid%blocks%place(:, b)
      corner = bin_corner(grid%lattice, at)
      n = 0
      do k = 1, bins_per_block
         if (p%head(k, b) == 0) cycle
         n = n + 1
         at = [iand(k - 1, 3), iand(shifta(k - 1, 2), 3), shifta(k - 1, 4)]
         bins%first(n) = p%head(k, b)
         bins%sided(n) = 0
         if (sided%n > 0) bins%sided(n) = sided%bin(k, b)
         bins%frame(n)%corner = corner + h*real(at, wp)
         bins%frame(n)%per_size = 1/h
         bins%frame(n)%base = 1 + at(1) + grid%lattice%width*(at(2) + grid%lattice%width*at(3))
      end do
      bins%n = n
      bins%first(n + 1:n + 2) = 0
   end subroutine list_bins
end module xmpm_bin_list
