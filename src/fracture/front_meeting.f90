!> Fronts of one crack that come near each other: which nodes wait for the other front, and which
!> fronts are ready to be joined.
module xmpm_front_meeting
   use xmpm_kinds, only: wp
   use xmpm_front, only: front_t
   use xmpm_front_line, only: front_limits_t
   use xmpm_material_test, only: material_test_t
   implicit none
   private

   public :: find_meetings, ready_to_join, ready_to_close, chain_of, facing

   real(wp), parameter :: facing = 0.3_wp    !! largest product of the directions ahead of two
                                             !! fronts that meet: each may lean by 53 degrees
   real(wp), parameter :: beside = -0.5_wp   !! the same of the direction ahead and that to the
                                             !! other front: fronts beside each other may have
                                             !! passed by a little

contains

   !> The chain that each node meets: near, ahead, and coming the other way; 0 for none.
   pure subroutine find_meetings(front, reach, partner)
      type(front_t), intent(in) :: front              !! all fronts of the crack
      real(wp), intent(in) :: reach                   !! distance from which they meet [length]
      integer, intent(out) :: partner(:)              !! (nn) chain
      real(wp) :: gap(3), best, d
      integer :: i, j, k, c
      integer :: chain(front%node_count)

      chain = chain_of(front)
      partner = 0
      if (front%chain_count < 2) return
      do i = 1, front%node_count
         best = huge(1.0_wp)
         do k = 1, front%edge_count
            j = front%edge_node(1, k)
            c = chain(j)
            if (c == chain(i)) cycle
            gap = nearest_in_edge(front, k, front%x(:, i)) - front%x(:, i)
            d = norm2(gap)
            if (d > reach) cycle
            if (dot_product(front%e1(:, i), front%e1(:, j)) > facing) cycle
            if (dot_product(gap, front%e1(:, i)) <= beside*d .or. .not. d < best) cycle
            best = d
            partner(i) = c
         end do
      end do
   end subroutine find_meetings

   !> Chain of each node.
   pure function chain_of(front) result(chain)
      type(front_t), intent(in) :: front       !! fronts of one crack
      integer :: chain(front%node_count), c

      do c = 1, front%chain_count
         chain(front%chain_offset(c):front%chain_offset(c + 1) - 1) = c
      end do
   end function chain_of

   pure function nearest_in_edge(front, k, x) result(p)
      type(front_t), intent(in) :: front
      integer, intent(in) :: k
      real(wp), intent(in) :: x(3)
      real(wp) :: p(3), t(3), f

      associate (a => front%x(:, front%edge_node(1, k)), b => front%x(:, front%edge_node(2, k)))
         t = b - a
         f = max(0.0_wp, min(1.0_wp, dot_product(x - a, t)/dot_product(t, t)))
         p = a + f*t
      end associate
   end function nearest_in_edge

   !> The chain that a chain has met with some node, if all nodes of both that lie in the material
   !> are near the other; 0 for none. Both must be open or both closed, with their normals alike.
   pure function ready_to_join(front, chain, partner, near, material) result(other)
      type(front_t), intent(in) :: front             !! fronts of one crack
      integer, intent(in) :: chain
      integer, intent(in) :: partner(:)              !! (nn) of find_meetings
      integer, intent(in) :: near(:)                 !! (nn) the same over a longer distance
      class(material_test_t), intent(in) :: material
      integer :: other

      associate (first => front%chain_offset(chain), last => front%chain_offset(chain + 1) - 1)
         other = maxval(partner(first:last))
         ! The meeting of two may have been noticed by the other one only.
         if (other == 0) other = maxval(chain_of(front), mask=partner == chain)
      end associate
      other = max(other, 0)
      if (other == 0) return
      if (wholly_met(front, chain, other, near, material) .and. &
          wholly_met(front, other, chain, near, material) .and. &
          (front%closed(chain) .eqv. front%closed(other))) then
         if (dot_product(front%e2(:, front%chain_offset(chain)), &
             front%e2(:, front%chain_offset(other))) > 0.0_wp) return
      end if
      other = 0
   end function ready_to_join

   pure function wholly_met(front, chain, other, partner, material) result(is)
      type(front_t), intent(in) :: front
      integer, intent(in) :: chain, other, partner(:)
      class(material_test_t), intent(in) :: material
      logical :: is
      integer :: i, met

      met = 0
      is = .false.
      do i = front%chain_offset(chain), front%chain_offset(chain + 1) - 1
         if (partner(i) == other) then
            met = met + 1
         else if (material%inside(front%x(:, i))) then
            return
         end if
      end do
      is = met > 0
   end function wholly_met

   !> Whether a closed chain has shrunk around a small rest of material that may be cut at once.
   pure function ready_to_close(front, chain, limits) result(ready)
      type(front_t), intent(in) :: front             !! fronts of one crack
      integer, intent(in) :: chain
      type(front_limits_t), intent(in) :: limits
      logical :: ready
      real(wp) :: centre(3)
      integer :: i, first, last

      first = front%chain_offset(chain)
      last = front%chain_offset(chain + 1) - 1
      ready = front%closed(chain) .and. front%length(chain) < 4.0_wp*limits%longest
      centre = sum(front%x(:, first:last), 2)/real(last - first + 1, wp)
      do i = first, last
         ready = ready .and. dot_product(centre - front%x(:, i), front%e1(:, i)) > 0.0_wp
      end do
   end function ready_to_close
end module xmpm_front_meeting
