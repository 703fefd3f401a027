!> One growth of a crack surface: new triangles ahead of its fronts, and the fronts that follow.
module xmpm_grow_surface
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_surface, only: surface_t
   use xmpm_front, only: front_t
   use xmpm_material_test, only: material_test_t
   use xmpm_front_line, only: line_t, front_limits_t, line_of_chain, merge_short, split_long, &
      smooth_line
   use xmpm_front_reach, only: reach_out, way_through
   use xmpm_front_strip, only: strip_between
   use xmpm_front_bridge, only: join_chains, close_chain
   use xmpm_front_meeting, only: find_meetings, ready_to_join, ready_to_close, chain_of
   use xmpm_front_search, only: find_front
   use xmpm_surface_draft, only: draft_t, start_draft, add_vertex, add_triangles, add_pairs, &
      finish_draft
   use xmpm_mesh_check, only: mesh_quality_t, check_new_triangles
   implicit none
   private

   public :: grown_t, grow_surface

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
      logical, allocatable :: held(:)          !! (old nn) nodes that stay because triangles that
                                               !! come from them would be folded
      integer :: joined = 0                    !! pairs of fronts that were joined, and closed rests
   end type grown_t

   !> What is decided about the nodes of the old fronts before there is a new line.
   type :: plan_t
      real(wp), allocatable :: advance(:, :)   !! (3,nn) way of each node [length]
      logical, allocatable :: stays(:)         !! (nn) nodes that do not go
      logical, allocatable :: turns(:)         !! (chains) open ends are not led out
      logical, allocatable :: through(:)       !! (chains) the rest ahead is cut at once
      integer, allocatable :: partner(:)       !! (nn) chain that a node has met
      integer, allocatable :: near(:)          !! (nn) chain that it is about to meet
      logical, allocatable :: held(:)          !! (nn) nodes that wait for triangles that are sound
   end type plan_t

   integer, parameter :: smoothing = 3   !! passes over a new front; waves of four segments and
                                         !! less are then halved at least
   real(wp), parameter :: about = 1.5_wp !! times the distance at which fronts meet: so far their
                                         !! last nodes may be when the first have met
   integer, parameter :: attempts = 8    !! lines that are tried before growth has failed
   real(wp), parameter :: patience = 2.0_wp !! way that a node may have to go while it waits for
                                         !! triangles that are sound [cells]

contains

   !> Let the fronts of a crack go their way.
   !>
   !> New vertices take the mean displacement of both faces from the front, without an opening.
   !> Nodes with less to go than `limits%least`, and those that wait, stay. What has left the
   !> material wholly, and the sides of the new strips, are no fronts any more. Where triangles
   !> outside the material do not hold, their nodes stay; where those inside would be folded, theirs
   !> stay as well and go later, when their neighbours have gone.
   subroutine grow_surface(surface, front, advance, waits, limits, material, grown, error)
      type(surface_t), intent(in) :: surface             !! the crack
      type(front_t), intent(in) :: front                 !! its fronts
      real(wp), intent(in) :: advance(:, :)              !! (3,nn) way of each node [length]
      logical, intent(in) :: waits(:)                    !! (nn) nodes that must stay
      type(front_limits_t), intent(in) :: limits         !! lengths to keep to
      class(material_test_t), intent(in) :: material     !! where material is
      type(grown_t), intent(out) :: grown                !! the crack after it
      type(error_t), allocatable, intent(out) :: error   !! code_numerics: no valid triangles
      type(plan_t) :: plan
      type(draft_t) :: draft
      integer :: attempt
      logical :: changed, behind(front%node_count)

      call make_plan(front, advance, waits, limits, material, plan)
      do attempt = 1, attempts
         call draw(surface, front, plan, limits, material, attempt, draft, grown%joined)
         call finish_draft(surface, draft, grown%surface, error)
         if (allocated(error)) return
         call check_new_triangles(grown%surface, surface%triangle_count + 1, grown%quality, error)
         if (.not. allocated(error)) exit
         behind = nodes_behind(draft, grown%quality%faulty, front%node_count)
         call hold_outside(front, behind, material, plan, changed)
         if (.not. changed .and. grown%quality%overlapping == 0) then
            call hold_folded(front, behind, patience*limits%cell, plan, changed)
         end if
         if (.not. changed .and. (grown%joined == 0 .or. attempt > 2)) return
      end do
      if (allocated(error)) return
      grown%met = plan%partner > 0
      grown%held = plan%held
      grown%old_vertices = surface%vertex_count
      call move_alloc(draft%parent, grown%parent)
      call move_alloc(draft%share, grown%share)
      call find_front(grown%surface, draft%pair, limits%cell, material, grown%front)
   end subroutine grow_surface

   subroutine make_plan(front, advance, waits, limits, material, plan)
      type(front_t), intent(in) :: front
      real(wp), intent(in) :: advance(:, :)
      logical, intent(in) :: waits(:)
      type(front_limits_t), intent(in) :: limits
      class(material_test_t), intent(in) :: material
      type(plan_t), intent(out) :: plan
      integer :: chain

      plan%advance = advance
      allocate (plan%through(front%chain_count), source=.false.)
      allocate (plan%partner(front%node_count), plan%near(front%node_count))
      call find_meetings(front, limits%meeting, plan%partner)
      call find_meetings(front, about*limits%meeting, plan%near)
      do chain = 1, front%chain_count
         associate (first => front%chain_offset(chain), last => front%chain_offset(chain + 1) - 1)
            if (any(waits(first:last)) .or. any(plan%partner(first:last) > 0)) cycle
            if (.not. any(norm2(advance(:, first:last), 1) > limits%least)) cycle
         end associate
         call way_through(front, chain, limits, material, plan%advance, plan%through(chain))
      end do
      plan%stays = waits .or. plan%partner > 0 .or. norm2(plan%advance, 1) < limits%least
      allocate (plan%turns(front%chain_count), source=.false.)
      allocate (plan%held(front%node_count), source=.false.)
   end subroutine make_plan

   !> Draw the surface that a plan leads to.
   subroutine draw(surface, front, plan, limits, material, attempt, draft, joined)
      type(surface_t), intent(in) :: surface
      type(front_t), intent(in) :: front
      type(plan_t), intent(in) :: plan
      type(front_limits_t), intent(in) :: limits
      class(material_test_t), intent(in) :: material
      integer, intent(in) :: attempt
      type(draft_t), intent(out) :: draft
      integer, intent(out) :: joined
      integer :: chain, other

      joined = 0
      call start_draft(surface, front, draft)
      do chain = 1, front%chain_count
         other = ready_to_join(front, chain, plan%partner, plan%near, material)
         if (other > 0) then
            if (other < chain) cycle
            call join_chains(front, chain, other, limits, material, attempt, draft)
            joined = joined + 1
         else if (ready_to_close(front, chain, limits)) then
            call close_chain(front, chain, draft)
            joined = joined + 1
         else
            call grow_chain(front, chain, plan, limits, material, draft)
         end if
      end do
   end subroutine draw

   !> New line, its vertices and the strip to it.
   subroutine grow_chain(front, chain, plan, limits, material, draft)
      type(front_t), intent(in) :: front
      integer, intent(in) :: chain
      type(plan_t), intent(in) :: plan
      type(front_limits_t), intent(in) :: limits
      class(material_test_t), intent(in) :: material
      type(draft_t), intent(inout) :: draft
      type(line_t) :: line
      integer, allocatable :: tri(:, :)
      integer :: first, last, pass

      first = front%chain_offset(chain)
      last = front%chain_offset(chain + 1) - 1
      line = line_of_chain(front, chain, plan%advance, plan%stays)
      if (any(line%vertex == 0)) then
         call reach_out(line, front, chain, limits, material, plan%turns(chain))
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
      ! Where the rest was cut at once no front is left, also if a corner came to lie inside again.
      if (.not. plan%through(chain)) call add_pairs(line%vertex, line%closed, draft)
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

   !> Let the nodes outside that faulty triangles come from stay, and the ends of their fronts turn
   !> about the old ones: surface outside the material has nothing to cut. Nodes that are about to
   !> meet another front have met it.
   subroutine hold_outside(front, behind, material, plan, changed)
      type(front_t), intent(in) :: front
      logical, intent(in) :: behind(:)                 !! (nn) nodes that they come from
      class(material_test_t), intent(in) :: material
      type(plan_t), intent(inout) :: plan
      logical, intent(out) :: changed
      integer :: chain(front%node_count), node

      chain = chain_of(front)
      changed = .false.
      do node = 1, front%node_count
         if (.not. behind(node)) cycle
         changed = changed .or. .not. plan%turns(chain(node))
         plan%turns(chain(node)) = .true.
         if (plan%stays(node)) cycle
         if (plan%near(node) > 0) then
            plan%partner(node) = plan%near(node)
         else if (material%inside(front%x(:, node) + plan%advance(:, node)) .and. &
                  material%inside(front%x(:, node))) then
            cycle
         end if
         plan%stays(node) = .true.
         changed = .true.
      end do
   end subroutine hold_outside

   !> Let the nodes that folded triangles come from stay: those that go ahead, as all criteria want
   !> it, and have no long way to go yet. Their neighbours go, and leave them another frame.
   subroutine hold_folded(front, behind, longest, plan, changed)
      type(front_t), intent(in) :: front
      logical, intent(in) :: behind(:)      !! (nn) nodes that they come from
      real(wp), intent(in) :: longest       !! way to go [length]
      type(plan_t), intent(inout) :: plan
      logical, intent(out) :: changed
      integer :: node

      changed = .false.
      do node = 1, front%node_count
         if (.not. behind(node) .or. plan%stays(node)) cycle
         if (dot_product(plan%advance(:, node), front%e1(:, node)) <= 0) cycle
         if (norm2(plan%advance(:, node)) > longest) cycle
         plan%held(node) = .true.
         plan%stays(node) = .true.
         changed = .true.
      end do
   end subroutine hold_folded

   !> Nodes of the old fronts that faulty triangles come from.
   pure function nodes_behind(draft, faulty, n) result(behind)
      type(draft_t), intent(in) :: draft
      logical, intent(in) :: faulty(:)   !! (new triangles)
      integer, intent(in) :: n           !! nodes of the old fronts
      logical :: behind(n)
      integer :: t, k, i, node, old

      behind = .false.
      old = size(draft%tri, 2) - size(faulty)
      do t = 1, size(faulty)
         if (.not. faulty(t)) cycle
         do k = 1, 3
            do i = 1, 2
               node = draft%parent(i, draft%tri(k, old + t))
               if (node > 0) behind(node) = .true.
            end do
         end do
      end do
   end function nodes_behind
end module xmpm_grow_surface
