! ranks: 1 3
!> Requests for fracture parameters: what is refused, which points there are, what is flagged.
program test_fracture
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel
   use xmpm_deck, only: deck_t
   use xmpm_model, only: model_t
   use xmpm_stages, only: measure_fronts
   use xmpm_front_values, only: flag_end, flag_held, flag_smaller, flag_leaves, flag_other
   use small_model, only: make_model
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none
   character(len=*), parameter :: start = '*JOB t|*UNITS length = mm, mass = g, time = ms|'// &
      '*GRID size = 1|*MATERIAL steel|density = 7.9e-3, young = 200e3, poisson = 0.3|'// &
      '*TIME end = 1e-3|'
   character(len=*), parameter :: plate = '*BODY plate|material = steel, '// &
      'box = -16 -12 -2 16 12 2, stress = 0 50 0 0 0 0|'
   character(len=*), parameter :: slit = '*CRACK slit|rectangle, centre = 0 0 0, '// &
      'along = 1 0 0, width = 10, across = 0 0 1, depth = 6|'
   character(len=*), parameter :: cut = '*CRACK cut|rectangle, centre = 0 8 0, '// &
      'along = 1 0 0, width = 80, across = 0 0 1, depth = 6|'
   type(suite_t) :: suite
   type(comm_t) :: comm

   suite%name = 'fracture'
   call start_parallel(comm)
   call refused()
   call through_crack()
   call room_kept()
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> Requests that cannot be met name what is wrong and what is possible.
   subroutine refused()
      call refuse(start//plate//slit//'*FRACTURE', "one of the keys 'every' and 'at'")
      call refuse(start//plate//'*FRACTURE every = 1', 'there is no *CRACK')
      call refuse(start//plate//slit//'*FRACTURE every = 1, cracks = slti', "'slit'")
      call refuse(start//plate//cut//'*FRACTURE every = 1, cracks = cut', 'has no front')
      call refuse(start//plate//cut//'*FRACTURE every = 1', 'no crack of this deck has a front')
      call refuse(start//plate//slit//'*FRACTURE every = 1, radii = 1.2 3', 'at least 2 cells')
      call refuse(start//plate//slit//'*FRACTURE every = 1, radii = 4 3', &
         'the radii must grow from one')
      call refuse(start//plate//slit//'*FRACTURE every = 1, methods = paper paper', &
         "the method 'paper' is named twice")
      call refuse(start//plate//slit//'*FRACTURE every = 1, radii = 3 40', 'larger than the bodies')
   end subroutine refused

   subroutine refuse(text, part)
      character(len=*), intent(in) :: text, part
      type(deck_t) :: deck
      type(model_t) :: m
      type(error_t), allocatable :: error

      call make_model(comm, text, deck, m, error)
      call check_error(suite, 'refused', error, part)
   end subroutine refuse

   !> Two fronts of a slit that goes through a plate: points, frames, ends, flags.
   subroutine through_crack()
      type(deck_t) :: deck
      type(model_t) :: m
      type(error_t), allocatable :: error
      integer :: i

      call make_model(comm, start//plate//slit//'*BOUNDARY b|plane = x 16, type = fixed|'// &
         '*FRACTURE every = 1, radii = 3 4 12.5', deck, m, error)
      call check_no_error(suite, 'the plate', error)
      call measure_fronts(m)
      associate (v => m%fracture%values(1))
         call check(suite, 'the slit has two fronts', maxval(v%points%chain) == 2)
         ! nodes of a crack 6 deep stand at -3, -2 .. 3; the last lie outside and are brought back
         call check_close(suite, 'fronts end at the faces of the plate', &
            maxval(abs(v%points%x(3, :))), 2.0_wp, 1e-12_wp, 0.0_wp)
         do i = 1, v%points%n
            call check_close(suite, 'e1 points ahead', &
               v%points%frame(1, 1, i)*sign(1.0_wp, v%points%x(1, i)), 1.0_wp, 1e-12_wp, 0.0_wp)
            call check(suite, 'ends are marked', (iand(v%flags(i), flag_end) > 0) .eqv. &
               (abs(abs(v%points%x(3, i)) - 2) < 1e-9_wp))
            call check(suite, 'the largest domain does not fit into the plate', &
               iand(v%flags(i), flag_smaller) > 0 .and. iand(v%flags(i), flag_leaves) == 0)
            call check_close(suite, 'the next one does', v%radius(i), 4.0_wp, 0.0_wp, 1e-12_wp)
            call check(suite, 'no other crack is near, and the held side is 11 away', &
               iand(v%flags(i), flag_other + flag_held) == 0)
         end do
         ! before the first step the field is uniform: what J has of it is quadrature
         call check(suite, 'J of a uniform field is small', &
            maxval(abs(v%j)) < 0.02_wp*50.0_wp**2/200e3_wp)
      end associate
      call check(suite, 'the grid serves the next step', m%mapped)
   end subroutine through_crack

   !> The room for samples stays from one evaluation to the next: a smaller domain and then a larger
   !> one have the values that they have by themselves.
   subroutine room_kept()
      type(deck_t) :: deck
      type(model_t) :: m
      type(error_t), allocatable :: error
      real(wp), allocatable :: alone(:, :)
      integer :: before

      call make_model(comm, start//plate//slit//'*FRACTURE every = 1, radii = 3 4', deck, m, error)
      call check_no_error(suite, 'the plate', error)
      call measure_fronts(m)
      associate (f => m%fracture)
         alone = all_of(m)
         before = size(f%room)
         f%shape%radius = 0.7_wp*f%shape%radius
         call measure_fronts(m)
         call check(suite, 'fewer samples take the same room', size(f%room) == before)
         call check(suite, 'another radius gives other values', any(abs(all_of(m) - alone) > 0))
         f%shape%radius = [3.0_wp, 4.0_wp]
         call measure_fronts(m)
         call check(suite, 'what stood there before does not matter', &
            .not. any(abs(all_of(m) - alone) > 0))
         deallocate (f%room)
         allocate (f%room(1))
         call measure_fronts(m)
         call check(suite, 'room that is too small is renewed', &
            .not. any(abs(all_of(m) - alone) > 0))
      end associate
   end subroutine room_kept

   !> J, K and T of all points.
   function all_of(m) result(values)
      type(model_t), intent(in) :: m
      real(wp), allocatable :: values(:, :)

      associate (v => m%fracture%values(1))
         allocate (values(5, v%points%n))
         values(1, :) = v%j
         values(2:4, :) = v%k
         values(5, :) = v%t
      end associate
   end function all_of
end program test_fracture
