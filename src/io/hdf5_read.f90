!> Reading HDF5: extents, datasets whole or by slabs, texts, attributes.
!>
!> Numbers are converted to the kind that is asked for; extents are in Fortran order.
module xmpm_hdf5_read
   use, intrinsic :: iso_c_binding, only: c_ptr, c_loc, c_f_pointer, c_char, c_size_t
   use hdf5   ! the library, named whole only in the modules of HDF5
   use xmpm_kinds, only: wp, i8
   use xmpm_text, only: string_t, to_text
   use xmpm_hdf5_file, only: hdf5_file_t, note, has_item, integer_type
   implicit none
   private

   public :: extent_of, read_dataset, read_attribute, read_texts

   !> Read a dataset, or `count` entries of its last extent from `first` (1 is the first).
   interface read_dataset
      module procedure read_reals, read_real_columns, read_longs, read_long_columns
   end interface read_dataset

   !> Read an attribute of a group or dataset.
   interface read_attribute
      module procedure read_text_attribute, read_real_attribute, read_long_attribute
   end interface read_attribute

   interface
      pure function c_strlen(text) result(n) bind(c, name='strlen')
         import :: c_ptr, c_size_t
         implicit none
         type(c_ptr), value :: text
         integer(c_size_t) :: n
      end function c_strlen
   end interface

contains

   !> Extent of a dataset in Fortran order; of size 0 where it is a scalar or missing.
   function extent_of(file, name) result(extent)
      type(hdf5_file_t), intent(inout) :: file    !! a missing dataset is its failure
      character(len=*), intent(in) :: name        !! of the dataset
      integer(i8), allocatable :: extent(:)       !! (rank) extents
      integer(hid_t) :: dataset, space

      call open_dataset(file, name, dataset, space, extent)
      call close_dataset(dataset, space)
   end function extent_of

   !> Open a dataset that a reader needs; `dataset` is negative where it cannot be had.
   subroutine open_dataset(file, name, dataset, space, extent)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      integer(hid_t), intent(out) :: dataset, space
      integer(i8), allocatable, intent(out) :: extent(:)
      integer(hsize_t), allocatable :: most(:)
      integer :: rank, status

      allocate (extent(0))
      dataset = -1
      space = -1
      status = -1
      if (has_item(file, name)) call h5dopen_f(file%id, name, dataset, status)
      call note(file, status, 'the dataset '//name//' is missing')
      if (status < 0) return
      call h5dget_space_f(dataset, space, status)
      call h5sget_simple_extent_ndims_f(space, rank, status)
      if (rank == 0) return
      deallocate (extent)
      allocate (extent(rank), most(rank))
      call h5sget_simple_extent_dims_f(space, extent, most, status)
   end subroutine open_dataset

   subroutine close_dataset(dataset, space)
      integer(hid_t), intent(in) :: dataset, space
      integer :: status

      if (dataset < 0) return
      call h5sclose_f(space, status)
      call h5dclose_f(dataset, status)
   end subroutine close_dataset

   subroutine read_reals(file, name, values, first, count)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      real(wp), allocatable, target, intent(out) :: values(:)   !! (n); of size 0 on failure
      integer(i8), intent(in), optional :: first, count
      integer(hid_t) :: dataset, space
      integer(i8) :: start(1), slab(1)

      call choose_slab(file, name, dataset, space, start, slab, first, count)
      allocate (values(slab(1)))
      call read_slab(file, name, [dataset, space], H5T_NATIVE_DOUBLE, c_loc(values), start, slab)
   end subroutine read_reals

   subroutine read_real_columns(file, name, values, first, count)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      real(wp), allocatable, target, intent(out) :: values(:, :)   !! (m,n); of size 0 on failure
      integer(i8), intent(in), optional :: first, count
      integer(hid_t) :: dataset, space
      integer(i8) :: start(2), slab(2)

      call choose_slab(file, name, dataset, space, start, slab, first, count)
      allocate (values(slab(1), slab(2)))
      call read_slab(file, name, [dataset, space], H5T_NATIVE_DOUBLE, c_loc(values), start, slab)
   end subroutine read_real_columns

   subroutine read_longs(file, name, values, first, count)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      integer(i8), allocatable, target, intent(out) :: values(:)   !! (n); of size 0 on failure
      integer(i8), intent(in), optional :: first, count
      integer(hid_t) :: dataset, space
      integer(i8) :: start(1), slab(1)

      call choose_slab(file, name, dataset, space, start, slab, first, count)
      allocate (values(slab(1)))
      call read_slab(file, name, [dataset, space], integer_type(i8), c_loc(values), start, slab)
   end subroutine read_longs

   subroutine read_long_columns(file, name, values, first, count)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      integer(i8), allocatable, target, intent(out) :: values(:, :)   !! (m,n); of size 0 on failure
      integer(i8), intent(in), optional :: first, count
      integer(hid_t) :: dataset, space
      integer(i8) :: start(2), slab(2)

      call choose_slab(file, name, dataset, space, start, slab, first, count)
      allocate (values(slab(1), slab(2)))
      call read_slab(file, name, [dataset, space], integer_type(i8), c_loc(values), start, slab)
   end subroutine read_long_columns

   !> Open a dataset and settle which part of it is to be read; an empty one on failure.
   subroutine choose_slab(file, name, dataset, space, start, slab, first, count)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      integer(hid_t), intent(out) :: dataset, space
      integer(i8), intent(out) :: start(:), slab(:)
      integer(i8), intent(in), optional :: first, count
      integer(i8), allocatable :: extent(:)
      integer :: last

      start = 0
      slab = 0
      call open_dataset(file, name, dataset, space, extent)
      if (dataset < 0) return
      if (size(extent) /= size(slab)) then
         call note(file, -1, 'the dataset '//name//' has '//to_text(size(extent))// &
            ' dimensions instead of '//to_text(size(slab)))
         return
      end if
      slab = extent
      last = size(slab)
      if (present(first)) then
         start(last) = first - 1
         slab(last) = max(0_i8, extent(last) - start(last))
      end if
      if (present(count)) slab(last) = count
      if (start(last) >= 0 .and. slab(last) >= 0 .and. &
         start(last) + slab(last) <= extent(last)) return
      call note(file, -1, 'the dataset '//name//' ends at entry '//to_text(extent(last)))
      slab = 0
   end subroutine choose_slab

   !> Read a slab of an open dataset and close it.
   subroutine read_slab(file, name, ids, type_id, address, start, slab)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      integer(hid_t), intent(in) :: ids(2)        !! dataset and its space
      integer(hid_t), intent(in) :: type_id       !! in memory
      type(c_ptr), intent(in) :: address
      integer(i8), intent(in) :: start(:), slab(:)
      type(c_ptr) :: buffer
      integer(hid_t) :: here
      integer :: status

      if (ids(1) < 0) return
      buffer = address
      call h5screate_simple_f(size(slab), slab, here, status)
      if (any(slab == 0)) then
         call h5sselect_none_f(ids(2), status)
         call h5sselect_none_f(here, status)
      else
         call h5sselect_hyperslab_f(ids(2), H5S_SELECT_SET_F, start, slab, status)
      end if
      call h5dread_f(ids(1), type_id, buffer, status, here, ids(2), file%transfer)
      call note(file, status, 'cannot read the dataset '//name)
      call h5sclose_f(here, status)
      call close_dataset(ids(1), ids(2))
   end subroutine read_slab

   !> Read a list of texts, or one text, of fixed or variable length; of size 0 on failure.
   subroutine read_texts(file, name, texts)
      type(hdf5_file_t), intent(inout) :: file              !! read from
      character(len=*), intent(in) :: name                  !! of the dataset
      type(string_t), allocatable, intent(out) :: texts(:)  !! (n) texts
      character(kind=c_char), allocatable, target :: bytes(:)
      type(c_ptr), allocatable, target :: places(:)
      type(c_ptr) :: buffer
      integer(i8), allocatable :: extent(:)
      integer(hid_t) :: dataset, space, type_id
      integer :: i, n, length, status

      call open_dataset(file, name, dataset, space, extent)
      n = int(product(extent))
      if (dataset < 0) n = 0
      allocate (texts(n))
      do i = 1, n
         texts(i)%s = ''
      end do
      if (n == 0) call close_dataset(dataset, space)
      if (n == 0) return
      call h5dget_type_f(dataset, type_id, status)
      call text_length(type_id, length)
      if (length > 0) then
         allocate (bytes(n*length))
         buffer = c_loc(bytes)
         call h5dread_f(dataset, type_id, buffer, status)
         if (status >= 0) call take_fixed(bytes, length, texts)
      else if (length == 0) then
         allocate (places(n))
         buffer = c_loc(places)
         call h5dread_f(dataset, type_id, buffer, status)
         if (status >= 0) call take_variable(places, texts)
         if (status >= 0) call h5dvlen_reclaim_f(type_id, space, H5P_DEFAULT_F, buffer, status)
      end if
      if (length < 0) status = -1
      call note(file, status, 'the dataset '//name//' does not hold readable texts')
      call h5tclose_f(type_id, status)
      call close_dataset(dataset, space)
   end subroutine read_texts

   !> Bytes of a fixed-length text type, 0 for variable length, -1 where it is no text.
   subroutine text_length(type_id, length)
      integer(hid_t), intent(in) :: type_id
      integer, intent(out) :: length
      integer(size_t) :: bytes
      integer :: class, status
      logical :: variable

      length = -1
      call h5tget_class_f(type_id, class, status)
      if (class /= H5T_STRING_F) return
      length = 0
      call h5tis_variable_str_f(type_id, variable, status)
      if (variable) return
      call h5tget_size_f(type_id, bytes, status)
      length = int(bytes)
   end subroutine text_length

   !> Texts of fixed length, without the blanks and nulls behind them.
   subroutine take_fixed(bytes, length, texts)
      character(kind=c_char), intent(in) :: bytes(:)
      integer, intent(in) :: length
      type(string_t), intent(inout) :: texts(:)
      integer :: i, j

      do i = 1, size(texts)
         texts(i)%s = repeat(' ', int(length, i8))
         do j = 1, length
            if (bytes((i - 1)*length + j) == achar(0)) exit
            texts(i)%s(j:j) = bytes((i - 1)*length + j)
         end do
         texts(i)%s = trim(texts(i)%s)
      end do
   end subroutine take_fixed

   !> Texts of variable length, as C strings.
   subroutine take_variable(places, texts)
      type(c_ptr), intent(in) :: places(:)
      type(string_t), intent(inout) :: texts(:)
      character(kind=c_char), pointer :: bytes(:)
      integer :: i, n

      do i = 1, size(texts)
         n = int(c_strlen(places(i)))
         call c_f_pointer(places(i), bytes, [n])
         call take_fixed(bytes, n, texts(i:i))
      end do
   end subroutine take_variable

   subroutine read_text_attribute(file, object, name, value)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: object, name
      character(len=:), allocatable, intent(out) :: value   !! without blanks behind; '' on failure
      character(kind=c_char), allocatable, target :: bytes(:)
      type(c_ptr), target :: places(1)
      type(c_ptr) :: buffer
      type(string_t) :: texts(1)
      integer(hid_t) :: attribute, type_id
      integer :: length, status

      texts(1)%s = ''
      call open_attribute(file, object, name, attribute)
      if (attribute >= 0) then
         call h5aget_type_f(attribute, type_id, status)
         call text_length(type_id, length)
         if (length > 0) then
            allocate (bytes(length))
            buffer = c_loc(bytes)
            call h5aread_f(attribute, type_id, buffer, status)
            call take_fixed(bytes, length, texts)
         else if (length == 0) then
            buffer = c_loc(places)
            call h5aread_f(attribute, type_id, buffer, status)
            call take_variable(places, texts)
         end if
         if (length < 0) call note(file, -1, 'the attribute '//name//' of '//object//' is no text')
         call h5tclose_f(type_id, status)
         call h5aclose_f(attribute, status)
      end if
      value = texts(1)%s
   end subroutine read_text_attribute

   subroutine read_real_attribute(file, object, name, value)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: object, name
      real(wp), target, intent(out) :: value   !! 0 on failure

      value = 0
      call get_attribute(file, object, name, H5T_NATIVE_DOUBLE, c_loc(value))
   end subroutine read_real_attribute

   subroutine read_long_attribute(file, object, name, value)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: object, name
      integer(i8), target, intent(out) :: value   !! 0 on failure

      value = 0
      call get_attribute(file, object, name, integer_type(i8), c_loc(value))
   end subroutine read_long_attribute

   !> Read one number.
   subroutine get_attribute(file, object, name, type_id, address)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: object, name
      integer(hid_t), intent(in) :: type_id
      type(c_ptr), intent(in) :: address
      type(c_ptr) :: buffer
      integer(hid_t) :: attribute
      integer :: status

      call open_attribute(file, object, name, attribute)
      if (attribute < 0) return
      buffer = address
      call h5aread_f(attribute, type_id, buffer, status)
      call note(file, status, 'cannot read the attribute '//name//' of '//object)
      call h5aclose_f(attribute, status)
   end subroutine get_attribute

   !> Open an attribute; negative where it is missing.
   subroutine open_attribute(file, object, name, attribute)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: object, name
      integer(hid_t), intent(out) :: attribute
      integer :: status

      attribute = -1
      call h5aopen_by_name_f(file%id, object, name, attribute, status)
      call note(file, status, 'the attribute '//name//' of '//object//' is missing')
      if (status < 0) attribute = -1
   end subroutine open_attribute
end module xmpm_hdf5_read
