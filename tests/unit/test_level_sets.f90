!> psi and phi: exact for planes, invariant, with the right sign at folds.
program test_level_sets
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t
   use xmpm_surface, only: surface_t, build_surface
   use xmpm_surface_index, only: surface_index_t, build_index
   use xmpm_front, only: front_t, mark_front, fully_cracked, beyond_reach
   use xmpm_level_sets, only: evaluate_level_sets
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_rectangle, make_disc, &
      make_polygon
   use testing, only: suite_t, check, check_close, finish
   implicit none
   type(suite_t) :: suite
   integer, parameter :: n = 2000
   real(wp), parameter :: reach = 1.5_wp
   real(wp) :: p(3, n), psi(n), phi(n), e1(3, n)

   suite%name = 'level_sets'
   call scatter_points()
   call plane_rectangle()
   call points_on_the_plane()
   call penny()
   call moved_and_turned()
   call turned_over()
   call folded(.true.)
   call folded(.false.)
   call past_a_fold()
   call past_a_bent_rim()
   call partial_front()
   call inner_corner()
   call no_front()
   call speed()
   call finish(suite)

contains

   !> Points in a box around the crack, some exactly on its plane and on its lines.
   subroutine scatter_points()
      integer :: i

      do i = 1, n
         p(:, i) = [5.0_wp, 3.0_wp, 1.6_wp]*([halton(i, 2), halton(i, 3), halton(i, 5)] - 0.5_wp)
      end do
      p(3, 1:n:7) = 0.0_wp
      p(1, 1:n:11) = 1.0_wp
      p(2, 1:n:13) = -0.5_wp
   end subroutine scatter_points

   !> Level sets of a mesh with the boundary edges whose middles are in `fronts` as fronts.
   subroutine evaluate(x, tri, all_front, points)
      real(wp), intent(in) :: x(:, :), points(:, :)
      integer, intent(in) :: tri(:, :)
      logical, intent(in) :: all_front
      type(surface_t) :: surface
      type(surface_index_t) :: index
      type(front_t) :: front
      type(error_t), allocatable :: error
      logical, allocatable :: inside(:)

      call build_surface(x, tri, surface, error)
      call build_index(surface, index)
      allocate (inside(size(surface%boundary)), source=all_front)
      call mark_front(surface, inside, front)
      call evaluate_level_sets(surface, index, front, reach, points, psi, phi, e1)
   end subroutine evaluate

   !> Signed distance to a 2 x 1 rectangle in its plane, and its gradient is of length one.
   subroutine plane_rectangle()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      type(error_t), allocatable :: error
      real(wp) :: d(2), flat, far(2)
      integer :: i

      call make_rectangle(crack_plane_t(), [2.0_wp, 1.0_wp], 0.25_wp, x, tri, error)
      call evaluate(x, tri, .true., p)
      far = 0.0_wp
      do i = 1, n
         d = abs(p(1:2, i)) - [1.0_wp, 0.5_wp]
         flat = norm2(max(d, 0.0_wp)) + min(maxval(d), 0.0_wp)
         if (norm2([max(flat, 0.0_wp), p(3, i)]) > reach) cycle
         if (flat < 0.0_wp .and. norm2([flat, p(3, i)]) > reach) cycle
         far(1) = max(far(1), abs(psi(i) - p(3, i)))
         far(2) = max(far(2), abs(phi(i) - flat), abs(norm2(e1(:, i)) - 1.0_wp))
      end do
      ! coordinates of order one and a dozen operations: a few units of rounding
      call check_close(suite, 'psi of a plane is exact, beyond its edges too', far(1), 0.0_wp, &
         1.0e-14_wp, 0.0_wp)
      call check_close(suite, 'phi of a rectangle is exact, around its corners too', far(2), &
         0.0_wp, 1.0e-14_wp, 0.0_wp)
      call check(suite, 'a point beyond the reach says so', any(psi >= beyond_reach) .and. &
         all((psi >= beyond_reach) .eqv. (phi >= beyond_reach)))
   end subroutine plane_rectangle

   !> Points on a tilted plane: psi is exactly zero, wherever rounding puts the point.
   subroutine points_on_the_plane()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      type(crack_plane_t) :: plane
      type(error_t), allocatable :: error
      real(wp) :: q(3, n)
      integer :: i

      call set_plane([0.1_wp, 0.7_wp, -0.3_wp], [1.0_wp, 2.0_wp, 0.3_wp], [-2.0_wp, 1.0_wp, &
         0.0_wp], plane, error)
      call make_rectangle(plane, [2.0_wp, 1.0_wp], 0.25_wp, x, tri, error)
      do i = 1, n
         q(:, i) = plane%centre + p(1, i)*0.4_wp*plane%along + p(2, i)*0.4_wp*plane%across
      end do
      call evaluate(x, tri, .true., q)
      call check(suite, 'psi of points on a tilted plane is exactly zero', all(abs(psi) <= 0.0_wp))
   end subroutine points_on_the_plane

   !> A disc: phi is the distance to the circle within the height of a chord.
   subroutine penny()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      type(error_t), allocatable :: error
      real(wp) :: worst, flat
      integer :: i

      call make_disc(crack_plane_t(), 1.0_wp, 0.1_wp, x, tri, error)
      call evaluate(x, tri, .true., p)
      worst = 0.0_wp
      do i = 1, n
         flat = norm2(p(1:2, i)) - 1.0_wp
         if (phi(i) > 1.0_wp .or. phi(i) <= fully_cracked) cycle
         worst = max(worst, abs(phi(i) - flat))
      end do
      ! the middle of one of 60 chords lies 1 - cos(pi/60) = 0.00137 inside the circle
      call check_close(suite, 'phi of a disc is the distance to its circle', worst, 0.0_wp, &
         0.00138_wp, 0.0_wp)
   end subroutine penny

   !> Turning and moving crack and points together changes nothing.
   subroutine moved_and_turned()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      type(error_t), allocatable :: error
      real(wp) :: turn(3, 3), psi0(n), phi0(n), shift(3), worst
      logical :: near(n)

      call bent_disc(x, tri, error)
      call evaluate(x, tri, .true., p)
      psi0 = psi
      phi0 = phi
      turn = rotation([0.3_wp, -1.1_wp, 0.7_wp])
      shift = [3.0_wp, -2.0_wp, 5.0_wp]
      call evaluate(matmul(turn, x) + spread(shift, 2, size(x, 2)), tri, .true., matmul(turn, p) &
         + spread(shift, 2, n))
      near = psi0 < beyond_reach .and. psi < beyond_reach
      ! coordinates of order ten: rounding of 1e-15 times the operations
      worst = maxval(abs(psi - psi0), near)
      call check_close(suite, 'psi does not depend on place and direction', worst, 0.0_wp, &
         1.0e-13_wp, 0.0_wp)
      near = near .and. phi0 > fully_cracked .and. phi > fully_cracked
      ! the length of a vector behind the front is divided by, so a point near a node gains rounding
      worst = maxval(abs(phi - phi0), near)
      call check_close(suite, 'phi does not depend on place and direction', worst, 0.0_wp, &
         1.0e-11_wp, 0.0_wp)
   end subroutine moved_and_turned

   subroutine bent_disc(x, tri, error)
      real(wp), allocatable, intent(out) :: x(:, :)
      integer, allocatable, intent(out) :: tri(:, :)
      type(error_t), allocatable, intent(out) :: error

      call make_disc(crack_plane_t(), 1.0_wp, 0.15_wp, x, tri, error)
      x(3, :) = 0.2_wp*sin(2.0_wp*x(1, :)) + 0.1_wp*x(2, :)**2
   end subroutine bent_disc

   !> Exchanging two vertices of every triangle exchanges the sides.
   subroutine turned_over()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      type(error_t), allocatable :: error
      real(wp) :: psi0(n), phi0(n)
      logical :: near(n)

      call bent_disc(x, tri, error)
      call evaluate(x, tri, .true., p)
      psi0 = psi
      phi0 = phi
      call evaluate(x, tri([1, 3, 2], :), .true., p)
      near = psi0 < beyond_reach
      ! the same distances; the nearest point may be computed from another corner of its triangle
      call check_close(suite, 'turning the surface over turns psi over', maxval(abs(psi + psi0), &
         near), 0.0_wp, &
         1.0e-14_wp, 0.0_wp)
      call check_close(suite, 'turning the surface over leaves phi', maxval(abs(phi - phi0), &
         near), 0.0_wp, &
         1.0e-11_wp, 0.0_wp)
   end subroutine turned_over

   !> A sheet folded by 100 degrees along x = 0, upwards or downwards: the sign is that of the
   !> wedge.
   subroutine folded(upwards)
      logical, intent(in) :: upwards
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      type(error_t), allocatable :: error
      real(wp) :: angle, sense, height, wedge, q(3, n)
      logical :: right
      integer :: i

      call make_rectangle(crack_plane_t(), [4.0_wp, 6.0_wp], 0.5_wp, x, tri, error)
      sense = merge(1.0_wp, -1.0_wp, upwards)
      angle = sense*50.0_wp*pi/180.0_wp
      do i = 1, size(x, 2)
         x(:, i) = [x(1, i)*cos(angle), x(2, i), abs(x(1, i))*sin(angle)]
      end do
      q = 0.5_wp*p
      call evaluate(x, tri, .true., q)
      right = .true.
      do i = 1, n
         height = q(3, i) - abs(q(1, i))*tan(angle)
         wedge = height*cos(angle)
         if (abs(wedge) > 1.0e-12_wp) right = right .and. (psi(i) > 0.0_wp .eqv. wedge > 0.0_wp)
         if (sense*wedge > 0.0_wp) right = right .and. abs(psi(i) - wedge) < 1.0e-14_wp
      end do
      call check(suite, 'psi has the right sign at a fold and the right size inside it', right)
   end subroutine folded

   !> Past the rim of a folded sheet psi is that of the plane of the nearest sheet.
   subroutine past_a_fold()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      type(error_t), allocatable :: error
      real(wp), parameter :: slope = 1.0_wp
      real(wp) :: q(3, n), worst, height
      integer :: i

      call make_rectangle(crack_plane_t(), [4.0_wp, 1.0_wp], 0.5_wp, x, tri, error)
      x(3, :) = slope*abs(x(1, :))
      do i = 1, n
         height = 0.2_wp*sin(real(i, wp))
         q(1, i) = merge(0.3_wp, -0.3_wp, modulo(i, 2) == 0)
         q(2, i) = 0.51_wp + 0.2_wp*halton(i, 3)
         q(3, i) = slope*abs(q(1, i)) + height
      end do
      call evaluate(x, tri, .true., q)
      worst = maxval(abs(psi - (q(3, :) - slope*abs(q(1, :)))/sqrt(1.0_wp + slope**2)))
      ! a dozen operations on numbers of order one
      call check_close(suite, 'past the end of a fold psi is that of the nearer sheet', worst, &
         0.0_wp, 1.0e-14_wp, 0.0_wp)
   end subroutine past_a_fold

   !> Around a bent disc, 0.3 outside of its rim, psi has no jumps from edge to edge.
   subroutine past_a_bent_rim()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      type(error_t), allocatable :: error
      real(wp) :: q(3, n), angle
      integer :: i

      call make_disc(crack_plane_t(), 1.0_wp, 0.2_wp, x, tri, error)
      x(3, :) = 0.5_wp*x(1, :)*x(2, :)
      do i = 1, n
         angle = 2.0_wp*pi*real(i, wp)/real(n, wp)
         q(:, i) = [1.3_wp*cos(angle), 1.3_wp*sin(angle), 0.2_wp]
      end do
      call evaluate(x, tri, .true., q)
      ! steps of 0.004 in space and a slope of psi of order one
      call check_close(suite, 'past a bent rim psi is continuous', &
         maxval(abs(psi(2:) - psi(:n - 1))), &
         0.0_wp, 0.008_wp, 0.0_wp)
   end subroutine past_a_bent_rim

   !> An L of which one edge at the inner corner is a front: the rest of the L stays behind it.
   subroutine inner_corner()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      type(error_t), allocatable :: error
      type(surface_t) :: surface
      type(surface_index_t) :: index
      type(front_t) :: front
      logical, allocatable :: inside(:)
      real(wp), parameter :: corners(3, 6) = reshape([0.0_wp, 0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, &
         0.0_wp, &
         2.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 0.0_wp, 0.0_wp, 2.0_wp, &
         0.0_wp], [3, 6])
      real(wp), parameter :: points(3, 2) = reshape([0.9_wp, 1.1_wp, 0.05_wp, 0.9_wp, 0.9_wp, &
         -0.05_wp], [3, 2])
      integer :: i, e

      call make_polygon(corners, 0.25_wp, x, tri, error)
      call build_surface(x, tri, surface, error)
      call build_index(surface, index)
      allocate (inside(size(surface%boundary)))
      do i = 1, size(inside)
         e = surface%boundary(i)
         inside(i) = all(abs(x(2, surface%edge(:, e)) - 1.0_wp) < 1.0e-9_wp)
      end do
      call mark_front(surface, inside, front)
      call evaluate_level_sets(surface, index, front, 1.0_wp, points, psi(:2), phi(:2), e1(:, :2))
      ! both points are 0.1 from the corner along x, y and 0.05 off the surface
      call check_close(suite, 'a point of the surface beside an open end stays behind the front', &
         phi(1), &
         -0.15_wp, 1.0e-14_wp, 0.0_wp)
      call check_close(suite, 'a point behind an open end counts from the line of the front', &
         phi(2), &
         -0.1_wp, 1.0e-14_wp, 0.0_wp)
   end subroutine inner_corner

   !> Only the edges at x = +-1 are fronts: they go on straight, and far from them the crack goes
   !> through.
   subroutine partial_front()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      type(error_t), allocatable :: error
      type(surface_t) :: surface
      type(surface_index_t) :: index
      type(front_t) :: front
      logical, allocatable :: inside(:)
      logical :: right
      integer :: i, e

      call make_rectangle(crack_plane_t(), [2.0_wp, 1.0_wp], 0.25_wp, x, tri, error)
      call build_surface(x, tri, surface, error)
      call build_index(surface, index)
      allocate (inside(size(surface%boundary)))
      do i = 1, size(inside)
         e = surface%boundary(i)
         inside(i) = all(abs(abs(x(1, surface%edge(:, e))) - 1.0_wp) < 1.0e-9_wp) &
            .and. all(abs(x(2, surface%edge(:, e))) < 0.3_wp)
      end do
      call mark_front(surface, inside, front)
      call evaluate_level_sets(surface, index, front, 0.7_wp, p, psi, phi, e1)
      right = .true.
      do i = 1, n
         if (psi(i) >= beyond_reach) cycle
         if (phi(i) <= fully_cracked) then
            right = right .and. (norm2([abs(p(1, i)) - 1.0_wp, max(abs(p(2, i)) - 0.25_wp, &
               0.0_wp), p(3, i)]) > 0.6999_wp)
         else
            right = right .and. abs(phi(i) - (abs(p(1, i)) - 1.0_wp)) < 1.0e-14_wp
         end if
      end do
      call check(suite, 'a front goes on straight past its ends; without a front near '// &
         'the crack goes through', right)
      call check(suite, 'both kinds of points were met', any(phi <= fully_cracked) .and. &
         any(abs(phi) < 1.0_wp))
   end subroutine partial_front

   subroutine no_front()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      type(error_t), allocatable :: error

      call make_rectangle(crack_plane_t(), [2.0_wp, 1.0_wp], 0.25_wp, x, tri, error)
      call evaluate(x, tri, .false., p)
      call check(suite, 'a crack without front goes through everywhere', &
         all(psi >= beyond_reach .or. phi <= fully_cracked) .and. any(phi <= fully_cracked))
   end subroutine no_front

   !> Microseconds a point; printed, not judged, since the machine may be shared.
   subroutine speed()
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)
      type(error_t), allocatable :: error
      type(surface_t) :: surface
      type(surface_index_t) :: index
      type(front_t) :: front
      logical, allocatable :: inside(:)
      real(wp) :: q(3, n), from, to
      integer :: i, round

      call make_disc(crack_plane_t(), 1.0_wp, 0.11_wp, x, tri, error)
      call build_surface(x, tri, surface, error)
      call build_index(surface, index)
      allocate (inside(size(surface%boundary)), source=.true.)
      call mark_front(surface, inside, front)
      do i = 1, n
         q(:, i) = [-1.3_wp + 2.6_wp*real(i, wp)/real(n, wp), 2.0_wp*halton(i, 2) - 1.0_wp, &
            0.6_wp*halton(i, 3) - 0.3_wp]
      end do
      call cpu_time(from)
      do round = 1, 10
         call evaluate_level_sets(surface, index, front, 0.4_wp, q, psi, phi, e1)
      end do
      call cpu_time(to)
      print '(a,i0,a,f6.3,a)', 'level sets at a surface of ', surface%triangle_count, &
         ' triangles: ', &
         (to - from)*1.0e6_wp/real(10*n, wp), ' microseconds a point'
   end subroutine speed

   !> Rotation by a vector of angle times axis (Rodrigues).
   pure function rotation(v) result(r)
      real(wp), intent(in) :: v(3)
      real(wp) :: r(3, 3), k(3, 3), angle
      integer :: i

      angle = norm2(v)
      k = reshape([0.0_wp, v(3), -v(2), -v(3), 0.0_wp, v(1), v(2), -v(1), 0.0_wp], [3, 3])/angle
      r = sin(angle)*k + (1.0_wp - cos(angle))*matmul(k, k)
      do i = 1, 3
         r(i, i) = r(i, i) + 1.0_wp
      end do
   end function rotation

   !> Low-discrepancy points in (0, 1).
   pure function halton(i, base) result(value)
      integer, intent(in) :: i, base
      real(wp) :: value, part
      integer :: rest

      value = 0.0_wp
      part = 1.0_wp
      rest = i
      do while (rest > 0)
         part = part/real(base, wp)
         value = value + part*real(modulo(rest, base), wp)
         rest = rest/base
      end do
   end function halton
end program test_level_sets
