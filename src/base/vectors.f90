!> Products and lengths of vectors in space, and the inverse of a matrix.
module xmpm_vectors
   use xmpm_kinds, only: wp
   implicit none
   private

   public :: cross, unit_vector, angle_between, inverse

contains

   !> Vector product a x b.
   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3)   !! first factor
      real(wp), intent(in) :: b(3)   !! second factor
      real(wp) :: c(3)

      c(1) = a(2)*b(3) - a(3)*b(2)
      c(2) = a(3)*b(1) - a(1)*b(3)
      c(3) = a(1)*b(2) - a(2)*b(1)
   end function cross

   !> The vector of length one along `a`; zero where `a` is zero.
   pure function unit_vector(a) result(u)
      real(wp), intent(in) :: a(3)   !! any vector
      real(wp) :: u(3), length

      length = sqrt(a(1)*a(1) + a(2)*a(2) + a(3)*a(3))
      u = 0.0_wp
      if (length > 0.0_wp) u = a/length
   end function unit_vector

   !> Angle between two vectors, from 0 to pi; accurate for small angles too.
   pure function angle_between(a, b) result(angle)
      real(wp), intent(in) :: a(3)   !! first vector
      real(wp), intent(in) :: b(3)   !! second vector
      real(wp) :: angle              !! [rad]

      angle = atan2(norm2(cross(a, b)), dot_product(a, b))
   end function angle_between

   !> Inverse of a matrix of three rows; its determinant must not be 0.
   pure function inverse(a) result(b)
      real(wp), intent(in) :: a(3, 3)   !! regular matrix
      real(wp) :: b(3, 3)

      b(1, :) = cross(a(:, 2), a(:, 3))
      b(2, :) = cross(a(:, 3), a(:, 1))
      b(3, :) = cross(a(:, 1), a(:, 2))
      b = b*(1/dot_product(a(:, 1), b(1, :)))
   end function inverse
end module xmpm_vectors
