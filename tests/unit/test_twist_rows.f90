!> The twist of Schoellmann's criterion in the surface: how the new rows turn.
program test_twist_rows
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_vectors, only: unit_vector
   use xmpm_surface, only: build_surface
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_disc, make_rectangle
   use xmpm_crack, only: crack_t
   use xmpm_schoellmann, only: schoellmann_t
   use xmpm_prescribed, only: prescribed_speed
   use xmpm_front_line, only: limits_for
   use xmpm_front_search, only: find_front
   use xmpm_grow_surface, only: grown_t, grow_surface
   use xmpm_growth, only: growth_t, start_growth, take_intensities, growth_vectors, renew_growth, &
      advance_fronts
   use xmpm_twist_rows, only: rise_of_rows
   use everywhere, only: everywhere_t
   use testing, only: suite_t, check, check_close, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   type(crack_t) :: crack
   type(growth_t) :: growth
   type(everywhere_t) :: body
   real(wp), parameter :: tight = 1.0e-12_wp   ! rounding

   suite%name = 'twist_rows'
   call face_normal_to_principal_stress()
   call way_limits_the_turn()
   call turn_goes_on()
   call round_a_disc()
   call finish(suite)

contains

   !> A slit with one straight front along y at x = 0, from y = -length/2 to length/2.
   subroutine straight_front(length)
      real(wp), intent(in) :: length
      type(crack_plane_t) :: plane
      type(error_t), allocatable :: error
      type(crack_t) :: blank
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :), pair(:, :)
      integer :: i

      crack = blank
      call set_plane([-4.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 1.0_wp, &
         0.0_wp], plane, error)
      call make_rectangle(plane, [8.0_wp, length], 1.0_wp, x, tri, error)
      call build_surface(x, tri, crack%surface, error)
      associate (s => crack%surface)
         allocate (pair(2, 0))
         do i = 1, size(s%boundary)
            if (minval(s%x(1, s%edge(:, s%boundary(i)))) < -1e-9_wp) cycle
            pair = reshape([pair, s%edge(:, s%boundary(i))], [2, size(pair, 2) + 1])
         end do
         call find_front(s, pair, 1.0_wp, body, crack%front)
      end associate
      call start()
   end subroutine straight_front

   subroutine start()
      type(growth_t) :: blank

      growth = blank
      growth%increment = 0.5_wp
      growth%limits = limits_for(1.0_wp, 1.0_wp, 0.5_wp)
      allocate (growth%criterion, source=schoellmann_t())
      allocate (growth%law, source=prescribed_speed(1.0_wp, 0.0_wp))
      growth%toughness_of = [1.0_wp]
      allocate (growth%regions(0))
      call start_growth(growth, crack)
   end subroutine start

   !> K at all nodes, judged.
   subroutine give(k, time)
      real(wp), intent(in) :: k(3), time
      integer :: n

      n = crack%front%node_count
      call take_intensities(growth, spread(k, 2, n), spread(1.0_wp, 1, n), time)
   end subroutine give

   !> A way of half the front's length lets the row turn by the whole twist: the new face is then
   !> normal to the largest principal stress ahead of a front under modes I and III.
   subroutine face_normal_to_principal_stress()
      real(wp), allocatable :: advance(:, :)
      real(wp) :: row(3), n(3), psi, k_3
      integer :: last, i

      do i = 1, 2
         k_3 = merge(-0.6_wp, 0.6_wp, i == 1)
         call straight_front(4.0_wp)
         call give([1.0_wp, 0.0_wp, k_3], 0.0_wp)
         crack%offset = 2.0_wp
         advance = growth_vectors(growth, crack)
         associate (f => crack%front)
            last = f%node_count
            row = unit_vector(f%x(:, last) + advance(:, last) - f%x(:, 1) - advance(:, 1))
            ! Ahead of the front s_22 : s_23 = K_I : K_III; the principal axis lies at psi to e2.
            psi = 0.5_wp*atan2(2*k_3, 1.0_wp)
            n = cos(psi)*f%e2(:, 1) + sin(psi)*f%e3(:, 1)
         end associate
         call check_close(suite, 'the new row is normal to the largest principal stress', &
            dot_product(row, n), 0.0_wp, tight, 0.0_wp)
         call check(suite, 'and it has turned', abs(dot_product(row, crack%front%e2(:, 1))) > &
            0.3_wp)
         call check_close(suite, 'the way ahead stays the same', &
            maxval(abs(sum(advance*crack%front%e1, 1) - 2.0_wp)), 0.0_wp, tight, 0.0_wp)
      end do
   end subroutine face_normal_to_principal_stress

   !> In a short increment the ends rise by the tangent of the twist, no more, and the middle not.
   subroutine way_limits_the_turn()
      real(wp), allocatable :: rise(:)
      real(wp), parameter :: psi = 0.4_wp
      integer :: n

      call straight_front(8.0_wp)
      n = crack%front%node_count
      rise = rise_of_rows(crack%front, spread(0.5_wp, 1, n), spread(psi, 1, n), &
         spread(.false., 1, n))
      call check_close(suite, 'an end rises by the twist over the way', maxval(abs(rise)), &
         0.5_wp*tan(psi), 0.0_wp, tight)
      call check_close(suite, 'a positive twist turns the row down along the front', &
         rise(n) - rise(1), -tan(psi), 0.0_wp, tight)
      call check_close(suite, 'it turns about its middle', sum(rise), 0.0_wp, tight, 0.0_wp)
      rise = rise_of_rows(crack%front, spread(0.5_wp, 1, n), spread(0.0_wp, 1, n), &
         spread(.false., 1, n))
      call check(suite, 'without a twist nothing rises', all(abs(rise) <= 0))
   end subroutine way_limits_the_turn

   !> As long as the twist is found the front turns on, increment after increment.
   subroutine turn_goes_on()
      type(grown_t) :: grown
      type(error_t), allocatable :: error
      real(wp), allocatable :: offset(:)
      real(wp) :: row(3), tilt(6)
      integer :: i

      call straight_front(6.0_wp)
      tilt = 0
      do i = 1, 6
         call give([1.0_wp, 0.0_wp, 0.3_wp], real(i, wp))
         call advance_fronts(growth, crack, real(i, wp), 0.5_wp)
         call grow_surface(crack%surface, crack%front, growth_vectors(growth, crack), &
            growth%waits, growth%limits, body, grown, error)
         call check_no_error(suite, 'a twisted front grows', error)
         if (allocated(error)) return
         call renew_growth(growth, grown, crack%offset, offset)
         crack%surface = grown%surface
         crack%front = grown%front
         crack%offset = offset
         associate (x => crack%front%x)
            row = unit_vector(x(:, crack%front%node_count) - x(:, 1))
         end associate
         tilt(i) = asin(abs(row(3)))
      end do
      call check(suite, 'rows turn on', tilt(2) > 0.05_wp .and. tilt(4) > 1.5_wp*tilt(2) .and. &
         tilt(6) > 1.3_wp*tilt(4))
   end subroutine turn_goes_on

   !> Around a disc the rise closes: for one lobe of K_III it is one lobe a quarter turn on, and for
   !> the same twist all round there is none.
   subroutine round_a_disc()
      type(crack_plane_t) :: plane
      type(error_t), allocatable :: error
      type(crack_t) :: blank
      real(wp), allocatable :: x(:, :), rise(:), angle(:), way(:)
      integer, allocatable :: tri(:, :)
      real(wp), parameter :: psi = 0.1_wp
      integer :: n

      crack = blank
      call set_plane([0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 1.0_wp, &
         0.0_wp], plane, error)
      call make_disc(plane, 5.0_wp, 1.0_wp, x, tri, error)
      call build_surface(x, tri, crack%surface, error)
      call find_front(crack%surface, crack%surface%edge(:, crack%surface%boundary), 1.0_wp, body, &
         crack%front)
      n = crack%front%node_count
      angle = atan2(crack%front%x(2, :), crack%front%x(1, :))
      way = spread(20.0_wp, 1, n)
      rise = rise_of_rows(crack%front, way, psi*sin(angle), spread(.false., 1, n))
      ! e3 runs clockwise seen from above the normal or against it; the trapezoids of 31 segments
      ! lack (2 pi/31)**2/12 = 0.4 % of the integral, and tan(psi) is 0.3 % more than psi
      call check_close(suite, 'one lobe of twist makes one lobe of rise', &
         min(maxval(abs(rise - 5*psi*cos(angle))), maxval(abs(rise + 5*psi*cos(angle)))), 0.0_wp, &
         0.01_wp*5*psi, 0.0_wp)
      rise = rise_of_rows(crack%front, way, spread(psi, 1, n), spread(.false., 1, n))
      call check_close(suite, 'a closed front cannot turn all round', maxval(abs(rise)), 0.0_wp, &
         1.0e-3_wp*5*psi, 0.0_wp)
   end subroutine round_a_disc
end program test_twist_rows
