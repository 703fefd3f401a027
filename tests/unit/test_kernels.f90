!> The kernels against a plain scalar evaluation of their shape functions, node by node.
program test_kernels
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use xmpm_kinds, only: wp
   use xmpm_text, only: to_text
   use xmpm_lattice, only: lattice_t, make_lattice, tile_base, stencil_offsets, linear_shape, &
      gimp_shape
   use xmpm_frame, only: frame_t
   use xmpm_kernels, only: kernels_t, choose_kernels, tile_nodes
   use xmpm_linear_kernels, only: weights_linear
   use xmpm_gimp_kernels, only: weights_gimp
   use testing, only: suite_t, check_close, finish
   implicit none

   type(suite_t) :: suite
   integer, parameter :: n_worst = 10
   real(wp) :: worst(n_worst), half
   integer :: trial, k, n

   suite%name = 'kernels'
   call random_seed(size=n)
   call random_seed(put=[(1234 + k, k=1, n)])

   worst = 0
   do trial = 1, 400
      call try_chunk(linear_shape, 0.25_wp, mod(trial, 4), worst)
   end do
   call report('linear', worst)
   do k = 1, 4
      half = 0.5_wp/real(k, wp)
      worst = 0
      do trial = 1, 400
         call try_chunk(gimp_shape, half, mod(trial, 4), worst)
      end do
      call report('GIMP of '//to_text(k)//' a cell', worst)
   end do
   call finish(suite)

contains

   !> One chunk at random in a random bin of a random lattice; `worst` takes the relative errors.
   subroutine try_chunk(shape, half, faces, worst)
      integer, intent(in) :: shape
      real(wp), intent(in) :: half              !! half a particle's width [cells]
      integer, intent(in) :: faces              !! coordinates that are put on a face or a kink
      real(wp), intent(inout) :: worst(n_worst)
      type(lattice_t) :: lattice
      type(frame_t) :: frame
      real(wp) :: q(8, 14), w(27, 8), d(27, 8, 3), u(3)
      integer :: offsets(27), base(64), reach, count

      call random_number(u)
      lattice = make_lattice(0.1_wp + u(1), [u(2), u(3), 0.5_wp], shape)
      reach = lattice%reach**3
      base = tile_base(lattice)
      offsets(:reach) = stencil_offsets(lattice)
      call random_number(u)
      frame%corner = 10*u - 5
      frame%per_size = 1/lattice%size
      frame%half = half
      frame%base = base(1 + int(63.9_wp*u(1)))
      count = 1 + int(7.99_wp*u(2))
      call fill_chunk(frame, lattice%size, half, faces, count, q)
      call weigh_plainly(lattice, frame, q, w, d)
      call compare_scatter(shape, frame, q, count, reach, offsets(:reach), w, d, worst)
      call compare_gather(shape, frame, q, count, reach, offsets(:reach), w, d, worst)
      call try_linear_field(lattice, frame, q, count, reach, offsets(:reach), worst)
      call compare_weights(lattice, frame, q, count, reach, w, worst)
   end subroutine try_chunk

   !> Random particles in the first lanes, the others empty at the bin's middle.
   subroutine fill_chunk(frame, size, half, faces, count, q)
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: size, half
      integer, intent(in) :: faces, count
      real(wp), intent(out) :: q(8, 14)
      real(wp) :: kinks(4)
      integer :: i

      call random_number(q)
      kinks = [0.0_wp, 1.0_wp, half, 1 - half]
      do i = 1, faces
         q(1:4, i) = kinks
         if (i > 1) q(1:4, i) = cshift(kinks, i)
      end do
      do i = 1, 3
         q(count + 1:, i) = 0.5_wp
         q(:, i) = frame%corner(i) + size*q(:, i)
      end do
      q(:, 4:6) = 2*q(:, 4:6) - 1
      q(:, 9:14) = 2*q(:, 9:14) - 1
      q(count + 1:, 4:) = 0
   end subroutine fill_chunk

   !> Weights and gradients [1/length] of each stencil node from the definition.
   subroutine weigh_plainly(lattice, frame, q, w, d)
      type(lattice_t), intent(in) :: lattice
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: q(8, 14)
      real(wp), intent(out) :: w(27, 8), d(27, 8, 3)
      real(wp) :: s(3), f(3), g(3)
      integer :: p, i, a(3), node, r

      r = lattice%reach
      do p = 1, 8
         do node = 1, r**3
            a = [mod(node - 1, r), mod((node - 1)/r, r), (node - 1)/r**2]
            do i = 1, 3
               s(i) = (q(p, i) - place_of_node(lattice, frame, i, a(i)))/lattice%size
               if (lattice%shape == linear_shape) then
                  f(i) = hat(s(i))
                  g(i) = merge(-1.0_wp, 1.0_wp, a(i) == 0)
               else
                  f(i) = (area(s(i) + frame%half) - area(s(i) - frame%half))/(2*frame%half)
                  g(i) = (hat(s(i) + frame%half) - hat(s(i) - frame%half))/(2*frame%half)
               end if
            end do
            w(node, p) = product(f)
            d(node, p, :) = [g(1)*f(2)*f(3), f(1)*g(2)*f(3), f(1)*f(2)*g(3)]/lattice%size
         end do
      end do
   end subroutine weigh_plainly

   !> Coordinate of a stencil node, numbered from 0 in its direction.
   pure function place_of_node(lattice, frame, direction, number) result(x)
      type(lattice_t), intent(in) :: lattice
      type(frame_t), intent(in) :: frame
      integer, intent(in) :: direction, number
      real(wp) :: x

      x = frame%corner(direction) + lattice%size*real(number, wp)
      if (lattice%shape == gimp_shape) x = x - 0.5_wp*lattice%size
   end function place_of_node

   elemental function hat(s) result(value)
      real(wp), intent(in) :: s
      real(wp) :: value

      value = max(0.0_wp, 1 - abs(s))
   end function hat

   !> Integral of the hat from minus infinity to s.
   elemental function area(s) result(value)
      real(wp), intent(in) :: s
      real(wp) :: value, c

      c = min(max(s, -1.0_wp), 1.0_wp)
      value = merge(0.5_wp*(1 + c)**2, 1 - 0.5_wp*(1 - c)**2, c < 0)
   end function area

   !> P2G of mass, momentum, force and of a vector, and nothing outside the stencil.
   subroutine compare_scatter(shape, frame, q, count, reach, offsets, w, d, worst)
      integer, intent(in) :: shape, count, reach, offsets(:)
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: q(8, 14), w(27, 8), d(27, 8, 3)
      real(wp), intent(inout) :: worst(:)
      type(kernels_t) :: kernels
      real(wp) :: tile(8, tile_nodes), push(4, tile_nodes), plain(7, tile_nodes), f(3), forces
      integer :: node, p, at

      kernels = choose_kernels(shape)
      tile = 0
      push = 0
      plain = 0
      forces = 0
      call kernels%scatter(count, q, frame, tile)
      call kernels%push(count, q, q(:, 4:6), frame, push)
      do node = 1, reach
         at = frame%base + offsets(node)
         do p = 1, count
            f = -q(p, 8)*matmul(stress_of(q(p, 9:14)), d(node, p, :))
            plain(1, at) = plain(1, at) + w(node, p)*q(p, 7)
            plain(2:4, at) = plain(2:4, at) + w(node, p)*q(p, 7)*q(p, 4:6)
            plain(5:7, at) = plain(5:7, at) + f
            forces = max(forces, q(p, 8)*frame%per_size)
         end do
      end do
      call keep_worst(worst(1), maxval(abs(tile(1:4, :) - plain(1:4, :))))
      call keep_worst(worst(2), maxval(abs(tile(5:7, :) - plain(5:7, :)))/forces)
      call keep_worst(worst(3), maxval(abs(sum(tile(5:7, :), 2)))/forces)
      plain(1:3, :) = 0
      do node = 1, reach
         do p = 1, count
            at = frame%base + offsets(node)
            plain(1:3, at) = plain(1:3, at) + w(node, p)*q(p, 4:6)
         end do
      end do
      call keep_worst(worst(4), maxval(abs(push(1:3, :) - plain(1:3, :))))
   end subroutine compare_scatter

   pure function stress_of(s) result(tensor)
      real(wp), intent(in) :: s(6)
      real(wp) :: tensor(3, 3)

      tensor = reshape([s(1), s(4), s(6), s(4), s(2), s(5), s(6), s(5), s(3)], [3, 3])
   end function stress_of

   !> G2P of random fields, and that it is the transpose of P2G.
   subroutine compare_gather(shape, frame, q, count, reach, offsets, w, d, worst)
      integer, intent(in) :: shape, count, reach, offsets(:)
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: q(8, 14), w(27, 8), d(27, 8, 3)
      real(wp), intent(inout) :: worst(:)
      type(kernels_t) :: kernels
      real(wp) :: tile(8, tile_nodes), push(4, tile_nodes), value(8, 3), moved(8, 3), gradient(8, 9)
      real(wp) :: v(3), g(3, 3), there(8, 3)
      integer :: p, i, node

      kernels = choose_kernels(shape)
      call random_number(tile)
      call random_number(there)
      call kernels%gather(q, frame, tile, 5, value)
      call kernels%gradient(q, frame, tile, gradient, moved)
      do p = 1, count
         v = 0
         g = 0
         do node = 1, reach
            v = v + w(node, p)*tile(5:7, frame%base + offsets(node))
            do i = 1, 3
               g(i, :) = g(i, :) + tile(4 + i, frame%base + offsets(node))*d(node, p, :)
            end do
         end do
         call keep_worst(worst(5), maxval(abs(value(p, :) - v)))
         call keep_worst(worst(6), maxval(abs(gradient(p, :) - reshape(transpose(g), [9]))) &
            /frame%per_size)
      end do
      push = 0
      call kernels%push(count, q, there, frame, push)
      call keep_worst(worst(7), abs(sum(push(1:3, :)*tile(5:7, :)) &
         - sum(there(:count, :)*value(:count, :))))
   end subroutine compare_gather

   !> A velocity that is linear in space comes back as it is, value and gradient; the constant part
   !> alone is the partition of unity.
   subroutine try_linear_field(lattice, frame, q, count, reach, offsets, worst)
      type(lattice_t), intent(in) :: lattice
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: q(8, 14)
      integer, intent(in) :: count, reach, offsets(:)
      real(wp), intent(inout) :: worst(:)
      type(kernels_t) :: kernels
      real(wp) :: tile(8, tile_nodes), gradient(8, 9), value(8, 3), a(3, 3), b(3), x(3), exact(9)
      integer :: p, node, r, i, n(3)

      kernels = choose_kernels(lattice%shape)
      call random_number(a)
      call random_number(b)
      r = lattice%reach
      tile = huge(1.0_wp)
      do node = 1, reach
         n = [mod(node - 1, r), mod((node - 1)/r, r), (node - 1)/r**2]
         x = [(place_of_node(lattice, frame, i, n(i)), i=1, 3)]
         tile(:, frame%base + offsets(node)) = 0
         tile(2:4, frame%base + offsets(node)) = matmul(a, x - frame%corner) + b
         tile(5:7, frame%base + offsets(node)) = matmul(a, x - frame%corner) + b
      end do
      call kernels%gradient(q, frame, tile, gradient, value)
      exact = reshape(transpose(a), [9])
      do p = 1, count
         x = q(p, 1:3) - frame%corner
         call keep_worst(worst(8), maxval(abs(value(p, :) - (matmul(a, x) + b))))
         call keep_worst(worst(9), maxval(abs(gradient(p, :) - exact))*lattice%size)
      end do
   end subroutine try_linear_field

   !> The weights at a point that probes and cracks use are those of the kernels.
   subroutine compare_weights(lattice, frame, q, count, reach, w, worst)
      type(lattice_t), intent(in) :: lattice
      type(frame_t), intent(in) :: frame
      real(wp), intent(in) :: q(8, 14), w(27, 8)
      integer, intent(in) :: count, reach
      real(wp), intent(inout) :: worst(:)
      real(wp) :: t(3), here(27)
      integer :: p

      here = 0
      do p = 1, count
         t = (q(p, 1:3) - frame%corner)*frame%per_size
         if (lattice%shape == linear_shape) then
            here(:8) = weights_linear(t)
         else
            here = weights_gimp(t - 0.5_wp, frame%half)
         end if
         call keep_worst(worst(10), maxval(abs(here(:reach) - w(:reach, p))) &
            + abs(sum(here(:reach)) - 1))
      end do
   end subroutine compare_weights

   !> The larger of two errors; what is no number stays.
   subroutine keep_worst(worst, error)
      real(wp), intent(inout) :: worst
      real(wp), intent(in) :: error

      if (.not. (error <= worst .or. ieee_is_nan(worst))) worst = error
   end subroutine keep_worst

   !> Every error against rounding: places are known to about 10 eps of |x|/h <= 50 cells, values
   !> are of order one and sums have at most 8 x 27 terms. A wrong weight is off by 1e-3 and more.
   subroutine report(kind, worst)
      character(len=*), intent(in) :: kind
      real(wp), intent(in) :: worst(n_worst)
      real(wp), parameter :: rounding = 1e-12_wp
      character(len=60) :: sentence(n_worst)
      integer :: i

      sentence = [character(len=60) :: 'mass and momentum come to the nodes by the weights', &
         'forces come to the nodes by the gradients', 'gradients of the nodes add up to zero', &
         'a vector comes to the nodes by the weights', &
         'a field comes to the particles by the weights', &
         'gradients of a field are the sum over the nodes', &
         'P2G and G2P are transposes of each other', 'a linear velocity is reproduced', &
         'the gradient of a linear velocity is reproduced', &
         'weights at a point are those of the kernels']
      do i = 1, n_worst
         call check_close(suite, kind//': '//trim(sentence(i)), worst(i), 0.0_wp, rounding, 0.0_wp)
      end do
   end subroutine report
end program test_kernels
