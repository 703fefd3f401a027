!> Tractions and pressures on the surface layer of a body, brought to the nodes at the true face.
module xmpm_loads
   use xmpm_kinds, only: wp, i8
   use xmpm_lattice, only: stencil_offsets, tile_base, bins_per_block, bin_corner, gimp_shape
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, lanes, bin_of_chunk
   use xmpm_frame, only: frame_t
   use xmpm_kernels, only: kernels_t, tile_nodes
   use xmpm_sided, only: sided_t
   use xmpm_sided_transfer, only: push_sides, gather_sides
   use xmpm_curves, only: curve_t, curve_value
   use xmpm_set_table, only: load_table_t, find
   implicit none
   private

   public :: load_t, apply_load, power_of_load, force_on_lanes, rows_of_bin, push_chunk, &
      gather_chunk

   real(wp), parameter :: point = 1e-6_wp   !! width that makes GIMP a point at the face [cells]

   !> One load on the particles of a set.
   type :: load_t
      integer :: set = 0                  !! bit of its particles
      type(load_table_t) :: table         !! area vector of each particle, and where the face is
      real(wp) :: traction(3) = 0         !! force on an area [stress]
      real(wp) :: pressure = 0            !! against the normal [stress]
      type(curve_t) :: curve              !! factor over time
      real(wp) :: work = 0                !! done so far, this rank [energy]
   end type load_t

contains

   !> Add the load's forces to fields 5:7 of the rows.
   subroutine apply_load(load, p, kernels, sided, time, grid)
      type(load_t), intent(in) :: load
      type(particles_t), intent(in) :: p
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      real(wp), intent(in) :: time            !! [time]
      type(grid_t), intent(inout) :: grid
      real(wp) :: force(lanes, 3), q(lanes, 14), factor
      integer :: c, s, offsets(grid%lattice%reach**3)
      type(frame_t) :: frame

      factor = curve_value(load%curve, time)
      if (.not. abs(factor) > 0) return
      offsets = stencil_offsets(grid%lattice)
      do c = 1, p%n_chunks
         if (.not. is_loaded(load, p, c)) cycle
         call force_of_lanes(load, p, grid, c, factor, force, q)
         frame = face_frame(p, grid, c)
         s = sided_bin(sided, p%bin(c))
         if (s > 0) then
            call push_load(p, c, kernels, sided, s, offsets, frame, force, grid)
         else
            call push_plain(p, c, kernels, q, offsets, frame, force, grid)
         end if
      end do
   end subroutine apply_load

   !> Add a force of each lane of a chunk to fields 5:7 of the rows, at the particles themselves.
   subroutine push_chunk(p, c, half, kernels, sided, force, grid)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c                !! chunk
      real(wp), intent(in) :: half            !! half a particle's width [cells]
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      real(wp), intent(in) :: force(lanes, 3)
      type(grid_t), intent(inout) :: grid
      integer :: s, offsets(grid%lattice%reach**3)
      type(frame_t) :: frame

      offsets = stencil_offsets(grid%lattice)
      frame = face_frame(p, grid, c)
      frame%half = half
      s = sided_bin(sided, p%bin(c))
      if (s > 0) then
         call push_load(p, c, kernels, sided, s, offsets, frame, force, grid)
      else
         call push_plain(p, c, kernels, p%q(:, :, c), offsets, frame, force, grid)
      end if
   end subroutine push_chunk

   !> Interpolate three fields of the rows to the particles of a chunk.
   subroutine gather_chunk(p, c, half, kernels, sided, offsets, grid, field, value)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c                !! chunk
      real(wp), intent(in) :: half            !! half a particle's width [cells]
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      integer, intent(in) :: offsets(:)       !! tile nodes of the stencil, less the first
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: field            !! first of the three
      real(wp), intent(out) :: value(lanes, 3)
      real(wp) :: tile(8, tile_nodes)
      integer :: s, i, rows(size(offsets))
      type(frame_t) :: frame

      frame = face_frame(p, grid, c)
      frame%half = half
      s = sided_bin(sided, p%bin(c))
      if (s > 0) then
         call gather_sides(p, c, kernels, sided, s, offsets, frame, grid, field, value)
         return
      end if
      rows = rows_of_bin(grid, p%bin(c), offsets)
      do i = 1, size(rows)
         tile(:, 1 + offsets(i)) = grid%node(:, rows(i))
      end do
      call kernels%gather(p%q(:, :, c), frame, tile, field, value)
   end subroutine gather_chunk

   !> Add forces of a chunk of an ordinary bin, with the lanes where `q` has them.
   subroutine push_plain(p, c, kernels, q, offsets, frame, force, grid)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c, offsets(:)
      type(kernels_t), intent(in) :: kernels
      real(wp), intent(in) :: q(lanes, 14), force(lanes, 3)
      type(frame_t), intent(in) :: frame
      type(grid_t), intent(inout) :: grid
      real(wp) :: push(4, tile_nodes)
      integer :: i, rows(size(offsets))

      push(:, 1 + offsets) = 0
      call kernels%push(p%count(c), q, force, frame, push)
      rows = rows_of_bin(grid, p%bin(c), offsets)
      do i = 1, size(rows)
         grid%node(5:7, rows(i)) = grid%node(5:7, rows(i)) + push(:3, 1 + offsets(i))
      end do
   end subroutine push_plain

   !> Add forces of a chunk of a sided bin: grid%second serves as the place to add to.
   subroutine push_load(p, c, kernels, sided, s, offsets, frame, force, grid)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c, s, offsets(:)
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: force(lanes, 3)
      type(grid_t), intent(inout) :: grid
      integer :: set, i, row

      call push_sides(p, c, kernels, sided, s, offsets, frame, force, grid)
      do set = 0, 2**sided%n_cracks(s) - 1
         do i = 1, size(offsets)
            row = sided%rows(i, set, s)
            grid%node(5:7, row) = grid%node(5:7, row) + grid%second(:, row)
            grid%second(:, row) = 0
         end do
      end do
   end subroutine push_load

   !> Power of the load with the velocity that three fields of the rows hold.
   function power_of_load(load, p, kernels, sided, time, grid, field) result(power)
      type(load_t), intent(in) :: load
      type(particles_t), intent(in) :: p
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      real(wp), intent(in) :: time            !! [time]
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: field            !! first of the three
      real(wp) :: power                       !! of this rank [energy/time]
      real(wp) :: force(lanes, 3), q(lanes, 14), tile(8, tile_nodes), v(lanes, 3), factor
      integer :: c, s, i, rows(grid%lattice%reach**3), offsets(grid%lattice%reach**3)
      type(frame_t) :: frame

      power = 0
      factor = curve_value(load%curve, time)
      if (.not. abs(factor) > 0) return
      offsets = stencil_offsets(grid%lattice)
      do c = 1, p%n_chunks
         if (.not. is_loaded(load, p, c)) cycle
         call force_of_lanes(load, p, grid, c, factor, force, q)
         frame = face_frame(p, grid, c)
         s = sided_bin(sided, p%bin(c))
         if (s > 0) then
            call gather_sides(p, c, kernels, sided, s, offsets, frame, grid, field, v)
         else
            rows = rows_of_bin(grid, p%bin(c), offsets)
            do i = 1, size(rows)
               tile(:, 1 + offsets(i)) = grid%node(:, rows(i))
            end do
            call kernels%gather(q, frame, tile, field, v)
         end if
         power = power + sum(force*v)
      end do
   end function power_of_load

   !> Force of the load on the lanes of a chunk, 0 where it acts on none.
   subroutine force_on_lanes(load, p, grid, c, time, force)
      type(load_t), intent(in) :: load
      type(particles_t), intent(in) :: p
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: c                   !! chunk
      real(wp), intent(in) :: time               !! [time]
      real(wp), intent(out) :: force(lanes, 3)
      real(wp) :: q(lanes, 14)

      force = 0
      if (is_loaded(load, p, c)) then
         call force_of_lanes(load, p, grid, c, curve_value(load%curve, time), force, q)
      end if
   end subroutine force_on_lanes

   pure function is_loaded(load, p, c) result(holds)
      type(load_t), intent(in) :: load
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c
      logical :: holds

      holds = p%count(c) > 0 .and. btest(p%any_set(c), load%set)
   end function is_loaded

   pure function sided_bin(sided, bin) result(s)
      type(sided_t), intent(in) :: sided
      integer, intent(in) :: bin
      integer :: s

      s = 0
      if (sided%n > 0) s = sided%bin(1 + mod(bin - 1, bins_per_block), 1 + (bin - 1)/bins_per_block)
   end function sided_bin

   !> Frame of a chunk's bin that makes particles points.
   pure function face_frame(p, grid, c) result(frame)
      type(particles_t), intent(in) :: p
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: c
      type(frame_t) :: frame

      frame%corner = bin_corner(grid%lattice, bin_of_chunk(p, grid%blocks, c))
      frame%per_size = 1/grid%lattice%size
      frame%half = point
   end function face_frame

   !> Force on each lane, and the lanes moved out to the face, but not out of the cell: a node
   !> beyond it, to which GIMP gives no mass or next to none, must not take a share of the force,
   !> not even that of a point's width.
   subroutine force_of_lanes(load, p, grid, c, factor, force, q)
      type(load_t), intent(in) :: load
      type(particles_t), intent(in) :: p
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: c
      real(wp), intent(in) :: factor
      real(wp), intent(out) :: force(lanes, 3), q(lanes, 14)
      real(wp) :: area(3), corner(3), low(3), high(3), size
      integer :: i, at

      corner = bin_corner(grid%lattice, bin_of_chunk(p, grid%blocks, c))
      size = grid%lattice%size
      q = p%q(:, :, c)
      force = 0
      do i = 1, p%count(c)
         if (.not. btest(p%sets(i, c), load%set)) cycle
         at = find(load%table, p%id(i, c))
         if (at == 0) cycle
         area = load%table%area(:, at)
         force(i, :) = factor*(load%traction*norm2(area) - load%pressure*area)
         low = corner
         high = corner + size
         if (grid%lattice%shape == gimp_shape) then
            where (q(i, 1:3) < corner + 0.5_wp*size)
               high = corner + (0.5_wp - point)*size
            else where
               low = corner + (0.5_wp + point)*size
            end where
         end if
         q(i, 1:3) = q(i, 1:3) + load%table%offset(:, at)
         q(i, 1:3) = max(low, min(high, q(i, 1:3)))
      end do
   end subroutine force_of_lanes

   !> Rows of the stencil of a bin on its ordinary nodes.
   pure function rows_of_bin(grid, bin, offsets) result(rows)
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: bin          !! 64 (block - 1) + bin of the block
      integer, intent(in) :: offsets(:)   !! tile nodes of the stencil, less the first
      integer :: rows(size(offsets)), base(bins_per_block)

      base = tile_base(grid%lattice)
      rows = grid%blocks%tile(base(1 + mod(bin - 1, bins_per_block)) + offsets, &
         1 + (bin - 1)/bins_per_block)
   end function rows_of_bin
end module xmpm_loads
