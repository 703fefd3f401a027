!> The fall from 1 to 0 along half a period of a cosine, of which the fields q of domains are made,
!> to rounding from series that a compiler can work out for several places at once.
module xmpm_cosine_fall
   use xmpm_kinds, only: wp, pi
   implicit none
   private

   public :: cosine_fall

   integer, parameter :: last = 10   !! term of both series: the next is below 1e-15
   real(wp), parameter :: order(0:last) = [0.0_wp, 1.0_wp, 2.0_wp, 3.0_wp, 4.0_wp, 5.0_wp, &
      6.0_wp, 7.0_wp, 8.0_wp, 9.0_wp, 10.0_wp]
   real(wp), parameter :: signs(0:last) = [1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, &
      1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp]
   real(wp), parameter :: of_sine(0:last) = signs/gamma(2*order + 2)
   real(wp), parameter :: of_cosine(0:last) = signs/gamma(2*order + 1)

contains

   !> f = (1 + cos pi t)/2 and its slope, for t from 0 to 1: with x = pi (t - 1/2), that is
   !> (1 - sin x)/2 and -pi/2 cos x.
   pure subroutine cosine_fall(t, f, slope)
      real(wp), intent(in) :: t
      real(wp), intent(out) :: f       !! 1 to 0
      real(wp), intent(out) :: slope   !! df/dt
      real(wp) :: x, x2, sine, cosine
      integer :: k

      x = pi*(t - 0.5_wp)
      x2 = x*x
      sine = of_sine(last)
      cosine = of_cosine(last)
      do k = last - 1, 0, -1
         sine = of_sine(k) + x2*sine
         cosine = of_cosine(k) + x2*cosine
      end do
      f = 0.5_wp - 0.5_wp*x*sine
      slope = -0.5_wp*pi*cosine
   end subroutine cosine_fall
end module xmpm_cosine_fall
