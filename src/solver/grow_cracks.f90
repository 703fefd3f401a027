!> Growth of cracks in a run: K for the laws, the way of the fronts every step, and new triangles
!> when an increment is due.
module xmpm_grow_cracks
   use xmpm_kinds, only: wp
   use xmpm_text, only: string_t, to_text
   use xmpm_error, only: error_t, raise, add_context, code_numerics
   use xmpm_communicator, only: max_all, agree_on_error
   use xmpm_stage_clock, only: start_stage, stop_stage, stage_crack
   use xmpm_surface_index, only: nearest_t, nearest_on_surface
   use xmpm_crack, only: gather_crack, find_near, advance_ramp, replace_surface
   use xmpm_fracture, only: start_traces, trace_reach
   use xmpm_front_values, only: flag_leaves
   use xmpm_front_average, only: average_along
   use xmpm_grow_surface, only: grown_t, grow_surface
   use xmpm_own_surface, only: find_own_surface
   use xmpm_occupancy, only: occupancy_t, look_around, body_at
   use xmpm_growth, only: advance_fronts, is_due, growth_vectors, renew_growth, toughness_at, &
      take_intensities
   use xmpm_stages, only: measure_fronts
   use xmpm_model, only: model_t
   implicit none
   private

   public :: grow_cracks, judge_fronts, note_rates, know_nodes, trace_ahead

   integer, parameter :: look = 4   !! bins around a front where material is looked for

contains

   !> Find K at the fronts whose law asks for it, when it is time to. Collective.
   subroutine judge_fronts(m)
      type(model_t), intent(inout) :: m   !! between two steps
      integer :: g, which
      logical :: due

      if (.not. allocated(m%growth)) return
      due = .false.
      do g = 1, size(m%growth)
         if (m%growth(g)%ended .or. .not. m%growth(g)%needs_intensity) cycle
         if (m%time + 0.5_wp*m%dt_before < m%growth(g)%start) cycle
         due = due .or. m%time + 0.5_wp*m%dt_before >= m%growth(g)%evaluated + m%growth(g)%every
      end do
      if (.not. due) return
      call measure_fronts(m)
      do g = 1, size(m%growth)
         if (m%growth(g)%ended .or. .not. m%growth(g)%needs_intensity) cycle
         which = findloc(m%fracture%cracks, m%growth(g)%crack, 1)
         call take_values(m, g, which)
      end do
   end subroutine judge_fronts

   !> Give the values of one crack to its growth, K averaged over neighbouring nodes; a node without
   !> a domain of its own has those of the nearest node that has one.
   subroutine take_values(m, g, which)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: g       !! growth
      integer, intent(in) :: which   !! place among the cracks with fracture parameters
      real(wp) :: k(3, m%fracture%values(which)%points%n), rate(m%fracture%values(which)%points%n)
      real(wp) :: averaged(3, m%fracture%values(which)%points%n)
      logical :: known(m%fracture%values(which)%points%n)
      integer :: i, from

      associate (values => m%fracture%values(which))
         known = iand(values%flags, flag_leaves) == 0
         averaged = average_along(m%cracks(m%growth(g)%crack)%front, known, values%k)
         do i = 1, values%points%n
            from = nearest_known(values%points%x, known, i)
            k(:, i) = 0
            rate(i) = 0
            ! Where no domain of the front fits, the last part of a section, its own K must do.
            if (from == 0 .and. values%j(i) > 0) from = i
            if (from == 0) cycle
            k(:, i) = averaged(:, from)
            rate(i) = max(0.0_wp, values%j(from))
            m%growth(g)%rayleigh(i) = values%material(from)%rayleigh
            m%growth(g)%dilatational(i) = values%material(from)%dilatation
         end do
      end associate
      call take_intensities(m%growth(g), k, rate, m%time)
      call note_widths(m, g, which)
   end subroutine take_values

   !> Energy release rates of fronts whose law asks for no K, as just measured for the output.
   subroutine note_rates(m)
      type(model_t), intent(inout) :: m
      integer :: g, which

      if (.not. allocated(m%growth)) return
      do g = 1, size(m%growth)
         which = findloc(m%fracture%cracks, m%growth(g)%crack, 1)
         if (m%growth(g)%ended .or. m%growth(g)%needs_intensity .or. which == 0) cycle
         m%growth(g)%rate = max(0.0_wp, m%fracture%values(which)%j)
         call note_widths(m, g, which)
      end do
   end subroutine note_rates

   !> Length of the front that goes with each node: half the way to both neighbours, where the last
   !> nodes stand where the material ends.
   subroutine note_widths(m, g, which)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: g, which
      real(wp), allocatable :: width(:)
      integer :: e

      associate (front => m%cracks(m%growth(g)%crack)%front, &
         x => m%fracture%values(which)%points%x)
         allocate (width(front%node_count), source=0.0_wp)
         do e = 1, front%edge_count
            associate (node => front%edge_node(:, e))
               width(node) = width(node) + 0.5_wp*norm2(x(:, node(2)) - x(:, node(1)))
            end associate
         end do
      end associate
      call move_alloc(width, m%growth(g)%width)
   end subroutine note_widths

   pure function nearest_known(x, known, i) result(best)
      real(wp), intent(in) :: x(:, :)
      logical, intent(in) :: known(:)
      integer, intent(in) :: i
      integer :: best, k

      best = i
      if (known(i)) return
      best = 0
      do k = 1, size(known)
         if (.not. known(k)) cycle
         if (best > 0) then
            if (norm2(x(:, k) - x(:, i)) >= norm2(x(:, best) - x(:, i))) cycle
         end if
         best = k
      end do
   end function nearest_known

   !> Let the fronts go the way of the step just done. Collective.
   subroutine grow_cracks(m, error)
      type(model_t), intent(inout) :: m
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: reached
      logical :: new
      integer :: g, c

      if (.not. allocated(m%growth) .or. m%relaxing) return
      if (size(m%growth) == 0) return
      call start_stage(m%clock, stage_crack)
      reached = 0
      do g = 1, size(m%growth)
         if (m%growth(g)%ended) cycle
         c = m%growth(g)%crack
         call advance_fronts(m%growth(g), m%cracks(c), m%time - m%dt_before, m%dt_before)
         if (is_due(m%growth(g), m%cracks(c))) then
            call regrow(m, g, error)
            call agree_on_error(m%comm, error)
            if (allocated(error)) exit
            reached = 1
         else if (any(m%growth(g)%speed > 0)) then
            call advance_ramp(m%cracks(c), c, m%grid%lattice%size, m%particles, new)
            if (new) reached = 1
         end if
      end do
      if (.not. allocated(error)) then
         call max_all(m%comm, reached)
         m%split_again = m%split_again .or. reached > 0
      end if
      call stop_stage(m%clock, stage_crack)
   end subroutine grow_cracks

   !> New triangles for what a crack has gone since the last time. Collective.
   subroutine regrow(m, g, error)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: g
      type(error_t), allocatable, intent(out) :: error
      type(occupancy_t) :: material
      type(grown_t) :: grown
      real(wp), allocatable :: advance(:, :), offset(:), x(:, :)
      integer :: c
      logical :: only_ahead

      c = m%growth(g)%crack
      call gather_crack(m%cracks(c), m%comm, m%grid, .true.)
      advance = growth_vectors(m%growth(g), m%cracks(c))
      call look_around(material, m%cracks(c)%front%x + advance, look, m%comm, m%grid, m%particles)
      call find_obstacles(m, g, advance)
      call grow_surface(m%cracks(c)%surface, m%cracks(c)%front, advance, m%growth(g)%waits, &
         m%growth(g)%limits, material, grown, error)
      if (allocated(error)) then
         call add_context(error, 'step '//to_text(m%step)//', time '//to_text(m%time)// &
            ", crack '"//m%cracks(c)%name//"'")
         return
      end if
      ! What was cut where a front ended or two have met is not near any front.
      only_ahead = grown%joined == 0 .and. &
         grown%front%chain_count == m%cracks(c)%front%chain_count
      x = m%cracks(c)%front%x
      call renew_growth(m%growth(g), grown, m%cracks(c)%offset, offset)
      call replace_surface(m%cracks(c), grown%surface, grown%front, offset, m%comm%rank, m%grid)
      call tell(m, g, grown, x)
      call know_nodes(m, g, error)
      if (allocated(error)) return
      call trace_ahead(m, c)
      call find_near(m%cracks(c), c, m%grid, m%particles, error, only_ahead)
   end subroutine regrow

   !> Trace the particles that the fronts of a crack will come to, long before they do.
   subroutine trace_ahead(m, c)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: c   !! crack

      if (.not. any(m%fracture%cracks == c)) return
      call start_traces(m%cracks(c), trace_reach(m%fracture, m%grid%lattice%size, .true.), m%grid, &
         m%bodies, m%particles)
   end subroutine trace_ahead

   !> Nodes that come within a cell of another crack, or of another part of their own, stay where
   !> they are.
   subroutine find_obstacles(m, g, advance)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: g
      real(wp), intent(in) :: advance(:, :)
      logical :: own(size(advance, 2)), knew
      integer :: i, k, c

      c = m%growth(g)%crack
      knew = any(m%growth(g)%waits)
      call find_own_surface(m%cracks(c)%surface, m%cracks(c)%front, advance, &
         m%grid%lattice%size, own)
      do i = 1, size(own)
         k = 0
         if (norm2(advance(:, i)) > 0) k = crack_ahead(m, c, m%cracks(c)%front%x(:, i), &
            advance(:, i))
         if (own(i)) k = c
         m%growth(g)%waits(i) = k > 0
         if (knew .or. k == 0) cycle
         call add_news(m, g, 'stopped at '//to_text(m%cracks(c)%front%x(:, i))// &
            ': it would grow into '//obstacle(m, c, k))
         knew = .true.
      end do
   end subroutine find_obstacles

   !> The last crack but one's own of which a point comes within a cell, 0 for none.
   function crack_ahead(m, c, x, way) result(k)
      type(model_t), intent(in) :: m
      integer, intent(in) :: c               !! crack that grows
      real(wp), intent(in) :: x(3), way(3)   !! of a node [length]
      integer :: k, i
      type(nearest_t) :: before, after

      k = 0
      do i = 1, size(m%cracks)
         if (i == c) cycle
         associate (other => m%cracks(i), clear => m%grid%lattice%size)
            call nearest_on_surface(other%index, other%surface, x + way, clear, after)
            if (after%triangle == 0) cycle
            call nearest_on_surface(other%index, other%surface, x, 3*clear, before)
            if (before%triangle > 0 .and. before%distance <= after%distance) cycle
            k = i
         end associate
      end do
   end function crack_ahead

   pure function obstacle(m, c, k) result(text)
      type(model_t), intent(in) :: m
      integer, intent(in) :: c, k   !! crack that grows and that which is in its way
      character(len=:), allocatable :: text

      text = "the crack '"//m%cracks(k)%name//"', and cracks that grow do not cross"
      if (k == c) text = 'its own surface; the rest of its front goes on'
   end function obstacle

   !> Where the new nodes are: outside or in which body, with its toughness. Collective.
   subroutine know_nodes(m, g, error)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: g
      type(error_t), allocatable, intent(out) :: error
      type(occupancy_t) :: material
      integer :: i, body, c

      c = m%growth(g)%crack
      call look_around(material, m%cracks(c)%front%x, 1, m%comm, m%grid, m%particles)
      do i = 1, m%cracks(c)%front%node_count
         body = body_at(material, m%cracks(c)%front%x(:, i))
         m%growth(g)%outside(i) = body == 0
         m%growth(g)%toughness(i) = toughness_at(m%growth(g), body, m%cracks(c)%front%x(:, i))
         if (m%growth(g)%toughness(i) > 0 .or. body == 0) cycle
         if (allocated(error) .or. .not. m%growth(g)%law%needs_toughness) cycle
         call raise(error, code_numerics, 'step '//to_text(m%step)//', time '//to_text(m%time)// &
            ": the crack '"//m%cracks(c)%name//"' enters a body without a toughness at "// &
            to_text(m%cracks(c)%front%x(:, i))//' (toughness in its *MATERIAL or in *GROWTH)')
      end do
   end subroutine know_nodes

   !> What the log should hear of a growth.
   subroutine tell(m, g, grown, x)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: g
      type(grown_t), intent(in) :: grown
      real(wp), intent(in) :: x(:, :)   !! (3,nn) nodes before it [length]

      if (grown%joined > 0) call add_news(m, g, 'two of its fronts met and were joined')
      if (any(grown%held)) call add_news(m, g, 'waits at '// &
         to_text(x(:, findloc(grown%held, .true., 1)))//': its new triangles would be folded')
      if (m%growth(g)%ended) call add_news(m, g, &
         'no front is left: it has cut the body through '// &
         'or left it')
   end subroutine tell

   subroutine add_news(m, g, text)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: g
      character(len=*), intent(in) :: text

      m%growth(g)%news = [m%growth(g)%news, string_t('step '//to_text(m%step)//', time '// &
         to_text(m%time)//": crack '"//m%cracks(m%growth(g)%crack)%name//"': "//text)]
   end subroutine add_news
end module xmpm_grow_cracks
