!> Fetching what a walk over particles needs next, while it works on something else.
module xmpm_fetch_ahead
   use xmpm_fetch, only: fetch_lines
   use xmpm_lattice, only: bins_per_block
   use xmpm_grid, only: grid_t, row_fields
   use xmpm_storage, only: particles_t, lanes, n_hot, n_trace
   implicit none
   private

   public :: fetch_chunk, fetch_record, fetch_bin, fetch_traces, fetch_rows

contains

   !> All that a particle of a chunk takes along when it moves, but for its number and sets.
   pure subroutine fetch_chunk(p, chunk)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: chunk

      call fetch_lines(p%q(1, 1, chunk), lanes*n_hot)
      call fetch_lines(p%x0(1, 1, chunk), lanes*3)
   end subroutine fetch_chunk

   !> Components of all chunks of a bin.
   pure subroutine fetch_bin(p, first, low, high)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: first       !! first chunk of the bin, 0 for none
      integer, intent(in) :: low, high   !! first and last component
      integer :: c

      c = first
      do while (c > 0)
         call fetch_lines(p%q(1, low, c), lanes*(high - low + 1))
         c = p%next(c)
      end do
   end subroutine fetch_bin

   !> All that a chunk with a near record holds but for first positions.
   pure subroutine fetch_record(p, chunk)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: chunk

      call fetch_lines(p%q(1, 1, chunk), lanes*n_hot)
      call fetch_lines(p%near(1, 1, p%attached(chunk)), lanes*size(p%near, 2))
   end subroutine fetch_record

   !> Traces of all chunks of a bin.
   pure subroutine fetch_traces(p, first)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: first       !! first chunk of the bin, 0 for none
      integer :: c, r

      if (p%trace < 0) return
      c = first
      do while (c > 0)
         r = p%attached(c)
         if (r > 0) call fetch_lines(p%near(1, p%trace + 1, r), lanes*n_trace)
         c = p%next(c)
      end do
   end subroutine fetch_traces

   !> One part in 64 of the rows of a block's tile, so that a walk over the bins of the block before
   !> fetches all of them without ever waiting.
   pure subroutine fetch_rows(grid, b, part)
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: b      !! block; there may be none of this number
      integer, intent(in) :: part   !! from 1 on
      integer :: i

      if (b > grid%blocks%n) return
      do i = part, size(grid%blocks%tile, 1), bins_per_block
         call fetch_lines(grid%node(1, grid%blocks%tile(i, b)), row_fields)
      end do
   end subroutine fetch_rows
end module xmpm_fetch_ahead
