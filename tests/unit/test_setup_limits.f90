!> What set-up refuses: more than it can tell apart, faces and planes that are not there.
program test_setup_limits
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_text, only: to_text
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel
   use xmpm_deck, only: deck_t
   use xmpm_model, only: model_t
   use xmpm_file_system, only: rename_file
   use small_model, only: make_model
   use testing, only: suite_t, check_error, finish
   implicit none
   character(len=*), parameter :: head = '*JOB t|*UNITS length=mm mass=g time=ms|*GRID size=1|' &
      //'*TIME end=1|*MATERIAL soft density=2 young=100 poisson=0.25|'
   character(len=*), parameter :: beam = '*BODY beam material=soft box=0 0 0 4 2 2|'
   type(suite_t) :: suite
   type(comm_t) :: comm

   suite%name = 'setup_limits'
   call start_parallel(comm)
   call too_many_of_a_kind()
   call too_many_at_one_place()
   call faces_and_conditions()
   call files()
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> Sets, faces and bodies have a bit or a number each.
   subroutine too_many_of_a_kind()
      character(len=:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, 64
         text = text//'*LOAD face=beam:+x pressure='//to_text(i)//'|'
      end do
      call refuse(beam//text, 'more than 63 sets and loaded faces')
      text = ''
      do i = 1, 32
         text = text//cube(i, [2*i, 0, 0])
      end do
      call refuse(text//'*CONTACT bodies=all', ' bodies that meet')
   end subroutine too_many_of_a_kind

   !> A bin tells three cracks apart, bodies that meet among them.
   subroutine too_many_at_one_place()
      character(len=:), allocatable :: text
      integer :: i

      text = ''
      do i = 0, 4
         text = text//cube(i, [mod(i, 2), mod(i/2, 2), i/4])
      end do
      call refuse(text//'*CONTACT bodies=all', 'meet at the grid node')
      text = ''
      do i = 0, 8
         text = text//cube(i, [mod(i, 3), i/3, 0])
      end do
      call refuse(text//'*CONTACT bodies=all', 'pass through the cells')
      text = ''
      do i = 1, 4
         text = text//'*CRACK c'//to_text(i)//' disc centre=2 1 '//to_text(0.7_wp &
            + 0.2_wp*real(i, wp))//' along=1 0 0 across=0 1 0 radius=0.8|'
      end do
      call refuse(beam//text, 'cracks are near the particle')
   end subroutine too_many_at_one_place

   !> A body that is a cell.
   function cube(number, at) result(text)
      integer, intent(in) :: number, at(3)
      character(len=:), allocatable :: text
      integer :: d

      text = '*BODY b'//to_text(number)//' material=soft box='
      do d = 1, 3
         text = text//to_text(at(d))//' '
      end do
      do d = 1, 3
         text = text//to_text(at(d) + 1)//' '
      end do
      text = text//'|'
   end function cube

   subroutine faces_and_conditions()
      call refuse('*BODY pipe material=soft tube=0 0 0 0 0 4 1 2 cylinder=0 0 0 0 0 4 1.5|' &
         //'*LOAD face=pipe:inside pressure=1', 'no particle of the body lies at its face')
      call refuse('*BODY ball material=soft sphere=0 0 0 2|*LOAD face=ball:+x pressure=1', &
         'the body has no face +x; it has: side')
      call refuse(beam//'*BOUNDARY plane=x 0.3 type=fixed', &
         'the plane is not one of grid nodes; the nearest is')
      call refuse('*CRACK c disc centre=2 1 1 along=1 0 0 across=0 1 0 radius=0.5|' &
         //'*CRACK d disc centre=2 1 1.4 along=1 0 0 across=0 1 0 radius=0.5|'//beam &
         //'*FRACTURE every=1 cracks=c|*GROWTH cracks=d law=running toughness=1', &
         'grows by its K, but *FRACTURE does not look at it')
   end subroutine faces_and_conditions

   subroutine refuse(text, part)
      character(len=*), intent(in) :: text, part
      type(deck_t) :: deck
      type(model_t) :: m
      type(error_t), allocatable :: error

      call make_model(comm, head//text, deck, m, error)
      call check_error(suite, 'an error says: '//part, error, part)
   end subroutine refuse

   subroutine files()
      type(error_t), allocatable :: error

      call rename_file('no_such_file', 'another', error)
      call check_error(suite, 'a file that is not there', error, &
         'no_such_file: cannot be renamed to another')
   end subroutine files
end program test_setup_limits
