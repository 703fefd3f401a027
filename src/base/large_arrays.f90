!> Where large arrays begin: at a page of 2 MB, with large pages under them.
!>
!> A chunk of particles and a row of the grid are whole lines of the cache, but the C library starts
!> a large block 16 bytes behind one, so that each access would touch two lines; and with pages of
!> 4 KB a walk over many megabytes misses the table of addresses again and again. The linker's
!> option `--wrap=malloc` sends what ALLOCATE asks for through here.
module xmpm_large_arrays
   use, intrinsic :: iso_c_binding, only: c_int, c_null_ptr, c_ptr, c_size_t
   implicit none
   private

   public :: place_array

   integer(c_size_t), parameter :: page = 2_c_size_t**21    !! bytes of a large page
   integer(c_size_t), parameter :: large = page/2           !! smaller blocks stay as they are
   integer(c_int), parameter :: huge_pages = 14             !! MADV_HUGEPAGE of Linux

   interface
      !> malloc(3) itself.
      function plain_malloc(bytes) bind(c, name='__real_malloc') result(place)
         import :: c_ptr, c_size_t
         integer(c_size_t), value :: bytes
         type(c_ptr) :: place
      end function plain_malloc

      !> posix_memalign(3).
      function aligned_malloc(place, alignment, bytes) bind(c, name='posix_memalign') result(code)
         import :: c_int, c_ptr, c_size_t
         type(c_ptr), intent(out) :: place
         integer(c_size_t), value :: alignment, bytes
         integer(c_int) :: code
      end function aligned_malloc

      !> madvise(2); a system that does not know the advice answers with an error and does nothing.
      function advise(place, bytes, advice) bind(c, name='madvise') result(code)
         import :: c_int, c_ptr, c_size_t
         type(c_ptr), value :: place
         integer(c_size_t), value :: bytes
         integer(c_int), value :: advice
         integer(c_int) :: code
      end function advise
   end interface

contains

   !> Memory for an array, null where there is none; free(3) takes it back.
   function place_array(bytes) bind(c, name='__wrap_malloc') result(place)
      integer(c_size_t), value :: bytes
      type(c_ptr) :: place
      integer(c_int) :: code

      if (bytes < large) then
         place = plain_malloc(bytes)
      else if (aligned_malloc(place, page, bytes) /= 0) then
         place = c_null_ptr
      else
         code = advise(place, bytes, huge_pages)
      end if
   end function place_array
end module xmpm_large_arrays
