!> Crack fronts: the boundary edges of a surface that lie inside the material, in chains with
!> frames.
module xmpm_front
   use xmpm_kinds, only: wp
   use xmpm_surface, only: surface_t
   use xmpm_vectors, only: cross, unit_vector
   use xmpm_box_tree, only: box_tree_t, build_tree, refit_tree, box_distance2, tree_depth
   implicit none
   private

   public :: front_t, front_place_t
   public :: front_test_points, mark_front, refresh_front, shift_front, nearest_on_front, &
      nearest_of_group, frame_on_front, vertex_phi
   public :: fully_cracked, beyond_reach

   real(wp), parameter :: fully_cracked = -1.0e30_wp   !! phi where no front is near [length]
   real(wp), parameter :: beyond_reach = 1.0e30_wp     !! psi, phi of a point too far away [length]

   !> All fronts of one crack; nodes and edges follow each other along e3, chain after chain.
   type :: front_t
      integer :: node_count = 0                 !! nn
      integer :: edge_count = 0                 !! nf
      integer :: chain_count = 0                !! nc
      integer, allocatable :: vertex(:)         !! (nn) vertex of the surface at a node
      integer, allocatable :: node_edge(:, :)   !! (2,nn) edges that arrive and leave, 0 at an end
      integer, allocatable :: edge_node(:, :)   !! (2,nf) nodes where an edge starts and ends
      integer, allocatable :: surface_edge(:)   !! (nf) edge of the surface
      integer, allocatable :: chain_offset(:)   !! (nc+1) first node of each chain
      logical, allocatable :: closed(:)         !! (nc) whether the first node follows the last
      integer, allocatable :: edge_of(:)        !! (ne) front edge of an edge of the surface, or 0
      integer, allocatable :: node_of(:)        !! (nv) front node of a vertex of the surface, or 0
      real(wp), allocatable :: x(:, :)          !! (3,nn) positions [length]
      real(wp), allocatable :: s(:)             !! (nn) length along the chain [length]
      real(wp), allocatable :: length(:)        !! (nc) length of the chains [length]
      real(wp), allocatable :: e1(:, :)         !! (3,nn) ahead in the surface
      real(wp), allocatable :: e2(:, :)         !! (3,nn) normal of the surface
      real(wp), allocatable :: e3(:, :)         !! (3,nn) along the front, e1 x e2
      real(wp), allocatable :: edge_e1(:, :)    !! (3,nf) ahead in the triangle at an edge
      type(box_tree_t) :: tree                  !! boxes of the edges
   end type front_t

   !> The nearest point of a front.
   type :: front_place_t
      integer :: edge = 0                    !! front edge that holds it, 0 for none within reach
      integer :: node = 0                    !! front node where it is one, else 0
      real(wp) :: fraction = 0.0_wp          !! place on the edge, 0 to 1
      real(wp) :: distance = 0.0_wp          !! from the point asked for [length]
      real(wp) :: point(3) = 0.0_wp          !! the nearest point [length]
   end type front_place_t

contains

   !> Points just ahead of the boundary edges: where there is material at such a point, its edge
   !> is a front.
   subroutine front_test_points(surface, h, points)
      type(surface_t), intent(in) :: surface                !! mesh
      real(wp), intent(in) :: h                             !! cell size [length]
      real(wp), allocatable, intent(out) :: points(:, :)    !! (3,nb) of `surface%boundary` [length]
      integer :: i, e

      allocate (points(3, size(surface%boundary)))
      do i = 1, size(surface%boundary)
         e = surface%boundary(i)
         points(:, i) = 0.5_wp*sum(surface%x(:, surface%edge(:, e)), 2) &
            + 0.3_wp*h*ahead_of_edge(surface, e)
      end do
   end subroutine front_test_points

   !> Make the boundary edges that lie inside the material the fronts of a crack.
   subroutine mark_front(surface, inside, front)
      type(surface_t), intent(in) :: surface    !! mesh
      logical, intent(in) :: inside(:)          !! (nb) whether material is at each test point
      type(front_t), intent(out) :: front       !! chains of edges and their frames
      integer :: loop, nf

      nf = count(inside)
      allocate (front%vertex(2*nf), front%edge_node(2, nf), front%surface_edge(nf))
      allocate (front%node_edge(2, 2*nf), front%edge_of(surface%edge_count), &
         front%node_of(surface%vertex_count), source=0)
      allocate (front%chain_offset(nf + 1), front%closed(nf))
      front%chain_offset(1) = 1
      do loop = 1, size(surface%loop_offset) - 1
         call chain_loop(surface, inside, surface%loop_offset(loop), &
            surface%loop_offset(loop + 1) - 1, front)
      end do
      front%vertex = front%vertex(:front%node_count)
      front%node_edge = front%node_edge(:, :front%node_count)
      front%chain_offset = front%chain_offset(:front%chain_count + 1)
      front%closed = front%closed(:front%chain_count)
      allocate (front%x(3, front%node_count), front%s(front%node_count), &
         front%length(front%chain_count))
      allocate (front%e1(3, front%node_count), front%e2(3, front%node_count), &
         front%e3(3, front%node_count))
      allocate (front%edge_e1(3, nf))
      call set_positions(surface, front)
      call build_tree(edge_boxes(surface%rounding, front), front%tree)
   end subroutine mark_front

   !> Renew positions, lengths and frames after the surface has moved; the front edges stay the
   !> same.
   subroutine refresh_front(surface, front)
      type(surface_t), intent(in) :: surface    !! mesh after `refresh_geometry`
      type(front_t), intent(inout) :: front     !! its fronts

      call set_positions(surface, front)
      call refit_tree(front%tree, edge_boxes(surface%rounding, front))
   end subroutine refresh_front

   !> Put the nodes ahead of the surface, to where the crack has come; frames stay as they are.
   subroutine shift_front(rounding, offset, front)
      real(wp), intent(in) :: rounding          !! of the surface [length]
      real(wp), intent(in) :: offset(:)         !! (nn) way ahead along e1 [length]
      type(front_t), intent(inout) :: front     !! positions and lengths are changed

      front%x = front%x + spread(offset, 1, 3)*front%e1
      call set_lengths(front)
      call refit_tree(front%tree, edge_boxes(rounding, front))
   end subroutine shift_front

   !> The nearest point of the fronts within reach.
   pure subroutine nearest_on_front(front, x, reach, place)
      type(front_t), intent(in) :: front             !! fronts of one crack
      real(wp), intent(in) :: x(3)                   !! point [length]
      real(wp), intent(in) :: reach                  !! largest distance of interest [length]
      type(front_place_t), intent(out) :: place      !! edge 0 where nothing is within reach
      integer :: waiting(tree_depth), count, node, child, i
      real(wp) :: best

      best = reach*reach
      count = 0
      if (front%edge_count > 0) then
         count = 1
         waiting(1) = 1
      end if
      do while (count > 0)
         node = waiting(count)
         count = count - 1
         if (box_distance2(front%tree%box(:, node), x) > best) cycle
         if (front%tree%second(node) == 0) then
            do i = front%tree%first(node), front%tree%last(node)
               call try_edge(front, front%tree%item(i), x, best, place)
            end do
         else
            child = front%tree%second(node)
            waiting(count + 1:count + 2) = [child, node + 1]
            if (box_distance2(front%tree%box(:, child), x) &
               < box_distance2(front%tree%box(:, node + 1), x)) then
               waiting(count + 1:count + 2) = [node + 1, child]
            end if
            count = count + 2
         end if
      end do
      if (place%edge > 0) call finish_place(front, best, place)
   end subroutine nearest_on_front

   !> Distance, and the node where the place is one.
   pure subroutine finish_place(front, distance2, place)
      type(front_t), intent(in) :: front
      real(wp), intent(in) :: distance2              !! square of the distance [length^2]
      type(front_place_t), intent(inout) :: place

      place%distance = sqrt(distance2)
      if (place%fraction <= 0.0_wp) place%node = front%edge_node(1, place%edge)
      if (place%fraction >= 1.0_wp) place%node = front%edge_node(2, place%edge)
   end subroutine finish_place

   !> The nearest points of the fronts within reach of n points in a ball, whose middle is known to
   !> be a distance from the fronts: what `nearest_on_front` says of each, for all at once.
   pure subroutine nearest_of_group(front, n, x, middle, radius, distance, reach, places)
      type(front_t), intent(in) :: front               !! fronts of one crack
      integer, intent(in) :: n
      real(wp), intent(in) :: x(n, 3)                  !! points [length]
      real(wp), intent(in) :: middle(3), radius        !! the ball [length]
      real(wp), intent(in) :: distance                 !! of its middle [length]
      real(wp), intent(in) :: reach                    !! largest distance of interest [length]
      type(front_place_t), intent(out) :: places(n)    !! edge 0 where nothing is within reach
      real(wp) :: best(n), fraction(n)
      integer :: edge(n), near(front%edge_count), i, k, count

      best = reach*reach
      edge = 0
      fraction = 0
      call edges_within(front, middle, distance + 2*radius, near, count)
      do k = 1, count
         call try_edge_of_group(front, near(k), n, x, best, edge, fraction)
      end do
      do i = 1, n
         if (edge(i) == 0) cycle
         places(i)%edge = edge(i)
         places(i)%fraction = fraction(i)
         places(i)%point = place_on_edge(front, edge(i), fraction(i))
         call finish_place(front, best(i), places(i))
      end do
   end subroutine nearest_of_group

   !> Edges whose boxes are within reach of a point, in ascending order.
   pure subroutine edges_within(front, x, reach, near, count)
      type(front_t), intent(in) :: front
      real(wp), intent(in) :: x(3), reach         !! [length]
      integer, intent(inout) :: near(:)           !! filled up to count
      integer, intent(out) :: count
      integer :: waiting(tree_depth), waits, node, i

      count = 0
      waits = 0
      if (front%edge_count > 0) then
         waits = 1
         waiting(1) = 1
      end if
      do while (waits > 0)
         node = waiting(waits)
         waits = waits - 1
         if (box_distance2(front%tree%box(:, node), x) > reach*reach) cycle
         if (front%tree%second(node) == 0) then
            do i = front%tree%first(node), front%tree%last(node)
               call insert(front%tree%item(i), near, count)
            end do
         else
            waiting(waits + 1:waits + 2) = [front%tree%second(node), node + 1]
            waits = waits + 2
         end if
      end do
   end subroutine edges_within

   !> Insert a number into an ascending list.
   pure subroutine insert(item, list, count)
      integer, intent(in) :: item
      integer, intent(inout) :: list(:), count
      integer :: i

      i = count
      do while (i > 0)
         if (list(i) < item) exit
         list(i + 1) = list(i)
         i = i - 1
      end do
      list(i + 1) = item
      count = count + 1
   end subroutine insert

   !> Take an edge as the nearest of the points for which it is nearer than those before.
   pure subroutine try_edge_of_group(front, edge, n, x, best, nearest, fraction)
      type(front_t), intent(in) :: front
      integer, intent(in) :: edge, n
      real(wp), intent(in) :: x(n, 3)
      real(wp), intent(inout) :: best(n)         !! square of the distance [length^2]
      integer, intent(inout) :: nearest(n)
      real(wp), intent(inout) :: fraction(n)
      real(wp) :: a(3), b(3), t(3), f, per, d1, d2, d3, square
      logical :: past
      integer :: i

      a = front%x(:, front%edge_node(1, edge))
      b = front%x(:, front%edge_node(2, edge))
      t = b - a
      per = 1/dot_product(t, t)
      !$omp simd private(f, d1, d2, d3, square, past)
      do i = 1, n
         d1 = x(i, 1) - a(1)
         d2 = x(i, 2) - a(2)
         d3 = x(i, 3) - a(3)
         f = min(1.0_wp, max(0.0_wp, (d1*t(1) + d2*t(2) + d3*t(3))*per))
         ! from the node itself, so that both of its edges are at the same distance
         past = f >= 1.0_wp
         d1 = merge(x(i, 1) - b(1), d1 - f*t(1), past)
         d2 = merge(x(i, 2) - b(2), d2 - f*t(2), past)
         d3 = merge(x(i, 3) - b(3), d3 - f*t(3), past)
         square = d1*d1 + d2*d2 + d3*d3
         nearest(i) = merge(edge, nearest(i), square < best(i))
         fraction(i) = merge(f, fraction(i), square < best(i))
         best(i) = min(square, best(i))
      end do
   end subroutine try_edge_of_group

   !> Point of an edge at a fraction of its length.
   pure function place_on_edge(front, edge, fraction) result(point)
      type(front_t), intent(in) :: front
      integer, intent(in) :: edge
      real(wp), intent(in) :: fraction
      real(wp) :: point(3), a(3)

      a = front%x(:, front%edge_node(1, edge))
      point = front%x(:, front%edge_node(2, edge))
      if (fraction < 1.0_wp) point = a + fraction*(point - a)
   end function place_on_edge

   !> Take an edge as the nearest if it is; of edges at the same distance the lowest number.
   pure subroutine try_edge(front, edge, x, best, place)
      type(front_t), intent(in) :: front
      integer, intent(in) :: edge
      real(wp), intent(in) :: x(3)
      real(wp), intent(inout) :: best
      type(front_place_t), intent(inout) :: place
      real(wp) :: a(3), t(3), q(3), f, d2

      a = front%x(:, front%edge_node(1, edge))
      t = front%x(:, front%edge_node(2, edge)) - a
      f = min(1.0_wp, max(0.0_wp, dot_product(x - a, t)/dot_product(t, t)))
      q = place_on_edge(front, edge, f)
      d2 = sum((x - q)**2)
      if (d2 > best) return
      if (.not. d2 < best .and. place%edge > 0 .and. edge > place%edge) return
      best = d2
      place%edge = edge
      place%fraction = f
      place%point = q
   end subroutine try_edge

   !> Frame and length along the chain at a place of a front, between those of the two nodes.
   pure subroutine frame_on_front(front, place, frame, s)
      type(front_t), intent(in) :: front           !! fronts of one crack
      type(front_place_t), intent(in) :: place     !! of `nearest_on_front`, with an edge
      real(wp), intent(out) :: frame(3, 3)         !! columns e1, e2, e3
      real(wp), intent(out) :: s                   !! [length]
      real(wp) :: f

      f = place%fraction
      associate (a => front%edge_node(1, place%edge), b => front%edge_node(2, place%edge))
         frame(:, 2) = unit_vector((1.0_wp - f)*front%e2(:, a) + f*front%e2(:, b))
         frame(:, 3) = (1.0_wp - f)*front%e3(:, a) + f*front%e3(:, b)
         frame(:, 1) = unit_vector(cross(frame(:, 2), frame(:, 3)))
         frame(:, 3) = cross(frame(:, 1), frame(:, 2))
         s = front%s(a) + f*norm2(front%x(:, b) - front%x(:, a))
      end associate
   end subroutine frame_on_front

   !> Minus the distance of each vertex of the surface to the nearest front edge; `fully_cracked`
   !> without a front.
   pure subroutine vertex_phi(surface, front, phi)
      type(surface_t), intent(in) :: surface   !! mesh
      type(front_t), intent(in) :: front       !! its fronts
      real(wp), intent(out) :: phi(:)          !! (nv) [length]
      type(front_place_t) :: place
      integer :: v

      do v = 1, surface%vertex_count
         phi(v) = fully_cracked
         if (front%node_of(v) > 0) then
            phi(v) = 0.0_wp
         else if (front%edge_count > 0) then
            call nearest_on_front(front, surface%x(:, v), beyond_reach, place)
            phi(v) = -place%distance
         end if
      end do
   end subroutine vertex_phi

   !> Unit vector in the triangle of a boundary edge, normal to the edge, out of the surface.
   pure function ahead_of_edge(surface, e) result(e1)
      type(surface_t), intent(in) :: surface
      integer, intent(in) :: e
      real(wp) :: e1(3)

      e1 = unit_vector(cross(surface%x(:, surface%edge(2, e)) - surface%x(:, surface%edge(1, e)), &
         surface%normal(:, surface%edge_triangle(1, e))))
   end function ahead_of_edge

   !> Find the chains of one boundary loop (places first to last of `surface%boundary`).
   !>
   !> s runs along e3 = e1 x e2, against the loop, which has the surface on its left.
   subroutine chain_loop(surface, inside, first, last, front)
      type(surface_t), intent(in) :: surface
      logical, intent(in) :: inside(:)
      integer, intent(in) :: first, last
      type(front_t), intent(inout) :: front
      integer :: step, n, place, gap
      logical :: starts

      n = last - first + 1
      gap = 0
      do place = first, last
         if (.not. inside(place)) gap = place - first + 1
      end do
      starts = .true.
      do step = 1, n
         place = first + modulo(max(gap, 1) - 1 - step, n)
         if (inside(place)) then
            call add_edge(surface, surface%boundary(place), starts, front)
         else if (.not. starts) then
            call end_chain(front, surface, .false.)
         end if
         starts = .not. inside(place)
      end do
      if (gap == 0) call end_chain(front, surface, .true.)
   end subroutine chain_loop

   !> Append an edge, and the node where it starts, to the chain that is being made.
   subroutine add_edge(surface, e, starts, front)
      type(surface_t), intent(in) :: surface
      integer, intent(in) :: e
      logical, intent(in) :: starts
      type(front_t), intent(inout) :: front
      integer :: k

      k = front%edge_count + 1
      front%edge_count = k
      front%surface_edge(k) = e
      front%edge_of(e) = k
      front%node_count = front%node_count + 1
      front%vertex(front%node_count) = surface%edge(2, e)
      front%node_of(surface%edge(2, e)) = front%node_count
      front%edge_node(1, k) = front%node_count
      front%edge_node(2, k) = front%node_count + 1
      front%node_edge(2, front%node_count) = k
      if (.not. starts) front%node_edge(1, front%node_count) = k - 1
   end subroutine add_edge

   !> Close the chain that is being made, or give it its last node.
   subroutine end_chain(front, surface, closed)
      type(front_t), intent(inout) :: front
      type(surface_t), intent(in) :: surface
      logical, intent(in) :: closed
      integer :: k, v, start

      k = front%edge_count
      start = front%chain_offset(front%chain_count + 1)
      if (closed) then
         front%edge_node(2, k) = start
         front%node_edge(1, start) = k
      else
         v = surface%edge(1, front%surface_edge(k))
         front%node_count = front%node_count + 1
         front%vertex(front%node_count) = v
         front%node_of(v) = front%node_count
         front%node_edge(1, front%node_count) = k
      end if
      front%chain_count = front%chain_count + 1
      front%closed(front%chain_count) = closed
      front%chain_offset(front%chain_count + 1) = front%node_count + 1
   end subroutine end_chain

   !> Positions, lengths and frames from the surface.
   subroutine set_positions(surface, front)
      type(surface_t), intent(in) :: surface
      type(front_t), intent(inout) :: front
      integer :: i, k

      front%x = surface%x(:, front%vertex)
      do k = 1, front%edge_count
         front%edge_e1(:, k) = ahead_of_edge(surface, front%surface_edge(k))
      end do
      do i = 1, front%node_count
         front%e2(:, i) = surface%vertex_normal(:, front%vertex(i))
         front%e1(:, i) = unit_vector(cross(front%e2(:, i), tangent_at(front, i)))
         front%e3(:, i) = cross(front%e1(:, i), front%e2(:, i))
      end do
      call set_lengths(front)
   end subroutine set_positions

   !> Lengths along the chains.
   subroutine set_lengths(front)
      type(front_t), intent(inout) :: front
      integer :: c, i, k
      real(wp) :: s

      do c = 1, front%chain_count
         s = 0.0_wp
         do i = front%chain_offset(c), front%chain_offset(c + 1) - 1
            front%s(i) = s
            k = front%node_edge(2, i)
            if (k > 0) s = s + norm2(edge_vector(front, k))
         end do
         front%length(c) = s
      end do
   end subroutine set_lengths

   pure function edge_vector(front, k) result(t)
      type(front_t), intent(in) :: front
      integer, intent(in) :: k
      real(wp) :: t(3)

      t = front%x(:, front%edge_node(2, k)) - front%x(:, front%edge_node(1, k))
   end function edge_vector

   !> Direction of a front at a node: that of the parabola through it and its neighbours.
   !>
   !> At an open end the parabola through the last three nodes, unless the front turns by more
   !> than 30 degrees there.
   pure function tangent_at(front, i) result(t)
      type(front_t), intent(in) :: front
      integer, intent(in) :: i
      real(wp) :: t(3), t1(3), t2(3), l1, l2
      integer :: k, next
      real(wp), parameter :: smooth = 0.866_wp

      if (all(front%node_edge(:, i) > 0)) then
         t1 = edge_vector(front, front%node_edge(1, i))
         t2 = edge_vector(front, front%node_edge(2, i))
         l1 = norm2(t1)
         l2 = norm2(t2)
         t = (t1*l2/l1 + t2*l1/l2)/(l1 + l2)
         return
      end if
      k = maxval(front%node_edge(:, i))
      t1 = edge_vector(front, k)
      t = t1
      if (front%node_edge(1, i) == 0) then
         next = front%node_edge(2, front%edge_node(2, k))
      else
         next = front%node_edge(1, front%edge_node(1, k))
      end if
      if (next == 0) return
      t2 = edge_vector(front, next)
      l1 = norm2(t1)
      l2 = norm2(t2)
      if (dot_product(t1, t2) > smooth*l1*l2) t = t1/l1 + (t1/l1 - t2/l2)*l1/(l1 + l2)
   end function tangent_at

   pure function edge_boxes(margin, front) result(box)
      real(wp), intent(in) :: margin
      type(front_t), intent(in) :: front
      real(wp) :: box(6, front%edge_count)
      integer :: k

      do k = 1, front%edge_count
         associate (a => front%x(:, front%edge_node(1, k)), b => front%x(:, front%edge_node(2, k)))
            box(1:3, k) = min(a, b) - margin
            box(4:6, k) = max(a, b) + margin
         end associate
      end do
   end function edge_boxes
end module xmpm_front
