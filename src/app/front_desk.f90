!> What the program says without running: help, version, keywords; and its last word.
module xmpm_front_desk
   use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t
   use xmpm_command_line, only: options_t, help_text
   use xmpm_keywords_text, only: keyword_table_text
   use xmpm_hdf5_file, only: hdf5_version
   use xmpm_provenance, only: mpi_version
   use xmpm_build_info, only: version, git_hash, compiler, flags, metis_version
   implicit none
   private

   public :: answer, complain_and_code

contains

   !> Print what was asked for, if anything.
   subroutine answer(options, answered)
      type(options_t), intent(in) :: options
      logical, intent(out) :: answered   !! whether the program is done

      answered = options%help .or. options%version .or. options%keywords
      if (options%help) then
         write (output_unit, '(a)') help_text()
      else if (options%version) then
         write (output_unit, '(a)') version_text()
      else if (options%keywords) then
         write (output_unit, '(a)') keyword_table_text(options%markdown)
      end if
   end subroutine answer

   !> Version, source and libraries.
   function version_text() result(text)
      character(len=:), allocatable :: text
      character(len=1), parameter :: nl = new_line('a')

      text = 'xmpm3d '//version//nl//'source    '//git_hash//nl//'compiler  '//compiler//nl// &
         'flags     '//flags//nl//'MPI       '//mpi_version()//nl//'HDF5      '//hdf5_version()// &
         nl// &
         'METIS     '//metis_version
   end function version_text

   !> Print a failure on standard error of rank 0 and give the exit code.
   function complain_and_code(comm, error) result(code)
      type(comm_t), intent(in) :: comm
      type(error_t), allocatable, intent(in) :: error
      integer :: code

      code = 0
      if (.not. allocated(error)) return
      code = error%code
      if (comm%rank == 0) write (error_unit, '(a)') 'xmpm3d: '//error%message
   end function complain_and_code
end module xmpm_front_desk
