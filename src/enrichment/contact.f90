!> Impulses between bodies that meet: equal and opposite, where they would close more than the gap.
module xmpm_contact
   use xmpm_kinds, only: wp
   use xmpm_grid, only: grid_t, f_mass, f_velocity, f_change
   use xmpm_contact_pairs, only: contact_t
   implicit none
   private

   public :: apply_impulses, impulse_between, may_meet, velocity_of, hold_side
   public :: note_reach, note_pull, note_first, note_second, note_again

   integer, parameter :: sweeps = 4            !! through the pairs, where a node has several
   real(wp), parameter :: slipping = 1e-9_wp   !! what friction may lack of its most when a pair
                                               !! slips
   real(wp), parameter :: overlap = 1e-12_wp   !! likewise for the faces of a crack [cells]
   real(wp), parameter :: touching = 1e-3_wp   !! gap that counts as closed [cells]

contains

   !> Impulses of all pairs on three fields of the rows.
   !>
   !> Where the rows would approach by more than the gap in this step, the difference of their
   !> velocities along the normal becomes that which closes it (0 where it is closed), and Coulomb
   !> friction acts across it. Momentum of both stays to rounding. Prescribed components count as
   !> those of an infinite mass. With `whole` they take the impulse all the same, so that the
   !> condition which holds them finds it as a reaction; and the impulses are kept.
   subroutine apply_impulses(contact, grid, field, whole)
      type(contact_t), intent(inout) :: contact
      type(grid_t), intent(inout) :: grid
      integer, intent(in) :: field           !! first of the three
      logical, intent(in) :: whole           !! velocities are those of the nodal update
      real(wp) :: impulse(3)
      integer :: i, sweep

      if (whole) contact%impulse = 0
      do sweep = 1, merge(sweeps, 1, any(contact%many > 1))
         do i = 1, contact%n
            if (.not. may_meet(contact, grid, i)) cycle
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
               contact%again(:, i) = contact%again(:, i) + impulse
            end if
         end do
      end do
   end subroutine apply_impulses

   !> Whether a pair may close in this step.
   pure function may_meet(contact, grid, i) result(near)
      type(contact_t), intent(in) :: contact
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: i
      logical :: near

      near = contact%gap(i) < grid%lattice%size .and. all(grid%node(f_mass, contact%row(:, i)) > 0)
   end function may_meet

   !> Impulse on the second row of a pair, where it would close further than it may.
   pure subroutine impulse_between(contact, grid, i, field, impulse)
      type(contact_t), intent(in) :: contact
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: i, field       !! pair; first of the three fields
      real(wp), intent(out) :: impulse(3)   !! [momentum]
      real(wp) :: yield(3), v(3), n(3), t(3), slip, normal, across

      impulse = 0
      n = contact%normal(:, i)
      v = velocity_of(contact, grid, i, 2, field) - velocity_of(contact, grid, i, 1, field)
      if (.not. dot_product(v, n) + contact%reach(i) < 0) return
      yield = yield_of(contact, grid, i)
      if (.not. dot_product(n*n, yield) > 0) return
      normal = -(dot_product(v, n) + contact%reach(i))/dot_product(n*n, yield)
      impulse = normal*n
      v = v + normal*yield*n
      t = v - dot_product(v, n)*n
      slip = norm2(t)
      if (.not. slip > 0) return
      t = t/slip
      if (.not. dot_product(t*t, yield) > 0) return
      across = slip/dot_product(t*t, yield)
      across = min(across, contact%mu(i)*normal)
      impulse = impulse - across*t
   end subroutine impulse_between

   !> Impulse that keeps a pair which the nodal update found in contact: the normal velocities
   !> become one (or approach as they may), also where they separate, for else the stress would do
   !> work that no motion gives back; the others too where the pair sticks.
   pure subroutine keep_closed(contact, grid, i, field, impulse)
      type(contact_t), intent(in) :: contact
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: i, field       !! pair; first of the three fields
      real(wp), intent(out) :: impulse(3)   !! [momentum]
      real(wp) :: yield(3), v(3), n(3)

      impulse = 0
      n = contact%normal(:, i)
      v = velocity_of(contact, grid, i, 2, field) - velocity_of(contact, grid, i, 1, field)
      yield = yield_of(contact, grid, i)
      if (sticks(contact, i)) then
         where (yield > 0) impulse = -v/yield
      else if (dot_product(n*n, yield) > 0) then
         impulse = -dot_product(v, n)/dot_product(n*n, yield)*n
      end if
   end subroutine keep_closed

   !> Whether friction holds a pair that had an impulse.
   pure function sticks(contact, i) result(holds)
      type(contact_t), intent(in) :: contact
      integer, intent(in) :: i
      logical :: holds
      real(wp) :: normal, across(3)

      normal = dot_product(contact%impulse(:, i), contact%normal(:, i))
      across = contact%impulse(:, i) - normal*contact%normal(:, i)
      holds = norm2(across) < (1 - slipping)*normal*contact%mu(i)
   end function sticks

   !> Change of the difference of the velocities by an impulse: both inverse masses, 0 where held.
   pure function yield_of(contact, grid, i) result(yield)
      type(contact_t), intent(in) :: contact
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: i
      real(wp) :: yield(3)   !! [1/mass]

      yield = 0
      where (.not. contact%held(:, 1, i)) yield = 1/grid%node(f_mass, contact%row(1, i))
      where (.not. contact%held(:, 2, i)) yield = yield + 1/grid%node(f_mass, contact%row(2, i))
   end function yield_of

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

   !> How fast each pair may approach without closing its gap in this step.
   pure subroutine note_reach(contact, size, dt)
      type(contact_t), intent(inout) :: contact
      real(wp), intent(in) :: size, dt   !! of the cells [length], of the step [time]
      integer :: i

      do i = 1, contact%n
         contact%reach(i) = 0
         if (contact%gap(i) < merge(touching, overlap, contact%crack(i) == 0)*size) cycle
         contact%reach(i) = min(contact%gap(i), size)/dt
      end do
   end subroutine note_reach

   !> Note what stress and loads do to the rows of all pairs, from their forces, and add what they
   !> do on the way of the second map's impulses of the step before.
   pure subroutine note_pull(contact, grid, dt)
      type(contact_t), intent(inout) :: contact
      type(grid_t), intent(in) :: grid   !! with forces in fields 5:7
      real(wp), intent(in) :: dt         !! the step before [time]
      integer :: i, side

      contact%owed = 0
      do i = 1, contact%n
         do side = 1, 2
            associate (node => grid%node(:, contact%row(side, i)))
               contact%pull(:, side, i) = 0
               if (node(f_mass) > 0) contact%pull(:, side, i) = &
                  node(f_change:f_change + 2)/node(f_mass)
            end associate
         end do
         if (grid%mine(contact%row(1, i))) contact%lost = contact%lost &
            + 0.5_wp*dt*work_again(contact, i)
         contact%again(:, i) = 0
      end do
   end subroutine note_pull

   !> Power of stress and loads on what the second map's impulses changed.
   pure function work_again(contact, i) result(power)
      type(contact_t), intent(in) :: contact
      integer, intent(in) :: i
      real(wp) :: power   !! [energy/time]

      power = dot_product(contact%again(:, i), &
         merge(0.0_wp, contact%pull(:, 2, i), contact%held(:, 2, i)) &
         - merge(0.0_wp, contact%pull(:, 1, i), contact%held(:, 1, i)))
   end function work_again

   !> Add half of what the impulses of the nodal update took: that with the velocities before it.
   !>
   !> An impulse takes the kinetic energy of the particles by minus its product with the mean of two
   !> relative velocities: that before the nodal update and that of the second map.
   subroutine note_first(contact, grid, before)
      type(contact_t), intent(inout) :: contact
      type(grid_t), intent(in) :: grid
      real(wp), intent(in) :: before(:, :)   !! (3,rigid bodies) before the step [length/time]
      integer :: i

      do i = 1, contact%n
         if (.not. any(abs(contact%impulse(:, i)) > 0)) cycle
         if (.not. grid%mine(contact%row(1, i))) cycle
         contact%lost = contact%lost - 0.5_wp*dot_product(contact%impulse(:, i), &
            old_velocity(contact, grid, i, 2, before) - old_velocity(contact, grid, i, 1, before))
      end do
   end subroutine note_first

   !> Add the other half, with the velocities of three fields: of the second map, before its own
   !> impulses.
   subroutine note_second(contact, grid, field)
      type(contact_t), intent(inout) :: contact
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: field
      integer :: i

      do i = 1, contact%n
         if (.not. any(abs(contact%impulse(:, i)) > 0)) cycle
         if (.not. grid%mine(contact%row(1, i))) cycle
         contact%lost = contact%lost - 0.5_wp*dot_product(contact%impulse(:, i), &
            grid%node(field:field + 2, contact%row(2, i)) &
            - grid%node(field:field + 2, contact%row(1, i)))
      end do
   end subroutine note_second

   !> Add the work of stress on what the second map's impulses changed: half of it with the stress
   !> of now, the other half with that of the next step, which is owed until then.
   subroutine note_again(contact, grid, dt)
      type(contact_t), intent(inout) :: contact
      type(grid_t), intent(in) :: grid
      real(wp), intent(in) :: dt   !! [time]
      real(wp) :: work
      integer :: i

      do i = 1, contact%n
         if (.not. grid%mine(contact%row(1, i))) cycle
         work = 0.5_wp*dt*work_again(contact, i)
         contact%lost = contact%lost + work
         contact%owed = contact%owed + work
      end do
   end subroutine note_again

   !> Velocity of one side of a pair before the nodal update.
   pure function old_velocity(contact, grid, i, side, before) result(v)
      type(contact_t), intent(in) :: contact
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: i, side
      real(wp), intent(in) :: before(:, :)
      real(wp) :: v(3)
      integer :: r

      r = contact%rigid(contact%group(side, i))
      if (r > 0) then
         v = before(:, r)
      else
         associate (node => grid%node(:, contact%row(side, i)))
            v = node(f_velocity:f_velocity + 2) - node(f_change:f_change + 2)
         end associate
      end if
   end function old_velocity

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
