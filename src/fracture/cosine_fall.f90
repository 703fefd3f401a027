!> The fall from 1 to 0 along half a period of a cosine, of which the fields q of domains are made,
!> to rounding from series that a compiler can work out for several places at once.
module xmpm_cosine_fall
   use xmpm_kinds, only: wp, pi
   implicit none
   private

   public :: cosine_fall

   integer, parameter :: last = 8   !! term of both series: the next is below 1e-16
   real(wp), parameter :: order(0:last) = [0.0_wp, 1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 5.0_wp, &
      6.0_wp, 7.0_wp, 8.0_wp]
   real(wp), parameter :: signs(0:last) = [1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, &
      1.0_wp, -1.0_wp, 1.0_wp]
   real(wp), parameter :: of_sine(0:last) = signs/gamma(2*order + 2)
   real(wp), parameter :: of_cosine(0:last) = signs/gamma(2*order + 1)

contains

   !> f = (1 + cos pi t)/2 and its slope, for t from 0 to 1: with x = pi/2 (t - 1/2), that is
   !> 1/2 - sin x cos x and -pi/2 (1 - 2 sin**2 x). Before 0 and from 1 on f is 1 and 0.
   pure subroutine cosine_fall(n, t, f, slope)
      integer, intent(in) :: n
      real(wp), intent(in) :: t(n)
      real(wp), intent(out) :: f(n)       !! 1 to 0
      real(wp), intent(out) :: slope(n)   !! df/dt
      real(wp) :: x, x2, sine, cosine, falls, past
      integer :: i, k

      !$omp simd private(x, x2, sine, cosine, falls, past)
      do i = 1, n
         x = 0.5_wp*pi*(min(max(t(i), 0.0_wp), 1.0_wp) - 0.5_wp)
         x2 = x*x
         sine = of_sine(last)
         cosine = of_cosine(last)
         !GCC$ unroll 8
         do k = last - 1, 0, -1
            sine = of_sine(k) + x2*sine
            cosine = of_cosine(k) + x2*cosine
         end do
         sine = x*sine
         past = merge(1.0_wp, 0.0_wp, t(i) >= 1)
         falls = merge(1.0_wp, 0.0_wp, t(i) > 0)*(1 - past)
         f(i) = falls*(0.5_wp - sine*cosine) + (1 - falls)*(1 - past)
         slope(i) = -falls*0.5_wp*pi*(1 - 2*sine*sine)
      end do
   end subroutine cosine_fall
end module xmpm_cosine_fall
