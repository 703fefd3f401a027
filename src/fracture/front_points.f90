!> The points of a crack's fronts where fracture parameters are found: their frames, how far their
!> material has turned, and the length of front that a window about each of them holds.
module xmpm_front_points
   use xmpm_kinds, only: wp, pi
   use xmpm_surface, only: refresh_geometry
   use xmpm_front, only: front_t, refresh_front
   use xmpm_crack, only: crack_t
   use xmpm_vectors, only: unit_vector
   use xmpm_cosine_fall, only: cosine_fall
   implicit none
   private

   public :: front_points_t, list_points, end_points, window_at, window_length, direction_at
   public :: same_part

   real(wp), parameter :: straight = 0.9994_wp  !! cosine (2 degrees) from which on a front counts
                                                !! as normal to the surface where it ends
   real(wp), parameter :: turned = 0.17_wp   !! cosine (80 degrees) from which on a part of a front
                                             !! is another one

   !> All points of the fronts of one crack, chain after chain along e3.
   type :: front_points_t
      integer :: n = 0                          !! points
      integer, allocatable :: node(:)           !! (n) node of the front
      integer, allocatable :: chain(:)          !! (n) front of the crack
      real(wp), allocatable :: x(:, :)          !! (3,n) places [length]
      real(wp), allocatable :: s(:)             !! (n) length along the front [length]
      real(wp), allocatable :: frame(:, :, :)   !! (3,3,n) columns e1 ahead, e2 normal, e3 along
      real(wp), allocatable :: turn(:, :, :)    !! (3,3,n) rotation of the material since the start
      logical, allocatable :: at_end(:)         !! (n) last point of an open front
      real(wp), allocatable :: bend(:)          !! (n) radius of curvature [length]
      real(wp), allocatable :: stop(:, :)       !! (3,n) nearest end of an open front [length]
      real(wp), allocatable :: outward(:, :)    !! (3,n) normal of the plane in which it ends, in
                                                !! the point's frame; 0 where no end is
      real(wp), allocatable :: beyond(:, :)     !! (2,chains) how far the material goes on past the
                                                !! first and last node, negative where it ends
                                                !! before them [length]
      real(wp), allocatable :: wall(:, :, :)    !! (3,2,chains) outward normal of the material where
                                                !! the front ends; 0 for that of the front itself
   end type front_points_t

contains

   !> The nodes of all fronts, as the surface is now.
   subroutine list_points(crack, points)
      type(crack_t), intent(in) :: crack              !! gathered
      type(front_points_t), intent(out) :: points     !! ends still as the mesh has them
      integer :: c, i, first, last

      associate (f => crack%front)
         points%n = f%node_count
         points%node = [(i, i=1, f%node_count)]
         points%x = f%x
         points%s = f%s
         allocate (points%chain(points%n), points%at_end(points%n))
         allocate (points%frame(3, 3, points%n), points%turn(3, 3, points%n))
         allocate (points%bend(points%n))
         allocate (points%stop(3, points%n), points%outward(3, points%n), source=0.0_wp)
         allocate (points%beyond(2, f%chain_count), points%wall(3, 2, f%chain_count), &
            source=0.0_wp)
         points%frame(:, 1, :) = f%e1
         points%frame(:, 2, :) = f%e2
         points%frame(:, 3, :) = f%e3
         points%at_end = .false.
         do c = 1, f%chain_count
            first = f%chain_offset(c)
            last = f%chain_offset(c + 1) - 1
            points%chain(first:last) = c
            points%at_end([first, last]) = .not. f%closed(c)
         end do
      end associate
      call find_turns(crack, points)
      call find_bends(crack%front, points)
   end subroutine list_points

   !> Radii of curvature from the neighbours of each point.
   pure subroutine find_bends(front, points)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(inout) :: points
      integer :: i, a, b

      do i = 1, points%n
         a = i
         b = i
         if (front%node_edge(1, i) > 0) a = front%edge_node(1, front%node_edge(1, i))
         if (front%node_edge(2, i) > 0) b = front%edge_node(2, front%node_edge(2, i))
         points%bend(i) = norm2(front%x(:, b) - front%x(:, a)) &
            /max(norm2(front%e1(:, b) - front%e1(:, a)), 1e-12_wp)
      end do
   end subroutine find_bends

   !> Rotation of each frame from where its vertices started.
   subroutine find_turns(crack, points)
      type(crack_t), intent(in) :: crack
      type(front_points_t), intent(inout) :: points
      type(crack_t) :: start
      real(wp) :: old(3, 3)
      integer :: i

      start%surface = crack%surface
      start%front = crack%front
      start%surface%up = 0
      start%surface%um = 0
      call refresh_geometry(start%surface)
      call refresh_front(start%surface, start%front)
      do i = 1, points%n
         old(:, 1) = start%front%e1(:, i)
         old(:, 2) = start%front%e2(:, i)
         old(:, 3) = start%front%e3(:, i)
         points%turn(:, :, i) = matmul(points%frame(:, :, i), transpose(old))
      end do
   end subroutine find_turns

   !> Put the last points of open fronts to where the material ends, if that is before them.
   pure subroutine end_points(front, points)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(inout) :: points   !! `beyond` is known
      integer :: c, first, last

      do c = 1, front%chain_count
         if (front%closed(c)) cycle
         first = front%chain_offset(c)
         last = front%chain_offset(c + 1) - 1
         call pull_back(front, points, first, first + 1, 1.0_wp, points%beyond(1, c))
         call pull_back(front, points, last, last - 1, -1.0_wp, points%beyond(2, c))
         call face_ends(points, c, first, last)
      end do
   end subroutine end_points

   !> Give each point of a chain its nearest end, and the plane of the material's surface there.
   pure subroutine face_ends(points, chain, first, last)
      type(front_points_t), intent(inout) :: points
      integer, intent(in) :: chain, first, last
      real(wp) :: n(3)
      integer :: i, end

      do i = first, last
         end = first
         if (norm2(points%x(:, last) - points%x(:, i)) &
             < norm2(points%x(:, first) - points%x(:, i))) end = last
         n = merge(1.0_wp, -1.0_wp, end == last)*points%frame(:, 3, end)
         associate (wall => points%wall(:, merge(2, 1, end == last), chain))
            ! A front normal to the surface ends in the plane of its own frame.
            if (dot_product(wall, n) < straight .and. norm2(wall) > 0.5_wp) n = wall
         end associate
         n = matmul(n, points%frame(:, :, i))
         n(2) = 0
         points%stop(:, i) = points%x(:, end)
         points%outward(:, i) = unit_vector(n)
      end do
   end subroutine face_ends

   !> Direction of q at n places in the frame of a point: e1, but tangent to the plane in which the
   !> front ends near it, fading over a depth.
   pure subroutine direction_at(n, points, i, d, depth, direction, fade)
      integer, intent(in) :: n
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: i                  !! point
      real(wp), intent(in) :: d(n, 3)           !! places from the point, in its frame [length]
      real(wp), intent(in) :: depth             !! [length]
      real(wp), intent(out) :: direction(n, 3)  !! e1 - eta (e1 . out) out
      real(wp), intent(out) :: fade(n)          !! -(e1 . out) d eta/d out, 0 beyond the depth
                                                !! [1/length]
      real(wp) :: out(3), eta, stop
      integer :: k

      direction(:, 1) = 1
      direction(:, 2:) = 0
      fade = 0
      out = points%outward(:, i)
      if (.not. abs(out(1)) > 1e-9_wp) return
      stop = dot_product(matmul(points%stop(:, i) - points%x(:, i), points%frame(:, :, i)), out)
      !$omp simd private(eta)
      do k = 1, n
         eta = max(1 - (stop - d(k, 1)*out(1) - d(k, 2)*out(2) - d(k, 3)*out(3))/depth, 0.0_wp)
         direction(k, 1) = 1 - eta*out(1)*out(1)
         direction(k, 2) = -eta*out(1)*out(2)
         direction(k, 3) = -eta*out(1)*out(3)
         fade(k) = merge(-out(1)/depth, 0.0_wp, eta > 0)
      end do
   end subroutine direction_at

   !> Whether an edge of the front belongs to the part that a point looks at.
   pure function same_part(front, points, i, edge) result(same)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: i, edge
      logical :: same

      same = points%frame(1, 1, i)*front%edge_e1(1, edge) &
         + points%frame(2, 1, i)*front%edge_e1(2, edge) &
         + points%frame(3, 1, i)*front%edge_e1(3, edge) > turned
   end function same_part

   pure subroutine pull_back(front, points, node, inner, way, beyond)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(inout) :: points
      integer, intent(in) :: node, inner   !! the end and its neighbour
      real(wp), intent(in) :: way          !! of the chain from the end: 1 or -1
      real(wp), intent(in) :: beyond       !! [length]
      real(wp) :: d(3)

      if (beyond >= 0) return
      d = front%x(:, inner) - front%x(:, node)
      points%x(:, node) = front%x(:, node) - beyond*unit_vector(d)
      points%s(node) = front%s(node) - way*beyond
   end subroutine pull_back

   !> The window l of a point at n places: 1 at the point, a cosine to 0 at the half-width along e3.
   pure subroutine window_at(n, xi, half_width, l, slope)
      integer, intent(in) :: n
      real(wp), intent(in) :: xi(n)        !! along e3 from the point [length]
      real(wp), intent(in) :: half_width   !! [length]
      real(wp), intent(out) :: l(n)        !! 0 to 1
      real(wp), intent(out) :: slope(n)    !! dl/dxi [1/length]

      call cosine_fall(n, abs(xi)/half_width, l, slope)
      slope = sign(slope, -xi)/half_width
   end subroutine window_at

   !> Integral of l e1 . n over the front in the material: what J of the window is divided by.
   pure function window_length(front, points, i, half_width, reach) result(length)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: i                 !! point
      real(wp), intent(in) :: half_width       !! of the window [length]
      real(wp), intent(in) :: reach            !! parts of the front further away do not count
                                               !! [length]
      real(wp) :: length                       !! [length]
      real(wp) :: a(3), b(3)
      integer :: k

      length = 0
      do k = 1, front%edge_count
         if (points%chain(front%edge_node(1, k)) /= points%chain(i)) cycle
         if (.not. same_part(front, points, i, k)) cycle
         call edge_in_material(front, points, k, a, b)
         if (norm2(0.5_wp*(a + b) - points%x(:, i)) > reach) cycle
         if (abs(points%outward(1, i)) > 1e-9_wp) then
            length = length + length_near_end(points, i, a, b, front%edge_e1(:, k), half_width)
         else
            length = length + dot_product(points%frame(:, 1, i), front%edge_e1(:, k)) &
               *edge_length(a, b, points%x(:, i), points%frame(:, 3, i), half_width)
         end if
      end do
   end function window_length

   !> Integral of l (direction . n) along an edge near the end of a front, by 16 midpoints.
   pure function length_near_end(points, i, a, b, ahead, half_width) result(length)
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: i                          !! point
      real(wp), intent(in) :: a(3), b(3), ahead(3)      !! the edge and the normal ahead of it
      real(wp), intent(in) :: half_width
      real(wp) :: length
      integer, parameter :: steps = 16
      real(wp) :: d(steps, 3), direction(steps, 3), fade(steps), l(steps), slope(steps)
      integer :: k

      do k = 1, steps
         d(k, :) = matmul(a + (real(k, wp) - 0.5_wp)/real(steps, wp)*(b - a) - points%x(:, i), &
            points%frame(:, :, i))
      end do
      call window_at(steps, d(:, 3), half_width, l, slope)
      call direction_at(steps, points, i, d, half_width, direction, fade)
      length = dot_product(l, matmul(direction, matmul(ahead, points%frame(:, :, i)))) &
         *norm2(b - a)/real(steps, wp)
   end function length_near_end

   !> Ends of an edge, moved to the end of the material where it is the last of an open front.
   pure subroutine edge_in_material(front, points, k, a, b)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: k
      real(wp), intent(out) :: a(3), b(3)
      real(wp) :: t(3)
      integer :: c

      associate (start => front%edge_node(1, k), end => front%edge_node(2, k))
         c = points%chain(start)
         a = front%x(:, start)
         b = front%x(:, end)
         t = unit_vector(b - a)
         if (front%node_edge(1, start) == 0) a = a - points%beyond(1, c)*t
         if (front%node_edge(2, end) == 0) b = b + points%beyond(2, c)*t
      end associate
   end subroutine edge_in_material

   !> Integral of the window along a straight edge from a to b.
   pure function edge_length(a, b, x, e3, half_width) result(length)
      real(wp), intent(in) :: a(3), b(3), x(3), e3(3), half_width
      real(wp) :: length, from, to, l(1), slope(1)

      from = dot_product(a - x, e3)
      to = dot_product(b - x, e3)
      if (abs(to - from) > 1e-6_wp*half_width) then
         length = norm2(b - a)/(to - from)*(antiderivative(to) - antiderivative(from))
      else
         call window_at(1, [0.5_wp*(from + to)], half_width, l, slope)
         length = norm2(b - a)*l(1)
      end if

   contains

      pure function antiderivative(xi) result(g)
         real(wp), intent(in) :: xi
         real(wp) :: g, z

         z = max(-half_width, min(half_width, xi))
         g = 0.5_wp*(z + half_width/pi*sin(pi*z/half_width))
      end function antiderivative
   end function edge_length
end module xmpm_front_points
