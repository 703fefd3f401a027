!> One growth of a crack surface: new triangles ahead of its fronts, and the fronts that follow.
module xmpm_grow_surface
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t
   use xmpm_hash_map, only: hash_map_t, clear_map, set_value, value_of
   use xmpm_vectors, only: cross, unit_vector
   use xmpm_surface, only: surface_t, build_surface, refresh_geometry
   use xmpm_front, only: front_t, mark_front
   use xmpm_material_test, only: material_test_t
   use xmpm_front_line, only: line_t, front_limits_t, line_of_chain, reach_out, merge_short, &
      split_long, smooth_line
   use xmpm_front_strip, only: strip_between
   use xmpm_front_meeting, only: find_meetings, ready_to_join, ready_to_close
   use xmpm_mesh_check, only: mesh_quality_t, check_new_triangles
   implicit none
   private

   public :: grown_t, grow_surface, find_front

   !> A crack after a growth.
   type :: grown_t
      type(surface_t) :: surface               !! old vertices and triangles first
      type(front_t) :: front                   !! its fronts
      integer, allocatable :: parent(:, :)     !! (2,nv) nodes of the old front between which a new
                                               !! vertex came to be; a node of it that stayed has
                                               !! itself twice, others 0
      real(wp), allocatable :: share(:)        !! (nv) part of the second of them
      integer :: old_vertices = 0              !! vertices that were there before
      type(mesh_quality_t) :: quality          !! of the new triangles
      logical, allocatable :: met(:)           !! (old nn) nodes that wait for another front of the
                                               !! crack
      integer :: joined = 0                    !! pairs of fronts that were joined, and closed rests
   end type grown_t

   !> What grows while chain after chain is worked on.
   type :: draft_t
      real(wp), allocatable :: x(:, :)         !! (3,nv) [length]
      real(wp), allocatable :: motion(:, :)    !! (3,nv) mean displacement of new vertices [length]
      integer, allocatable :: parent(:, :)     !! (2,nv)
      real(wp), allocatable :: share(:)        !! (nv)
      integer, allocatable :: tri(:, :)        !! (3,nt)
      integer, allocatable :: pair(:, :)       !! (2,np) vertices of edges that may be fronts
   end type draft_t

   integer, parameter :: smoothing = 3   !! passes over a new front; waves of four segments and
                                         !! less are then halved at least
   real(wp), parameter :: test_ahead = 0.3_wp  !! distance of test points ahead of an edge [cells]

contains

   !> Let the fronts of a crack go their way.
   !>
   !> New vertices take the mean displacement of both faces from the front, without an opening.
   !> Nodes with less to go than `limits%least`, and those that wait, stay. What has left the
   !> material wholly, and the sides of the new strips, are no fronts any more.
   subroutine grow_surface(surface, front, advance, waits, limits, material, grown, error)
      type(surface_t), intent(in) :: surface             !! the crack
      type(front_t), intent(in) :: front                 !! its fronts
      real(wp), intent(in) :: advance(:, :)              !! (3,nn) way of each node [length]
      logical, intent(in) :: waits(:)                    !! (nn) nodes that must stay
      type(front_limits_t), intent(in) :: limits         !! lengths to keep to
      class(material_test_t), intent(in) :: material     !! where material is
      type(grown_t), intent(out) :: grown                !! the crack after it
      type(error_t), allocatable, intent(out) :: error   !! code_numerics: no valid triangles
      type(draft_t) :: draft
      integer :: partner(front%node_count), chain, other
      logical :: stays(front%node_count)

      call find_meetings(front, advance, limits, partner)
      stays = waits .or. partner > 0 .or. norm2(advance, 1) < limits%least
      call start_draft(surface, front, draft)
      do chain = 1, front%chain_count
         other = ready_to_join(front, chain, partner, material)
         if (other > 0) then
            if (other < chain) cycle
            call join_chains(front, chain, other, draft)
            grown%joined = grown%joined + 1
         else if (ready_to_close(front, chain, limits)) then
            call close_chain(front, chain, draft)
            grown%joined = grown%joined + 1
         else
            call grow_chain(front, chain, advance, stays, limits, material, draft)
         end if
      end do
      grown%met = partner > 0
      grown%old_vertices = surface%vertex_count
      call finish_draft(surface, draft, grown, error)
      if (allocated(error)) return
      call check_new_triangles(grown%surface, surface%triangle_count + 1, grown%quality, error)
      if (allocated(error)) return
      call find_front(grown%surface, draft%pair, limits%cell, material, grown%front)
   end subroutine grow_surface

   subroutine start_draft(surface, front, draft)
      type(surface_t), intent(in) :: surface
      type(front_t), intent(in) :: front
      type(draft_t), intent(out) :: draft
      integer :: i

      draft%x = surface%x
      draft%tri = surface%tri
      draft%motion = 0.5_wp*(surface%up + surface%um)
      allocate (draft%parent(2, surface%vertex_count), source=0)
      allocate (draft%share(surface%vertex_count), source=0.0_wp)
      allocate (draft%pair(2, 0))
      do i = 1, front%node_count
         draft%parent(:, front%vertex(i)) = i
      end do
   end subroutine start_draft

   !> New line, its vertices and the strip to it.
   subroutine grow_chain(front, chain, advance, stays, limits, material, draft)
      type(front_t), intent(in) :: front
      integer, intent(in) :: chain
      real(wp), intent(in) :: advance(:, :)
      logical, intent(in) :: stays(:)
      type(front_limits_t), intent(in) :: limits
      class(material_test_t), intent(in) :: material
      type(draft_t), intent(inout) :: draft
      type(line_t) :: line
      integer, allocatable :: tri(:, :)
      integer :: first, last, pass

      first = front%chain_offset(chain)
      last = front%chain_offset(chain + 1) - 1
      line = line_of_chain(front, chain, advance, stays)
      if (any(line%vertex == 0)) then
         call reach_out(line, limits, material)
         call merge_short(line, front, limits)
         call split_long(line, limits)
         do pass = 1, smoothing
            call smooth_line(line, front)
         end do
      end if
      call add_vertices(front, line, draft)
      call strip_between(front%vertex(first:last), line%vertex, line%closed, draft%x, &
         front%e2(:, first:last), tri)
      call add_triangles(tri, draft)
      call add_pairs(line%vertex, line%closed, draft)
   end subroutine grow_chain

   !> Number the new nodes of a line.
   subroutine add_vertices(front, line, draft)
      type(front_t), intent(in) :: front
      type(line_t), intent(inout) :: line
      type(draft_t), intent(inout) :: draft
      integer :: i

      do i = 1, line%n
         if (line%vertex(i) > 0) cycle
         call add_vertex(front, line%x(:, i), line%from(:, i), line%share(i), draft)
         line%vertex(i) = size(draft%x, 2)
      end do
   end subroutine add_vertices

   subroutine add_vertex(front, x, from, share, draft)
      type(front_t), intent(in) :: front
      real(wp), intent(in) :: x(3), share
      integer, intent(in) :: from(2)
      type(draft_t), intent(inout) :: draft
      integer :: n
      real(wp) :: motion(3)

      n = size(draft%x, 2) + 1
      motion = (1.0_wp - share)*draft%motion(:, front%vertex(from(1))) &
         + share*draft%motion(:, front%vertex(from(2)))
      draft%x = reshape([draft%x, x], [3, n])
      draft%motion = reshape([draft%motion, motion], [3, n])
      draft%parent = reshape([draft%parent, from], [2, n])
      draft%share = [draft%share, share]
   end subroutine add_vertex

   pure subroutine add_triangles(tri, draft)
      integer, intent(in) :: tri(:, :)
      type(draft_t), intent(inout) :: draft

      draft%tri = reshape([draft%tri, tri], [3, size(draft%tri, 2) + size(tri, 2)])
   end subroutine add_triangles

   pure subroutine add_pairs(vertex, closed, draft)
      integer, intent(in) :: vertex(:)
      logical, intent(in) :: closed
      type(draft_t), intent(inout) :: draft
      integer :: i, n

      n = size(vertex)
      draft%pair = reshape([draft%pair, (vertex(i), vertex(i + 1), i=1, n - 1)], &
         [2, size(draft%pair, 2) + n - 1])
      if (closed) draft%pair = reshape([draft%pair, vertex(n), vertex(1)], &
         [2, size(draft%pair, 2) + 1])
   end subroutine add_pairs

   !> Triangles between two fronts that have met.
   subroutine join_chains(front, chain, other, draft)
      type(front_t), intent(in) :: front
      integer, intent(in) :: chain, other
      type(draft_t), intent(inout) :: draft
      integer, allocatable :: tri(:, :)
      integer :: i, first, last

      first = front%chain_offset(chain)
      last = front%chain_offset(chain + 1) - 1
      associate (ahead => [(front%vertex(i), i=front%chain_offset(other + 1) - 1, &
         front%chain_offset(other), -1)])
         call strip_between(front%vertex(first:last), ahead, front%closed(chain), draft%x, &
            front%e2(:, first:last), tri)
      end associate
      call add_triangles(tri, draft)
   end subroutine join_chains

   !> Triangles from a small closed front to its centre.
   subroutine close_chain(front, chain, draft)
      type(front_t), intent(in) :: front
      integer, intent(in) :: chain
      type(draft_t), intent(inout) :: draft
      integer :: i, first, last, n, centre

      first = front%chain_offset(chain)
      last = front%chain_offset(chain + 1) - 1
      n = last - first + 1
      call add_vertex(front, sum(front%x(:, first:last), 2)/real(n, wp), [first, first + n/2], &
         0.5_wp, draft)
      centre = size(draft%x, 2)
      do i = first, last
         call add_triangles(reshape([front%vertex(i), front%vertex(merge(first, i + 1, &
            i == last)), centre], [3, 1]), draft)
      end do
   end subroutine close_chain

   !> Topology, displacements and geometry of the grown surface.
   subroutine finish_draft(surface, draft, grown, error)
      type(surface_t), intent(in) :: surface
      type(draft_t), intent(inout) :: draft
      type(grown_t), intent(inout) :: grown
      type(error_t), allocatable, intent(out) :: error
      integer :: n

      call build_surface(draft%x, draft%tri, grown%surface, error)
      if (allocated(error)) return
      n = surface%vertex_count
      associate (s => grown%surface)
         s%up = draft%motion
         s%um = draft%motion
         s%start = draft%x - draft%motion
         s%up(:, :n) = surface%up
         s%um(:, :n) = surface%um
         s%start(:, :n) = surface%start
         call refresh_geometry(s)
      end associate
      call move_alloc(draft%parent, grown%parent)
      call move_alloc(draft%share, grown%share)
   end subroutine finish_draft

   !> Fronts among given edges: those of the boundary with material ahead of any part of them.
   subroutine find_front(surface, pair, h, material, front)
      type(surface_t), intent(in) :: surface           !! mesh
      integer, intent(in) :: pair(:, :)                !! (2,np) vertices of edges that may be
                                                       !! fronts
      real(wp), intent(in) :: h                        !! grid size [length]
      class(material_test_t), intent(in) :: material   !! where material is
      type(front_t), intent(out) :: front              !! chains and frames
      type(hash_map_t) :: may
      logical :: inside(size(surface%boundary))
      integer :: i, e

      call clear_map(may, size(pair, 2))
      do i = 1, size(pair, 2)
         call set_value(may, pair_key(pair(:, i)), 1)
      end do
      do i = 1, size(inside)
         e = surface%boundary(i)
         inside(i) = .false.
         if (value_of(may, pair_key(surface%edge(:, e)), 0) == 0) cycle
         inside(i) = has_material_ahead(surface, e, h, material)
      end do
      call mark_front(surface, inside, front)
      call drop_rests(surface, material, inside, front)
   end subroutine find_front

   !> Chains without a node in the material are done: what is left ahead of them is less than a
   !> segment, and the ramp has reached it.
   subroutine drop_rests(surface, material, inside, front)
      type(surface_t), intent(in) :: surface
      class(material_test_t), intent(in) :: material
      logical, intent(inout) :: inside(:)
      type(front_t), intent(inout) :: front
      logical :: keep(surface%edge_count), any_inside
      integer :: c, i, k

      keep = .false.
      do c = 1, front%chain_count
         any_inside = .false.
         do i = front%chain_offset(c), front%chain_offset(c + 1) - 1
            any_inside = any_inside .or. material%inside(front%x(:, i))
         end do
         do i = front%chain_offset(c), front%chain_offset(c + 1) - 1
            k = front%node_edge(2, i)
            if (k > 0) keep(front%surface_edge(k)) = any_inside
         end do
      end do
      if (count(keep) == count(inside)) return
      inside = inside .and. keep(surface%boundary)
      call mark_front(surface, inside, front)
   end subroutine drop_rests

   pure function pair_key(pair) result(key)
      integer, intent(in) :: pair(2)
      integer(i8) :: key

      key = int(minval(pair), i8)*2_i8**31 + int(maxval(pair), i8)
   end function pair_key

   !> Whether material is just ahead of an edge, at five places along it.
   pure function has_material_ahead(surface, e, h, material) result(has)
      type(surface_t), intent(in) :: surface
      integer, intent(in) :: e
      real(wp), intent(in) :: h
      class(material_test_t), intent(in) :: material
      logical :: has
      real(wp) :: ahead(3), a(3), b(3), f
      integer :: i

      a = surface%x(:, surface%edge(1, e))
      b = surface%x(:, surface%edge(2, e))
      ahead = unit_vector(cross(b - a, surface%normal(:, surface%edge_triangle(1, e))))
      has = .false.
      do i = 1, 9, 2
         f = 0.1_wp*real(i, wp)
         has = has .or. material%inside(a + f*(b - a) + test_ahead*h*ahead)
      end do
   end function has_material_ahead
end module xmpm_grow_surface
