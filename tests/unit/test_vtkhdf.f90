!> Time series for ParaView: counts and offsets of the master fit the steps, on any number of ranks.
!>
!> tests/python/test_vtkhdf.py opens the files that this program leaves behind with VTK.
! ranks: 1 2 3
program test_vtkhdf
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t
   use xmpm_text, only: to_text
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, wait_for_all
   use xmpm_file_system, only: file_exists
   use xmpm_hdf5_file, only: hdf5_file_t, open_file, close_file
   use xmpm_hdf5_read, only: read_dataset, read_attribute, extent_of
   use xmpm_provenance, only: provenance_t, start_provenance
   use xmpm_vtkhdf, only: surface_t, new_field
   use xmpm_output_series, only: series_t, open_series, write_particles, write_surface
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none
   type(comm_t) :: comm
   type(suite_t) :: suite
   type(provenance_t) :: provenance
   character(len=:), allocatable :: name

   call start_parallel(comm)
   suite%name = 'vtkhdf'
   name = 'series'//to_text(comm%size)
   call start_provenance(provenance, comm)
   provenance%version = '0.0.0'
   provenance%job = name
   call test_particles(suite, comm, name//'_particles')
   call test_surface(suite, comm, name//'_crack')
   call test_failure(suite, comm)
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> Steps of 4, 7, 0 and 2 particles, dealt out to the ranks in turn.
   subroutine test_particles(suite, comm, name)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      character(len=*), intent(in) :: name
      integer, parameter :: counts(4) = [4, 7, 0, 2]
      type(series_t) :: series
      type(error_t), allocatable :: error
      integer :: i

      call open_series(series, comm, 'results', name, error)
      call check_no_error(suite, 'the folder of a series is made', error)
      do i = 1, 4
         call write_step(series, comm, 0.5_wp*real(i - 1, wp), counts(i), error)
         call check_no_error(suite, 'step '//to_text(i)//' is written', error)
      end do
      call check_master(suite, 'results/'//name//'.vtkhdf')
      call check(suite, 'no temporary master is left', &
         .not. file_exists('results/'//name//'.vtkhdf.part'))
      call check(suite, 'no temporary step is left', &
         .not. file_exists('results/'//name//'/'//name//'_000000.vtkhdf.part'))
      call wait_for_all(comm)
      call open_series(series, comm, 'results/', name, error)
      call check(suite, 'a new run removes the old steps', &
         .not. file_exists('results/'//name//'/'//name//'_000003.vtkhdf'))
      call wait_for_all(comm)
      do i = 1, 4
         call write_step(series, comm, 0.5_wp*real(i - 1, wp), counts(i), error)
      end do
      call check_no_error(suite, 'a new run writes its own', error)
   end subroutine test_particles

   !> Particle k is at (k, time, -k), with its number as displacement and stress.
   subroutine write_step(series, comm, time, count, error)
      type(series_t), intent(inout) :: series
      type(comm_t), intent(in) :: comm
      real(wp), intent(in) :: time
      integer, intent(in) :: count
      type(error_t), allocatable, intent(out) :: error
      integer(i8), allocatable :: ids(:)
      real(wp), allocatable :: x(:), points(:, :)
      integer :: k, n

      n = (count + comm%size - 1 - comm%rank)/comm%size
      allocate (ids(n), x(n), points(3, n))
      ids(:) = [(int(comm%rank + (k - 1)*comm%size, i8), k=1, n)]
      x(:) = real(ids, wp)
      points(1, :) = x
      points(2, :) = time
      points(3, :) = -x
      call write_particles(series, comm, time, provenance, points, [ &
         new_field('id', '1', ids), &
         new_field('displacement', 'mm', points), &
         new_field('stress', 'MPa', spread(x, 1, 6)), &
         new_field('energy', 'mJ', 1.0e300_wp*x), &
         new_field('psi', 'mm', x/3, double=.true.)], error)
   end subroutine write_step

   subroutine check_master(suite, path)
      type(suite_t), intent(inout) :: suite
      character(len=*), intent(in) :: path
      character(len=*), parameter :: steps = 'VTKHDF/Steps/', fields = 'VTKHDF/PointData/'
      type(hdf5_file_t) :: file
      type(error_t), allocatable :: error
      integer(i8), allocatable :: ids(:), starts(:), cells(:, :), offsets(:)
      integer(i8) :: number
      real(wp), allocatable :: psi(:), points(:, :), energy(:), times(:)
      character(len=:), allocatable :: unit

      call open_file(file, path, error)
      call check_no_error(suite, 'the master opens', error)
      call read_attribute(file, 'VTKHDF/Steps', 'NSteps', number)
      call read_dataset(file, steps//'Values', times)
      call read_dataset(file, steps//'PointOffsets', starts)
      call read_dataset(file, steps//'CellOffsets', cells)
      call read_dataset(file, 'VTKHDF/Vertices/Offsets', offsets)
      call read_dataset(file, 'VTKHDF/Points', points)
      call read_dataset(file, fields//'id', ids)
      call read_dataset(file, fields//'psi', psi)
      call read_dataset(file, fields//'energy', energy)
      call read_attribute(file, fields//'stress', 'unit', unit)
      call check(suite, 'there are as many times as steps', number == 4 .and. size(times) == 4)
      call check(suite, 'steps begin where the points before them end', &
         all(int(starts) == [0, 4, 11, 11]))
      call check(suite, 'a step has one cell, or none without particles', &
         all(int(cells(1, :)) == [0, 1, 2, 2]) .and. all(cells(2:, :) == 0))
      call check(suite, 'every step has its own offsets', &
         all(int(offsets) == [0, 4, 0, 7, 0, 0, 2]))
      call check(suite, 'every particle is there', &
         size(ids) == 13 .and. sum(ids) == 6 + 21 + 1 .and. all(shape(points) == [3, 13]))
      call check(suite, 'a field stands with its particle', all(nint(points(1, :)) == int(ids)))
      call check(suite, 'a step has its own time', all(nint(points(2, 5:11)/0.5_wp) == 1))
      ! exact: the same division is done here
      call check(suite, 'fields on request keep every digit', all(abs(psi - real(ids, wp)/3) <= 0))
      call check_close(suite, 'what float32 cannot hold becomes its largest number', &
         maxval(energy), 3.4028235e38_wp, 0.0_wp, 1.0e-7_wp)   ! float32 has 7 digits
      call check(suite, 'fields have units', unit == 'MPa')
      call close_file(file, error)
      call check_no_error(suite, 'the master is read', error)
   end subroutine check_master

   !> A quadrilateral of two triangles with one front of two edges; then the same with a third.
   subroutine test_surface(suite, comm, name)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      character(len=*), intent(in) :: name
      type(series_t) :: series
      type(surface_t) :: surface
      type(error_t), allocatable :: error
      type(hdf5_file_t) :: file
      integer(i8), allocatable :: ids(:), offsets(:)

      call open_series(series, comm, 'results', name, error)
      surface%points = reshape(real([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0], wp), [3, 4])
      surface%triangles = reshape([1, 2, 3, 1, 3, 4], [3, 2])
      surface%fronts = [2, 3, 4]
      surface%front_start = [1, 4]
      call write_surface(series, comm, 0.0_wp, provenance, surface, &
         [new_field('opening', 'mm', 2*surface%points)], error)
      call check_no_error(suite, 'a surface is written', error)
      surface%points = reshape([surface%points, [2.0_wp, 0.5_wp, 0.0_wp]], [3, 5])
      surface%triangles = reshape([surface%triangles, [2, 5, 3]], [3, 3])
      surface%fronts = [2, 5, 3, 4, 1]
      surface%front_start = [1, 4, 6]
      call write_surface(series, comm, 1.0_wp, provenance, surface, &
         [new_field('opening', 'mm', 2*surface%points)], error)
      call check_no_error(suite, 'a grown surface is written', error)
      call open_file(file, 'results/'//name//'.vtkhdf', error)
      call read_dataset(file, 'VTKHDF/Polygons/Connectivity', ids)
      call read_dataset(file, 'VTKHDF/Lines/Offsets', offsets)
      call check(suite, 'triangles count their points from 0', &
         all(int(ids(7:)) == [0, 1, 2, 0, 2, 3, 1, 4, 2]))
      call check(suite, 'each front is a line', all(int(offsets) == [0, 3, 0, 3, 5]))
      call close_file(file, error)
      call check_no_error(suite, 'the surface is read', error)
   end subroutine test_surface

   subroutine test_failure(suite, comm)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      type(series_t) :: series
      type(error_t), allocatable :: error

      call open_series(series, comm, 'results/'//name//'_crack.vtkhdf', 'x', error)
      call check_error(suite, 'a file in the way of a folder is reported', error, 'cannot be made')
      series%folder = 'nowhere/'
      call write_step(series, comm, 0.0_wp, 3, error)
      call check_error(suite, 'a step that cannot be written is reported', error, &
         'cannot be created')
   end subroutine test_failure
end program test_vtkhdf
