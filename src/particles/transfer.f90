!> P2G and G2P: walks over blocks, bins and chunks that hand plain arrays to the kernels.
!>
!> A block's rows are copied to a small dense tile, worked on there, and added back once. Bins that
!> touch split nodes bypass the tile, set of rows by set of rows.
module xmpm_transfer
   use xmpm_kinds, only: wp
   use xmpm_law, only: law_t
   use xmpm_lattice, only: tile_base, stencil_offsets, bin_corner, bins_per_block, block_width
   use xmpm_blocks, only: nodes_per_block
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, lanes, c_v, c_m, c_vol, c_x, is_traced
   use xmpm_trace, only: follow_chunk
   use xmpm_frame, only: frame_t
   use xmpm_kernels, only: kernels_t, tile_nodes
   use xmpm_sided, only: sided_t
   use xmpm_sided_transfer, only: scatter_sided, velocity_sided, gradient_sided, mean_sided
   implicit none
   private

   public :: tally_t, law_slot_t, bodies_t
   public :: particles_to_grid, update_velocity, smooth_velocity, update_stress, advance_positions

   !> Sums over particles that a step yields as it goes.
   type :: tally_t
      real(wp) :: kinetic = 0                        !! kinetic energy after the velocity update
      real(wp) :: work = 0                           !! stress work of the step
      real(wp) :: speed2 = 0                         !! largest square of a speed
      real(wp) :: volume = huge(1.0_wp)              !! smallest volume over its particle's mass
   end type tally_t

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
      real(wp) :: corners(3, bins_per_block)
      type(frame_t) :: frame
      integer :: base(bins_per_block), offsets(grid%lattice%reach**3), b, k, c, i, n, row

      base = tile_base(grid%lattice)
      offsets = stencil_offsets(grid%lattice)
      n = size(grid%blocks%tile, 1)
      do b = first, last
         call start_block(grid, b, frame, corners)
         tile(:, :n) = 0
         do k = 1, bins_per_block
            c = p%head(k, b)
            if (c == 0) cycle
            frame%corner = corners(:, k)
            frame%base = base(k)
            frame%half = bodies%half(p%body(c))
            if (sided%n > 0) then
               if (sided%bin(k, b) > 0) then
                  call scatter_sided(p, c, kernels, sided, sided%bin(k, b), offsets, frame, grid)
                  cycle
               end if
            end if
            do while (c > 0)
               frame%half = bodies%half(p%body(c))
               call kernels%scatter(p%count(c), p%q(:, :, c), frame, tile)
               c = p%next(c)
            end do
         end do
         do i = 1, n
            row = grid%blocks%tile(i, b)
            if (.not. any(abs(tile(:, i)) > 0)) cycle
            grid%node(:, row) = grid%node(:, row) + tile(:, i)
            grid%active(1 + (row - 1)/nodes_per_block) = .true.
         end do
      end do
   end subroutine particles_to_grid

   !> What all bins of a walk have in common, and the lower corners of a block's bins.
   pure subroutine start_block(grid, b, frame, corners)
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: b                                !! block
      type(frame_t), intent(inout) :: frame                   !! scale is set
      real(wp), intent(out) :: corners(3, bins_per_block)     !! [length]
      real(wp) :: corner(3), h
      integer :: k

      h = grid%lattice%size
      frame%per_size = 1/h
      corner = bin_corner(grid%lattice, block_width*grid%blocks%place(:, b))
      do k = 0, bins_per_block - 1
         corners(1, k + 1) = corner(1) + h*real(iand(k, 3), wp)
         corners(2, k + 1) = corner(2) + h*real(iand(shifta(k, 2), 3), wp)
         corners(3, k + 1) = corner(3) + h*real(shifta(k, 4), wp)
      end do
   end subroutine start_block

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
      real(wp) :: corners(3, bins_per_block)
      type(frame_t) :: frame
      integer :: base(bins_per_block), offsets(grid%lattice%reach**3), b, k, c, n, i

      base = tile_base(grid%lattice)
      offsets = stencil_offsets(grid%lattice)
      n = size(grid%blocks%tile, 1)
      do b = first, last
         call start_block(grid, b, frame, corners)
         call load_tile(grid, b, tile)
         second(:, :n) = 0
         do k = 1, bins_per_block
            c = p%head(k, b)
            if (c == 0) cycle
            frame%corner = corners(:, k)
            frame%base = base(k)
            frame%half = bodies%half(p%body(c))
            if (sided%n > 0) then
               if (sided%bin(k, b) > 0) then
                  call velocity_sided(p, c, kernels, sided, sided%bin(k, b), offsets, frame, keep, &
                     remap, grid)
                  do while (c > 0)
                     call add_motion(p%q(:, :, c), tally)
                     c = p%next(c)
                  end do
                  cycle
               end if
            end if
            do while (c > 0)
               frame%half = bodies%half(p%body(c))
               call kernels%gather(p%q(:, :, c), frame, tile, 5, value)
               call change_velocity(value, keep, p%q(:, :, c))
               call add_motion(p%q(:, :, c), tally)
               if (remap) then
                  call momentum_of(p%q(:, :, c), value)
                  call kernels%push(p%count(c), p%q(:, :, c), value, frame, second)
               end if
               c = p%next(c)
            end do
         end do
         if (.not. remap) cycle
         do i = 1, n
            grid%second(:, grid%blocks%tile(i, b)) = grid%second(:, grid%blocks%tile(i, b)) &
               + second(:3, i)
         end do
      end do
   end subroutine update_velocity

   !> Copy the rows of a block to its tile.
   pure subroutine load_tile(grid, b, tile)
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: b
      real(wp), intent(inout) :: tile(8, tile_nodes)
      integer :: i

      do i = 1, size(grid%blocks%tile, 1)
         tile(:, i) = grid%node(:, grid%blocks%tile(i, b))
      end do
   end subroutine load_tile

   pure subroutine change_velocity(change, keep, q)
      real(wp), intent(in) :: change(lanes, 3), keep
      real(wp), intent(inout) :: q(lanes, 14)
      integer :: i, p

      do i = 1, 3
         !$omp simd
         do p = 1, lanes
            q(p, 3 + i) = merge(keep*q(p, 3 + i) + change(p, i), 0.0_wp, q(p, c_m) > 0)
         end do
      end do
   end subroutine change_velocity

   pure subroutine momentum_of(q, value)
      real(wp), intent(in) :: q(lanes, 14)
      real(wp), intent(out) :: value(lanes, 3)
      integer :: i

      do i = 1, 3
         value(:, i) = q(:, c_m)*q(:, 3 + i)
      end do
   end subroutine momentum_of

   pure subroutine add_motion(q, tally)
      real(wp), intent(in) :: q(lanes, 14)
      type(tally_t), intent(inout) :: tally
      real(wp) :: square(lanes), kinetic, fastest
      integer :: p

      kinetic = 0
      fastest = tally%speed2
      !$omp simd reduction(+:kinetic)
      do p = 1, lanes
         square(p) = q(p, c_v)**2 + q(p, c_v + 1)**2 + q(p, c_v + 2)**2
         kinetic = kinetic + q(p, c_m)*square(p)
      end do
      !$omp simd reduction(max:fastest)
      do p = 1, lanes
         fastest = max(fastest, square(p))
      end do
      tally%kinetic = tally%kinetic + 0.5_wp*kinetic
      tally%speed2 = fastest
   end subroutine add_motion

   !> Momentum of the velocity interpolated from fields 2:4, for XPIC: sum m N (S v) to grid%second.
   subroutine smooth_velocity(p, bodies, kernels, sided, first, last, grid)
      type(particles_t), intent(in) :: p
      type(bodies_t), intent(in) :: bodies
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      integer, intent(in) :: first, last      !! blocks to work on
      type(grid_t), intent(inout) :: grid
      real(wp) :: tile(8, tile_nodes), second(4, tile_nodes), value(lanes, 3)
      real(wp) :: corners(3, bins_per_block)
      type(frame_t) :: frame
      integer :: base(bins_per_block), offsets(grid%lattice%reach**3), b, k, c, i

      base = tile_base(grid%lattice)
      offsets = stencil_offsets(grid%lattice)
      do b = first, last
         call start_block(grid, b, frame, corners)
         call load_tile(grid, b, tile)
         second = 0
         do k = 1, bins_per_block
            c = p%head(k, b)
            if (c == 0) cycle
            frame%corner = corners(:, k)
            frame%base = base(k)
            frame%half = bodies%half(p%body(c))
            if (sided%n > 0) then
               if (sided%bin(k, b) > 0) then
                  call mean_sided(p, c, kernels, sided, sided%bin(k, b), offsets, frame, grid)
                  cycle
               end if
            end if
            do while (c > 0)
               frame%half = bodies%half(p%body(c))
               call kernels%gather(p%q(:, :, c), frame, tile, 2, value)
               do i = 1, 3
                  value(:, i) = value(:, i)*p%q(:, c_m, c)
               end do
               call kernels%push(p%count(c), p%q(:, :, c), value, frame, second)
               c = p%next(c)
            end do
         end do
         do i = 1, size(grid%blocks%tile, 1)
            grid%second(:, grid%blocks%tile(i, b)) = grid%second(:, grid%blocks%tile(i, b)) &
               + second(:3, i)
         end do
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
      real(wp) :: tile(8, tile_nodes), gradient(lanes, 9), value(lanes, 3), work(lanes), &
         power(lanes)
      real(wp) :: corners(3, bins_per_block)
      type(frame_t) :: frame
      integer :: base(bins_per_block), offsets(grid%lattice%reach**3), b, k, c, s
      logical :: left

      base = tile_base(grid%lattice)
      offsets = stencil_offsets(grid%lattice)
      work = 0
      do b = 1, grid%blocks%n
         call start_block(grid, b, frame, corners)
         call load_tile(grid, b, tile)
         do k = 1, bins_per_block
            c = p%head(k, b)
            if (c == 0) cycle
            frame%corner = corners(:, k)
            frame%base = base(k)
            frame%half = bodies%half(p%body(c))
            s = 0
            if (sided%n > 0) s = sided%bin(k, b)
            do while (c > 0)
               frame%half = bodies%half(p%body(c))
               if (s == 0) then
                  call kernels%gradient(p%q(:, :, c), frame, tile, gradient, value)
               else
                  call gradient_sided(p, c, kernels, sided, s, offsets, frame, grid, gradient, &
                     value)
               end if
               power = 0
               call bodies%laws(bodies%law_of(p%body(c)))%law%update(gradient, dt, p%q(:, :, c), &
                  power)
               work = work + power
               if (is_traced(p, c)) call follow_chunk(p, c, gradient, dt, power)
               call move_lanes(value, move, frame, p%q(:, :, c), tally%volume, left)
               if (left) then
                  n_movers = n_movers + 1
                  movers(n_movers) = c
               end if
               c = p%next(c)
            end do
         end do
      end do
      tally%work = tally%work + sum(work)
   end subroutine update_stress

   !> Move the lanes of a chunk; tells whether one left the bin.
   pure subroutine move_lanes(value, move, frame, q, volume, left)
      real(wp), intent(in) :: value(lanes, 3), move
      type(frame_t), intent(in) :: frame
      real(wp), intent(inout) :: q(lanes, 14), volume
      logical, intent(out) :: left
      real(wp) :: far, t, least
      integer :: i, p

      far = 0
      least = volume
      do i = 1, 3
         !$omp simd private(t) reduction(max:far)
         do p = 1, lanes
            q(p, i) = q(p, i) + merge(move*value(p, i), 0.0_wp, q(p, c_m) > 0)
            t = (q(p, i) - frame%corner(i))*frame%per_size
            far = max(far, abs(t - 0.5_wp))
         end do
      end do
      !$omp simd reduction(min:least)
      do p = 1, lanes
         least = min(least, merge(q(p, c_vol), huge(1.0_wp), q(p, c_m) > 0))
      end do
      volume = least
      left = .not. far < 0.5_wp
   end subroutine move_lanes

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
      real(wp) :: corners(3, bins_per_block)
      type(frame_t) :: frame
      integer :: base(bins_per_block), offsets(grid%lattice%reach**3), b, k, c, s
      logical :: left

      base = tile_base(grid%lattice)
      offsets = stencil_offsets(grid%lattice)
      do b = 1, grid%blocks%n
         call start_block(grid, b, frame, corners)
         call load_tile(grid, b, tile)
         do k = 1, bins_per_block
            c = p%head(k, b)
            if (c == 0) cycle
            frame%corner = corners(:, k)
            frame%base = base(k)
            frame%half = bodies%half(p%body(c))
            s = 0
            if (sided%n > 0) s = sided%bin(k, b)
            do while (c > 0)
               frame%half = bodies%half(p%body(c))
               if (s == 0) then
                  call kernels%gather(p%q(:, :, c), frame, tile, 2, value)
               else
                  call gradient_sided(p, c, kernels, sided, s, offsets, frame, grid, gradient, &
                     value)
               end if
               call move_lanes(value, dt, frame, p%q(:, :, c), tally%volume, left)
               if (left) then
                  n_movers = n_movers + 1
                  movers(n_movers) = c
               end if
               c = p%next(c)
            end do
         end do
      end do
   end subroutine advance_positions
end module xmpm_transfer
