!> Folders and files of the operating system: make, rename, remove.
module xmpm_file_system
   use, intrinsic :: iso_c_binding, only: c_int, c_char, c_null_char
   use xmpm_error, only: error_t, raise, code_files
   implicit none
   private

   public :: make_folder, rename_file, remove_file, file_exists

   interface
      function c_mkdir(path, mode) result(status) bind(c, name='mkdir')
         import :: c_int, c_char
         implicit none
         ! allow(assumed-size)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode   ! mode_t, passed like an int by the platforms we know
         integer(c_int) :: status
      end function c_mkdir

      function c_rename(from, to) result(status) bind(c, name='rename')
         import :: c_int, c_char
         implicit none
         ! allow(assumed-size)
         character(kind=c_char), intent(in) :: from(*), to(*)
         integer(c_int) :: status
      end function c_rename

      function c_remove(path) result(status) bind(c, name='remove')
         import :: c_int, c_char
         implicit none
         ! allow(assumed-size)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: status
      end function c_remove
   end interface

contains

   !> Make a folder and those above it; one that exists is fine.
   subroutine make_folder(path, error)
      character(len=*), intent(in) :: path               !! for example 'results/plate_particles'
      type(error_t), allocatable, intent(out) :: error   !! no permission, or a file in the way
      integer :: i
      integer(c_int) :: status

      do i = 2, len(path)
         if (path(i:i) == '/') status = c_mkdir(path(:i - 1)//c_null_char, int(o'777', c_int))
      end do
      if (len(path) > 0) status = c_mkdir(path//c_null_char, int(o'777', c_int))
      if (.not. file_exists(path//'/.')) then
         call raise(error, code_files, path//': the folder cannot be made')
      end if
   end subroutine make_folder

   !> Give a file its final name in one step, replacing what has that name.
   subroutine rename_file(from, to, error)
      character(len=*), intent(in) :: from               !! present name
      character(len=*), intent(in) :: to                 !! new name on the same disk
      type(error_t), allocatable, intent(out) :: error   !! the file cannot be renamed

      if (c_rename(from//c_null_char, to//c_null_char) /= 0) then
         call raise(error, code_files, from//': cannot be renamed to '//to)
      end if
   end subroutine rename_file

   !> Remove a file; one that does not exist is fine.
   subroutine remove_file(path)
      character(len=*), intent(in) :: path   !! removed
      integer(c_int) :: status

      status = c_remove(path//c_null_char)
   end subroutine remove_file

   !> Whether a file is there.
   function file_exists(path) result(found)
      character(len=*), intent(in) :: path   !! looked for
      logical :: found

      inquire (file=path, exist=found)
   end function file_exists
end module xmpm_file_system
