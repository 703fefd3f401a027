!> Fronts: which edges they are, their chains, frames and lengths.
program test_front
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t
   use xmpm_vectors, only: cross, unit_vector
   use xmpm_surface, only: surface_t, build_surface, refresh_geometry
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_rectangle, make_disc, make_sector
   use xmpm_front, only: front_t, front_place_t, front_test_points, mark_front, refresh_front, &
      nearest_on_front, nearest_of_group, frame_on_front, vertex_phi, fully_cracked
   use testing, only: suite_t, check, check_close, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   type(surface_t) :: surface
   type(front_t) :: front
   type(error_t), allocatable :: error
   real(wp), allocatable :: x(:, :), points(:, :)
   integer, allocatable :: tri(:, :)
   logical, allocatable :: inside(:)

   suite%name = 'front'
   call penny()
   call half_penny()
   call deep_rectangle()
   call annulus()
   call no_front()
   call nearest_by_plain_search()
   call nearest_together()
   call moved()
   call uneven_rim()
   call finish(suite)

contains

   !> A disc deep inside the material.
   subroutine penny()
      type(crack_plane_t) :: plane
      real(wp) :: n(3), radial(3), worst(2), phi(500)
      integer :: i

      call set_plane([1.0_wp, 2.0_wp, 3.0_wp], [1.0_wp, 1.0_wp, 0.5_wp], [-1.0_wp, 1.0_wp, &
         0.0_wp], plane, error)
      n = cross(plane%along, plane%across)
      call make_disc(plane, 2.0_wp, 0.2_wp, x, tri, error)
      call build_surface(x, tri, surface, error)
      call front_test_points(surface, 0.5_wp, points)
      ! the points stand 0.15 ahead of the chords; exact to rounding
      call check_close(suite, 'test points stand 0.3 h ahead of the rim', &
         maxval(abs(norm2(points - spread(plane%centre, 2, size(points, 2)), 1) &
         - 2.0_wp*cos(pi/60.0_wp) - 0.15_wp)), &
         0.0_wp, 1.0e-14_wp, 0.0_wp)
      allocate (inside(size(points, 2)), source=.true.)
      call mark_front(surface, inside, front)
      call check(suite, 'a disc has one closed front', front%chain_count == 1 .and. &
         all(front%closed))
      ! 60 chords: their length is 2 pi a (1 - (pi/60)**2/6), exactly 120 a sin(pi/60)
      call check_close(suite, 'its length is that of its chords', front%length(1), &
         240.0_wp*sin(pi/60.0_wp), 0.0_wp, 1.0e-14_wp)
      call check_close(suite, 'its length is 2 pi a within a chord', front%length(1), 4.0_wp*pi, &
         0.0_wp, 5.0e-4_wp)
      worst = 0.0_wp
      do i = 1, front%node_count
         radial = unit_vector(front%x(:, i) - plane%centre)
         worst(1) = max(worst(1), norm2(front%e1(:, i) - radial), norm2(front%e2(:, i) - n))
         worst(2) = max(worst(2), norm2(front%e3(:, i) - cross(front%e1(:, i), front%e2(:, i))))
      end do
      ! equal chords: the parabola's tangent is that of the circle; rounding only
      call check_close(suite, 'e1 is radial, e2 the normal', worst(1), 0.0_wp, 1.0e-13_wp, 0.0_wp)
      call check_close(suite, 'frames are right-handed', worst(2), 0.0_wp, 1.0e-15_wp, 0.0_wp)
      call check(suite, 's runs along e3', runs_along_e3())
      call vertex_phi(surface, front, phi(:surface%vertex_count))
      call check(suite, 'phi of the vertices is 0 on the front and negative behind it', &
         all((phi(:surface%vertex_count) < 0.0_wp) .neqv. surface%on_boundary) .and. &
         all(phi(:surface%vertex_count) <= 0.0_wp))
      ! the centre sees the middle of a chord
      call check_close(suite, 'phi of the centre is minus the radius', phi(1), &
         -2.0_wp*cos(pi/60.0_wp), 1.0e-13_wp, 0.0_wp)
   end subroutine penny

   function runs_along_e3() result(does)
      logical :: does
      integer :: k

      does = .true.
      do k = 1, front%edge_count
         associate (a => front%edge_node(1, k), b => front%edge_node(2, k))
            does = does .and. dot_product(front%x(:, b) - front%x(:, a), front%e3(:, a)) > 0.0_wp
            if (b > a) does = does .and. front%s(b) > front%s(a)
            does = does .and. front%node_edge(2, a) == k .and. front%node_edge(1, b) == k
         end associate
      end do
   end function runs_along_e3

   !> Half a disc at a free surface y = 0: the arc is the front, with frames good up to its ends.
   subroutine half_penny()
      integer :: i
      real(wp) :: worst

      call make_sector(crack_plane_t(), [1.0_wp, 1.0_wp], [0.0_wp, 180.0_wp], 0.1_wp, x, tri, error)
      call build_surface(x, tri, surface, error)
      call front_test_points(surface, 0.1_wp, points)
      inside = points(2, :) > 0.0_wp
      call mark_front(surface, inside, front)
      call check(suite, 'half a disc at a surface has one open front', &
         front%chain_count == 1 .and. .not. any(front%closed))
      ! 32 chords leave out (pi/32)**2/24 = 0.04 %
      call check_close(suite, 'its length is pi a', front%length(1), pi, 0.0_wp, 5.0e-4_wp)
      call check(suite, 'its s runs along e3', runs_along_e3())
      call check(suite, 'with the normal along z it runs clockwise, from -x to +x', &
         front%x(1, 1) < -0.999_wp .and. front%x(1, front%node_count) > 0.999_wp)
      worst = 0.0_wp
      do i = 1, front%node_count
         worst = max(worst, norm2(front%e1(:, i) - front%x(:, i)))
      end do
      ! at the ends the parabola through three nodes: error of third order in the angle pi/32,
      ! (pi/32)**2/4 at most
      call check_close(suite, 'e1 is radial up to the ends', worst, 0.0_wp, 0.0025_wp, 0.0_wp)
   end subroutine half_penny

   !> The slit of a plate: deeper than the plate, so that only the edges at its ends inside the
   !> plate are fronts.
   subroutine deep_rectangle()
      integer :: i
      logical :: sides
      real(wp) :: phi(500)

      call make_rectangle(crack_plane_t(), [40.0_wp, 12.0_wp], 2.0_wp, x, tri, error)
      call build_surface(x, tri, surface, error)
      call front_test_points(surface, 2.0_wp, points)
      inside = abs(points(1, :)) < 60.0_wp .and. abs(points(2, :)) < 5.5_wp
      call mark_front(surface, inside, front)
      call check(suite, 'a slit deeper than the plate has two open fronts', &
         front%chain_count == 2 .and. .not. any(front%closed))
      sides = all(abs(abs(front%x(1, :)) - 20.0_wp) < 1.0e-12_wp)
      do i = 1, front%node_count
         sides = sides .and. norm2(front%e1(:, i) - [sign(1.0_wp, front%x(1, i)), 0.0_wp, &
            0.0_wp]) < 1.0e-14_wp
      end do
      call check(suite, 'the fronts are its ends and look outwards', sides)
      ! six edges of 2 a side
      call check_close(suite, 'the fronts are as long as the edges inside', sum(front%length), &
         24.0_wp, 0.0_wp, 1.0e-14_wp)
      call check(suite, 'their s runs along e3', runs_along_e3())
      call vertex_phi(surface, front, phi(:surface%vertex_count))
      call check(suite, 'phi of its vertices counts from the ends', &
         all(abs(phi(:surface%vertex_count) - (abs(x(1, :)) - 20.0_wp)) < 1.0e-13_wp))
   end subroutine deep_rectangle

   !> A square with a hole, all inside: two closed fronts.
   subroutine annulus()
      logical :: keep(50)
      integer :: i

      call make_rectangle(crack_plane_t(), [5.0_wp, 5.0_wp], 1.0_wp, x, tri, error)
      keep = .true.
      keep(25:26) = .false.   ! the middle cell
      tri = reshape(pack(tri, spread(keep, 1, 3)), [3, 48])
      call build_surface(x, tri, surface, error)
      call front_test_points(surface, 1.0_wp, points)
      inside = points(1, :) < 99.0_wp
      call mark_front(surface, inside, front)
      call check(suite, 'a hole in a crack has a front of its own', front%chain_count == 2 .and. &
         all(front%closed))
      i = front%chain_offset(2)
      call check(suite, 'the front of the hole looks into the hole', &
         norm2(front%x(:, i) + 0.1_wp*front%e1(:, i)) < norm2(front%x(:, i)))
      call check(suite, 'its s runs along e3', runs_along_e3())
   end subroutine annulus

   subroutine no_front()
      type(front_place_t) :: place
      real(wp) :: phi(500)

      inside = points(1, :) > 99.0_wp
      call mark_front(surface, inside, front)
      call nearest_on_front(front, [0.0_wp, 0.0_wp, 0.0_wp], 9.0_wp, place)
      call vertex_phi(surface, front, phi(:surface%vertex_count))
      call check(suite, 'without a front nothing is near and all vertices are behind it', &
         front%chain_count == 0 .and. place%edge == 0 .and. &
         all(phi(:surface%vertex_count) <= fully_cracked))
   end subroutine no_front

   !> Nearest front points against the plain search, and the frame there.
   subroutine nearest_by_plain_search()
      type(front_place_t) :: place
      real(wp) :: p(3), best, worst, frame(3, 3), s, off
      integer :: i, k
      real(wp) :: t(3), a(3), f

      call make_disc(crack_plane_t(), 1.0_wp, 0.1_wp, x, tri, error)
      x(3, :) = 0.2_wp*x(1, :)**2
      call build_surface(x, tri, surface, error)
      call front_test_points(surface, 0.1_wp, points)
      inside = points(1, :) < 0.3_wp
      call mark_front(surface, inside, front)
      worst = 0.0_wp
      off = 0.0_wp
      do i = 1, 1000
         p = 1.5_wp*sin([1.0_wp, 2.3_wp, 3.7_wp]*real(i, wp))
         best = huge(1.0_wp)
         do k = 1, front%edge_count
            a = front%x(:, front%edge_node(1, k))
            t = front%x(:, front%edge_node(2, k)) - a
            f = min(1.0_wp, max(0.0_wp, dot_product(p - a, t)/dot_product(t, t)))
            best = min(best, norm2(p - a - f*t))
         end do
         call nearest_on_front(front, p, 9.0_wp, place)
         worst = max(worst, abs(place%distance - best), abs(norm2(p - place%point) - best))
         call frame_on_front(front, place, frame, s)
         off = max(off, maxval(abs(matmul(transpose(frame), frame) - unit_matrix())), &
            norm2(cross(frame(:, 1), frame(:, 2)) - frame(:, 3)))
      end do
      ! the same few operations: rounding
      call check_close(suite, 'the nearest front point is that of the plain search', worst, &
         0.0_wp, 1.0e-15_wp, 0.0_wp)
      call check_close(suite, 'frames between the nodes are right-handed and orthonormal', off, &
         0.0_wp, 2.0e-15_wp, 0.0_wp)
      call nearest_on_front(front, [3.0_wp, 0.0_wp, 0.0_wp], 0.5_wp, place)
      call check(suite, 'beyond the reach nothing is near', place%edge == 0)
   end subroutine nearest_by_plain_search

   !> Eight points in a ball at once: the same as one after the other; at the node between two
   !> edges the lower number.
   subroutine nearest_together()
      type(front_place_t) :: places(8), place
      real(wp) :: p(8, 3), middle(3), worst
      integer :: i, k, wrong, found

      worst = 0.0_wp
      wrong = 0
      found = 0
      do i = 1, 300
         middle = 1.2_wp*sin([1.0_wp, 2.3_wp, 3.7_wp]*real(i, wp))
         if (i <= front%node_count) middle = 1.1_wp*front%x(:, i)
         do k = 1, 8
            p(k, :) = middle + 0.1_wp*sin([1.0_wp, 2.0_wp, 4.0_wp]*real(8*i + k, wp))
         end do
         p(1, :) = middle
         call nearest_on_front(front, middle, 9.0_wp, place)
         call nearest_of_group(front, 8, p, middle, 0.18_wp, place%distance, 0.5_wp, places)
         do k = 1, 8
            call nearest_on_front(front, p(k, :), 0.5_wp, place)
            if (place%edge /= places(k)%edge .or. place%node /= places(k)%node) wrong = wrong + 1
            if (place%edge == 0) cycle
            found = found + 1
            worst = max(worst, norm2(place%point - places(k)%point), &
               abs(place%distance - places(k)%distance))
         end do
      end do
      call check(suite, 'points together are near to the same edges and nodes', wrong == 0)
      call check(suite, 'some of them are beyond the reach', found > 300 .and. found < 2100)
      ! the same few operations: rounding
      call check_close(suite, 'and to the same places', worst, 0.0_wp, 1.0e-15_wp, 0.0_wp)
   end subroutine nearest_together

   pure function unit_matrix() result(unit)
      real(wp) :: unit(3, 3)
      integer :: i

      unit = 0.0_wp
      do i = 1, 3
         unit(i, i) = 1.0_wp
      end do
   end function unit_matrix

   !> A disc cut into uneven slices: e1 is radial all the same, and nodes are named as such.
   subroutine uneven_rim()
      integer, parameter :: n = 40
      real(wp) :: rim(3, n + 1), angle, worst
      integer :: slices(3, n), i
      type(front_place_t) :: place
      logical :: named

      do i = 1, n
         angle = 2.0_wp*pi*(real(i, wp) + 0.4_wp*real(modulo(i, 2), wp))/real(n, wp)
         rim(:, i) = [cos(angle), sin(angle), 0.0_wp]
         slices(:, i) = [n + 1, i, modulo(i, n) + 1]
      end do
      rim(:, n + 1) = 0.0_wp
      call build_surface(rim, slices, surface, error)
      inside = [(.true., i=1, n)]
      call mark_front(surface, inside, front)
      worst = 0.0_wp
      named = .true.
      do i = 1, front%node_count
         worst = max(worst, norm2(front%e1(:, i) - front%x(:, i)))
         call nearest_on_front(front, 1.1_wp*front%x(:, i), 1.0_wp, place)
         named = named .and. place%node == i
      end do
      ! third order in the angle between nodes: (2 pi 1.4/40)**3/8 = 0.0013 at most
      call check_close(suite, 'e1 is radial on an uneven rim', worst, 0.0_wp, 0.0013_wp, 0.0_wp)
      call check(suite, 'a node that is the nearest point is named', named)
   end subroutine uneven_rim

   !> A front that moves with its surface is that of a surface made there.
   subroutine moved()
      type(front_t) :: fresh
      type(surface_t) :: there
      type(front_place_t) :: place, place_there

      surface%up(1, :) = 0.2_wp*x(2, :)
      surface%um(1, :) = 0.2_wp*x(2, :)
      call refresh_geometry(surface)
      call refresh_front(surface, front)
      call build_surface(surface%x, tri, there, error)
      call mark_front(there, inside, fresh)
      call check(suite, 'a moved front has the frames and lengths of its new place', &
         all(abs(front%e1 - fresh%e1) <= 0.0_wp) .and. all(abs(front%s - fresh%s) <= 0.0_wp) .and. &
         all(abs(front%edge_e1 - fresh%edge_e1) <= 0.0_wp))
      call nearest_on_front(front, [0.1_wp, 0.3_wp, 0.2_wp], 9.0_wp, place)
      call nearest_on_front(fresh, [0.1_wp, 0.3_wp, 0.2_wp], 9.0_wp, place_there)
      call check(suite, 'a moved front finds the same nearest point', &
         place%edge == place_there%edge)
   end subroutine moved
end program test_front
