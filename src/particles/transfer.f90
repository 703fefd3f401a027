!> P2G and G2P: walks over blocks, bins and chunks that hand plain arrays to the kernels.
!>
!> A block's rows are copied to a small dense tile, worked on there, and added back once. Bins that
!> touch split nodes bypass the tile, set of rows by set of rows.
module xmpm_transfer
   use xmpm_kinds, only: wp
   use xmpm_law, only: law_t
   use xmpm_lattice, only: stencil_offsets
   use xmpm_blocks, only: nodes_per_block
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, lanes, c_x, c_m, n_hot, is_traced
   use xmpm_trace, only: follow_chunk
   use xmpm_fetch_ahead, only: fetch_bin, fetch_traces, fetch_rows
   use xmpm_kernels, only: kernels_t, tile_nodes
   use xmpm_motion, only: tally_t, lane_tally_t, reduce_tally, change_velocity, note_motion, &
      move_lanes
   use xmpm_sided, only: sided_t
   use xmpm_bin_list, only: bin_list_t, list_bins
   use xmpm_sided_transfer, only: scatter_sided, velocity_sided, gradient_sided, mean_sided
   implicit none
   private

   public :: tally_t, law_slot_t, bodies_t
   public :: particles_to_grid, update_velocity, smooth_velocity, update_stress, advance_positions

   !> One constitutive law among others.
   type :: law_slot_t
      class(law_t), allocatable :: law   !! the law
   end type law_slot_t

   !> What the transfers must know of the bodies.
   type :: bodies_t
      type(law_slot_t), allocatable :: laws(:)   !! constitutive laws
      integer, allocatable :: law_of(:)          !! (bodies) law of each body
      real(wp), allocatable :: half(:)           !! (bodies) half a particle's width [cells]
   end type bodies_t

contains

   !> Mass, momentum and internal force of the rows (eq. 6, 7, 23 to 28).
   subroutine particles_to_grid(p, bodies, kernels, sided, first, last, grid)
      type(particles_t), intent(in) :: p
      type(bodies_t), intent(in) :: bodies
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      integer, intent(in) :: first, last      !! blocks to work on
      type(grid_t), intent(inout) :: grid     !! fields 1:7 are added to
      real(wp) :: tile(8, tile_nodes)
      type(bin_list_t) :: bins
      integer :: offsets(grid%lattice%reach**3), b, k, c, n

      offsets = stencil_offsets(grid%lattice)
      n = size(grid%blocks%tile, 1)
      do b = first, last
         call list_bins(p, sided, grid, b, bins)
         tile(:, :n) = 0
         do k = 1, bins%n
            c = bins%first(k)
            call fetch_rows(grid, b + 1, k)
            call fetch_bin(p, bins%first(k + 2), c_x, n_hot)
            bins%frame(k)%half = bodies%half(p%body(c))
            if (bins%sided(k) > 0) then
               call scatter_sided(p, c, kernels, sided, bins%sided(k), offsets, bins%frame(k), grid)
               cycle
            end if
            do while (c > 0)
               bins%frame(k)%half = bodies%half(p%body(c))
               call kernels%scatter(p%count(c), p%q(:, :, c), bins%frame(k), tile)
               c = p%next(c)
            end do
         end do
         call add_tile(grid, b, tile)
      end do
   end subroutine particles_to_grid

   !> Add a block's tile to its rows.
   pure subroutine add_tile(grid, b, tile)
      type(grid_t), intent(inout) :: grid
      integer, intent(in) :: b
      real(wp), intent(in) :: tile(8, tile_nodes)
      integer :: f, i, row

      do i = 1, size(grid%blocks%tile, 1)
         ! A node at the rim of a particle's support can take force without mass.
         if (.not. tile(1, i) > 0) then
            if (.not. any(abs(tile(:, i)) > 0)) cycle
         end if
         row = grid%blocks%tile(i, b)
         !$omp simd
         do f = 1, 8
            grid%node(f, row) = grid%node(f, row) + tile(f, i)
         end do
         grid%active(1 + (row - 1)/nodes_per_block) = .true.
      end do
   end subroutine add_tile

   !> Copy the rows of a block to its tile.
   pure subroutine load_tile(grid, b, tile)
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: b
      real(wp), intent(inout) :: tile(8, tile_nodes)
      integer :: f, i

      do i = 1, size(grid%blocks%tile, 1)
         !$omp simd
         do f = 1, 8
            tile(f, i) = grid%node(f, grid%blocks%tile(i, b))
         end do
      end do
   end subroutine load_tile

   !> Add a block's sums of m v to grid%second.
   pure subroutine add_second(grid, b, second)
      type(grid_t), intent(inout) :: grid
      integer, intent(in) :: b
      real(wp), intent(in) :: second(4, tile_nodes)
      integer :: i, row

      do i = 1, size(grid%blocks%tile, 1)
         row = grid%blocks%tile(i, b)
         grid%second(1, row) = grid%second(1, row) + second(1, i)
         grid%second(2, row) = grid%second(2, row) + second(2, i)
         grid%second(3, row) = grid%second(3, row) + second(3, i)
      end do
   end subroutine add_second

   !> Particle velocities from the rows' change, and MUSL's second map (eq. 43).
   !>
   !> v = keep v + sum N change; keep is 1 for FLIP. Where `remap` is asked for, m v of the new
   !> velocity is added to grid%second.
   subroutine update_velocity(p, bodies, kernels, sided, first, last, keep, remap, grid, tally)
      type(particles_t), intent(inout) :: p
      type(bodies_t), intent(in) :: bodies
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      integer, intent(in) :: first, last      !! blocks to work on
      real(wp), intent(in) :: keep            !! share of the old velocity that is kept
      logical, intent(in) :: remap            !! whether the second map is wanted
      type(grid_t), intent(inout) :: grid
      type(tally_t), intent(inout) :: tally
      real(wp) :: tile(8, tile_nodes), second(4, tile_nodes), value(lanes, 3)
      type(bin_list_t) :: bins
      type(lane_tally_t) :: part
      integer :: offsets(grid%lattice%reach**3), b, k, c

      offsets = stencil_offsets(grid%lattice)
      do b = first, last
         call list_bins(p, sided, grid, b, bins)
         call load_tile(grid, b, tile)
         second = 0
         do k = 1, bins%n
            c = bins%first(k)
            call fetch_rows(grid, b + 1, k)
            call fetch_bin(p, bins%first(k + 2), c_x, c_m)
            bins%frame(k)%half = bodies%half(p%body(c))
            if (bins%sided(k) > 0) then
               call velocity_sided(p, c, kernels, sided, bins%sided(k), offsets, bins%frame(k), &
                  keep, remap, grid)
               do while (c > 0)
                  call note_motion(p%q(:, :, c), part%kinetic, part%speed2)
                  c = p%next(c)
               end do
               cycle
            end if
            do while (c > 0)
               bins%frame(k)%half = bodies%half(p%body(c))
               call kernels%gather(p%q(:, :, c), bins%frame(k), tile, 5, value)
               call change_velocity(keep, p%q(:, :, c), value, part%kinetic, part%speed2)
               if (remap) call kernels%push(p%count(c), p%q(:, :, c), value, bins%frame(k), second)
               c = p%next(c)
            end do
         end do
         if (remap) call add_second(grid, b, second)
      end do
      call reduce_tally(part, tally)
   end subroutine update_velocity

   !> Momentum of what is interpolated from three fields: sum m N (S v) to grid%second.
   subroutine smooth_velocity(p, bodies, kernels, sided, first, last, field, grid)
      type(particles_t), intent(in) :: p
      type(bodies_t), intent(in) :: bodies
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      integer, intent(in) :: first, last      !! blocks to work on
      integer, intent(in) :: field            !! first of the three: 2 or 5
      type(grid_t), intent(inout) :: grid
      real(wp) :: tile(8, tile_nodes), second(4, tile_nodes), value(lanes, 3)
      type(bin_list_t) :: bins
      integer :: offsets(grid%lattice%reach**3), b, k, c, i

      offsets = stencil_offsets(grid%lattice)
      do b = first, last
         call list_bins(p, sided, grid, b, bins)
         call load_tile(grid, b, tile)
         second = 0
         do k = 1, bins%n
            c = bins%first(k)
            call fetch_rows(grid, b + 1, k)
            call fetch_bin(p, bins%first(k + 2), c_x, c_m)
            bins%frame(k)%half = bodies%half(p%body(c))
            if (bins%sided(k) > 0) then
               call mean_sided(p, c, kernels, sided, bins%sided(k), offsets, bins%frame(k), field, &
                  grid)
               cycle
            end if
            do while (c > 0)
               bins%frame(k)%half = bodies%half(p%body(c))
               call kernels%gather(p%q(:, :, c), bins%frame(k), tile, field, value)
               do i = 1, 3
                  value(:, i) = value(:, i)*p%q(:, c_m, c)
               end do
               call kernels%push(p%count(c), p%q(:, :, c), value, bins%frame(k), second)
               c = p%next(c)
            end do
         end do
         call add_second(grid, b, second)
      end do
   end subroutine smooth_velocity

   !> Stress and volume from the gradient of fields 5:7 (eq. 45, 46), and positions from fields 2:4
   !> (eq. 44) where `move` is positive; chunks with particles that left their bin are listed.
   subroutine update_stress(p, bodies, kernels, sided, grid, dt, move, tally, movers, n_movers)
      type(particles_t), intent(inout) :: p
      type(bodies_t), intent(in) :: bodies
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      type(grid_t), intent(in) :: grid
      real(wp), intent(in) :: dt                     !! of the strain increment [time]
      real(wp), intent(in) :: move                   !! of the change of position [time]
      type(tally_t), intent(inout) :: tally
      integer, intent(inout) :: movers(:)            !! chunks that particles left
      integer, intent(inout) :: n_movers             !! number of them
      real(wp) :: tile(8, tile_nodes), gradient(lanes, 9), value(lanes, 3), work(lanes)
      type(bin_list_t) :: bins
      type(lane_tally_t) :: part
      integer :: offsets(grid%lattice%reach**3), b, k, c
      logical :: left

      offsets = stencil_offsets(grid%lattice)
      do b = 1, grid%blocks%n
         call list_bins(p, sided, grid, b, bins)
         call load_tile(grid, b, tile)
         do k = 1, bins%n
            c = bins%first(k)
            call fetch_rows(grid, b + 1, k)
            call fetch_bin(p, bins%first(k + 2), c_x, c_x + 2)
            call fetch_bin(p, bins%first(k + 2), c_m, n_hot)
            call fetch_traces(p, bins%first(k + 2))
            do while (c > 0)
               bins%frame(k)%half = bodies%half(p%body(c))
               if (bins%sided(k) == 0) then
                  call kernels%gradient(p%q(:, :, c), bins%frame(k), tile, gradient, value)
               else
                  call gradient_sided(p, c, kernels, sided, bins%sided(k), offsets, &
                     bins%frame(k), grid, gradient, value)
               end if
               work = 0
               call bodies%laws(bodies%law_of(p%body(c)))%law%update(gradient, dt, p%q(:, :, c), &
                  work)
               part%work = part%work + work
               if (is_traced(p, c)) call follow_chunk(p, c, gradient, dt, work)
               call move_lanes(value, move, bins%frame(k), p%q(:, :, c), part%volume, left)
               if (left) then
                  n_movers = n_movers + 1
                  movers(n_movers) = c
               end if
               c = p%next(c)
            end do
         end do
      end do
      call reduce_tally(part, tally)
   end subroutine update_stress

   !> Move the particles with fields 2:4 of the rows and nothing else (USF).
   subroutine advance_positions(p, bodies, kernels, sided, grid, dt, tally, movers, n_movers)
      type(particles_t), intent(inout) :: p
      type(bodies_t), intent(in) :: bodies
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      type(grid_t), intent(in) :: grid
      real(wp), intent(in) :: dt                     !! [time]
      type(tally_t), intent(inout) :: tally
      integer, intent(inout) :: movers(:)            !! chunks that particles left
      integer, intent(inout) :: n_movers             !! number of them
      real(wp) :: tile(8, tile_nodes), gradient(lanes, 9), value(lanes, 3)
      type(bin_list_t) :: bins
      type(lane_tally_t) :: part
      integer :: offsets(grid%lattice%reach**3), b, k, c
      logical :: left

      offsets = stencil_offsets(grid%lattice)
      do b = 1, grid%blocks%n
         call list_bins(p, sided, grid, b, bins)
         call load_tile(grid, b, tile)
         do k = 1, bins%n
            c = bins%first(k)
            call fetch_rows(grid, b + 1, k)
            call fetch_bin(p, bins%first(k + 2), c_x, c_m)
            do while (c > 0)
               bins%frame(k)%half = bodies%half(p%body(c))
               if (bins%sided(k) == 0) then
                  call kernels%gather(p%q(:, :, c), bins%frame(k), tile, 2, value)
               else
                  call gradient_sided(p, c, kernels, sided, bins%sided(k), offsets, &
                     bins%frame(k), grid, gradient, value)
               end if
               call move_lanes(value, dt, bins%frame(k), p%q(:, :, c), part%volume, left)
               if (left) then
                  n_movers = n_movers + 1
                  movers(n_movers) = c
               end if
               c = p%next(c)
            end do
         end do
      end do
      call reduce_tally(part, tally)
   end subroutine advance_positions
end module xmpm_transfer
