!> Nodes ahead of a front that GIMP particles with a side hardly reach stay whole.
!>
!> Particles ahead of the ramp (H = 0) give half their mass to each row of a split node and see
!> only the mean of both. What moves the rows apart, and what feels it, are the particles with a
!> side alone. Where those reach the node by the part e of a cell, as GIMP particles at the quarter
!> points of their cells do once the body has moved by e, their weights go with e**2 and their
!> slopes with e, while the mass stays. So the rows drift apart more and more slowly, never come
!> to rest, and strain the particles of the ramp on the way.
module xmpm_ahead_nodes
   use xmpm_kinds, only: wp
   use xmpm_communicator, only: comm_t
   use xmpm_halo, only: halo_t, start_sum, finish_sum
   use xmpm_lattice, only: bin_corner, stencil_offsets
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, c_x, bin_of_chunk, n_near, near_crack, near_jump
   use xmpm_loads, only: rows_of_bin
   use xmpm_gimp_kernels, only: weights_gimp
   implicit none
   private

   public :: keep_ahead_whole, least_weight

   real(wp), parameter :: least_weight = 1e-3_wp   !! of the particles of a side at a node; between
                                                   !! e**2 of bodies at rest and (1/4)**3, the least
                                                   !! weight at quarter points

contains

   !> Clear the bits of nodes that particles ahead of the ramp or in it reach, but those with H > 0
   !> or those with H < 0 do not, to the least weight. Only for GIMP. Collective.
   subroutine keep_ahead_whole(p, half, grid, number, comm, halo, bits)
      type(particles_t), intent(in) :: p
      real(wp), intent(in) :: half(:)       !! (bodies) half a particle's width [cells]
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: number         !! of the crack
      type(comm_t), intent(in) :: comm
      type(halo_t), intent(inout) :: halo   !! of ordinary rows
      integer, intent(inout) :: bits(:)     !! (ordinary rows) 0 where the node stays whole
      real(wp), allocatable :: reached(:, :)
      real(wp) :: corner(3), t(3), h
      integer :: c, i, k, rows(grid%lattice%reach**3), offsets(grid%lattice%reach**3)

      offsets = stencil_offsets(grid%lattice)
      allocate (reached(3, size(bits)), source=0.0_wp)
      do c = 1, p%n_chunks
         if (p%count(c) == 0) cycle
         rows = rows_of_bin(grid, p%bin(c), offsets)
         if (.not. any(bits(rows) > 0)) cycle
         corner = bin_corner(grid%lattice, bin_of_chunk(p, grid%blocks, c))
         do i = 1, p%count(c)
            t = (p%q(i, c_x:c_x + 2, c) - corner)/grid%lattice%size - 0.5_wp
            h = jump_of(p, i, c, number)
            do k = 1, 3
               if (.not. counts(k, h)) cycle
               reached(k, rows) = reached(k, rows) + weights_gimp(t, half(p%body(c)))
            end do
         end do
      end do
      call start_sum(halo, comm, reached, 1, 3)
      call finish_sum(halo, reached, 1, 3)
      where (reached(3, :) >= least_weight .and. minval(reached(:2, :), dim=1) < least_weight)
         bits = 0
      end where
   end subroutine keep_ahead_whole

   !> Whether a particle with the jump h counts for the plus side (1), for the minus side (2), as
   !> one that sees both (3).
   elemental function counts(k, h)
      integer, intent(in) :: k
      real(wp), intent(in) :: h
      logical :: counts

      select case (k)
      case (1)
         counts = h > 0
      case (2)
         counts = h < 0
      case default
         counts = abs(h) < 1
      end select
   end function counts

   !> H of a particle for a crack, 0 far from it.
   pure function jump_of(p, lane, chunk, number) result(h)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: lane, chunk, number
      real(wp) :: h
      integer :: k

      h = 0
      if (p%attached(chunk) == 0) return
      do k = 0, n_near*(p%slots - 1), n_near
         if (nint(p%near(lane, k + near_crack, p%attached(chunk))) /= number) cycle
         h = p%near(lane, k + near_jump, p%attached(chunk))
      end do
   end function jump_of
end module xmpm_ahead_nodes
