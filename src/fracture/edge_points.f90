!> Which points of a front the particles near each of its edges can count for.
module xmpm_edge_points
   use xmpm_kinds, only: wp
   use xmpm_front, only: front_t
   use xmpm_front_points, only: front_points_t
   implicit none
   private

   public :: edge_points_t, list_edge_points

   !> The points of one edge.
   type :: edge_points_t
      integer, allocatable :: point(:)
   end type edge_points_t

contains

   !> Points within reach of each edge of the front, along the front to both sides.
   pure subroutine list_edge_points(front, points, reach, near)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      real(wp), intent(in) :: reach                               !! [length]
      type(edge_points_t), allocatable, intent(out) :: near(:)    !! (edges)
      integer :: list(points%n), n, edge

      allocate (near(front%edge_count))
      do edge = 1, front%edge_count
         n = 0
         call walk(front, points, edge, 2, reach, list, n)
         call walk(front, points, edge, 1, reach, list, n)
         near(edge)%point = list(:n)
      end do
   end subroutine list_edge_points

   !> Append the points to one side of an edge, up to the first that is out of reach or there.
   pure subroutine walk(front, points, edge, way, reach, list, n)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: edge
      integer, intent(in) :: way             !! 1 against the front, 2 along it
      real(wp), intent(in) :: reach          !! [length]
      integer, intent(inout) :: list(:), n   !! filled up to n
      integer :: node, next

      next = edge
      do while (next > 0)
         node = front%edge_node(way, next)
         if (distance2(front, edge, points%x(:, node)) > reach*reach) return
         if (any(list(:n) == node)) return
         n = n + 1
         list(n) = node
         next = front%node_edge(way, node)
      end do
   end subroutine walk

   !> Square of the distance of a place from an edge.
   pure function distance2(front, edge, x)
      type(front_t), intent(in) :: front
      integer, intent(in) :: edge
      real(wp), intent(in) :: x(3)   !! [length]
      real(wp) :: distance2          !! [length^2]
      real(wp) :: a(3), t(3), d(3)

      a = front%x(:, front%edge_node(1, edge))
      t = front%x(:, front%edge_node(2, edge)) - a
      d = x - a
      d = d - min(1.0_wp, max(0.0_wp, dot_product(d, t)/dot_product(t, t)))*t
      distance2 = dot_product(d, d)
   end function distance2
end module xmpm_edge_points
