!> The particles around the fronts of one crack, with all that integrals over them need.
module xmpm_samples
   use xmpm_kinds, only: wp
   use xmpm_communicator, only: comm_t
   use xmpm_halo, only: halo_t
   use xmpm_lattice, only: bin_corner, block_width, bins_per_block
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, lanes, bin_of_chunk, c_x, c_v, c_m, c_vol, c_s, &
      n_near, near_crack, near_psi, trace_f, trace_work
   use xmpm_kernels, only: kernels_t
   use xmpm_sided, only: sided_t
   use xmpm_fetch_ahead, only: fetch_record
   use xmpm_transfer, only: bodies_t
   use xmpm_elastic, only: elastic_t
   use xmpm_loads, only: load_t, force_on_lanes
   use xmpm_vectors, only: unit_vector
   use xmpm_front, only: front_t, front_place_t, nearest_on_front, nearest_of_group
   use xmpm_crack, only: crack_t
   use xmpm_chunk_state, only: pull_and_rate
   use xmpm_resolved, only: resolve_fields
   implicit none
   private

   public :: sample_t, collect_samples, place_sample

   !> A particle near a front. What tells which points see it fills the first line of the cache;
   !> what only moving fronts and circles want comes last.
   type :: sample_t
      real(wp) :: x(3) = 0           !! position [length]
      real(wp) :: foot(3) = 0        !! nearest point of the front [length]
      real(wp) :: r = 0              !! distance from the front [length]
      integer :: edge = 0            !! front edge that holds the nearest point
      real(wp) :: side = 1           !! 1 above, -1 below the crack
      real(wp) :: away(3) = 0        !! unit vector from the front
      real(wp) :: volume = 0         !! [length^3]
      real(wp) :: density = 0        !! now [mass/length^3]
      real(wp) :: lambda = 0         !! first Lame constant [stress]
      real(wp) :: mu = 0             !! shear modulus [stress]
      real(wp) :: stress(6) = 0      !! xx yy zz xy yz xz [stress]
      real(wp) :: work = 0           !! stress work on a volume [stress]
      real(wp) :: pull(3) = 0        !! force of the divergence of stress [force]
      real(wp) :: back(3, 3) = 0     !! inverse of the deformation gradient
      real(wp) :: v(3) = 0           !! velocity [length/time]
      real(wp) :: rate(3, 3) = 0     !! velocity gradient dv_i/dx_j, if wanted [1/time]
   end type sample_t

   real(wp), parameter :: margin = 0.9_wp        !! of a chunk around the middle of its bin [cells]
   real(wp), parameter :: beyond = 2.5_wp        !! the same where chunks beyond reach take part in
                                                 !! the smoothing [cells]
   integer, parameter :: f_stress = 1            !! places of the fields that are smoothed
   integer, parameter :: f_velocity = 7
   integer, parameter :: f_deformation = 10
   integer, parameter :: n_fields = 18

contains

   !> The traced particles of this rank within reach of the fronts of a crack. The rows hold mass,
   !> momentum and force as P2G leaves them. With `resolve` stress, deformation and velocity are
   !> what the grid resolves of them. Collective.
   subroutine collect_samples(crack, number, reach, resolve, moving, comm, halo, grid, p, bodies, &
         kernels, sided, loads, time, samples, n)
      type(crack_t), intent(in) :: crack                      !! gathered
      integer, intent(in) :: number                           !! of the crack
      real(wp), intent(in) :: reach                           !! [length]
      logical, intent(in) :: resolve
      logical, intent(in) :: moving                           !! velocity gradients are wanted
      type(comm_t), intent(in) :: comm
      type(halo_t), intent(inout) :: halo
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      type(bodies_t), intent(in) :: bodies
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      type(load_t), intent(in) :: loads(:)
      real(wp), intent(in) :: time                            !! of the loads [time]
      type(sample_t), allocatable, intent(inout) :: samples(:)   !! room, renewed if too small
      integer, intent(out) :: n                               !! samples, the first of `samples`
      real(wp), allocatable :: fields(:, :, :), distance(:)
      integer, allocatable :: near(:)
      integer :: i

      call find_chunks(crack%front, reach + merge(beyond, margin, resolve)*grid%lattice%size, &
         grid, p, near, distance)
      call fit_room(sum(p%count(near)), samples)
      if (resolve) then
         allocate (fields(lanes, n_fields, size(near)))
         do i = 1, size(near)
            call read_fields(p, near(i), fields(:, :, i))
         end do
         call resolve_fields(near, comm, halo, grid, p, bodies, kernels, sided, fields)
      end if
      n = 0
      do i = 1, size(near)
         if (i + 2 <= size(near)) call fetch_record(p, near(i + 2))
         if (resolve) then
            call sample_chunk(crack%front, number, reach, grid, p, near(i), distance(i), bodies, &
               kernels, sided, loads, time, moving, samples, n, fields(:, :, i))
         else
            call sample_chunk(crack%front, number, reach, grid, p, near(i), distance(i), bodies, &
               kernels, sided, loads, time, moving, samples, n)
         end if
      end do
   end subroutine collect_samples

   !> Room for n samples, with some to spare; what there is stays if it is enough.
   pure subroutine fit_room(n, samples)
      integer, intent(in) :: n
      type(sample_t), allocatable, intent(inout) :: samples(:)

      if (allocated(samples)) then
         if (size(samples) >= n) return
         deallocate (samples)
      end if
      allocate (samples(n + n/8))
   end subroutine fit_room

   !> Stress, velocity and deformation gradient of the lanes of a chunk.
   pure subroutine read_fields(p, c, fields)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c                  !! chunk
      real(wp), intent(out) :: fields(:, :)     !! (8,18)

      fields(:, f_stress:f_stress + 5) = p%q(:, c_s:c_s + 5, c)
      fields(:, f_velocity:f_velocity + 2) = p%q(:, c_v:c_v + 2, c)
      fields(:, f_deformation:f_deformation + 8) = &
         p%near(:, p%trace + trace_f:p%trace + trace_f + 8, p%attached(c))
   end subroutine read_fields

   !> The traced chunks whose bins are near a front, block by block.
   pure subroutine find_chunks(front, reach, grid, p, near, distance)
      type(front_t), intent(in) :: front
      real(wp), intent(in) :: reach            !! of the bins' middles [length]
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      integer, allocatable, intent(out) :: near(:)
      real(wp), allocatable, intent(out) :: distance(:)   !! of the bins' middles [length]
      real(wp) :: away(p%n_attached), middle(3), h
      integer :: chosen(p%n_attached), b, n
      type(front_place_t) :: place

      h = grid%lattice%size
      n = 0
      if (p%trace >= 0) then
         do b = 1, grid%blocks%n
            middle = bin_corner(grid%lattice, block_width*grid%blocks%place(:, b)) &
               + 0.5_wp*real(block_width, wp)*h
            call nearest_on_front(front, middle, reach + margin*real(block_width - 1, wp)*h, place)
            if (place%edge > 0) call search_block(front, reach, grid, p, b, chosen, away, n)
         end do
      end if
      near = chosen(:n)
      distance = away(:n)
   end subroutine find_chunks

   !> Append the chunks of one block.
   pure subroutine search_block(front, reach, grid, p, b, chosen, away, n)
      type(front_t), intent(in) :: front
      real(wp), intent(in) :: reach
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      integer, intent(in) :: b                            !! block
      integer, intent(inout) :: chosen(:), n              !! filled up to n
      real(wp), intent(inout) :: away(:)
      type(front_place_t) :: place
      integer :: k, c

      do k = 1, bins_per_block
         c = p%head(k, b)
         if (c == 0) cycle
         call nearest_on_front(front, middle_of_bin(grid, p, c), reach, place)
         if (place%edge == 0) cycle
         do while (c > 0)
            if (p%attached(c) > 0) then
               n = n + 1
               chosen(n) = c
               away(n) = place%distance
            end if
            c = p%next(c)
         end do
      end do
   end subroutine search_block

   !> Middle of the bin of a chunk.
   pure function middle_of_bin(grid, p, c) result(middle)
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c
      real(wp) :: middle(3)   !! [length]

      middle = bin_corner(grid%lattice, bin_of_chunk(p, grid%blocks, c)) + 0.5_wp*grid%lattice%size
   end function middle_of_bin

   !> Append the particles of one chunk, for which there is room.
   subroutine sample_chunk(front, number, reach, grid, p, c, distance, bodies, kernels, sided, &
         loads, time, moving, samples, n, fields)
      type(front_t), intent(in) :: front
      integer, intent(in) :: number, c
      real(wp), intent(in) :: reach, time
      real(wp), intent(in) :: distance                 !! of the middle of its bin [length]
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      type(bodies_t), intent(in) :: bodies
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      type(load_t), intent(in) :: loads(:)
      logical, intent(in) :: moving
      type(sample_t), intent(inout) :: samples(:)
      integer, intent(inout) :: n
      real(wp), intent(in), optional :: fields(:, :)   !! (8,18) instead of what particles carry
      real(wp) :: pull(lanes, 3), rate(lanes, 9), f(lanes, 9), back(lanes, 9)
      logical :: traced(lanes)
      type(front_place_t) :: places(lanes)
      integer :: i

      call nearest_of_group(front, lanes, p%q(:, c_x:c_x + 2, c), middle_of_bin(grid, p, c), &
         margin*grid%lattice%size, distance, reach, places)
      if (all(places(:p%count(c))%edge == 0)) return
      call pull_and_rate(p, c, bodies%half(p%body(c)), kernels, sided, grid, moving, pull, rate)
      call take_loads(loads, p, grid, c, time, pull)
      f = p%near(:, p%trace + trace_f:p%trace + trace_f + 8, p%attached(c))
      traced = any(abs(f) > 0, dim=2)
      if (present(fields)) f = fields(:, f_deformation:f_deformation + 8)
      call invert_lanes(f, back)
      do i = 1, p%count(c)
         if (places(i)%edge == 0) cycle
         if (.not. traced(i)) cycle
         associate (s => samples(n + 1))
            s%x = p%q(i, c_x:c_x + 2, c)
            s%side = side_of_lane(p, c, i, number)
            call put_sample(front, places(i), s)
            call read_lane(p, c, i, s)
            if (present(fields)) then
               s%stress = fields(i, f_stress:f_stress + 5)
               s%v = fields(i, f_velocity:f_velocity + 2)
            end if
            s%back = rows_of(back(i, :))
            s%lambda = 0
            s%mu = 0
            select type (law => bodies%laws(bodies%law_of(p%body(c)))%law)
            type is (elastic_t)
               s%lambda = law%lambda
               s%mu = law%mu
               if (present(fields)) s%work = law%strain_energy(s%stress)
            end select
            s%pull = pull(i, :)
            if (moving) s%rate = rows_of(rate(i, :))
         end associate
         n = n + 1
      end do
   end subroutine sample_chunk

   !> Take the loads on the particles of a chunk from the force at the nodes.
   subroutine take_loads(loads, p, grid, c, time, pull)
      type(load_t), intent(in) :: loads(:)
      type(particles_t), intent(in) :: p
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: c
      real(wp), intent(in) :: time
      real(wp), intent(inout) :: pull(lanes, 3)   !! [force]
      real(wp) :: load(lanes, 3)
      integer :: i

      do i = 1, size(loads)
         call force_on_lanes(loads(i), p, grid, c, time, load)
         pull = pull - load
      end do
   end subroutine take_loads

   !> Inverses of the matrices in all lanes, each given by its rows one after the other; 0 where a
   !> lane is 0.
   pure subroutine invert_lanes(a, b)
      real(wp), intent(in) :: a(lanes, 9)
      real(wp), intent(out) :: b(lanes, 9)
      real(wp) :: per
      integer :: i

      !$omp simd private(per)
      do i = 1, lanes
         b(i, 1) = a(i, 5)*a(i, 9) - a(i, 6)*a(i, 8)
         b(i, 2) = a(i, 3)*a(i, 8) - a(i, 2)*a(i, 9)
         b(i, 3) = a(i, 2)*a(i, 6) - a(i, 3)*a(i, 5)
         b(i, 4) = a(i, 6)*a(i, 7) - a(i, 4)*a(i, 9)
         b(i, 5) = a(i, 1)*a(i, 9) - a(i, 3)*a(i, 7)
         b(i, 6) = a(i, 3)*a(i, 4) - a(i, 1)*a(i, 6)
         b(i, 7) = a(i, 4)*a(i, 8) - a(i, 5)*a(i, 7)
         b(i, 8) = a(i, 2)*a(i, 7) - a(i, 1)*a(i, 8)
         b(i, 9) = a(i, 1)*a(i, 5) - a(i, 2)*a(i, 4)
         per = a(i, 1)*b(i, 1) + a(i, 2)*b(i, 4) + a(i, 3)*b(i, 7)
         per = 1/merge(per, 1.0_wp, abs(per) > 0)
         b(i, :) = per*b(i, :)
      end do
   end subroutine invert_lanes

   !> The side of a crack that a particle carries, 0 where it has none.
   pure function side_of_lane(p, c, lane, number) result(side)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c, lane, number
      real(wp) :: side
      integer :: k

      side = 0
      do k = 0, n_near*(p%slots - 1), n_near
         if (nint(p%near(lane, k + near_crack, p%attached(c))) /= number) cycle
         side = sign(1.0_wp, p%near(lane, k + near_psi, p%attached(c)))
      end do
   end function side_of_lane

   !> What a traced particle carries itself.
   pure subroutine read_lane(p, c, lane, s)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c, lane
      type(sample_t), intent(inout) :: s

      s%v = p%q(lane, c_v:c_v + 2, c)
      s%volume = p%q(lane, c_vol, c)
      s%density = p%q(lane, c_m, c)/s%volume
      s%stress = p%q(lane, c_s:c_s + 5, c)
      s%work = p%near(lane, p%trace + trace_work, p%attached(c))/s%volume
   end subroutine read_lane

   !> A matrix from its rows one after the other.
   pure function rows_of(values) result(a)
      real(wp), intent(in) :: values(9)
      real(wp) :: a(3, 3)

      a(1, :) = values(1:3)
      a(2, :) = values(4:6)
      a(3, :) = values(7:9)
   end function rows_of

   !> Find the nearest point of the front.
   pure subroutine place_sample(front, reach, s, inside)
      type(front_t), intent(in) :: front
      real(wp), intent(in) :: reach          !! [length]
      type(sample_t), intent(inout) :: s     !! x and side are known
      logical, intent(out) :: inside         !! within reach
      type(front_place_t) :: place

      call nearest_on_front(front, s%x, reach, place)
      inside = place%edge > 0
      if (inside) call put_sample(front, place, s)
   end subroutine place_sample

   !> Place a sample by the nearest point of the front; past its open ends the front goes on
   !> straight.
   pure subroutine put_sample(front, place, s)
      type(front_t), intent(in) :: front
      type(front_place_t), intent(in) :: place   !! nearest to x
      type(sample_t), intent(inout) :: s         !! x and side are known
      real(wp) :: t(3), d(3)

      s%edge = place%edge
      d = s%x - place%point
      if (place%node > 0) then
         if (any(front%node_edge(:, place%node) == 0)) then
            t = unit_vector(front%x(:, front%edge_node(2, place%edge)) &
               - front%x(:, front%edge_node(1, place%edge)))
            d = d - dot_product(d, t)*t
         end if
      end if
      s%foot = s%x - d
      s%r = sqrt(dot_product(d, d))
      s%away = unit_vector(d)
      if (abs(s%side) > 0) return
      s%side = sign(1.0_wp, dot_product(d, front%e2(:, front%edge_node(1, place%edge))))
   end subroutine put_sample
end module xmpm_samples
