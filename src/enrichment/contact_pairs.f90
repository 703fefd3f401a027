!> Where bodies of different contact groups, or the faces of a crack, meet: pairs of rows of one
!> node.
module xmpm_contact_pairs
   use xmpm_kinds, only: wp
   use xmpm_halo, only: halo_t, make_halo
   use xmpm_grid, only: grid_t, node_position
   use xmpm_sharing, only: sharing_t
   use xmpm_surface_index, only: nearest_t, nearest_on_surface
   use xmpm_level_sets, only: level_sets_at
   use xmpm_crack, only: crack_t, rule_graded
   use xmpm_split, only: split_t, row_of_sides, sides_of_group
   implicit none
   private

   public :: contact_t, list_pairs

   !> Contact of bodies: what the deck says of each two groups, and the pairs of rows.
   type :: contact_t
      integer :: n_groups = 1                         !! numbered from 0
      real(wp), allocatable :: friction(:, :)         !! (0:,0:) coefficient between two groups
      real(wp), allocatable :: given_normal(:, :, :)  !! (3,0:,0:) from lower to higher group; 0: to
                                                      !! be found
      real(wp), allocatable :: spacing(:)             !! (bodies) of particles, 0 where not known
                                                      !! [length]
      integer, allocatable :: rigid(:)                !! (-1:) rigid body of the group, 0 for none
      real(wp), allocatable :: face_friction(:)       !! (cracks) between its faces, less than 0
                                                      !! where
                                                      !! these do not meet
      integer :: n = 0                                !! pairs of this rank
      integer, allocatable :: row(:, :)               !! (2,n) rows, lower group first
      integer, allocatable :: group(:, :)             !! (2,n) their groups, -1 for faces of a crack
      integer, allocatable :: crack(:)                !! (n) crack whose minus and plus face they
                                                      !! are, 0
                                                      !! for bodies
      real(wp), allocatable :: mu(:)                  !! (n) coefficient of friction
      integer, allocatable :: first(:)                !! (rows) first pair of the row's node
      integer, allocatable :: many(:)                 !! (rows) pairs of the node, 0 for most
      real(wp), allocatable :: place(:, :)            !! (3,n) of the node [length]
      real(wp), allocatable :: normal(:, :)           !! (3,n) from the first to the second
      real(wp), allocatable :: gap(:)                 !! (n) along it [length]
      real(wp), allocatable :: reach(:)               !! (n) speed of approach that does not yet
                                                      !! close the gap in this step [length/time]
      real(wp), allocatable :: impulse(:, :)          !! (3,n) on the second in this step [momentum]
      real(wp), allocatable :: again(:, :)            !! (3,n) likewise in the velocity that strains
                                                      !! [momentum]
      real(wp), allocatable :: pull(:, :, :)          !! (3,2,n) acceleration of both rows by stress
                                                      !! and loads [length/time^2]
      real(wp) :: owed = 0                            !! part of `lost` that the next step finds
                                                      !! again [energy]
      logical, allocatable :: held(:, :, :)           !! (3,2,n) components that are prescribed
      real(wp), allocatable :: prescribed(:, :, :)    !! (3,2,n) their velocity [length/time]
      type(halo_t) :: halo                            !! pairs as other ranks have them too
      real(wp) :: lost = 0                            !! energy lost so far, this rank [energy]
   end type contact_t

contains

   !> List the pairs of all nodes that several groups reach.
   subroutine list_pairs(contact, cracks, split, grid, sharing, rank)
      type(contact_t), intent(inout) :: contact   !! groups are given
      type(crack_t), intent(in) :: cracks(:)
      type(split_t), intent(in) :: split
      type(grid_t), intent(in) :: grid            !! with the rows of split nodes
      type(sharing_t), intent(in) :: sharing      !! shared rows of ordinary nodes
      integer, intent(in) :: rank
      integer :: s, n

      n = 0
      do s = 1, split%n
         n = n + pairs_at(contact, split, s)
      end do
      call make_room(contact, n, grid%n_rows)
      do s = 1, split%n
         call add_node(contact, cracks, split, grid, s)
      end do
      call share_pairs(contact, split, sharing, rank)
   end subroutine list_pairs

   !> Pairs that a node may have.
   pure function pairs_at(contact, split, s) result(n)
      type(contact_t), intent(in) :: contact
      type(split_t), intent(in) :: split
      integer, intent(in) :: s
      integer :: n, groups, sets, k

      groups = 1
      if (size(split%groups) > 0) groups = popcnt(split%groups(split%row(s)))
      sets = 2**count(split%crack(:split%n_cracks(s), s) > 0)
      n = sets**2*groups*(groups - 1)/2 + 2**(split%n_cracks(s) - 1) &
         *count([(meets_itself(contact, split%crack(k, s)), k=1, split%n_cracks(s))])
   end function pairs_at

   !> Whether the faces of a crack meet each other; not so for a contact group.
   pure function meets_itself(contact, crack) result(meets)
      type(contact_t), intent(in) :: contact
      integer, intent(in) :: crack
      logical :: meets

      meets = .false.
      if (crack > 0) meets = contact%face_friction(crack) >= 0
   end function meets_itself

   subroutine make_room(contact, n, n_rows)
      type(contact_t), intent(inout) :: contact
      integer, intent(in) :: n, n_rows

      if (allocated(contact%row)) then
         deallocate (contact%crack, contact%mu, contact%row, contact%group, contact%first, &
            contact%many, contact%place, &
            contact%normal, contact%gap, contact%reach, contact%impulse, contact%again, &
            contact%pull, contact%held, contact%prescribed)
      end if
      contact%lost = contact%lost + contact%owed   ! the pairs that it belongs to are gone
      contact%owed = 0
      contact%n = 0
      allocate (contact%crack(n), contact%mu(n), contact%row(2, n), contact%group(2, n), &
         contact%normal(3, n))
      allocate (contact%gap(n), contact%place(3, n))
      allocate (contact%reach(n), contact%impulse(3, n), contact%again(3, n), &
         contact%pull(3, 2, n), source=0.0_wp)
      allocate (contact%held(3, 2, n), contact%prescribed(3, 2, n))
      allocate (contact%first(n_rows), contact%many(n_rows), source=0)
   end subroutine make_room

   !> Add the pairs of a node: every row of a group with every row of each higher group.
   subroutine add_node(contact, cracks, split, grid, s)
      type(contact_t), intent(inout) :: contact
      type(crack_t), intent(in) :: cracks(:)
      type(split_t), intent(in) :: split
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: s
      integer, allocatable :: low(:), high(:)
      integer :: g, h, i, j, bits, before

      bits = 0
      if (size(split%groups) > 0) bits = split%groups(split%row(s))
      before = contact%n
      do g = 0, contact%n_groups - 2
         if (.not. btest(bits, g)) cycle
         low = sides_of_group(split, s, g)
         do h = g + 1, contact%n_groups - 1
            if (.not. btest(bits, h)) cycle
            high = sides_of_group(split, s, h)
            do i = 1, size(low)
               do j = 1, size(high)
                  contact%n = contact%n + 1
                  contact%row(1, contact%n) = row_of_sides(split, s, low(i))
                  contact%row(2, contact%n) = row_of_sides(split, s, high(j))
                  contact%group(:, contact%n) = [g, h]
                  contact%crack(contact%n) = 0
                  contact%mu(contact%n) = contact%friction(g, h)
               end do
            end do
         end do
      end do
      do i = 1, split%n_cracks(s)
         if (meets_itself(contact, split%crack(i, s))) call add_faces(contact, cracks, split, &
            grid, s, i)
      end do
      do i = before + 1, contact%n
         contact%first(contact%row(:, i)) = before + 1
         contact%many(contact%row(:, i)) = contact%n - before
         contact%place(:, i) = node_position(grid, split%row(s))
      end do
   end subroutine add_node

   !> Add the pairs of a node for the faces of one of its cracks, with the normal of the surface.
   !> A node ahead of the ramp, which particles in it split, has no faces.
   subroutine add_faces(contact, cracks, split, grid, s, i)
      type(contact_t), intent(inout) :: contact
      type(crack_t), intent(in) :: cracks(:)
      type(split_t), intent(in) :: split
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: s, i   !! split node, number of the crack at the node
      type(nearest_t) :: nearest
      real(wp) :: x(3), reach
      integer :: sides, k

      k = split%crack(i, s)
      x = node_position(grid, split%row(s))
      reach = 8*grid%lattice%size
      associate (crack => cracks(k))
         call nearest_on_surface(crack%index, crack%surface, x, reach, nearest, 0)
         if (nearest%triangle == 0) return
         if (is_ahead(crack, x, nearest, reach, grid%lattice%size)) return
         do sides = 0, 2**split%n_cracks(s) - 1
            if (btest(sides, i - 1)) cycle
            contact%n = contact%n + 1
            contact%row(1, contact%n) = row_of_sides(split, s, sides)
            contact%row(2, contact%n) = row_of_sides(split, s, ibset(sides, i - 1))
            contact%group(:, contact%n) = -1
            contact%crack(contact%n) = k
            contact%mu(contact%n) = contact%face_friction(k)
            contact%normal(:, contact%n) = crack%surface%normal(:, nearest%triangle)
         end do
      end associate
   end subroutine add_faces

   !> Whether a point is ahead of the ramp of a crack that does not grow (one that grows takes the
   !> nodes in between two listings).
   pure function is_ahead(crack, x, nearest, reach, h) result(ahead)
      type(crack_t), intent(in) :: crack
      real(wp), intent(in) :: x(3)               !! [length]
      type(nearest_t), intent(in) :: nearest     !! of the surface to x
      real(wp), intent(in) :: reach              !! [length]
      real(wp), intent(in) :: h                  !! cell size [length]
      logical :: ahead
      real(wp) :: psi, phi, e1(3)

      ahead = .false.
      if (crack%rule /= rule_graded .or. allocated(crack%offset)) return
      call level_sets_at(crack%surface, crack%front, reach, x, nearest, psi, phi, e1)
      ahead = phi >= crack%ramp_end*h
   end function is_ahead

   !> The halo of the pairs: nodes in the order of the shared rows, pairs as they were added.
   subroutine share_pairs(contact, split, sharing, rank)
      type(contact_t), intent(inout) :: contact
      type(split_t), intent(in) :: split
      type(sharing_t), intent(in) :: sharing
      integer, intent(in) :: rank
      integer :: i, j, k, n, s, row
      integer, allocatable :: first(:), pairs(:)

      allocate (first(size(sharing%first)), pairs(size(sharing%rows) + 64))
      n = 0
      do k = 1, size(sharing%ranks)
         first(k) = n + 1
         do i = sharing%first(k), sharing%first(k + 1) - 1
            s = split%of(sharing%rows(i))
            if (s == 0) cycle
            row = first_row(contact, split, s)
            if (row == 0) cycle
            do j = 0, contact%many(row) - 1
               n = n + 1
               if (n > size(pairs)) pairs = [pairs, pairs]
               pairs(n) = contact%first(row) + j
            end do
         end do
      end do
      first(size(sharing%first)) = n + 1
      call make_halo(contact%halo, rank, sharing%ranks, first, pairs(:n), contact%n)
   end subroutine share_pairs

   !> A row of a split node that has pairs, 0 for none.
   pure function first_row(contact, split, s) result(row)
      type(contact_t), intent(in) :: contact
      type(split_t), intent(in) :: split
      integer, intent(in) :: s
      integer :: row, k

      do k = 0, 2**split%n_cracks(s) - 1
         row = row_of_sides(split, s, k)
         if (contact%many(row) > 0) return
      end do
      row = 0
   end function first_row
end module xmpm_contact_pairs
