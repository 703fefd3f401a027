! ranks: 1 3
!> What the grid resolves of fields that particles carry: smooth fields stay, what no node sees
!> goes, and the sides of a crack do not mix.
program test_resolved
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel
   use xmpm_deck, only: deck_t
   use xmpm_model, only: model_t
   use xmpm_storage, only: lanes, c_x
   use xmpm_resolved, only: resolve_fields
   use small_model, only: make_model
   use testing, only: suite_t, check, check_close, check_no_error, finish
   implicit none
   character(len=*), parameter :: start = '*JOB t|*UNITS length = mm, mass = g, time = ms|'// &
      '*MATERIAL steel|density = 7.9e-3, young = 200e3, poisson = 0.3|'// &
      '*BODY block|material = steel, box = -8 -6 -6 8 6 6|*TIME end = 1e-3|'
   character(len=*), parameter :: slit = '*CRACK slit|rectangle, centre = -8.5 0 0.2, '// &
      'along = 1 0 0, width = 17, across = 0 1 0, depth = 14|'
   type(suite_t) :: suite
   type(comm_t) :: comm

   suite%name = 'resolved'
   call start_parallel(comm)
   call without_crack('linear')
   call without_crack('gimp')
   call beside_crack()
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> A parabola stays as it is inside, a sign that changes from particle to particle goes.
   subroutine without_crack(shape)
      character(len=*), intent(in) :: shape
      type(model_t) :: m
      real(wp), allocatable :: before(:, :, :), after(:, :, :)
      real(wp) :: x(3), worst(3)
      integer, allocatable :: chunks(:)
      integer :: k, i

      call fill_model(start//'*GRID size = 1, shape = '//shape, m, chunks)
      allocate (before(lanes, 3, size(chunks)), source=0.0_wp)
      do k = 1, size(chunks)
         do i = 1, m%particles%count(chunks(k))
            x = m%particles%q(i, c_x:c_x + 2, chunks(k))
            before(i, 1, k) = 1 + x(1)*x(2) - 0.3_wp*x(3)**2 + 0.2_wp*x(1)**2
            ! particles stand at quarters of the cells: one goes up, the next one down
            before(i, 2, k) = real(1 - 2*modulo(floor(2*x(3)), 2), wp)
            before(i, 3, k) = before(i, 2, k)*real(1 - 2*modulo(floor(2*x(1)), 2), wp)
         end do
      end do
      after = before
      call resolve(m, chunks, after)
      worst = 0
      do k = 1, size(chunks)
         do i = 1, m%particles%count(chunks(k))
            x = m%particles%q(i, c_x:c_x + 2, chunks(k))
            if (any(abs(x) > [5.0_wp, 3.0_wp, 3.0_wp])) cycle   ! faces reach three cells in
            worst(1) = max(worst(1), abs(after(i, 1, k) - before(i, 1, k)))
            worst(2:3) = max(worst(2:3), abs(after(i, 2:3, k)))
         end do
      end do
      call check_close(suite, shape//': a parabola stays', worst(1), 0.0_wp, 1e-12_wp, 0.0_wp)
      ! linear: S halves such a wave and 2 S - S S keeps 3/4 of it to the power of directions; GIMP
      ! of particles as wide as the wave is long sees nothing of it
      call check(suite, shape//': a wave in one direction is damped', worst(2) < 0.5_wp)
      call check(suite, shape//': one in two directions more so', worst(3) < 0.25_wp)
   end subroutine without_crack

   !> Constants on both sides of a crack stay what they are.
   subroutine beside_crack()
      type(model_t) :: m
      real(wp), allocatable :: values(:, :, :)
      real(wp) :: x(3), worst
      integer, allocatable :: chunks(:)
      integer :: k, i

      call fill_model(start//'*GRID size = 1|'//slit, m, chunks)
      allocate (values(lanes, 3, size(chunks)), source=0.0_wp)
      do k = 1, size(chunks)
         values(:, 1, k) = sign(1.0_wp, m%particles%q(:, c_x + 2, chunks(k)) - 0.2_wp)
      end do
      call resolve(m, chunks, values)
      worst = 0
      do k = 1, size(chunks)
         do i = 1, m%particles%count(chunks(k))
            x = m%particles%q(i, c_x:c_x + 2, chunks(k))
            if (x(1) > -4) cycle   ! the front is at 0
            worst = max(worst, abs(values(i, 1, k) - sign(1.0_wp, x(3) - 0.2_wp)))
         end do
      end do
      call check_close(suite, 'the sides of a crack do not mix', worst, 0.0_wp, 1e-12_wp, 0.0_wp)
   end subroutine beside_crack

   subroutine fill_model(text, m, chunks)
      character(len=*), intent(in) :: text
      type(model_t), intent(out) :: m
      integer, allocatable, intent(out) :: chunks(:)   !! all with particles
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      integer :: c

      call make_model(comm, text, deck, m, error)
      call check_no_error(suite, 'the model', error)
      chunks = pack([(c, c=1, m%particles%n_chunks)], &
         m%particles%count(:m%particles%n_chunks) > 0)
   end subroutine fill_model

   subroutine resolve(m, chunks, values)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: chunks(:)
      real(wp), intent(inout) :: values(:, :, :)

      call resolve_fields(chunks, m%comm, m%halo, m%grid, m%particles, m%bodies, m%kernels, &
         m%sided, values)
   end subroutine resolve
end program test_resolved
