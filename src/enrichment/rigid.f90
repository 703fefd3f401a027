!> Rigid bodies: all rows of one move with one velocity, found from all forces and contacts on it.
!>
!> They move without turning. A body of mass M that would have the velocity V* after the step takes
!> the sum F(V) of the impulses that contact with it at the velocity V brings: M (V - V*) = F(V),
!> solved by
!> Newton's method, so that a light body on many nodes does not bounce between two steps. The
!> impulses
!> then given are summed once more, and V follows from that sum: momentum is kept to rounding.
module xmpm_rigid
   use xmpm_kinds, only: wp
   use xmpm_communicator, only: comm_t, sum_all
   use xmpm_grid, only: grid_t, f_mass, f_velocity, f_change
   use xmpm_split, only: split_t, row_of_sides, sides_of_group
   use xmpm_contact_pairs, only: contact_t
   use xmpm_contact, only: impulse_between, may_meet
   implicit none
   private

   public :: rigid_t, list_rigid_rows, predict_motion, meet_rigid, move_rigid, hold_rigid

   integer, parameter :: most_rounds = 8      !! of Newton's method
   real(wp), parameter :: settled = 1e-12_wp  !! change of velocity at which it ends, relative

   !> All rigid bodies.
   type :: rigid_t
      integer :: n = 0                           !! bodies
      integer, allocatable :: group(:)           !! (n) contact group of each
      logical, allocatable :: held(:, :)         !! (3,n) components that are prescribed
      real(wp), allocatable :: prescribed(:, :)  !! (3,n) their velocity [length/time]
      integer, allocatable :: row(:)             !! rows that rigid bodies reach
      integer, allocatable :: owner(:)           !! body of each
      real(wp), allocatable :: mass(:)           !! (n)
      real(wp), allocatable :: before(:, :)      !! (3,n) velocity before the step [length/time]
      real(wp), allocatable :: free(:, :)        !! (3,n) after it, without contact [length/time]
      real(wp), allocatable :: now(:, :)         !! (3,n) after it [length/time]
      real(wp) :: work = 0                       !! of what holds components, on one rank [energy]
   end type rigid_t

contains

   !> List the rows of all rigid bodies.
   subroutine list_rigid_rows(rigid, split)
      type(rigid_t), intent(inout) :: rigid   !! groups are given
      type(split_t), intent(in) :: split
      integer :: r, row, s, k, n
      integer, allocatable :: sides(:)

      if (allocated(rigid%row)) deallocate (rigid%row, rigid%owner)
      n = 8*rigid%n*count(split%groups /= 0)
      allocate (rigid%row(n), rigid%owner(n))
      n = 0
      do r = 1, rigid%n
         do row = 1, size(split%groups)
            if (.not. btest(split%groups(row), rigid%group(r))) cycle
            s = split%of(row)
            sides = [0]
            if (s > 0) sides = sides_of_group(split, s, rigid%group(r))
            do k = 1, size(sides)
               n = n + 1
               rigid%row(n) = row
               if (s > 0) rigid%row(n) = row_of_sides(split, s, sides(k))
               rigid%owner(n) = r
            end do
         end do
      end do
      rigid%row = rigid%row(:n)
      rigid%owner = rigid%owner(:n)
   end subroutine list_rigid_rows

   !> Mass and velocities of the bodies before and after the nodal update, which has done its work
   !> on
   !> all rows; without contact yet. Collective.
   subroutine predict_motion(rigid, comm, grid)
      type(rigid_t), intent(inout) :: rigid
      type(comm_t), intent(in) :: comm
      type(grid_t), intent(in) :: grid
      real(wp) :: sums(7, rigid%n)
      integer :: i

      sums = 0
      do i = 1, size(rigid%row)
         if (.not. grid%mine(rigid%row(i))) cycle
         associate (node => grid%node(:, rigid%row(i)), s => sums(:, rigid%owner(i)))
            s(1) = s(1) + node(f_mass)
            s(2:4) = s(2:4) + node(f_mass)*node(f_velocity:f_velocity + 2)
            s(5:7) = s(5:7) + node(f_mass)*node(f_change:f_change + 2)
         end associate
      end do
      call sum_all(comm, sums)
      rigid%mass = sums(1, :)
      rigid%free = sums(2:4, :)/spread(sums(1, :), 1, 3)
      rigid%before = rigid%free - sums(5:7, :)/spread(sums(1, :), 1, 3)
      rigid%now = merge(rigid%prescribed, rigid%free, rigid%held)
   end subroutine predict_motion

   !> Velocities with the contacts of the step. Collective.
   subroutine meet_rigid(rigid, contact, comm, grid)
      type(rigid_t), intent(inout) :: rigid
      type(contact_t), intent(inout) :: contact
      type(comm_t), intent(in) :: comm
      type(grid_t), intent(in) :: grid
      real(wp) :: sums(12, rigid%n), change(3)
      logical :: done
      integer :: round, r

      call prescribe(contact, rigid%now)
      do round = 1, most_rounds
         call sum_contact(rigid, contact, grid, sums)
         call sum_all(comm, sums)
         done = .true.
         do r = 1, rigid%n
            change = newton_step(rigid, r, sums(:, r))
            rigid%now(:, r) = rigid%now(:, r) + change
            done = done .and. norm2(change) <= settled*(norm2(rigid%now(:, r)) &
               + norm2(rigid%before(:, r)))
         end do
         call prescribe(contact, rigid%now)
         if (done) exit
      end do
   end subroutine meet_rigid

   !> Tell the pairs how fast their rigid sides are.
   pure subroutine prescribe(contact, velocity)
      type(contact_t), intent(inout) :: contact
      real(wp), intent(in) :: velocity(:, :)   !! (3,rigid bodies) [length/time]
      integer :: i, side, r

      do i = 1, contact%n
         do side = 1, 2
            r = contact%rigid(contact%group(side, i))
            if (r > 0) contact%prescribed(:, side, i) = velocity(:, r)
         end do
      end do
   end subroutine prescribe

   !> Impulses on each body and their decrease with its velocity, of the pairs that this rank
   !> counts.
   subroutine sum_contact(rigid, contact, grid, sums)
      type(rigid_t), intent(in) :: rigid
      type(contact_t), intent(in) :: contact
      type(grid_t), intent(in) :: grid
      real(wp), intent(out) :: sums(12, rigid%n)   !! impulse, then 3 x 3 by columns
      real(wp) :: impulse(3), n(3), slope(3, 3), mass, normal
      integer :: i, side, r, k

      sums = 0
      do i = 1, contact%n
         do side = 1, 2
            r = contact%rigid(contact%group(side, i))
            if (r == 0 .or. contact%rigid(contact%group(3 - side, i)) > 0) cycle
            if (.not. grid%mine(contact%row(1, i))) cycle
            if (.not. may_meet(contact, grid, i)) cycle
            call impulse_between(contact, grid, i, f_velocity, impulse)
            if (.not. any(abs(impulse) > 0)) cycle
            n = contact%normal(:, i)
            mass = grid%node(f_mass, contact%row(3 - side, i))
            normal = dot_product(impulse, n)
            slope = 0
            do k = 1, 3
               slope(:, k) = mass*n*n(k)
            end do
            if (norm2(impulse - normal*n) < (1 - 1e-9_wp)*normal &
                *contact%mu(i)) then
               slope = 0
               do k = 1, 3
                  slope(k, k) = mass
               end do
            end if
            sums(:3, r) = sums(:3, r) + real(2*side - 3, wp)*impulse
            sums(4:, r) = sums(4:, r) + reshape(slope, [9])
         end do
      end do
   end subroutine sum_contact

   !> Change of a body's velocity: (M + K) change = M (V* - V) + F in the components not held.
   pure function newton_step(rigid, r, sums) result(change)
      type(rigid_t), intent(in) :: rigid
      integer, intent(in) :: r
      real(wp), intent(in) :: sums(12)
      real(wp) :: change(3), a(3, 3), f
      integer :: k, j

      a = reshape(sums(4:), [3, 3])
      do k = 1, 3
         a(k, k) = a(k, k) + rigid%mass(r)
      end do
      change = rigid%mass(r)*(rigid%free(:, r) - rigid%now(:, r)) + sums(:3)
      do k = 1, 3
         if (.not. rigid%held(k, r)) cycle
         a(k, :) = 0
         a(:, k) = 0
         a(k, k) = 1
         change(k) = 0
      end do
      do k = 1, 3   ! the matrix is symmetric and positive: no pivots are needed
         do j = k + 1, 3
            f = a(j, k)/a(k, k)
            a(j, :) = a(j, :) - f*a(k, :)
            change(j) = change(j) - f*change(k)
         end do
      end do
      do k = 3, 1, -1
         change(k) = (change(k) - dot_product(a(k, k + 1:), change(k + 1:)))/a(k, k)
      end do
   end function newton_step

   !> Final velocities from the impulses that were given; all rows of a body take them. Collective.
   subroutine move_rigid(rigid, contact, comm, grid)
      type(rigid_t), intent(inout) :: rigid
      type(contact_t), intent(inout) :: contact
      type(comm_t), intent(in) :: comm
      type(grid_t), intent(inout) :: grid
      real(wp) :: sums(3, rigid%n), holding(3)
      integer :: i, side, r

      sums = 0
      do i = 1, contact%n
         if (.not. grid%mine(contact%row(1, i))) cycle
         do side = 1, 2
            r = contact%rigid(contact%group(side, i))
            if (r > 0) sums(:, r) = sums(:, r) + real(2*side - 3, wp)*contact%impulse(:, i)
         end do
      end do
      call sum_all(comm, sums)
      do r = 1, rigid%n
         rigid%now(:, r) = rigid%free(:, r) + sums(:, r)/rigid%mass(r)
         holding = 0
         where (rigid%held(:, r)) holding = rigid%prescribed(:, r) - rigid%now(:, r)
         rigid%now(:, r) = rigid%now(:, r) + holding
         if (comm%rank == 0) rigid%work = rigid%work + rigid%mass(r)*dot_product(holding, &
            0.5_wp*(rigid%before(:, r) + rigid%now(:, r)))
      end do
      call prescribe(contact, rigid%now)
      do i = 1, size(rigid%row)
         r = rigid%owner(i)
         if (.not. grid%node(f_mass, rigid%row(i)) > 0) cycle
         grid%node(f_velocity:f_velocity + 2, rigid%row(i)) = rigid%now(:, r)
         grid%node(f_change:f_change + 2, rigid%row(i)) = rigid%now(:, r) - rigid%before(:, r)
      end do
   end subroutine move_rigid

   !> Rigid sides of the pairs are held, at the velocity that their rows have.
   pure subroutine hold_rigid(contact, grid, field)
      type(contact_t), intent(inout) :: contact
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: field   !! first of the three
      integer :: i, side

      do i = 1, contact%n
         do side = 1, 2
            if (contact%rigid(contact%group(side, i)) == 0) cycle
            contact%held(:, side, i) = .true.
            contact%prescribed(:, side, i) = grid%node(field:field + 2, contact%row(side, i))
         end do
      end do
   end subroutine hold_rigid
end module xmpm_rigid
