!> The nodal part of a step: forces to velocities, damping, gravity, and the second map's velocity.
module xmpm_momentum
   use xmpm_kinds, only: wp
   use xmpm_grid, only: grid_t, active_rows
   implicit none
   private

   public :: force_out_of_balance, impulse_energy, advance_momentum, add_nodal_work, &
      blend_change, velocity_from_second, nodal_work_t, change_from_velocity, sharpen_rows

   !> Work that nodes did or took in a step, counted once over all ranks [energy].
   type :: nodal_work_t
      real(wp) :: external = 0   !! by body force
      real(wp) :: damping = 0    !! lost to nodal damping
   end type nodal_work_t

contains

   !> Velocity after the step and its change: eq. 4 and 29, row by row.
   !>
   !> change = dt (f/m + b - rate v); fields 2:4 become the new velocity, 5:7 the change. Rows
   !> without mass become zero.
   subroutine advance_momentum(grid, dt, gravity, rate)
      type(grid_t), intent(inout) :: grid
      real(wp), intent(in) :: dt           !! from v(n-1/2) to v(n+1/2) [time]
      real(wp), intent(in) :: gravity(3)   !! body force per mass [length/time^2]
      real(wp), intent(in) :: rate         !! of nodal damping [1/time]
      integer :: b, first, last

      do b = 1, grid%blocks%n_node_blocks + 1
         call active_rows(grid, b, first, last)
         call advance_rows(last - first + 1, dt, gravity, rate, grid%node(:, first:last))
      end do
   end subroutine advance_momentum

   !> Mass, momentum and force of rows become mass, velocity and its change.
   pure subroutine advance_rows(n, dt, gravity, rate, node)
      integer, intent(in) :: n
      real(wp), intent(in) :: dt, gravity(3), rate
      real(wp), intent(inout) :: node(8, n)
      real(wp) :: per_mass, v, change
      integer :: i, k

      do i = 1, n
         if (.not. node(1, i) > 0) then
            node(2:7, i) = 0
            cycle
         end if
         per_mass = 1/node(1, i)
         do k = 1, 3
            v = node(1 + k, i)*per_mass
            change = dt*(node(4 + k, i)*per_mass + gravity(k) - rate*v)
            node(1 + k, i) = v + change
            node(4 + k, i) = change
         end do
      end do
   end subroutine advance_rows

   !> Add the work of body force and nodal damping in a step, when conditions and contact have had
   !> their say: exact for the change of the rows' kinetic energy.
   pure subroutine add_nodal_work(grid, dt, gravity, rate, work)
      type(grid_t), intent(in) :: grid
      real(wp), intent(in) :: dt           !! from v(n-1/2) to v(n+1/2) [time]
      real(wp), intent(in) :: gravity(3)   !! body force per mass [length/time^2]
      real(wp), intent(in) :: rate         !! of nodal damping [1/time]
      type(nodal_work_t), intent(inout) :: work
      real(wp) :: impulse, v(3), mean(3)
      integer :: b, i, first, last

      if (.not. (any(abs(gravity) > 0) .or. rate > 0)) return
      do b = 1, grid%blocks%n_node_blocks + 1
         call active_rows(grid, b, first, last)
         do i = first, last
            if (.not. (grid%node(1, i) > 0 .and. grid%mine(i))) cycle
            impulse = dt*grid%node(1, i)
            v = grid%node(2:4, i) - grid%node(5:7, i)
            mean = v + 0.5_wp*grid%node(5:7, i)
            work%external = work%external + impulse*dot_product(gravity, mean)
            work%damping = work%damping + impulse*rate*dot_product(v, mean)
         end do
      end do
   end subroutine add_nodal_work

   !> Sum of |m change| over the rows that this rank counts [momentum]; fields 5:7 hold the change.
   pure function force_out_of_balance(grid) result(total)
      type(grid_t), intent(in) :: grid
      real(wp) :: total
      integer :: b, i, first, last

      total = 0
      do b = 1, grid%blocks%n_node_blocks + 1
         call active_rows(grid, b, first, last)
         do i = first, last
            if (grid%mine(i)) total = total + grid%node(1, i)*norm2(grid%node(5:7, i))
         end do
      end do
   end function force_out_of_balance

   !> Sum of m |change|^2 over the rows that this rank counts [energy]; fields 5:7 hold the change.
   pure function impulse_energy(grid) result(total)
      type(grid_t), intent(in) :: grid
      real(wp) :: total
      integer :: b, i, first, last

      total = 0
      do b = 1, grid%blocks%n_node_blocks + 1
         call active_rows(grid, b, first, last)
         do i = first, last
            if (grid%mine(i)) total = total + grid%node(1, i)*sum(grid%node(5:7, i)**2)
         end do
      end do
   end function impulse_energy

   !> Change that gives the particles the share `eta` of the nodal velocity: fields 5:7 become
   !> (1 - eta) change + eta target, where the target is v for PIC and 2 v - S+ S v for XPIC(2) in
   !> the form of Nairn and Hammerquist 2021, with the momentum of S+ S v in grid%second.
   subroutine blend_change(grid, eta, xpic)
      type(grid_t), intent(inout) :: grid
      real(wp), intent(in) :: eta    !! share of the nodal velocity, 0 to 1
      logical, intent(in) :: xpic    !! whether the target is that of XPIC(2)
      real(wp) :: target(3)
      integer :: b, i, first, last

      do b = 1, grid%blocks%n_node_blocks + 1
         call active_rows(grid, b, first, last)
         do i = first, last
            if (.not. grid%node(1, i) > 0) cycle
            target = grid%node(2:4, i)
            if (xpic) target = 2*target - grid%second(:, i)/grid%node(1, i)
            grid%node(5:7, i) = (1 - eta)*grid%node(5:7, i) + eta*target
            grid%second(:, i) = 0
         end do
      end do
   end subroutine blend_change

   !> Fields 5:7, say w, become w + 3/4 (w - S+ S w); grid%second has the momentum of S+ S w, and is
   !> cleared. With `carry` the velocity in fields 2:4 gets what they gain.
   !>
   !> Of the 3/4 one half makes up for the two transfers of a step, since it acts twice, and one
   !> quarter for the lumped mass, on the mean over all directions of a wave.
   subroutine sharpen_rows(grid, carry)
      type(grid_t), intent(inout) :: grid
      logical, intent(in) :: carry   !! whether 5:7 are the change of 2:4
      real(wp) :: gain(3)
      integer :: b, i, first, last

      do b = 1, grid%blocks%n_node_blocks + 1
         call active_rows(grid, b, first, last)
         do i = first, last
            if (.not. grid%node(1, i) > 0) cycle
            gain = 0.75_wp*(grid%node(5:7, i) - grid%second(:, i)/grid%node(1, i))
            grid%node(5:7, i) = grid%node(5:7, i) + gain
            if (carry) grid%node(2:4, i) = grid%node(2:4, i) + gain
            grid%second(:, i) = 0
         end do
      end do
   end subroutine sharpen_rows

   !> Velocity of MUSL's second map in fields 5:7; grid%second is cleared.
   subroutine velocity_from_second(grid)
      type(grid_t), intent(inout) :: grid
      integer :: b, first, last

      do b = 1, grid%blocks%n_node_blocks + 1
         call active_rows(grid, b, first, last)
         call take_second(last - first + 1, grid%second(:, first:last), grid%node(:, first:last))
      end do
   end subroutine velocity_from_second

   !> Momentum of the second map over mass goes to fields 5:7 of rows, 0 where there is no mass.
   pure subroutine take_second(n, second, node)
      integer, intent(in) :: n
      real(wp), intent(inout) :: second(3, n)   !! cleared
      real(wp), intent(inout) :: node(8, n)
      real(wp) :: per_mass
      integer :: i

      do i = 1, n
         per_mass = 0
         if (node(1, i) > 0) per_mass = 1/node(1, i)
         node(5, i) = per_mass*second(1, i)
         node(6, i) = per_mass*second(2, i)
         node(7, i) = per_mass*second(3, i)
      end do
      second = 0
   end subroutine take_second

   !> Fields 5:7 become the velocity of fields 2:4 (momentum there where `divide` is asked for).
   subroutine change_from_velocity(grid, divide)
      type(grid_t), intent(inout) :: grid
      logical, intent(in) :: divide   !! whether 2:4 hold momentum
      integer :: b, i, first, last

      do b = 1, grid%blocks%n_node_blocks + 1
         call active_rows(grid, b, first, last)
         do i = first, last
            grid%node(5:7, i) = grid%node(2:4, i)
            if (divide .and. grid%node(1, i) > 0) then
               grid%node(5:7, i) = grid%node(2:4, i)/grid%node(1, i)
            end if
         end do
      end do
   end subroutine change_from_velocity
end module xmpm_momentum
