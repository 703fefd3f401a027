!> Impulses between bodies that meet: equal and opposite, where they approach and the gap is closed.
module xmpm_contact
   use xmpm_kinds, only: wp
   use xmpm_grid, only: grid_t, f_mass, f_velocity, f_change
   use xmpm_contact_pairs, only: contact_t
   implicit none
   private

   public :: apply_impulses, impulse_between, is_closed, note_loss, velocity_of, hold_side

   integer, parameter :: sweeps = 4            !! through the pairs, where a node has several
   real(wp), parameter :: touching = 1e-3_wp   !! gap that counts as closed [cells]

contains

   !> Impulses of all pairs on three fields of the rows.
   !>
   !> Where the gap is closed and the rows approach, the difference of their velocities along the
   !> normal becomes 0, and Coulomb friction acts across it. Momentum of both stays to rounding.
   !> Prescribed components count as
   !> those of an infinite mass. With `whole` they take the impulse all the same, so that the
   !> condition
   !> which holds them finds it as a reaction; and the impulses are kept.
   subroutine apply_impulses(contact, grid, field, whole)
      type(contact_t), intent(inout) :: contact
      type(grid_t), intent(inout) :: grid
      integer, intent(in) :: field           !! first of the three
      logical, intent(in) :: whole           !! velocities are those of the nodal update
      real(wp) :: impulse(3)
      integer :: i, sweep

      if (whole) call note_forces(contact, grid)
      do sweep = 1, merge(sweeps, 1, any(contact%many > 1))
         do i = 1, contact%n
            if (.not. is_closed(contact, grid, i)) cycle
            if (whole .or. .not. any(abs(contact%impulse(:, i)) > 0)) then
               call impulse_between(contact, grid, i, field, impulse)
            else
               call keep_closed(contact, grid, i, field, impulse)
            end if
            if (.not. any(abs(impulse) > 0)) cycle
            call push(contact, grid, i, 1, field, -impulse, whole)
            call push(contact, grid, i, 2, field, impulse, whole)
            if (whole) then
               contact%impulse(:, i) = contact%impulse(:, i) + impulse
            else
               call note_straining(contact, grid, i, impulse)
            end if
         end do
      end do
   end subroutine apply_impulses

   !> Keep what forces give the rows in this step, before any impulse.
   subroutine note_forces(contact, grid)
      type(contact_t), intent(inout) :: contact
      type(grid_t), intent(in) :: grid
      integer :: i, side

      contact%impulse = 0
      do i = 1, contact%n
         do side = 1, 2
            associate (node => grid%node(:, contact%row(side, i)))
               contact%force(:, side, i) = node(f_mass)*node(f_change:f_change + 2)
            end associate
         end do
      end do
   end subroutine note_forces

   !> Energy of an impulse on the velocity that strains: particles do not take it, so that the next
   !> step's velocity before the update is without it. Half the work of the forces on the difference
   !> is then in the kinetic energy but not in the stress work.
   subroutine note_straining(contact, grid, i, impulse)
      type(contact_t), intent(inout) :: contact
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: i
      real(wp), intent(in) :: impulse(3)
      integer :: side
      real(wp) :: change(3)

      if (.not. grid%mine(contact%row(1, i))) return
      do side = 1, 2
         change = real(2*side - 3, wp)*impulse/grid%node(f_mass, contact%row(side, i))
         where (contact%held(:, side, i)) change = 0
         contact%lost = contact%lost + 0.5_wp*dot_product(contact%force(:, side, i), change)
      end do
   end subroutine note_straining

   !> Whether the gap of a pair is closed.
   pure function is_closed(contact, grid, i) result(closed)
      type(contact_t), intent(in) :: contact
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: i
      logical :: closed

      closed = contact%gap(i) < touching*grid%lattice%size &
         .and. all(grid%node(f_mass, contact%row(:, i)) > 0)
   end function is_closed

   !> Impulse on the second row of a closed pair.
   pure subroutine impulse_between(contact, grid, i, field, impulse)
      type(contact_t), intent(in) :: contact
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: i, field       !! pair; first of the three fields
      real(wp), intent(out) :: impulse(3)   !! [momentum]
      real(wp) :: yield(3), v(3), n(3), t(3), slip, normal, across

      impulse = 0
      n = contact%normal(:, i)
      v = velocity_of(contact, grid, i, 2, field) - velocity_of(contact, grid, i, 1, field)
      if (.not. dot_product(v, n) < 0) return
      yield = 0
      where (.not. contact%held(:, 1, i)) yield = 1/grid%node(f_mass, contact%row(1, i))
      where (.not. contact%held(:, 2, i)) yield = yield + 1/grid%node(f_mass, contact%row(2, i))
      if (.not. dot_product(n*n, yield) > 0) return
      normal = -dot_product(v, n)/dot_product(n*n, yield)
      impulse = normal*n
      v = v + normal*yield*n
      t = v - dot_product(v, n)*n
      slip = norm2(t)
      if (.not. slip > 0) return
      t = t/slip
      if (.not. dot_product(t*t, yield) > 0) return
      across = slip/dot_product(t*t, yield)
      across = min(across, contact%friction(contact%group(1, i), contact%group(2, i))*normal)
      impulse = impulse - across*t
   end subroutine impulse_between

   !> Impulse that keeps a pair which the nodal update found in contact: the normal velocities
   !> become
   !> one, also where they separate, for else the stress would do work that no motion gives back.
   pure subroutine keep_closed(contact, grid, i, field, impulse)
      type(contact_t), intent(in) :: contact
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: i, field       !! pair; first of the three fields
      real(wp), intent(out) :: impulse(3)   !! [momentum]
      real(wp) :: yield(3), v(3), n(3)

      impulse = 0
      n = contact%normal(:, i)
      v = velocity_of(contact, grid, i, 2, field) - velocity_of(contact, grid, i, 1, field)
      yield = 0
      where (.not. contact%held(:, 1, i)) yield = 1/grid%node(f_mass, contact%row(1, i))
      where (.not. contact%held(:, 2, i)) yield = yield + 1/grid%node(f_mass, contact%row(2, i))
      if (.not. dot_product(n*n, yield) > 0) return
      impulse = -dot_product(v, n)/dot_product(n*n, yield)*n
   end subroutine keep_closed

   !> Velocity of one side of a pair, with what is prescribed.
   pure function velocity_of(contact, grid, i, side, field) result(v)
      type(contact_t), intent(in) :: contact
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: i, side, field
      real(wp) :: v(3)

      v = merge(contact%prescribed(:, side, i), &
         grid%node(field:field + 2, contact%row(side, i)), contact%held(:, side, i))
   end function velocity_of

   !> Give an impulse to one side of a pair.
   pure subroutine push(contact, grid, i, side, field, impulse, whole)
      type(contact_t), intent(in) :: contact
      type(grid_t), intent(inout) :: grid
      integer, intent(in) :: i, side, field
      real(wp), intent(in) :: impulse(3)
      logical, intent(in) :: whole
      real(wp) :: change(3)
      integer :: row

      row = contact%row(side, i)
      change = impulse/grid%node(f_mass, row)
      if (.not. whole) where (contact%held(:, side, i)) change = 0
      grid%node(field:field + 2, row) = grid%node(field:field + 2, row) + change
      if (whole) then
         grid%node(f_change:f_change + 2, row) = grid%node(f_change:f_change + 2, row) + change
      end if
   end subroutine push

   !> Add the energy that the impulses of the nodal update took: minus impulse times the mean of
   !> relative velocity before and after the step, which is exact for the rows' kinetic energy.
   !> `before` is the velocity of rigid bodies before the step; theirs after it is prescribed.
   subroutine note_loss(contact, grid, before)
      type(contact_t), intent(inout) :: contact
      type(grid_t), intent(in) :: grid
      real(wp), intent(in) :: before(:, :)   !! (3,rigid bodies) [length/time]
      real(wp) :: mean(3, 2)
      integer :: i, side, r

      do i = 1, contact%n
         if (.not. any(abs(contact%impulse(:, i)) > 0)) cycle
         if (.not. grid%mine(contact%row(1, i))) cycle
         do side = 1, 2
            r = contact%rigid(contact%group(side, i))
            mean(:, side) = velocity_of(contact, grid, i, side, f_velocity)
            if (r > 0) then
               mean(:, side) = 0.5_wp*(mean(:, side) + before(:, r))
            else
               associate (node => grid%node(:, contact%row(side, i)))
                  mean(:, side) = 0.5_wp*(mean(:, side) + node(f_velocity:f_velocity + 2) &
                     - node(f_change:f_change + 2))
               end associate
            end if
         end do
         contact%lost = contact%lost - dot_product(contact%impulse(:, i), mean(:, 2) - mean(:, 1))
      end do
   end subroutine note_loss

   !> Prescribe a component of the pairs that use a row.
   pure subroutine hold_side(contact, row, component, velocity)
      type(contact_t), intent(inout) :: contact
      integer, intent(in) :: row, component
      real(wp), intent(in) :: velocity   !! [length/time]
      integer :: j, side

      do j = contact%first(row), contact%first(row) + contact%many(row) - 1
         do side = 1, 2
            if (contact%row(side, j) /= row) cycle
            contact%held(component, side, j) = .true.
            contact%prescribed(component, side, j) = velocity
         end do
      end do
   end subroutine hold_side
end module xmpm_contact
