!> HDF5 files come back as they were written, by any number of ranks, and failures are reported.
! ranks: 1 2 3
program test_hdf5_file
   use xmpm_kinds, only: wp, sp, i1, i4, i8
   use xmpm_error, only: error_t
   use xmpm_text, only: string_t, to_text
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, wait_for_all
   use xmpm_hdf5_file, only: hdf5_file_t, create_file, open_file, close_file, has_item, hdf5_version
   use xmpm_hdf5_write, only: write_dataset, write_attribute, write_texts, write_virtual, &
      make_group, kind_real64, kind_int64
   use xmpm_hdf5_read, only: extent_of, read_dataset, read_attribute, read_texts
   use testing, only: suite_t, check, check_error, check_no_error, finish
   implicit none
   type(comm_t) :: comm
   type(suite_t) :: suite
   character(len=:), allocatable :: path

   call start_parallel(comm)
   suite%name = 'hdf5_file'
   path = 'test_hdf5_'//to_text(comm%size)//'.h5'
   call write_slabs(suite, comm, path)
   call read_slabs(suite, comm, path)
   call wait_for_all(comm)
   call test_small_things(suite, comm)
   call test_failures(suite, comm, path)
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> Rank r writes r entries, so that rank 0 takes part without any; values are 100 r + i.
   subroutine write_slabs(suite, comm, path)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      character(len=*), intent(in) :: path
      type(hdf5_file_t) :: file
      type(error_t), allocatable :: error
      integer(i8), allocatable :: ids(:)
      integer :: i

      allocate (ids(comm%rank))
      ids(:) = [(int(100*comm%rank + i, i8), i=1, comm%rank)]
      call create_file(file, path, error, comm)
      call check_no_error(suite, 'all ranks create a file together', error)
      call make_group(file, 'a/b')
      call write_dataset(file, 'a/ids', ids)
      call write_dataset(file, 'a/b/reals', real(ids, wp)/3)
      call write_dataset(file, 'a/b/columns', spread(real(ids, wp), 1, 3))
      call write_dataset(file, 'singles', spread(real(ids, sp), 1, 2))
      call write_dataset(file, 'integers', int(ids, i4))
      call write_dataset(file, 'bytes', int(mod(ids, 100_i8), i1))
      call write_dataset(file, 'nobody', ids(:0))
      call write_attribute(file, 'a/b/reals', 'unit', 'mm')
      call write_attribute(file, 'a', 'pair', [2_i8, 2_i8])
      call write_attribute(file, '/', 'time', 0.1_wp)
      call write_attribute(file, '/', 'step', 7_i8)
      call close_file(file, error)
      call check_no_error(suite, 'all ranks write and close it', error)
   end subroutine write_slabs

   !> Reading converts kinds; every value is exact.
   subroutine read_slabs(suite, comm, path)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      character(len=*), intent(in) :: path
      type(hdf5_file_t) :: file
      type(error_t), allocatable :: error
      integer(i8), allocatable :: ids(:), bytes(:), expected(:)
      real(wp), allocatable :: reals(:), columns(:, :), part(:, :)
      integer :: n, i, j

      n = comm%size*(comm%size - 1)/2
      allocate (expected(n))
      expected(:) = [((int(100*i + j, i8), j=1, i), i=1, comm%size - 1)]
      call open_file(file, path, error)
      call check_no_error(suite, 'one rank opens the file for itself', error)
      call read_dataset(file, 'a/ids', ids)
      call read_dataset(file, 'a/b/reals', reals)
      call read_dataset(file, 'singles', columns)
      call read_dataset(file, 'bytes', bytes)
      call check(suite, 'slabs stand in rank order', size(ids) == n .and. all(ids == expected))
      ! exact: the same division was done when writing
      call check(suite, 'reals keep every digit', all(abs(reals - real(ids, wp)/3) <= 0))
      call check(suite, 'float32 columns are read as float64', all(nint(columns(2, :)) == int(ids)))
      call check(suite, 'bytes are read as integers', all(bytes == mod(ids, 100_i8)))
      call check(suite, 'extents are in Fortran order', &
         all(int(extent_of(file, 'a/b/columns')) == [3, n]))
      call read_dataset(file, 'a/b/columns', part, first=int(n, i8) + 1)
      call check(suite, 'the slab behind the end is empty', all(shape(part) == [3, 0]))
      if (n > 1) then
         call read_dataset(file, 'a/b/columns', part, first=2_i8, count=1_i8)
         call check(suite, 'a slab is read alone', nint(part(3, 1)) == int(ids(2)))
      end if
      call check(suite, 'a dataset that no rank fills is there', &
         size(extent_of(file, 'nobody')) == 1)
      call check_attributes(suite, file)
      call close_file(file, error)
      call check_no_error(suite, 'reading met no failure', error)
   end subroutine read_slabs

   subroutine check_attributes(suite, file)
      type(suite_t), intent(inout) :: suite
      type(hdf5_file_t), intent(inout) :: file
      character(len=:), allocatable :: unit
      real(wp) :: time
      integer(i8) :: step

      call read_attribute(file, 'a/b/reals', 'unit', unit)
      call read_attribute(file, '/', 'time', time)
      call read_attribute(file, '/', 'step', step)
      call check(suite, 'text attributes come back', unit == 'mm' .and. len(unit) == 2)
      call check(suite, 'real attributes come back', abs(time - 0.1_wp) <= 0)
      call check(suite, 'integer attributes come back', step == 7)
      call check(suite, 'groups are found', has_item(file, 'a'))
      call check(suite, 'datasets are found', has_item(file, 'a/b/reals'))
      call check(suite, 'missing items are not', .not. has_item(file, 'x/y/z'))
      call check(suite, 'the library says its version', index(hdf5_version(), '1.') == 1)
   end subroutine check_attributes

   !> Files of one rank: texts and virtual datasets.
   subroutine test_small_things(suite, comm)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      type(hdf5_file_t) :: file
      type(error_t), allocatable :: error
      type(string_t) :: names(2), sources(3)
      type(string_t), allocatable :: back(:)
      real(wp), allocatable :: values(:, :)
      integer(i8), allocatable :: ids(:)
      integer :: i

      if (comm%rank > 0) return
      do i = 1, 3
         sources(i)%s = 'test_part_'//to_text(comm%size)//to_text(i)//'.h5'
         call create_file(file, sources(i)%s, error)
         call write_dataset(file, 'g/x', spread([10.0_wp, 1.0_wp]*real(i, wp), 2, i - 1))
         call write_dataset(file, 'g/id', [int(i, i8)])
         call close_file(file, error)
      end do
      names(1)%s = 'plate'
      names(2)%s = 'a longer name'
      call create_file(file, 'test_master_'//to_text(comm%size)//'.h5', error)
      call write_virtual(file, 'g/x', sources, [0_i8, 1_i8, 2_i8], 2, kind_real64)
      call write_virtual(file, 'g/id', sources, [1_i8, 1_i8, 1_i8], 0, kind_int64)
      call write_virtual(file, 'g/none', sources, [0_i8, 0_i8, 0_i8], 0, kind_int64)
      call write_texts(file, 'names', names)
      call close_file(file, error)
      call check_no_error(suite, 'a file of virtual datasets is written', error)
      call open_file(file, 'test_master_'//to_text(comm%size)//'.h5', error)
      call read_dataset(file, 'g/x', values)
      call read_dataset(file, 'g/id', ids)
      call read_texts(file, 'names', back)
      call check(suite, 'virtual columns stand one behind the other', &
         all(nint(reshape(values, [6])) == [20, 2, 30, 3, 30, 3]))
      call check(suite, 'virtual lists stand one behind the other', all(int(ids) == [1, 2, 3]))
      call check(suite, 'texts come back', back(1)%s == 'plate' .and. back(2)%s == 'a longer name')
      call close_file(file, error)
      call check_no_error(suite, 'virtual datasets and texts are read', error)
   end subroutine test_small_things

   subroutine test_failures(suite, comm, path)
      type(suite_t), intent(inout) :: suite
      type(comm_t), intent(in) :: comm
      character(len=*), intent(in) :: path
      type(hdf5_file_t) :: file
      type(error_t), allocatable :: error
      real(wp), allocatable :: values(:)

      call open_file(file, 'missing.h5', error)
      call check_error(suite, 'a missing file is reported', error, 'missing.h5: no such file')
      call create_file(file, 'no/such/folder/x.h5', error, comm)
      call check_error(suite, 'a file in no folder is reported', error, &
         'x.h5: the file cannot be created')
      call open_file(file, path, error)
      call read_dataset(file, 'a/none', values)
      call check(suite, 'a failed reading gives an empty array', size(values) == 0)
      call close_file(file, error)
      call check_error(suite, 'a missing dataset is reported', error, &
         'the dataset a/none is missing')
      call open_file(file, path, error)
      call read_dataset(file, 'a/b/columns', values)
      call close_file(file, error)
      call check_error(suite, 'a wrong rank is reported', error, 'has 2 dimensions instead of 1')
      call open_file(file, path, error)
      call read_dataset(file, 'a/b/reals', values, first=1_i8, count=99_i8)
      call close_file(file, error)
      call check_error(suite, 'a slab beyond the end is reported', error, 'ends at entry')
      call test_wrong_kinds(suite, 'test_kinds_'//to_text(comm%size) &
         //to_text(comm%rank)//'.h5')
      call open_file(file, path, error, comm)
      if (comm%rank == 0) call write_attribute(file, '/', 'x', 1_i8)
      call close_file(file, error)
      call check_error(suite, 'all ranks hear of the failure of one', error, &
         'cannot make the attribute x')
   end subroutine test_failures

   !> Things that are there already, or are of another kind.
   subroutine test_wrong_kinds(suite, path)
      type(suite_t), intent(inout) :: suite
      character(len=*), intent(in) :: path
      type(hdf5_file_t) :: file
      type(error_t), allocatable :: error
      type(string_t), allocatable :: texts(:)
      real(wp), allocatable :: values(:)
      real(wp) :: value
      integer :: i

      do i = 1, 3
         call create_file(file, path, error)
         call make_group(file, 'a')
         call write_dataset(file, 'x', [1.0_wp])
         if (i == 1) call make_group(file, 'a')
         if (i == 2) call write_dataset(file, 'x', [1.0_wp])
         if (i == 3) call write_attribute(file, 'none', 'x', 1.0_wp)
         call close_file(file, error)
         if (i == 1) call check_error(suite, 'a group twice', error, 'cannot make the group a')
         if (i == 2) call check_error(suite, 'a dataset twice', error, 'cannot make the dataset x')
         if (i == 3) call check_error(suite, 'an object that is not there', error, &
            'cannot open none')
      end do
      call create_file(file, path, error)
      call write_dataset(file, 'x', [1.0_wp])
      allocate (texts(1))
      texts(1)%s = 'one'
      call write_texts(file, 'texts', texts)
      call write_attribute(file, '/', 'text', 'one')
      call close_file(file, error)
      call open_file(file, path, error)
      call read_texts(file, 'x', texts)
      call close_file(file, error)
      call check_error(suite, 'numbers are no texts', error, 'x does not hold readable texts')
      call open_file(file, path, error)
      call read_dataset(file, 'texts', values)
      call close_file(file, error)
      call check_error(suite, 'texts are no numbers', error, 'cannot read the dataset texts')
      call open_file(file, path, error)
      call read_attribute(file, '/', 'text', value)
      call close_file(file, error)
      call check_error(suite, 'a text is no number', error, 'cannot read the attribute text')
   end subroutine test_wrong_kinds
end program test_hdf5_file
