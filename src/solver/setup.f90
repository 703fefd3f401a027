!> From the deck to a model that can take its first step.
module xmpm_setup
   use xmpm_kinds, only: wp
   use xmpm_text, only: lower
   use xmpm_error, only: error_t
   use xmpm_communicator, only: agree_on_error
   use xmpm_stage_clock, only: start_clock
   use xmpm_deck, only: deck_t, block_t, find_block, has, real_of, &
      reals_of, integer_of, text_of, problems
   use xmpm_lattice, only: linear_shape, gimp_shape
   use xmpm_grid, only: make_grid
   use xmpm_kernels, only: choose_kernels
   use xmpm_crack, only: start_crack
   use xmpm_schemes, only: step_musl, step_usf, step_usl
   use xmpm_layout, only: fresh_rows
   use xmpm_settle, only: renew_level_sets, renew_splits, count_all, find_wave_speed, &
      find_fastest
   use xmpm_setup_bodies, only: set_up_materials, set_up_bodies, body_plan_t
   use xmpm_setup_conditions, only: set_up_conditions
   use xmpm_setup_contact, only: read_contact, finish_contact
   use xmpm_setup_cracks, only: read_cracks
   use xmpm_setup_fracture, only: set_up_fracture
   use xmpm_setup_growth, only: set_up_growth
   use xmpm_ledger, only: start_ledger
   use xmpm_model, only: model_t
   implicit none
   private

   public :: set_up

contains

   !> Build the model. The communicator is set before. Collective; all ranks get the same error.
   subroutine set_up(m, deck, error)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(inout) :: deck                !! set-up adds to its problems
      type(error_t), allocatable, intent(out) :: error   !! all problems of the deck, or one of
                                                         !! files
      type(body_plan_t), allocatable :: plans(:)
      integer :: i

      call start_clock(m%clock)
      call set_up_method(m, deck)
      call read_cracks(deck, m%grid%lattice%size, m%cracks)
      call set_up_materials(m, deck)
      call read_contact(m, deck)
      allocate (m%loads(0), m%boundaries(0))
      call set_up_bodies(m, deck, plans, error)
      deallocate (m%loads, m%boundaries)
      if (allocated(error)) return
      call set_up_conditions(m, deck, plans)
      call finish_contact(m, deck, plans)
      call problems(deck, error)
      call agree_on_error(m%comm, error)
      if (allocated(error)) return
      call count_all(m)
      call find_wave_speed(m)
      call find_fastest(m)
      call fresh_rows(m)
      do i = 1, size(m%cracks)
         call start_crack(m%cracks(i), m%comm, m%grid, m%particles)
      end do
      call set_up_fracture(m, deck)
      call set_up_growth(m, deck)
      call problems(deck, error)
      call agree_on_error(m%comm, error)
      if (allocated(error)) return
      call renew_level_sets(m, error)
      call agree_on_error(m%comm, error)
      if (allocated(error)) return
      if (size(m%cracks) > 0 .or. m%bodies_meet) call renew_splits(m, error)
      if (allocated(error)) return
      call start_ledger(m)
   end subroutine set_up

   !> Grid, shape function, scheme and options.
   subroutine set_up_method(m, deck)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(inout) :: deck
      type(block_t) :: grid, time, damping, health, partition
      integer :: shape

      grid = find_block(deck, 'grid', 1)
      time = find_block(deck, 'time', 1)
      damping = find_block(deck, 'damping', 1)
      health = find_block(deck, 'health', 1)
      partition = find_block(deck, 'partition', 1)
      shape = merge(gimp_shape, linear_shape, lower(text_of(grid, 'shape')) == 'gimp')
      m%grid = make_grid(real_of(grid, 'size'), reals_of(grid, 'origin'), shape)
      m%kernels = choose_kernels(shape)
      select case (lower(text_of(time, 'scheme')))
      case ('usf')
         m%take_step => step_usf
         m%options%strain_first = .true.
      case ('usl')
         m%take_step => step_usl
         m%options%strain_by_nodes = .true.
      case default
         m%take_step => step_musl
      end select
      associate (o => m%options)
         o%end_time = real_of(time, 'end')
         o%cfl = real_of(time, 'cfl')
         if (has(time, 'step')) o%fixed_step = real_of(time, 'step')
         if (has(time, 'steps')) o%most_steps = integer_of(time, 'steps')
         o%xpic = lower(text_of(time, 'transfer')) == 'xpic'
         o%sharp = lower(text_of(time, 'inertia')) == 'corrected'
         o%viscous = real_of(damping, 'viscous')
         o%pic = real_of(damping, 'pic')
         if (has(damping, 'until')) o%damped_until = real_of(damping, 'until')
         o%energy_limit = real_of(health, 'energy')
         o%smallest_step = real_of(health, 'smallest_step')
         o%imbalance = real_of(partition, 'imbalance')
      end associate
   end subroutine set_up_method
end module xmpm_setup
