!> Transfers between one chunk of particles and the tile of its block: uniform GIMP.
!>
!> t is the distance from the bin's middle node in cells, -1/2 to 1/2; half is half a particle's
!> width in cells. P2G keeps a node's values in vector lanes, G2P the 8 particles.
module xmpm_gimp_kernels
   use xmpm_kinds, only: wp
   use xmpm_frame, only: frame_t
   implicit none
   private

   public :: scatter_gimp, push_gimp, gather_gimp, gradient_gimp, weights_gimp

   integer, parameter :: width = 6   !! nodes of a tile along one direction
   integer, parameter :: second(9) = [1, 2, 3, 1, 2, 3, 1, 2, 3]   !! y node of each line
   integer, parameter :: third(9) = [1, 1, 1, 2, 2, 2, 3, 3, 3]    !! z node of each line

contains

   !> Weights and slopes (per cell) of the three nodes in one direction.
   elemental subroutine weigh(t, half, w1, w2, w3, d1, d2, d3)
      real(wp), intent(in) :: t, half
      real(wp), intent(out) :: w1, w2, w3, d1, d2, d3
      real(wp) :: below, above, scale

      scale = 0.5_wp/half
      below = min(max(half - t, 0.0_wp), 2*half)
      above = min(max(half + t, 0.0_wp), 2*half)
      d1 = -below*scale
      d3 = above*scale
      d2 = -(d1 + d3)
      w1 = 0.5_wp*below*below*scale + max(-t - half, 0.0_wp)
      w3 = 0.5_wp*above*above*scale + max(t - half, 0.0_wp)
      w2 = 1 - w1 - w3
   end subroutine weigh

   !> Weights and slopes of the lanes in all directions.
   pure subroutine weigh_lanes(q, frame, w, d)
      real(wp), intent(in) :: q(8, 14)
      type(frame_t), intent(in) :: frame
      real(wp), intent(out) :: w(8, 3, 3)   !! (lane, node, direction)
      real(wp), intent(out) :: d(8, 3, 3)   !! (lane, node, direction) [1/cell]
      real(wp) :: t
      integer :: i, p

      do i = 1, 3
         !$omp simd private(t)
         do p = 1, 8
            t = (q(p, i) - frame%corner(i))*frame%per_size - 0.5_wp
            call weigh(t, frame%half, w(p, 1, i), w(p, 2, i), w(p, 3, i), d(p, 1, i), d(p, 2, i), &
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
      real(wp) :: w(8, 3, 3), d(8, 3, 3), v(8, 8), ex(8, 8), ey(8, 8), ez(8, 8), vol(8)
      real(wp) :: xc(8), yc(8), zc(8), bb, cc, wb, db
      integer :: p, b, c, r, f

      call weigh_lanes(q, frame, w, d)
      vol = -q(:, 8)*frame%per_size
      call lay_out(q, vol, v, ex, ey, ez)
      do p = 1, n
         do c = 1, 3
            xc = w(p, c, 3)*ex(:, p)
            yc = w(p, c, 3)*ey(:, p)
            zc = w(p, c, 3)*v(:, p) + d(p, c, 3)*ez(:, p)
            do b = 1, 3
               wb = w(p, b, 2)
               db = d(p, b, 2)
               r = frame%base + width*(b - 1 + width*(c - 1))
               !$omp simd private(bb, cc)
               do f = 1, 8
                  bb = wb*zc(f) + db*yc(f)
                  cc = wb*xc(f)
                  tile(f, r) = tile(f, r) + w(p, 1, 1)*bb + d(p, 1, 1)*cc
                  tile(f, r + 1) = tile(f, r + 1) + w(p, 2, 1)*bb + d(p, 2, 1)*cc
                  tile(f, r + 2) = tile(f, r + 2) + w(p, 3, 1)*bb + d(p, 3, 1)*cc
               end do
            end do
         end do
      end do
   end subroutine scatter_gimp

   !> What a particle gives to a node: v with the weight, ex ey ez with the slopes.
   pure subroutine lay_out(q, vol, v, ex, ey, ez)
      real(wp), intent(in) :: q(8, 14), vol(8)
      real(wp), intent(out) :: v(8, 8), ex(8, 8), ey(8, 8), ez(8, 8)   !! (value, particle)

      v = 0
      ex = 0
      ey = 0
      ez = 0
      v(1, :) = q(:, 7)
      v(2, :) = q(:, 7)*q(:, 4)
      v(3, :) = q(:, 7)*q(:, 5)
      v(4, :) = q(:, 7)*q(:, 6)
      ex(5, :) = vol*q(:, 9)
      ex(6, :) = vol*q(:, 12)
      ex(7, :) = vol*q(:, 14)
      ey(5, :) = vol*q(:, 12)
      ey(6, :) = vol*q(:, 10)
      ey(7, :) = vol*q(:, 13)
      ez(5, :) = vol*q(:, 14)
      ez(6, :) = vol*q(:, 13)
      ez(7, :) = vol*q(:, 11)
   end subroutine lay_out

   !> Add a vector of each particle to the nodes with the shape function's weight.
   pure subroutine push_gimp(n, q, value, frame, tile)
      integer, intent(in) :: n                  !! particles in the chunk
      real(wp), intent(in) :: q(8, 14)          !! x v m vol s of the lanes
      real(wp), intent(in) :: value(8, 3)       !! vector of each lane
      type(frame_t), intent(in) :: frame          !! bin of the chunk
      real(wp), intent(inout) :: tile(4, *)   !! sums of the tile's nodes in 1:3
      real(wp) :: w(8, 3, 3), d(8, 3, 3), v(4, 8), wbc, zb
      integer :: p, b, c, r, f

      call weigh_lanes(q, frame, w, d)
      v(1, :) = value(:, 1)
      v(2, :) = value(:, 2)
      v(3, :) = value(:, 3)
      v(4, :) = 0
      do p = 1, n
         do c = 1, 3
            do b = 1, 3
               wbc = w(p, b, 2)*w(p, c, 3)
               r = frame%base + width*(b - 1 + width*(c - 1))
               !$omp simd private(zb)
               do f = 1, 4
                  zb = wbc*v(f, p)
                  tile(f, r) = tile(f, r) + w(p, 1, 1)*zb
                  tile(f, r + 1) = tile(f, r + 1) + w(p, 2, 1)*zb
                  tile(f, r + 2) = tile(f, r + 2) + w(p, 3, 1)*zb
               end do
            end do
         end do
      end do
   end subroutine push_gimp

   !> Interpolate three nodal fields to the lanes of a chunk.
   pure subroutine gather_gimp(q, frame, tile, field, value)
      real(wp), intent(in) :: q(8, 14)        !! x v m vol s of the lanes
      type(frame_t), intent(in) :: frame          !! bin of the chunk
      real(wp), intent(in) :: tile(8, *)    !! values of the tile's nodes
      integer, intent(in) :: field            !! first of the three fields
      real(wp), intent(out) :: value(8, 3)    !! at the particles
      real(wp) :: w(8, 3, 3), d(8, 3, 3), wyz(8, 9)
      integer :: m

      call weigh_lanes(q, frame, w, d)
      do m = 1, 9
         wyz(:, m) = w(:, second(m), 2)*w(:, third(m), 3)
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
         wyz(:, m) = w(:, second(m), 2)*w(:, third(m), 3)
         dyz(:, m) = d(:, second(m), 2)*w(:, third(m), 3)
         wdz(:, m) = w(:, second(m), 2)*d(:, third(m), 3)
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
         gradient(:, 3*i - 13) = frame%per_size*gy
         gradient(:, 3*i - 12) = frame%per_size*gz
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
         call weigh(t(i), half, a(1, i), a(2, i), a(3, i), d1, d2, d3)
      end do
      do m = 1, 9
         w(3*m - 2:3*m) = a(:, 1)*a(second(m), 2)*a(third(m), 3)
      end do
   end function weights_gimp
end module xmpm_gimp_kernels
