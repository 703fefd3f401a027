!> HDF5 files: opening, closing, and the one place where their failures are kept.
!>
!> A file remembers its first failure and goes on taking part in what the other ranks do; closing it
!> reports the failure. So calls need no check of their own and no rank waits for one that gave up.
!> All HDF5 calls of the program stand here, in xmpm_hdf5_write and in xmpm_hdf5_read.
module xmpm_hdf5_file
   use hdf5   ! the library, named whole only in these three modules
   use mpi_f08, only: MPI_INFO_NULL
   use xmpm_kinds, only: i4, i8
   use xmpm_error, only: error_t, raise, code_files
   use xmpm_text, only: to_text
   use xmpm_communicator, only: comm_t, agree_on_error
   implicit none
   private

   public :: hdf5_file_t, create_file, open_file, close_file, hdf5_version
   public :: has_item, note, integer_type, text_type

   !> An open file.
   type :: hdf5_file_t
      character(len=:), allocatable :: path      !! as opened
      character(len=:), allocatable :: failure   !! the first failure; unallocated where all is well
      logical :: parallel = .false.              !! opened by all ranks together
      type(comm_t) :: comm                       !! ranks of a parallel file
      integer(hid_t) :: id = -1                  !! of the HDF5 library
      integer(hid_t) :: transfer = -1            !! collective transfer in a parallel file
   end type hdf5_file_t

contains

   !> Create a file, together with all ranks where `comm` is given; an older file is replaced.
   subroutine create_file(file, path, error, comm)
      type(hdf5_file_t), intent(out) :: file               !! open on return
      character(len=*), intent(in) :: path                 !! the same on every rank
      type(error_t), allocatable, intent(out) :: error     !! the file cannot be created
      type(comm_t), intent(in), optional :: comm           !! all of them must call

      integer(hid_t) :: access
      integer :: status

      call prepare(file, path, access, comm)
      call h5fcreate_f(path, H5F_ACC_TRUNC_F, file%id, status, access_prp=access)
      if (status < 0) call raise(error, code_files, path//': the file cannot be created')
      call h5pclose_f(access, status)
      if (file%parallel) call agree_on_error(file%comm, error)
   end subroutine create_file

   !> Open a file for reading, each rank for itself, or together where `comm` is given.
   subroutine open_file(file, path, error, comm)
      type(hdf5_file_t), intent(out) :: file               !! open on return
      character(len=*), intent(in) :: path                 !! an existing file
      type(error_t), allocatable, intent(out) :: error     !! missing or not HDF5
      type(comm_t), intent(in), optional :: comm           !! all of them must call
      integer(hid_t) :: access
      integer :: status
      logical :: found

      call prepare(file, path, access, comm)
      inquire (file=path, exist=found)
      if (found) then
         call h5fopen_f(path, H5F_ACC_RDONLY_F, file%id, status, access_prp=access)
         if (status < 0) call raise(error, code_files, path//': not a readable HDF5 file')
      else
         call raise(error, code_files, path//': no such file')
      end if
      call h5pclose_f(access, status)
      if (file%parallel) call agree_on_error(file%comm, error)
   end subroutine open_file

   !> Close a file and report the first failure since it was opened, of any rank of a parallel file.
   subroutine close_file(file, error)
      type(hdf5_file_t), intent(inout) :: file             !! closed on return
      type(error_t), allocatable, intent(out) :: error     !! what could not be read or written
      integer :: status

      call h5pclose_f(file%transfer, status)
      call h5fclose_f(file%id, status)
      call note(file, status, 'the file cannot be closed (disk full?)')
      file%id = -1
      if (allocated(file%failure)) call raise(error, code_files, file%path//': '//file%failure)
      if (file%parallel) call agree_on_error(file%comm, error)
   end subroutine close_file

   !> Version of the HDF5 library in use, for example 1.10.8.
   function hdf5_version() result(version)
      character(len=:), allocatable :: version
      integer :: major, minor, release, status

      call start_library()
      call h5get_libversion_f(major, minor, release, status)
      version = to_text(major)//'.'//to_text(minor)//'.'//to_text(release)
   end function hdf5_version

   !> Whether a group or dataset is there, and every group above it.
   function has_item(file, name) result(found)
      type(hdf5_file_t), intent(in) :: file   !! searched
      character(len=*), intent(in) :: name    !! for example 'bodies/plate/points'
      logical :: found
      integer :: i, status

      found = .true.
      do i = 2, len(name) + 1
         if (.not. found) return
         if (i <= len(name)) then
            if (name(i:i) /= '/') cycle
         end if
         call h5lexists_f(file%id, name(:i - 1), found, status)
         if (status < 0) found = .false.
      end do
   end function has_item

   !> Keep the first failure of a file.
   subroutine note(file, status, what)
      type(hdf5_file_t), intent(inout) :: file   !! gets the failure
      integer, intent(in) :: status              !! of the HDF5 library: negative where it failed
      character(len=*), intent(in) :: what       !! what could not be done

      if (status < 0 .and. .not. allocated(file%failure)) file%failure = what
   end subroutine note

   !> Type of an integer of a kind, in memory and in the file.
   function integer_type(kind_of) result(type_id)
      integer, intent(in) :: kind_of   !! kind, which is its number of bytes
      integer(hid_t) :: type_id

      type_id = h5kind_to_type(kind_of, H5_INTEGER_KIND)
   end function integer_type

   !> Type of an ASCII text of fixed length, to be closed by the caller.
   function text_type(length) result(type_id)
      integer, intent(in) :: length   !! number of characters, 1 at least
      integer(hid_t) :: type_id
      integer :: status

      call h5tcopy_f(H5T_C_S1, type_id, status)
      call h5tset_size_f(type_id, int(length, size_t), status)
      call h5tset_strpad_f(type_id, H5T_STR_NULLPAD_F, status)
   end function text_type

   !> Set up the library and the lists for opening a file.
   subroutine prepare(file, path, access, comm)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: path
      integer(hid_t), intent(out) :: access
      type(comm_t), intent(in), optional :: comm
      integer :: status

      call start_library()
      file%path = path
      file%parallel = present(comm)
      call h5pcreate_f(H5P_FILE_ACCESS_F, access, status)
      call h5pcreate_f(H5P_DATASET_XFER_F, file%transfer, status)
      if (.not. present(comm)) return
      file%comm = comm
      call h5pset_fapl_mpio_f(access, comm%handle%MPI_VAL, MPI_INFO_NULL%MPI_VAL, status)
      call h5pset_dxpl_mpio_f(file%transfer, H5FD_MPIO_COLLECTIVE_F, status)
   end subroutine prepare

   !> Start the HDF5 library where that is still to be done, and silence its own messages.
   subroutine start_library()
      integer :: status
      logical :: started

      call h5iis_valid_f(H5T_NATIVE_DOUBLE, started, status)
      if (started) return
      call h5open_f(status)
      call h5eset_auto_f(0, status)
   end subroutine start_library
end module xmpm_hdf5_file
