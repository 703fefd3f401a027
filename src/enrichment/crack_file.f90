!> Crack surfaces from files: STL, or the triangles of the HDF5 format that doc/crack_file.md
!> describes.
module xmpm_crack_file
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t, raise, add_context, code_files
   use xmpm_text, only: to_text, lower
   use xmpm_hdf5_file, only: hdf5_file_t, open_file, close_file
   use xmpm_hdf5_read, only: extent_of, read_dataset, read_attribute
   use xmpm_stl_file, only: read_stl
   implicit none
   private

   public :: read_crack_file

   character(len=*), parameter :: format_name = 'xmpm3d crack'
   integer(i8), parameter :: format_version = 1

contains

   !> Read the triangles of a crack, each rank for itself; the ending .stl tells STL from HDF5.
   subroutine read_crack_file(path, length_unit, x, tri, error)
      character(len=*), intent(in) :: path               !! of the file, ending in .stl or .h5
      character(len=*), intent(in) :: length_unit   !! of the deck; an HDF5 file must have the same
      real(wp), allocatable, intent(out) :: x(:, :)      !! (3,nv) vertices [length]
      integer, allocatable, intent(out) :: tri(:, :)     !! (3,nt) triangles, vertices from 1
      type(error_t), allocatable, intent(out) :: error   !! missing, broken, or of another format

      if (lower(path(max(1, len(path) - 3):)) == '.stl') then
         call read_stl(path, x, tri, error)
      else
         call read_hdf5(path, length_unit, x, tri, error)
      end if
   end subroutine read_crack_file

   subroutine read_hdf5(path, length_unit, x, tri, error)
      character(len=*), intent(in) :: path, length_unit
      real(wp), allocatable, intent(out) :: x(:, :)
      integer, allocatable, intent(out) :: tri(:, :)
      type(error_t), allocatable, intent(out) :: error
      type(error_t), allocatable :: failure
      type(hdf5_file_t) :: file
      integer(i8), allocatable :: triangles(:, :)

      call open_file(file, path, error)
      if (allocated(error)) return
      call check_header(file, length_unit, error)
      if (.not. allocated(error)) call check_shape(file, 'vertices', error)
      if (.not. allocated(error)) call check_shape(file, 'triangles', error)
      if (.not. allocated(error)) then
         call read_dataset(file, 'vertices', x)
         call read_dataset(file, 'triangles', triangles)
      end if
      call close_file(file, failure)
      if (allocated(failure)) then
         call move_alloc(failure, error)   ! what could not be read comes before what was wrong
         return
      end if
      if (.not. allocated(error)) call take_triangles(x, triangles, tri, error)
      call add_context(error, path)
   end subroutine read_hdf5

   subroutine check_header(file, length_unit, error)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: length_unit
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: word
      integer(i8) :: version

      call read_attribute(file, '/', 'format', word)
      if (allocated(file%failure)) return
      if (word /= format_name) then
         call raise(error, code_files, "the format is '"//word//"' instead of '"//format_name//"'")
         return
      end if
      call read_attribute(file, '/', 'version', version)
      if (allocated(file%failure)) return
      if (version /= format_version) then
         call raise(error, code_files, 'the format has version '//to_text(version)// &
            '; this program reads version '//to_text(format_version))
         return
      end if
      call read_attribute(file, '/', 'length_unit', word)
      if (allocated(file%failure) .or. word == length_unit) return
      call raise(error, code_files, "the length_unit is '"//word//"', that of the deck is '"// &
         length_unit//"'; nothing is converted")
   end subroutine check_header

   !> A dataset must have rows of three.
   subroutine check_shape(file, name, error)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      type(error_t), allocatable, intent(out) :: error
      integer(i8), allocatable :: extent(:)

      extent = extent_of(file, name)
      if (allocated(file%failure)) return
      if (size(extent) == 2) then
         if (extent(1) == 3 .and. extent(2) > 0) return
      end if
      call raise(error, code_files, 'the dataset '//name// &
         ' must have rows of three numbers, one row at least')
   end subroutine check_shape

   !> Triangles that count vertices from 1; every one must name vertices that are there.
   subroutine take_triangles(x, triangles, tri, error)
      real(wp), intent(in) :: x(:, :)
      integer(i8), intent(in) :: triangles(:, :)
      integer, allocatable, intent(out) :: tri(:, :)
      type(error_t), allocatable, intent(out) :: error
      integer :: t, v
      integer(i8) :: last

      do v = 1, size(x, 2)
         if (all(ieee_is_finite(x(:, v)))) cycle
         call raise(error, code_files, 'vertices['//to_text(v - 1)//'] is not finite')
         return
      end do
      last = size(x, 2, i8) - 1
      do t = 1, size(triangles, 2)
         if (all(triangles(:, t) >= 0 .and. triangles(:, t) <= last)) cycle
         call raise(error, code_files, 'triangles['//to_text(t - 1)// &
            '] names a vertex that is not there; vertices are 0 to '//to_text(last))
         return
      end do
      allocate (tri(3, size(triangles, 2)))
      tri = int(triangles) + 1
   end subroutine take_triangles
end module xmpm_crack_file
