!> The surface of a crack in a body that flies from rank to rank: its places, and with them its
!> front, are renewed at steps that do not depend on the ranks and at no others.
! ranks: 1 2 3
program test_crack
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, max_all
   use xmpm_deck, only: deck_t
   use xmpm_model, only: model_t
   use xmpm_settle, only: choose_step, settle
   use small_model, only: make_model
   use testing, only: suite_t, check, check_close, check_no_error, finish
   implicit none
   integer, parameter :: interval = 20   !! steps between renewals of the geometry
   type(suite_t) :: suite
   type(comm_t) :: comm

   call start_parallel(comm)
   suite%name = 'crack'
   call places_wait_for_geometry()
   call faces_part_far('linear')
   call faces_part_far('gimp')
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> 0.18 cells a step: the crack crosses three blocks in 60 steps.
   subroutine places_wait_for_geometry()
      type(deck_t) :: deck
      type(model_t) :: m
      type(error_t), allocatable :: error
      real(wp), allocatable :: x(:, :), start(:, :)
      logical, allocatable :: mine(:)
      real(wp) :: off, moved
      logical :: stays, together
      integer :: i

      call make_model(comm, '*JOB x|*UNITS length=mm mass=g time=ms|*GRID size=1|'// &
         '*MATERIAL a law=elastic density=1e-3 young=1 poisson=0.2|'// &
         '*BODY b material=a box=0 0 0 8 4 4 velocity=100 0 0|'// &
         '*CRACK c disc radius=1.3 centre=4.1 2.2 1.9 along=1 0 0.2 across=0 1 0|'// &
         '*TIME end=1 step=1.8e-3', deck, m, error)
      call check_no_error(suite, 'a body with a crack is set up', error)
      if (allocated(error)) return
      x = m%cracks(1)%surface%x
      start = x
      mine = m%cracks(1)%mine
      stays = .true.
      together = .true.
      moved = 0
      do i = 1, 3*interval
         call choose_step(m, 1.0_wp, error)
         call m%take_step(m, m%dt)
         call settle(m, error)
         if (allocated(error)) exit
         associate (crack => m%cracks(1))
            if (mod(i, interval) == 0) then
               x = crack%surface%x
               mine = crack%mine
            else
               if (any(mine .neqv. crack%mine)) moved = 1
               stays = stays .and. all(abs(crack%surface%x - x) <= 0)
            end if
            together = together .and. all(abs(crack%front%x &
               - crack%surface%x(:, crack%front%vertex)) <= 0)
         end associate
      end do
      call check_no_error(suite, 'the body flies', error)
      call max_all(comm, moved)
      call check(suite, 'vertices changed their rank in between, where there are several', &
         moved > 0.5_wp .or. comm%size == 1)
      call check(suite, 'places stay as they are between renewals', stays)
      call check(suite, 'the front is that of the surface', together)
      off = maxval(norm2(x - start - spread([100*m%time, 0.0_wp, 0.0_wp], 2, size(x, 2)), 1))
      ! rounding over 60 steps of a flight without stress
      call check_close(suite, 'the surface flew with the body', off, 0.0_wp, 1e-9_wp, 0.0_wp)
   end subroutine places_wait_for_geometry

   !> Halves that fly apart by one and a half cells: each face goes with its own half, also when it
   !> has left the cells in which nodes are split.
   subroutine faces_part_far(shape)
      character(len=*), intent(in) :: shape
      type(deck_t) :: deck
      type(model_t) :: m
      type(error_t), allocatable :: error
      real(wp) :: off
      integer :: i, v

      call make_model(comm, '*JOB x|*UNITS length=mm mass=g time=ms|*GRID size=1 shape='//shape// &
         '|*MATERIAL a law=elastic density=1e-3 young=1 poisson=0.2|'// &
         '*BODY a material=a box=0 0 0 6 6 2.5|'// &
         '*BODY b material=a box=0 0 2.5 6 6 5 velocity=0 0 10|'// &
         '*CRACK c rectangle centre=3 3 2.5 along=1 0 0 across=0 1 0 width=8 depth=8|'// &
         '*TIME end=1 step=5e-3', deck, m, error)
      call check_no_error(suite, shape//': two halves are set up', error)
      if (allocated(error)) return
      do i = 1, 30
         call choose_step(m, 1.0_wp, error)
         call m%take_step(m, m%dt)
         call settle(m, error)
         if (allocated(error)) exit
      end do
      call check_no_error(suite, shape//': they fly', error)
      off = 0
      associate (s => m%cracks(1)%surface)
         do v = 1, s%vertex_count
            if (.not. m%cracks(1)%mine(v)) cycle
            if (any(s%start(1:2, v) < 1 .or. s%start(1:2, v) > 5)) cycle
            off = max(off, norm2(s%up(:, v) - [0.0_wp, 0.0_wp, 1.5_wp]), norm2(s%um(:, v)))
         end do
      end associate
      call max_all(comm, off)
      ! rounding over 30 steps without stress
      call check_close(suite, shape//': each face has gone with its half', off, 0.0_wp, 1e-9_wp, &
         0.0_wp)
   end subroutine faces_part_far
end program test_crack
