!> Fracture parameters from the deck: which fronts, when, over which domains.
module xmpm_setup_fracture
   use xmpm_kinds, only: wp
   use xmpm_text, only: string_t, to_text
   use xmpm_communicator, only: max_all
   use xmpm_deck, only: deck_t, block_t, count_blocks, find_block, block_named, has, real_of, &
      reals_of, texts_of, complain
   use xmpm_fracture, only: start_traces, trace_reach
   use xmpm_rates, only: method_domain, method_contour, method_paper
   use xmpm_model, only: model_t
   implicit none
   private

   public :: set_up_fracture

   real(wp), parameter :: plateau = 1.5_wp   !! inner radius of a domain [cells]
   real(wp), parameter :: support = 1.6_wp   !! of the fits on circles [cells]

contains

   !> Read *FRACTURE and trace the particles around the fronts; problems go to the deck.
   subroutine set_up_fracture(m, deck)
      type(model_t), intent(inout) :: m        !! with its cracks and their fronts
      type(deck_t), intent(inout) :: deck
      type(block_t) :: block
      integer :: i

      allocate (m%fracture%cracks(0), m%fracture%at(0))
      m%fracture%methods = [method_domain]
      if (count_blocks(deck, 'fracture') > 0) then
         block = find_block(deck, 'fracture', 1)
         call read_times(block, m)
         call read_methods(deck, block, m)
         call read_shape(deck, block, m)
         call read_crack_list(deck, block, m)
      end if
      allocate (m%fracture%values(size(m%fracture%cracks)))
      do i = 1, size(m%fracture%cracks)
         call start_traces(m%cracks(m%fracture%cracks(i)), &
            trace_reach(m%fracture, m%grid%lattice%size, .false.), m%grid, m%bodies, m%particles)
      end do
   end subroutine set_up_fracture

   subroutine read_times(block, m)
      type(block_t), intent(in) :: block
      type(model_t), intent(inout) :: m

      if (has(block, 'every')) m%fracture%every = real_of(block, 'every')
      if (has(block, 'at')) m%fracture%at = reals_of(block, 'at')
   end subroutine read_times

   !> Estimators of J, each once.
   subroutine read_methods(deck, block, m)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(model_t), intent(inout) :: m
      type(string_t), allocatable :: names(:)
      integer :: i, number

      if (.not. has(block, 'methods')) return
      names = texts_of(block, 'methods')
      m%fracture%methods = [integer ::]
      do i = 1, size(names)
         select case (names(i)%s)
         case ('contour'); number = method_contour
         case ('paper'); number = method_paper
         case default; number = method_domain
         end select
         if (any(m%fracture%methods == number)) call complain(deck, block, 'methods', &
            "the method '"//names(i)%s//"' is named twice")
         m%fracture%methods = [m%fracture%methods, number]
      end do
   end subroutine read_methods

   !> Radii, window and the place of the opening; what is not given counts in cells.
   subroutine read_shape(deck, block, m)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(model_t), intent(inout) :: m
      real(wp) :: h, largest

      h = m%grid%lattice%size
      associate (shape => m%fracture%shape)
         shape%inner = plateau*h
         shape%support = support*h
         shape%radius = h*[3.0_wp, 4.0_wp, 5.0_wp]
         if (has(block, 'radii')) shape%radius = reals_of(block, 'radii')
         shape%half_width = 2*h
         if (has(block, 'window')) shape%half_width = real_of(block, 'window')
         m%fracture%behind = 2*h
         if (has(block, 'behind')) m%fracture%behind = real_of(block, 'behind')
         shape%reach = shape%half_width + maxval(shape%radius)
         if (minval(shape%radius) < (plateau + 0.5_wp)*h) then
            call complain(deck, block, 'radii', 'a radius must be at least 2 cells ('// &
               to_text(2*h)//'), for the field within '//to_text(plateau)// &
               ' cells of a front is not that of the front')
         end if
         if (any(shape%radius(2:) <= shape%radius(:size(shape%radius) - 1))) then
            call complain(deck, block, 'radii', 'the radii must grow from one to the next')
         end if
         largest = largest_body(m)
         if (maxval(shape%radius) > 0.5_wp*largest) then
            call complain(deck, block, 'radii', 'a domain of radius '// &
               to_text(maxval(shape%radius))//' is larger than the bodies, whose longest side '// &
               'is '// &
               to_text(largest))
         end if
      end associate
   end subroutine read_shape

   !> Longest side of the box around all particles. Collective.
   function largest_body(m) result(length)
      type(model_t), intent(in) :: m
      real(wp) :: length, bounds(6)
      integer :: c, i, d

      bounds = -huge(1.0_wp)
      do c = 1, m%particles%n_chunks
         do i = 1, m%particles%count(c)
            do d = 1, 3
               bounds(d) = max(bounds(d), m%particles%q(i, d, c))
               bounds(3 + d) = max(bounds(3 + d), -m%particles%q(i, d, c))
            end do
         end do
      end do
      call max_all(m%comm, bounds)
      length = maxval(bounds(:3) + bounds(4:))
   end function largest_body

   !> Cracks by name, all that have a front where none is named.
   subroutine read_crack_list(deck, block, m)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(model_t), intent(inout) :: m
      type(string_t), allocatable :: names(:)
      integer :: i, k

      if (.not. has(block, 'cracks')) then
         m%fracture%cracks = pack([(i, i=1, size(m%cracks))], m%cracks%front%node_count > 0)
         if (size(m%fracture%cracks) == 0) call complain(deck, block, '', &
            'no crack of this deck has a front inside the material')
         return
      end if
      names = texts_of(block, 'cracks')
      do i = 1, size(names)
         k = block_named(deck, 'crack', names(i)%s)
         if (k == 0) cycle
         m%fracture%cracks = [m%fracture%cracks, k]
         if (m%cracks(k)%front%node_count > 0) cycle
         call complain(deck, block, 'cracks', "the crack '"//names(i)%s// &
            "' has no front inside the material, so that it has no J; take it out of the list")
      end do
   end subroutine read_crack_list
end module xmpm_setup_fracture
