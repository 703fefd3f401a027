!> The rows of split nodes are the enriched nodes of 10.1002/nme.6653 in other variables: with plain
!> sums m, p, f and starred sums m*, p*, f* (each particle times its H) the sides carry (m + m*)/2
!> and (m - m*)/2, so that p/m of a side is (p + H p*)/(m + H m*).
! ranks: 1 2 3
program test_rows
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel, max_all, sum_all
   use xmpm_halo, only: start_sum, finish_sum
   use xmpm_deck, only: deck_t
   use xmpm_lattice, only: bin_corner, bins_per_block, stencil_offsets, linear_shape
   use xmpm_grid, only: node_position
   use xmpm_storage, only: bin_of_chunk, c_x, c_v, c_m, c_vol, c_s, n_near, near_crack, near_jump, &
      near_slope
   use xmpm_frame, only: frame_t
   use xmpm_loads, only: rows_of_bin
   use xmpm_sided_transfer, only: gradient_sided
   use xmpm_balance, only: momenta
   use xmpm_stages, only: map_to_grid, advance_nodes, map_to_particles
   use xmpm_model, only: model_t
   use small_model, only: make_model, seed
   use testing, only: suite_t, check, check_close, check_no_error, finish
   implicit none
   character(len=*), parameter :: base = '*JOB rows|*UNITS length=mm mass=g time=ms|*TIME end=1|' &
      //'*MATERIAL alloy density=2 young=100 poisson=0.25|' &
      //'*BODY a material=alloy box=0.3 0.2 0.1 7.3 5.2 5.1 particles=3|' &
      //'*CRACK c rectangle centre=-1 2.7 1.77 along=1 0 0.2 across=0 1 0 width=10 depth=12 front='
   real(wp), parameter :: along(3) = [1.0_wp, 0.0_wp, 0.2_wp]/sqrt(1.04_wp)
   real(wp), parameter :: normal(3) = [-0.2_wp, 0.0_wp, 1.0_wp]/sqrt(1.04_wp)
   real(wp), parameter :: centre(3) = [-1.0_wp, 2.7_wp, 1.77_wp]
   real(wp), parameter :: rounding = 1e-13_wp   !! sums of hundreds of terms over their magnitude
   character(len=6), parameter :: rules(4) = ['cut   ', 'full  ', 'node  ', 'graded']
   character(len=6), parameter :: shapes(2) = ['linear', 'gimp  ']
   type(comm_t) :: comm
   type(suite_t) :: suite
   integer :: i, k

   call start_parallel(comm)
   suite%name = 'rows'
   do k = 1, 2
      do i = 1, 4
         call test_rule(trim(shapes(k)), trim(rules(i)))
      end do
   end do
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   subroutine test_rule(shape, rule)
      character(len=*), intent(in) :: shape, rule
      type(model_t) :: m
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      real(wp), allocatable :: plain(:, :)
      real(wp) :: split
      character(len=:), allocatable :: head

      head = shape//', '//rule//': '
      call make_model(comm, base//rule//'|*GRID size=1 shape='//shape//'|', deck, m, error)
      call check_no_error(suite, head//'the deck is set up', error)
      if (allocated(error)) return
      split = real(count(m%grid%mine(m%grid%n_plain + 1:m%grid%n_rows)), wp)
      call sum_all(comm, split)
      call check(suite, head//'nodes are split', split > 20)
      call check_jump(m, head, rule == 'graded')
      call randomise(m)
      call map_to_grid(m)
      call sum_plainly(m, plain)
      call check_rows(m, head, plain)
      call check_particles(m, head)
      call check_gradient(m, head, rule == 'graded')
   end subroutine test_rule

   !> Random masses, volumes, velocities and stresses; places stay, as level sets belong to them.
   subroutine randomise(m)
      type(model_t), intent(inout) :: m
      real(wp) :: u(14)
      integer :: c, k

      call seed(77 + comm%rank)
      do c = 1, m%particles%n_chunks
         do k = 1, m%particles%count(c)
            call random_number(u)
            m%particles%q(k, c_v:c_v + 2, c) = 2*u(c_v:c_v + 2) - 1
            m%particles%q(k, c_s:c_s + 5, c) = 2*u(c_s:c_s + 5) - 1
            m%particles%q(k, c_m:c_vol, c) = 0.2_wp + u(c_m:c_vol)
         end do
      end do
   end subroutine randomise

   !> H and its gradient as the particle holds them; 0 far from the crack.
   pure subroutine jump_of(m, k, c, h, slope)
      type(model_t), intent(in) :: m
      integer, intent(in) :: k, c   !! lane and chunk
      real(wp), intent(out) :: h, slope(3)

      h = 0
      slope = 0
      if (m%particles%attached(c) == 0) return
      associate (near => m%particles%near(k, :n_near, m%particles%attached(c)))
         if (nint(near(near_crack)) /= 1) return
         h = near(near_jump)
         slope = near(near_slope:near_slope + 2)
      end associate
   end subroutine jump_of

   !> H and its gradient follow from the plane and its straight front.
   subroutine check_jump(m, head, graded)
      type(model_t), intent(in) :: m
      character(len=*), intent(in) :: head
      logical, intent(in) :: graded
      real(wp) :: h, slope(3), x(3), phi, exact, exact_slope(3), worst(2)
      integer :: c, k

      worst = 0
      do c = 1, m%particles%n_chunks
         do k = 1, m%particles%count(c)
            x = m%particles%q(k, c_x:c_x + 2, c) - centre
            ! Particles within a cell of the plane and behind or just ahead of the front.
            phi = dot_product(x, along) - 5
            if (abs(dot_product(x, normal)) > 1 .or. phi > 1) cycle
            exact = sign(1.0_wp, dot_product(x, normal))
            exact_slope = 0
            if (graded .and. phi > -0.1_wp .and. phi < 0.4_wp) exact_slope = -exact/0.5_wp*along
            if (graded) exact = exact*min(1.0_wp, max(0.0_wp, (0.4_wp - phi)/0.5_wp))
            call jump_of(m, k, c, h, slope)
            call keep_worst(worst(1), abs(h - exact))
            call keep_worst(worst(2), maxval(abs(slope - exact_slope)))
         end do
      end do
      call max_all(comm, worst)
      call hold(head//'H is that of a plane with a straight front', worst(1), rounding)
      call hold(head//'the gradient of H is that of a straight front', worst(2), rounding)
   end subroutine check_jump

   !> Plain sums in 1:7 and starred ones in 8:14 of each ordinary row: mass, momentum, force.
   subroutine sum_plainly(m, plain)
      type(model_t), intent(inout) :: m
      real(wp), allocatable, intent(out) :: plain(:, :)
      integer :: offsets(m%grid%lattice%reach**3), rows(m%grid%lattice%reach**3), c, k, i
      real(wp) :: q(14), w, d(3), h, slope(3), s(3, 3)

      allocate (plain(14, m%grid%n_rows), source=0.0_wp)
      offsets = stencil_offsets(m%grid%lattice)
      do c = 1, m%particles%n_chunks
         if (m%particles%count(c) == 0) cycle
         rows = rows_of_bin(m%grid, m%particles%bin(c), offsets)
         do k = 1, m%particles%count(c)
            q = m%particles%q(k, :, c)
            s = reshape(q([9, 12, 14, 12, 10, 13, 14, 13, 11]), [3, 3])
            call jump_of(m, k, c, h, slope)
            do i = 1, size(rows)
               call weigh(m, rows(i), q(:3), w, d)
               plain(1:4, rows(i)) = plain(1:4, rows(i)) + w*q(7)*[1.0_wp, q(4:6)]
               plain(5:7, rows(i)) = plain(5:7, rows(i)) - q(8)*matmul(s, d)
               plain(8:11, rows(i)) = plain(8:11, rows(i)) + h*w*q(7)*[1.0_wp, q(4:6)]
               plain(12:14, rows(i)) = plain(12:14, rows(i)) - q(8)*matmul(s, h*d + w*slope)
            end do
         end do
      end do
      call start_sum(m%halo, comm, plain, 1, 14)
      call finish_sum(m%halo, plain, 1, 14)
   end subroutine sum_plainly

   !> Weight of a node and its gradient from the definition.
   pure subroutine weigh(m, row, x, w, d)
      type(model_t), intent(in) :: m
      integer, intent(in) :: row
      real(wp), intent(in) :: x(3)
      real(wp), intent(out) :: w, d(3)
      real(wp) :: s(3), f(3), g(3), l

      s = (x - node_position(m%grid, row))/m%grid%lattice%size
      if (m%grid%lattice%shape == linear_shape) then
         f = hat(s)
         g = merge(-1.0_wp, 1.0_wp, s > 0)
      else
         l = m%bodies%half(1)
         f = (area(s + l) - area(s - l))/(2*l)
         g = (hat(s + l) - hat(s - l))/(2*l)
      end if
      w = product(f)
      d = [g(1)*f(2)*f(3), f(1)*g(2)*f(3), f(1)*f(2)*g(3)]/m%grid%lattice%size
   end subroutine weigh

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

   !> Row of the plus side of each ordinary row, 0 where the node is not split.
   pure function plus_rows(m) result(plus)
      type(model_t), intent(in) :: m
      integer :: plus(m%grid%n_plain), i

      plus = 0
      do i = m%grid%n_plain + 1, m%grid%n_rows
         plus(m%grid%parent(i - m%grid%n_plain)) = i
      end do
   end function plus_rows

   !> Rows against the sums. A side's mass is known to eps m, so its velocity and acceleration only
   !> to eps m/m_side.
   subroutine check_rows(m, head, plain)
      type(model_t), intent(in) :: m
      character(len=*), intent(in) :: head
      real(wp), intent(in) :: plain(:, :)
      real(wp) :: worst(5), m_side, side(7)
      integer :: plus(m%grid%n_plain), i, k, row

      plus = plus_rows(m)
      worst = 0
      do i = 1, m%grid%n_plain
         if (.not. plain(1, i) > 0) cycle
         if (plus(i) == 0) then
            call keep_worst(worst(1), maxval(abs(m%grid%node(:7, i) - plain(:7, i)))/plain(1, i))
            cycle
         end if
         call keep_worst(worst(2), maxval(abs(m%grid%node(:7, i) + m%grid%node(:7, plus(i)) &
            - plain(:7, i))))
         do k = -1, 1, 2
            row = merge(plus(i), i, k > 0)
            side = plain(:7, i) + real(k, wp)*plain(8:14, i)
            m_side = 0.5_wp*side(1)
            call keep_worst(worst(3), abs(m%grid%node(1, row) - m_side)/plain(1, i))
            if (.not. m_side > 1e-9_wp*plain(1, i)) cycle
            call keep_worst(worst(4), maxval(abs(m%grid%node(2:4, row)/m%grid%node(1, row) &
               - side(2:4)/side(1)))*m_side/plain(1, i))
            call keep_worst(worst(5), maxval(abs(m%grid%node(5:7, row)/m%grid%node(1, row) &
               - side(5:7)/side(1)))*m_side)
         end do
      end do
      call max_all(comm, worst)
      ! Forces of nodes with little mass are not small with it: their magnitude is about one.
      call hold(head//'ordinary rows are the plain sums', worst(1), 1e-11_wp)
      call hold(head//'sides add up to the plain sums', worst(2), 10*rounding)
      call hold(head//'a side has the mass (m + H m*)/2', worst(3), rounding)
      call hold(head//'a side moves with (p + H p*)/(m + H m*)', worst(4), rounding)
      call hold(head//'a side speeds up with (f + H f*)/(m + H m*)', worst(5), 10*rounding)
   end subroutine check_rows

   !> Particles take N (a + H a*), and the momentum stays.
   subroutine check_particles(m, head)
      type(model_t), intent(inout) :: m
      character(len=*), intent(in) :: head
      real(wp), allocatable :: before(:, :, :), change(:, :)
      real(wp) :: p0(3), p(3), l(3), h, slope(3), w, d(3), dv(3), worst(2)
      integer :: offsets(m%grid%lattice%reach**3), rows(m%grid%lattice%reach**3), c, k, i
      integer :: plus(m%grid%n_plain)

      call momenta(m, p0, l)
      m%dt = 0.01_wp
      call advance_nodes(m, m%dt)
      before = m%particles%q(:, c_v:c_v + 2, :m%particles%n_chunks)
      change = m%grid%node(5:7, :)
      call map_to_particles(m, remap=.true.)
      call momenta(m, p, l)
      plus = plus_rows(m)
      offsets = stencil_offsets(m%grid%lattice)
      worst = 0
      do c = 1, m%particles%n_chunks
         if (m%particles%count(c) == 0) cycle
         rows = rows_of_bin(m%grid, m%particles%bin(c), offsets)
         do k = 1, m%particles%count(c)
            call jump_of(m, k, c, h, slope)
            dv = 0
            do i = 1, size(rows)
               call weigh(m, rows(i), m%particles%q(k, :3, c), w, d)
               if (plus(rows(i)) == 0) then
                  dv = dv + w*change(:, rows(i))
               else
                  dv = dv + w*0.5_wp*((1 + h)*change(:, plus(rows(i))) + (1 - h)*change(:, rows(i)))
               end if
            end do
            call keep_worst(worst(1), maxval(abs(m%particles%q(k, c_v:c_v + 2, c) &
               - before(k, :, c) - dv))/(1 + maxval(abs(dv))))
         end do
      end do
      worst(2) = maxval(abs(p - p0))/real(m%n_particles, wp)
      call max_all(comm, worst)
      call hold(head//'particles take the change of their side', worst(1), rounding)
      call hold(head//'the linear momentum stays', worst(2), rounding)
   end subroutine check_particles

   !> With the velocity a on the plus rows and -a on the others, particles that reach split nodes
   !> only see H a with the gradient a grad H.
   subroutine check_gradient(m, head, graded)
      type(model_t), intent(inout) :: m
      character(len=*), intent(in) :: head
      logical, intent(in) :: graded
      real(wp), parameter :: a(3) = [0.3_wp, -0.7_wp, 1.1_wp]
      real(wp) :: gradient(8, 9), value(8, 3), h, slope(3), worst(2), seen(1)
      integer :: offsets(m%grid%lattice%reach**3), rows(m%grid%lattice%reach**3), c, k, b, s, i
      integer :: plus(m%grid%n_plain)
      type(frame_t) :: frame

      plus = plus_rows(m)
      offsets = stencil_offsets(m%grid%lattice)
      do i = 1, m%grid%n_rows
         m%grid%node(2:7, i) = merge(1.0_wp, -1.0_wp, i > m%grid%n_plain)*[a, a]
      end do
      worst = 0
      seen = 0
      do c = 1, m%particles%n_chunks
         if (m%particles%count(c) == 0) cycle
         rows = rows_of_bin(m%grid, m%particles%bin(c), offsets)
         b = 1 + (m%particles%bin(c) - 1)/bins_per_block
         s = m%sided%bin(1 + mod(m%particles%bin(c) - 1, bins_per_block), b)
         if (s == 0) then
            if (any(plus(rows) > 0)) error stop 'a bin of split nodes is not listed'
            cycle
         end if
         frame = frame_t(corner=bin_corner(m%grid%lattice, &
            bin_of_chunk(m%particles, m%grid%blocks, c)), half=m%bodies%half(1))
         call gradient_sided(m%particles, c, m%kernels, m%sided, s, offsets, frame, m%grid, &
            gradient, value)
         do k = 1, m%particles%count(c)
            if (any_reached(m, pack(rows, plus(rows) == 0), m%particles%q(k, :3, c))) cycle
            call jump_of(m, k, c, h, slope)
            if (.not. graded .or. norm2(slope) > 0) seen(1) = 1
            call keep_worst(worst(1), maxval(abs(value(k, :) - h*a)))
            call keep_worst(worst(2), maxval(abs(reshape(gradient(k, :), [3, 3]) &
               - spread(slope, 2, 3)*spread(a, 1, 3))))
         end do
      end do
      call max_all(comm, worst)
      call max_all(comm, seen)
      ! The sharp rules split the nodes of crossed cells only, which GIMP's stencil outreaches.
      if (graded .or. m%grid%lattice%shape == linear_shape) then
         call check(suite, head//'some particle sees split nodes only', seen(1) > 0)
      end if
      call hold(head//'a constant jump is H times it', worst(1), rounding)
      call hold(head//'the gradient of a constant jump is that of H', worst(2), rounding)
   end subroutine check_gradient

   !> Whether a particle has a weight or a slope at one of some nodes, but for rounding.
   pure function any_reached(m, rows, x) result(is)
      type(model_t), intent(in) :: m
      integer, intent(in) :: rows(:)
      real(wp), intent(in) :: x(3)
      logical :: is
      real(wp) :: w, d(3)
      integer :: i

      is = .false.
      do i = 1, size(rows)
         call weigh(m, rows(i), x, w, d)
         is = is .or. w > rounding .or. maxval(abs(d)) > rounding
      end do
   end function any_reached

   !> An error that must be within its tolerance.
   subroutine hold(sentence, error, tolerance)
      character(len=*), intent(in) :: sentence
      real(wp), intent(in) :: error, tolerance

      call check_close(suite, sentence, error, 0.0_wp, tolerance, 0.0_wp)
   end subroutine hold

   !> The larger of two errors; what is no number stays.
   subroutine keep_worst(worst, error)
      real(wp), intent(inout) :: worst
      real(wp), intent(in) :: error

      if (.not. (error <= worst .or. ieee_is_nan(worst))) worst = error
   end subroutine keep_worst
end program test_rows
