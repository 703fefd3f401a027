!> Number kinds and mathematical constants.
module xmpm_kinds
   use, intrinsic :: iso_fortran_env, only: real64, real32, int64, int32, int8
   implicit none
   private

   public :: wp, sp, i1, i4, i8, pi

   integer, parameter :: wp = real64   !! working precision
   integer, parameter :: sp = real32   !! precision of field output
   integer, parameter :: i1 = int8     !! small flags
   integer, parameter :: i4 = int32    !! default integer
   integer, parameter :: i8 = int64    !! ids, counts and keys
   real(wp), parameter :: pi = acos(-1.0_wp)
end module xmpm_kinds
