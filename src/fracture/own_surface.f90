!> Fronts that run into the surface of their own crack.
module xmpm_own_surface
   use xmpm_kinds, only: wp
   use xmpm_surface, only: surface_t
   use xmpm_surface_index, only: nearest_in_triangle
   use xmpm_front, only: front_t
   use xmpm_front_meeting, only: facing
   implicit none
   private

   public :: find_own_surface

   real(wp), parameter :: clear = 1.0_wp     !! nearer to the surface a front does not go [cells]
   real(wp), parameter :: around = 3.0_wp    !! what is connected with a node so far from it is the
                                             !! surface that it belongs to [cells]
   real(wp), parameter :: rim = 0.25_wp      !! nearer to a front a place is at the front [cells]

contains

   !> Nodes that would come within a cell of a part of the surface which is not connected with them
   !> nearby. Fronts that meet face to face are no such case.
   pure subroutine find_own_surface(surface, front, advance, h, meets)
      type(surface_t), intent(in) :: surface       !! of one crack
      type(front_t), intent(in) :: front           !! its fronts
      real(wp), intent(in) :: advance(:, :)        !! (3,nn) way of each node [length]
      real(wp), intent(in) :: h                    !! cell size [length]
      logical, intent(out) :: meets(:)             !! (nn)
      logical :: own(surface%vertex_count)
      real(wp) :: d(2), q(3)
      integer :: i

      meets = .false.
      do i = 1, front%node_count
         if (.not. norm2(advance(:, i)) > 0) cycle
         call connected(surface, front%vertex(i), around*h, own)
         call nearest_other(surface, own, front%x(:, i), advance(:, i), clear*h, d, q)
         meets(i) = d(2) < clear*h .and. d(2) < d(1)
         if (meets(i)) meets(i) = .not. is_facing(front, i, q, rim*h)
      end do
   end subroutine find_own_surface

   !> Vertices that are connected with one of them by edges within a ball around it.
   pure subroutine connected(surface, vertex, radius, own)
      type(surface_t), intent(in) :: surface
      integer, intent(in) :: vertex
      real(wp), intent(in) :: radius   !! [length]
      logical, intent(out) :: own(:)   !! (nv)
      logical :: within(size(own)), more
      integer :: e, v

      do v = 1, size(own)
         within(v) = norm2(surface%x(:, v) - surface%x(:, vertex)) < radius
      end do
      own = .false.
      own(vertex) = .true.
      more = .true.
      do while (more)
         more = .false.
         do e = 1, surface%edge_count
            associate (a => surface%edge(1, e), b => surface%edge(2, e))
               if (.not. (within(a) .and. within(b)) .or. (own(a) .eqv. own(b))) cycle
               own([a, b]) = .true.
               more = .true.
            end associate
         end do
      end do
   end subroutine connected

   !> Distances of the triangles without such a vertex from a point, before and after its way, as
   !> far as they are near, and the place next to it then.
   pure subroutine nearest_other(surface, own, x, way, reach, d, place)
      type(surface_t), intent(in) :: surface
      logical, intent(in) :: own(:)         !! (nv)
      real(wp), intent(in) :: x(3), way(3)  !! [length]
      real(wp), intent(in) :: reach         !! after the way [length]
      real(wp), intent(out) :: d(2)         !! huge where nothing is near [length]
      real(wp), intent(out) :: place(3)     !! [length]
      real(wp) :: c(3, 3), q(3), far
      integer :: t, region

      d = huge(1.0_wp)
      place = x
      far = reach + norm2(way)
      do t = 1, surface%triangle_count
         if (any(own(surface%tri(:, t)))) cycle
         c = surface%x(:, surface%tri(:, t))
         if (any(minval(c, 2) > x + far .or. maxval(c, 2) < x - far)) cycle
         call nearest_in_triangle(c, x, q, region)
         d(1) = min(d(1), norm2(q - x))
         call nearest_in_triangle(c, x + way, q, region)
         if (norm2(q - x - way) >= d(2)) cycle
         d(2) = norm2(q - x - way)
         place = q
      end do
   end subroutine nearest_other

   !> Whether a place is at a front that comes towards a node.
   pure function is_facing(front, node, place, reach) result(is)
      type(front_t), intent(in) :: front
      integer, intent(in) :: node
      real(wp), intent(in) :: place(3), reach   !! [length]
      logical :: is
      real(wp) :: t(3), f
      integer :: k

      is = .false.
      do k = 1, front%edge_count
         associate (a => front%x(:, front%edge_node(1, k)), b => front%x(:, front%edge_node(2, k)))
            t = b - a
            f = max(0.0_wp, min(1.0_wp, dot_product(place - a, t)/dot_product(t, t)))
            if (norm2(a + f*t - place) > reach) cycle
            is = is .or. dot_product(front%edge_e1(:, k), front%e1(:, node)) < facing
         end associate
      end do
   end function is_facing
end module xmpm_own_surface
