!> Particles of bodies: volumes, centres of mass, symmetries, and independence of the blocks.
program test_body_fill
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t
   use xmpm_geometry, only: geometry_t, add_primitive, exact_volume, inside
   use xmpm_body_fill, only: sub_lattice_t, fill_bins, count_in_bins, cell_range
   use testing, only: suite_t, check, check_close, finish
   implicit none
   type(suite_t) :: suite

   suite%name = 'body_fill'
   call test_boxes()
   call test_box_off_the_lattice()
   call test_slivers()
   call test_round_volumes()
   call test_differences()
   call test_mirror()
   call test_rotation()
   call test_translation()
   call test_blocks()
   call test_order()
   call test_touching_lattice()
   call test_speed()
   call finish(suite)

contains

   subroutine put(g, kind, values, subtract)
      type(geometry_t), intent(inout) :: g
      character(len=*), intent(in) :: kind
      real(wp), intent(in) :: values(:)
      logical, intent(in), optional :: subtract
      type(error_t), allocatable :: error

      call add_primitive(g, kind, values, present(subtract), error)
      if (allocated(error)) call check(suite, error%message, .false.)
   end subroutine put

   function body(kind, values) result(g)
      character(len=*), intent(in) :: kind
      real(wp), intent(in) :: values(:)
      type(geometry_t) :: g

      call put(g, kind, values)
   end function body

   function lattice_of(spacing, per_direction) result(lattice)
      real(wp), intent(in) :: spacing
      integer, intent(in) :: per_direction
      type(sub_lattice_t) :: lattice

      lattice%spacing = spacing
      lattice%per_direction = per_direction
   end function lattice_of

   !> All particles of a body, in one block.
   subroutine fill(g, lattice, x, volume)
      type(geometry_t), intent(in) :: g
      type(sub_lattice_t), intent(in) :: lattice
      real(wp), allocatable, intent(out) :: x(:, :), volume(:)
      integer :: low(3), high(3)

      call cell_range(g, lattice, low, high)
      call fill_bins(g, lattice, low, high, x, volume)
   end subroutine fill

   function volume_of(g, lattice) result(total)
      type(geometry_t), intent(in) :: g
      type(sub_lattice_t), intent(in) :: lattice
      real(wp) :: total
      real(wp), allocatable :: x(:, :), volume(:)

      call fill(g, lattice, x, volume)
      total = sum(volume)
   end function volume_of

   !> Largest difference of two sets of particles, each sought in the other.
   function distance_of_sets(x, volume, y, other) result(worst)
      real(wp), intent(in) :: x(:, :), volume(:), y(:, :), other(:)
      real(wp) :: worst, nearest
      integer :: i, j

      worst = merge(0.0_wp, huge(1.0_wp), size(volume) == size(other))
      if (size(volume) /= size(other)) return
      do i = 1, size(volume)
         nearest = huge(1.0_wp)
         do j = 1, size(other)
            if (abs(x(1, i) - y(1, j)) > nearest) cycle
            nearest = min(nearest, maxval(abs(x(:, i) - y(:, j))) + abs(volume(i) - other(j)))
         end do
         worst = max(worst, nearest)
      end do
   end function distance_of_sets

   subroutine test_boxes()
      type(geometry_t) :: g
      real(wp), allocatable :: x(:, :), volume(:)
      integer :: n

      g = body('box', [-2.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 2.0_wp, 2.0_wp])
      do n = 1, 4
         call fill(g, lattice_of(1.0_wp, n), x, volume)
         call check(suite, 'a box on the lattice has n**3 particles a cell', size(volume) == 8*n**3)
         call check(suite, 'each with the volume of a sub-cell', &
            all(abs(volume*real(n**3, wp) - 1.0_wp) < 1.0e-14_wp))   ! rounding
         call check(suite, 'and at its centre', &
            all(abs(real(n, wp)*x - 0.5_wp - anint(real(n, wp)*x - 0.5_wp)) < 1.0e-13_wp))
      end do
      call check(suite, 'a body of nothing has no particles', count_in_bins(geometry_t(), &
         lattice_of(1.0_wp, 2), [0, 0, 0], [3, 3, 3]) == 0)
      call fill_bins(g, lattice_of(1.0_wp, 2), [3, 0, 0], [2, 9, 9], x, volume)
      call check(suite, 'an empty box of cells has none either', size(volume) == 0)
   end subroutine test_boxes

   !> The parts of a box that ends between lattice planes are exact, and so are their centroids.
   subroutine test_box_off_the_lattice()
      type(geometry_t) :: g
      real(wp), allocatable :: x(:, :), volume(:)
      real(wp) :: values(6), centre(3)

      values = [-0.37_wp, 0.12_wp, -2.81_wp, 1.93_wp, 1.44_wp, 0.07_wp]
      g = body('box', values)
      call fill(g, lattice_of(0.5_wp, 2), x, volume)
      centre = matmul(x, volume)/sum(volume)
      ! only sums of some hundred rounded numbers
      call check_close(suite, 'volume of a box off the lattice', sum(volume), exact_volume(g), &
         0.0_wp, 1.0e-13_wp)
      call check(suite, 'centre of mass of a box off the lattice', &
         all(abs(centre - 0.5_wp*(values(1:3) + values(4:6))) < 1.0e-13_wp))
      call put(g, 'box', [1.0_wp, 0.5_wp, -1.0_wp, 1.5_wp, 2.0_wp, 3.0_wp], subtract=.true.)
      call check_close(suite, 'volume of a box with a notch', volume_of(g, lattice_of(0.5_wp, 2)), &
         exact_volume(body('box', values)) - 0.5_wp*0.94_wp*1.07_wp, 0.0_wp, 1.0e-13_wp)
      call put(g, 'box', [0.91_wp, 0.0_wp, -3.0_wp, 1.6_wp, 2.0_wp, 1.1_wp])
      call check_close(suite, 'volume of a box with a filled notch', &
         volume_of(g, lattice_of(0.5_wp, 2)), 2.3_wp*1.32_wp*2.88_wp + 0.69_wp*(2*4.1_wp &
         - 1.32_wp*2.88_wp), 0.0_wp, 1.0e-13_wp)
   end subroutine test_box_off_the_lattice

   !> Parts below 1 % of a sub-cell join their neighbours without loss.
   subroutine test_slivers()
      type(geometry_t) :: g
      real(wp), allocatable :: x(:, :), volume(:)

      g = body('box', [0.0_wp, 0.0_wp, 0.0_wp, 2.004_wp, 2.006_wp, 2.0_wp])
      call fill(g, lattice_of(1.0_wp, 1), x, volume)
      call check(suite, 'slivers are no particles', size(volume) == 8)
      call check_close(suite, 'slivers keep their volume', sum(volume), exact_volume(g), &
         0.0_wp, 1.0e-14_wp)   ! rounding
      call check(suite, 'and their moment', all(abs(matmul(x, volume)/sum(volume) - &
         [1.002_wp, 1.003_wp, 1.0_wp]) < 1.0e-13_wp))   ! rounding
      call check_close(suite, 'a layer of slivers goes to the layer below', maxval(x(1, :)), &
         1.502_wp, 0.0_wp, 1.0e-13_wp)   ! rounding
      g = body('box', [0.1_wp, 0.1_wp, 0.1_wp, 0.2_wp, 0.2_wp, 0.2_wp])
      call fill(g, lattice_of(1.0_wp, 1), x, volume)
      call check(suite, 'a body that is all sliver still has a particle', size(volume) == 1)
      ! rounding
      call check_close(suite, 'of its volume', volume(1), 1.0e-3_wp, 0.0_wp, 1.0e-13_wp)
   end subroutine test_slivers

   subroutine test_round_volumes()
      real(wp), parameter :: radii(4) = [1.03_wp, 2.0_wp, 3.37_wp, 5.11_wp]
      type(geometry_t) :: g
      integer :: i

      do i = 1, 4
         associate (r => radii(i))
            g = body('sphere', [0.13_wp, -0.21_wp, 0.48_wp, r])
            call compare('sphere', g)
            g = body('cylinder', [0.13_wp, -0.21_wp, 0.48_wp, 0.13_wp, -0.21_wp, 3.7_wp, r])
            call compare('cylinder along z', g)
            g = body('cylinder', [0.0_wp, 0.0_wp, 0.0_wp, 2.0_wp, 3.0_wp, 1.0_wp, r])
            call compare('oblique cylinder', g)
            g = body('tube', [0.0_wp, 0.0_wp, 0.0_wp, 4.0_wp, 0.0_wp, 0.0_wp, 0.7_wp*r, r])
            call compare('tube along x', g)
         end associate
      end do
   end subroutine test_round_volumes

   !> The parts of curved bodies are found by small leaves: 0.1 % is what is promised.
   subroutine compare(name, g)
      character(len=*), intent(in) :: name
      type(geometry_t), intent(in) :: g
      real(wp), allocatable :: x(:, :), volume(:)

      call fill(g, lattice_of(1.0_wp, 2), x, volume)
      call check_close(suite, 'volume of a '//name, sum(volume), exact_volume(g), 0.0_wp, 1.0e-3_wp)
      ! bounds are those of the shape: their middle is its centre; 1e-3 as for the volume
      call check(suite, 'centre of mass of a '//name, all(abs(matmul(x, volume)/sum(volume) - &
         0.5_wp*(g%low + g%high)) < 1.0e-3_wp*maxval(g%high - g%low)))
      call check(suite, 'no part of a '//name//' exceeds its sub-cell and its slivers', &
         all(volume <= 1.1_wp*0.125_wp) .and. all(volume > 0.0_wp))
   end subroutine compare

   subroutine test_differences()
      type(geometry_t) :: g
      real(wp) :: whole

      g = body('box', [-2.0_wp, -2.0_wp, -0.5_wp, 2.0_wp, 2.0_wp, 0.5_wp])
      call put(g, 'cylinder', [0.1_wp, 0.2_wp, -1.0_wp, 0.1_wp, 0.2_wp, 1.0_wp, 0.8_wp], &
         subtract=.true.)
      call check_close(suite, 'volume of a plate with a hole', &
         volume_of(g, lattice_of(0.5_wp, 2)), &
         16.0_wp - pi*0.64_wp, 0.0_wp, 1.0e-3_wp)   ! as promised for curved cuts
      g = body('tube', [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 3.0_wp, 1.1_wp, 1.9_wp])
      call put(g, 'cylinder', [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 3.0_wp, 1.1_wp])
      whole = exact_volume(body('cylinder', [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 3.0_wp, &
         1.9_wp]))
      call check_close(suite, 'a tube and its core leave no gap', &
         volume_of(g, lattice_of(0.5_wp, 2)), &
         whole, 0.0_wp, 1.0e-3_wp)   ! as promised for curved cuts
      g = body('sphere', [0.0_wp, 0.0_wp, 0.0_wp, 2.0_wp])
      call put(g, 'sphere', [1.0_wp, 0.0_wp, 0.0_wp, 2.0_wp])
      ! lens of two spheres of radius r at distance d: pi (4 r + d) (2 r - d)**2 / 12
      call check_close(suite, 'two spheres that overlap', volume_of(g, lattice_of(0.5_wp, 2)), &
         64*pi/3 - pi*9*9/12, 0.0_wp, 1.0e-3_wp)   ! as promised for curved cuts
   end subroutine test_differences

   !> A lopsided body on a lattice through the origin.
   function lopsided(turn) result(g)
      integer, intent(in) :: turn   !! 0: as it is, 1: mirrored in x, 2: turned about z
      type(geometry_t) :: g

      call put(g, 'box', moved(turn, [-1.3_wp, -0.9_wp, -0.505_wp, 1.17_wp, 0.75_wp, 0.495_wp]))
      call put(g, 'sphere', moved(turn, [0.9_wp, 0.3_wp, 0.2_wp, 0.83_wp]))
      call put(g, 'cylinder', moved(turn, [-0.7_wp, -0.2_wp, -2.0_wp, -0.4_wp, 0.1_wp, 2.0_wp, &
         0.31_wp]), &
         subtract=.true.)
   end function lopsided

   pure function moved(turn, values) result(new)
      integer, intent(in) :: turn
      real(wp), intent(in) :: values(:)
      real(wp) :: new(size(values))

      new = values
      if (turn == 0) return
      new(1:3) = moved_point(turn, values(1:3))
      if (size(values) == 4) return
      new(4:6) = moved_point(turn, values(4:6))
      if (size(values) > 6) return
      new(1:3) = min(moved_point(turn, values(1:3)), moved_point(turn, values(4:6)))
      new(4:6) = max(moved_point(turn, values(1:3)), moved_point(turn, values(4:6)))
   end function moved

   pure function moved_point(turn, x) result(y)
      integer, intent(in) :: turn
      real(wp), intent(in) :: x(3)
      real(wp) :: y(3)

      y = [-x(1), x(2), x(3)]
      if (turn == 2) y = [-x(2), x(1), x(3)]
   end function moved_point

   subroutine test_mirror()
      real(wp), allocatable :: x(:, :), volume(:), y(:, :), other(:)

      call fill(lopsided(0), lattice_of(0.25_wp, 2), x, volume)
      call fill(lopsided(1), lattice_of(0.25_wp, 2), y, other)
      y(1, :) = -y(1, :)
      ! rounding of coordinates of size 1
      call check_close(suite, 'a mirrored body has mirrored particles', &
         distance_of_sets(x, volume, y, other), 0.0_wp, 1.0e-13_wp, 0.0_wp)
   end subroutine test_mirror

   subroutine test_rotation()
      real(wp), allocatable :: x(:, :), volume(:), y(:, :), other(:), z(:, :)
      integer :: i

      call fill(lopsided(0), lattice_of(0.25_wp, 2), x, volume)
      call fill(lopsided(2), lattice_of(0.25_wp, 2), y, other)
      z = x
      do i = 1, size(volume)
         z(:, i) = moved_point(2, x(:, i))
      end do
      ! rounding of coordinates of size 1
      call check_close(suite, 'a body turned by 90 degrees has turned particles', &
         distance_of_sets(z, volume, y, other), 0.0_wp, 1.0e-13_wp, 0.0_wp)
   end subroutine test_rotation

   subroutine test_translation()
      type(geometry_t) :: g
      real(wp), allocatable :: x(:, :), volume(:), y(:, :), other(:)
      type(sub_lattice_t) :: lattice

      lattice = lattice_of(0.25_wp, 3)
      g = body('tube', [0.1_wp, 0.2_wp, 0.3_wp, 0.8_wp, 0.9_wp, 0.0_wp, 0.4_wp, 0.77_wp])
      call fill(g, lattice, x, volume)
      g = body('tube', [7.1_wp, -4.8_wp, 0.55_wp, 7.8_wp, -4.1_wp, 0.25_wp, 0.4_wp, 0.77_wp])
      call fill(g, lattice, y, other)
      call check(suite, 'a body moved by whole cells has as many particles', &
         size(other) == size(volume))
      if (size(other) /= size(volume)) return
      ! rounding of coordinates of size 10, over a sub-cell
      call check(suite, 'and the same ones, moved', maxval(abs(y - x - &
         spread([7.0_wp, -5.0_wp, 0.25_wp], 2, size(volume)))) < 1.0e-12_wp .and. &
         maxval(abs(volume - other)) < 1.0e-14_wp)
      lattice%origin = [7.0_wp, -5.0_wp, 0.25_wp]
      call fill(g, lattice, y, other)
      call check(suite, 'the lattice may move with it', size(other) == size(volume) .and. &
         abs(sum(other) - sum(volume)) < 1.0e-12_wp)   ! rounding, as before
   end subroutine test_translation

   !> Blocks of any size give bit for bit the same particles.
   subroutine test_blocks()
      type(geometry_t) :: g
      type(sub_lattice_t) :: lattice
      real(wp), allocatable :: x(:, :), volume(:), y(:, :), other(:)
      integer :: low(3), high(3), i, j, k, n, found

      g = lopsided(0)
      lattice = lattice_of(0.25_wp, 2)
      call fill(g, lattice, x, volume)
      call cell_range(g, lattice, low, high)
      n = 0
      found = 0
      do k = low(3), high(3), 3
         do j = low(2), high(2), 4
            do i = low(1), high(1), 2
               call fill_bins(g, lattice, [i, j, k], min([i + 1, j + 3, k + 2], high), y, other)
               call check(suite, 'the count of a block is that of its particles', size(other) == &
                  count_in_bins(g, lattice, [i, j, k], min([i + 1, j + 3, k + 2], high)))
               n = n + size(other)
               found = found + count_same(x, volume, y, other)
            end do
         end do
      end do
      call check(suite, 'blocks hold as many particles as the whole', n == size(volume))
      call check(suite, 'and the very same ones', found == n)
   end subroutine test_blocks

   !> How many particles of a block stand bit for bit in the whole.
   function count_same(x, volume, y, other) result(found)
      real(wp), intent(in) :: x(:, :), volume(:), y(:, :), other(:)
      integer :: found, i

      found = 0
      do i = 1, size(other)
         found = found + count(.not. (abs(x(1, :) - y(1, i)) > 0.0_wp .or. &
            abs(x(2, :) - y(2, i)) > 0.0_wp .or. abs(x(3, :) - y(3, i)) > 0.0_wp .or. &
            abs(volume - other(i)) > 0.0_wp))
      end do
   end function count_same

   subroutine test_order()
      real(wp), allocatable :: x(:, :), volume(:)
      type(geometry_t) :: g

      g = body('box', [0.0_wp, 0.0_wp, 0.0_wp, 2.0_wp, 1.0_wp, 1.0_wp])
      call fill(g, lattice_of(1.0_wp, 2), x, volume)
      call check(suite, 'particles come cell by cell, x fastest', &
         all(x(1, :8) < 1.0_wp) .and. all(x(1, 9:) > 1.0_wp) .and. x(1, 2) > x(1, 1) .and. &
         x(2, 3) > x(2, 2) .and. x(3, 5) > x(3, 4))
   end subroutine test_order

   !> Faces beside a lattice plane by rounding cut nothing.
   subroutine test_touching_lattice()
      type(geometry_t) :: g
      real(wp), allocatable :: x(:, :), volume(:)
      real(wp), parameter :: off = 3.0e-10_wp
      integer :: low(3), high(3)

      g = body('box', [off, -off, off, 1.0_wp + off, 1.0_wp - off, 1.0_wp])
      call fill_bins(g, lattice_of(0.5_wp, 2), [-1, -1, -1], [2, 2, 2], x, volume)
      call check(suite, 'rounding of a face makes no particle', size(volume) == 64)
      call check(suite, 'and moves none', all(abs(8*x - anint(8*x)) < 1.0e-14_wp))
      call cell_range(g, lattice_of(0.5_wp, 2), low, high)
      call check(suite, 'nor does it touch a cell', all(low == 0) .and. all(high == 1))
      call check(suite, 'particles lie inside', all([inside(g, x(:, 1)), inside(g, x(:, 64))]))
   end subroutine test_touching_lattice

   !> A million particles of a box in blocks of 4x4x4 cells; about 0.05 s when optimised.
   subroutine test_speed()
      type(geometry_t) :: g
      real(wp), allocatable :: x(:, :), volume(:)
      real(wp) :: start, end
      integer :: i, j, k, n

      g = body('box', [0.1_wp, 0.1_wp, 0.1_wp, 49.9_wp, 49.9_wp, 49.9_wp])
      n = 0
      call cpu_time(start)
      do k = 0, 48, 4
         do j = 0, 48, 4
            do i = 0, 48, 4
               call fill_bins(g, lattice_of(1.0_wp, 2), [i, j, k], [i, j, k] + 3, x, volume)
               n = n + size(volume)
            end do
         end do
      end do
      call cpu_time(end)
      call check(suite, 'a box of a million particles is complete', n == 1000000)
      ! unoptimised code with all run-time checks on a shared machine; only a blow-up shall fail
      call check(suite, 'and is not slow', end - start < 20.0_wp)
      print '(a,f8.3,a)', 'a million particles of a box: ', end - start, ' s'
   end subroutine test_speed
end program test_body_fill
