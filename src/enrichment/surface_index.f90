!> The nearest point of a crack surface, by exact distances to the few triangles that can hold it.
module xmpm_surface_index
   use xmpm_kinds, only: wp
   use xmpm_surface, only: surface_t
   use xmpm_box_tree, only: box_tree_t, build_tree, refit_tree, box_distance2, tree_depth
   implicit none
   private

   public :: surface_index_t, nearest_t, build_index, refresh_index, nearest_on_surface, &
      nearest_in_triangle
   public :: on_face, on_edge, on_vertex

   integer, parameter :: on_face = 0     !! the nearest point lies inside a triangle
   integer, parameter :: on_edge = 1     !! the nearest point lies on an edge
   integer, parameter :: on_vertex = 2   !! the nearest point is a vertex

   !> Tree over the triangles, with their corners side by side.
   type :: surface_index_t
      type(box_tree_t) :: tree                   !! boxes of the triangles
      real(wp), allocatable :: corner(:, :, :)   !! (3, 3, nt) corners of the triangles in the
                                                 !! tree's order [length]
   end type surface_index_t

   !> The nearest point of a surface.
   type :: nearest_t
      integer :: triangle = 0   !! the triangle that holds it, 0 where there is none within reach
      integer :: feature = on_face      !! on_face, on_edge or on_vertex
      integer :: part = 0               !! number of the triangle, edge or vertex of the surface
      real(wp) :: distance = 0.0_wp     !! from the point asked for [length]
      real(wp) :: point(3) = 0.0_wp     !! the nearest point [length]
   end type nearest_t

contains

   !> Build the index of a surface.
   subroutine build_index(surface, index)
      type(surface_t), intent(in) :: surface           !! mesh
      type(surface_index_t), intent(out) :: index      !! ready for questions

      call build_tree(triangle_boxes(surface), index%tree)
      allocate (index%corner(3, 3, surface%triangle_count))
      call copy_corners(surface, index)
   end subroutine build_index

   !> Renew the index after the vertices have moved; the triangles must be the same.
   subroutine refresh_index(surface, index)
      type(surface_t), intent(in) :: surface           !! mesh after `refresh_geometry`
      type(surface_index_t), intent(inout) :: index    !! boxes and corners are renewed

      call refit_tree(index%tree, triangle_boxes(surface))
      call copy_corners(surface, index)
   end subroutine refresh_index

   !> The nearest point of the surface within reach of a point.
   !>
   !> Of triangles at the same distance the one with the lowest number answers, whatever the hint.
   pure subroutine nearest_on_surface(index, surface, x, reach, nearest, hint)
      type(surface_index_t), intent(in) :: index     !! of this surface
      type(surface_t), intent(in) :: surface         !! mesh
      real(wp), intent(in) :: x(3)                   !! point [length]
      real(wp), intent(in) :: reach                  !! largest distance of interest [length]
      type(nearest_t), intent(out) :: nearest        !! triangle 0 where nothing is within reach
      integer, intent(in), optional :: hint   !! a triangle that may be near, 0 for none; saves time
                                              !! only
      real(wp) :: best, q(3)
      integer :: region

      best = reach*reach
      if (present(hint)) then
         if (hint > 0) then
            ! Only a bound, a little too large: what is found then never depends on the hint.
            call nearest_in_triangle(surface%x(:, surface%tri(:, hint)), x, q, region)
            best = min(best, sum((x - q)**2)*(1.0_wp + 1.0e-9_wp) + surface%rounding**2)
         end if
      end if
      region = 0
      call walk(index, x, best, region, nearest%triangle, nearest%point)
      if (nearest%triangle == 0) return
      nearest%distance = sqrt(best)
      call name_feature(surface, region, nearest)
   end subroutine nearest_on_surface

   !> Visit the boxes that are nearer than the best triangle so far, the nearer of two first.
   pure subroutine walk(index, x, best, best_region, best_triangle, best_point)
      type(surface_index_t), intent(in) :: index
      real(wp), intent(in) :: x(3)
      real(wp), intent(inout) :: best
      integer, intent(inout) :: best_region, best_triangle
      real(wp), intent(inout) :: best_point(3)
      integer :: waiting(tree_depth), count, node, one, two
      real(wp) :: bound(tree_depth), to_one, to_two

      count = 0
      if (index%tree%nodes > 0) then
         count = 1
         waiting(1) = 1
         bound(1) = box_distance2(index%tree%box(:, 1), x)
      end if
      do while (count > 0)
         node = waiting(count)
         count = count - 1
         if (bound(count + 1) > best) cycle
         if (index%tree%second(node) == 0) then
            call search_leaf(index, node, x, best, best_region, best_triangle, best_point)
            cycle
         end if
         one = node + 1
         two = index%tree%second(node)
         to_one = box_distance2(index%tree%box(:, one), x)
         to_two = box_distance2(index%tree%box(:, two), x)
         if (to_two < to_one) then
            waiting(count + 1:count + 2) = [one, two]
            bound(count + 1:count + 2) = [to_one, to_two]
         else
            waiting(count + 1:count + 2) = [two, one]
            bound(count + 1:count + 2) = [to_two, to_one]
         end if
         count = count + 2
      end do
   end subroutine walk

   pure subroutine search_leaf(index, node, x, best, best_region, best_triangle, best_point)
      type(surface_index_t), intent(in) :: index
      integer, intent(in) :: node
      real(wp), intent(in) :: x(3)
      real(wp), intent(inout) :: best
      integer, intent(inout) :: best_region, best_triangle
      real(wp), intent(inout) :: best_point(3)
      real(wp) :: q(3), d2
      integer :: place, region, triangle

      do place = index%tree%first(node), index%tree%last(node)
         call nearest_in_triangle(index%corner(:, :, place), x, q, region)
         d2 = (x(1) - q(1))**2 + (x(2) - q(2))**2 + (x(3) - q(3))**2
         if (d2 > best) cycle
         triangle = index%tree%item(place)
         if (.not. d2 < best .and. best_triangle > 0 .and. triangle > best_triangle) cycle
         best = d2
         best_region = region
         best_triangle = triangle
         best_point = q
      end do
   end subroutine search_leaf

   !> The nearest point of a triangle, by the regions of its corners, edges and face (Ericson
   !> 2005, section 5.1.5).
   pure subroutine nearest_in_triangle(c, x, q, region)
      real(wp), intent(in) :: c(3, 3)    !! corners, one a column [length]
      real(wp), intent(in) :: x(3)       !! point [length]
      real(wp), intent(out) :: q(3)      !! nearest point [length]
      integer, intent(out) :: region   !! 0 face, 1 to 3 edge from corner k to k + 1, 4 to 6 corner
                                       !! k - 3
      real(wp) :: ab(3), ac(3), d1, d2, d3, d4, d5, d6, va, vb, vc

      ab = c(:, 2) - c(:, 1)
      ac = c(:, 3) - c(:, 1)
      d1 = dot_product(ab, x - c(:, 1))
      d2 = dot_product(ac, x - c(:, 1))
      d3 = dot_product(ab, x - c(:, 2))
      d4 = dot_product(ac, x - c(:, 2))
      d5 = dot_product(ab, x - c(:, 3))
      d6 = dot_product(ac, x - c(:, 3))
      vc = d1*d4 - d3*d2
      vb = d5*d2 - d1*d6
      va = d3*d6 - d5*d4
      if (d1 <= 0.0_wp .and. d2 <= 0.0_wp) then
         region = 4
         q = c(:, 1)
      else if (d3 >= 0.0_wp .and. d4 <= d3) then
         region = 5
         q = c(:, 2)
      else if (d6 >= 0.0_wp .and. d5 <= d6) then
         region = 6
         q = c(:, 3)
      else if (vc <= 0.0_wp .and. d1 >= 0.0_wp .and. d3 <= 0.0_wp) then
         region = 1
         q = c(:, 1) + d1/(d1 - d3)*ab
      else if (va <= 0.0_wp .and. d4 >= d3 .and. d5 >= d6) then
         region = 2
         q = c(:, 2) + (d4 - d3)/((d4 - d3) + (d5 - d6))*(c(:, 3) - c(:, 2))
      else if (vb <= 0.0_wp .and. d2 >= 0.0_wp .and. d6 <= 0.0_wp) then
         region = 3
         q = c(:, 1) + d2/(d2 - d6)*ac
      else
         region = 0
         q = c(:, 1) + (vb*ab + vc*ac)/(va + vb + vc)
      end if
   end subroutine nearest_in_triangle

   !> Which edge or vertex of the surface the region of a triangle is.
   pure subroutine name_feature(surface, region, nearest)
      type(surface_t), intent(in) :: surface
      integer, intent(in) :: region
      type(nearest_t), intent(inout) :: nearest

      select case (region)
      case (0)
         nearest%feature = on_face
         nearest%part = nearest%triangle
      case (1:3)
         nearest%feature = on_edge
         nearest%part = surface%triangle_edge(region, nearest%triangle)
      case default
         nearest%feature = on_vertex
         nearest%part = surface%tri(region - 3, nearest%triangle)
      end select
   end subroutine name_feature

   !> Boxes of all triangles, wider by rounding so that no box is farther than its triangle.
   pure function triangle_boxes(surface) result(box)
      type(surface_t), intent(in) :: surface
      real(wp) :: box(6, surface%triangle_count)
      integer :: t

      do t = 1, surface%triangle_count
         associate (x => surface%x(:, surface%tri(:, t)))
            box(1:3, t) = minval(x, 2) - surface%rounding
            box(4:6, t) = maxval(x, 2) + surface%rounding
         end associate
      end do
   end function triangle_boxes

   pure subroutine copy_corners(surface, index)
      type(surface_t), intent(in) :: surface
      type(surface_index_t), intent(inout) :: index
      integer :: place

      do place = 1, surface%triangle_count
         index%corner(:, :, place) = surface%x(:, surface%tri(:, index%tree%item(place)))
      end do
   end subroutine copy_corners
end module xmpm_surface_index
