!> What the grid resolves of fields that particles carry.
!>
!> Particles outnumber nodes, so stress and velocity have parts that no node sees: they exert no
!> force and no force changes them. A front that moves leaves much of the energy that it releases
!> in them. f = 2 S f - S S f, with S f = sum N f_I, f_I = sum V N f/sum V N on each side of the
!> cracks, takes them out and changes smooth fields by h**4 only.
module xmpm_resolved
   use xmpm_kinds, only: wp
   use xmpm_communicator, only: comm_t
   use xmpm_halo, only: halo_t, start_sum, finish_sum
   use xmpm_lattice, only: stencil_offsets, bins_per_block, bin_corner
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, lanes, c_vol, bin_of_chunk
   use xmpm_frame, only: frame_t
   use xmpm_transfer, only: bodies_t
   use xmpm_kernels, only: kernels_t, tile_nodes
   use xmpm_sided, only: sided_t, side_weights
   use xmpm_loads, only: rows_of_bin
   implicit none
   private

   public :: resolve_fields

   integer, parameter :: passes = 2   !! 2 S - S S is S of f and of what the first S left

contains

   !> Replace fields at the particles of some chunks by what the grid resolves of them; they count
   !> as 0 elsewhere. Collective.
   subroutine resolve_fields(chunks, comm, halo, grid, p, bodies, kernels, sided, values)
      integer, intent(in) :: chunks(:)
      type(comm_t), intent(in) :: comm
      type(halo_t), intent(inout) :: halo
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      type(bodies_t), intent(in) :: bodies
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      real(wp), intent(inout) :: values(:, :, :)   !! (8,3 n,chunks)
      real(wp), allocatable :: volume(:, :), sums(:, :), rest(:, :, :), mean(:, :, :)
      integer :: k, first, pass

      allocate (volume(3, grid%n_rows), sums(3, grid%n_rows))
      allocate (mean(lanes, 3, size(chunks)))
      allocate (rest(lanes, 3, size(chunks)), source=0.0_wp)
      rest(:, 1, :) = 1
      call push_all(chunks, comm, halo, grid, p, bodies, kernels, sided, rest, volume)
      do first = 1, size(values, 2), 3
         rest = values(:, first:first + 2, :)
         values(:, first:first + 2, :) = 0
         do pass = 1, passes
            call push_all(chunks, comm, halo, grid, p, bodies, kernels, sided, rest, sums)
            do k = 1, size(chunks)
               call gather_mean(chunks(k), grid, p, bodies, kernels, sided, volume, sums, &
                  mean(:, :, k))
            end do
            values(:, first:first + 2, :) = values(:, first:first + 2, :) + mean
            rest = rest - mean
         end do
      end do
   end subroutine resolve_fields

   !> Sums of V N f on all rows that the chunks reach. Collective.
   subroutine push_all(chunks, comm, halo, grid, p, bodies, kernels, sided, values, sums)
      integer, intent(in) :: chunks(:)
      type(comm_t), intent(in) :: comm
      type(halo_t), intent(inout) :: halo
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      type(bodies_t), intent(in) :: bodies
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      real(wp), intent(in) :: values(:, :, :)    !! (8,3,chunks)
      real(wp), intent(inout) :: sums(:, :)      !! (3,rows)
      real(wp) :: push(4, tile_nodes), g(lanes), part(lanes, 3)
      integer :: rows(grid%lattice%reach**3), offsets(grid%lattice%reach**3), k, set, i
      type(frame_t) :: frame

      offsets = stencil_offsets(grid%lattice)
      if (allocated(halo%shared)) sums(:, halo%shared) = 0
      do k = 1, size(chunks)
         do set = 0, sets_of(p, chunks(k), sided) - 1
            call rows_of_set(p, chunks(k), grid, sided, set, offsets, rows, g)
            sums(:, rows) = 0
         end do
      end do
      do k = 1, size(chunks)
         frame = frame_of(p, chunks(k), bodies, grid)
         do set = 0, sets_of(p, chunks(k), sided) - 1
            call rows_of_set(p, chunks(k), grid, sided, set, offsets, rows, g)
            if (.not. any(g > 0)) cycle
            do i = 1, 3
               part(:, i) = g*p%q(:, c_vol, chunks(k))*values(:, i, k)
            end do
            push(:, 1 + offsets) = 0
            call kernels%push(p%count(chunks(k)), p%q(:, :, chunks(k)), part, frame, push)
            do i = 1, size(rows)
               sums(:, rows(i)) = sums(:, rows(i)) + push(:3, 1 + offsets(i))
            end do
         end do
      end do
      call start_sum(halo, comm, sums, 1, 3)
      call finish_sum(halo, sums, 1, 3)
   end subroutine push_all

   !> Interpolate the nodal means to the lanes of a chunk.
   subroutine gather_mean(c, grid, p, bodies, kernels, sided, volume, sums, mean)
      integer, intent(in) :: c                       !! chunk
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      type(bodies_t), intent(in) :: bodies
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      real(wp), intent(in) :: volume(:, :), sums(:, :)   !! (3,rows)
      real(wp), intent(out) :: mean(:, :)                !! (8,3)
      real(wp) :: tile(8, tile_nodes), g(lanes), part(lanes, 3)
      integer :: rows(grid%lattice%reach**3), offsets(grid%lattice%reach**3), set, i
      type(frame_t) :: frame

      offsets = stencil_offsets(grid%lattice)
      frame = frame_of(p, c, bodies, grid)
      mean = 0
      do set = 0, sets_of(p, c, sided) - 1
         call rows_of_set(p, c, grid, sided, set, offsets, rows, g)
         if (.not. any(g > 0)) cycle
         do i = 1, size(rows)
            tile(:, 1 + offsets(i)) = 0
            if (volume(1, rows(i)) > 0) then
               tile(2:4, 1 + offsets(i)) = sums(:, rows(i))/volume(1, rows(i))
            end if
         end do
         call kernels%gather(p%q(:, :, c), frame, tile, 2, part)
         do i = 1, 3
            mean(:, i) = mean(:, i) + g*part(:, i)
         end do
      end do
   end subroutine gather_mean

   pure function frame_of(p, c, bodies, grid) result(frame)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c
      type(bodies_t), intent(in) :: bodies
      type(grid_t), intent(in) :: grid
      type(frame_t) :: frame

      frame%corner = bin_corner(grid%lattice, bin_of_chunk(p, grid%blocks, c))
      frame%per_size = 1/grid%lattice%size
      frame%half = bodies%half(p%body(c))
   end function frame_of

   !> Sets of sides that the bin of a chunk tells apart.
   pure function sets_of(p, c, sided) result(n)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c
      type(sided_t), intent(in) :: sided
      integer :: n, s

      n = 1
      s = sided_place(p, c, sided)
      if (s > 0) n = 2**sided%n_cracks(s)
   end function sets_of

   pure function sided_place(p, c, sided) result(s)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c
      type(sided_t), intent(in) :: sided
      integer :: s

      s = 0
      if (sided%n > 0) s = sided%bin(1 + mod(p%bin(c) - 1, bins_per_block), &
         1 + (p%bin(c) - 1)/bins_per_block)
   end function sided_place

   !> Rows of the stencil of a chunk's bin for a set of sides, and the set's weight in the lanes.
   pure subroutine rows_of_set(p, c, grid, sided, set, offsets, rows, g)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c, set, offsets(:)
      type(grid_t), intent(in) :: grid
      type(sided_t), intent(in) :: sided
      integer, intent(out) :: rows(:)
      real(wp), intent(out) :: g(lanes)
      real(wp) :: slope(lanes, 3)
      integer :: s

      s = sided_place(p, c, sided)
      g = 1
      if (s == 0) then
         rows = rows_of_bin(grid, p%bin(c), offsets)
      else
         call side_weights(p, c, sided%crack(:sided%n_cracks(s), s), set, g, slope)
         rows = sided%rows(:, set, s)
      end if
   end subroutine rows_of_set
end module xmpm_resolved
