!> Particle files come back by any number of ranks, and every fault in them is reported.
! ranks: 1 2 3
program test_particle_file
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t
   use xmpm_text, only: string_t, to_text
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, wait_for_all, sum_all
   use xmpm_hdf5_file, only: hdf5_file_t, create_file, close_file
   use xmpm_hdf5_write, only: write_dataset, write_attribute, write_texts, make_group
   use xmpm_particle_file, only: particle_data_t, particle_units_t, read_particles, &
      read_particle_set, particle_set_t
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none

   !> What stands in a file of the tests; a blank text leaves the item out.
   type :: content_t
      character(len=:), allocatable :: format, length, time
      integer(i8) :: version = 1
      real(wp), allocatable :: x(:, :), volume(:), velocity(:, :), area(:, :), offset(:, :)
      integer(i8), allocatable :: bodies(:), set(:)
      logical :: named = .true.
   end type content_t

   integer, parameter :: n = 10
   type(suite_t) :: suite
   type(comm_t) :: comm
   type(particle_units_t) :: units
   character(len=:), allocatable :: path

   call start_parallel(comm)
   suite%name = 'particle_file'
   units%length = 'mm'
   units%time = 'ms'
   path = 'test_particles_'//to_text(comm%size)//'.h5'
   call test_whole()
   call test_part()
   call test_plain()
   call test_sets()
   call test_header_faults()
   call test_shape_faults()
   call test_value_faults()
   call test_name_faults()
   call test_set_faults()
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> A right file: particle i stands at (i, 2i, 3i), with volume i + 1; odd ones are body 1.
   function right_content() result(c)
      type(content_t) :: c
      integer :: i

      c%format = 'xmpm3d particles'
      c%length = 'mm'
      c%time = 'ms'
      allocate (c%x(3, n), c%velocity(3, n), c%volume(n), c%bodies(n))
      do i = 1, n
         c%x(:, i) = real(i - 1, wp)*[1.0_wp, 2.0_wp, 3.0_wp]
         c%volume(i) = real(i, wp)
         c%bodies(i) = modulo(int(i - 1, i8), 2_i8)
      end do
      c%velocity = -c%x
      allocate (c%set(2), source=[7_i8, 3_i8])
      allocate (c%area(3, 2), source=reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp], &
         [3, 2]))
   end function right_content

   !> Rank 0 writes a file; the others wait for it.
   subroutine write_file(c)
      type(content_t), intent(in) :: c
      type(hdf5_file_t) :: file
      type(error_t), allocatable :: error

      call wait_for_all(comm)
      if (comm%rank == 0) then
         call create_file(file, path, error)
         if (len(c%format) > 0) call write_attribute(file, '/', 'format', c%format)
         if (len(c%length) > 0) call write_attribute(file, '/', 'length_unit', c%length)
         if (len(c%time) > 0) call write_attribute(file, '/', 'time_unit', c%time)
         call write_attribute(file, '/', 'version', c%version)
         if (allocated(c%x)) call write_dataset(file, 'positions', c%x)
         if (allocated(c%volume)) call write_dataset(file, 'volumes', c%volume)
         if (allocated(c%velocity)) call write_dataset(file, 'velocities', c%velocity)
         if (allocated(c%bodies)) call write_dataset(file, 'bodies', c%bodies)
         if (c%named) call write_texts(file, 'body_names', [string_t('plate'), string_t('rod')])
         call make_group(file, 'sets/top')
         if (allocated(c%set)) call write_dataset(file, 'sets/top/particles', c%set)
         if (allocated(c%area)) call write_dataset(file, 'sets/top/areas', c%area)
         if (allocated(c%offset)) call write_dataset(file, 'sets/top/offsets', c%offset)
         call close_file(file, error)
         call check_no_error(suite, 'a file of the tests is written', error)
      end if
      call wait_for_all(comm)
   end subroutine write_file

   !> Whether all particles of this rank are those of the file at their places.
   function all_right(data, moving) result(right)
      type(particle_data_t), intent(in) :: data
      logical, intent(in) :: moving
      logical :: right
      real(wp) :: place
      integer :: i

      right = size(data%x, 2) == size(data%place) .and. size(data%volume) == size(data%place)
      right = right .and. size(data%velocity, 2) == merge(size(data%place), 0, moving)
      if (.not. right) return
      do i = 1, size(data%place)
         place = real(data%place(i), wp)
         right = right .and. all(abs(data%x(:, i) - place*[1.0_wp, 2.0_wp, 3.0_wp]) <= 0.0_wp) &
            .and. abs(data%volume(i) - place - 1.0_wp) <= 0.0_wp
         if (moving) right = right .and. all(abs(data%velocity(:, i) + data%x(:, i)) <= 0.0_wp)
      end do
   end function all_right

   subroutine test_whole()
      type(particle_data_t) :: data
      type(error_t), allocatable :: error
      integer(i8) :: count

      call write_file(right_content())
      call read_particles(path, '', units, comm, data, error)
      call check_no_error(suite, 'a right file is read', error)
      call check(suite, 'every particle is as it was written', all_right(data, .true.))
      call check(suite, 'the file tells how many particles it has', data%total == n)
      count = size(data%volume, kind=i8)
      call check(suite, 'ranks share the particles evenly', &
         abs(int(count) - n/comm%size) <= 1)
      call sum_all(comm, count)
      call check(suite, 'and together have all of them', count == n)
   end subroutine test_whole

   subroutine test_part()
      type(particle_data_t) :: data
      type(error_t), allocatable :: error
      integer(i8) :: count

      call read_particles(path, 'rod', units, comm, data, error)
      call check_no_error(suite, 'one body is read', error)
      call check(suite, 'its particles are as they were written', all_right(data, .true.))
      call check(suite, 'they are those of this body', all(modulo(data%place, 2_i8) == 1))
      count = size(data%volume, kind=i8)
      call sum_all(comm, count)
      call check(suite, 'and all of them', count == n/2)
   end subroutine test_part

   !> Bodies, velocities and the unit of time may be missing.
   subroutine test_plain()
      type(particle_data_t) :: data
      type(error_t), allocatable :: error
      type(content_t) :: c

      c = right_content()
      deallocate (c%bodies, c%velocity)
      c%named = .false.
      c%time = ''
      call write_file(c)
      call read_particles(path, '', units, comm, data, error)
      call check_no_error(suite, 'positions and volumes are enough', error)
      call check(suite, 'particles at rest are as they were written', all_right(data, .false.))
      call read_particles(path, 'rod', units, comm, data, error)
      call check_error(suite, 'a body of a file without bodies', error, &
         path//": there is no body 'rod'; body_names are: none")
   end subroutine test_plain

   subroutine test_sets()
      type(error_t), allocatable :: error
      type(content_t) :: c
      type(particle_set_t) :: set

      c = right_content()
      call write_file(c)
      call read_particle_set(path, 'top', units, comm, set, error)
      call check_no_error(suite, 'a set is read', error)
      call check(suite, 'every rank has the whole set', all(set%place == c%set))
      call check(suite, 'with its areas', all(abs(set%area - c%area) <= 0.0_wp))
      call check(suite, 'offsets that are not there are none', size(set%offset) == 0)
      allocate (c%offset, source=0.25_wp*c%area)
      call write_file(c)
      call read_particle_set(path, 'top', units, comm, set, error)
      call check(suite, 'offsets are read', all(abs(set%offset - c%offset) <= 0.0_wp))
      deallocate (c%area, c%offset)
      call write_file(c)
      call read_particle_set(path, 'top', units, comm, set, error)
      call check_no_error(suite, 'a set without areas is read', error)
      call check(suite, 'and has none', size(set%place) == 2 .and. size(set%area) == 0)
   end subroutine test_sets

   !> Write a file, read it, and look for a message.
   subroutine expect(c, message, part)
      type(content_t), intent(in) :: c
      character(len=*), intent(in) :: message
      character(len=*), intent(in), optional :: part
      type(particle_data_t) :: data
      type(error_t), allocatable :: error

      call write_file(c)
      if (present(part)) then
         call read_particles(path, part, units, comm, data, error)
      else
         call read_particles(path, '', units, comm, data, error)
      end if
      call check_error(suite, 'a wrong file is refused', error, message)
   end subroutine expect

   subroutine test_header_faults()
      type(content_t) :: c
      type(particle_data_t) :: data
      type(error_t), allocatable :: error

      c = right_content()
      c%format = ''
      call expect(c, path//': the attribute format of / is missing')
      c%format = 'holiday pictures'
      call expect(c, path//": the format is 'holiday pictures' instead of 'xmpm3d particles'")
      c = right_content()
      c%version = 2
      call expect(c, 'the format has version 2; this program reads version 1')
      c = right_content()
      c%length = 'm'
      call expect(c, "the length_unit is 'm', that of the deck is 'mm'; nothing is converted")
      c%length = ''
      call expect(c, 'the attribute length_unit of / is missing')
      c = right_content()
      c%time = 's'
      call expect(c, "the time_unit is 's', that of the deck is 'ms'")
      c%time = ''
      call expect(c, 'the attribute time_unit of / is missing')
      call read_particles('no_such_file.h5', '', units, comm, data, error)
      call check_error(suite, 'a missing file', error, 'no_such_file.h5: no such file')
   end subroutine test_header_faults

   subroutine test_shape_faults()
      type(content_t) :: c

      c = right_content()
      deallocate (c%x)
      call expect(c, 'the dataset positions is missing')
      c%x = reshape([0.0_wp, 0.0_wp], [2, 1])
      call expect(c, &
         'the dataset positions has shape (1,2) instead of (10,3), n being that of volumes')
      c = right_content()
      deallocate (c%volume)
      call expect(c, 'the dataset volumes is missing')
      allocate (c%volume(0))
      call expect(c, 'the dataset volumes is empty: there are no particles')
      c = right_content()
      c%velocity = c%velocity(:, :9)
      call expect(c, 'the dataset velocities has shape (9,3) instead of (10,3)')
      c = right_content()
      c%bodies = c%bodies(:4)
      call expect(c, 'the dataset bodies has shape (4) instead of (10)')
      call expect_flat_volumes()
   end subroutine test_shape_faults

   !> Volumes as a table instead of a list.
   subroutine expect_flat_volumes()
      type(content_t) :: c
      type(hdf5_file_t) :: file
      type(error_t), allocatable :: error
      type(particle_data_t) :: data

      call wait_for_all(comm)
      c = right_content()
      if (comm%rank == 0) then
         call create_file(file, path, error)
         call write_attribute(file, '/', 'format', c%format)
         call write_attribute(file, '/', 'length_unit', c%length)
         call write_attribute(file, '/', 'version', c%version)
         call write_dataset(file, 'volumes', c%x)
         call close_file(file, error)
      end if
      call wait_for_all(comm)
      call read_particles(path, '', units, comm, data, error)
      call check_error(suite, 'volumes as a table', error, &
         'the dataset volumes has shape (10,3) instead of (n)')
   end subroutine expect_flat_volumes

   !> One wrong number on one rank is everyone's failure.
   subroutine test_value_faults()
      type(content_t) :: c
      real(wp) :: nan

      nan = ieee_value(nan, ieee_quiet_nan)
      c = right_content()
      c%volume(9) = -2.0_wp
      call expect(c, path//': volumes[8] is -2; it must be positive')
      c%volume(9) = nan
      call expect(c, path//': volumes[8] is not finite')
      c = right_content()
      c%x(2, 4) = nan
      call expect(c, 'positions[3] is not finite')
      c = right_content()
      c%velocity(3, 1) = nan
      call expect(c, 'velocities[0] is not finite')
   end subroutine test_value_faults

   subroutine test_name_faults()
      type(content_t) :: c

      c = right_content()
      call expect(c, path//": there is no body 'wheel'; body_names are: plate, rod", 'wheel')
      c%bodies(10) = 2
      call expect(c, 'bodies[9] is 2, but there are 2 body_names')
      c%bodies(10) = -1
      call expect(c, 'bodies[9] is -1, but there are 2 body_names')
      c%named = .false.
      call expect(c, 'the dataset body_names is missing')
   end subroutine test_name_faults

   subroutine test_set_faults()
      type(content_t) :: c

      c = right_content()
      call expect_set(c, 'side', "there is no set 'side' (no dataset sets/side/particles)")
      c%set(2) = 10
      call expect_set(c, 'top', 'sets/top/particles[1] is 10, but particles are 0 to 9')
      c%set(2) = -1
      call expect_set(c, 'top', 'sets/top/particles[1] is -1, but particles are 0 to 9')
      c = right_content()
      c%area(1, 1) = ieee_value(1.0_wp, ieee_quiet_nan)
      call expect_set(c, 'top', 'sets/top/areas[0] is not finite')
      c%area = c%area(:2, :)
      call expect_set(c, 'top', 'the dataset sets/top/areas has shape (2,2) instead of (2,3)')
      c = right_content()
      allocate (c%offset(3, 3), source=0.0_wp)
      call expect_set(c, 'top', 'the dataset sets/top/offsets has shape (3,3) instead of (2,3)')
      c%length = 'km'
      call expect_set(c, 'top', "the length_unit is 'km', that of the deck is 'mm'")
   end subroutine test_set_faults

   subroutine expect_set(c, name, message)
      type(content_t), intent(in) :: c
      character(len=*), intent(in) :: name, message
      type(error_t), allocatable :: error
      type(particle_set_t) :: set

      call write_file(c)
      call read_particle_set(path, name, units, comm, set, error)
      call check_error(suite, 'a wrong set is refused', error, message)
   end subroutine expect_set
end program test_particle_file
