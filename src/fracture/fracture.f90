!> Fracture parameters of all fronts that the deck asks for.
module xmpm_fracture
   use xmpm_kinds, only: wp
   use xmpm_communicator, only: comm_t, sum_all, max_all
   use xmpm_halo, only: halo_t
   use xmpm_lattice, only: bin_corner
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, attach, bin_of_chunk, c_s, c_vol
   use xmpm_trace, only: start_trace
   use xmpm_transfer, only: bodies_t
   use xmpm_kernels, only: kernels_t
   use xmpm_sided, only: sided_t
   use xmpm_loads, only: load_t
   use xmpm_elastic, only: elastic_t
   use xmpm_vectors, only: unit_vector
   use xmpm_surface_index, only: nearest_t, nearest_on_surface
   use xmpm_front, only: front_t, front_place_t, nearest_on_front, shift_front
   use xmpm_crack, only: crack_t, gather_crack
   use xmpm_near_tip, only: strain_of
   use xmpm_samples, only: sample_t, collect_samples
   use xmpm_material_drift, only: drift_sums, drift_of
   use xmpm_front_points, only: list_points, front_points_t
   use xmpm_front_ends, only: find_ends
   use xmpm_domain_integral, only: domain_shape_t, domain_sums_t, clear_sums, sum_domains
   use xmpm_face_points, only: face_forces_t, face_points_t, list_face_points, find_shares, &
      find_tractions
   use xmpm_face_work, only: add_face_work
   use xmpm_rates, only: rates_t, find_rates, method_domain
   use xmpm_front_values, only: front_values_t, clear_values, find_values, flag_other
   implicit none
   private

   public :: fracture_t, start_traces, trace_reach, measure_front, release_range

   real(wp), parameter :: spare = 2.0_wp     !! particles traced beyond the largest domain [cells]
   real(wp), parameter :: ahead = 20.0_wp    !! the same around a front that grows, so that their
                                             !! rotation is known when it comes [cells]

   !> What the deck wants, and what was found last.
   type :: fracture_t
      integer, allocatable :: cracks(:)             !! cracks whose fronts are looked at
      real(wp) :: every = 0                         !! interval, 0 for none [time]
      real(wp), allocatable :: at(:)                !! single times, ascending [time]
      integer, allocatable :: methods(:)            !! method_*, the first answers
      type(domain_shape_t) :: shape                 !! of the domains
      real(wp) :: behind = 0                        !! where openings are taken [length]
      type(front_values_t), allocatable :: values(:)   !! of each crack in the list, last time
      logical :: measured = .false.                 !! there are values
      type(face_forces_t) :: faces                  !! contact of the crack that is looked at
      type(sample_t), allocatable :: room(:)        !! for samples, kept for the next time
   end type fracture_t

contains

   !> Distance from a front within which particles are traced.
   pure function trace_reach(fracture, h, grows) result(reach)
      type(fracture_t), intent(in) :: fracture
      real(wp), intent(in) :: h        !! cell size [length]
      logical, intent(in) :: grows     !! the front will move
      real(wp) :: reach                !! [length]

      reach = maxval(fracture%shape%radius) + merge(ahead, spare, grows)*h
   end function trace_reach

   !> Trace the particles around the fronts of a crack, from now on. What they have of stress now
   !> counts as reached from a state without stress and rotation.
   subroutine start_traces(crack, reach, grid, bodies, p)
      type(crack_t), intent(in) :: crack
      real(wp), intent(in) :: reach              !! [length]
      type(grid_t), intent(in) :: grid
      type(bodies_t), intent(in) :: bodies
      type(particles_t), intent(inout) :: p
      type(front_place_t) :: place
      real(wp) :: centre(3), stress(6)
      integer :: c, i

      do c = 1, p%n_chunks
         if (p%count(c) == 0) cycle
         centre = bin_corner(grid%lattice, bin_of_chunk(p, grid%blocks, c)) &
            + 0.5_wp*grid%lattice%size
         place = front_place_t()
         call nearest_on_front(crack%front, centre, reach + grid%lattice%size, place)
         if (place%edge == 0) cycle
         if (p%attached(c) == 0) call attach(p, c)
         select type (law => bodies%laws(bodies%law_of(p%body(c)))%law)
         type is (elastic_t)
            do i = 1, p%count(c)
               stress = p%q(i, c_s:c_s + 5, c)
               call start_trace(p, i, c, strain_of(stress, law%mu, &
                  0.5_wp*law%lambda/(law%lambda + law%mu)), &
                  p%q(i, c_vol, c)*law%strain_energy(stress))
            end do
         end select
      end do
   end subroutine start_traces

   !> Find the values at the fronts of one crack of the list. The rows hold mass, momentum and
   !> force as P2G leaves them, with what is in `faces`; nothing of the run is changed. Collective.
   subroutine measure_front(fracture, which, cracks, comm, halo, grid, p, bodies, kernels, sided, &
         loads, time, speed)
      type(fracture_t), intent(inout) :: fracture
      integer, intent(in) :: which                 !! place in the list
      type(crack_t), intent(in) :: cracks(:)
      type(comm_t), intent(in) :: comm
      type(halo_t), intent(inout) :: halo
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      type(bodies_t), intent(in) :: bodies
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      type(load_t), intent(in) :: loads(:)
      real(wp), intent(in) :: time                 !! [time]
      real(wp), intent(in) :: speed(:)             !! of the front at its nodes [length/time]
      type(crack_t) :: crack
      type(front_values_t) :: values
      type(domain_sums_t) :: sums
      type(rates_t) :: rates
      type(face_points_t) :: faces
      real(wp), allocatable :: drift(:, :)
      real(wp) :: reach
      integer :: n
      logical :: moving

      associate (number => fracture%cracks(which), shape => fracture%shape)
         crack = cracks(number)
         call gather_crack(crack, comm, grid, .true.)
         if (fracture%faces%meet) call press_faces(fracture, crack, comm, grid, p, faces)
         if (allocated(crack%offset)) call shift_front(crack%surface%rounding, crack%offset, &
            crack%front)
         call list_points(crack, values%points)
         call clear_values(values, values%points%n)
         values%speed = speed
         reach = maxval(shape%radius)
         if (any(fracture%methods /= method_domain)) reach = reach + shape%support
         moving = any(speed > 0) .or. any(fracture%methods /= method_domain)
         call collect_samples(crack, number, reach, allocated(crack%offset), moving, comm, halo, &
            grid, p, bodies, kernels, sided, loads, time, fracture%room, n)
         call find_ends(crack%front, comm, grid%lattice%size, fracture%room(:n), values%points)
         call clear_sums(sums, size(shape%radius), values%points%n)
         drift = drift_at(fracture%room(:n), values%points, speed, comm)
         call sum_domains(fracture%room(:n), crack%front, values%points, shape, speed, drift, sums)
         call sum_over_ranks(comm, sums)
         call add_face_work(faces, crack%front, values%points, shape, sums)
         call find_rates(fracture%methods, comm, fracture%room(:n), crack%front, values%points, &
            shape, speed, drift, sums, rates)
         call find_values(crack, shape, sums, rates, fracture%behind, values)
         call flag_neighbours(cracks, number, values)
      end associate
      fracture%values(which) = values
      fracture%measured = .true.
   end subroutine measure_front

   !> Points of the closed faces with their tractions; none where nothing presses. Collective.
   subroutine press_faces(fracture, crack, comm, grid, p, faces)
      type(fracture_t), intent(in) :: fracture
      type(crack_t), intent(in) :: crack             !! gathered, its front as the mesh has it
      type(comm_t), intent(in) :: comm
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      type(face_points_t), intent(out) :: faces
      real(wp), allocatable :: share(:)
      real(wp) :: largest

      largest = 0
      if (size(fracture%faces%force) > 0) largest = maxval(abs(fracture%faces%force))
      call max_all(comm, largest)
      if (.not. largest > 0) return
      call list_face_points(crack, grid%lattice%size, maxval(fracture%shape%radius), faces)
      allocate (share(faces%n))
      call find_shares(faces, grid, p, share)
      call sum_all(comm, share)
      call find_tractions(fracture%faces, comm, grid%lattice, share, faces)
   end subroutine press_faces

   !> Least and largest J of all fronts, as measured last.
   pure function release_range(fracture) result(range)
      type(fracture_t), intent(in) :: fracture
      real(wp) :: range(2)   !! [energy/length^2]
      integer :: i

      range = [huge(1.0_wp), -huge(1.0_wp)]
      do i = 1, size(fracture%values)
         if (.not. allocated(fracture%values(i)%j)) cycle
         range(1) = min(range(1), minval(fracture%values(i)%j))
         range(2) = max(range(2), maxval(fracture%values(i)%j))
      end do
   end function release_range

   !> Velocity of the material at moving points. Collective.
   function drift_at(samples, points, speed, comm) result(drift)
      type(sample_t), intent(in) :: samples(:)
      type(front_points_t), intent(in) :: points
      real(wp), intent(in) :: speed(:)
      type(comm_t), intent(in) :: comm
      real(wp) :: drift(3, points%n)
      real(wp) :: sums(4, points%n)

      drift = 0
      if (.not. any(speed > 0)) return
      sums = drift_sums(samples, points, speed)
      call sum_all(comm, sums)
      drift = drift_of(sums)
   end function drift_at

   subroutine sum_over_ranks(comm, sums)
      type(comm_t), intent(in) :: comm
      type(domain_sums_t), intent(inout) :: sums
      real(wp), allocatable :: all(:, :)
      integer :: nr, n

      nr = size(sums%j, 1)
      n = size(sums%j, 2)
      allocate (all(6*nr + 9, n))
      all(:nr, :) = sums%j
      all(nr + 1:5*nr, :) = reshape(sums%interaction, [4*nr, n])
      all(5*nr + 1:6*nr, :) = sums%volume
      all(6*nr + 1:6*nr + 4, :) = sums%material
      all(6*nr + 5:, :) = sums%along
      call sum_all(comm, all)
      sums%j = all(:nr, :)
      sums%interaction = reshape(all(nr + 1:5*nr, :), [4, nr, n])
      sums%volume = all(5*nr + 1:6*nr, :)
      sums%material = all(6*nr + 1:6*nr + 4, :)
      sums%along = all(6*nr + 5:, :)
   end subroutine sum_over_ranks

   !> Mark the points whose domain meets another crack, or another part of their own fronts.
   subroutine flag_neighbours(cracks, number, values)
      type(crack_t), intent(in) :: cracks(:)
      integer, intent(in) :: number                    !! of the crack
      type(front_values_t), intent(inout) :: values
      type(nearest_t) :: nearest
      integer :: i, k
      logical :: meets

      associate (points => values%points)
         do i = 1, points%n
            meets = .false.
            do k = 1, size(cracks)
               if (k == number) cycle
               call nearest_on_surface(cracks(k)%index, cracks(k)%surface, points%x(:, i), &
                  values%radius(i), nearest)
               meets = meets .or. nearest%triangle > 0
            end do
            do k = 1, points%n
               if (points%chain(k) == points%chain(i) .and. &
                  dot_product(points%frame(:, 1, k), points%frame(:, 1, i)) > -0.5_wp) cycle
               meets = meets .or. norm2(points%x(:, k) - points%x(:, i)) < values%radius(i)
            end do
            if (meets) values%flags(i) = values%flags(i) + flag_other
         end do
      end associate
   end subroutine flag_neighbours
end module xmpm_fracture
