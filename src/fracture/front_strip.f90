!> Triangles between an old front and a new one, or between two fronts that have met.
module xmpm_front_strip
   use xmpm_kinds, only: wp
   use xmpm_vectors, only: cross
   implicit none
   private

   public :: strip_between

   real(wp), parameter :: folded = 1.0e6_wp   !! cost of a triangle that lies on its face, over the
                                              !! square of the diagonal

contains

   !> Triangles between two lines of vertices, right-handed about the normal.
   !>
   !> Both lines run along e3, the new one ahead. A vertex that is in both stays where it is, and
   !> the strip closes there. Of all strips the one with the shortest diagonals and no triangle on
   !> its face is taken (dynamic programming).
   pure subroutine strip_between(old, new, closed, x, normal, tri)
      integer, intent(in) :: old(:)                  !! vertices of the old line
      integer, intent(in) :: new(:)                  !! vertices of the new line
      logical, intent(in) :: closed                  !! whether the lines are closed
      real(wp), intent(in) :: x(:, :)                !! (3,nv) positions [length]
      real(wp), intent(in) :: normal(:, :)           !! (3,size(old)) normals at the old line
      integer, allocatable, intent(out) :: tri(:, :) !! (3,nt)
      integer, allocatable :: a(:), b(:), order(:), part(:, :)
      integer :: i, j, i0, j0

      allocate (tri(3, 0))
      order = [(i, i=1, size(old))]
      b = new
      if (closed) then
         call common_start(old, new, x, i0, j0)
         order = [cshift(order, i0 - 1), i0]
         b = [cshift(new, j0 - 1), new(j0)]
      end if
      a = old(order)
      i0 = 1
      j0 = 1
      do j = 2, size(b)
         i = place_of(b(j), a, i0 + 1)
         if (closed .and. j == size(b)) i = size(a)
         if (i == 0 .and. j < size(b)) cycle
         if (i == 0) i = size(a)
         call fill_section(a(i0:i), b(j0:j), x, normal(:, order(i0:i)), part)
         tri = reshape([tri, part], [3, size(tri, 2) + size(part, 2)])
         i0 = i
         j0 = j
      end do
   end subroutine strip_between

   !> Where two closed lines begin: at a common vertex, or else at the new vertex nearest to the
   !> first old one.
   pure subroutine common_start(old, new, x, i0, j0)
      integer, intent(in) :: old(:), new(:)
      real(wp), intent(in) :: x(:, :)
      integer, intent(out) :: i0, j0
      real(wp) :: best, d
      integer :: j

      do i0 = 1, size(old)
         j0 = place_of(old(i0), new, 1)
         if (j0 > 0) return
      end do
      i0 = 1
      j0 = 1
      best = huge(1.0_wp)
      do j = 1, size(new)
         d = sum((x(:, new(j)) - x(:, old(1)))**2)
         if (.not. d < best) cycle
         best = d
         j0 = j
      end do
   end subroutine common_start

   pure function place_of(vertex, list, first) result(place)
      integer, intent(in) :: vertex, list(:), first
      integer :: place

      do place = first, size(list)
         if (list(place) == vertex) return
      end do
      place = 0
   end function place_of

   !> Triangles of a section whose ends, and nothing else, may be common to both lines.
   pure subroutine fill_section(a, b, x, normal, tri)
      integer, intent(in) :: a(:), b(:)
      real(wp), intent(in) :: x(:, :), normal(:, :)
      integer, allocatable, intent(out) :: tri(:, :)
      integer :: m, n, low(2), high(2), i, j
      integer, allocatable :: middle(:, :)

      m = size(a)
      n = size(b)
      allocate (tri(3, 0))
      if (m == 2 .and. n == 2 .and. a(1) == b(1) .and. a(m) == b(n)) return
      low = 1
      high = [m, n]
      if (a(1) == b(1)) then
         low = 2
         tri = reshape([a(1), a(2), b(2)], [3, 1])
      end if
      if (a(m) == b(n) .and. (m > 2 .or. a(1) /= b(1))) high = [m - 1, n - 1]
      call cheapest_strip(a(low(1):high(1)), b(low(2):high(2)), x, &
         normal(:, low(1):high(1)), middle)
      tri = reshape([tri, middle], [3, size(tri, 2) + size(middle, 2)])
      i = high(1)
      j = high(2)
      if (i < m) tri = reshape([tri, a(i), a(m), b(j)], [3, size(tri, 2) + 1])
   end subroutine fill_section

   !> The strip of least cost between two lines without a common vertex.
   pure subroutine cheapest_strip(a, b, x, normal, tri)
      integer, intent(in) :: a(:), b(:)
      real(wp), intent(in) :: x(:, :), normal(:, :)
      integer, allocatable, intent(out) :: tri(:, :)
      real(wp), allocatable :: cost(:, :)
      logical, allocatable :: along_old(:, :)
      real(wp) :: one, two
      integer :: i, j, k

      allocate (cost(size(a), size(b)), along_old(size(a), size(b)))
      do j = 1, size(b)
         do i = 1, size(a)
            if (i == 1 .and. j == 1) then
               cost(i, j) = 0.0_wp
               cycle
            end if
            one = huge(1.0_wp)
            two = huge(1.0_wp)
            if (i > 1) one = cost(i - 1, j) + triangle_cost(x(:, a(max(1, i - 1))), x(:, a(i)), &
               x(:, b(j)), normal(:, i))
            if (j > 1) two = cost(i, j - 1) + triangle_cost(x(:, a(i)), x(:, b(j)), &
               x(:, b(max(1, j - 1))), normal(:, i))
            along_old(i, j) = one <= two
            cost(i, j) = min(one, two) + sum((x(:, a(i)) - x(:, b(j)))**2)
         end do
      end do
      allocate (tri(3, size(a) + size(b) - 2))
      i = size(a)
      j = size(b)
      do k = size(tri, 2), 1, -1
         if (along_old(i, j)) then
            tri(:, k) = [a(i - 1), a(i), b(j)]
            i = i - 1
         else
            tri(:, k) = [a(i), b(j), b(j - 1)]
            j = j - 1
         end if
      end do
   end subroutine cheapest_strip

   !> Nothing, or much for a triangle on its face.
   pure function triangle_cost(p, q, r, normal) result(cost)
      real(wp), intent(in) :: p(3), q(3), r(3), normal(3)
      real(wp) :: cost

      cost = 0.0_wp
      if (dot_product(cross(q - p, r - p), normal) > 0.0_wp) return
      cost = folded*(sum((q - p)**2) + sum((r - p)**2))
   end function triangle_cost
end module xmpm_front_strip
