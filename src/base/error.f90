!> The one way in which a procedure reports that it could not do its work.
module xmpm_error
   implicit none
   private

   public :: error_t, raise, add_context
   public :: code_usage, code_numerics, code_files, code_parallel, code_stopped

   integer, parameter :: code_usage = 2      !! usage or deck
   integer, parameter :: code_numerics = 3   !! NaN, lost particle, collapsed step, energy error
   integer, parameter :: code_files = 4      !! a file cannot be read or written
   integer, parameter :: code_parallel = 5   !! partition or MPI
   integer, parameter :: code_stopped = 75   !! stopped early with a valid checkpoint

   !> A failure: allocated where something went wrong, unallocated where all is well.
   type :: error_t
      integer :: code = code_usage              !! exit code of the program
      character(len=:), allocatable :: message  !! where, what, and what is allowed; lines split by
                                                !! new_line
   end type error_t

contains

   !> Report a failure through `error`.
   subroutine raise(error, code, message)
      type(error_t), allocatable, intent(out) :: error   !! set on return
      integer, intent(in) :: code                        !! one of the codes of this module
      character(len=*), intent(in) :: message            !! where, what, and what is allowed

      allocate (error)
      error%code = code
      error%message = message
   end subroutine raise

   !> Put the place where a failure was met before its message; does nothing where there is none.
   subroutine add_context(error, place)
      type(error_t), allocatable, intent(inout) :: error   !! failure, if any
      character(len=*), intent(in) :: place                !! for example 'deck.inp:12'

      if (allocated(error)) error%message = place//': '//error%message
   end subroutine add_context
end module xmpm_error
