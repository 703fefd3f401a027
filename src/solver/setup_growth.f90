!> Growth from the deck: which cracks, criterion, speed law, increments, toughness.
module xmpm_setup_growth
   use xmpm_kinds, only: wp
   use xmpm_text, only: string_t, lower, to_text
   use xmpm_error, only: error_t
   use xmpm_deck, only: deck_t, block_t, count_blocks, find_block, block_named, has, real_of, &
      reals_of, text_of, texts_of, complain
   use xmpm_elastic, only: elastic_t
   use xmpm_hoop_stress, only: hoop_stress_t
   use xmpm_schoellmann, only: schoellmann_t
   use xmpm_straight, only: straight_t
   use xmpm_running_toughness, only: running_toughness_t
   use xmpm_constant_toughness, only: constant_toughness_t
   use xmpm_toughness_table, only: toughness_table_t
   use xmpm_prescribed, only: prescribed_t, prescribed_speed
   use xmpm_front_line, only: limits_for
   use xmpm_growth, only: growth_t, region_t, start_growth
   use xmpm_grow_cracks, only: know_nodes, trace_ahead
   use xmpm_model, only: model_t
   implicit none
   private

   public :: set_up_growth

   real(wp), parameter :: filter_cells = 3.5_wp   !! default of filter, in cells at the fastest wave
   real(wp), parameter :: every_cells = 0.5_wp    !! default of every, likewise

contains

   !> Read all *GROWTH blocks; problems go to the deck. Collective.
   subroutine set_up_growth(m, deck)
      type(model_t), intent(inout) :: m        !! with cracks, fronts and fracture parameters
      type(deck_t), intent(inout) :: deck
      type(block_t) :: block
      type(string_t), allocatable :: names(:)
      integer :: i, k, c

      allocate (m%growth(0))
      do i = 1, count_blocks(deck, 'growth')
         block = find_block(deck, 'growth', i)
         if (has(block, 'cracks')) then
            names = texts_of(block, 'cracks')
            do k = 1, size(names)
               c = block_named(deck, 'crack', names(k)%s)
               if (c > 0) call add_growth(m, deck, block, c)
            end do
         else
            do c = 1, size(m%cracks)
               call add_growth(m, deck, block, c)
            end do
         end if
      end do
   end subroutine set_up_growth

   !> Let one crack grow as a block says. Collective.
   subroutine add_growth(m, deck, block, crack)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      integer, intent(in) :: crack
      type(growth_t) :: growth
      type(error_t), allocatable :: failure
      character(len=:), allocatable :: name
      real(wp) :: h

      name = m%cracks(crack)%name
      if (any(m%growth%crack == crack)) then
         call complain(deck, block, '', "the crack '"//name//"' grows already by another *GROWTH")
         return
      end if
      if (m%cracks(crack)%front%edge_count == 0) then
         call complain(deck, block, '', "the crack '"//name// &
            "' has no front inside the material, so that it cannot grow")
         return
      end if
      h = m%grid%lattice%size
      growth%crack = crack
      growth%increment = real_of(block, 'increment')*h
      growth%start = real_of(block, 'start')
      growth%filter = filter_cells*h/m%wave_speed
      if (has(block, 'filter')) growth%filter = real_of(block, 'filter')
      growth%every = every_cells*h/m%wave_speed
      if (has(block, 'every')) growth%every = real_of(block, 'every')
      growth%limits = limits_for(h, h, growth%increment)
      call choose_criterion(m, block, growth)
      call choose_law(block, growth)
      call read_toughness(deck, block, growth)
      call check_fracture(m, deck, block, growth)
      call choose_meeting(m, deck, block, growth)
      call start_growth(growth, m%cracks(crack))
      m%growth = [m%growth, growth]
      call know_nodes(m, size(m%growth), failure)
      call trace_ahead(m, crack)
      if (allocated(failure)) call complain(deck, block, '', failure%message)
   end subroutine add_growth

   subroutine choose_criterion(m, block, growth)
      type(model_t), intent(in) :: m
      type(block_t), intent(in) :: block
      type(growth_t), intent(inout) :: growth
      type(straight_t) :: straight
      integer :: k

      select case (lower(text_of(block, 'criterion')))
      case ('schoellmann')
         allocate (growth%criterion, source=schoellmann_t())
      case ('straight')
         k = m%bodies%law_of(1)
         select type (law => m%bodies%laws(k)%law)
         type is (elastic_t)
            straight%poisson = 0.5_wp*law%lambda/(law%lambda + law%mu)
         end select
         allocate (growth%criterion, source=straight)
      case default
         allocate (growth%criterion, source=hoop_stress_t())
      end select
   end subroutine choose_criterion

   subroutine choose_law(block, growth)
      type(block_t), intent(in) :: block
      type(growth_t), intent(inout) :: growth
      type(toughness_table_t) :: table
      type(prescribed_t) :: told

      select case (lower(text_of(block, 'law')))
      case ('speed')
         allocate (growth%law, source=prescribed_speed(real_of(block, 'speed'), growth%start))
      case ('position')
         associate (n => reals_of(block, 'table'))
            told = prescribed_speed(0.0_wp, 0.0_wp)
            told%time = n(1::2)
            told%way = n(2::2)
         end associate
         allocate (growth%law, source=told)
      case ('table')
         associate (n => reals_of(block, 'table'))
            table%speed = n(1::2)
            table%toughness = n(2::2)
         end associate
         table%needs_toughness = .false.
         allocate (growth%law, source=table)
      case ('constant')
         allocate (growth%law, source=constant_toughness_t())
      case default
         allocate (growth%law, source=running_toughness_t())
      end select
      growth%needs_intensity = growth%law%needs_intensity &
         .or. lower(text_of(block, 'criterion')) /= 'straight'
   end subroutine choose_law

   !> K_IC of the bodies: of this block, else of their materials; and the regions.
   subroutine read_toughness(deck, block, growth)
      type(deck_t), intent(in) :: deck
      type(block_t), intent(in) :: block
      type(growth_t), intent(inout) :: growth
      type(block_t) :: body, material
      integer :: i

      allocate (growth%toughness_of(count_blocks(deck, 'body')), source=0.0_wp)
      do i = 1, size(growth%toughness_of)
         body = find_block(deck, 'body', i)
         material = find_block(deck, 'material', block_named(deck, 'material', &
            text_of(body, 'material')))
         if (has(material, 'toughness')) growth%toughness_of(i) = real_of(material, 'toughness')
      end do
      if (has(block, 'toughness')) growth%toughness_of = real_of(block, 'toughness')
      allocate (growth%regions(0))
      do i = 1, size(block%entries)
         if (block%entries(i)%key /= 'region') cycle
         associate (n => block%entries(i)%numbers)
            growth%regions = [growth%regions, region_t(n(:6), n(7))]
         end associate
      end do
   end subroutine read_toughness

   !> How near fronts must come to be joined: as the deck says, no nearer than a strip between can
   !> be drawn; else where their domains touch, since K is then that of neither alone.
   subroutine choose_meeting(m, deck, block, growth)
      type(model_t), intent(in) :: m
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(growth_t), intent(inout) :: growth

      associate (meeting => growth%limits%meeting)
         if (has(block, 'meeting')) then
            if (real_of(block, 'meeting') < meeting) then
               call complain(deck, block, 'meeting', 'no strip can be drawn so near: at least '// &
                  to_text(meeting)//', two increments and half a cell')
            end if
            meeting = real_of(block, 'meeting')
         else if (growth%needs_intensity .and. allocated(m%fracture%shape%radius)) then
            meeting = max(meeting, 2*maxval(m%fracture%shape%radius))
         end if
      end associate
   end subroutine choose_meeting

   !> A crack whose growth asks for K must be one whose fracture parameters are found.
   subroutine check_fracture(m, deck, block, growth)
      type(model_t), intent(in) :: m
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(growth_t), intent(in) :: growth

      if (.not. growth%needs_intensity) return
      if (any(m%fracture%cracks == growth%crack)) return
      call complain(deck, block, 'cracks', "the crack '"//m%cracks(growth%crack)%name// &
         "' grows by its K, but *FRACTURE does not look at it: add it to cracks there")
   end subroutine check_fracture
end module xmpm_setup_growth
