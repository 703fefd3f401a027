!> Contact of bodies and rigid bodies from the deck.
module xmpm_setup_contact
   use xmpm_kinds, only: wp
   use xmpm_text, only: string_t, to_text, lower
   use xmpm_communicator, only: sum_all, max_all
   use xmpm_deck, only: deck_t, block_t, count_blocks, find_block, block_named, has, real_of, &
      reals_of, text_of, texts_of, flag_of, complain
   use xmpm_rigid_law, only: new_rigid_law
   use xmpm_geometry, only: geometry_t, inside
   use xmpm_storage, only: c_x, c_m
   use xmpm_split, only: most_groups
   use xmpm_setup_bodies, only: body_plan_t
   use xmpm_model, only: model_t
   implicit none
   private

   public :: read_contact, finish_contact

   !> What the deck says of each two bodies.
   type :: meeting_t
      logical, allocatable :: meet(:, :)        !! (bodies,bodies) a *CONTACT names both
      real(wp), allocatable :: friction(:, :)   !! (bodies,bodies)
      real(wp), allocatable :: normal(:, :, :)  !! (3,bodies,bodies) 0 where not given
   end type meeting_t

contains

   !> Contact groups and rigid bodies, before there are particles. Problems go to the deck.
   subroutine read_contact(m, deck)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(inout) :: deck
      type(meeting_t) :: meeting
      logical, allocatable :: rigid(:)
      integer, allocatable :: group(:)
      integer :: i, n

      n = count_blocks(deck, 'body')
      allocate (rigid(n))
      do i = 1, n
         rigid(i) = flag_of(find_block(deck, 'body', i), 'rigid')
      end do
      call read_meetings(deck, n, meeting)
      call number_groups(meeting, rigid, group)
      m%bodies_meet = count_blocks(deck, 'contact') > 0 .or. any(rigid)
      call read_faces(m, deck)
      if (m%bodies_meet) then
         call check_groups(deck, meeting, rigid, group)
         m%particles%group = group
      end if
      m%bodies_meet = m%bodies_meet .or. any(m%contact%face_friction >= 0)
      call keep_groups(m, meeting, group)
      call read_rigid(m, deck, rigid, group)
   end subroutine read_contact

   !> Contact of the cracks' own faces.
   subroutine read_faces(m, deck)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(in) :: deck
      type(block_t) :: block
      integer :: k

      allocate (m%contact%face_friction(count_blocks(deck, 'crack')), source=-1.0_wp)
      do k = 1, size(m%contact%face_friction)
         block = find_block(deck, 'crack', k)
         if (lower(text_of(block, 'contact')) == 'none') cycle
         m%contact%face_friction(k) = 0
         if (has(block, 'friction')) m%contact%face_friction(k) = real_of(block, 'friction')
      end do
   end subroutine read_faces

   !> Which bodies meet, with what friction.
   subroutine read_meetings(deck, n, meeting)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: n
      type(meeting_t), intent(out) :: meeting
      type(block_t) :: block
      type(string_t), allocatable :: names(:)
      integer, allocatable :: bodies(:)
      integer :: i, j, k
      real(wp) :: normal(3)

      allocate (meeting%meet(n, n), source=.false.)
      allocate (meeting%friction(n, n), meeting%normal(3, n, n), source=0.0_wp)
      do k = 1, count_blocks(deck, 'contact')
         block = find_block(deck, 'contact', k)
         names = texts_of(block, 'bodies')
         bodies = [(block_named(deck, 'body', names(i)%s), i=1, size(names))]
         if (lower(names(1)%s) == 'all') bodies = [(i, i=1, n)]
         normal = 0
         if (has(block, 'normal')) normal = reals_of(block, 'normal')
         normal = normal/max(norm2(normal), tiny(1.0_wp))
         do i = 1, size(bodies)
            do j = 1, size(bodies)
               if (bodies(i) == bodies(j)) cycle
               meeting%meet(bodies(i), bodies(j)) = .true.
               meeting%friction(bodies(i), bodies(j)) = real_of(block, 'friction')
               meeting%normal(:, bodies(i), bodies(j)) = merge(normal, -normal, i < j)
            end do
         end do
      end do
   end subroutine read_meetings

   !> Bodies that no *CONTACT names together share rows: they are one group, and so are those that
   !> hang together by others. Rigid bodies never do.
   subroutine number_groups(meeting, rigid, group)
      type(meeting_t), intent(in) :: meeting
      logical, intent(in) :: rigid(:)
      integer, allocatable, intent(out) :: group(:)
      integer :: i, j, n
      logical :: changed

      n = size(rigid)
      group = [(i, i=1, n)]
      changed = .true.
      do while (changed)
         changed = .false.
         do i = 1, n
            do j = 1, n
               if (meeting%meet(i, j) .or. rigid(i) .or. rigid(j)) cycle
               if (group(j) <= group(i)) cycle
               group(j) = group(i)
               changed = .true.
            end do
         end do
      end do
      j = -1
      do i = 1, n   ! close up the numbers
         if (.not. any(group == i)) cycle
         j = j + 1
         where (group == i) group = j - n
      end do
      group = group + n
   end subroutine number_groups

   !> Pairs of bodies that cannot be what the deck wants.
   subroutine check_groups(deck, meeting, rigid, group)
      type(deck_t), intent(inout) :: deck
      type(meeting_t), intent(in) :: meeting
      logical, intent(in) :: rigid(:)
      integer, intent(in) :: group(:)
      type(block_t) :: one, other
      integer :: i, j

      if (maxval(group) >= most_groups) then
         one = find_block(deck, 'contact', 1)
         call complain(deck, one, '', 'more than '//to_text(most_groups)//' bodies that meet')
      end if
      do i = 1, size(group)
         one = find_block(deck, 'body', i)
         do j = i + 1, size(group)
            other = find_block(deck, 'body', j)
            if (meeting%meet(i, j) .and. group(i) == group(j)) then
               call complain(deck, one, '', 'it meets the body '//other%name//', and yet both '// &
                  'share grid nodes with a third body: name that one in the *CONTACT too')
            else if ((rigid(i) .neqv. rigid(j)) .and. .not. meeting%meet(i, j)) then
               call complain(deck, one, '', 'a rigid body shares no grid nodes: name '//one%name// &
                  ' and '//other%name//' in a *CONTACT')
            end if
         end do
      end do
   end subroutine check_groups

   !> Friction and normal by groups.
   subroutine keep_groups(m, meeting, group)
      type(model_t), intent(inout) :: m
      type(meeting_t), intent(in) :: meeting
      integer, intent(in) :: group(:)
      integer :: i, j, n

      n = maxval(group)
      m%contact%n_groups = n + 1
      allocate (m%contact%friction(0:n, 0:n), m%contact%given_normal(3, 0:n, 0:n), source=0.0_wp)
      allocate (m%contact%rigid(-1:n), source=0)
      do i = 1, size(group)
         do j = 1, size(group)
            if (group(i) == group(j) .or. .not. meeting%meet(i, j)) cycle
            m%contact%friction(group(i), group(j)) = meeting%friction(i, j)
            m%contact%given_normal(:, group(i), group(j)) = meeting%normal(:, i, j)
         end do
      end do
   end subroutine keep_groups

   !> Rigid bodies take a law of their own.
   subroutine read_rigid(m, deck, rigid, group)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(in) :: deck
      logical, intent(in) :: rigid(:)
      integer, intent(in) :: group(:)
      type(block_t) :: block
      integer :: i, r, n, k

      n = count(rigid)
      r = 0
      m%rigid%n = n
      allocate (m%rigid%group(n), m%rigid%mass(n), m%rigid%held(3, n))
      allocate (m%rigid%prescribed(3, n), m%rigid%before(3, n), m%rigid%free(3, n))
      allocate (m%rigid%now(3, n), m%rigid%row(0), m%rigid%owner(0))
      if (n > 0) call add_rigid_laws(m, rigid)
      do i = 1, size(rigid)
         if (.not. rigid(i)) cycle
         block = find_block(deck, 'body', i)
         r = r + 1
         m%rigid%group(r) = group(i)
         m%contact%rigid(group(i)) = r
         m%rigid%prescribed(:, r) = reals_of(block, 'velocity')
         m%rigid%held(:, r) = .false.
         if (has(block, 'held')) m%rigid%held(:, r) = [(index(lower(text_of(block, 'held')), &
            'xyz' (k:k)) > 0, k=1, 3)]
      end do
   end subroutine read_rigid

   !> One more law for each rigid body, with the density of its material.
   subroutine add_rigid_laws(m, rigid)
      type(model_t), intent(inout) :: m
      logical, intent(in) :: rigid(:)
      integer :: i, n
      type(model_t), allocatable :: longer

      allocate (longer)
      n = size(m%bodies%laws)
      allocate (longer%bodies%laws(n + count(rigid)))
      do i = 1, n
         call move_alloc(m%bodies%laws(i)%law, longer%bodies%laws(i)%law)
      end do
      do i = 1, size(rigid)
         if (.not. rigid(i)) cycle
         n = n + 1
         associate (law => longer%bodies%laws(m%bodies%law_of(i))%law)
            allocate (longer%bodies%laws(n)%law, source=new_rigid_law(law%name, law%density))
         end associate
         m%bodies%law_of(i) = n
      end do
      call move_alloc(longer%bodies%laws, m%bodies%laws)
   end subroutine add_rigid_laws

   !> Masses of rigid bodies that the deck gives, and bodies that stand in each other. Collective.
   subroutine finish_contact(m, deck, plans)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(inout) :: deck
      type(body_plan_t), intent(in) :: plans(:)
      type(block_t) :: block
      integer :: i, j

      m%contact%spacing = [(merge(0.0_wp, plans(i)%spacing, plans(i)%from_file), i=1, size(plans))]
      if (.not. allocated(m%particles%group)) return
      do i = 1, size(plans)
         block = find_block(deck, 'body', i)
         if (has(block, 'mass')) call scale_mass(m, i, real_of(block, 'mass'))
         do j = 1, size(plans)
            if (m%particles%group(i) == m%particles%group(j) .or. plans(j)%from_file) cycle
            call check_apart(m, deck, i, j, plans(j)%geometry)
         end do
      end do
   end subroutine finish_contact

   !> Scale the particles of a body to a mass. Collective.
   subroutine scale_mass(m, body, mass)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: body
      real(wp), intent(in) :: mass
      real(wp) :: total
      integer :: c

      total = 0
      do c = 1, m%particles%n_chunks
         if (m%particles%body(c) == body) total = total + sum(m%particles%q(:, c_m, c))
      end do
      call sum_all(m%comm, total)
      do c = 1, m%particles%n_chunks
         if (m%particles%body(c) /= body) cycle
         m%particles%q(:, c_m, c) = m%particles%q(:, c_m, c)*(mass/total)
      end do
   end subroutine scale_mass

   !> Complain where particles of a body stand in the shapes of another. Collective.
   subroutine check_apart(m, deck, body, other, geometry)
      type(model_t), intent(in) :: m
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: body, other
      type(geometry_t), intent(in) :: geometry
      type(block_t) :: one, two
      real(wp) :: x(3), corners(6)
      integer :: c, i

      corners = -huge(1.0_wp)
      do c = 1, m%particles%n_chunks
         if (m%particles%body(c) /= body) cycle
         do i = 1, m%particles%count(c)
            x = m%particles%q(i, c_x:c_x + 2, c)
            if (any(x < geometry%low) .or. any(x > geometry%high)) cycle
            if (inside(geometry, x)) corners = max(corners, [-x, x])
         end do
      end do
      call max_all(m%comm, corners)
      if (corners(1) <= -huge(1.0_wp)) return
      one = find_block(deck, 'body', body)
      two = find_block(deck, 'body', other)
      call complain(deck, one, '', 'it stands in the body '//two%name// &
         ' at the start, with particles from '//to_text(-corners(:3))//' to '// &
         to_text(corners(4:))//': bodies that meet must not overlap')
   end subroutine check_apart
end module xmpm_setup_contact
