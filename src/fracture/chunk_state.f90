!> What the grid says at the particles of one chunk: the divergence of stress and the velocity
!> gradient, on each particle's own side of the cracks.
module xmpm_chunk_state
   use xmpm_kinds, only: wp
   use xmpm_lattice, only: stencil_offsets, bins_per_block, bin_corner
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, lanes, c_m, bin_of_chunk
   use xmpm_frame, only: frame_t
   use xmpm_kernels, only: kernels_t, tile_nodes
   use xmpm_sided, only: sided_t, side_weights
   use xmpm_loads, only: rows_of_bin
   implicit none
   private

   public :: pull_and_rate

contains

   !> Nodal force at the particles and, where `moving` asks for it, velocity gradient (else 0), from
   !> rows that hold mass, momentum and force as P2G leaves them.
   !>
   !> The pull is m sum N f/m: the force that stress (and loads) exert on a particle. Damping and
   !> body forces are not in it, so that it stands for the divergence of stress.
   subroutine pull_and_rate(p, c, half, kernels, sided, grid, moving, pull, rate)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c                     !! chunk
      real(wp), intent(in) :: half                 !! half a particle's width [cells]
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      type(grid_t), intent(in) :: grid
      logical, intent(in) :: moving                !! whether the velocity gradient is wanted
      real(wp), intent(out) :: pull(lanes, 3)      !! [force]
      real(wp), intent(out) :: rate(lanes, 9)      !! dv_i/dx_j at 3 (i - 1) + j [1/time]
      real(wp) :: tile(8, tile_nodes), g(lanes), slope(lanes, 3), part(lanes, 9), value(lanes, 3)
      type(frame_t) :: frame
      integer :: offsets(grid%lattice%reach**3), s, set, i, j

      frame%corner = bin_corner(grid%lattice, bin_of_chunk(p, grid%blocks, c))
      frame%per_size = 1/grid%lattice%size
      frame%half = half
      offsets = stencil_offsets(grid%lattice)
      s = 0
      if (sided%n > 0) s = sided%bin(1 + mod(p%bin(c) - 1, bins_per_block), &
         1 + (p%bin(c) - 1)/bins_per_block)
      rate = 0
      if (s == 0) then
         call load_rows(grid, rows_of_bin(grid, p%bin(c), offsets), offsets, moving, tile)
         call state_of_rows(p, c, frame, kernels, tile, moving, rate, pull)
      else
         pull = 0
         do set = 0, 2**sided%n_cracks(s) - 1
            call side_weights(p, c, sided%crack(:sided%n_cracks(s), s), set, g, slope)
            if (.not. (any(g > 0) .or. any(abs(slope) > 0))) cycle
            call load_rows(grid, sided%rows(:, set, s), offsets, moving, tile)
            call state_of_rows(p, c, frame, kernels, tile, moving, part, value)
            do i = 1, 3
               pull(:, i) = pull(:, i) + g*value(:, i)
            end do
            if (.not. moving) cycle
            do i = 1, 9
               rate(:, i) = rate(:, i) + g*part(:, i)
            end do
            if (.not. any(abs(slope) > 0)) cycle
            call kernels%gather(p%q(:, :, c), frame, tile, 5, value)
            do i = 1, 3
               do j = 1, 3
                  rate(:, 3*i - 3 + j) = rate(:, 3*i - 3 + j) + value(:, i)*slope(:, j)
               end do
            end do
         end do
      end if
      do i = 1, 3
         pull(:, i) = pull(:, i)*p%q(:, c_m, c)
      end do
   end subroutine pull_and_rate

   !> Value of fields 2:4 of a tile and, where wanted, the gradient of fields 5:7.
   subroutine state_of_rows(p, c, frame, kernels, tile, moving, gradient, value)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c                          !! chunk
      type(frame_t), intent(in) :: frame
      type(kernels_t), intent(in) :: kernels
      real(wp), intent(in) :: tile(8, tile_nodes)
      logical, intent(in) :: moving
      real(wp), intent(inout) :: gradient(lanes, 9)     !! left alone where it is not wanted
      real(wp), intent(out) :: value(lanes, 3)

      if (moving) then
         call kernels%gradient(p%q(:, :, c), frame, tile, gradient, value)
      else
         call kernels%gather(p%q(:, :, c), frame, tile, 2, value)
      end if
   end subroutine state_of_rows

   !> Accelerations to fields 2:4 and, where wanted, velocities to fields 5:7 of the stencil's
   !> places of a tile.
   pure subroutine load_rows(grid, rows, offsets, moving, tile)
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: rows(:), offsets(:)
      logical, intent(in) :: moving
      real(wp), intent(inout) :: tile(8, tile_nodes)
      real(wp) :: per_mass
      integer :: i

      do i = 1, size(rows)
         tile(:, 1 + offsets(i)) = 0
         if (.not. grid%node(1, rows(i)) > 0) cycle
         per_mass = 1/grid%node(1, rows(i))
         tile(2:4, 1 + offsets(i)) = per_mass*grid%node(5:7, rows(i))
         if (moving) tile(5:7, 1 + offsets(i)) = per_mass*grid%node(2:4, rows(i))
      end do
   end subroutine load_rows
end module xmpm_chunk_state
