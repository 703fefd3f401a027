!> Transfers between one chunk of particles and the tile of its block: linear hat functions.
!>
!> P2G keeps the 8 nodes in vector lanes and walks over particles; G2P keeps the 8 particles in
!> lanes and evaluates the trilinear polynomial of the cell. t is the place in the cell, 0 to 1.
module xmpm_linear_kernels
   use xmpm_kinds, only: wp
   use xmpm_frame, only: frame_t
   implicit none
   private

   public :: scatter_linear, push_linear, gather_linear, gradient_linear
   public :: weights_linear

   integer, parameter :: off(8) = [0, 1, 5, 6, 25, 26, 30, 31]   !! tile node of each cell node
   real(wp), parameter :: sx(8) = real([-1, 1, -1, 1, -1, 1, -1, 1], wp)
   real(wp), parameter :: sy(8) = real([-1, -1, 1, 1, -1, -1, 1, 1], wp)
   real(wp), parameter :: sz(8) = real([-1, -1, -1, -1, 1, 1, 1, 1], wp)
   real(wp), parameter :: ox(8) = 0.5_wp*(1 - sx), oy(8) = 0.5_wp*(1 - sy), oz(8) = 0.5_wp*(1 - sz)

contains

   !> Add mass, momentum and internal force of a chunk (eq. 6, 7 and 23 of 10.1002/nme.6653).
   pure subroutine scatter_linear(n, q, frame, tile)
      integer, intent(in) :: n                    !! particles in the chunk
      real(wp), intent(in) :: q(8, 14)            !! x v m vol s of the lanes
      type(frame_t), intent(in) :: frame          !! bin of the chunk
      real(wp), intent(inout) :: tile(8, *)     !! m, p, f of the tile's nodes
      real(wp), dimension(8) :: tx, ty, tz, m, px, py, pz, s1, s2, s3, s4, s5, s6, vol
      real(wp), dimension(8) :: am, ax, ay, az, fx, fy, fz
      real(wp) :: wx, wy, wz, wyz, w, gx, gy, gz
      integer :: k, p

      vol = q(:, 8)*frame%per_size
      tx = (q(:, 1) - frame%corner(1))*frame%per_size
      ty = (q(:, 2) - frame%corner(2))*frame%per_size
      tz = (q(:, 3) - frame%corner(3))*frame%per_size
      m = q(:, 7)
      px = m*q(:, 4)
      py = m*q(:, 5)
      pz = m*q(:, 6)
      s1 = vol*q(:, 9)
      s2 = vol*q(:, 10)
      s3 = vol*q(:, 11)
      s4 = vol*q(:, 12)
      s5 = vol*q(:, 13)
      s6 = vol*q(:, 14)
      am = 0
      ax = 0
      ay = 0
      az = 0
      fx = 0
      fy = 0
      fz = 0
      do p = 1, n
         !$omp simd private(wx, wy, wz, wyz, w, gx, gy, gz)
         do k = 1, 8
            wx = ox(k) + sx(k)*tx(p)
            wy = oy(k) + sy(k)*ty(p)
            wz = oz(k) + sz(k)*tz(p)
            wyz = wy*wz
            w = wx*wyz
            gx = sx(k)*wyz
            gy = sy(k)*(wx*wz)
            gz = sz(k)*(wx*wy)
            am(k) = am(k) + w*m(p)
            ax(k) = ax(k) + w*px(p)
            ay(k) = ay(k) + w*py(p)
            az(k) = az(k) + w*pz(p)
            fx(k) = fx(k) - gx*s1(p) - gy*s4(p) - gz*s6(p)
            fy(k) = fy(k) - gx*s4(p) - gy*s2(p) - gz*s5(p)
            fz(k) = fz(k) - gx*s6(p) - gy*s5(p) - gz*s3(p)
         end do
      end do
      do k = 1, 8
         p = frame%base + off(k)
         tile(1:7, p) = tile(1:7, p) + [am(k), ax(k), ay(k), az(k), fx(k), fy(k), fz(k)]
      end do
   end subroutine scatter_linear

   !> Add a vector of each particle to the nodes with the shape function's weight.
   pure subroutine push_linear(n, q, value, frame, tile)
      integer, intent(in) :: n                  !! particles in the chunk
      real(wp), intent(in) :: q(8, 14)          !! x v m vol s of the lanes
      real(wp), intent(in) :: value(8, 3)       !! vector of each lane
      type(frame_t), intent(in) :: frame          !! bin of the chunk
      real(wp), intent(inout) :: tile(4, *)   !! sums of the tile's nodes in 1:3
      real(wp), dimension(8) :: tx, ty, tz, ax, ay, az
      real(wp) :: w
      integer :: k, p

      tx = (q(:, 1) - frame%corner(1))*frame%per_size
      ty = (q(:, 2) - frame%corner(2))*frame%per_size
      tz = (q(:, 3) - frame%corner(3))*frame%per_size
      ax = 0
      ay = 0
      az = 0
      do p = 1, n
         !$omp simd private(w)
         do k = 1, 8
            w = (ox(k) + sx(k)*tx(p))*(oy(k) + sy(k)*ty(p))*(oz(k) + sz(k)*tz(p))
            ax(k) = ax(k) + w*value(p, 1)
            ay(k) = ay(k) + w*value(p, 2)
            az(k) = az(k) + w*value(p, 3)
         end do
      end do
      do k = 1, 8
         p = frame%base + off(k)
         tile(1:3, p) = tile(1:3, p) + [ax(k), ay(k), az(k)]
      end do
   end subroutine push_linear

   !> Interpolate three nodal fields to the lanes of a chunk.
   pure subroutine gather_linear(q, frame, tile, field, value)
      real(wp), intent(in) :: q(8, 14)        !! x v m vol s of the lanes
      type(frame_t), intent(in) :: frame          !! bin of the chunk
      real(wp), intent(in) :: tile(8, *)    !! values of the tile's nodes
      integer, intent(in) :: field            !! first of the three fields
      real(wp), intent(out) :: value(8, 3)    !! at the particles
      real(wp) :: c(8, 8), tx, ty, tz
      integer :: i, p

      call cell_polynomial(tile, frame%base, c)
      do i = 1, 3
         !$omp simd private(tx, ty, tz)
         do p = 1, 8
            tx = (q(p, 1) - frame%corner(1))*frame%per_size
            ty = (q(p, 2) - frame%corner(2))*frame%per_size
            tz = (q(p, 3) - frame%corner(3))*frame%per_size
            value(p, i) = polynomial(c, field + i - 1, tx, ty, tz)
         end do
      end do
   end subroutine gather_linear

   !> Gradient of fields 5:7 and value of fields 2:4 at the lanes of a chunk (eq. 45, 46 and 44).
   pure subroutine gradient_linear(q, frame, tile, gradient, value)
      real(wp), intent(in) :: q(8, 14)          !! x v m vol s of the lanes
      type(frame_t), intent(in) :: frame          !! bin of the chunk
      real(wp), intent(in) :: tile(8, *)      !! values of the tile's nodes
      real(wp), intent(out) :: gradient(8, 9)   !! dv_i/dx_j at 3 (i - 1) + j [1/time]
      real(wp), intent(out) :: value(8, 3)      !! velocity that moves the particles
      real(wp) :: c(8, 8), tx, ty, tz
      integer :: i, p, l

      call cell_polynomial(tile, frame%base, c)
      do i = 1, 3
         l = 4 + i
         !$omp simd private(tx, ty, tz)
         do p = 1, 8
            tx = (q(p, 1) - frame%corner(1))*frame%per_size
            ty = (q(p, 2) - frame%corner(2))*frame%per_size
            tz = (q(p, 3) - frame%corner(3))*frame%per_size
            gradient(p, 3*i - 2) = frame%per_size*(c(l, 2) + c(l, 4)*ty + tz*(c(l, 6) + c(l, 8)*ty))
            gradient(p, 3*i - 1) = frame%per_size*(c(l, 3) + c(l, 4)*tx + tz*(c(l, 7) + c(l, 8)*tx))
            gradient(p, 3*i) = frame%per_size*(c(l, 5) + c(l, 6)*tx + ty*(c(l, 7) + c(l, 8)*tx))
            value(p, i) = polynomial(c, 1 + i, tx, ty, tz)
         end do
      end do
   end subroutine gradient_linear

   !> Coefficients of 1, x, y, xy, z, xz, yz, xyz of all fields in a cell.
   pure subroutine cell_polynomial(tile, base, c)
      real(wp), intent(in) :: tile(8, *)
      integer, intent(in) :: base
      real(wp), intent(out) :: c(8, 8)
      real(wp) :: a0, a1, a2, a3, a4, a5, a6, a7
      integer :: f

      !$omp simd private(a0, a1, a2, a3, a4, a5, a6, a7)
      do f = 1, 8
         a0 = tile(f, base)
         a1 = tile(f, base + 1) - a0
         a2 = tile(f, base + 5)
         a3 = tile(f, base + 6) - a2
         a4 = tile(f, base + 25)
         a5 = tile(f, base + 26) - a4
         a6 = tile(f, base + 30)
         a7 = tile(f, base + 31) - a6
         a3 = a3 - a1
         a2 = a2 - a0
         a7 = a7 - a5
         a6 = a6 - a4
         c(f, 1) = a0
         c(f, 2) = a1
         c(f, 3) = a2
         c(f, 4) = a3
         c(f, 5) = a4 - a0
         c(f, 6) = a5 - a1
         c(f, 7) = a6 - a2
         c(f, 8) = a7 - a3
      end do
   end subroutine cell_polynomial

   !> Value of one field of a cell's polynomial.
   pure function polynomial(c, f, tx, ty, tz) result(value)
      real(wp), intent(in) :: c(8, 8), tx, ty, tz
      integer, intent(in) :: f
      real(wp) :: value

      value = c(f, 1) + c(f, 2)*tx + ty*(c(f, 3) + c(f, 4)*tx) &
         + tz*(c(f, 5) + c(f, 6)*tx + ty*(c(f, 7) + c(f, 8)*tx))
   end function polynomial

   !> Weights of the 8 nodes of the cell at one point, x fastest.
   pure function weights_linear(t) result(w)
      real(wp), intent(in) :: t(3)   !! place in the cell, 0 to 1
      real(wp) :: w(8)

      w = (ox + sx*t(1))*(oy + sy*t(2))*(oz + sz*t(3))
   end function weights_linear
end module xmpm_linear_kernels
