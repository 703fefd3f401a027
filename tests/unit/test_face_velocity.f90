!> The faces of a crack move with the material of their side, also where rows of that side have no
!> mass or hardly any: in a body that turns they do not slip.
! ranks: 1 2 3
program test_face_velocity
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, max_all, sum_all
   use xmpm_deck, only: deck_t
   use xmpm_grid, only: node_position
   use xmpm_crack, only: advance_crack
   use xmpm_settle, only: renew_splits
   use xmpm_stages, only: map_to_grid
   use xmpm_model, only: model_t
   use small_model, only: make_model, disturb
   use testing, only: suite_t, check, check_close, check_no_error, finish
   implicit none
   real(wp), parameter :: shift = 3e-3_wp   !! of particles off their lattice, at most [cells]
   real(wp), parameter :: weak = 1e-3_wp    !! share of a node's mass that only corners of particles
                                            !! have
   !> A gradient of the order 1 on ways of up to half a cell, of which 1e-4 over the spread of the
   !> rows (0.02 cells^2 and more) is lost; and (`weak`/0.1)**2 of rows whose velocity is off by 1.
   !> If these counted in full, they would make 0.2.
   real(wp), parameter :: close = 0.01_wp
   type(comm_t) :: comm
   type(suite_t) :: suite

   call start_parallel(comm)
   suite%name = 'face velocity'
   call turn('linear', 'inclined', '0.41 along=1 -1 0 across=1 1 -2')
   call turn('gimp', 'inclined', '0.41 along=1 -1 0 across=1 1 -2')
   call turn('gimp', 'on the lattice', '0.2 along=1 0 0 across=0 1 0')
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> Rows move as a body that turns; those that corners alone reach lag behind.
   subroutine turn(shape, name, plane)
      character(len=*), intent(in) :: shape, name
      character(len=*), intent(in) :: plane   !! z of the centre and directions of the crack
      type(model_t) :: m
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      character(len=:), allocatable :: head
      real(wp) :: slip(1), off(1), number
      integer :: v

      head = shape//', '//name//': '
      call make_model(comm, '*JOB faces|*UNITS length=mm mass=g time=ms|*TIME end=1|' &
         //'*GRID size=1 shape='//shape//'|*MATERIAL alloy density=8 young=100 poisson=0.25|' &
         //'*BODY a material=alloy box=-6 -6 -6 6 6 6|*CRACK c disc centre=0.13 0.27 ' &
         //plane//' radius=3|', deck, m, error)
      call check_no_error(suite, head//'the deck is set up', error)
      call disturb(m, shift)
      call renew_splits(m, error)
      call check_no_error(suite, head//'nodes are split again', error)
      call map_to_grid(m)
      call set_velocities(m, number)
      if (name == 'on the lattice') call check(suite, &
         head//'corners of particles alone reach some rows', number > 20)
      call advance_crack(m%cracks(1), 1, m%grid, m%sided, 1.0_wp)
      slip = 0
      off = 0
      associate (s => m%cracks(1)%surface)
         do v = 1, s%vertex_count
            if (.not. m%cracks(1)%mine(v)) cycle
            slip = max(slip, norm2(s%up(:, v) - s%um(:, v)))
            off = max(off, norm2(s%up(:, v) - velocity(s%start(:, v))))
         end do
      end associate
      call max_all(comm, slip)
      call max_all(comm, off)
      call check_close(suite, head//'faces do not slip', slip(1), 0.0_wp, 2*close, 0.0_wp)
      call check_close(suite, head//'faces move with the material', off(1), 0.0_wp, close, 0.0_wp)
   end subroutine turn

   !> Of a body that turns.
   pure function velocity(x) result(v)
      real(wp), intent(in) :: x(3)
      real(wp) :: v(3)

      v = [0.3_wp*x(2) - 0.5_wp*x(3), 0.8_wp*x(3) - 0.3_wp*x(1), 0.5_wp*x(1) - 0.8_wp*x(2)]
   end function velocity

   !> Velocities of all rows; those that corners alone reach lag behind. Rows without mass have no
   !> velocity.
   subroutine set_velocities(m, number)
      type(model_t), intent(inout) :: m
      real(wp), intent(out) :: number   !! of rows that corners reach, of all ranks
      real(wp) :: share, total(1)
      integer :: i, k, pair(2)

      do i = 1, m%grid%n_rows
         m%grid%node(5:7, i) = velocity(node_position(m%grid, i))
      end do
      total = 0
      do i = m%grid%n_plain + 1, m%grid%n_rows
         pair = [m%grid%parent(i - m%grid%n_plain), i]
         if (.not. any(m%grid%node(1, pair) > 0)) cycle
         do k = 1, 2
            share = m%grid%node(1, pair(k))/sum(m%grid%node(1, pair))
            if (share > weak) cycle
            m%grid%node(5:7, pair(k)) = m%grid%node(5:7, pair(k)) + 1
            if (m%grid%mine(pair(1))) total = total + 1
         end do
      end do
      call sum_all(comm, total)
      number = total(1)
   end subroutine set_velocities
end program test_face_velocity
