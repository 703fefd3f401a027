!> Triangulated plane cracks: rectangle, polygon, disc, ellipse and sectors of the two.
module xmpm_crack_shapes
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t, raise, code_usage
   use xmpm_text, only: to_text
   use xmpm_vectors, only: cross, unit_vector
   use xmpm_planar_mesh, only: planar_mesh_t, mesh_polygon, signed_area
   implicit none
   private

   public :: crack_plane_t, set_plane
   public :: make_rectangle, make_polygon, make_disc, make_ellipse, make_sector

   !> Place of a shape in space: its normal is along x across.
   type :: crack_plane_t
      real(wp) :: centre(3) = 0.0_wp                     !! middle of the shape [length]
      real(wp) :: along(3) = [1.0_wp, 0.0_wp, 0.0_wp]    !! unit vector of width or first semi-axis
      real(wp) :: across(3) = [0.0_wp, 1.0_wp, 0.0_wp]   !! that of depth or second semi-axis
   end type crack_plane_t

   real(wp), parameter :: square = 1.0e-3_wp   !! cosine up to which across is turned right
   real(wp), parameter :: planar = 1.0e-6_wp   !! distance of a point from its plane over the size

contains

   !> Set a plane from a centre and two directions of any length.
   subroutine set_plane(centre, along, across, plane, error)
      real(wp), intent(in) :: centre(3)                  !! middle of the shape [length]
      real(wp), intent(in) :: along(3)   !! direction of the width or first semi-axis
      real(wp), intent(in) :: across(3)   !! direction of the depth or second semi-axis, at right
                                          !! angles to it
      type(crack_plane_t), intent(out) :: plane          !! centre and unit vectors
      type(error_t), allocatable, intent(out) :: error   !! set where the directions span no plane
      real(wp) :: cosine

      if (.not. (norm2(along) > 0.0_wp .and. norm2(across) > 0.0_wp)) then
         call raise(error, code_usage, 'crack: along ('//to_text(along)//') and across ('// &
            to_text(across)// &
            ') must both have a length')
         return
      end if
      plane%centre = centre
      plane%along = unit_vector(along)
      cosine = dot_product(plane%along, unit_vector(across))
      if (.not. abs(cosine) <= square) then
         call raise(error, code_usage, 'crack: along ('//to_text(along)//') and across ('// &
            to_text(across)// &
            ') must be at right angles; the cosine between them is '//to_text(cosine))
         return
      end if
      plane%across = across
      if (abs(cosine) > 0.0_wp) plane%across = across - dot_product(plane%along, across)*plane%along
      plane%across = unit_vector(plane%across)
   end subroutine set_plane

   !> A rectangle about the centre: right-angled triangles, diagonals in turn.
   subroutine make_rectangle(plane, sizes, element, x, tri, error)
      type(crack_plane_t), intent(in) :: plane           !! centre and directions
      real(wp), intent(in) :: sizes(2)                   !! width along, depth across [length]
      real(wp), intent(in) :: element                    !! wanted edge of the triangles [length]
      real(wp), allocatable, intent(out) :: x(:, :)      !! (3, nv) vertices [length]
      integer, allocatable, intent(out) :: tri(:, :)     !! (3, nt) triangles
      type(error_t), allocatable, intent(out) :: error   !! set where a size is not positive
      real(wp) :: edge
      integer :: n(2), i, j, v, t

      call check_sizes('rectangle', 'width and depth', sizes, element, error)
      if (allocated(error)) return
      ! A strip thinner than the element keeps angles above 20 degrees.
      edge = min(element, 2.4_wp*minval(sizes))
      n = max(1, nint(sizes/edge))
      allocate (x(3, (n(1) + 1)*(n(2) + 1)), tri(3, 2*n(1)*n(2)))
      t = 0
      do j = 0, n(2)
         do i = 0, n(1)
            v = 1 + i + (n(1) + 1)*j
            x(:, v) = plane%centre + sizes(1)*(real(i, wp)/real(n(1), wp) - 0.5_wp)*plane%along &
               + sizes(2)*(real(j, wp)/real(n(2), wp) - 0.5_wp)*plane%across
            if (i == n(1) .or. j == n(2)) cycle
            if (modulo(i + j, 2) == 0) then
               tri(:, t + 1) = [v, v + 1, v + n(1) + 2]
               tri(:, t + 2) = [v, v + n(1) + 2, v + n(1) + 1]
            else
               tri(:, t + 1) = [v, v + 1, v + n(1) + 1]
               tri(:, t + 2) = [v + 1, v + n(1) + 2, v + n(1) + 1]
            end if
            t = t + 2
         end do
      end do
   end subroutine make_rectangle

   !> A plane polygon of any simple form; its normal is right-handed about the order of its points.
   subroutine make_polygon(points, element, x, tri, error)
      real(wp), intent(in) :: points(:, :)   !! (3, n) corners in order, the first not repeated
                                             !! [length]
      real(wp), intent(in) :: element                    !! wanted edge of the triangles [length]
      real(wp), allocatable, intent(out) :: x(:, :)   !! (3, nv) vertices, the corners among them
                                                      !! [length]
      integer, allocatable, intent(out) :: tri(:, :)     !! (3, nt) triangles
      type(error_t), allocatable, intent(out) :: error   !! set where the points form no plane
                                                         !! simple polygon
      type(crack_plane_t) :: plane
      real(wp) :: normal(3), extent
      integer :: i, n

      n = size(points, 2)
      if (n < 3) then
         call raise(error, code_usage, 'crack polygon: it has '//to_text(n)// &
            ' points; at least 3 are needed')
         return
      end if
      extent = norm2(maxval(points, 2) - minval(points, 2))
      call check_sizes('polygon', 'extent', [extent], element, error)
      if (allocated(error)) return
      normal = 0.0_wp
      plane%centre = sum(points, 2)/real(n, wp)
      do i = 1, n
         associate (a => points(:, i), b => points(:, modulo(i, n) + 1))
            normal = normal + cross(a - plane%centre, b - plane%centre)
            if (norm2(b - a) <= planar*extent) call raise(error, code_usage, &
               'crack polygon: point '//to_text(i)// &
               ' and the next are one and the same; name each once')
         end associate
      end do
      if (allocated(error)) return
      if (norm2(normal) <= planar*extent**2) then
         call raise(error, code_usage, 'crack polygon: its points enclose no area')
         return
      end if
      call lay_plane(points, unit_vector(normal), plane, extent, error)
      if (allocated(error)) return
      call fill_outline(plane, divide_edges(in_plane(plane, points), element), element, &
         'polygon', x, tri, error)
   end subroutine make_polygon

   !> A disc: rings of triangles about the centre, six sides in the first ring.
   subroutine make_disc(plane, radius, element, x, tri, error)
      type(crack_plane_t), intent(in) :: plane           !! centre and directions
      real(wp), intent(in) :: radius                     !! [length]
      real(wp), intent(in) :: element                    !! wanted edge of the triangles [length]
      real(wp), allocatable, intent(out) :: x(:, :)   !! (3, nv) vertices, those of the rim exactly
                                                      !! on the circle [length]
      integer, allocatable, intent(out) :: tri(:, :)     !! (3, nt) triangles
      type(error_t), allocatable, intent(out) :: error   !! set where a size is not positive
      integer :: rings, k, j, v
      real(wp) :: angle

      call check_sizes('disc', 'radius', [radius], element, error)
      if (allocated(error)) return
      rings = max(2, nint(radius/element))
      allocate (x(3, 1 + 3*rings*(rings + 1)), tri(3, 6*rings**2))
      x(:, 1) = plane%centre
      v = 1
      do k = 1, rings
         do j = 0, 6*k - 1
            v = v + 1
            angle = pi*real(j, wp)/real(3*k, wp)
            x(:, v) = plane%centre + radius*real(k, wp)/real(rings, wp)*(cos(angle)*plane%along &
               + sin(angle)*plane%across)
         end do
      end do
      call join_rings(rings, tri)
   end subroutine make_disc

   !> Triangles between ring k - 1 and ring k, six sectors each: k outer and k - 1 inner edges a
   !> sector.
   pure subroutine join_rings(rings, tri)
      integer, intent(in) :: rings
      integer, intent(out) :: tri(:, :)
      integer :: k, sector, j, t, outer, inner

      t = 0
      do k = 1, rings
         do sector = 0, 5
            do j = 0, k - 1
               t = t + 1
               outer = sector*k + j
               inner = sector*(k - 1) + j
               tri(:, t) = [ring_point(k, outer), ring_point(k, outer + 1), &
                  ring_point(k - 1, inner)]
               if (j == k - 1) cycle
               t = t + 1
               tri(:, t) = [ring_point(k - 1, inner), ring_point(k, outer + 1), &
                  ring_point(k - 1, inner + 1)]
            end do
         end do
      end do
   end subroutine join_rings

   pure function ring_point(ring, place) result(v)
      integer, intent(in) :: ring, place
      integer :: v

      v = 1
      if (ring > 0) v = 2 + 3*ring*(ring - 1) + modulo(place, 6*ring)
   end function ring_point

   !> An ellipse; the points of its rim are equally spaced along it.
   subroutine make_ellipse(plane, semi_axes, element, x, tri, error)
      type(crack_plane_t), intent(in) :: plane           !! centre and directions
      real(wp), intent(in) :: semi_axes(2)               !! along and across [length]
      real(wp), intent(in) :: element                    !! wanted edge of the triangles [length]
      real(wp), allocatable, intent(out) :: x(:, :)   !! (3, nv) vertices, those of the rim exactly
                                                      !! on the ellipse [length]
      integer, allocatable, intent(out) :: tri(:, :)     !! (3, nt) triangles
      type(error_t), allocatable, intent(out) :: error   !! set where a size is not positive
      real(wp), allocatable :: quarter(:, :), rim(:, :)
      integer :: n

      call check_sizes('ellipse', 'semi-axes', semi_axes, element, error)
      if (allocated(error)) return
      n = max(3, ceiling(arc_length(semi_axes, 0.0_wp, 0.5_wp*pi)/element))
      quarter = divide_arc(semi_axes, 0.0_wp, 0.5_wp*pi, n)
      quarter(:, 1) = [semi_axes(1), 0.0_wp]
      quarter(:, n + 1) = [0.0_wp, semi_axes(2)]
      allocate (rim(2, 4*n))
      rim(:, 1:n) = quarter(:, 1:n)
      rim(1, n + 1:2*n) = -quarter(1, n + 1:2:-1)
      rim(2, n + 1:2*n) = quarter(2, n + 1:2:-1)
      rim(:, 2*n + 1:4*n) = -rim(:, 1:2*n)
      call fill_outline(plane, rim, element, 'ellipse', x, tri, error)
   end subroutine make_ellipse

   !> The part of a disc or ellipse between two angles, measured from along towards across.
   subroutine make_sector(plane, semi_axes, angles, element, x, tri, error)
      type(crack_plane_t), intent(in) :: plane           !! centre and directions
      real(wp), intent(in) :: semi_axes(2)   !! along and across, equal for a disc [length]
      real(wp), intent(in) :: angles(2)                  !! from, to [degrees]
      real(wp), intent(in) :: element                    !! wanted edge of the triangles [length]
      real(wp), allocatable, intent(out) :: x(:, :)   !! (3, nv) vertices, those of the arc exactly
                                                      !! on the curve [length]
      integer, allocatable, intent(out) :: tri(:, :)     !! (3, nt) triangles
      type(error_t), allocatable, intent(out) :: error   !! set where a size is not positive or the
                                                         !! angles are wrong
      real(wp), allocatable :: arc(:, :), first(:, :), last(:, :)
      real(wp) :: t(2)
      integer :: n

      call check_sizes('sector', 'semi-axes', semi_axes, element, error)
      if (allocated(error)) return
      if (.not. (angles(2) > angles(1) .and. angles(2) - angles(1) <= 360.0_wp)) then
         call raise(error, code_usage, 'crack sector: it goes from '//to_text(angles(1))// &
            ' to '//to_text(angles(2))// &
            ' degrees; the second angle must be larger, by 360 at most')
         return
      end if
      if (angles(2) - angles(1) >= 360.0_wp) then
         call make_whole(plane, semi_axes, element, x, tri, error)
         return
      end if
      t = [parameter_angle(semi_axes, angles(1)), parameter_angle(semi_axes, angles(2))]
      n = max(2, ceiling(arc_length(semi_axes, t(1), t(2))/element))
      arc = divide_arc(semi_axes, t(1), t(2), n)
      arc(:, 1) = rim_point(semi_axes, angles(1))
      arc(:, n + 1) = rim_point(semi_axes, angles(2))
      first = divide_line([0.0_wp, 0.0_wp], arc(:, 1), element)
      last = divide_line(arc(:, n + 1), [0.0_wp, 0.0_wp], element)
      if (abs(angles(2) - angles(1) - 180.0_wp) <= 0.0_wp) first(:, 1) = 0.5_wp*(arc(:, 1) &
         + arc(:, n + 1))
      n = size(first, 2) + n + size(last, 2)
      call fill_outline(plane, reshape([first, arc(:, :size(arc, 2) - 1), last], [2, n]), &
         element, 'sector', x, tri, error)
   end subroutine make_sector

   !> A sector of 360 degrees.
   subroutine make_whole(plane, semi_axes, element, x, tri, error)
      type(crack_plane_t), intent(in) :: plane
      real(wp), intent(in) :: semi_axes(2), element
      real(wp), allocatable, intent(out) :: x(:, :)
      integer, allocatable, intent(out) :: tri(:, :)
      type(error_t), allocatable, intent(out) :: error

      if (abs(semi_axes(1) - semi_axes(2)) > 0.0_wp) then
         call make_ellipse(plane, semi_axes, element, x, tri, error)
      else
         call make_disc(plane, semi_axes(1), element, x, tri, error)
      end if
   end subroutine make_whole

   !> Point of the rim under a direction; exact where the direction is an axis.
   pure function rim_point(semi_axes, degrees) result(p)
      real(wp), intent(in) :: semi_axes(2), degrees
      real(wp) :: p(2), t, quarter

      quarter = degrees/90.0_wp
      if (abs(quarter - anint(quarter)) <= 0.0_wp) then
         select case (modulo(nint(quarter), 4))
         case (0)
            p = [semi_axes(1), 0.0_wp]
         case (1)
            p = [0.0_wp, semi_axes(2)]
         case (2)
            p = [-semi_axes(1), 0.0_wp]
         case default
            p = [0.0_wp, -semi_axes(2)]
         end select
      else
         t = parameter_angle(semi_axes, degrees)
         p = semi_axes*[cos(t), sin(t)]
      end if
   end function rim_point

   !> The t of (a cos t, b sin t) under a direction, continuous over any number of turns.
   pure function parameter_angle(semi_axes, degrees) result(t)
      real(wp), intent(in) :: semi_axes(2), degrees
      real(wp) :: t, angle, turn

      angle = degrees*pi/180.0_wp
      turn = 2.0_wp*pi*anint(angle/(2.0_wp*pi))
      t = turn + atan2(semi_axes(1)*sin(angle - turn), semi_axes(2)*cos(angle - turn))
   end function parameter_angle

   !> Length of the ellipse between two parameters, by the midpoint rule.
   pure function arc_length(semi_axes, from, to) result(length)
      real(wp), intent(in) :: semi_axes(2), from, to
      real(wp) :: length, step, t
      integer :: i
      integer, parameter :: parts = 2000

      step = (to - from)/real(parts, wp)
      length = 0.0_wp
      do i = 1, parts
         t = from + (real(i, wp) - 0.5_wp)*step
         length = length + step*hypot(semi_axes(1)*sin(t), semi_axes(2)*cos(t))
      end do
   end function arc_length

   !> Points of the ellipse at n equal steps of its length, both ends included.
   pure function divide_arc(semi_axes, from, to, n) result(points)
      real(wp), intent(in) :: semi_axes(2), from, to
      integer, intent(in) :: n
      real(wp) :: points(2, n + 1), goal, done, step, piece, t
      integer :: i, k
      integer, parameter :: parts = 2000

      step = (to - from)/real(parts, wp)
      goal = arc_length(semi_axes, from, to)/real(n, wp)
      done = 0.0_wp
      k = 0
      points(:, 1) = semi_axes*[cos(from), sin(from)]
      do i = 1, parts
         t = from + (real(i, wp) - 0.5_wp)*step
         piece = step*hypot(semi_axes(1)*sin(t), semi_axes(2)*cos(t))
         do while (k < n .and. done + piece >= real(k + 1, wp)*goal)
            k = k + 1
            t = from + step*(real(i - 1, wp) + (real(k, wp)*goal - done)/piece)
            points(:, k + 1) = semi_axes*[cos(t), sin(t)]
         end do
         done = done + piece
      end do
      points(:, n + 1) = semi_axes*[cos(to), sin(to)]
   end function divide_arc

   !> Points from a to b in equal steps of about one element, b left out.
   pure function divide_line(a, b, element) result(points)
      real(wp), intent(in) :: a(2), b(2), element
      real(wp), allocatable :: points(:, :)
      integer :: i, n

      n = max(1, nint(norm2(b - a)/element))
      allocate (points(2, n))
      do i = 1, n
         points(:, i) = a + (b - a)*real(i - 1, wp)/real(n, wp)
      end do
   end function divide_line

   !> The rim of a polygon in steps of about one element.
   pure function divide_edges(corners, element) result(rim)
      real(wp), intent(in) :: corners(:, :), element
      real(wp), allocatable :: rim(:, :), side(:, :)
      integer :: i, n

      allocate (rim(2, 0))
      do i = 1, size(corners, 2)
         side = divide_line(corners(:, i), corners(:, modulo(i, size(corners, 2)) + 1), element)
         n = size(rim, 2) + size(side, 2)
         rim = reshape([rim, side], [2, n])
      end do
   end function divide_edges

   !> Mesh an outline in the plane and place it in space.
   subroutine fill_outline(plane, rim, element, name, x, tri, error)
      type(crack_plane_t), intent(in) :: plane
      real(wp), intent(in) :: rim(:, :), element
      character(len=*), intent(in) :: name
      real(wp), allocatable, intent(out) :: x(:, :)
      integer, allocatable, intent(out) :: tri(:, :)
      type(error_t), allocatable, intent(out) :: error
      type(planar_mesh_t) :: mesh
      logical :: ok
      integer :: v

      ok = signed_area(rim) > 0.0_wp
      if (ok) call mesh_polygon(rim, element, mesh, ok)
      if (.not. ok) then
         call raise(error, code_usage, 'crack '//name// &
            ': its outline crosses or touches itself; it must be simple')
         return
      end if
      allocate (x(3, mesh%points))
      do v = 1, mesh%points
         x(:, v) = plane%centre + mesh%x(1, v)*plane%along + mesh%x(2, v)*plane%across
      end do
      tri = mesh%tri(:, :mesh%triangles)
   end subroutine fill_outline

   !> Coordinates of points in a plane.
   pure function in_plane(plane, points) result(flat)
      type(crack_plane_t), intent(in) :: plane
      real(wp), intent(in) :: points(:, :)
      real(wp) :: flat(2, size(points, 2))
      integer :: i

      do i = 1, size(points, 2)
         flat(:, i) = [dot_product(points(:, i) - plane%centre, plane%along), &
            dot_product(points(:, i) - plane%centre, plane%across)]
      end do
   end function in_plane

   !> Directions in the plane of a polygon; all its points must lie in it.
   subroutine lay_plane(points, normal, plane, extent, error)
      real(wp), intent(in) :: points(:, :), normal(3), extent
      type(crack_plane_t), intent(inout) :: plane
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: off
      integer :: i

      plane%along = unit_vector(points(:, 2) - points(:, 1) - dot_product(points(:, 2) &
         - points(:, 1), normal)*normal)
      plane%across = cross(normal, plane%along)
      do i = 1, size(points, 2)
         off = abs(dot_product(points(:, i) - plane%centre, normal))
         if (off <= planar*extent) cycle
         call raise(error, code_usage, 'crack polygon: point '//to_text(i)//' at '// &
            to_text(points(:, i))//' lies '// &
            to_text(off)//' off the plane of the others; all must lie in one plane '// &
            '(write a bent crack as a file)')
         return
      end do
   end subroutine lay_plane

   !> All sizes of a shape must be positive numbers.
   subroutine check_sizes(name, what, sizes, element, error)
      character(len=*), intent(in) :: name, what
      real(wp), intent(in) :: sizes(:), element
      type(error_t), allocatable, intent(out) :: error

      if (.not. all(sizes > 0.0_wp .and. sizes < huge(1.0_wp))) then
         call raise(error, code_usage, 'crack '//name//': '//what//' = '//to_text(sizes)// &
            '; must be positive')
      else if (.not. (element > 0.0_wp .and. element < huge(1.0_wp))) then
         call raise(error, code_usage, 'crack '//name//': element = '//to_text(element)// &
            '; must be positive')
      end if
   end subroutine check_sizes
end module xmpm_crack_shapes
