!> A crack in the material: its surface, how the particles near it know it, and its motion.
module xmpm_crack
   use xmpm_kinds, only: wp
   use xmpm_text, only: to_text
   use xmpm_error, only: error_t, raise, code_numerics
   use xmpm_communicator, only: comm_t, sum_all, max_all
   use xmpm_lattice, only: lattice_t, bin_of, bin_corner, block_of, local_bin, gimp_shape
   use xmpm_blocks, only: local_block, owner_of
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, attach, bin_of_chunk, n_near, near_crack, near_side, &
      near_psi, near_phi, near_jump, near_slope, near_ahead, near_place, c_x
   use xmpm_sided, only: sided_t
   use xmpm_face_velocity, only: face_velocities
   use xmpm_surface, only: surface_t, refresh_geometry, fill_void
   use xmpm_surface_index, only: surface_index_t, nearest_t, build_index, refresh_index, &
      nearest_on_surface
   use xmpm_front, only: front_t, front_place_t, front_test_points, mark_front, refresh_front, &
      vertex_phi, nearest_on_front, beyond_reach
   use xmpm_level_sets, only: level_sets_at
   use xmpm_ramp, only: jump_weight
   implicit none
   private

   public :: crack_t, start_crack, find_near, advance_crack, gather_crack, has_drifted, near_reach
   public :: advance_ramp, replace_surface, weigh_vertices
   public :: rule_graded, rule_node, rule_full, rule_cut

   integer, parameter :: rule_graded = 1   !! H falls from 1 to 0 over a ramp at the front
   integer, parameter :: rule_node = 2     !! nodes well behind the front
   integer, parameter :: rule_full = 3     !! nodes of cells that are cut all through
   integer, parameter :: rule_cut = 4      !! nodes of every cell that the crack touches

   real(wp), parameter :: drift = 0.02_wp  !! relative motion after which level sets are renewed
                                           !! [cells]
   real(wp), parameter :: wide = 0.1_wp    !! faces so far apart have left each other's nodes
                                           !! [cells]
   real(wp), parameter :: close = 0.02_wp  !! particles so near to the surface keep their side
                                           !! [cells]
   real(wp), parameter :: touching = 1e-6_wp   !! a vertex so near to a bin touches it [cells]
   real(wp), parameter :: tie = 1e-9_wp    !! particles so little above lie in the surface, which is
                                           !! below [cells]

   !> One crack.
   type :: crack_t
      character(len=:), allocatable :: name      !! from the deck
      type(surface_t) :: surface                 !! triangles, replicated on all ranks
      type(surface_index_t) :: index             !! finds the nearest triangle
      type(front_t) :: front                     !! edges inside the material
      integer :: rule = rule_graded              !! which nodes are split near the front
      real(wp) :: ramp = 0.5_wp                  !! length of the ramp [cells]
      real(wp) :: ramp_end = 0.4_wp              !! where it ends ahead of the front [cells]
      real(wp), allocatable :: offset(:)         !! (nn) how far the crack has come past the front
                                                 !! of
                                                 !! the mesh, unallocated where it does not grow
                                                 !! [length]
      logical, allocatable :: mine(:)            !! (nv) vertices that this rank moves
      logical, allocatable :: material(:)        !! (nv) whether there was mass around
      real(wp), allocatable :: weight(:)         !! (nv) H at the vertices
      real(wp), allocatable :: evaluated(:, :)   !! (3,nv) vertices when level sets were last found
      logical :: stale = .false.                 !! a vertex left the blocks of its rank
   end type crack_t

contains

   !> Find the fronts of a new crack and who moves its vertices. Collective.
   subroutine start_crack(crack, comm, grid, p)
      type(crack_t), intent(inout) :: crack    !! surface and rule are given
      type(comm_t), intent(in) :: comm
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      real(wp), allocatable :: points(:, :), full(:)
      integer :: i, b, bin(3)

      call build_index(crack%surface, crack%index)
      call front_test_points(crack%surface, grid%lattice%size, points)
      allocate (full(size(points, 2)), source=0.0_wp)
      do i = 1, size(full)
         bin = bin_of(grid%lattice, points(:, i))
         b = local_block(grid%blocks, block_of(bin))
         if (b == 0) cycle
         if (p%head(local_bin(bin), b) > 0) full(i) = 1
      end do
      call max_all(comm, full)
      call mark_front(crack%surface, full > 0.5_wp, crack%front)
      allocate (crack%material(crack%surface%vertex_count), source=.true.)
      allocate (crack%weight(crack%surface%vertex_count))
      crack%evaluated = crack%surface%x
      call take_vertices(crack, comm%rank, grid)
      call weigh_vertices(crack, grid%lattice%size)
   end subroutine start_crack

   !> Which vertices this rank moves: those in its blocks.
   subroutine take_vertices(crack, rank, grid)
      type(crack_t), intent(inout) :: crack
      integer, intent(in) :: rank
      type(grid_t), intent(in) :: grid
      integer :: v

      if (.not. allocated(crack%mine)) allocate (crack%mine(crack%surface%vertex_count))
      do v = 1, size(crack%mine)
         crack%mine(v) = owner_of(grid%blocks, &
            block_of(bin_of_vertex(grid, place_of(crack%surface, v)))) == rank
      end do
      crack%stale = .false.
   end subroutine take_vertices

   !> Where a vertex is now: between both faces. The geometry has the places of its last renewal.
   pure function place_of(surface, v) result(x)
      type(surface_t), intent(in) :: surface
      integer, intent(in) :: v   !! vertex
      real(wp) :: x(3)           !! [length]

      x = surface%start(:, v) + 0.5_wp*(surface%up(:, v) + surface%um(:, v))
   end function place_of

   !> Bin whose nodes move a vertex: the one that it is in or, where no block has that, one that it
   !> touches. Vertices on the surface of a body are not left to rounding so.
   pure function bin_of_vertex(grid, x) result(bin)
      type(grid_t), intent(in) :: grid
      real(wp), intent(in) :: x(3)   !! [length]
      integer :: bin(3), i

      bin = bin_of(grid%lattice, x)
      do i = 0, 26
         if (owner_of(grid%blocks, block_of(bin)) >= 0) return
         bin = bin_of(grid%lattice, x + touching*grid%lattice%size &
            *real([mod(i, 3), mod(i/3, 3), i/9] - 1, wp))
      end do
      bin = bin_of(grid%lattice, x)
   end function bin_of_vertex

   !> H at the vertices, from their distance to the front.
   subroutine weigh_vertices(crack, h)
      type(crack_t), intent(inout) :: crack
      real(wp), intent(in) :: h   !! cell size [length]
      type(front_place_t) :: place
      real(wp), allocatable :: phi(:)
      real(wp) :: slope(3)
      integer :: v

      crack%weight = 1
      if (crack%rule /= rule_graded) return
      allocate (phi(crack%surface%vertex_count))
      call vertex_phi(crack%surface, crack%front, phi)
      do v = 1, size(phi)
         if (allocated(crack%offset) .and. crack%front%edge_count > 0) then
            call nearest_on_front(crack%front, crack%surface%x(:, v), beyond_reach, place)
            phi(v) = phi(v) - offset_at(crack, place_code(place))
         end if
         call jump_weight(1.0_wp, phi(v), [1.0_wp, 0.0_wp, 0.0_wp], crack%ramp*h, &
            crack%ramp_end*h, &
            crack%weight(v), slope)
      end do
   end subroutine weigh_vertices

   !> A place of the front as one number: its edge plus part of it, 0 for none.
   pure function place_code(place) result(code)
      type(front_place_t), intent(in) :: place
      real(wp) :: code

      code = 0
      if (place%edge > 0) code = real(place%edge, wp) + min(place%fraction, 0.9999999_wp)
   end function place_code

   !> How far the crack has come past the front of the mesh at a place.
   pure function offset_at(crack, code) result(offset)
      type(crack_t), intent(in) :: crack
      real(wp), intent(in) :: code   !! of place_code
      real(wp) :: offset             !! [length]
      integer :: edge

      offset = 0
      edge = int(code)
      if (edge == 0 .or. .not. allocated(crack%offset)) return
      associate (node => crack%front%edge_node(:, edge), f => code - real(edge, wp))
         offset = (1 - f)*crack%offset(node(1)) + f*crack%offset(node(2))
      end associate
   end function offset_at

   !> Gradient of the offset: along the edge of the place.
   pure function offset_slope(crack, code) result(slope)
      type(crack_t), intent(in) :: crack
      real(wp), intent(in) :: code   !! of place_code
      real(wp) :: slope(3), t(3)
      integer :: edge

      slope = 0
      edge = int(code)
      if (edge == 0 .or. .not. allocated(crack%offset)) return
      associate (node => crack%front%edge_node(:, edge))
         t = crack%front%x(:, node(2)) - crack%front%x(:, node(1))
         slope = (crack%offset(node(2)) - crack%offset(node(1)))/dot_product(t, t)*t
      end associate
   end function offset_slope

   !> Distance from the surface within which particles know the crack [length].
   pure function near_reach(lattice) result(reach)
      type(lattice_t), intent(in) :: lattice
      real(wp) :: reach

      reach = merge(3.5_wp, 3.0_wp, lattice%shape == gimp_shape)*lattice%size
   end function near_reach

   !> Level sets and H of all particles near the crack. A side, once given behind the front, stays,
   !> and so does that of a particle that lies in the surface itself.
   !>
   !> With `grown` only those near the fronts: what growth has changed.
   subroutine find_near(crack, number, grid, p, error, grown)
      type(crack_t), intent(inout) :: crack
      integer, intent(in) :: number                       !! of the crack
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(inout) :: p
      type(error_t), allocatable, intent(out) :: error    !! too many cracks near a particle
      logical, intent(in), optional :: grown
      type(nearest_t) :: nearest
      real(wp) :: low(3), high(3), centre(3), reach, half
      integer :: c, hint
      logical :: ahead_only

      ahead_only = .false.
      if (present(grown)) ahead_only = grown
      call forget_places(number, p)
      half = 0.5_wp*grid%lattice%size
      reach = near_reach(grid%lattice) + sqrt(3.0_wp)*half
      low = minval(crack%surface%x, dim=2) - reach
      high = maxval(crack%surface%x, dim=2) + reach
      hint = 0
      do c = 1, p%n_chunks
         if (p%count(c) == 0) cycle
         centre = bin_corner(grid%lattice, bin_of_chunk(p, grid%blocks, c)) + half
         if (any(centre < low) .or. any(centre > high)) cycle
         if (ahead_only) then
            if (.not. beside_front(crack, centre, reach + 2*grid%lattice%size)) cycle
         end if
         call nearest_on_surface(crack%index, crack%surface, centre, reach, nearest, hint)
         hint = nearest%triangle
         if (hint == 0) cycle
         if (p%attached(c) == 0) call attach(p, c)
         call find_lanes(crack, number, grid%lattice%size, reach, hint, p, c, error)
         if (allocated(error)) return
      end do
      crack%evaluated = crack%surface%x
   end subroutine find_near

   pure function beside_front(crack, x, reach) result(is)
      type(crack_t), intent(in) :: crack
      real(wp), intent(in) :: x(3), reach
      logical :: is
      type(front_place_t) :: place

      call nearest_on_front(crack%front, x, reach, place)
      is = place%edge > 0
   end function beside_front

   !> Places of an older front are none of the present one.
   subroutine forget_places(number, p)
      integer, intent(in) :: number             !! of the crack
      type(particles_t), intent(inout) :: p
      integer :: c, k

      do c = 1, p%n_chunks
         if (p%count(c) == 0 .or. p%attached(c) == 0) cycle
         associate (near => p%near(:, :, p%attached(c)))
            do k = 0, n_near*(p%slots - 1), n_near
               where (nint(near(:, k + near_crack)) == number) near(:, k + near_place) = 0
            end do
         end associate
      end do
   end subroutine forget_places

   !> Level sets and H of one chunk.
   subroutine find_lanes(crack, number, h, reach, hint, p, c, error)
      type(crack_t), intent(in) :: crack
      integer, intent(in) :: number, hint, c
      real(wp), intent(in) :: h, reach
      type(particles_t), intent(inout) :: p
      type(error_t), allocatable, intent(out) :: error
      type(nearest_t) :: nearest
      type(front_place_t) :: place
      real(wp) :: x(3), psi, phi, ahead, code, e1(3), side, jump, slope(3)
      integer :: i, at

      associate (near => p%near(:, :, p%attached(c)))
         do i = 1, p%count(c)
            x = p%q(i, c_x:c_x + 2, c)
            call nearest_on_surface(crack%index, crack%surface, x, 2*reach, nearest, hint)
            call level_sets_at(crack%surface, crack%front, 2*reach, x, nearest, psi, ahead, e1, &
               place)
            code = place_code(place)
            phi = ahead - offset_at(crack, code)
            e1 = e1 - offset_slope(crack, code)
            if (psi >= 0.5_wp*beyond_reach) cycle
            at = slot_for(near(i, :n_near*p%slots), number)
            if (at < 0) then
               call raise(error, code_numerics, 'more than '//to_text(p%slots)// &
                  ' cracks are near the particle '//to_text(p%id(i, c)))
               return
            end if
            side = merge(1.0_wp, -1.0_wp, psi > tie*h)
            if (nint(near(i, at + near_crack)) == number) then
               if (near(i, at + near_phi) < 0 .or. abs(psi) < close*h) then
                  side = near(i, at + near_side)
               end if
            end if
            jump = side
            slope = 0
            if (crack%rule == rule_graded) then
               call jump_weight(side, phi, e1, crack%ramp*h, crack%ramp_end*h, jump, slope)
            end if
            near(i, at + near_crack) = real(number, wp)
            near(i, at + near_side) = side
            near(i, at + near_psi) = sign(psi, side)
            near(i, at + near_phi) = phi
            near(i, at + near_jump) = jump
            near(i, at + near_slope:at + near_slope + 2) = slope
            near(i, at + near_ahead) = ahead
            near(i, at + near_place) = code
         end do
      end associate
   end subroutine find_lanes

   !> H of the particles near a front that has come further. Sides and places stay as they were
   !> found; a side is fixed once the crack has passed its particle.
   subroutine advance_ramp(crack, number, h, p, reached)
      type(crack_t), intent(in) :: crack
      integer, intent(in) :: number             !! of the crack
      real(wp), intent(in) :: h                 !! cell size [length]
      type(particles_t), intent(inout) :: p
      logical, intent(out) :: reached           !! H is no more 0 somewhere
      real(wp) :: phi, e1(3), before, ramp, ramp_end
      integer :: c, i, k, edge

      reached = .false.
      ramp = crack%ramp*h
      ramp_end = crack%ramp_end*h
      do c = 1, p%n_chunks
         if (p%count(c) == 0 .or. p%attached(c) == 0) cycle
         associate (near => p%near(:, :, p%attached(c)))
            do k = 0, n_near*(p%slots - 1), n_near
               do i = 1, p%count(c)
                  if (nint(near(i, k + near_crack)) /= number) cycle
                  edge = int(near(i, k + near_place))
                  if (edge == 0 .or. near(i, k + near_phi) < ramp_end - ramp) cycle
                  phi = near(i, k + near_ahead) - offset_at(crack, near(i, k + near_place))
                  near(i, k + near_phi) = phi
                  if (crack%rule /= rule_graded .or. phi >= ramp_end) cycle
                  e1 = crack%front%edge_e1(:, edge) - offset_slope(crack, near(i, k + near_place))
                  before = near(i, k + near_jump)
                  call jump_weight(near(i, k + near_side), phi, e1, ramp, ramp_end, &
                     near(i, k + near_jump), near(i, k + near_slope:k + near_slope + 2))
                  reached = reached .or. .not. abs(before) > 0
               end do
            end do
         end associate
      end do
   end subroutine advance_ramp

   !> Take a surface that growth has made, its vertices in the same order and new ones behind.
   subroutine replace_surface(crack, surface, front, offset, rank, grid)
      type(crack_t), intent(inout) :: crack
      type(surface_t), intent(in) :: surface     !! with geometry
      type(front_t), intent(in) :: front         !! its fronts
      real(wp), intent(in) :: offset(:)          !! (nn) of its nodes [length]
      integer, intent(in) :: rank
      type(grid_t), intent(in) :: grid
      integer :: n

      n = surface%vertex_count - crack%surface%vertex_count
      crack%surface = surface
      crack%front = front
      crack%offset = offset
      call build_index(crack%surface, crack%index)
      crack%material = [crack%material, spread(.true., 1, n)]
      deallocate (crack%mine, crack%weight)
      allocate (crack%weight(surface%vertex_count))
      crack%evaluated = surface%x
      call take_vertices(crack, rank, grid)
      call weigh_vertices(crack, grid%lattice%size)
   end subroutine replace_surface

   !> Where the slot of a crack begins, less one: its own, or a free one; -1 where none is free.
   pure function slot_for(near, number) result(at)
      real(wp), intent(in) :: near(:)
      integer, intent(in) :: number
      integer :: at, k, taken

      at = -1
      do k = size(near)/n_near - 1, 0, -1
         taken = nint(near(n_near*k + near_crack))
         if (taken == number) then
            at = n_near*k
            return
         end if
         if (taken == 0) at = n_near*k
      end do
   end function slot_for

   !> Move this rank's vertices with the velocity of fields 5:7; both faces on their own.
   subroutine advance_crack(crack, number, grid, sided, dt)
      type(crack_t), intent(inout) :: crack
      integer, intent(in) :: number            !! of the crack
      type(grid_t), intent(in) :: grid
      type(sided_t), intent(in) :: sided
      real(wp), intent(in) :: dt               !! [time]
      real(wp) :: x(3), n(3), plus(3), minus(3), g
      integer :: v, b, bin(3)

      do v = 1, size(crack%mine)
         if (.not. crack%mine(v)) cycle
         x = place_of(crack%surface, v)
         bin = bin_of_vertex(grid, x)
         b = local_block(grid%blocks, block_of(bin))
         if (b == 0) then
            crack%stale = .true.
            cycle
         end if
         n = crack%surface%vertex_normal(:, v)
         if (dot_product(crack%surface%up(:, v) - crack%surface%um(:, v), n) &
             < wide*grid%lattice%size) n = 0
         call face_velocities(grid, sided, number, x, n, bin, b, plus, minus, crack%material(v))
         g = 0.5_wp*(1 + crack%weight(v))
         crack%surface%up(:, v) = crack%surface%up(:, v) + dt*(g*plus + (1 - g)*minus)
         crack%surface%um(:, v) = crack%surface%um(:, v) + dt*(g*minus + (1 - g)*plus)
         bin = bin_of_vertex(grid, place_of(crack%surface, v))
         if (local_block(grid%blocks, block_of(bin)) == 0) crack%stale = .true.
      end do
   end subroutine advance_crack

   !> Bring the vertices of all ranks together and, if it is time to, let those without material
   !> follow and renew geometry and H. Collective.
   !>
   !> A vertex may leave the blocks of its rank at any step. If that renewed the geometry, places
   !> included, fields would depend on the number of ranks; only the sharp rules, which look for
   !> nodes then, need it.
   subroutine gather_crack(crack, comm, grid, follow)
      type(crack_t), intent(inout) :: crack
      type(comm_t), intent(in) :: comm
      type(grid_t), intent(in) :: grid
      logical, intent(in) :: follow   !! at steps that do not depend on the number of ranks
      real(wp), allocatable :: state(:, :)
      integer :: v

      allocate (state(8, size(crack%mine)), source=0.0_wp)
      do v = 1, size(crack%mine)
         if (.not. crack%mine(v)) cycle
         state(1:3, v) = crack%surface%up(:, v)
         state(4:6, v) = crack%surface%um(:, v)
         state(7, v) = 1
         if (crack%material(v)) state(8, v) = 1
      end do
      call sum_all(comm, state)
      do v = 1, size(crack%mine)
         crack%material(v) = state(8, v) > 0.5_wp
         if (state(7, v) < 0.5_wp) cycle
         crack%surface%up(:, v) = state(1:3, v)
         crack%surface%um(:, v) = state(4:6, v)
      end do
      if (follow .and. any(crack%material) .and. .not. all(crack%material)) then
         call fill_void(crack%surface, crack%material)
      end if
      call take_vertices(crack, comm%rank, grid)
      if (.not. follow .and. crack%rule == rule_graded) return
      crack%surface%x = crack%surface%start + 0.5_wp*(crack%surface%up + crack%surface%um)
      call refresh_geometry(crack%surface)
      call refresh_index(crack%surface, crack%index)
      call refresh_front(crack%surface, crack%front)
      if (allocated(crack%offset)) call weigh_vertices(crack, grid%lattice%size)
   end subroutine gather_crack

   !> Whether the surface has turned or strained so much that level sets must be found again.
   pure function has_drifted(crack, h) result(drifted)
      type(crack_t), intent(in) :: crack
      real(wp), intent(in) :: h   !! cell size [length]
      logical :: drifted
      real(wp) :: shift(3)
      integer :: v, n

      n = crack%surface%vertex_count
      shift = sum(crack%surface%x - crack%evaluated, dim=2)/real(n, wp)
      drifted = .false.
      do v = 1, n
         if (norm2(crack%surface%x(:, v) - crack%evaluated(:, v) - shift) > drift*h) then
            drifted = .true.
         end if
      end do
   end function has_drifted
end module xmpm_crack
