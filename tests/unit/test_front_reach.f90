!> Fronts at the surface of bodies without any mechanics: ends that are led out, rests, faults
!> outside.
module reach_bodies
   use xmpm_kinds, only: wp
   use xmpm_material_test, only: material_test_t
   implicit none
   private

   public :: wedge_t

   !> A plate whose faces move apart from x = 10 on.
   type, extends(material_test_t) :: wedge_t
      real(wp) :: half = 4.3_wp    !! half its thickness
      real(wp) :: slope = 0.0_wp   !! growth of it
      real(wp) :: end = 1.0e9_wp   !! where it ends
   contains
      procedure :: inside => inside_wedge
   end type wedge_t

contains

   pure function inside_wedge(material, x) result(is)
      class(wedge_t), intent(in) :: material
      real(wp), intent(in) :: x(3)
      logical :: is

      is = abs(x(2)) < material%half + material%slope*max(0.0_wp, x(1) - 10) &
         .and. x(1) < material%end
   end function inside_wedge
end module reach_bodies

program test_front_reach
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t
   use xmpm_surface, only: surface_t, surface_area
   use xmpm_surface_index, only: surface_index_t, nearest_t, build_index, nearest_on_surface
   use xmpm_front, only: front_t
   use xmpm_material_test, only: material_test_t
   use xmpm_front_line, only: front_limits_t, limits_for
   use xmpm_grow_surface, only: grown_t
   use growing_surface, only: tube_t, make_cut, grow_cut
   use reach_bodies, only: wedge_t
   use testing, only: suite_t, check, check_error, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   type(surface_t) :: surface
   type(front_t) :: front
   type(grown_t) :: grown
   type(front_limits_t) :: limits
   type(error_t), allocatable :: error

   suite%name = 'front_reach'
   limits = limits_for(1.0_wp, 1.0_wp, 0.5_wp)
   call ends_follow_a_wall()
   call ends_re_enter()
   call rest_is_cut_at_once()
   call rest_in_a_corner_is_cut_at_once()
   call thin_plate_is_no_rest()
   call fault_outside_is_held()
   call fronts_meet_beside_each_other()
   call finish(suite)

contains

   subroutine start(size, centre, along, across, body)
      real(wp), intent(in) :: size(2), centre(3), along(3), across(3)
      class(material_test_t), intent(in) :: body

      call make_cut(size, centre, along, across, body, surface, front, error)
   end subroutine start

   subroutine grow_by(advance, body)
      real(wp), intent(in) :: advance(:, :)
      class(material_test_t), intent(in) :: body

      call grow_cut(advance, limits, body, surface, front, grown, error)
   end subroutine grow_by

   !> Two fronts that run through the wall of a tube with the same speed at all points lean more and
   !> more against the inner wall. Their ends follow it, and no node is put far ahead.
   subroutine ends_follow_a_wall()
      type(tube_t) :: tube
      real(wp), allocatable :: before(:, :)
      real(wp) :: jump
      integer :: i, k, outside

      tube%inner = 8
      tube%outer = 12
      call start([5.0_wp, 6.0_wp], [0.0_wp, 10.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp], tube)
      jump = 0
      outside = 0
      do i = 1, 30
         before = front%x
         call grow_by(0.5_wp*front%e1, tube)
         call check_no_error(suite, 'a front that leans against a wall grows', error)
         if (allocated(error) .or. front%edge_count == 0) exit
         do k = 1, front%node_count
            jump = max(jump, minval(norm2(before - spread(front%x(:, k), 2, size(before, 2)), 1)))
         end do
         outside = outside + count(.not. [tube%inside(front%x(:, 1)), &
            tube%inside(front%x(:, front%node_count))])
      end do
      ! half a cell of way, three cells to the outside, a quarter beyond
      call check(suite, 'no node is put further than three cells ahead', jump < 3.8_wp)
      call check(suite, 'the ends lie outside', outside > 50)
   end subroutine ends_follow_a_wall

   !> The plate gets thicker as fast as the front goes: its ends come into the material again and
   !> again, are set free, and new ones are put outside.
   subroutine ends_re_enter()
      type(wedge_t) :: plate
      integer :: i
      logical :: out

      plate%slope = 1
      call start([18.0_wp, 10.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp], plate)
      out = .true.
      do i = 1, 16
         call grow_by(spread([0.5_wp, 0.0_wp, 0.0_wp], 2, front%node_count) &
            *spread(merge(1.0_wp, 0.0_wp, front%x(1, :) > 0), 1, 3), plate)
         call check_no_error(suite, 'a front in a plate that gets thicker grows', error)
         if (allocated(error)) return
         out = out .and. .not. any([plate%inside(end_of(1)), plate%inside(end_of(2))])
      end do
      call check(suite, 'after every increment both ends lie outside', out)
      ! the front is at 17; its last cells outside lean back, by less than a cell
      call check(suite, 'the crack covers the plate as far as it has come', covers(plate, 16.0_wp))
   end subroutine ends_re_enter

   !> First or last node of the front at the far side.
   function end_of(side) result(x)
      integer, intent(in) :: side
      real(wp) :: x(3)
      integer :: c

      do c = 1, front%chain_count
         x = front%x(:, merge(front%chain_offset(c), front%chain_offset(c + 1) - 1, side == 1))
         if (x(1) > 0) return
      end do
   end function end_of

   function covers(plate, reach) result(does)
      type(wedge_t), intent(in) :: plate
      real(wp), intent(in) :: reach
      logical :: does
      type(surface_index_t) :: index
      type(nearest_t) :: nearest
      real(wp) :: x(3)
      integer :: i, j

      call build_index(surface, index)
      does = .true.
      do i = 0, floor(4*reach)
         do j = -60, 60
            x = [0.25_wp*real(i, wp), 0.25_wp*real(j, wp), 0.0_wp]
            if (.not. plate%inside(x)) cycle
            call nearest_on_surface(index, surface, x, 1.0_wp, nearest)
            does = does .and. nearest%triangle > 0
            if (nearest%triangle > 0) does = does .and. nearest%distance < 1e-9_wp
         end do
      end do
   end function covers

   !> One cell before the far side the rest goes at once; two cells before it does not.
   subroutine rest_is_cut_at_once()
      type(wedge_t) :: plate

      plate%end = 11
      call start([18.0_wp, 10.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp], plate)
      call grow_by(ahead_at_far_side(), plate)
      call check(suite, 'two cells of material are no rest', any(front%x(1, :) > 0) .and. &
         maxval(surface%x(1, :)) < 9.6_wp)
      call grow_by(ahead_at_far_side(), plate)
      call check(suite, 'one and a half cells are cut at once', maxval(surface%x(1, :)) > 11.0_wp &
         .and. .not. any(front%x(1, :) > 0))
   end subroutine rest_is_cut_at_once

   !> The same where a front that has become uneven runs into a corner of the body: once little is
   !> left ahead of all its nodes, it is gone with that growth, and no piece of it stays behind.
   subroutine rest_in_a_corner_is_cut_at_once()
      type(wedge_t) :: plate
      real(wp), parameter :: d = sqrt(0.5_wp), along(3) = [d, d, 0.0_wp], &
         across(3) = [-d, d, 0.0_wp]
      real(wp), allocatable :: advance(:, :)
      real(wp) :: s, last
      integer :: i, k, n, pieces

      plate%end = 11
      pieces = 0
      do i = 1, 60
         call start([12.0_wp, 9.1_wp], [11.0_wp, 4.3_wp, 0.0_wp] - 9.0_wp*along, along, across, &
            plate)
         do n = 1, 12
            last = 0
            advance = 0*front%x
            do k = 1, front%node_count
               if (dot_product(front%e1(:, k), along) < 0.1_wp) cycle
               if (plate%inside(front%x(:, k))) last = max(last, &
                  dot_product([11.0_wp, 4.3_wp, 0.0_wp] - front%x(:, k), along))
               s = dot_product(front%x(:, k) - [11.0_wp, 4.3_wp, 0.0_wp], across)
               advance(:, k) = (0.35_wp + 0.15_wp*sin(0.7_wp*real(i, wp)*s + real(i, wp))) &
                  *front%e1(:, k)
            end do
            if (.not. any(norm2(advance, 1) > 0)) exit
            ! three of the sixty left one, 0.2 to 0.4 cells from the corner
            if (last < 0.4_wp) pieces = pieces + 1
            call grow_by(advance, plate)
            call check_no_error(suite, 'a front grows in a corner', error)
            if (allocated(error)) exit
         end do
      end do
      call check(suite, 'no piece of a front stays in a corner', pieces == 0)
   end subroutine rest_in_a_corner_is_cut_at_once

   function ahead_at_far_side() result(advance)
      real(wp), allocatable :: advance(:, :)

      advance = 0.5_wp*front%e1*spread(merge(1.0_wp, 0.0_wp, front%x(1, :) > 0), 1, 3)
   end function ahead_at_far_side

   !> A plate of one cell has short fronts, but the material ahead of them is no rest.
   subroutine thin_plate_is_no_rest()
      type(wedge_t) :: plate

      plate%half = 0.5_wp
      call start([18.0_wp, 2.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp], plate)
      call grow_by(ahead_at_far_side(), plate)
      call check_no_error(suite, 'a front of one cell grows', error)
      call check(suite, 'it goes its way and no further', abs(maxval(surface%x(1, :)) - 9.5_wp) &
         < 1e-9_wp)
   end subroutine thin_plate_is_no_rest

   !> Nodes outside that would fold the surface back stay; a node inside that does so is a fault.
   subroutine fault_outside_is_held()
      type(wedge_t) :: plate
      real(wp), allocatable :: advance(:, :)
      integer :: i

      call start([18.0_wp, 12.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp], plate)
      advance = ahead_at_far_side()
      do i = 1, front%node_count
         if (.not. plate%inside(front%x(:, i))) advance(:, i) = -3*advance(:, i)
      end do
      call grow_by(advance, plate)
      call check_no_error(suite, 'a fold outside the material is avoided', error)
      call check(suite, 'and the front inside goes its way', maxval(surface%x(1, :)) > 9.4_wp)
      call grow_by(-3*ahead_at_far_side(), plate)
      call check_error(suite, 'a fold inside is none that could be', error, 'no valid triangles')
   end subroutine fault_outside_is_held

   !> Fronts that run round a tube and rise to opposite sides come to lie beside each other: they
   !> are joined by a ramp of several rows.
   subroutine fronts_meet_beside_each_other()
      type(tube_t) :: tube
      real(wp), allocatable :: advance(:, :)
      real(wp) :: turn
      integer :: i, k, joined

      tube%inner = 8
      tube%outer = 12
      call start([5.0_wp, 6.0_wp], [0.0_wp, 10.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp], tube)
      limits%meeting = 6
      joined = 0
      do i = 1, 80
         advance = 0*front%x
         do k = 1, front%node_count
            turn = sign(0.05_wp, dot_product(front%e1(:, k), [-front%x(2, k), front%x(1, k), &
               0.0_wp]))
            advance(:, k) = rotated(front%x(:, k), turn) - front%x(:, k) &
               + [0.0_wp, 0.0_wp, 0.8_wp*turn]
         end do
         call grow_by(advance, tube)
         call check_no_error(suite, 'fronts run round a tube and rise', error)
         if (allocated(error)) return
         joined = joined + grown%joined
         if (front%edge_count == 0) exit
      end do
      call check(suite, 'fronts beside each other were joined', joined == 1 .and. &
         front%edge_count == 0)
      call check(suite, 'the ring is closed', size(surface%loop_offset) == 3)
      call check(suite, 'its last part is made of rows', grown%quality%triangles > 20 .and. &
         grown%quality%worst_shape > 0.2_wp)
      call check(suite, 'the ring covers the wall', surface_area(surface) > 80*pi)
   end subroutine fronts_meet_beside_each_other

   pure function rotated(x, angle) result(y)
      real(wp), intent(in) :: x(3), angle
      real(wp) :: y(3)

      y = [cos(angle)*x(1) - sin(angle)*x(2), sin(angle)*x(1) + cos(angle)*x(2), x(3)]
   end function rotated
end program test_front_reach
