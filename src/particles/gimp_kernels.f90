!> Transfers between one chunk of particles and the tile of its block: uniform GIMP.
!>
!> t is the distance from the bin's middle node in cells, -1/2 to 1/2; half is half a particle's
!> width in cells. P2G keeps a node's values in vector lanes, G2P the 8 particles.
module xmpm_gimp_kernels
   use xmpm_kinds, only: wp
   use xmpm_frame, only: frame_t
   use xmpm_shuffle, only: turn
   implicit none
   private

   public :: scatter_gimp, push_gimp, gather_gimp, gradient_gimp, weights_gimp

   integer, parameter :: width = 6   !! nodes of a tile along one direction
   real(wp), parameter :: is_v(8) = real([1, 1, 1, 1, 0, 0, 0, 0], &
      wp)   !! mass and momentum of a node
   real(wp), parameter :: is_f(8) = 1 - is_v                           !! its force
   integer, parameter :: second(9) = [1, 2, 3, 1, 2, 3, 1, 2, 3]   !! y node of each line
   integer, parameter :: third(9) = [1, 1, 1, 2, 2, 2, 3, 3, 3]    !! z node of each line

contains

   !> Weights and slopes (per cell) of the three nodes in one direction: how far the particle
   !> reaches
   !> below and above the middle node, and what of that lies beyond its own width.
   elemental subroutine weigh(t, half, scale, w1, w2, w3, d1, d2, d3)
      real(wp), intent(in) :: t, half
      real(wp), intent(in) :: scale   !! 1/(2 half)
      real(wp), intent(out) :: w1, w2, w3, d1, d2, d3
      real(wp) :: below, above, low, high

      below = max(half - t, 0.0_wp)
      above = max(half + t, 0.0_wp)
      low = min(below, 2*half)
      high = min(above, 2*half)
      d1 = -low*scale
      d3 = high*scale
      d2 = -(d1 + d3)
      w1 = below - low - 0.5_wp*low*d1
      w3 = above - high + 0.5_wp*high*d3
      w2 = 1 - w1 - w3
   end subroutine weigh

   !> Weights and slopes of the lanes in all directions.
   pure subroutine weigh_lanes(q, frame, w, d)
      real(wp), intent(in) :: q(8, 14)
      type(frame_t), intent(in) :: frame
      real(wp), intent(out) :: w(8, 3, 3)   !! (lane, node, direction)
      real(wp), intent(out) :: d(8, 3, 3)   !! (lane, node, direction) [1/cell]
      real(wp) :: t, scale
      integer :: i, p

      scale = 0.5_wp/frame%half
      do i = 1, 3
         !$omp simd private(t)
         do p = 1, 8
            t = (q(p, i) - frame%corner(i))*frame%per_size - 0.5_wp
            call weigh(t, frame%half, scale, w(p, 1, i), w(p, 2, i), w(p, 3, i), d(p, 1, i), &
               d(p, 2, i), &
               d(p, 3, i))
         end do
      end do
   end subroutine weigh_lanes

   !> Add mass, momentum and internal force of a chunk (eq. 6, 7 and 23 of 10.1002/nme.6653).
   pure subroutine scatter_gimp(n, q, frame, tile)
      integer, intent(in) :: n                    !! particles in the chunk
      real(wp), intent(in) :: q(8, 14)            !! x v m vol s of the lanes
      type(frame_t), intent(in) :: frame          !! bin of the chunk
      real(wp), intent(inout) :: tile(8, *)     !! m, p, f of the tile's nodes
      real(wp) :: w(8, 3, 3), d(8, 3, 3), vx(8, 8), y(8, 8), z(8, 8)
      real(wp), dimension(8) :: w1, w2, w3, x1, x2, x3, xc, yc, zc
      real(wp) :: bb, cc, wb, db
      integer :: p, b, c, r, f

      call weigh_lanes(q, frame, w, d)
      call lay_out(q, frame%per_size, vx, y, z)
      do p = 1, n
         !$omp simd
         do f = 1, 8
            w1(f) = w(p, 1, 1)
            w2(f) = w(p, 2, 1)
            w3(f) = w(p, 3, 1)
            x1(f) = is_v(f)*w(p, 1, 1) + is_f(f)*d(p, 1, 1)
            x2(f) = is_v(f)*w(p, 2, 1) + is_f(f)*d(p, 2, 1)
            x3(f) = is_v(f)*w(p, 3, 1) + is_f(f)*d(p, 3, 1)
         end do
         do c = 1, 3
            !$omp simd
            do f = 1, 8
               xc(f) = w(p, c, 3)*vx(f, p)
               yc(f) = w(p, c, 3)*y(f, p)
               zc(f) = d(p, c, 3)*z(f, p)
            end do
            do b = 1, 3
               wb = w(p, b, 2)
               db = d(p, b, 2)
               r = frame%base + width*(b - 1 + width*(c - 1))
               !$omp simd private(bb, cc)
               do f = 1, 8
                  bb = wb*zc(f) + db*yc(f)
                  cc = wb*xc(f)
                  tile(f, r) = tile(f, r) + w1(f)*bb + x1(f)*cc
                  tile(f, r + 1) = tile(f, r + 1) + w2(f)*bb + x2(f)*cc
                  tile(f, r + 2) = tile(f, r + 2) + w3(f)*bb + x3(f)*cc
               end do
            end do
         end do
      end do
   end subroutine scatter_gimp

   !> What the particles give to a node, as (value,particle): m, m v and the force of the stress on
   !> planes across x; that on planes across y; that on planes across z.
   pure subroutine lay_out(q, per_size, vx, y, z)
      real(wp), intent(in) :: q(8, 14), per_size
      real(wp), intent(out) :: vx(8, 8)   !! 1:4 taken with the weight, 5:7 with the x slope
      real(wp), intent(out) :: y(8, 8)    !! 5:7 taken with the y slope
      real(wp), intent(out) :: z(8, 8)    !! 5:7 taken with the z slope
      real(wp) :: vol
      integer :: p

      !$omp simd private(vol)
      do p = 1, 8
         vol = -q(p, 8)*per_size
         vx(p, 1) = q(p, 7)
         vx(p, 2) = q(p, 7)*q(p, 4)
         vx(p, 3) = q(p, 7)*q(p, 5)
         vx(p, 4) = q(p, 7)*q(p, 6)
         vx(p, 5) = vol*q(p, 9)
         vx(p, 6) = vol*q(p, 12)
         vx(p, 7) = vol*q(p, 14)
         vx(p, 8) = 0
         y(p, 5) = vol*q(p, 12)
         y(p, 6) = vol*q(p, 10)
         y(p, 7) = vol*q(p, 13)
         y(p, 8) = 0
         z(p, 5) = vol*q(p, 14)
         z(p, 6) = vol*q(p, 13)
         z(p, 7) = vol*q(p, 11)
         z(p, 8) = 0
      end do
      do p = 1, 4
         y(:, p) = 0
         z(:, p) = 0
      end do
      call turn(vx)
      call turn(y)
      call turn(z)
   end subroutine lay_out

   !> Add a vector of each particle to the nodes with the shape function's weight.
   pure subroutine push_gimp(n, q, value, frame, tile)
      integer, intent(in) :: n                  !! particles in the chunk
      real(wp), intent(in) :: q(8, 14)          !! x v m vol s of the lanes
      real(wp), intent(in) :: value(8, 3)       !! vector of each lane
      type(frame_t), intent(in) :: frame          !! bin of the chunk
      real(wp), intent(inout) :: tile(4, *)   !! sums of the tile's nodes in 1:3
      real(wp) :: w(8, 3, 3), d(8, 3, 3), v(8, 8)
      integer :: p

      call weigh_lanes(q, frame, w, d)
      !$omp simd
      do p = 1, 8
         v(p, 1) = value(p, 1)
         v(p, 2) = value(p, 2)
         v(p, 3) = value(p, 3)
         v(p, 4) = 0
         v(p, 5) = value(p, 1)
         v(p, 6) = value(p, 2)
         v(p, 7) = value(p, 3)
         v(p, 8) = 0
      end do
      call turn(v)
      call push_pairs(n, w, v, frame%base, tile)
   end subroutine push_gimp

   !> Add a vector of each particle to its nodes: two neighbours in x at once, then the third.
   pure subroutine push_pairs(n, w, v, base, tile)
      integer, intent(in) :: n, base
      real(wp), intent(in) :: w(8, 3, 3)
      real(wp), intent(in) :: v(8, 8)            !! each particle's vector, twice
      real(wp), intent(inout) :: tile(*)         !! four sums a node
      real(wp) :: x(8), z(8), wbc
      integer :: p, b, c, r, f

      do p = 1, n
         !$omp simd
         do f = 1, 8
            x(f) = is_v(f)*w(p, 1, 1) + is_f(f)*w(p, 2, 1)
         end do
         do c = 1, 3
            do b = 1, 3
               wbc = w(p, b, 2)*w(p, c, 3)
               r = 4*(base - 1 + width*(b - 1 + width*(c - 1)))
               !$omp simd
               do f = 1, 8
                  z(f) = wbc*v(f, p)
                  tile(r + f) = tile(r + f) + x(f)*z(f)
               end do
               !$omp simd
               do f = 1, 4
                  tile(r + f + 8) = tile(r + f + 8) + w(p, 3, 1)*z(f)
               end do
            end do
         end do
      end do
   end subroutine push_pairs

   !> Interpolate three nodal fields to the lanes of a chunk.
   pure subroutine gather_gimp(q, frame, tile, field, value)
      real(wp), intent(in) :: q(8, 14)        !! x v m vol s of the lanes
      type(frame_t), intent(in) :: frame          !! bin of the chunk
      real(wp), intent(in) :: tile(8, *)    !! values of the tile's nodes
      integer, intent(in) :: field            !! first of the three fields
      real(wp), intent(out) :: value(8, 3)    !! at the particles
      real(wp) :: w(8, 3, 3), d(8, 3, 3), wyz(8, 9)
      integer :: m, p

      call weigh_lanes(q, frame, w, d)
      do m = 1, 9
         !$omp simd
         do p = 1, 8
            wyz(p, m) = w(p, second(m), 2)*w(p, third(m), 3)
         end do
      end do
      call gather_weighted(w, wyz, frame%base, tile, field, value)
   end subroutine gather_gimp

   !> Gradient of fields 5:7 and value of fields 2:4 at the lanes of a chunk (eq. 45, 46 and 44).
   pure subroutine gradient_gimp(q, frame, tile, gradient, value)
      real(wp), intent(in) :: q(8, 14)          !! x v m vol s of the lanes
      type(frame_t), intent(in) :: frame          !! bin of the chunk
      real(wp), intent(in) :: tile(8, *)      !! values of the tile's nodes
      real(wp), intent(out) :: gradient(8, 9)   !! dv_i/dx_j at 3 (i - 1) + j [1/time]
      real(wp), intent(out) :: value(8, 3)      !! velocity that moves the particles
      real(wp) :: w(8, 3, 3), d(8, 3, 3), wyz(8, 9), dyz(8, 9), wdz(8, 9), a, b
      real(wp), dimension(8) :: gx, gy, gz
      integer :: m, p, r, i

      call weigh_lanes(q, frame, w, d)
      do m = 1, 9
         !$omp simd
         do p = 1, 8
            wyz(p, m) = w(p, second(m), 2)*w(p, third(m), 3)
            dyz(p, m) = frame%per_size*d(p, second(m), 2)*w(p, third(m), 3)
            wdz(p, m) = frame%per_size*w(p, second(m), 2)*d(p, third(m), 3)
         end do
      end do
      do i = 5, 7
         gx = 0
         gy = 0
         gz = 0
         !GCC$ unroll 9
         do m = 1, 9
            r = frame%base + width*(second(m) - 1 + width*(third(m) - 1))
            !$omp simd private(a, b)
            do p = 1, 8
               a = w(p, 1, 1)*tile(i, r) + w(p, 2, 1)*tile(i, r + 1) + w(p, 3, 1)*tile(i, r + 2)
               b = d(p, 1, 1)*tile(i, r) + d(p, 2, 1)*tile(i, r + 1) + d(p, 3, 1)*tile(i, r + 2)
               gx(p) = gx(p) + b*wyz(p, m)
               gy(p) = gy(p) + a*dyz(p, m)
               gz(p) = gz(p) + a*wdz(p, m)
            end do
         end do
         gradient(:, 3*i - 14) = frame%per_size*gx
         gradient(:, 3*i - 13) = gy
         gradient(:, 3*i - 12) = gz
      end do
      call gather_weighted(w, wyz, frame%base, tile, 2, value)
   end subroutine gradient_gimp

   !> Value of three fields with weights at hand.
   pure subroutine gather_weighted(w, wyz, base, tile, field, value)
      real(wp), intent(in) :: w(8, 3, 3), wyz(8, 9), tile(8, *)
      integer, intent(in) :: base, field
      real(wp), intent(out) :: value(8, 3)
      real(wp) :: total(8)
      integer :: i, l, m, p, r

      do i = 1, 3
         l = field + i - 1
         total = 0
         !GCC$ unroll 9
         do m = 1, 9
            r = base + width*(second(m) - 1 + width*(third(m) - 1))
            !$omp simd
            do p = 1, 8
               total(p) = total(p) + wyz(p, m)*(w(p, 1, 1)*tile(l, r) &
                  + w(p, 2, 1)*tile(l, r + 1) + w(p, 3, 1)*tile(l, r + 2))
            end do
         end do
         value(:, i) = total
      end do
   end subroutine gather_weighted

   !> Weights of the 27 nodes of the stencil at one point, x fastest.
   pure function weights_gimp(t, half) result(w)
      real(wp), intent(in) :: t(3)   !! distance from the middle node [cells]
      real(wp), intent(in) :: half   !! half a particle's width [cells]
      real(wp) :: w(27), a(3, 3), d1, d2, d3
      integer :: i, m

      do i = 1, 3
         call weigh(t(i), half, 0.5_wp/half, a(1, i), a(2, i), a(3, i), d1, d2, d3)
      end do
      do m = 1, 9
         w(3*m - 2:3*m) = a(:, 1)*a(second(m), 2)*a(third(m), 3)
      end do
   end function weights_gimp
end module xmpm_gimp_kernels
