!> Conditions on grid nodes: velocities prescribed on a plane, in a box, or around a set.
module xmpm_boundary
   use xmpm_kinds, only: wp
   use xmpm_grid, only: grid_t, node_position
   implicit none
   private

   public :: boundary_t, find_rows, apply_boundary, hold_boundary
   public :: region_plane, region_box, region_set

   integer, parameter :: region_plane = 1   !! nodes on and beyond a plane
   integer, parameter :: region_box = 2     !! nodes in a box
   integer, parameter :: region_set = 3     !! nodes around the particles of a set

   !> One condition.
   type :: boundary_t
      character(len=:), allocatable :: name      !! for probes
      integer :: region = region_plane           !! which nodes
      integer :: axis = 1                        !! of the plane
      real(wp) :: coordinate = 0                 !! of the plane [length]
      real(wp) :: outward = -1                   !! side without material, -1 or +1
      real(wp) :: low(3) = 0, high(3) = 0        !! of the box [length]
      integer :: set = 0                         !! bit of the set
      logical :: holds(3) = .false.              !! components that are prescribed
      logical :: accelerates = .false.           !! `value` is an acceleration
      real(wp) :: value(3) = 0                   !! times its curve: [length/time] or
                                                 !! [length/time^2]
      real(wp) :: velocity(3) = 0                !! prescribed now [length/time]
      integer, allocatable :: rows(:)            !! rows of the nodes
      real(wp) :: reaction(3) = 0                !! force on the nodes in the last step, this rank
      real(wp) :: work = 0                       !! done by it so far, this rank [energy]
   end type boundary_t

contains

   !> Find the rows of a plane or a box.
   subroutine find_rows(boundary, grid)
      type(boundary_t), intent(inout) :: boundary
      type(grid_t), intent(in) :: grid
      integer :: i, n
      integer, allocatable :: rows(:)

      if (boundary%region == region_set) return
      allocate (rows(grid%n_rows))
      n = 0
      do i = 1, grid%n_rows
         if (.not. in_region(boundary, node_position(grid, i), 1e-9_wp*grid%lattice%size)) cycle
         n = n + 1
         rows(n) = i
      end do
      boundary%rows = rows(:n)
   end subroutine find_rows

   pure function in_region(boundary, x, tolerance) result(holds)
      type(boundary_t), intent(in) :: boundary
      real(wp), intent(in) :: x(3), tolerance
      logical :: holds

      if (boundary%region == region_plane) then
         holds = boundary%outward*(x(boundary%axis) - boundary%coordinate) >= -tolerance
      else
         holds = all(x >= boundary%low - tolerance) .and. all(x <= boundary%high + tolerance)
      end if
   end function in_region

   !> Prescribe velocity and change of the rows; the reaction follows from the change.
   subroutine apply_boundary(boundary, grid, dt, again)
      type(boundary_t), intent(inout) :: boundary
      type(grid_t), intent(inout) :: grid   !! fields 2:4 hold the new velocity, 5:7 its change
      real(wp), intent(in) :: dt            !! of the change [time]
      logical, intent(in) :: again          !! whether it adds to the reaction of this step
      real(wp) :: before, change, impulse
      integer :: i, k, d

      if (.not. again) boundary%reaction = 0
      do k = 1, size(boundary%rows)
         i = boundary%rows(k)
         if (.not. grid%node(1, i) > 0) cycle
         do d = 1, 3
            if (.not. boundary%holds(d)) cycle
            before = grid%node(1 + d, i) - grid%node(4 + d, i)
            change = boundary%velocity(d) - before
            impulse = grid%node(1, i)*(change - grid%node(4 + d, i))
            grid%node(1 + d, i) = boundary%velocity(d)
            grid%node(4 + d, i) = change
            if (.not. grid%mine(i)) cycle
            boundary%reaction(d) = boundary%reaction(d) + impulse/dt
            boundary%work = boundary%work + impulse*0.5_wp*(before + boundary%velocity(d))
         end do
      end do
   end subroutine apply_boundary

   !> Prescribe the velocity in three fields of the rows.
   subroutine hold_boundary(boundary, grid, field)
      type(boundary_t), intent(in) :: boundary
      type(grid_t), intent(inout) :: grid
      integer, intent(in) :: field   !! first of the three
      integer :: k, d

      do k = 1, size(boundary%rows)
         do d = 1, 3
            if (boundary%holds(d)) grid%node(field - 1 + d, boundary%rows(k)) = boundary%velocity(d)
         end do
      end do
   end subroutine hold_boundary
end module xmpm_boundary
