!> Conditions on nodes: what they prescribe, what they leave alone, their reaction and work.
! ranks: 1 2
program test_boundary
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, sum_all
   use xmpm_deck, only: deck_t
   use xmpm_grid, only: node_position
   use xmpm_stages, only: map_to_grid, advance_nodes
   use xmpm_model, only: model_t
   use small_model, only: make_model
   use testing, only: suite_t, check, check_close, check_no_error, finish
   implicit none
   character(len=*), parameter :: base = '*JOB b|*UNITS length=mm mass=g time=ms|*GRID size=1|' &
      //'*TIME end=1|*MATERIAL alloy density=2 young=100 poisson=0.25|' &
      //'*BODY a material=alloy box=0 0 0 6 4 3 particles=2 velocity=1 2 3|'
   real(wp), parameter :: momentum(3) = 2*6*4*3*[1.0_wp, 2.0_wp, 3.0_wp]
   type(comm_t) :: comm
   type(suite_t) :: suite

   call start_parallel(comm)
   suite%name = 'boundary'
   call try('fixed', '*BOUNDARY plane=x 0 type=fixed|', 0.0_wp, [.true., .true., .true.], &
      [0.0_wp, 0.0_wp, 0.0_wp])
   call try('roller', '*BOUNDARY plane=x 0 type=roller|', 0.0_wp, [.true., .false., .false.], &
      [0.0_wp, 0.0_wp, 0.0_wp])
   call try('velocity', '*BOUNDARY plane=x 0 type=velocity components=yz value=5 -6|', 0.0_wp, &
      [.false., .true., .true.], [0.0_wp, 5.0_wp, -6.0_wp])
   call try('box', '*BOUNDARY box=-1 -1 -1 2 9 9 type=fixed|', 2.0_wp, [.true., .true., .true.], &
      [0.0_wp, 0.0_wp, 0.0_wp])
   call try('roller in a box', '*BOUNDARY box=-1 -1 -1 2 9 9 type=roller components=xz|', 2.0_wp, &
      [.true., .false., .true.], [0.0_wp, 0.0_wp, 0.0_wp])
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> One nodal update of a free-flying block with a condition on the nodes up to x = edge.
   subroutine try(name, text, edge, holds, value)
      character(len=*), intent(in) :: name, text
      real(wp), intent(in) :: edge, value(3)
      logical, intent(in) :: holds(3)
      type(model_t) :: m
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      real(wp) :: v(3), p(3), worst, others, sums(7), exact(3)
      integer :: i

      call make_model(comm, base//text, deck, m, error)
      call check_no_error(suite, name//': the deck is set up', error)
      if (allocated(error)) return
      m%dt = 0.01_wp
      call map_to_grid(m)
      call advance_nodes(m, m%dt)
      worst = 0
      others = 0
      p = 0
      do i = 1, m%grid%n_rows
         if (.not. m%grid%node(1, i) > 0) cycle
         v = m%grid%node(2:4, i)
         if (m%grid%mine(i)) p = p + m%grid%node(1, i)*v
         exact = [1.0_wp, 2.0_wp, 3.0_wp]
         associate (x => node_position(m%grid, i))
            if (x(1) <= edge + 1e-9_wp) where (holds) exact = value
            if (x(1) <= edge + 1e-9_wp) then
               worst = max(worst, maxval(abs(v - exact)))
            else
               others = max(others, maxval(abs(v - exact)))
            end if
         end associate
      end do
      sums = [p, m%boundaries(1)%reaction, m%boundaries(1)%work]
      call sum_all(comm, sums)
      ! Rounding of p/m with values up to 6.
      call check_close(suite, name//': nodes move as prescribed', worst, 0.0_wp, 1e-14_wp, 0.0_wp)
      call check_close(suite, name//': other nodes move on', others, 0.0_wp, 1e-14_wp, 0.0_wp)
      ! Sums of some hundred nodes of 300 at most.
      call check_close(suite, name//': the reaction is the change of momentum', &
         maxval(abs(sums(:3) - momentum - m%dt*sums(4:6))), 0.0_wp, 1e-10_wp, 0.0_wp)
      call check(suite, name//': what stops a body takes energy', name == 'velocity' &
         .or. sums(7) < 0)
   end subroutine try
end program test_boundary
