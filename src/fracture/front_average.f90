!> Values of front nodes, averaged over each node and its neighbours.
!>
!> K of a node is found over two cells of front to each side. What still changes from one node to
!> the next is not in the fields but made by their places between the particles: a node ahead of its
!> neighbour reads about 0.1 of that way [cells] too high, relatively, and a slow front multiplies
!> this by K/(v dK/dv), five to ten. The front of a slab of one cell would tilt so, by a factor
!> of e a cell from rounding on.
module xmpm_front_average
   use xmpm_kinds, only: wp
   use xmpm_front, only: front_t
   implicit none
   private

   public :: average_along

contains

   !> Let each known node go half of the way to the straight line between its neighbours: what
   !> changes sign from node to node goes out, what is linear along the front stays. Where only one
   !> neighbour is known it stands for both, as at a plane of symmetry.
   pure function average_along(front, known, values) result(averaged)
      type(front_t), intent(in) :: front
      logical, intent(in) :: known(:)          !! (nn) nodes that have values
      real(wp), intent(in) :: values(:, :)     !! (m,nn)
      real(wp) :: averaged(size(values, 1), size(values, 2))
      real(wp) :: weight, total, line(size(values, 1))
      integer :: i, side, e, other

      averaged = values
      do i = 1, front%node_count
         if (.not. known(i)) cycle
         total = 0
         line = 0
         do side = 1, 2
            e = front%node_edge(side, i)
            if (e == 0) cycle
            other = front%edge_node(side, e)
            if (.not. known(other)) cycle
            weight = 1/max(norm2(front%x(:, other) - front%x(:, i)), tiny(1.0_wp))
            total = total + weight
            line = line + weight*values(:, other)
         end do
         if (total > 0) averaged(:, i) = 0.5_wp*(values(:, i) + line/total)
      end do
   end function average_along
end module xmpm_front_average
