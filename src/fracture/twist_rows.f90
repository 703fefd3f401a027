!> What the twist of a criterion makes of a front: its new row turns about the direction of growth.
!>
!> A twist psi turns the new face about the kinked direction e1', and so the row from e3 to
!> cos(psi) e3 - sin(psi) e2'. A continuous surface cannot do so at every node by itself: the row
!> rises by dw/ds = -tan(psi) along it, about its middle. It does not turn further at once than the
!> way allows: no node leaves its kinked direction by more than the largest psi. The rest follows
!> with the next increments, for as long as the criterion finds a twist.
module xmpm_twist_rows
   use xmpm_kinds, only: wp
   use xmpm_front, only: front_t
   implicit none
   private

   public :: rise_of_rows

contains

   !> Rise of each node along e2' by the twist.
   pure function rise_of_rows(front, way, twist, outside) result(rise)
      type(front_t), intent(in) :: front      !! fronts of one crack
      real(wp), intent(in) :: way(:)          !! (nn) of the nodes in this increment [length]
      real(wp), intent(in) :: twist(:)        !! (nn) of the criterion [rad]
      logical, intent(in) :: outside(:)       !! (nn) nodes without material around
      real(wp) :: rise(size(way))             !! [length]
      real(wp) :: weight(size(way)), largest, allowed, shrink
      integer :: c, first, last

      rise = 0
      if (.not. any(abs(twist) > 0)) return
      weight = weights(front, outside)
      do c = 1, front%chain_count
         first = front%chain_offset(c)
         last = front%chain_offset(c + 1) - 1
         if (.not. any(weight(first:last) > 0)) cycle
         call climb(front, twist, first, last, front%closed(c), rise)
         rise(first:last) = rise(first:last) - sum(weight(first:last)*rise(first:last)) &
            /sum(weight(first:last))
         largest = maxval(abs(rise(first:last)), mask=weight(first:last) > 0)
         allowed = maxval(way(first:last))*tan(maxval(abs(twist(first:last))))
         shrink = 1
         if (largest > allowed) shrink = allowed/largest
         ! A node that does not go does not rise.
         rise(first:last) = shrink*rise(first:last)*way(first:last) &
            /max(maxval(way(first:last)), tiny(1.0_wp))
      end do
   end function rise_of_rows

   !> Half the length of the segments at each node inside.
   pure function weights(front, outside) result(weight)
      type(front_t), intent(in) :: front
      logical, intent(in) :: outside(:)
      real(wp) :: weight(size(outside))
      integer :: k

      weight = 0
      do k = 1, front%edge_count
         associate (node => front%edge_node(:, k))
            weight(node) = weight(node) + 0.5_wp*norm2(front%x(:, node(2)) - front%x(:, node(1)))
         end associate
      end do
      where (outside) weight = 0
   end function weights

   !> Integrate the slope along a chain; around a closed one what is left over is taken out.
   pure subroutine climb(front, twist, first, last, closed, rise)
      type(front_t), intent(in) :: front
      real(wp), intent(in) :: twist(:)
      integer, intent(in) :: first, last
      logical, intent(in) :: closed
      real(wp), intent(inout) :: rise(:)
      real(wp) :: step
      integer :: i

      rise(first) = 0
      do i = first + 1, last
         step = norm2(front%x(:, i) - front%x(:, i - 1))
         rise(i) = rise(i - 1) - 0.5_wp*step*(tan(twist(i - 1)) + tan(twist(i)))
      end do
      if (.not. closed) return
      step = norm2(front%x(:, first) - front%x(:, last))
      step = rise(last) - 0.5_wp*step*(tan(twist(last)) + tan(twist(first)))
      rise(first:last) = rise(first:last) - step*front%s(first:last) &
         /(front%s(last) + norm2(front%x(:, first) - front%x(:, last)))
   end subroutine climb
end module xmpm_twist_rows
