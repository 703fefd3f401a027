!> Triangles of nearly equal size in a planar polygon: a constrained Delaunay triangulation with
!> inner points.
!!
!! Ears are cut from the polygon, edges are flipped until each is Delaunay, the points of a
!! hexagonal lattice are inserted one by one, and the inner points are moved to the middle of
!! their neighbours. Nothing is random.
module xmpm_planar_mesh
   use xmpm_kinds, only: wp
   implicit none
   private

   public :: planar_mesh_t, mesh_polygon, signed_area

   !> Triangulation in a plane; the first points are those of the polygon.
   type :: planar_mesh_t
      integer :: points = 0                    !! number of points
      integer :: triangles = 0                 !! number of triangles
      integer :: corners = 0                   !! number of points of the polygon
      real(wp), allocatable :: x(:, :)         !! (2, >= points) positions [length]
      integer, allocatable :: tri(:, :)        !! (3, >= triangles) vertices, counter-clockwise
      integer, allocatable :: beside(:, :)   !! (3, >= triangles) triangle across edge k, 0 on the
                                             !! boundary
   end type planar_mesh_t

contains

   !> Fill a simple polygon, given counter-clockwise in edges of about the wanted length, with
   !> triangles.
   subroutine mesh_polygon(polygon, element, mesh, ok)
      real(wp), intent(in) :: polygon(:, :)   !! (2, n) points in counter-clockwise order [length]
      real(wp), intent(in) :: element             !! wanted edge of the triangles [length]
      type(planar_mesh_t), intent(out) :: mesh   !! points (those of the polygon first) and
                                                 !! triangles
      logical, intent(out) :: ok   !! false where the polygon crosses or touches itself
      integer :: room, sweep

      room = size(polygon, 2) + lattice_size(polygon, element)
      allocate (mesh%x(2, room), source=0.0_wp)
      allocate (mesh%tri(3, 2*room), mesh%beside(3, 2*room), source=0)
      mesh%x(:, :size(polygon, 2)) = polygon
      mesh%points = size(polygon, 2)
      mesh%corners = mesh%points
      call cut_ears(mesh, ok)
      if (.not. ok) return
      call find_neighbours(mesh)
      call flip_all(mesh)
      call insert_lattice(mesh, element)
      do sweep = 1, 6
         call relax_points(mesh)
         call flip_all(mesh)
      end do
   end subroutine mesh_polygon

   !> Area of a polygon, positive where it runs counter-clockwise.
   pure function signed_area(polygon) result(area)
      real(wp), intent(in) :: polygon(:, :)   !! (2, n) points in order [length]
      real(wp) :: area                        !! [length**2]
      integer :: i

      area = 0.0_wp
      do i = 2, size(polygon, 2) - 1
         area = area + 0.5_wp*twice_area(polygon(:, 1), polygon(:, i), polygon(:, i + 1))
      end do
   end function signed_area

   pure function twice_area(a, b, c) result(area)
      real(wp), intent(in) :: a(2), b(2), c(2)
      real(wp) :: area

      area = (b(1) - a(1))*(c(2) - a(2)) - (b(2) - a(2))*(c(1) - a(1))
   end function twice_area

   !> Triangulate the polygon by cutting convex corners that hold no other point.
   subroutine cut_ears(mesh, ok)
      type(planar_mesh_t), intent(inout) :: mesh
      logical, intent(out) :: ok
      integer, allocatable :: ring(:)
      integer :: n, i, best
      real(wp) :: shape, best_shape

      n = mesh%points
      allocate (ring(n))
      do i = 1, n
         ring(i) = i
      end do
      ok = .true.
      do while (n > 2)
         best = 0
         best_shape = 0.0_wp
         do i = 1, n
            shape = ear_shape(mesh%x, ring(:n), i)
            if (shape <= best_shape*(1.0_wp + 1.0e-9_wp)) cycle
            if (blocked(mesh%x, ring(:n), i)) cycle
            best = i
            best_shape = shape
         end do
         ok = best > 0
         if (.not. ok) return
         mesh%triangles = mesh%triangles + 1
         mesh%tri(:, mesh%triangles) = [ring(before(best, n)), ring(best), ring(after(best, n))]
         ring(best:n - 1) = ring(best + 1:n)
         n = n - 1
      end do
   end subroutine cut_ears

   pure integer function before(i, n)
      integer, intent(in) :: i, n

      before = modulo(i - 2, n) + 1
   end function before

   pure integer function after(i, n)
      integer, intent(in) :: i, n

      after = modulo(i, n) + 1
   end function after

   !> Area of a corner over the square of its longest edge; 0 or less where the corner is not
   !> convex.
   pure function ear_shape(x, ring, i) result(shape)
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: ring(:), i
      real(wp) :: shape, longest

      associate (a => x(:, ring(before(i, size(ring)))), b => x(:, ring(i)), &
         c => x(:, ring(after(i, size(ring)))))
         longest = max(sum((b - a)**2), sum((c - b)**2), sum((a - c)**2))
         shape = twice_area(a, b, c)/longest - 1.0e-9_wp
      end associate
   end function ear_shape

   !> Whether another point of the ring lies in the corner or on its rim.
   pure function blocked(x, ring, i) result(is)
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: ring(:), i
      logical :: is
      integer :: j, n
      real(wp) :: slack

      n = size(ring)
      is = .false.
      associate (a => x(:, ring(before(i, n))), b => x(:, ring(i)), c => x(:, ring(after(i, n))))
         slack = -1.0e-10_wp*twice_area(a, b, c)
         do j = 1, n
            if (j == i .or. j == before(i, n) .or. j == after(i, n)) cycle
            if (twice_area(a, b, x(:, ring(j))) < slack) cycle
            if (twice_area(b, c, x(:, ring(j))) < slack) cycle
            if (twice_area(c, a, x(:, ring(j))) < slack) cycle
            is = .true.
            return
         end do
      end associate
   end function blocked

   !> The triangle across each edge, found by comparing all pairs once: the polygon alone has few
   !> triangles.
   subroutine find_neighbours(mesh)
      type(planar_mesh_t), intent(inout) :: mesh
      integer :: s, t, j, k

      do t = 2, mesh%triangles
         do s = 1, t - 1
            do k = 1, 3
               do j = 1, 3
                  if (mesh%tri(k, t) /= mesh%tri(after(j, 3), s)) cycle
                  if (mesh%tri(after(k, 3), t) /= mesh%tri(j, s)) cycle
                  mesh%beside(k, t) = s
                  mesh%beside(j, s) = t
               end do
            end do
         end do
      end do
   end subroutine find_neighbours

   !> Flip edges until all that are not on the boundary are Delaunay.
   subroutine flip_all(mesh)
      type(planar_mesh_t), intent(inout) :: mesh
      integer :: t, k, round
      logical :: flipped

      do round = 1, 1000
         flipped = .false.
         do t = 1, mesh%triangles
            do k = 1, 3
               if (.not. should_flip(mesh, t, k)) cycle
               call flip_edge(mesh, t, k)
               flipped = .true.
            end do
         end do
         if (.not. flipped) return
      end do
   end subroutine flip_all

   !> Whether the point across edge k of triangle t lies within the circle through t, by more than
   !> rounding.
   !>
   !> By the angles opposite to the edge: their sum exceeds pi where sin(alpha + beta) < 0.
   pure function should_flip(mesh, t, k) result(should)
      type(planar_mesh_t), intent(in) :: mesh
      integer, intent(in) :: t, k
      logical :: should
      integer :: s, j
      real(wp) :: p(2), q(2), r(2), w(2), cos_a, cos_b, sin_a, sin_b, scale

      should = .false.
      s = mesh%beside(k, t)
      if (s == 0) return
      j = before(place_of(mesh, s, t), 3)
      associate (a => mesh%x(:, mesh%tri(k, t)), b => mesh%x(:, mesh%tri(after(k, 3), t)), &
         c => mesh%x(:, mesh%tri(before(k, 3), t)), d => mesh%x(:, mesh%tri(j, s)))
         p = a - c
         q = b - c
         r = b - d
         w = a - d
      end associate
      cos_a = dot_product(p, q)
      cos_b = dot_product(r, w)
      sin_a = p(1)*q(2) - p(2)*q(1)
      sin_b = r(1)*w(2) - r(2)*w(1)
      scale = norm2(p)*norm2(q)*norm2(r)*norm2(w)
      should = sin_a*cos_b + cos_a*sin_b < -1.0e-10_wp*scale
   end function should_flip

   !> Which edge of triangle s borders on triangle t.
   pure function place_of(mesh, s, t) result(j)
      type(planar_mesh_t), intent(in) :: mesh
      integer, intent(in) :: s, t
      integer :: j

      do j = 1, 2
         if (mesh%beside(j, s) == t) return
      end do
   end function place_of

   !> Turn the edge between two triangles to the other diagonal: (a b c) (b a d) become (c a d) (d
   !> b c).
   subroutine flip_edge(mesh, t, k)
      type(planar_mesh_t), intent(inout) :: mesh
      integer, intent(in) :: t, k
      integer :: s, j, a, b, c, d, beyond(4)

      s = mesh%beside(k, t)
      j = place_of(mesh, s, t)
      a = mesh%tri(k, t)
      b = mesh%tri(after(k, 3), t)
      c = mesh%tri(before(k, 3), t)
      d = mesh%tri(before(j, 3), s)
      beyond = [mesh%beside(before(k, 3), t), mesh%beside(after(j, 3), s), &
         mesh%beside(before(j, 3), s), mesh%beside(after(k, 3), t)]
      mesh%tri(:, t) = [c, a, d]
      mesh%beside(:, t) = [beyond(1), beyond(2), s]
      mesh%tri(:, s) = [d, b, c]
      mesh%beside(:, s) = [beyond(3), beyond(4), t]
      if (beyond(2) > 0) mesh%beside(place_of(mesh, beyond(2), s), beyond(2)) = t
      if (beyond(4) > 0) mesh%beside(place_of(mesh, beyond(4), t), beyond(4)) = s
   end subroutine flip_edge

   !> Number of lattice points that a polygon may take in at most.
   pure function lattice_size(polygon, element) result(n)
      real(wp), intent(in) :: polygon(:, :), element
      integer :: n
      real(wp) :: extent(2)

      extent = maxval(polygon, 2) - minval(polygon, 2)
      n = (ceiling(extent(1)/element) + 3)*(ceiling(extent(2)/(0.866_wp*element)) + 3)
   end function lattice_size

   !> Insert the points of a hexagonal lattice that lie inside and not too near to the boundary.
   subroutine insert_lattice(mesh, element)
      type(planar_mesh_t), intent(inout) :: mesh
      real(wp), intent(in) :: element
      real(wp) :: low(2), high(2), middle(2), p(2)
      integer :: i, j, n(2), near

      low = minval(mesh%x(:, :mesh%corners), 2)
      high = maxval(mesh%x(:, :mesh%corners), 2)
      middle = 0.5_wp*(low + high)
      n = ceiling(0.5_wp*(high - low)/(element*[1.0_wp, sqrt(0.75_wp)]))
      near = 1
      do j = -n(2), n(2)
         do i = -n(1), n(1)
            p = middle + element*[real(i, wp) + 0.5_wp*real(modulo(j, 2), wp), &
               sqrt(0.75_wp)*real(j, wp)]
            if (.not. well_inside(mesh%x(:, :mesh%corners), p, 0.6_wp*element)) cycle
            call insert_point(mesh, p, near)
         end do
      end do
   end subroutine insert_lattice

   !> Whether a point is inside a polygon and at least `gap` away from its edges.
   pure function well_inside(polygon, p, gap) result(inside)
      real(wp), intent(in) :: polygon(:, :), p(2), gap
      logical :: inside
      integer :: i, j
      real(wp) :: t

      inside = .false.
      j = size(polygon, 2)
      do i = 1, size(polygon, 2)
         associate (a => polygon(:, j), b => polygon(:, i))
            t = min(1.0_wp, max(0.0_wp, dot_product(p - a, b - a)/sum((b - a)**2)))
            if (sum((p - a - t*(b - a))**2) < gap**2) then
               inside = .false.
               return
            end if
            if ((a(2) > p(2)) .neqv. (b(2) > p(2))) then
               if ((twice_area(a, b, p) > 0.0_wp) .eqv. (b(2) > a(2))) inside = .not. inside
            end if
         end associate
         j = i
      end do
   end function well_inside

   !> Split the triangle that holds a point into three and flip what is no longer Delaunay around
   !> it.
   subroutine insert_point(mesh, p, near)
      type(planar_mesh_t), intent(inout) :: mesh
      real(wp), intent(in) :: p(2)
      integer, intent(inout) :: near
      integer :: t, m, c(3), beyond(3), round
      logical :: flipped

      t = holder_of(mesh, p, near)
      if (t == 0) return
      near = t
      mesh%points = mesh%points + 1
      mesh%x(:, mesh%points) = p
      m = mesh%triangles
      mesh%triangles = m + 2
      c = mesh%tri(:, t)
      beyond = mesh%beside(:, t)
      mesh%tri(:, t) = [c(1), c(2), mesh%points]
      mesh%tri(:, m + 1) = [c(2), c(3), mesh%points]
      mesh%tri(:, m + 2) = [c(3), c(1), mesh%points]
      mesh%beside(:, t) = [beyond(1), m + 1, m + 2]
      mesh%beside(:, m + 1) = [beyond(2), m + 2, t]
      mesh%beside(:, m + 2) = [beyond(3), t, m + 1]
      if (beyond(2) > 0) mesh%beside(place_of(mesh, beyond(2), t), beyond(2)) = m + 1
      if (beyond(3) > 0) mesh%beside(place_of(mesh, beyond(3), t), beyond(3)) = m + 2
      do round = 1, 1000
         call flip_around(mesh, t, flipped)
         if (.not. flipped) return
      end do
   end subroutine insert_point

   !> Visit the triangles around the newest point once, flipping the far edge of each where it
   !> must be.
   subroutine flip_around(mesh, start, flipped)
      type(planar_mesh_t), intent(inout) :: mesh
      integer, intent(in) :: start
      logical, intent(out) :: flipped
      integer :: t, k, v, next

      flipped = .false.
      v = mesh%points
      t = start
      do
         k = after(findloc_in(mesh%tri(:, t), v), 3)
         next = mesh%beside(after(k, 3), t)
         if (should_flip(mesh, t, k)) then
            call flip_edge(mesh, t, k)
            flipped = .true.
         end if
         t = next
         if (t == start) return
      end do
   end subroutine flip_around

   pure function findloc_in(corners, v) result(k)
      integer, intent(in) :: corners(3), v
      integer :: k

      do k = 1, 2
         if (corners(k) == v) return
      end do
   end function findloc_in

   !> The triangle that holds a point: a walk from a guess, or a search of all where a hole is in
   !> the way.
   pure function holder_of(mesh, p, guess) result(t)
      type(planar_mesh_t), intent(in) :: mesh
      real(wp), intent(in) :: p(2)
      integer, intent(in) :: guess
      integer :: t, step, k

      t = guess
      do step = 1, mesh%triangles
         k = edge_seen(mesh, t, p)
         if (k == 0) return
         t = mesh%beside(k, t)
         if (t == 0) exit
      end do
      do t = 1, mesh%triangles
         if (edge_seen(mesh, t, p) == 0) return
      end do
      t = 0
   end function holder_of

   !> The edge of a triangle behind which a point lies farthest; 0 where it lies inside.
   pure function edge_seen(mesh, t, p) result(edge)
      type(planar_mesh_t), intent(in) :: mesh
      integer, intent(in) :: t
      real(wp), intent(in) :: p(2)
      integer :: edge, k
      real(wp) :: lowest, side

      edge = 0
      lowest = 0.0_wp
      do k = 1, 3
         side = twice_area(mesh%x(:, mesh%tri(k, t)), mesh%x(:, mesh%tri(after(k, 3), t)), p)
         if (side >= lowest) cycle
         lowest = side
         edge = k
      end do
   end function edge_seen

   !> Move each inner point to the middle of its neighbours unless that would turn a triangle over.
   subroutine relax_points(mesh)
      type(planar_mesh_t), intent(inout) :: mesh
      real(wp), allocatable :: total(:, :), old(:, :)
      integer, allocatable :: count(:)
      integer :: t, k, v

      allocate (total(2, mesh%points), source=0.0_wp)
      allocate (count(mesh%points), source=0)
      do t = 1, mesh%triangles
         do k = 1, 3
            v = mesh%tri(k, t)
            total(:, v) = total(:, v) + mesh%x(:, mesh%tri(after(k, 3), t))
            count(v) = count(v) + 1
         end do
      end do
      old = mesh%x(:, :mesh%points)
      do v = mesh%corners + 1, mesh%points
         mesh%x(:, v) = total(:, v)/real(count(v), wp)
      end do
      do t = 1, mesh%triangles
         associate (c => mesh%tri(:, t))
            if (twice_area(mesh%x(:, c(1)), mesh%x(:, c(2)), mesh%x(:, c(3))) > &
               0.2_wp*twice_area(old(:, c(1)), old(:, c(2)), old(:, c(3)))) cycle
         end associate
         mesh%x(:, :mesh%points) = old
         return
      end do
   end subroutine relax_points
end module xmpm_planar_mesh
