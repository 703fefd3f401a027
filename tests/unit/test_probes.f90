!> Probes follow their particle, and forces are those of the stress, on any number of ranks.
! ranks: 1 2 3
program test_probes
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t
   use xmpm_text, only: string_t
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, min_all
   use xmpm_deck, only: deck_t, problems
   use xmpm_model, only: model_t
   use xmpm_probes, only: probe_t, read_probes, probe_names, probe_units, probe_values
   use small_model, only: make_model
   use testing, only: suite_t, check, check_error, check_no_error, finish
   implicit none
   character(len=*), parameter :: base = '*JOB bar|*UNITS length=mm mass=g time=ms|*GRID size=1|' &
      //'*TIME end=1|*MATERIAL alloy density=2 young=100 poisson=0.25|' &
      //'*BODY bar material=alloy box=0 0 0 12 4 4 particles=2 stress=10 20 30 4 5 6|' &
      //'*BOUNDARY base plane=x 0 type=fixed|'
   real(wp), parameter :: rounding = 1.0e-12_wp   !! sums of some thousand terms below 1e4
   type(comm_t) :: comm
   type(suite_t) :: suite

   call start_parallel(comm)
   suite%name = 'probes'
   call test_points(suite)
   call test_ties(suite)
   call test_sections(suite)
   call test_reaction(suite)
   call test_columns(suite)
   call test_void(suite)
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   subroutine probe(text, m, probes, values)
      character(len=*), intent(in) :: text                  !! *PROBE blocks
      type(model_t), intent(out) :: m
      type(probe_t), allocatable, intent(out) :: probes(:)
      real(wp), allocatable, intent(out) :: values(:)
      type(deck_t) :: deck
      type(error_t), allocatable :: error

      call make_model(comm, base//text, deck, m, error)
      call check_no_error(suite, 'the deck is set up', error)
      call read_probes(deck, m, probes)
      call problems(deck, error)
      call check_no_error(suite, 'the probes are read', error)
      call probe_values(probes, m, values)
   end subroutine probe

   !> Each particle gets the velocity that equals its first position, so that it can be told.
   subroutine test_points(suite)
      type(suite_t), intent(inout) :: suite
      type(model_t) :: m
      type(probe_t), allocatable :: probes(:)
      real(wp), allocatable :: values(:)

      call probe('*PROBE a point=11.9 3.4 0.1|*PROBE b point=0.3 0.3 0.3 quantity=velocity|' &
         //'*PROBE c point=6 2 2 quantity=stress|', m, probes, values)
      call check(suite, 'a displacement has three values, a stress six', size(values) == 12)
      call check(suite, 'nothing has moved at the start', all(abs(values(:6)) <= 0))
      ! the stress is copied, so it is exact
      call check(suite, 'the stress is that of the particle', &
         all(abs(values(7:) - [10.0_wp, 20.0_wp, 30.0_wp, 4.0_wp, 5.0_wp, 6.0_wp]) <= 0))
      m%particles%q(:, 4:6, :) = m%particles%x0
      m%particles%q(:, 1:3, :) = m%particles%q(:, 1:3, :) + 0.5_wp*m%particles%x0
      call probe_values(probes, m, values)
      ! particles stand at odd quarters, exact in binary
      call check(suite, 'the nearest particle is followed as it moves', &
         all(abs(values(:3) - 0.5_wp*[11.75_wp, 3.25_wp, 0.25_wp]) <= 0))
      call check(suite, 'the velocity is that of the nearest particle', &
         all(abs(values(4:6) - 0.25_wp) <= 0))
   end subroutine test_points

   subroutine test_ties(suite)
      type(suite_t), intent(inout) :: suite
      type(model_t) :: m
      type(probe_t), allocatable :: probes(:)
      real(wp), allocatable :: values(:)
      integer(i8) :: lowest
      integer :: c, i

      call probe('*PROBE a point=6 2 2|', m, probes, values)
      lowest = huge(lowest)
      do c = 1, m%particles%n_chunks
         do i = 1, m%particles%count(c)
            ! eight particles are equally near to this corner of cells
            if (any(abs(m%particles%x0(i, :, c) - [6.0_wp, 2.0_wp, 2.0_wp]) > 0.3_wp)) cycle
            lowest = min(lowest, m%particles%id(i, c))
         end do
      end do
      call min_all(comm, lowest)
      call check(suite, 'of particles equally near, the lowest number is taken', &
         probes(1)%id == lowest)
   end subroutine test_ties

   subroutine test_sections(suite)
      type(suite_t), intent(inout) :: suite
      type(model_t) :: m
      type(probe_t), allocatable :: probes(:)
      real(wp), allocatable :: values(:)

      call probe('*PROBE a section=x 6|*PROBE b section=x 3.3|*PROBE c section=y 2.25|' &
         //'*PROBE d section=z 2|', m, probes, values)
      call check(suite, 'the force through a section is stress times area', &
         all(abs(values(:3) - 16*[10.0_wp, 4.0_wp, 6.0_wp]) < 160*rounding))
      call check(suite, 'it does not depend on where the section cuts the cells', &
         all(abs(values(4:6) - 16*[10.0_wp, 4.0_wp, 6.0_wp]) < 160*rounding))
      call check(suite, 'the stress of the y axis goes through a section of it', &
         all(abs(values(7:9) - 48*[4.0_wp, 20.0_wp, 5.0_wp]) < 960*rounding))
      call check(suite, 'the stress of the z axis goes through a section of it', &
         all(abs(values(10:) - 48*[6.0_wp, 5.0_wp, 30.0_wp]) < 1440*rounding))
      call check_tension(suite, m, probes)
   end subroutine test_sections

   !> A stress that grows along x: the section reads that of its own place.
   subroutine check_tension(suite, m, probes)
      type(suite_t), intent(inout) :: suite
      type(model_t), intent(inout) :: m
      type(probe_t), intent(in) :: probes(:)
      real(wp), allocatable :: values(:)

      m%particles%q(:, 9, :) = m%particles%x0(:, 1, :)
      call probe_values(probes, m, values)
      ! particles lie evenly about x = 6
      call check(suite, 'a section reads the stress at its place', &
         abs(values(1) - 16*6) < 96*rounding)
      ! the share of partly covered particles weighs their centres, off by less than a quarter
      call check(suite, 'a section between particles reads the stress near its place', &
         abs(values(4) - 16*3.3_wp) < 16*0.25_wp)
   end subroutine check_tension

   subroutine test_reaction(suite)
      type(suite_t), intent(inout) :: suite
      type(model_t) :: m
      type(probe_t), allocatable :: probes(:)
      real(wp), allocatable :: values(:)

      call probe('*PROBE a reaction=base|', m, probes, values)
      call check(suite, 'nothing holds a body before the first step', all(abs(values) <= 0))
      m%boundaries(1)%reaction = real((comm%rank + 1)*[1, 2, 3], wp)
      call probe_values(probes, m, values)
      ! small whole numbers, exact
      call check(suite, 'a reaction is the sum over the ranks', &
         all(abs(values - real([1, 2, 3]*comm%size*(comm%size + 1)/2, wp)) <= 0))
   end subroutine test_reaction

   subroutine test_columns(suite)
      type(suite_t), intent(inout) :: suite
      type(model_t) :: m
      type(deck_t) :: deck
      type(probe_t), allocatable :: probes(:)
      type(string_t), allocatable :: names(:), units(:)
      type(error_t), allocatable :: error
      integer :: i
      character(len=:), allocatable :: all_names, all_units

      call make_model(comm, base//'*PROBE "a, b" point=1 1 1|*PROBE s point=1 1 1 ' &
         //'quantity=stress|*PROBE f section=x 6|', deck, m, error)
      call check_no_error(suite, 'a deck with named probes is set up', error)
      call read_probes(deck, m, probes)
      names = probe_names(probes)
      units = probe_units(deck, probes)
      all_names = ''
      all_units = ''
      do i = 1, size(names)
         all_names = all_names//names(i)%s//'|'
         all_units = all_units//units(i)%s//'|'
      end do
      call check(suite, 'columns are named after the probe, without commas: '//all_names, &
         all_names == 'a_ b_x|a_ b_y|a_ b_z|s_xx|s_yy|s_zz|s_xy|s_yz|s_xz|f_x|f_y|f_z|')
      call check(suite, 'columns have units: '//all_units, all_units == repeat('mm|', 3) &
         //repeat('g/(mm ms2)|', 6)//repeat('g mm/ms2|', 3))
   end subroutine test_columns

   subroutine test_void(suite)
      type(suite_t), intent(inout) :: suite
      type(model_t) :: m
      type(deck_t) :: deck
      type(probe_t), allocatable :: probes(:)
      type(error_t), allocatable :: error

      call make_model(comm, base//'*PROBE far point=20 1 1|', deck, m, error)
      call check_no_error(suite, 'a deck with a probe outside is set up', error)
      call read_probes(deck, m, probes)
      call problems(deck, error)
      call check_error(suite, 'a probe outside the bodies is an error', error, &
         'test.inp:8: *PROBE far, point: there is no material here: the nearest particle is 8.2')
   end subroutine test_void
end program test_probes
