!> Asking for memory before it is used.
!>
!> Particles stream through the cache three times a step, and the processor's own guess of what
!> comes next fails wherever chunks are not in order. Fortran has no word for this, so that fetch.c
!> says it; it changes nothing but the time.
module xmpm_fetch
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   implicit none
   private

   public :: fetch_lines

   interface
      !> Let an array come into the cache; the call does not wait for it.
      pure subroutine fetch_lines(values, n) bind(c, name='xmpm_fetch_lines')
         import :: c_double, c_int
         integer(c_int), value :: n                !! number of values
         real(c_double), intent(in) :: values(n)   !! from the beginning of a line of the cache on
      end subroutine fetch_lines
   end interface
end module xmpm_fetch
