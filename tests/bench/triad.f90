!> Memory bandwidth of one core: a = b + s c over arrays far larger than the caches.
!>
!> Prints the best of several passes in GB/s, counting two reads and one write of 8 bytes an entry.
!> The hidden read of a before it is written is not counted, as is the custom.
program triad
   use, intrinsic :: iso_fortran_env, only: real64, int64
   implicit none
   integer, parameter :: n = 20000000
   integer, parameter :: passes = 12
   real(real64), allocatable :: a(:), b(:), c(:)
   integer(int64) :: start, finish, rate
   real(real64) :: best
   integer :: pass, i

   allocate (a(n), b(n), c(n))
   a = 0.0_real64
   b = 1.0_real64
   c = 2.0_real64
   best = huge(best)
   do pass = 1, passes
      call system_clock(start, rate)
      do i = 1, n
         a(i) = b(i) + 3.0_real64*c(i)
      end do
      call system_clock(finish)
      best = min(best, real(finish - start, real64)/real(rate, real64))
      b(pass) = a(n - pass)   ! a pass depends on the last one, so none is left out
   end do
   if (sum(a(:10)) < 0.0_real64) print '(a)', 'never'
   print '(f0.3)', 24.0_real64*real(n, real64)/best/1.0e9_real64
end program triad
