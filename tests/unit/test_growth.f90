!> The clock of growth: ways, increments, filters, and what is carried over to a grown front.
program test_growth
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t
   use xmpm_surface, only: build_surface
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_disc
   use xmpm_crack, only: crack_t
   use xmpm_hoop_stress, only: hoop_stress_t
   use xmpm_running_toughness, only: running_toughness_t
   use xmpm_prescribed, only: prescribed_speed
   use xmpm_front_line, only: limits_for
   use xmpm_material_test, only: material_test_t
   use xmpm_front_search, only: find_front
   use xmpm_grow_surface, only: grown_t, grow_surface
   use xmpm_growth, only: growth_t, region_t, start_growth, advance_fronts, is_due, &
      growth_vectors, renew_growth, take_intensities, toughness_at
   use everywhere, only: everywhere_t
   use testing, only: suite_t, check, check_close, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   type(crack_t) :: crack
   type(growth_t) :: growth
   real(wp), parameter :: tight = 1.0e-12_wp   ! rounding, added up over some hundred steps

   suite%name = 'growth'
   call increment_waits_for_the_way()
   call energy_is_rate_times_area()
   call kinks_turn_and_shorten()
   call folds_are_tried_again()
   call filter_does_not_lag()
   call rest_takes_intensity_as_it_is()
   call outside_follows_inside()
   call toughness_of_regions()
   call finish(suite)

contains

   !> A disc of radius 5 that has not grown, by a prescribed speed of 2.
   subroutine fresh_disc()
      type(crack_plane_t) :: plane
      type(error_t), allocatable :: error
      type(everywhere_t) :: body
      type(growth_t) :: blank
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)

      call set_plane([0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 1.0_wp, &
         0.0_wp], plane, error)
      call make_disc(plane, 5.0_wp, 1.0_wp, x, tri, error)
      call build_surface(x, tri, crack%surface, error)
      call find_front(crack%surface, crack%surface%edge(:, crack%surface%boundary), 1.0_wp, body, &
         crack%front)
      growth = blank
      growth%increment = 0.5_wp
      growth%limits = limits_for(1.0_wp, 1.0_wp, 0.5_wp)
      allocate (growth%criterion, source=hoop_stress_t())
      allocate (growth%law, source=prescribed_speed(2.0_wp, 0.0_wp))
      growth%toughness_of = [20.0_wp, 0.0_wp]
      allocate (growth%regions(0))
      call start_growth(growth, crack)
   end subroutine fresh_disc

   !> The surface grows when the way has reached the increment, not before; no way is lost.
   subroutine increment_waits_for_the_way()
      type(error_t), allocatable :: error
      type(everywhere_t) :: body
      type(grown_t) :: grown
      real(wp), allocatable :: offset(:), radius(:)
      real(wp), parameter :: dt = 0.03_wp
      integer :: i, increments
      logical :: early

      call fresh_disc()
      increments = 0
      early = .false.
      do i = 1, 100
         call advance_fronts(growth, crack, real(i - 1, wp)*dt, dt)
         if (.not. is_due(growth, crack)) cycle
         early = early .or. maxval(crack%offset) < 0.5_wp - tight
         call grow_surface(crack%surface, crack%front, growth_vectors(growth, crack), &
            growth%waits, growth%limits, body, grown, error)
         call check_no_error(suite, 'a disc grows by its clock', error)
         call renew_growth(growth, grown, crack%offset, offset)
         crack%surface = grown%surface
         crack%front = grown%front
         crack%offset = offset
         increments = increments + 1
      end do
      call check(suite, 'no increment before its way', .not. early)
      ! 9 steps of 0.06 make 0.54, the first sum not below 0.5; 100 steps hold 11 of them
      call check(suite, 'an increment takes as many steps as its way', increments == 11)
      call check(suite, 'they are counted', growth%increments == 11)
      radius = norm2(crack%front%x, 1) + crack%offset
      ! as in the test of surfaces: nodes on cubics between nodes
      call check_close(suite, 'mesh and way ahead together are where the law says', &
         sum(radius)/real(size(radius), wp), 11.0_wp, 0.02_wp, 0.0_wp)
   end subroutine increment_waits_for_the_way

   !> G dA over the steps.
   subroutine energy_is_rate_times_area()
      integer :: i

      call fresh_disc()
      growth%rate = 3.0_wp
      do i = 1, 4
         call advance_fronts(growth, crack, real(i - 1, wp)*0.01_wp, 0.01_wp)
      end do
      call check_close(suite, 'the area is length times way', growth%area, &
         crack%front%length(1)*0.08_wp, 0.0_wp, tight)
      call check_close(suite, 'the energy is G dA', growth%energy, 3*growth%area, 0.0_wp, tight)
   end subroutine energy_is_rate_times_area

   !> The way goes along the kink; where it is sharp the increment is short.
   subroutine kinks_turn_and_shorten()
      real(wp), allocatable :: advance(:, :)

      call fresh_disc()
      growth%kink = pi/3
      call advance_fronts(growth, crack, 0.0_wp, 0.06_wp)
      advance = growth_vectors(growth, crack)
      call check_close(suite, 'a positive kink goes to the side of the normal', &
         maxval(abs(sum(advance*crack%front%e2, 1) - 0.12_wp*sin(pi/3))), 0.0_wp, tight, 0.0_wp)
      call check_close(suite, 'the way keeps its length', &
         maxval(abs(norm2(advance, 1) - 0.12_wp)), &
         0.0_wp, tight, 0.0_wp)
      call check(suite, 'at a sharp kink a quarter of the increment is not reached at 0.12', &
         .not. is_due(growth, crack))
      call advance_fronts(growth, crack, 0.06_wp, 0.003_wp)
      call check(suite, 'and is reached at 0.126', is_due(growth, crack))
      growth%kink = 0
      call check(suite, 'straight on it is not', .not. is_due(growth, crack))
   end subroutine kinks_turn_and_shorten

   !> Nodes whose triangles would have been folded keep their way, and are due again when they have
   !> gone another increment.
   subroutine folds_are_tried_again()
      type(error_t), allocatable :: error
      type(everywhere_t) :: body
      type(grown_t) :: grown
      real(wp), allocatable :: offset(:)

      call fresh_disc()
      call advance_fronts(growth, crack, 0.0_wp, 0.25_wp)
      call check(suite, 'the way of an increment is due', is_due(growth, crack))
      growth%waits(:3) = .true.
      call grow_surface(crack%surface, crack%front, growth_vectors(growth, crack), &
         growth%waits, growth%limits, body, grown, error)
      call check_no_error(suite, 'a disc grows but at three nodes', error)
      grown%held(:3) = .true.
      growth%waits = .false.
      call renew_growth(growth, grown, crack%offset, offset)
      call check(suite, 'three nodes have kept their way', count(abs(offset - 0.5_wp) < tight) &
         == 3 .and. count(abs(offset) < tight) == size(offset) - 3)
      crack%surface = grown%surface
      crack%front = grown%front
      crack%offset = offset
      call check(suite, 'they are not due at once', .not. is_due(growth, crack))
      call advance_fronts(growth, crack, 0.25_wp, 0.24_wp)
      call check(suite, 'nor before another increment', .not. is_due(growth, crack))
      call advance_fronts(growth, crack, 0.49_wp, 0.01_wp)
      call check(suite, 'but then', is_due(growth, crack))
   end subroutine folds_are_tried_again

   !> K that rises steadily is followed without a lag; noise is damped.
   subroutine filter_does_not_lag()
      real(wp), allocatable :: k(:, :), rate(:)
      real(wp) :: t, worst
      integer :: i

      call fresh_disc()
      deallocate (growth%law)
      allocate (growth%law, source=running_toughness_t())
      growth%filter = 1.0_wp
      growth%speed = 1.0_wp
      allocate (k, source=0*growth%k)
      allocate (rate, source=0*growth%rate)
      do i = 0, 400
         t = 0.05_wp*real(i, wp)
         k(1, :) = 10 + 2*t
         call take_intensities(growth, k, rate, t)
      end do
      ! the starting error decays as t exp(-t): 20 exp(-20) is 4e-8 of K
      call check_close(suite, 'K that rises steadily does not lag', growth%intensity(1), 50.0_wp, &
         0.0_wp, 1.0e-5_wp)
      worst = 0
      do i = 401, 1200
         t = 0.05_wp*real(i, wp)
         k(1, :) = 50 + 5*real((-1)**i, wp)
         call take_intensities(growth, k, rate, t)
         if (i > 1000) worst = max(worst, abs(growth%intensity(1) - 50))
      end do
      ! (1 - exp(-0.05))/(1 + exp(-0.05)) is 0.025 of the noise, twice that less its square
      call check(suite, 'noise from step to step is damped to a twentieth', worst < 0.05_wp*5)
   end subroutine filter_does_not_lag

   !> A node at rest begins when K reaches the toughness, without waiting for the filter.
   subroutine rest_takes_intensity_as_it_is()
      real(wp), allocatable :: k(:, :), rate(:)
      integer :: i

      call fresh_disc()
      deallocate (growth%law)
      allocate (growth%law, source=running_toughness_t())
      growth%filter = 100.0_wp
      growth%toughness = 20
      growth%rayleigh = 3
      allocate (k, source=0*growth%k)
      allocate (rate, source=0*growth%rate)
      do i = 1, 3
         k(1, :) = 10.0_wp*real(i, wp) - 1
         call take_intensities(growth, k, rate, real(i, wp))
         call advance_fronts(growth, crack, real(i, wp), 0.01_wp)
         if (i == 2) call check(suite, 'below the toughness nothing grows', all(abs(crack%offset) &
            <= 0))
      end do
      call check_close(suite, 'at rest the law sees K as it is', growth%speed(1), &
         3*(1 - 20/29.0_wp), 0.0_wp, tight)
   end subroutine rest_takes_intensity_as_it_is

   !> A node outside the material goes with the nearest one inside; without any it stays.
   subroutine outside_follows_inside()
      call fresh_disc()
      growth%outside(1:3) = .true.
      growth%kink(size(growth%kink)) = 0.3_wp
      call advance_fronts(growth, crack, 0.0_wp, 0.01_wp)
      call check_close(suite, 'a node outside goes as far as one inside', crack%offset(2), &
         0.02_wp, &
         0.0_wp, tight)
      call check_close(suite, 'and turns with the nearest', growth%kink(1), 0.3_wp, 0.0_wp, 0.0_wp)
      call fresh_disc()
      growth%outside = .true.
      call advance_fronts(growth, crack, 0.0_wp, 0.01_wp)
      call check(suite, 'a front wholly outside stays', all(abs(crack%offset) <= 0))
      call fresh_disc()
      growth%waits(4) = .true.
      call advance_fronts(growth, crack, 0.0_wp, 0.01_wp)
      call check(suite, 'a node that waits stays', abs(crack%offset(4)) <= 0 .and. &
         crack%offset(5) > 0)
   end subroutine outside_follows_inside

   !> The last region that holds a point wins over the body.
   subroutine toughness_of_regions()
      real(wp), parameter :: x(3) = [1.0_wp, 2.0_wp, 3.0_wp]

      call fresh_disc()
      call check_close(suite, 'a body has its toughness', toughness_at(growth, 1, x), 20.0_wp, &
         0.0_wp, 0.0_wp)
      call check_close(suite, 'no body has none', toughness_at(growth, 0, x), 0.0_wp, 0.0_wp, &
         0.0_wp)
      growth%regions = [region_t([0.0_wp, 0.0_wp, 0.0_wp, 5.0_wp, 5.0_wp, 5.0_wp], 7.0_wp), &
         region_t([0.0_wp, 0.0_wp, 0.0_wp, 2.0_wp, 2.0_wp, 3.0_wp], 9.0_wp)]
      call check_close(suite, 'the last region counts', toughness_at(growth, 1, x), 9.0_wp, &
         0.0_wp, &
         0.0_wp)
      call check_close(suite, 'outside it the first', toughness_at(growth, 1, x + 1), 7.0_wp, &
         0.0_wp, 0.0_wp)
   end subroutine toughness_of_regions
end program test_growth
