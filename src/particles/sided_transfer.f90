!> Transfers of the chunks of one bin that touches split nodes, one set of rows after the other.
module xmpm_sided_transfer
   use xmpm_kinds, only: wp
   use xmpm_blocks, only: nodes_per_block
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, lanes, c_m, c_vol, c_s
   use xmpm_frame, only: frame_t
   use xmpm_kernels, only: kernels_t, tile_nodes
   use xmpm_sided, only: sided_t, side_weights
   implicit none
   private

   public :: gather_sides, push_sides, scatter_sided, velocity_sided, gradient_sided, mean_sided

contains

   !> Mass, momentum and internal force of a bin's chunks to the rows of all sides.
   !>
   !> A set takes g m, g V; where H varies (graded front) also the force - V s . grad g N.
   subroutine scatter_sided(p, first, kernels, sided, s, offsets, frame, grid)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: first           !! first chunk of the bin
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      integer, intent(in) :: s               !! sided bin
      integer, intent(in) :: offsets(:)      !! tile nodes of the stencil, less the first
      type(frame_t), intent(in) :: frame
      type(grid_t), intent(inout) :: grid
      real(wp) :: tile(8, tile_nodes), push(4, tile_nodes), q(lanes, 14)
      real(wp) :: g(lanes), slope(lanes, 3), force(lanes, 3)
      type(frame_t) :: here
      integer :: set, c

      here = frame
      here%base = 1
      do set = 0, 2**sided%n_cracks(s) - 1
         tile(:, 1 + offsets) = 0
         push(:, 1 + offsets) = 0
         c = first
         do while (c > 0)
            call side_weights(p, c, sided%crack(:sided%n_cracks(s), s), set, g, slope)
            if (any(g > 0)) then
               q = p%q(:, :, c)
               q(:, c_m) = q(:, c_m)*g
               q(:, c_vol) = q(:, c_vol)*g
               call kernels%scatter(p%count(c), q, here, tile)
            end if
            if (any(abs(slope) > 0)) then
               call slope_force(p%q(:, :, c), slope, force)
               call kernels%push(p%count(c), p%q(:, :, c), force, here, push)
            end if
            c = p%next(c)
         end do
         call add_rows(sided%rows(:, set, s), offsets, tile, push, grid)
      end do
   end subroutine scatter_sided

   !> - V s . grad g of the lanes.
   pure subroutine slope_force(q, slope, force)
      real(wp), intent(in) :: q(lanes, 14), slope(lanes, 3)
      real(wp), intent(out) :: force(lanes, 3)

      force(:, 1) = -q(:, c_vol)*(q(:, c_s)*slope(:, 1) + q(:, c_s + 3)*slope(:, 2) &
         + q(:, c_s + 5)*slope(:, 3))
      force(:, 2) = -q(:, c_vol)*(q(:, c_s + 3)*slope(:, 1) + q(:, c_s + 1)*slope(:, 2) &
         + q(:, c_s + 4)*slope(:, 3))
      force(:, 3) = -q(:, c_vol)*(q(:, c_s + 5)*slope(:, 1) + q(:, c_s + 4)*slope(:, 2) &
         + q(:, c_s + 2)*slope(:, 3))
   end subroutine slope_force

   pure subroutine add_rows(rows, offsets, tile, push, grid)
      integer, intent(in) :: rows(:), offsets(:)
      real(wp), intent(in) :: tile(8, tile_nodes), push(4, tile_nodes)
      type(grid_t), intent(inout) :: grid
      integer :: i

      do i = 1, size(offsets)
         grid%node(:, rows(i)) = grid%node(:, rows(i)) + tile(:, 1 + offsets(i))
         grid%node(5:7, rows(i)) = grid%node(5:7, rows(i)) + push(:3, 1 + offsets(i))
         if (rows(i) <= grid%n_plain) grid%active(1 + (rows(i) - 1)/nodes_per_block) = .true.
      end do
   end subroutine add_rows

   !> Velocities of a bin's chunks from the rows of all sides, and their second map.
   subroutine velocity_sided(p, first, kernels, sided, s, offsets, frame, keep, remap, grid)
      type(particles_t), intent(inout) :: p
      integer, intent(in) :: first           !! first chunk of the bin
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      integer, intent(in) :: s               !! sided bin
      integer, intent(in) :: offsets(:)      !! tile nodes of the stencil, less the first
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: keep           !! share of the old velocity that is kept
      logical, intent(in) :: remap           !! whether the second map is wanted
      type(grid_t), intent(inout) :: grid
      real(wp) :: change(lanes, 3)
      integer :: c, i

      c = first
      do while (c > 0)
         call gather_sides(p, c, kernels, sided, s, offsets, frame, grid, 5, change)
         do i = 1, 3
            p%q(:, 3 + i, c) = merge(keep*p%q(:, 3 + i, c) + change(:, i), 0.0_wp, &
               p%q(:, c_m, c) > 0)
         end do
         if (remap) then
            do i = 1, 3
               change(:, i) = p%q(:, c_m, c)*p%q(:, 3 + i, c)
            end do
            call push_sides(p, c, kernels, sided, s, offsets, frame, change, grid)
         end if
         c = p%next(c)
      end do
   end subroutine velocity_sided

   !> Momentum of the interpolated velocity of a bin's chunks (XPIC), to the rows of all sides.
   subroutine mean_sided(p, first, kernels, sided, s, offsets, frame, field, grid)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: first           !! first chunk of the bin
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      integer, intent(in) :: s               !! sided bin
      integer, intent(in) :: offsets(:)      !! tile nodes of the stencil, less the first
      type(frame_t), intent(in) :: frame
      integer, intent(in) :: field           !! first of the three fields of rows
      type(grid_t), intent(inout) :: grid
      real(wp) :: value(lanes, 3)
      integer :: c, i

      c = first
      do while (c > 0)
         call gather_sides(p, c, kernels, sided, s, offsets, frame, grid, field, value)
         do i = 1, 3
            value(:, i) = p%q(:, c_m, c)*value(:, i)
         end do
         call push_sides(p, c, kernels, sided, s, offsets, frame, value, grid)
         c = p%next(c)
      end do
   end subroutine mean_sided

   !> Interpolate three fields: sum over sides of g N v.
   subroutine gather_sides(p, c, kernels, sided, s, offsets, frame, grid, field, value)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c, s, offsets(:)
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      type(frame_t), intent(in) :: frame
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: field
      real(wp), intent(out) :: value(lanes, 3)
      real(wp) :: tile(8, tile_nodes), g(lanes), slope(lanes, 3), part(lanes, 3)
      type(frame_t) :: here
      integer :: set, i

      here = frame
      here%base = 1
      value = 0
      do set = 0, 2**sided%n_cracks(s) - 1
         call side_weights(p, c, sided%crack(:sided%n_cracks(s), s), set, g, slope)
         if (.not. any(g > 0)) cycle
         call load_set(sided%rows(:, set, s), offsets, grid, tile)
         call kernels%gather(p%q(:, :, c), here, tile, field, part)
         do i = 1, 3
            value(:, i) = value(:, i) + g*part(:, i)
         end do
      end do
   end subroutine gather_sides

   !> Add a vector of each lane, times g, to grid%second of all sides.
   subroutine push_sides(p, c, kernels, sided, s, offsets, frame, value, grid)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c, s, offsets(:)
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: value(lanes, 3)
      type(grid_t), intent(inout) :: grid
      real(wp) :: push(4, tile_nodes), g(lanes), slope(lanes, 3), part(lanes, 3)
      type(frame_t) :: here
      integer :: set, i, row

      here = frame
      here%base = 1
      do set = 0, 2**sided%n_cracks(s) - 1
         call side_weights(p, c, sided%crack(:sided%n_cracks(s), s), set, g, slope)
         if (.not. any(g > 0)) cycle
         do i = 1, 3
            part(:, i) = g*value(:, i)
         end do
         push(:, 1 + offsets) = 0
         call kernels%push(p%count(c), p%q(:, :, c), part, here, push)
         do i = 1, size(offsets)
            row = sided%rows(i, set, s)
            grid%second(:, row) = grid%second(:, row) + push(:3, 1 + offsets(i))
         end do
      end do
   end subroutine push_sides

   !> Gradient of fields 5:7 with the gradient of the weights, and value of fields 2:4.
   subroutine gradient_sided(p, c, kernels, sided, s, offsets, frame, grid, gradient, value)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c               !! chunk
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      integer, intent(in) :: s               !! sided bin
      integer, intent(in) :: offsets(:)      !! tile nodes of the stencil, less the first
      type(frame_t), intent(in) :: frame
      type(grid_t), intent(in) :: grid
      real(wp), intent(out) :: gradient(lanes, 9)   !! dv_i/dx_j at 3 (i - 1) + j [1/time]
      real(wp), intent(out) :: value(lanes, 3)      !! velocity that moves the particles
      real(wp) :: tile(8, tile_nodes), g(lanes), slope(lanes, 3), part(lanes, 9), v(lanes, 3)
      type(frame_t) :: here
      integer :: set, i, j

      here = frame
      here%base = 1
      gradient = 0
      value = 0
      do set = 0, 2**sided%n_cracks(s) - 1
         call side_weights(p, c, sided%crack(:sided%n_cracks(s), s), set, g, slope)
         if (.not. (any(g > 0) .or. any(abs(slope) > 0))) cycle
         call load_set(sided%rows(:, set, s), offsets, grid, tile)
         call kernels%gradient(p%q(:, :, c), here, tile, part, v)
         do i = 1, 9
            gradient(:, i) = gradient(:, i) + g*part(:, i)
         end do
         do i = 1, 3
            value(:, i) = value(:, i) + g*v(:, i)
         end do
         if (.not. any(abs(slope) > 0)) cycle
         call kernels%gather(p%q(:, :, c), here, tile, 5, v)
         do i = 1, 3
            do j = 1, 3
               gradient(:, 3*i - 3 + j) = gradient(:, 3*i - 3 + j) + v(:, i)*slope(:, j)
            end do
         end do
      end do
   end subroutine gradient_sided

   !> Copy the rows of one set to the stencil's places of a tile.
   pure subroutine load_set(rows, offsets, grid, tile)
      integer, intent(in) :: rows(:), offsets(:)
      type(grid_t), intent(in) :: grid
      real(wp), intent(inout) :: tile(8, tile_nodes)
      integer :: i

      do i = 1, size(offsets)
         tile(:, 1 + offsets(i)) = grid%node(:, rows(i))
      end do
   end subroutine load_set
end module xmpm_sided_transfer
