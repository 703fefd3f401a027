!> Moving least squares: the value at a place from particles around it, by a fit of polynomials
!> with weights that fall with distance.
!>
!> The value is sum_p w_p (c . b_p) f_p with the monomials b_p of the particle's distance and M c =
!> (1, 0, ...), M = sum_p w_p b_p b_p^T. Both are sums over particles, so that ranks only add up.
module xmpm_moving_least_squares
   use xmpm_kinds, only: wp
   implicit none
   private

   public :: monomials, fit_weight, add_moments, fit_coefficients
   public :: n_monomials, n_moments

   integer, parameter :: n_monomials = 10   !! of second order in three dimensions
   integer, parameter :: n_linear = 4       !! the first of them
   integer, parameter :: n_moments = n_monomials*(n_monomials + 1)/2   !! of the symmetric M

   real(wp), parameter :: least_pivot = 1e-6_wp   !! over the diagonal, in the factors of M

contains

   !> 1, x, y, z, then the squares and products; distances over the support.
   pure function monomials(d) result(b)
      real(wp), intent(in) :: d(3)
      real(wp) :: b(n_monomials)

      b = [1.0_wp, d(1), d(2), d(3), d(1)*d(1), d(2)*d(2), d(3)*d(3), d(1)*d(2), d(2)*d(3), &
         d(1)*d(3)]
   end function monomials

   !> Quartic spline, 1 at the place and 0 from the support on.
   pure function fit_weight(z) result(w)
      real(wp), intent(in) :: z   !! distance over the support
      real(wp) :: w

      w = 0
      if (z < 1) w = 1 - z*z*(6 - z*(8 - 3*z))
   end function fit_weight

   !> Add one particle to M, packed row by row up to the diagonal.
   pure subroutine add_moments(w, b, m)
      real(wp), intent(in) :: w, b(n_monomials)
      real(wp), intent(inout) :: m(n_moments)
      integer :: i, k

      k = 0
      do i = 1, n_monomials
         m(k + 1:k + i) = m(k + 1:k + i) + w*b(i)*b(:i)
         k = k + i
      end do
   end subroutine add_moments

   !> Solve M c = (1, 0, ...); with fewer particles than a parabola needs the fit is linear.
   pure subroutine fit_coefficients(m, c, found)
      real(wp), intent(in) :: m(n_moments)
      real(wp), intent(out) :: c(n_monomials)
      logical, intent(out) :: found             !! false where not even a plane can be laid

      call solve_leading(m, n_monomials, c, found)
      if (.not. found) call solve_leading(m, n_linear, c, found)
   end subroutine fit_coefficients

   !> The same with the first n monomials, by Cholesky's factors.
   pure subroutine solve_leading(m, n, c, found)
      real(wp), intent(in) :: m(n_moments)
      integer, intent(in) :: n
      real(wp), intent(out) :: c(n_monomials)
      logical, intent(out) :: found
      real(wp) :: l(n, n)
      integer :: i, j, k

      c = 0
      found = .false.
      k = 0
      do i = 1, n
         do j = 1, i
            k = k + 1
            l(i, j) = m(k) - dot_product(l(i, :j - 1), l(j, :j - 1))
            if (j < i) l(i, j) = l(i, j)/l(j, j)
         end do
         if (.not. l(i, i) > least_pivot*m(k)) return
         l(i, i) = sqrt(l(i, i))
      end do
      c(1) = 1
      do i = 1, n
         c(i) = (c(i) - dot_product(l(i, :i - 1), c(:i - 1)))/l(i, i)
      end do
      do i = n, 1, -1
         c(i) = (c(i) - dot_product(l(i + 1:, i), c(i + 1:n)))/l(i, i)
      end do
      found = .true.
   end subroutine solve_leading
end module xmpm_moving_least_squares
