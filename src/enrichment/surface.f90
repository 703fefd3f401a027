!> The crack surface: a triangle mesh of its own, moved by the mean of the displacements of its
!> two faces.
module xmpm_surface
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t, raise, code_usage
   use xmpm_text, only: to_text
   use xmpm_hash_map, only: hash_map_t, clear_map, set_value, value_of
   use xmpm_vectors, only: cross, unit_vector, angle_between
   implicit none
   private

   public :: surface_t, build_surface, refresh_geometry, surface_area, fill_void

   !> Mesh, topology and normals of one crack; the normal points from the minus to the plus face.
   !!
   !! Edge k of a triangle joins its vertices k and k+1. An edge runs as its first triangle runs,
   !! so a boundary edge has the surface on its left when seen from the plus side.
   type :: surface_t
      integer :: vertex_count = 0                   !! nv
      integer :: triangle_count = 0                 !! nt
      integer :: edge_count = 0                     !! ne
      real(wp) :: rounding = 0.0_wp                 !! a point nearer is on the surface [length]
      real(wp), allocatable :: start(:, :)          !! (3,nv) vertices before any motion [length]
      real(wp), allocatable :: x(:, :)              !! (3,nv) vertices now [length]
      real(wp), allocatable :: up(:, :)             !! (3,nv) motion of the plus face [length]
      real(wp), allocatable :: um(:, :)             !! (3,nv) motion of the minus face [length]
      integer, allocatable :: tri(:, :)             !! (3,nt) vertices right-handed about the normal
      integer, allocatable :: edge(:, :)            !! (2,ne) vertices of the edges
      integer, allocatable :: edge_triangle(:, :)   !! (2,ne) triangles; the second 0 on the rim
      integer, allocatable :: triangle_edge(:, :)   !! (3,nt) edges of the triangles
      integer, allocatable :: vertex_offset(:)      !! (nv+1) first place of each vertex in the next
      integer, allocatable :: vertex_triangle(:)    !! (3 nt) triangles around vertex after vertex
      integer, allocatable :: boundary(:)           !! (nb) boundary edges in order, loop after loop
      integer, allocatable :: loop_offset(:)        !! (loops+1) first place of each loop in it
      logical, allocatable :: on_boundary(:)        !! (nv) whether a vertex lies on the boundary
      real(wp), allocatable :: normal(:, :)         !! (3,nt) unit normals of the triangles
      real(wp), allocatable :: area(:)              !! (nt) areas [length**2]
      real(wp), allocatable :: edge_normal(:, :)    !! (3,ne) unit pseudo-normals of the edges
      real(wp), allocatable :: vertex_normal(:, :)  !! (3,nv) the same of the vertices, by angle
   end type surface_t

   real(wp), parameter :: flat = 1.0e-10_wp   !! area over edge squared of a degenerate triangle

contains

   !> Build a crack surface from vertices and triangles; it starts without displacement.
   subroutine build_surface(x, tri, surface, error)
      real(wp), intent(in) :: x(:, :)                     !! (3,nv) vertices [length]
      integer, intent(in) :: tri(:, :)                    !! (3,nt) vertices of triangles, from 1
      type(surface_t), intent(out) :: surface             !! the mesh with topology and normals
      type(error_t), allocatable, intent(out) :: error    !! the mesh is no oriented manifold

      call check_triangles(x, tri, error)
      if (allocated(error)) return
      surface%vertex_count = size(x, 2)
      surface%triangle_count = size(tri, 2)
      surface%start = x
      surface%x = x
      surface%tri = tri
      allocate (surface%up(3, size(x, 2)), source=0.0_wp)
      allocate (surface%um(3, size(x, 2)), source=0.0_wp)
      call join_edges(surface, error)
      if (allocated(error)) return
      call list_vertex_triangles(surface, error)
      if (allocated(error)) return
      call follow_boundary(surface, error)
      if (allocated(error)) return
      allocate (surface%normal(3, surface%triangle_count), surface%area(surface%triangle_count))
      allocate (surface%edge_normal(3, surface%edge_count))
      allocate (surface%vertex_normal(3, surface%vertex_count))
      call refresh_geometry(surface)
   end subroutine build_surface

   !> Move the vertices to x0 + (u+ + u-)/2 and renew all normals and areas.
   subroutine refresh_geometry(surface)
      type(surface_t), intent(inout) :: surface   !! displacements are read, positions and normals
                                                  !! are set
      real(wp) :: n(3), a(3), b(3)
      integer :: t, e, k, v

      surface%x = surface%start + 0.5_wp*(surface%up + surface%um)
      surface%rounding = 64.0_wp*epsilon(1.0_wp)*maxval(abs(surface%x))
      surface%vertex_normal = 0.0_wp
      do t = 1, surface%triangle_count
         associate (c => surface%tri(:, t), x => surface%x)
            n = cross(x(:, c(2)) - x(:, c(1)), x(:, c(3)) - x(:, c(1)))
            surface%area(t) = 0.5_wp*norm2(n)
            surface%normal(:, t) = unit_vector(n)
            do k = 1, 3
               v = c(k)
               a = x(:, c(mod(k, 3) + 1)) - x(:, v)
               b = x(:, c(mod(k + 1, 3) + 1)) - x(:, v)
               surface%vertex_normal(:, v) = surface%vertex_normal(:, v) &
                  + angle_between(a, b)*surface%normal(:, t)
            end do
         end associate
      end do
      do v = 1, surface%vertex_count
         surface%vertex_normal(:, v) = unit_vector(surface%vertex_normal(:, v))
      end do
      do e = 1, surface%edge_count
         n = surface%normal(:, surface%edge_triangle(1, e))
         t = surface%edge_triangle(2, e)
         if (t > 0) n = unit_vector(n + surface%normal(:, t))
         surface%edge_normal(:, e) = n
      end do
   end subroutine refresh_geometry

   !> Area of the whole surface.
   pure function surface_area(surface) result(area)
      type(surface_t), intent(in) :: surface   !! mesh
      real(wp) :: area                         !! [length**2]

      area = sum(surface%area)
   end function surface_area

   !> Let vertices with no material around take the displacement of their neighbours.
   !>
   !> Vertices next to material come first, each with the mean of the neighbours that already have
   !> a displacement, then the next ring, and so on. A part that meets no material at all stays as
   !> it is.
   subroutine fill_void(surface, has_material)
      type(surface_t), intent(inout) :: surface   !! `up` and `um` of vertices in a void are set
      logical, intent(in) :: has_material(:)      !! (nv) whether a vertex has its own displacement
      real(wp), allocatable :: total(:, :)
      integer, allocatable :: count(:)
      logical :: known(surface%vertex_count)
      integer :: e, i, v, w

      known = has_material
      allocate (total(6, surface%vertex_count), count(surface%vertex_count))
      do while (.not. all(known))
         total = 0.0_wp
         count = 0
         do e = 1, surface%edge_count
            do i = 1, 2
               v = surface%edge(i, e)
               w = surface%edge(3 - i, e)
               if (known(v) .or. .not. known(w)) cycle
               total(:, v) = total(:, v) + [surface%up(:, w), surface%um(:, w)]
               count(v) = count(v) + 1
            end do
         end do
         if (all(count == 0)) return
         do v = 1, surface%vertex_count
            if (count(v) == 0) cycle
            surface%up(:, v) = total(1:3, v)/real(count(v), wp)
            surface%um(:, v) = total(4:6, v)/real(count(v), wp)
            known(v) = .true.
         end do
      end do
   end subroutine fill_void

   !> Every triangle must have three known, distinct vertices and an area.
   subroutine check_triangles(x, tri, error)
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: tri(:, :)
      type(error_t), allocatable, intent(out) :: error
      integer :: t
      real(wp) :: a(3), b(3), longest

      if (size(tri, 2) == 0) then
         call raise(error, code_usage, 'crack surface: it has no triangle; at least one is needed')
         return
      end if
      do t = 1, size(tri, 2)
         if (minval(tri(:, t)) < 1 .or. maxval(tri(:, t)) > size(x, 2)) then
            call raise(error, code_usage, 'crack surface: triangle '//to_text(t)// &
               ' names a vertex that is not there; allowed are 1 to '//to_text(size(x, 2)))
            return
         end if
         a = x(:, tri(2, t)) - x(:, tri(1, t))
         b = x(:, tri(3, t)) - x(:, tri(1, t))
         longest = max(dot_product(a, a), dot_product(b, b), dot_product(b - a, b - a))
         if (.not. norm2(cross(a, b)) > flat*longest) then
            call raise(error, code_usage, 'crack surface: triangle '//to_text(t)//' at '// &
               to_text(x(:, tri(1, t)))// &
               ' is degenerate (it has no area); its three vertices must not lie on one line')
            return
         end if
      end do
   end subroutine check_triangles

   !> Number the edges and find the triangles at each.
   subroutine join_edges(surface, error)
      type(surface_t), intent(inout) :: surface
      type(error_t), allocatable, intent(out) :: error
      type(hash_map_t) :: known
      integer, allocatable :: edge(:, :), owner(:, :)
      integer :: t, k, e, a, b

      allocate (edge(2, 3*surface%triangle_count), owner(2, 3*surface%triangle_count))
      allocate (surface%triangle_edge(3, surface%triangle_count))
      owner = 0
      call clear_map(known, 3*surface%triangle_count)
      do t = 1, surface%triangle_count
         do k = 1, 3
            a = surface%tri(k, t)
            b = surface%tri(mod(k, 3) + 1, t)
            e = value_of(known, edge_key(a, b), 0)
            if (e == 0) then
               e = known%count + 1
               call set_value(known, edge_key(a, b), e)
               edge(:, e) = [a, b]
               owner(1, e) = t
            else
               call check_edge(surface%tri, edge(:, e), owner(:, e), t, a, error)
               if (allocated(error)) return
               owner(2, e) = t
            end if
            surface%triangle_edge(k, t) = e
         end do
      end do
      surface%edge_count = known%count
      surface%edge = edge(:, :known%count)
      surface%edge_triangle = owner(:, :known%count)
   end subroutine join_edges

   !> A triangle that meets a known edge must be its second one, another one, and run against the
   !> first.
   subroutine check_edge(tri, edge, owner, t, first, error)
      integer, intent(in) :: tri(:, :), edge(2), owner(2), t, first
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: pair

      pair = 'crack surface: triangles '//to_text(owner(1))//' and '//to_text(t)
      if (sum(tri(:, t)) == sum(tri(:, owner(1)))) then
         call raise(error, code_usage, pair// &
            ' have the same three vertices; each triangle may be there once')
      else if (owner(2) > 0) then
         call raise(error, code_usage, 'crack surface: triangle '//to_text(t)// &
            ' is the third at the edge of triangles '// &
            to_text(owner(1))//' and '//to_text(owner(2))// &
            '; an edge joins two at most (write branches as cracks of their own)')
      else if (edge(1) == first) then
         call raise(error, code_usage, pair// &
            ' run along their common edge in the same direction; '// &
            'all triangles must be oriented alike (turn one of them round)')
      end if
   end subroutine check_edge

   pure function edge_key(a, b) result(key)
      integer, intent(in) :: a, b
      integer(i8) :: key

      key = int(min(a, b), i8)*2_i8**31 + int(max(a, b), i8)
   end function edge_key

   !> The triangles around each vertex, in rising order.
   subroutine list_vertex_triangles(surface, error)
      type(surface_t), intent(inout) :: surface
      type(error_t), allocatable, intent(out) :: error
      integer :: t, k, v
      integer, allocatable :: filled(:)

      allocate (surface%vertex_offset(surface%vertex_count + 1), filled(surface%vertex_count), &
         source=0)
      allocate (surface%vertex_triangle(3*surface%triangle_count))
      do t = 1, surface%triangle_count
         filled(surface%tri(:, t)) = filled(surface%tri(:, t)) + 1
      end do
      if (any(filled == 0)) then
         v = minloc(filled, 1)
         call raise(error, code_usage, 'crack surface: vertex '//to_text(v)//' at '// &
            to_text(surface%x(:, v))// &
            ' belongs to no triangle; leave it out')
         return
      end if
      surface%vertex_offset(1) = 1
      do v = 1, surface%vertex_count
         surface%vertex_offset(v + 1) = surface%vertex_offset(v) + filled(v)
      end do
      filled = surface%vertex_offset(:surface%vertex_count)
      do t = 1, surface%triangle_count
         do k = 1, 3
            v = surface%tri(k, t)
            surface%vertex_triangle(filled(v)) = t
            filled(v) = filled(v) + 1
         end do
      end do
   end subroutine list_vertex_triangles

   !> String the boundary edges into closed loops.
   subroutine follow_boundary(surface, error)
      type(surface_t), intent(inout) :: surface
      type(error_t), allocatable, intent(out) :: error
      integer, allocatable :: leaving(:), boundary(:), offset(:)
      integer :: e, v, first, count, loops

      allocate (surface%on_boundary(surface%vertex_count), source=.false.)
      allocate (leaving(surface%vertex_count), boundary(surface%edge_count), &
         offset(surface%edge_count + 1), source=0)
      do e = 1, surface%edge_count
         if (surface%edge_triangle(2, e) > 0) cycle
         v = surface%edge(1, e)
         if (leaving(v) > 0) then
            call raise(error, code_usage, 'crack surface: two parts, with triangles '// &
               to_text(surface%edge_triangle(1, leaving(v)))//' and '// &
               to_text(surface%edge_triangle(1, e))// &
               ', touch at vertex '//to_text(v)// &
               ' only; join them along an edge or give each its own vertex')
            return
         end if
         leaving(v) = e
         surface%on_boundary(v) = .true.
      end do
      count = 0
      loops = 0
      offset(1) = 1
      do first = 1, surface%vertex_count
         v = first
         do while (leaving(v) > 0)
            count = count + 1
            boundary(count) = leaving(v)
            leaving(v) = 0
            v = surface%edge(2, boundary(count))
         end do
         if (count < offset(loops + 1)) cycle
         loops = loops + 1
         offset(loops + 1) = count + 1
      end do
      surface%boundary = boundary(:count)
      surface%loop_offset = offset(:loops + 1)
   end subroutine follow_boundary
end module xmpm_surface
