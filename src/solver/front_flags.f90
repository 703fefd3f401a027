!> Marks the front points whose domain holds nodes of a boundary condition.
module xmpm_front_flags
   use xmpm_kinds, only: wp
   use xmpm_communicator, only: comm_t, max_all
   use xmpm_grid, only: grid_t, node_position
   use xmpm_boundary, only: boundary_t, region_plane, region_box
   use xmpm_front_values, only: front_values_t, flag_held
   implicit none
   private

   public :: flag_conditions

contains

   !> Add `flag_held` where a condition is nearer than the radius of the domain. Collective.
   subroutine flag_conditions(boundaries, comm, grid, values)
      type(boundary_t), intent(in) :: boundaries(:)
      type(comm_t), intent(in) :: comm
      type(grid_t), intent(in) :: grid
      type(front_values_t), intent(inout) :: values
      logical :: held(values%points%n)
      real(wp) :: low(3), high(3)
      integer :: i, k

      held = .false.
      do k = 1, size(boundaries)
         call region_of_condition(boundaries(k), comm, grid, low, high)
         do i = 1, values%points%n
            held(i) = held(i) .or. distance(values%points%x(:, i), low, high) < values%radius(i)
         end do
      end do
      where (held) values%flags = values%flags + flag_held
   end subroutine flag_conditions

   !> Box around the nodes of a condition. Collective.
   subroutine region_of_condition(b, comm, grid, low, high)
      type(boundary_t), intent(in) :: b
      type(comm_t), intent(in) :: comm
      type(grid_t), intent(in) :: grid
      real(wp), intent(out) :: low(3), high(3)   !! [length]
      real(wp) :: most(6)
      integer :: k

      low = -huge(1.0_wp)
      high = huge(1.0_wp)
      select case (b%region)
      case (region_plane)
         if (b%outward > 0) low(b%axis) = b%coordinate
         if (b%outward < 0) high(b%axis) = b%coordinate
      case (region_box)
         low = b%low
         high = b%high
      case default
         most = -huge(1.0_wp)
         do k = 1, size(b%rows)
            most(:3) = max(most(:3), node_position(grid, b%rows(k)))
            most(4:) = max(most(4:), -node_position(grid, b%rows(k)))
         end do
         call max_all(comm, most)
         low = -most(4:)
         high = most(:3)
      end select
   end subroutine region_of_condition

   !> From a point to a box, 0 within it.
   pure function distance(x, low, high) result(d)
      real(wp), intent(in) :: x(3), low(3), high(3)   !! [length]
      real(wp) :: d

      d = norm2(max(0.0_wp, low - x, x - high))
   end function distance
end module xmpm_front_flags
