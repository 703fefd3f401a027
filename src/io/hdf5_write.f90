!> Writing HDF5: datasets by slabs of the ranks, texts, attributes, virtual datasets.
!>
!> Extents are in Fortran order; the last one is split between the ranks of a parallel file.
module xmpm_hdf5_write
   use, intrinsic :: iso_c_binding, only: c_ptr, c_loc, c_char
   use hdf5   ! the library, named whole only in the modules of HDF5
   use xmpm_kinds, only: wp, sp, i1, i4, i8
   use xmpm_text, only: string_t
   use xmpm_communicator, only: sum_all, offset_of
   use xmpm_hdf5_file, only: hdf5_file_t, note, integer_type, text_type
   implicit none
   private

   public :: write_dataset, write_attribute, write_texts, write_virtual, make_group
   public :: kind_real64, kind_real32, kind_int64

   integer, parameter :: kind_real64 = 1   !! element kinds of virtual datasets
   integer, parameter :: kind_real32 = 2
   integer, parameter :: kind_int64 = 3

   !> Write an array to a dataset; the ranks of a parallel file put theirs behind each other.
   interface write_dataset
      module procedure write_reals, write_real_columns, write_singles, write_single_columns, &
         write_longs, write_long_columns, write_integers, write_integer_columns, &
         write_bytes, write_byte_columns
   end interface write_dataset

   !> Write an attribute of a group or dataset; the same value on every rank.
   interface write_attribute
      module procedure write_text_attribute, write_real_attribute, write_long_attribute, &
         write_longs_attribute
   end interface write_attribute

contains

   !> Make a group, and the groups above it.
   subroutine make_group(file, name)
      type(hdf5_file_t), intent(inout) :: file   !! written to
      character(len=*), intent(in) :: name       !! for example 'VTKHDF/Steps'
      integer(hid_t) :: group, links
      integer :: status

      links = parents_too()
      call h5gcreate_f(file%id, name, group, status, lcpl_id=links)
      call note(file, status, 'cannot make the group '//name)
      if (status >= 0) call h5gclose_f(group, status)
      call h5pclose_f(links, status)
   end subroutine make_group

   subroutine write_reals(file, name, values)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      real(wp), contiguous, target, intent(in) :: values(:)   !! (n) of this rank

      call write_slab(file, name, H5T_NATIVE_DOUBLE, c_loc(values), shape(values, hsize_t))
   end subroutine write_reals

   subroutine write_real_columns(file, name, values)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      real(wp), contiguous, target, intent(in) :: values(:, :)   !! (m,n) of this rank

      call write_slab(file, name, H5T_NATIVE_DOUBLE, c_loc(values), shape(values, hsize_t))
   end subroutine write_real_columns

   subroutine write_singles(file, name, values)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      real(sp), contiguous, target, intent(in) :: values(:)   !! (n) of this rank

      call write_slab(file, name, H5T_NATIVE_REAL, c_loc(values), shape(values, hsize_t))
   end subroutine write_singles

   subroutine write_single_columns(file, name, values)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      real(sp), contiguous, target, intent(in) :: values(:, :)   !! (m,n) of this rank

      call write_slab(file, name, H5T_NATIVE_REAL, c_loc(values), shape(values, hsize_t))
   end subroutine write_single_columns

   subroutine write_longs(file, name, values)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      integer(i8), contiguous, target, intent(in) :: values(:)   !! (n) of this rank

      call write_slab(file, name, integer_type(i8), c_loc(values), shape(values, hsize_t))
   end subroutine write_longs

   subroutine write_long_columns(file, name, values)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      integer(i8), contiguous, target, intent(in) :: values(:, :)   !! (m,n) of this rank

      call write_slab(file, name, integer_type(i8), c_loc(values), shape(values, hsize_t))
   end subroutine write_long_columns

   subroutine write_integers(file, name, values)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      integer(i4), contiguous, target, intent(in) :: values(:)   !! (n) of this rank

      call write_slab(file, name, integer_type(i4), c_loc(values), shape(values, hsize_t))
   end subroutine write_integers

   subroutine write_integer_columns(file, name, values)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      integer(i4), contiguous, target, intent(in) :: values(:, :)   !! (m,n) of this rank

      call write_slab(file, name, integer_type(i4), c_loc(values), shape(values, hsize_t))
   end subroutine write_integer_columns

   subroutine write_bytes(file, name, values)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      integer(i1), contiguous, target, intent(in) :: values(:)   !! (n) of this rank

      call write_slab(file, name, integer_type(i1), c_loc(values), shape(values, hsize_t))
   end subroutine write_bytes

   subroutine write_byte_columns(file, name, values)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      integer(i1), contiguous, target, intent(in) :: values(:, :)   !! (m,n) of this rank

      call write_slab(file, name, integer_type(i1), c_loc(values), shape(values, hsize_t))
   end subroutine write_byte_columns

   !> Write this rank's part of a dataset; ranks without a part take part in the call all the same.
   subroutine write_slab(file, name, type_id, address, extent)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      integer(hid_t), intent(in) :: type_id        !! of memory and file
      type(c_ptr), intent(in) :: address           !! of the first value
      integer(hsize_t), intent(in) :: extent(:)    !! of this rank
      integer(hid_t) :: dataset, there, here, links
      integer(hsize_t) :: start(size(extent)), whole(size(extent))
      integer :: status

      call place_slab(file, extent, start, whole)
      links = parents_too()
      call h5screate_simple_f(size(whole), whole, there, status)
      call h5dcreate_f(file%id, name, type_id, there, dataset, status, lcpl_id=links)
      call note(file, status, 'cannot make the dataset '//name)
      if (status >= 0) then
         call h5screate_simple_f(size(extent), extent, here, status)
         call select_slab(there, here, start, extent)
         if (all(whole > 0)) call h5dwrite_f(dataset, type_id, address, status, here, there, &
            file%transfer)   ! HDF5 refuses to write where there is nothing at all
         call note(file, status, 'cannot write the dataset '//name)
         call h5sclose_f(here, status)
         call h5dclose_f(dataset, status)
      end if
      call h5sclose_f(there, status)
      call h5pclose_f(links, status)
   end subroutine write_slab

   !> Where a rank's part begins in a dataset, and the extent of the whole.
   subroutine place_slab(file, extent, start, whole)
      type(hdf5_file_t), intent(in) :: file
      integer(hsize_t), intent(in) :: extent(:)
      integer(hsize_t), intent(out) :: start(:), whole(:)
      integer :: last
      integer(i8) :: total

      last = size(extent)
      start = 0
      whole = extent
      if (.not. file%parallel) return
      total = extent(last)
      start(last) = offset_of(file%comm, total)
      call sum_all(file%comm, total)
      whole(last) = total
   end subroutine place_slab

   !> Select a slab of a file's space, or nothing where it is empty.
   subroutine select_slab(there, here, start, extent)
      integer(hid_t), intent(in) :: there, here
      integer(hsize_t), intent(in) :: start(:), extent(:)
      integer :: status

      if (any(extent == 0)) then
         call h5sselect_none_f(there, status)
         call h5sselect_none_f(here, status)
      else
         call h5sselect_hyperslab_f(there, H5S_SELECT_SET_F, start, extent, status)
      end if
   end subroutine select_slab

   !> Write a list of texts as a dataset of fixed-length texts; serial files only.
   subroutine write_texts(file, name, texts)
      type(hdf5_file_t), intent(inout) :: file   !! a serial file
      character(len=*), intent(in) :: name       !! of the dataset
      type(string_t), intent(in) :: texts(:)     !! (n) texts
      character(kind=c_char), allocatable, target :: bytes(:)
      integer(hid_t) :: type_id
      integer :: i, length, status

      length = 1
      do i = 1, size(texts)
         length = max(length, len(texts(i)%s))
      end do
      allocate (bytes(length*size(texts)))
      do i = 1, size(texts)
         call put_bytes(texts(i)%s, bytes((i - 1)*length + 1:i*length))
      end do
      type_id = text_type(length)
      call write_slab(file, name, type_id, c_loc(bytes), shape(texts, hsize_t))
      call h5tclose_f(type_id, status)
   end subroutine write_texts

   !> Bytes of a text, with nulls behind it.
   subroutine put_bytes(text, bytes)
      character(len=*), intent(in) :: text
      character(kind=c_char), intent(out) :: bytes(:)
      integer :: i

      bytes = achar(0)
      do i = 1, len(text)
         bytes(i) = text(i:i)
      end do
   end subroutine put_bytes

   !> Write a dataset that shows the same dataset of other files one behind the other.
   !>
   !> The paths of `sources` count from the folder of this file; all have `width` values an entry.
   subroutine write_virtual(file, name, sources, counts, width, element)
      type(hdf5_file_t), intent(inout) :: file   !! a serial file
      character(len=*), intent(in) :: name       !! of the dataset, here and in the sources
      type(string_t), intent(in) :: sources(:)   !! (n) paths of files
      integer(i8), intent(in) :: counts(:)       !! (n) entries in each source
      integer, intent(in) :: width               !! values an entry; 0 for a plain list
      integer, intent(in) :: element             !! one of the kinds of this module
      integer(hid_t) :: space, layout, links, dataset
      integer(hsize_t) :: extent(2), start(2)
      integer :: i, status, rank, last

      rank = merge(1, 2, width == 0)
      last = rank
      extent(1) = int(width, hsize_t)
      extent(last) = sum(counts)
      start = 0
      call h5screate_simple_f(rank, extent(:rank), space, status)
      call h5pcreate_f(H5P_DATASET_CREATE_F, layout, status)
      do i = 1, size(sources)
         if (counts(i) == 0) cycle
         extent(last) = counts(i)
         call add_source(layout, space, sources(i)%s, name, start(:rank), extent(:rank))
         start(last) = start(last) + counts(i)
      end do
      call h5sselect_all_f(space, status)
      links = parents_too()
      call h5dcreate_f(file%id, name, element_type(element), space, dataset, status, layout, links)
      call note(file, status, 'cannot make the dataset '//name)
      if (status >= 0) call h5dclose_f(dataset, status)
      call h5pclose_f(links, status)
      call h5pclose_f(layout, status)
      call h5sclose_f(space, status)
   end subroutine write_virtual

   !> Map one whole dataset of another file to its place.
   subroutine add_source(layout, space, path, name, start, extent)
      integer(hid_t), intent(in) :: layout, space
      character(len=*), intent(in) :: path, name
      integer(hsize_t), intent(in) :: start(:), extent(:)
      integer(hid_t) :: source
      integer :: status

      call h5screate_simple_f(size(extent), extent, source, status)
      call h5sselect_hyperslab_f(space, H5S_SELECT_SET_F, start, extent, status)
      call h5pset_virtual_f(layout, space, path, name, source, status)
      call h5sclose_f(source, status)
   end subroutine add_source

   subroutine write_text_attribute(file, object, name, value)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: object   !! group or dataset; '/' is the file
      character(len=*), intent(in) :: name
      character(len=*), intent(in) :: value    !! written as fixed-length ASCII
      character(kind=c_char), target :: bytes(max(1, len(value)))
      integer(hid_t) :: type_id
      integer :: status

      call put_bytes(value, bytes)
      type_id = text_type(size(bytes))
      call put_attribute(file, object, name, type_id, c_loc(bytes), 0)
      call h5tclose_f(type_id, status)
   end subroutine write_text_attribute

   subroutine write_real_attribute(file, object, name, value)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: object, name
      real(wp), target, intent(in) :: value

      call put_attribute(file, object, name, H5T_NATIVE_DOUBLE, c_loc(value), 0)
   end subroutine write_real_attribute

   subroutine write_long_attribute(file, object, name, value)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: object, name
      integer(i8), target, intent(in) :: value

      call put_attribute(file, object, name, integer_type(i8), c_loc(value), 0)
   end subroutine write_long_attribute

   subroutine write_longs_attribute(file, object, name, values)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: object, name
      integer(i8), contiguous, target, intent(in) :: values(:)

      call put_attribute(file, object, name, integer_type(i8), c_loc(values), size(values))
   end subroutine write_longs_attribute

   !> Write an attribute of `count` values, or of one value where that is 0.
   subroutine put_attribute(file, object, name, type_id, address, count)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: object, name
      integer(hid_t), intent(in) :: type_id
      type(c_ptr), intent(in) :: address
      integer, intent(in) :: count
      integer(hid_t) :: owner, space, attribute
      integer :: status

      call h5oopen_f(file%id, object, owner, status)
      call note(file, status, 'cannot open '//object)
      if (status < 0) return
      if (count == 0) then
         call h5screate_f(H5S_SCALAR_F, space, status)
      else
         call h5screate_simple_f(1, [int(count, hsize_t)], space, status)
      end if
      call h5acreate_f(owner, name, type_id, space, attribute, status)
      call note(file, status, 'cannot make the attribute '//name//' of '//object)
      if (status >= 0) then
         call h5awrite_f(attribute, type_id, address, status)
         call note(file, status, 'cannot write the attribute '//name//' of '//object)
         call h5aclose_f(attribute, status)
      end if
      call h5sclose_f(space, status)
      call h5oclose_f(owner, status)
   end subroutine put_attribute

   !> Type of an element kind of virtual datasets.
   function element_type(element) result(type_id)
      integer, intent(in) :: element
      integer(hid_t) :: type_id

      select case (element)
      case (kind_real64)
         type_id = H5T_NATIVE_DOUBLE
      case (kind_real32)
         type_id = H5T_NATIVE_REAL
      case default
         type_id = integer_type(i8)
      end select
   end function element_type

   !> List that lets a dataset or group make the groups above it.
   function parents_too() result(links)
      integer(hid_t) :: links
      integer :: status

      call h5pcreate_f(H5P_LINK_CREATE_F, links, status)
      call h5pset_create_inter_group_f(links, 1, status)
   end function parents_too
end module xmpm_hdf5_write
