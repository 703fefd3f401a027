!> The line to which one chain of a front grows: its nodes are moved, split, merged and smoothed
!> before there are triangles.
module xmpm_front_line
   use xmpm_kinds, only: wp
   use xmpm_vectors, only: unit_vector
   use xmpm_front, only: front_t
   implicit none
   private

   public :: line_t, front_limits_t
   public :: limits_for, line_of_chain, merge_short, split_long, smooth_line, parent_of, insert_node

   real(wp), parameter :: tie = 1e-6_wp   !! lengths that differ by less, relatively, are equal: new
                                          !! nodes stand at distances that are bounds themselves

   !> Lengths that a front keeps to.
   type :: front_limits_t
      real(wp) :: cell = 1.0_wp       !! grid size h [length]
      real(wp) :: shortest = 0.5_wp   !! shorter segments are merged [length]
      real(wp) :: longest = 1.4_wp    !! longer segments are split [length]
      real(wp) :: least = 0.05_wp     !! a node waits until it has this way to go [length]
      real(wp) :: meeting = 0.5_wp    !! fronts of one crack that are nearer have met [length]
   end type front_limits_t

   !> A front as it will be.
   type :: line_t
      integer :: n = 0                       !! nodes
      logical :: closed = .false.            !! whether the first node follows the last
      real(wp), allocatable :: x(:, :)       !! (3,n) positions [length]
      integer, allocatable :: from(:, :)     !! (2,n) nodes of the old front that a node stands for
      real(wp), allocatable :: share(:)      !! (n) part of the second of them
      integer, allocatable :: vertex(:)      !! (n) vertex of the surface where a node stays, else 0
   end type line_t

contains

   !> The usual bounds: half of a grid size and 1.4 of it, or of a wider triangle edge.
   pure function limits_for(h, element, increment) result(limits)
      real(wp), intent(in) :: h           !! grid size [length]
      real(wp), intent(in) :: element     !! wanted edge of triangles [length]
      real(wp), intent(in) :: increment   !! way between two re-meshings [length]
      type(front_limits_t) :: limits

      limits%cell = h
      limits%shortest = 0.5_wp*min(h, element)
      limits%longest = 1.4_wp*min(h, element)
      limits%least = 0.1_wp*min(increment, limits%shortest)
      limits%meeting = limits%shortest + 2*increment
   end function limits_for

   !> The nodes of one chain, each moved by its advance; those that stay keep their vertex.
   pure function line_of_chain(front, chain, advance, stays) result(line)
      type(front_t), intent(in) :: front        !! old fronts
      integer, intent(in) :: chain              !! number of the chain
      real(wp), intent(in) :: advance(:, :)     !! (3,nn) way of each node [length]
      logical, intent(in) :: stays(:)           !! (nn) whether it waits
      type(line_t) :: line
      integer :: i, first, last

      first = front%chain_offset(chain)
      last = front%chain_offset(chain + 1) - 1
      line%n = last - first + 1
      line%closed = front%closed(chain)
      line%x = front%x(:, first:last) + advance(:, first:last)
      line%vertex = [(0, i=first, last)]
      line%from = reshape([(i, i, i=first, last)], [2, line%n])
      allocate (line%share(line%n), source=0.0_wp)
      do i = 1, line%n
         if (.not. stays(first + i - 1)) cycle
         line%vertex(i) = front%vertex(first + i - 1)
         line%x(:, i) = front%x(:, first + i - 1)
      end do
   end function line_of_chain

   !> The node of the old front that a node stands for first of all.
   pure function parent_of(line, i) result(node)
      type(line_t), intent(in) :: line   !! new front
      integer, intent(in) :: i           !! its node
      integer :: node

      node = line%from(merge(2, 1, line%share(i) > 0.5_wp), i)
   end function parent_of

   !> Merge the nodes of segments that are too short or have turned round.
   !>
   !> A node that stays is never moved, an open end keeps its place; of a chain there remain three
   !> nodes if it is closed, two if not.
   pure subroutine merge_short(line, front, limits)
      type(line_t), intent(inout) :: line
      type(front_t), intent(in) :: front
      type(front_limits_t), intent(in) :: limits
      integer :: i, j, rounds
      logical :: first, last

      i = 1
      rounds = 0
      do while (i <= segments(line) .and. rounds < 20*size(front%vertex))
         rounds = rounds + 1
         if (line%n <= merge(3, 2, line%closed)) exit
         j = modulo(i, line%n) + 1
         first = .not. line%closed .and. i == 1
         last = .not. line%closed .and. j == line%n
         if (is_sound(line, front, limits, i, j) .or. (held(line, i) .and. held(line, j)) &
             .or. (held(line, i) .and. last) .or. (first .and. held(line, j)) &
             .or. (first .and. last)) then
            i = i + 1
            cycle
         end if
         if (held(line, i) .or. first) then
            call remove_node(line, j)
         else if (held(line, j) .or. last) then
            call remove_node(line, i)
         else
            call merge_pair(line, i, j)
         end if
         i = max(1, i - 1)
      end do
      call restore_gaps(line, front)
   end subroutine merge_short

   pure function is_sound(line, front, limits, i, j) result(sound)
      type(line_t), intent(in) :: line
      type(front_t), intent(in) :: front
      type(front_limits_t), intent(in) :: limits
      integer, intent(in) :: i, j
      logical :: sound
      real(wp) :: t(3)

      t = line%x(:, j) - line%x(:, i)
      sound = norm2(t) >= (1 - tie)*limits%shortest .and. dot_product(t, &
         front%e3(:, parent_of(line, i)) + front%e3(:, parent_of(line, j))) > 0.0_wp
   end function is_sound

   pure function held(line, i) result(is)
      type(line_t), intent(in) :: line
      integer, intent(in) :: i
      logical :: is

      is = line%vertex(i) > 0
   end function held

   !> Put one node between two, on the curve through them.
   pure subroutine merge_pair(line, i, j)
      type(line_t), intent(inout) :: line
      integer, intent(in) :: i, j

      line%x(:, i) = middle(line, i, j)
      line%from(:, i) = [parent_of(line, i), parent_of(line, j)]
      line%share(i) = 0.5_wp
      call remove_node(line, j)
   end subroutine merge_pair

   !> Where merging took away all nodes between two that stay, the old ones stay too: else the
   !> strip would have a hole.
   pure subroutine restore_gaps(line, front)
      type(line_t), intent(inout) :: line
      type(front_t), intent(in) :: front
      integer :: i, j, next

      i = 1
      do while (i <= segments(line))
         j = modulo(i, line%n) + 1
         if (held(line, i) .and. held(line, j)) then
            next = front%edge_node(2, front%node_edge(2, parent_of(line, i)))
            if (next /= parent_of(line, j)) then
               call insert_node(line, i, front%x(:, next), [next, next], 0.0_wp)
               line%vertex(i + 1) = front%vertex(next)
            end if
         end if
         i = i + 1
      end do
   end subroutine restore_gaps

   !> Halve segments until none is too long; new nodes lie on the curve through the neighbours.
   pure subroutine split_long(line, limits)
      type(line_t), intent(inout) :: line
      type(front_limits_t), intent(in) :: limits
      integer :: i, j

      i = 1
      do while (i <= segments(line))
         j = modulo(i, line%n) + 1
         if (norm2(line%x(:, j) - line%x(:, i)) <= (1 + tie)*limits%longest .or. &
             (held(line, i) .and. held(line, j))) then
            i = i + 1
            cycle
         end if
         call insert_node(line, i, middle(line, i, j), [parent_of(line, i), parent_of(line, j)], &
            0.5_wp)
      end do
   end subroutine split_long

   !> Take out what changes sign from node to node: each node goes part of the way to the cubic
   !> through its four neighbours. Waves longer than a few segments, the radius of a circle and the
   !> length of the front stay as they are.
   pure subroutine smooth_line(line, front)
      type(line_t), intent(inout) :: line
      type(front_t), intent(in) :: front
      real(wp), allocatable :: x(:, :)
      real(wp) :: d(3)
      integer :: i

      if (line%n < 5) return
      allocate (x(3, line%n), source=line%x)
      do i = 1, line%n
         if (held(line, i)) cycle
         if (line%closed .or. (i > 2 .and. i < line%n - 1)) then
            d = 0.375_wp*(from_neighbours(x, i, [-2, -1, 1, 2]) - x(:, i))
         else if (i == 2) then
            d = 0.1875_wp*(from_neighbours(x, i, [-1, 1, 2]) - x(:, i))
         else if (i == line%n - 1) then
            d = 0.1875_wp*(from_neighbours(x, i, [-2, -1, 1]) - x(:, i))
         else
            cycle
         end if
         ! Only across the front: along it nodes may stand as unevenly as they like.
         associate (e3 => front%e3(:, parent_of(line, i)))
            line%x(:, i) = x(:, i) + d - dot_product(d, e3)*e3
         end associate
      end do
   end subroutine smooth_line

   !> The place of a node on the polynomial of the chord lengths through some neighbours.
   pure function from_neighbours(x, i, steps) result(p)
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: i, steps(:)
      real(wp) :: p(3), s(size(steps)), weight
      integer :: k, m, n, at(size(steps))

      n = size(x, 2)
      at = modulo(i + steps - 1, n) + 1
      do k = 1, size(steps)
         s(k) = 0.0_wp
         do m = 0, abs(steps(k)) - 1
            s(k) = s(k) + norm2(x(:, modulo(i + sign(m + 1, steps(k)) - 1, n) + 1) &
               - x(:, modulo(i + sign(m, steps(k)) - 1, n) + 1))
         end do
         s(k) = sign(s(k), real(steps(k), wp))
      end do
      p = 0.0_wp
      do k = 1, size(steps)
         weight = product(s/(s - s(k)), mask=steps /= steps(k))
         p = p + weight*x(:, at(k))
      end do
   end function from_neighbours

   !> The middle of a segment on the cubic through its nodes with their tangents.
   pure function middle(line, i, j) result(x)
      type(line_t), intent(in) :: line
      integer, intent(in) :: i, j
      real(wp) :: x(3), length, bulge(3)

      length = norm2(line%x(:, j) - line%x(:, i))
      bulge = 0.125_wp*length*(tangent(line, i, j) - tangent(line, j, i))
      x = 0.5_wp*(line%x(:, i) + line%x(:, j))
      ! A corner is no curve: past a quarter of a radian between the tangents the chord serves.
      if (norm2(bulge) < 0.0625_wp*length) x = x + bulge
   end function middle

   !> Unit tangent at a node of a segment, along the line, by the parabola through its neighbours;
   !> the chord's direction where there is no neighbour on the other side.
   pure function tangent(line, i, other) result(t)
      type(line_t), intent(in) :: line
      integer, intent(in) :: i       !! node
      integer, intent(in) :: other   !! the other node of the segment
      real(wp) :: t(3), t1(3), t2(3), l1, l2
      integer :: before, after

      before = i - 1
      after = i + 1
      if (line%closed) then
         before = modulo(before - 1, line%n) + 1
         after = modulo(after - 1, line%n) + 1
      else if (before < 1 .or. after > line%n) then
         t = unit_vector(line%x(:, max(i, other)) - line%x(:, min(i, other)))
         return
      end if
      t1 = line%x(:, i) - line%x(:, before)
      t2 = line%x(:, after) - line%x(:, i)
      l1 = max(norm2(t1), tiny(1.0_wp))
      l2 = max(norm2(t2), tiny(1.0_wp))
      t = unit_vector(t1*l2/l1 + t2*l1/l2)
   end function tangent

   pure function segments(line) result(n)
      type(line_t), intent(in) :: line
      integer :: n

      n = line%n - merge(0, 1, line%closed)
   end function segments

   !> Put a new node into a line.
   pure subroutine insert_node(line, after, x, from, share)
      type(line_t), intent(inout) :: line
      integer, intent(in) :: after      !! node before it, 0 for none
      real(wp), intent(in) :: x(3)      !! [length]
      integer, intent(in) :: from(2)    !! nodes of the old front that it stands for
      real(wp), intent(in) :: share     !! part of the second of them

      line%x = reshape([line%x(:, :after), x, line%x(:, after + 1:)], [3, line%n + 1])
      line%from = reshape([line%from(:, :after), from, line%from(:, after + 1:)], [2, line%n + 1])
      line%share = [line%share(:after), share, line%share(after + 1:)]
      line%vertex = [line%vertex(:after), 0, line%vertex(after + 1:)]
      line%n = line%n + 1
   end subroutine insert_node

   pure subroutine remove_node(line, i)
      type(line_t), intent(inout) :: line
      integer, intent(in) :: i

      line%x = reshape([line%x(:, :i - 1), line%x(:, i + 1:)], [3, line%n - 1])
      line%from = reshape([line%from(:, :i - 1), line%from(:, i + 1:)], [2, line%n - 1])
      line%share = [line%share(:i - 1), line%share(i + 1:)]
      line%vertex = [line%vertex(:i - 1), line%vertex(i + 1:)]
      line%n = line%n - 1
   end subroutine remove_node
end module xmpm_front_line
