!> Files of a run hold what the model holds, whatever the number of ranks.
! ranks: 1 2 3
program test_results
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t
   use xmpm_text, only: to_text
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, wait_for_all
   use xmpm_file_system, only: file_exists
   use xmpm_hdf5_file, only: hdf5_file_t, open_file, close_file
   use xmpm_hdf5_read, only: read_dataset, read_attribute
   use xmpm_provenance, only: provenance_t, start_provenance
   use xmpm_deck, only: deck_t
   use xmpm_elastic, only: elastic_t, new_elastic
   use xmpm_model, only: model_t
   use xmpm_balance, only: balance_t, momenta
   use xmpm_results, only: results_t, open_results, write_fields, write_energy, write_probes, &
      close_results
   use small_model, only: make_model
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none
   character(len=*), parameter :: base = '*JOB bar|*UNITS length=mm mass=g time=ms|*GRID size=1|' &
      //'*TIME end=1|*MATERIAL alloy density=2 young=100 poisson=0.25|' &
      //'*MATERIAL other density=3 young=50 poisson=0.2|'
   character(len=*), parameter :: bar = '*BODY bar material=other box=0 0 0 12 4 4 particles=2|'
   real(wp), parameter :: single = 1.0e-6_wp   !! fields are kept in single precision, 6e-8
   type(comm_t) :: comm
   type(suite_t) :: suite
   type(provenance_t) :: provenance
   character(len=:), allocatable :: folder

   call start_parallel(comm)
   suite%name = 'results'
   folder = 'results_'//to_text(comm%size)
   call start_provenance(provenance, comm)
   call test_momenta(suite)
   call test_particles(suite)
   call test_near_fields(suite)
   call test_cracks(suite)
   call test_tables(suite)
   call test_none(suite)
   call test_energy_density(suite)
   call test_failure(suite)
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   !> Set a model up and open its results.
   subroutine begin(text, job, deck, m, results)
      character(len=*), intent(in) :: text, job
      type(deck_t), intent(out) :: deck
      type(model_t), intent(out) :: m
      type(results_t), intent(out) :: results
      type(error_t), allocatable :: error

      call make_model(comm, base//text, deck, m, error)
      call check_no_error(suite, 'the deck of '//job//' is set up', error)
      call open_results(results, m, deck, provenance, folder, job, error)
      call check_no_error(suite, 'the results of '//job//' are opened', error)
   end subroutine begin

   !> Write the fields, close all, and open a file that was written.
   subroutine read_back(m, results, name, file)
      type(model_t), intent(in) :: m
      type(results_t), intent(inout) :: results
      character(len=*), intent(in) :: name   !! of the file, without what stands behind the point
      type(hdf5_file_t), intent(out) :: file
      type(error_t), allocatable :: error

      call write_fields(results, m, error)
      call check_no_error(suite, 'fields are written', error)
      call close_results(results, m, error)
      call check_no_error(suite, 'results are closed', error)
      call wait_for_all(comm)
      call open_file(file, folder//'/'//name//'.vtkhdf', error)
      call check_no_error(suite, name//' can be read', error)
   end subroutine read_back

   subroutine test_momenta(suite)
      type(suite_t), intent(inout) :: suite
      type(deck_t) :: deck
      type(model_t) :: m
      type(error_t), allocatable :: error
      real(wp) :: linear(3), angular(3)

      call make_model(comm, base//'*BODY bar material=alloy box=0 0 0 12 4 4 particles=2 '// &
         'velocity=1 2 3|', deck, m, error)
      call check_no_error(suite, 'a moving bar is set up', error)
      call momenta(m, linear, angular)
      ! mass 384, centre 6 2 2; sums of 1536 numbers below 1e3 round to 1e-12 of the largest
      call check(suite, 'linear momentum is mass times velocity', &
         all(abs(linear - 384*[1.0_wp, 2.0_wp, 3.0_wp]) < 1.0e-8_wp))
      call check(suite, 'angular momentum is centre x momentum', &
         all(abs(angular - 384*[2.0_wp, -16.0_wp, 10.0_wp]) < 1.0e-8_wp))
   end subroutine test_momenta

   !> Two steps; the second is read back from the master with ids as the key.
   subroutine test_particles(suite)
      type(suite_t), intent(inout) :: suite
      type(deck_t) :: deck
      type(model_t) :: m
      type(results_t) :: results
      type(hdf5_file_t) :: file
      type(error_t), allocatable :: error
      real(wp), allocatable :: x(:, :), u(:, :), v(:, :), s(:, :), times(:), energy(:)
      integer(i8), allocatable :: id(:), number(:)
      character(len=:), allocatable :: unit
      integer :: n

      call begin(bar//'*OUTPUT particles=displacement velocity stress energy material body '// &
         'psi phi side id rank|', 'bar', deck, m, results)
      call write_fields(results, m, error)
      call check_no_error(suite, 'the start is written', error)
      m%particles%q(:, 4:6, :) = 2*m%particles%x0
      m%particles%q(:, 1:3, :) = m%particles%q(:, 1:3, :) + 0.25_wp*m%particles%x0
      m%particles%q(:, 9:11, :) = m%particles%x0
      m%time = 0.5_wp
      call read_back(m, results, 'bar_particles', file)
      call read_dataset(file, 'VTKHDF/Steps/Values', times)
      call check(suite, 'the times are those of the model', size(times) == 2 .and. &
         all(abs(times - [0.0_wp, 0.5_wp]) <= 0))
      n = 12*4*4*8
      call read_dataset(file, 'VTKHDF/Points', x, int(n + 1, i8), int(n, i8))
      call read_dataset(file, 'VTKHDF/PointData/displacement', u, int(n + 1, i8), int(n, i8))
      call read_dataset(file, 'VTKHDF/PointData/velocity', v, int(n + 1, i8), int(n, i8))
      call read_dataset(file, 'VTKHDF/PointData/stress', s, int(n + 1, i8), int(n, i8))
      call read_dataset(file, 'VTKHDF/PointData/energy', energy, int(n + 1, i8), int(n, i8))
      call read_dataset(file, 'VTKHDF/PointData/id', id, int(n + 1, i8), int(n, i8))
      call read_dataset(file, 'VTKHDF/PointData/rank', number, int(n + 1, i8), int(n, i8))
      call check(suite, 'every rank has written its particles', minval(number) == 0 .and. &
         maxval(number) == int(comm%size - 1, i8))
      call read_dataset(file, 'VTKHDF/PointData/material', number, int(n + 1, i8), int(n, i8))
      call check(suite, 'materials count from the first of the deck', all(number == 2))
      call read_dataset(file, 'VTKHDF/PointData/body', number, int(n + 1, i8), int(n, i8))
      call check(suite, 'bodies count from the first of the deck', all(number == 1))
      call read_dataset(file, 'VTKHDF/PointData/side', number)
      call check(suite, 'without cracks there are no sides', all(number == 0))
      call check(suite, 'each particle is there once', is_permutation(id))
      ! positions are odd quarters times 5/4: exact also in single precision
      call check(suite, 'the displacement is the way from the first position', &
         all(abs(u - x/5) < single))
      call check(suite, 'the velocity stands at its particle', all(abs(v - 8*u) < single))
      call check(suite, 'the stress stands at its particle', all(abs(s(:3, :) - 4*u) < single) &
         .and. all(abs(s(4:, :)) <= 0))
      ! e = ((s:s) - nu/(1 + nu) (tr s)**2) (1 + nu)/(2 E)
      call check(suite, 'the energy is that of the stress', all(abs(energy - 0.012_wp*( &
         sum(s**2, dim=1) - sum(s, dim=1)**2/6)) < single*300))
      call read_attribute(file, 'VTKHDF/PointData/energy', 'unit', unit)
      call check(suite, 'fields say their unit', unit == 'g/(mm ms2)')
      call close_file(file, error)
      call check_no_error(suite, 'the particles were all found', error)
   end subroutine test_particles

   pure function is_permutation(id) result(holds)
      integer(i8), intent(in) :: id(:)
      logical :: holds, seen(size(id))
      integer :: i

      seen = .false.
      do i = 1, size(id)
         if (id(i) >= 1 .and. id(i) <= size(id, kind=i8)) seen(int(id(i))) = .true.
      end do
      holds = all(seen)
   end function is_permutation

   !> A crack through the bar at z = 2 up to x = 6.
   subroutine test_near_fields(suite)
      type(suite_t), intent(inout) :: suite
      type(deck_t) :: deck
      type(model_t) :: m
      type(results_t) :: results
      type(hdf5_file_t) :: file
      type(error_t), allocatable :: error
      real(wp), allocatable :: x(:, :), psi(:), phi(:)
      integer(i8), allocatable :: side(:)
      logical, allocatable :: near(:)

      call begin(bar//'*CRACK c rectangle centre=3 2 2 along=1 0 0 across=0 1 0 width=6 '// &
         'depth=4 element=1|*OUTPUT particles=side psi phi crack=none|', 'near', deck, m, results)
      call read_back(m, results, 'near_particles', file)
      call read_dataset(file, 'VTKHDF/Points', x)
      call read_dataset(file, 'VTKHDF/PointData/psi', psi)
      call read_dataset(file, 'VTKHDF/PointData/phi', phi)
      call read_dataset(file, 'VTKHDF/PointData/side', side)
      near = x(1, :) < 7
      call check(suite, 'psi is the distance to the plane of the crack', &
         all(abs(psi - (x(3, :) - 2)) < single .or. .not. near))
      call check(suite, 'phi is the distance ahead of its front', &
         all(abs(phi - (x(1, :) - 6)) < single .or. .not. near))
      call check(suite, 'particles know their side', &
         all(side == merge(1_i8, -1_i8, x(3, :) > 2) .or. .not. near))
      call check(suite, 'far from the crack there is neither side nor distance', &
         all((side == 0 .and. abs(psi) + abs(phi) <= 0) .or. x(1, :) < 11))
      call check(suite, 'a series that nobody wants is not written', &
         .not. file_exists(folder//'/near_crack.vtkhdf'))
      call close_file(file, error)
      call check_no_error(suite, 'psi, phi and side were found', error)
   end subroutine test_near_fields

   !> A disc inside and a strip that ends inside; each rank opens the vertices that it moves.
   subroutine test_cracks(suite)
      type(suite_t), intent(inout) :: suite
      type(deck_t) :: deck
      type(model_t) :: m
      type(results_t) :: results
      type(hdf5_file_t) :: file
      type(error_t), allocatable :: error
      real(wp), allocatable :: x(:, :), opening(:, :), across(:), u(:, :), normal(:, :)
      integer(i8), allocatable :: crack(:)
      integer :: i

      call begin(bar//'*CRACK a disc centre=8 2 2 along=1 0 0 across=0 1 0 radius=1.5 element=1|' &
         //'*CRACK b rectangle centre=1 2 3 along=1 0 0 across=0 1 0 width=4 depth=6 element=1|' &
         //'*OUTPUT crack=opening displacement normal|', 'slits', deck, m, results)
      do i = 1, 2
         call open_mine(m, i)
      end do
      call read_back(m, results, 'slits_crack', file)
      call read_dataset(file, 'VTKHDF/Points', x)
      call read_dataset(file, 'VTKHDF/PointData/opening', opening)
      call read_dataset(file, 'VTKHDF/PointData/opening_normal', across)
      call read_dataset(file, 'VTKHDF/PointData/displacement', u)
      call read_dataset(file, 'VTKHDF/PointData/normal', normal)
      call read_dataset(file, 'VTKHDF/PointData/crack', crack)
      i = m%cracks(1)%surface%vertex_count
      call check(suite, 'cracks are numbered in the order of the deck', &
         all(crack(:i) == 1) .and. all(crack(i + 1:) == 2) .and. &
         size(crack) == i + m%cracks(2)%surface%vertex_count)
      call check(suite, 'the normal points to the plus side', &
         all(abs(normal - spread([0.0_wp, 0.0_wp, 1.0_wp], 2, size(crack))) < single))
      ! the strip has vertices outside the body that no rank moves: they follow their neighbours
      x = x - u
      call check(suite, 'the opening is that of both faces, from all ranks', &
         all(abs(opening(3, :) - 0.01_wp*x(1, :)) < single .or. is_outside(x)) .and. &
         all(abs(opening(:2, :)) < single))
      call check(suite, 'its component along the normal stands apart', &
         all(abs(across - opening(3, :)) < single))
      call check(suite, 'the surface moves with the mean of its faces', &
         all(abs(u(1, :) - 0.125_wp) < single .or. is_outside(x)))
      call check_fronts(suite, file, x)
      call close_file(file, error)
      call check_no_error(suite, 'the fields of the cracks were found', error)
   end subroutine test_cracks

   pure function is_outside(x) result(outside)
      real(wp), intent(in) :: x(:, :)
      logical :: outside(size(x, 2))

      outside = x(1, :) < 0.1_wp .or. x(2, :) < 0.1_wp .or. x(2, :) > 3.9_wp
   end function is_outside

   !> Open a crack by 0.01 x and shift it by 1/8 where this rank moves its vertices.
   subroutine open_mine(m, i)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: i
      integer :: v

      associate (s => m%cracks(i)%surface)
         do v = 1, s%vertex_count
            m%cracks(i)%material(v) = m%cracks(i)%mine(v)
            if (.not. m%cracks(i)%mine(v)) cycle
            s%up(:, v) = [0.125_wp, 0.0_wp, 0.005_wp*s%start(1, v)]
            s%um(:, v) = [0.125_wp, 0.0_wp, -0.005_wp*s%start(1, v)]
         end do
      end associate
   end subroutine open_mine

   !> One closed line about the disc, one open line across the bar at x = 3.
   subroutine check_fronts(suite, file, x)
      type(suite_t), intent(inout) :: suite
      type(hdf5_file_t), intent(inout) :: file
      real(wp), intent(in) :: x(:, :)   !! before the motion
      integer(i8), allocatable :: offsets(:), points(:)

      call read_dataset(file, 'VTKHDF/Lines/Offsets', offsets)
      call read_dataset(file, 'VTKHDF/Lines/Connectivity', points)
      call check(suite, 'each front is a line', size(offsets) == 3)
      if (size(offsets) /= 3) return
      points = points + 1
      associate (ring => points(:offsets(2)), edge => points(offsets(2) + 1:))
         call check(suite, 'a closed front ends where it begins', ring(1) == ring(size(ring)))
         call check(suite, 'the front of a disc is its rim', &
            all(abs(norm2(x(:2, ring) - spread([8.0_wp, 2.0_wp], 2, size(ring)), dim=1) &
            - 1.5_wp) < single))
         call check(suite, 'the front of a strip is its inner edge', size(edge) > 2 .and. &
            all(abs(x(1, edge) - 3) < single))
      end associate
   end subroutine check_fronts

   subroutine test_tables(suite)
      type(suite_t), intent(inout) :: suite
      type(deck_t) :: deck
      type(model_t) :: m
      type(results_t) :: results
      type(balance_t) :: balance
      type(error_t), allocatable :: error
      real(wp) :: row(22)

      call begin(bar//'*OUTPUT particles=none every=0.25 history=0.125|'// &
         '*PROBE tip point=11.9 2 2|', 'table', deck, m, results)
      call check(suite, 'the intervals are those of the deck', &
         abs(results%every - 0.25_wp) <= 0 .and. abs(results%history_every - 0.125_wp) <= 0)
      balance = balance_t(time=0.5_wp, step=7_i8, dt=0.1_wp, kinetic=1.0_wp, strain=2.0_wp, &
         external=3.0_wp, damping=4.0_wp, transfer=4.5_wp, fracture=4.6_wp, unresolved=4.7_wp, &
         transfer_seen=4.8_wp, error=5.0_wp, relative_error=6.0_wp, fracture_error=6.5_wp, &
         linear=[7.0_wp, 8.0_wp, 9.0_wp], angular=[10.0_wp, 11.0_wp, 12.0_wp])
      call write_energy(results, m, balance)
      m%time = 0.75_wp
      m%particles%q(:, 1:3, :) = m%particles%q(:, 1:3, :) + 0.5_wp
      call write_probes(results, m)
      call close_results(results, m, error)
      call check_no_error(suite, 'tables are closed', error)
      call wait_for_all(comm)
      call read_table(suite, 'table_energy', 'time,step,dt,kinetic,strain,external,damping,'// &
         'transfer,plastic,contact,fracture,unresolved,transfer_seen,balance_error,'// &
         'relative_error,fracture_error,momentum_x,momentum_y,momentum_z,'// &
         'angular_x,angular_y,angular_z', &
         '# units: ms,1,ms'// &
         repeat(',g mm2/ms2', 11)//',1,1'//repeat(',g mm/ms', 3)//repeat(',g mm2/ms', 3), row)
      ! 17 digits give every real back
      call check(suite, 'the row is the balance', all(abs(row - [0.5_wp, 7.0_wp, 0.1_wp, 1.0_wp, &
         2.0_wp, 3.0_wp, 4.0_wp, 4.5_wp, 0.0_wp, 0.0_wp, 4.6_wp, 4.7_wp, 4.8_wp, 5.0_wp, 6.0_wp, &
         6.5_wp, 7.0_wp, 8.0_wp, 9.0_wp, 10.0_wp, 11.0_wp, 12.0_wp]) <= 0))
      call read_table(suite, 'table_probe', 'time,step,tip_x,tip_y,tip_z', &
         '# units: ms,1,mm,mm,mm', row(:5))
      call check(suite, 'the row is what the probe sees', &
         all(abs(row(:5) - [0.75_wp, 0.0_wp, 0.5_wp, 0.5_wp, 0.5_wp]) <= 0))
   end subroutine test_tables

   !> The one row of a table, and what stands above it.
   subroutine read_table(suite, name, header, units, row)
      type(suite_t), intent(inout) :: suite
      character(len=*), intent(in) :: name, header, units   !! file, and lines that must be there
      real(wp), intent(out) :: row(:)
      character(len=600) :: line, before
      integer :: unit, status

      open (newunit=unit, file=folder//'/'//name//'.csv', status='old', action='read')
      line = ''
      do
         before = line
         read (unit, '(a)', iostat=status) line
         if (status /= 0 .or. line(1:1) /= '#') exit
      end do
      call check(suite, name//' has its columns: '//trim(line), line == header)
      call check(suite, name//' has its units: '//trim(before), before == units)
      read (unit, *, iostat=status) row
      call check(suite, name//' has one row', status == 0)
      close (unit)
   end subroutine read_table

   subroutine test_none(suite)
      type(suite_t), intent(inout) :: suite
      type(deck_t) :: deck
      type(model_t) :: m
      type(results_t) :: results
      type(error_t), allocatable :: error

      call begin(bar//'*OUTPUT particles=none|', 'bar', deck, m, results)
      call write_fields(results, m, error)
      call check_no_error(suite, 'nothing to write is no error', error)
      call close_results(results, m, error)
      call check_no_error(suite, 'a run without probes can be closed', error)
      call check(suite, 'particles that nobody wants are not written, older ones not left', &
         .not. file_exists(folder//'/bar_particles.vtkhdf'))
      call check(suite, 'without probes there is no table of them', &
         .not. file_exists(folder//'/bar_probe.csv'))
   end subroutine test_none

   subroutine test_energy_density(suite)
      type(suite_t), intent(inout) :: suite
      type(elastic_t) :: law

      law = new_elastic('alloy', 1.0_wp, 100.0_wp, 0.25_wp)
      ! a handful of operations each: rounding only
      call check_close(suite, 'tension stores s**2/(2 E)', &
         law%strain_energy([10.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]), 0.5_wp, &
         0.0_wp, 1e-14_wp)
      call check_close(suite, 'shear stores t**2/(2 mu)', &
         law%strain_energy([0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 4.0_wp, 0.0_wp]), 0.2_wp, &
         0.0_wp, 1e-14_wp)
      call check_close(suite, 'pressure stores p**2/(2 K)', &
         law%strain_energy([2.0_wp, 2.0_wp, 2.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]), 0.03_wp, &
         0.0_wp, 1e-14_wp)
   end subroutine test_energy_density

   subroutine test_failure(suite)
      type(suite_t), intent(inout) :: suite
      type(deck_t) :: deck
      type(model_t) :: m
      type(results_t) :: results
      type(error_t), allocatable :: error

      call make_model(comm, base//bar//'*PROBE far point=20 0 0|', deck, m, error)
      call check_no_error(suite, 'a deck with a probe outside is set up', error)
      call open_results(results, m, deck, provenance, folder, 'far', error)
      call check_error(suite, 'a probe outside the bodies is told on all ranks', error, &
         '*PROBE far')
      call check(suite, 'no file is begun then', .not. file_exists(folder//'/far_energy.csv'))
      call make_model(comm, base//bar, deck, m, error)
      call open_results(results, m, deck, provenance, '/dev/null/x', 'bar', error)
      call check_error(suite, 'a folder that cannot be made is told on all ranks', error, &
         '/dev/null')
   end subroutine test_failure
end program test_results
