!> A crack surface that is being added to: vertices, triangles, and the edges that may be fronts.
module xmpm_surface_draft
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_surface, only: surface_t, build_surface, refresh_geometry
   use xmpm_front, only: front_t
   implicit none
   private

   public :: draft_t, start_draft, add_vertex, add_triangles, add_pairs, finish_draft

   !> What grows while chain after chain is worked on.
   type :: draft_t
      real(wp), allocatable :: x(:, :)         !! (3,nv) [length]
      real(wp), allocatable :: motion(:, :)    !! (3,nv) mean displacement of new vertices [length]
      integer, allocatable :: parent(:, :)     !! (2,nv)
      real(wp), allocatable :: share(:)        !! (nv)
      integer, allocatable :: tri(:, :)        !! (3,nt)
      integer, allocatable :: pair(:, :)       !! (2,np) vertices of edges that may be fronts
   end type draft_t

contains

   !> Begin with a surface as it is; the nodes of its fronts are known by their vertices.
   subroutine start_draft(surface, front, draft)
      type(surface_t), intent(in) :: surface   !! mesh
      type(front_t), intent(in) :: front       !! its fronts
      type(draft_t), intent(out) :: draft      !! a copy
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

   !> Add a vertex between two nodes of the old front, with the motion that the surface has there.
   subroutine add_vertex(front, x, from, share, draft)
      type(front_t), intent(in) :: front   !! old fronts
      real(wp), intent(in) :: x(3)      !! [length]
      integer, intent(in) :: from(2)    !! nodes
      real(wp), intent(in) :: share     !! part of the second of them
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

   !> Add triangles.
   pure subroutine add_triangles(tri, draft)
      integer, intent(in) :: tri(:, :)   !! (3,nt) vertices
      type(draft_t), intent(inout) :: draft

      draft%tri = reshape([draft%tri, tri], [3, size(draft%tri, 2) + size(tri, 2)])
   end subroutine add_triangles

   !> Name the edges along a line of vertices as those that may be fronts.
   pure subroutine add_pairs(vertex, closed, draft)
      integer, intent(in) :: vertex(:)   !! in order
      logical, intent(in) :: closed      !! whether the first follows the last
      type(draft_t), intent(inout) :: draft
      integer :: i, n

      n = size(vertex)
      draft%pair = reshape([draft%pair, (vertex(i), vertex(i + 1), i=1, n - 1)], &
         [2, size(draft%pair, 2) + n - 1])
      if (closed) draft%pair = reshape([draft%pair, vertex(n), vertex(1)], &
         [2, size(draft%pair, 2) + 1])
   end subroutine add_pairs

   !> Topology, displacements and geometry of the surface.
   subroutine finish_draft(surface, draft, grown, error)
      type(surface_t), intent(in) :: surface      !! as it was
      type(draft_t), intent(in) :: draft          !! with all that is new
      type(surface_t), intent(out) :: grown       !! old vertices and triangles first
      type(error_t), allocatable, intent(out) :: error
      integer :: n

      call build_surface(draft%x, draft%tri, grown, error)
      if (allocated(error)) return
      n = surface%vertex_count
      grown%up = draft%motion
      grown%um = draft%motion
      grown%start = draft%x - draft%motion
      grown%up(:, :n) = surface%up
      grown%um(:, :n) = surface%um
      grown%start(:, :n) = surface%start
      call refresh_geometry(grown)
   end subroutine finish_draft
end module xmpm_surface_draft
