!> Bins that touch split nodes: their rows for each side, and the particles' weights of the sides.
!>
!> With k cracks in reach a bin has 2**k sets of rows; set s takes the plus side of crack i where
!> bit i - 1 of s is set. A contact group counts as a crack too: its bodies are the plus side, all
!> others the minus side. A particle's weight of a set is the product of (1 + H)/2 or (1 - H)/2,
!> which add up to one: u_p = sum over sets of g_s sum over nodes of N v_s.
module xmpm_sided
   use xmpm_kinds, only: wp
   use xmpm_lattice, only: bins_per_block
   use xmpm_storage, only: particles_t, lanes, n_near, near_crack, near_jump
   implicit none
   private

   public :: sided_t, clear_sided, side_weights, most_cracks

   integer, parameter :: most_cracks = 3   !! cracks and contact groups that one bin can tell apart

   !> Rows by side of the bins that need them.
   type :: sided_t
      integer :: n = 0                          !! sided bins
      integer, allocatable :: bin(:, :)         !! (64,blocks) number of the sided bin, 0 for none
      integer, allocatable :: n_cracks(:)       !! (n)
      integer, allocatable :: crack(:, :)       !! (3,n) cracks in reach; less than 0: contact group
      integer, allocatable :: rows(:, :, :)     !! (nodes,0:7,n) row of each stencil node and set
   end type sided_t

contains

   !> No sided bins, for a number of blocks; `n` can be filled in.
   pure subroutine clear_sided(sided, n_blocks, n, nodes)
      type(sided_t), intent(inout) :: sided
      integer, intent(in) :: n_blocks   !! blocks of this rank
      integer, intent(in) :: n          !! sided bins to make room for
      integer, intent(in) :: nodes      !! nodes of a stencil

      sided%n = 0
      if (allocated(sided%bin)) deallocate (sided%bin, sided%n_cracks, sided%crack, sided%rows)
      allocate (sided%bin(bins_per_block, n_blocks), source=0)
      allocate (sided%n_cracks(n), sided%crack(most_cracks, n), source=0)
      allocate (sided%rows(nodes, 0:2**most_cracks - 1, n), source=0)
   end subroutine clear_sided

   !> Weights of one set and their gradients in the lanes of a chunk.
   pure subroutine side_weights(p, chunk, cracks, set, weight, slope)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: chunk
      integer, intent(in) :: cracks(:)             !! cracks and contact groups in reach of the bin
      integer, intent(in) :: set                   !! 0 to 2**size(cracks) - 1
      real(wp), intent(out) :: weight(lanes)       !! g
      real(wp), intent(out) :: slope(lanes, 3)     !! gradient of g [1/length]
      real(wp) :: jump(lanes, 4), sign, g
      integer :: i, k

      weight = 1
      slope = 0
      do k = 1, size(cracks)
         if (cracks(k) < 0) then
            if ((p%group(p%body(chunk)) == -cracks(k)) .eqv. btest(set, k - 1)) cycle
            weight = 0
            slope = 0
            return
         end if
         jump = 0
         if (p%attached(chunk) > 0) then
            call find_jumps(p%slots, p%near(:, :, p%attached(chunk)), p%count(chunk), &
               cracks(k), jump)
         end if
         sign = merge(0.5_wp, -0.5_wp, btest(set, k - 1))
         do i = 1, lanes
            g = 0.5_wp + sign*jump(i, 1)
            slope(i, :) = slope(i, :)*g + weight(i)*sign*jump(i, 2:4)
            weight(i) = weight(i)*g
         end do
      end do
      weight(p%count(chunk) + 1:) = 0
      slope(p%count(chunk) + 1:, :) = 0
   end subroutine side_weights

   !> H of a crack and its gradient in the lanes that have a slot of it; others stay as they are.
   pure subroutine find_jumps(slots, near, n, crack, jump)
      integer, intent(in) :: slots
      real(wp), intent(in) :: near(:, :)           !! near record of the chunk
      integer, intent(in) :: n                     !! lanes in use
      integer, intent(in) :: crack
      real(wp), intent(inout) :: jump(lanes, 4)    !! H, gradient of H [1/length]
      real(wp) :: mine(lanes)
      integer :: slot, at, i

      do slot = 0, slots - 1
         at = n_near*slot
         mine = merge(1.0_wp, 0.0_wp, abs(near(:, at + near_crack) - real(crack, wp)) < 0.5_wp)
         do i = 0, 3
            jump(:, 1 + i) = jump(:, 1 + i) + mine*near(:, at + near_jump + i)
         end do
         if (all(mine(:n) > 0)) exit
      end do
   end subroutine find_jumps
end module xmpm_sided
