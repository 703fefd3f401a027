!> Growth of surfaces without any mechanics: shape, area, fronts, faults.
program test_grow_surface
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t
   use xmpm_vectors, only: cross, unit_vector
   use xmpm_surface, only: surface_t, build_surface, refresh_geometry, surface_area
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_disc
   use xmpm_surface_index, only: surface_index_t, nearest_t, build_index, nearest_on_surface
   use xmpm_front, only: front_t
   use xmpm_front_line, only: front_limits_t, limits_for
   use xmpm_mesh_check, only: triangles_overlap
   use xmpm_front_meeting, only: find_meetings
   use xmpm_front_search, only: find_front
   use xmpm_grow_surface, only: grown_t, grow_surface
   use growing_surface, only: tube_t, make_cut, grow_cut
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   type(surface_t) :: surface
   type(front_t) :: front
   type(grown_t) :: grown
   type(tube_t) :: body
   type(front_limits_t) :: limits
   type(error_t), allocatable :: error
   real(wp), parameter :: h = 1.0_wp   ! grid size of all tests

   suite%name = 'grow_surface'
   limits = limits_for(h, h, 0.5_wp)
   call disc_stays_round()
   call disc_leaves_the_body()
   call tilted_front_stays_planar()
   call kink_of_sixty_degrees()
   call noise_dies_out()
   call half_a_front_waits()
   call fronts_meet_in_a_tube(limits%meeting, 50)
   call fronts_meet_in_a_tube(8.0_wp, 44)
   call ring_closes()
   call motion_of_new_vertices()
   call folds_wait()
   call fronts_that_lean_meet()
   call faults_are_found()
   call overlaps()
   call finish(suite)

contains

   !> A disc of radius a on the plane with a normal, its rim the front.
   subroutine start_disc(a, centre, along, across)
      real(wp), intent(in) :: a, centre(3), along(3), across(3)
      type(crack_plane_t) :: plane
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)

      call set_plane(centre, along, across, plane, error)
      call make_disc(plane, a, h, x, tri, error)
      call build_surface(x, tri, surface, error)
      call find_front(surface, rim(), h, body, front)
   end subroutine start_disc

   subroutine start_rectangle(size, centre, along, across)
      real(wp), intent(in) :: size(2), centre(3), along(3), across(3)

      call make_cut(size, centre, along, across, body, surface, front, error)
   end subroutine start_rectangle

   function rim() result(pair)
      integer, allocatable :: pair(:, :)

      pair = surface%edge(:, surface%boundary)
   end function rim

   subroutine grow_by(advance)
      real(wp), intent(in) :: advance(:, :)

      call grow_cut(advance, limits, body, surface, front, grown, error)
   end subroutine grow_by

   !> Every node ahead by a length, kinked by an angle.
   function ahead(length, kink) result(advance)
      real(wp), intent(in) :: length, kink
      real(wp), allocatable :: advance(:, :)

      advance = length*(cos(kink)*front%e1 + sin(kink)*front%e2)
   end function ahead

   !> 24 increments of half a cell from a radius of 5 to 17.
   subroutine disc_stays_round()
      real(wp) :: n(3), centre(3), before, radius(2), off, shape
      real(wp), allocatable :: r(:)
      integer :: i

      body = tube_t()
      centre = [0.3_wp, -0.2_wp, 0.7_wp]
      call start_disc(5.0_wp, centre, [1.0_wp, 1.0_wp, 0.5_wp], [-1.0_wp, 1.0_wp, 0.0_wp])
      n = unit_vector(cross([1.0_wp, 1.0_wp, 0.5_wp], [-1.0_wp, 1.0_wp, 0.0_wp]))
      before = surface_area(surface)
      shape = 1
      do i = 1, 24
         call grow_by(ahead(0.5_wp, 0.0_wp))
         call check_no_error(suite, 'a disc grows', error)
         if (allocated(error)) return
         shape = min(shape, grown%quality%worst_shape)
      end do
      r = norm2(front%x - spread(centre, 2, front%node_count), 1)
      radius = [minval(r), maxval(r)]
      off = maxval(abs(matmul(n, surface%x - spread(centre, 2, surface%vertex_count))))
      ! rounding, carried through 24 increments of coordinates of size 20
      call check_close(suite, 'the grown disc is plane', off, 0.0_wp, 1.0e-12_wp, 0.0_wp)
      ! each increment inserts nodes on a cubic and smooths: 1e-3 of a cell each way
      call check_close(suite, 'its smallest radius is 17', radius(1), 17.0_wp, 0.02_wp, 0.0_wp)
      call check_close(suite, 'its largest radius is 17', radius(2), 17.0_wp, 0.02_wp, 0.0_wp)
      call check(suite, 'it has one closed front', front%chain_count == 1 .and. all(front%closed))
      call check_close(suite, 'the front has the length of its circle', front%length(1), &
         34*pi, 0.0_wp, 2.0e-3_wp)
      ! chords shorter than 1.4: the polygon lacks (1.4/17)**2/6 = 1.1e-3 of the circle at most
      call check_close(suite, 'the area is that of its circle', surface_area(surface), &
         289*pi, 0.0_wp, 3.0e-3_wp)
      call check(suite, 'segments keep to their bounds', bounds_kept())
      ! half a cell against 1.4 cells gives 0.55
      call check(suite, 'no triangle is a sliver', shape > 0.3_wp)
      call check(suite, 'it has grown', surface_area(surface) > 10*before)
   end subroutine disc_stays_round

   function bounds_kept() result(are)
      logical :: are
      real(wp) :: d
      integer :: k

      are = .true.
      do k = 1, front%edge_count
         d = norm2(front%x(:, front%edge_node(2, k)) - front%x(:, front%edge_node(1, k)))
         ! smoothing moves a node by a few per cent after the bounds were met
         are = are .and. d > 0.9_wp*limits%shortest .and. d < 1.1_wp*limits%longest
      end do
   end function bounds_kept

   !> A disc in a cylinder: it reaches the wall, is locked there, and at last cuts the body.
   subroutine disc_leaves_the_body()
      integer :: i, opened
      real(wp) :: beyond

      body = tube_t()
      body%outer = 10
      call start_disc(4.0_wp, [3.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp])
      opened = 0
      do i = 1, 40
         call grow_by(ahead(0.4_wp, 0.0_wp))
         call check_no_error(suite, 'a disc grows out of a body', error)
         if (allocated(error)) return
         if (front%edge_count == 0) exit
         if (opened == 0 .and. .not. front%closed(1)) opened = i
      end do
      call check(suite, 'at the wall the front opens', opened > 5 .and. opened < 15)
      call check(suite, 'a body cut through has no front', front%edge_count == 0)
      ! from x = -1 to -10 at 0.4 an increment, less the last 1.5, which are cut at once: 18.75
      call check(suite, 'it is cut when the front has crossed it', i >= 19 .and. i <= 36)
      beyond = maxval(norm2(surface%x(1:2, :), 1)) - 10
      call check(suite, 'locked parts do not grow on', beyond < 3*h)
      call check_close(suite, 'the cut stays plane', maxval(abs(surface%x(3, :))), 0.0_wp, &
         1.0e-12_wp, 0.0_wp)
      call check(suite, 'the cut covers the body', covers(9.6_wp))
   end subroutine disc_leaves_the_body

   !> Whether all points of the plane z = 0 within a radius lie on the surface.
   function covers(radius) result(does)
      real(wp), intent(in) :: radius
      logical :: does
      type(surface_index_t) :: index
      type(nearest_t) :: nearest
      real(wp) :: x(3)
      integer :: i, j

      call build_index(surface, index)
      does = .true.
      do i = -40, 40
         do j = -40, 40
            x = [0.25_wp*real(i, wp), 0.25_wp*real(j, wp), 0.0_wp]
            if (norm2(x) > radius) cycle
            call nearest_on_surface(index, surface, x, h, nearest)
            does = does .and. nearest%triangle > 0 .and. nearest%distance < 1e-9_wp
         end do
      end do
   end function covers

   !> A straight front through a plate, tilted to all axes, 20 increments.
   subroutine tilted_front_stays_planar()
      real(wp) :: n(3), off, along(3), across(3), reach(2)
      integer :: i

      body = tube_t()
      body%y = [-4.3_wp, 4.3_wp]
      along = unit_vector([2.0_wp, 0.0_wp, 1.0_wp])
      across = unit_vector([0.0_wp, 1.0_wp, 0.0_wp])
      n = cross(along, across)
      call start_rectangle([10.0_wp, 10.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], along, across)
      call check(suite, 'a crack through a plate has two open fronts', front%chain_count == 2 &
         .and. .not. any(front%closed))
      do i = 1, 20
         call grow_by(ahead(0.5_wp, 0.0_wp))
         call check_no_error(suite, 'a tilted front grows', error)
         if (allocated(error)) return
      end do
      off = maxval(abs(matmul(n, surface%x)))
      call check_close(suite, 'a tilted front stays in its plane', off, 0.0_wp, 1.0e-12_wp, 0.0_wp)
      reach = [minval(abs(matmul(along, front%x))), maxval(abs(matmul(along, front%x)))]
      call check_close(suite, 'and straight, the least node', reach(1), 15.0_wp, 1.0e-9_wp, 0.0_wp)
      call check_close(suite, 'and straight, the first node', reach(2), 15.0_wp, 1.0e-9_wp, 0.0_wp)
      call check_close(suite, 'the area is what was swept', surface_area(surface), 300.0_wp, &
         0.0_wp, 1.0e-9_wp)
   end subroutine tilted_front_stays_planar

   !> The first increment turns by 60 degrees, the next ones go straight on.
   subroutine kink_of_sixty_degrees()
      integer :: i
      real(wp) :: way(3), area

      call start_cut()
      area = surface_area(surface)
      call grow_by(ahead(0.5_wp, pi/3))
      call check_no_error(suite, 'a front turns by 60 degrees', error)
      call check_close(suite, 'the fold is measured', grown%quality%sharpest_fold, pi/3, &
         1.0e-12_wp, &
         0.0_wp)
      do i = 1, 3
         ! the frame of a node stands between the old and the new triangles, so the direction is
         ! given here
         way = 0.5_wp*[cos(pi/3), 0.0_wp, sin(pi/3)]
         call grow_by(spread(way, 2, front%node_count)*sign_of_x())
         call check_no_error(suite, 'and goes on', error)
      end do
      call check_close(suite, 'kinked fronts have moved as told', maxval(front%x(3, :)), &
         4*way(3), 1.0e-12_wp, 0.0_wp)
      call check_close(suite, 'the kinked area is what was swept', surface_area(surface) - area, &
         2*9*2.0_wp, 0.0_wp, 1.0e-9_wp)
   end subroutine kink_of_sixty_degrees

   !> Growth to both sides: the direction of x changes with the side.
   function sign_of_x() result(factor)
      real(wp), allocatable :: factor(:, :)

      allocate (factor(3, front%node_count), source=1.0_wp)
      factor(1, :) = sign(1.0_wp, front%x(1, :))
   end function sign_of_x

   !> Lengths that differ from node to node by a tenth, as noise in K would do: the front keeps its
   !> mean, and the noise does not build up.
   subroutine noise_dies_out()
      real(wp), allocatable :: advance(:, :)
      real(wp) :: zigzag(2)
      integer :: i, k

      body = tube_t()
      call start_disc(8.0_wp, [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp])
      do i = 1, 20
         advance = ahead(0.5_wp, 0.0_wp)
         do k = 1, front%node_count
            advance(:, k) = advance(:, k)*(1 + 0.1_wp*real((-1)**k, wp)) + [0.0_wp, 0.0_wp, &
               0.05_wp*real((-1)**(k/2), wp)]
         end do
         call grow_by(advance)
         call check_no_error(suite, 'a noisy front grows', error)
         if (allocated(error)) return
         if (i == 2) zigzag(1) = roughness()
      end do
      zigzag(2) = roughness()
      call check(suite, 'noise from node to node does not build up', zigzag(2) < 2*zigzag(1) + &
         1e-3_wp)
      call check_close(suite, 'a noisy front keeps its mean', sum(norm2(front%x, 1)) &
         /real(front%node_count, wp), 18.0_wp, 0.1_wp, 0.0_wp)
      call check(suite, 'and stays near its plane', maxval(abs(front%x(3, :))) < 0.3_wp)
   end subroutine noise_dies_out

   !> Largest distance of a node from the middle of its neighbours, less that of a circle.
   function roughness() result(r)
      real(wp) :: r, d(3)
      integer :: i, n

      n = front%node_count
      r = 0
      do i = 1, n
         d = front%x(:, i) - 0.5_wp*(front%x(:, modulo(i - 2, n) + 1) &
            + front%x(:, modulo(i, n) + 1))
         r = max(r, abs(d(3)))
      end do
   end function roughness

   !> Nodes on one half go, the others have nothing to go: the strip ends at the ones that stay.
   subroutine half_a_front_waits()
      real(wp), allocatable :: advance(:, :)
      real(wp) :: area
      integer :: i

      body = tube_t()
      call start_disc(6.0_wp, [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp])
      area = surface_area(surface)
      do i = 1, 6
         advance = ahead(0.5_wp, 0.0_wp)
         advance(:, pack([(i, i=1, front%node_count)], front%x(1, :) < 0.1_wp)) = 0
         call grow_by(advance)
         call check_no_error(suite, 'half a front grows', error)
         if (allocated(error)) return
      end do
      call check_close(suite, 'the half that waits has not moved', &
         minval(front%x(1, :)), -6.0_wp, 0.05_wp, 0.0_wp)
      call check(suite, 'the other half has gone its way', maxval(norm2(front%x, 1)) > &
         8.9_wp .and. &
         maxval(norm2(front%x, 1)) < 9.1_wp)
      call check(suite, 'it is still one closed front', front%chain_count == 1 .and. &
         all(front%closed))
      call check_close(suite, 'the area of the half is what was swept', surface_area(surface) &
         - area, 22.5_wp*pi, 0.0_wp, 0.1_wp)
   end subroutine half_a_front_waits

   !> A crack through the wall of a tube; both fronts run round and meet on the other side, from
   !> nearby or from further off, where the straight way between them cuts through the hole and
   !> leaves the wall bare outside.
   subroutine fronts_meet_in_a_tube(apart, earliest)
      real(wp), intent(in) :: apart      ! distance from which they meet
      integer, intent(in) :: earliest    ! increment at which they may
      real(wp), allocatable :: advance(:, :)
      type(front_limits_t) :: far
      integer :: i, k

      far = limits
      far%meeting = apart

      body = tube_t()
      body%inner = 8
      body%outer = 12
      call start_rectangle([5.0_wp, 6.0_wp], [0.0_wp, 10.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp])
      call check(suite, 'a crack through the wall of a tube has two fronts', front%chain_count == 2)
      do i = 1, 80
         advance = ahead(0.0_wp, 0.0_wp)
         do k = 1, front%node_count
            ! half a cell at the middle of the wall, round the axis
            advance(:, k) = rotated(front%x(:, k), sign(0.05_wp, dot_product(front%e1(:, k), &
               [-front%x(2, k), front%x(1, k), 0.0_wp]))) - front%x(:, k)
         end do
         call grow_cut(advance, far, body, surface, front, grown, error)
         call check_no_error(suite, 'fronts run round a tube', error)
         if (allocated(error)) return
         if (front%edge_count == 0) exit
      end do
      call check(suite, 'the fronts met and were joined', grown%joined == 1)
      call check(suite, 'the tube is cut', front%edge_count == 0)
      ! each goes from 0.25 to pi, half a turn, at 0.05 an increment, and waits a cell before it
      call check(suite, 'they met half way round', i > earliest .and. i < earliest + 12)
      call check(suite, 'the ring has two rims', size(surface%loop_offset) == 3)
      call check(suite, 'the ring covers the wall', surface_area(surface) > 80*pi)
      ! the surface is plane, so that only rounding is left
      call check_close(suite, 'to its outer rim', farthest_bare(11.9_wp), 0.0_wp, 1e-9_wp, 0.0_wp)
      call check_close(suite, 'and to its inner rim', farthest_bare(8.1_wp), 0.0_wp, 1e-9_wp, &
         0.0_wp)
   end subroutine fronts_meet_in_a_tube

   !> Largest distance of the surface from points of a circle.
   function farthest_bare(radius) result(d)
      real(wp), intent(in) :: radius
      real(wp) :: d, a
      type(surface_index_t) :: index
      type(nearest_t) :: near
      integer :: i

      call build_index(surface, index)
      d = 0
      do i = 1, 720
         a = 2*pi*real(i, wp)/720
         call nearest_on_surface(index, surface, radius*[cos(a), sin(a), 0.0_wp], 10.0_wp, near)
         d = max(d, near%distance)
      end do
   end function farthest_bare

   pure function rotated(x, angle) result(y)
      real(wp), intent(in) :: x(3), angle
      real(wp) :: y(3)

      y = [cos(angle)*x(1) - sin(angle)*x(2), sin(angle)*x(1) + cos(angle)*x(2), x(3)]
   end function rotated

   !> A crack from the outside of a rod all round, grown to the centre.
   subroutine ring_closes()
      integer, parameter :: n = 40
      real(wp) :: x(3, 2*n), a
      integer :: tri(3, 2*n), i, j

      body = tube_t()
      body%outer = 8
      do i = 1, n
         a = 2*pi*real(i, wp)/real(n, wp)
         x(:, i) = [6*cos(a), 6*sin(a), 0.0_wp]
         x(:, n + i) = [9*cos(a), 9*sin(a), 0.0_wp]
         j = modulo(i, n) + 1
         tri(:, 2*i - 1) = [i, n + i, n + j]
         tri(:, 2*i) = [i, n + j, j]
      end do
      call build_surface(x, tri, surface, error)
      call find_front(surface, rim(), h, body, front)
      call check(suite, 'a ring crack in a rod has one closed front', front%chain_count == 1 .and. &
         front%node_count == n)
      do i = 1, 30
         call grow_by(ahead(0.4_wp, 0.0_wp))
         call check_no_error(suite, 'a ring crack grows', error)
         if (allocated(error)) return
         if (front%edge_count == 0) exit
      end do
      call check(suite, 'the last rest is cut at once', front%edge_count == 0 .and. &
         grown%joined == 1)
      call check_close(suite, 'the ring crack has become the whole disc', surface_area(surface), &
         0.5_wp*real(n, wp)*81*sin(2*pi/real(n, wp)), 0.0_wp, 1.0e-9_wp)
   end subroutine ring_closes

   !> New vertices have the mean motion of the front and no opening; old ones keep theirs.
   subroutine motion_of_new_vertices()
      integer :: v, nv
      real(wp) :: worst(3)
      real(wp), allocatable :: up(:, :)

      body = tube_t()
      call start_disc(5.0_wp, [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp])
      nv = surface%vertex_count
      do v = 1, nv
         surface%up(:, v) = [0.01_wp*surface%x(1, v), 0.2_wp, 0.03_wp]
         surface%um(:, v) = [0.01_wp*surface%x(1, v), 0.2_wp, -0.01_wp]
      end do
      call refresh_geometry(surface)
      up = surface%up
      call find_front(surface, rim(), h, body, front)
      call grow_by(ahead(0.5_wp, 0.0_wp))
      worst = 0
      do v = nv + 1, surface%vertex_count
         worst(1) = max(worst(1), norm2(surface%up(:, v) - surface%um(:, v)))
         worst(2) = max(worst(2), norm2(surface%up(:, v) - [0.01_wp*(surface%start(1, v)), &
            0.2_wp, 0.01_wp]))
         worst(3) = max(worst(3), norm2(surface%x(:, v) - surface%start(:, v) - surface%up(:, v)))
      end do
      call check_close(suite, 'new vertices have no opening', worst(1), 0.0_wp, 0.0_wp, 0.0_wp)
      ! the motion varies by 0.01 a length, and the front has gone half a cell
      call check_close(suite, 'new vertices have the motion of the front', worst(2), 0.0_wp, &
         0.007_wp, 0.0_wp)
      call check_close(suite, 'start and motion give the position', worst(3), 0.0_wp, 1e-14_wp, &
         0.0_wp)
      call check_close(suite, 'old vertices keep their motion', maxval(abs(surface%up(:, :nv) &
         - up)), 0.0_wp, 0.0_wp, 0.0_wp)
      call check(suite, 'new vertices name their parents', all(grown%parent(:, nv + 1:) > 0))
   end subroutine motion_of_new_vertices

   !> One half of a front wants to turn up by 88 degrees, the other down: the triangles between
   !> them would be folded, so that their nodes stay, with their way, and go later. A node that has
   !> waited too long is a fault.
   subroutine folds_wait()
      type(front_limits_t) :: hasty
      real(wp), allocatable :: before(:, :)
      integer :: i

      call start_cut()
      before = front%x
      call grow_by(torn())
      call check_no_error(suite, 'a front is torn up and down', error)
      if (allocated(error)) return
      call check(suite, 'the two nodes at the tear of both fronts stay', count(grown%held) == 4)
      call check(suite, 'they are where they were', all([(minval(norm2(front%x &
         - spread(before(:, i), 2, front%node_count), 1)) < tiny(1.0_wp), i=1, &
         size(grown%held))] .eqv. grown%held))
      call check(suite, 'no fold of more than 120 degrees', grown%quality%sharpest_fold < 2*pi/3)
      call grow_by(ahead(0.5_wp, 0.0_wp))
      call check_no_error(suite, 'straight on they go', error)
      if (allocated(error)) return
      call check(suite, 'and none stays', .not. any(grown%held))
      call start_cut()
      hasty = limits
      hasty%cell = 0.2_wp
      call grow_cut(torn(), hasty, body, surface, front, grown, error)
      call check_error(suite, 'after two cells it is a fault', error, 'folded')
   end subroutine folds_wait

   !> Two fronts 10 apart that come towards each other, each leaning by an angle to the same side:
   !> they meet at 45 degrees, where one has passed the other at one side of a wall before the other
   !> side, and do not at 60; nor do those further apart than the distance.
   subroutine fronts_that_lean_meet()
      call start_cut()
      front%x(1, :) = -front%x(1, :)
      call check(suite, 'fronts face to face meet', all(met(0.0_wp, 10.1_wp)))
      call check(suite, 'not from afar', .not. any(met(0.0_wp, 9.9_wp)))
      call check(suite, 'those that lean by 45 degrees do', all(met(pi/4, 10.1_wp)))
      call check(suite, 'those that lean by 60 degrees do not', .not. any(met(pi/3, 10.1_wp)))
   end subroutine fronts_that_lean_meet

   !> Which nodes meet the other front, if it leans by an angle.
   function met(lean, reach) result(is)
      real(wp), intent(in) :: lean, reach
      logical, allocatable :: is(:)
      integer :: partner(front%node_count)
      type(front_t) :: leaning

      leaning = front
      leaning%e1(1, :) = sign(cos(lean), front%e1(1, :))
      leaning%e1(2, :) = sin(lean)
      call find_meetings(leaning, reach, partner)
      is = partner > 0
   end function met

   !> A rectangle with a front at both ends of x.
   subroutine start_cut()
      body = tube_t()
      body%y = [-4.3_wp, 4.3_wp]
      call start_rectangle([10.0_wp, 9.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp])
   end subroutine start_cut

   !> Ways of 0.45, up on one half of the fronts and down on the other.
   function torn() result(advance)
      real(wp), allocatable :: advance(:, :)

      advance = ahead(0.45_wp, 0.49_wp*pi)
      where (spread(front%x(2, :) > 0.1_wp, 1, 3)) advance = ahead(0.45_wp, -0.49_wp*pi)
   end function torn

   !> A front that turns back on itself, and two limbs that run into each other.
   subroutine faults_are_found()
      body = tube_t()
      call start_disc(5.0_wp, [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp])
      call grow_by(ahead(0.5_wp, 0.9_wp*pi))
      call check_error(suite, 'a front that turns back is a fault', error, 'folded')
      body%y = [-4.3_wp, 4.3_wp]
      call start_rectangle([10.0_wp, 9.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp])
      call grow_by(-2.0_wp*ahead(0.5_wp, 0.0_wp))
      call check_error(suite, 'a front that runs into its crack is a fault', error, &
         'no valid triangles')
   end subroutine faults_are_found

   !> Pairs of triangles that do and do not overlap.
   subroutine overlaps()
      real(wp) :: a(3, 3), b(3, 3)

      a = reshape([0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], [3, 3])
      call check(suite, 'a triangle overlaps itself', triangles_overlap(a, a))
      b = a
      b(1:2, :) = 1 - a(1:2, :)
      call check(suite, 'neighbours at an edge do not overlap', .not. triangles_overlap(a, b))
      b = a
      b(1, :) = -a(1, :)
      b(2, :) = -a(2, :)
      call check(suite, 'neighbours at a corner do not overlap', .not. triangles_overlap(a, b))
      b = a
      b(1, :) = a(1, :) + 0.3_wp
      call check(suite, 'triangles that cover each other in part overlap', triangles_overlap(a, b))
      b = a
      b(3, :) = 0.1_wp
      call check(suite, 'triangles above each other do not overlap', .not. triangles_overlap(a, b))
      b = reshape([0.2_wp, 0.2_wp, -1.0_wp, 0.2_wp, 0.2_wp, 1.0_wp, 5.0_wp, 5.0_wp, 0.0_wp], [3, 3])
      call check(suite, 'a triangle that passes through overlaps', triangles_overlap(a, b))
      b(1:2, :) = b(1:2, :) + 0.5_wp
      call check(suite, 'one that passes beside does not', .not. triangles_overlap(a, b))
   end subroutine overlaps
end program test_grow_surface
