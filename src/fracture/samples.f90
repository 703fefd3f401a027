!> The particles around the fronts of one crack, with all that integrals over them need.
module xmpm_samples
   use xmpm_kinds, only: wp
   use xmpm_communicator, only: comm_t
   use xmpm_halo, only: halo_t
   use xmpm_lattice, only: bin_corner
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, lanes, bin_of_chunk, c_x, c_v, c_m, c_vol, c_s, &
      n_hot, n_near, near_crack, near_psi, n_trace, trace_f, trace_work
   use xmpm_kernels, only: kernels_t
   use xmpm_sided, only: sided_t
   use xmpm_transfer, only: bodies_t
   use xmpm_elastic, only: elastic_t
   use xmpm_loads, only: load_t, force_on_lanes
   use xmpm_vectors, only: unit_vector, inverse
   use xmpm_front, only: front_t, front_place_t, nearest_on_front
   use xmpm_crack, only: crack_t
   use xmpm_chunk_state, only: pull_and_rate
   use xmpm_resolved, only: resolve_fields
   implicit none
   private

   public :: sample_t, collect_samples, place_sample

   !> A particle near a front.
   type :: sample_t
      real(wp) :: x(3) = 0           !! position [length]
      real(wp) :: volume = 0         !! [length^3]
      real(wp) :: density = 0        !! now [mass/length^3]
      real(wp) :: lambda = 0         !! first Lame constant [stress]
      real(wp) :: mu = 0             !! shear modulus [stress]
      real(wp) :: stress(6) = 0      !! xx yy zz xy yz xz [stress]
      real(wp) :: work = 0           !! stress work on a volume [stress]
      real(wp) :: back(3, 3) = 0     !! inverse of the deformation gradient
      real(wp) :: pull(3) = 0        !! force of the divergence of stress [force]
      real(wp) :: v(3) = 0           !! velocity [length/time]
      real(wp) :: rate(3, 3) = 0     !! velocity gradient dv_i/dx_j [1/time]
      real(wp) :: side = 1           !! 1 above, -1 below the crack
      real(wp) :: r = 0              !! distance from the front [length]
      real(wp) :: away(3) = 0        !! unit vector from the front
      real(wp) :: foot(3) = 0        !! nearest point of the front [length]
      integer :: edge = 0            !! front edge that holds it
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
         kernels, sided, loads, time, samples)
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
      type(sample_t), allocatable, intent(out) :: samples(:)
      real(wp), allocatable :: fields(:, :, :)
      integer, allocatable :: near(:)
      integer :: i, n

      call find_chunks(crack%front, reach + merge(beyond, margin, resolve)*grid%lattice%size, &
         grid, p, near)
      allocate (samples(sum(p%count(near))))
      if (resolve) then
         allocate (fields(lanes, n_fields, size(near)))
         do i = 1, size(near)
            call read_fields(p, near(i), fields(:, :, i))
         end do
         call resolve_fields(near, comm, halo, grid, p, bodies, kernels, sided, fields)
      end if
      n = 0
      do i = 1, size(near)
         if (resolve) then
            call sample_chunk(crack%front, number, reach, grid, p, near(i), bodies, kernels, &
               sided, loads, time, moving, samples, n, fields(:, :, i))
         else
            call sample_chunk(crack%front, number, reach, grid, p, near(i), bodies, kernels, &
               sided, loads, time, moving, samples, n)
         end if
      end do
      samples = samples(:n)
   end subroutine collect_samples

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

   !> The traced chunks whose bins are near a front.
   pure subroutine find_chunks(front, reach, grid, p, near)
      type(front_t), intent(in) :: front
      real(wp), intent(in) :: reach            !! of the bins' middles [length]
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      integer, allocatable, intent(out) :: near(:)
      integer :: chosen(count(p%attached(:p%n_chunks) > 0)), c, n
      type(front_place_t) :: place
      real(wp) :: centre(3)

      n = 0
      if (p%trace >= 0) then
         do c = 1, p%n_chunks
            if (p%attached(c) == 0) cycle
            if (p%count(c) == 0) cycle
            centre = bin_corner(grid%lattice, bin_of_chunk(p, grid%blocks, c)) &
               + 0.5_wp*grid%lattice%size
            call nearest_on_front(front, centre, reach, place)
            if (place%edge == 0) cycle
            n = n + 1
            chosen(n) = c
         end do
      end if
      near = chosen(:n)
   end subroutine find_chunks

   !> Append the particles of one chunk, for which there is room.
   subroutine sample_chunk(front, number, reach, grid, p, c, bodies, kernels, sided, loads, time, &
         moving, samples, n, fields)
      type(front_t), intent(in) :: front
      integer, intent(in) :: number, c
      real(wp), intent(in) :: reach, time
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
      real(wp) :: pull(lanes, 3), rate(lanes, 9), load(lanes, 3)
      logical :: inside
      integer :: i

      call pull_and_rate(p, c, bodies%half(p%body(c)), kernels, sided, grid, moving, pull, &
         rate)
      do i = 1, size(loads)
         call force_on_lanes(loads(i), p, grid, c, time, load)
         pull = pull - load
      end do
      do i = 1, p%count(c)
         associate (s => samples(n + 1))
            call read_lane(p, c, i, number, s)
            if (.not. any(abs(s%back) > 0)) cycle
            call place_sample(front, reach, s, inside)
            if (.not. inside) cycle
            if (present(fields)) then
               s%stress = fields(i, f_stress:f_stress + 5)
               s%v = fields(i, f_velocity:f_velocity + 2)
               s%back = rows_of(fields(i, f_deformation:f_deformation + 8))
            end if
            s%back = inverse(s%back)
            select type (law => bodies%laws(bodies%law_of(p%body(c)))%law)
            type is (elastic_t)
               s%lambda = law%lambda
               s%mu = law%mu
               if (present(fields)) s%work = law%strain_energy(s%stress)
            end select
            s%pull = pull(i, :)
            s%rate = rows_of(rate(i, :))
         end associate
         n = n + 1
      end do
   end subroutine sample_chunk

   !> What a particle carries itself; `back` holds its deformation gradient, 0 where it is not
   !> traced.
   pure subroutine read_lane(p, c, lane, number, s)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c, lane, number
      type(sample_t), intent(out) :: s
      real(wp) :: trace(n_trace), q(n_hot)
      integer :: k, r

      r = p%attached(c)
      trace = p%near(lane, p%trace + 1:p%trace + n_trace, r)
      if (.not. any(abs(trace(trace_f:trace_f + 8)) > 0)) return
      q = p%q(lane, :, c)
      s%x = q(c_x:c_x + 2)
      s%v = q(c_v:c_v + 2)
      s%volume = q(c_vol)
      s%density = q(c_m)/q(c_vol)
      s%stress = q(c_s:c_s + 5)
      s%work = trace(trace_work)/q(c_vol)
      s%back = rows_of(trace(trace_f:trace_f + 8))
      s%side = 0
      do k = 0, n_near*(p%slots - 1), n_near
         if (nint(p%near(lane, k + near_crack, r)) /= number) cycle
         s%side = sign(1.0_wp, p%near(lane, k + near_psi, r))
      end do
   end subroutine read_lane

   !> A matrix from its rows one after the other.
   pure function rows_of(values) result(a)
      real(wp), intent(in) :: values(9)
      real(wp) :: a(3, 3)

      a(1, :) = values(1:3)
      a(2, :) = values(4:6)
      a(3, :) = values(7:9)
   end function rows_of

   !> Find the nearest point of the front; past its open ends the front goes on straight.
   pure subroutine place_sample(front, reach, s, inside)
      type(front_t), intent(in) :: front
      real(wp), intent(in) :: reach          !! [length]
      type(sample_t), intent(inout) :: s     !! x and side are known
      logical, intent(out) :: inside         !! within reach
      type(front_place_t) :: place
      real(wp) :: t(3), d(3)

      call nearest_on_front(front, s%x, reach, place)
      inside = place%edge > 0
      if (.not. inside) return
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
      s%r = norm2(d)
      s%away = unit_vector(d)
      if (abs(s%side) > 0) return
      s%side = sign(1.0_wp, dot_product(d, front%e2(:, front%edge_node(1, place%edge))))
   end subroutine place_sample
end module xmpm_samples
