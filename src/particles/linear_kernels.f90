!> Transfers between one chunk of particles and the tile of its block: linear hat functions.
!>
!> P2G keeps the 8 nodes in vector lanes and walks over particles; G2P keeps the 8 particles in
!> lanes and evaluates the trilinear polynomial of the cell. t is the place in the cell, 0 to 1.
module xmpm_linear_kernels
   use xmpm_kinds, only: wp
   use xmpm_frame, only: frame_t
   use xmpm_shuffle, only: turn, turn_4
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
      real(wp) :: t(8, 3), m(8, 4), s(8, 6), values(8, 8), x, y, z, yz, xz, xy, w
      real(wp), dimension(8) :: am, ax, ay, az, f11, f12, f13, f21, f22, f23, f31, f32, f33
      integer :: k, p

      call lane_products(q, frame, t, m, s)
      am = 0
      ax = 0
      ay = 0
      az = 0
      f11 = 0
      f12 = 0
      f13 = 0
      f21 = 0
      f22 = 0
      f23 = 0
      f31 = 0
      f32 = 0
      f33 = 0
      do p = 1, n
         !$omp simd private(x, y, z, yz, xz, xy, w)
         do k = 1, 8
            x = ox(k) + sx(k)*t(p, 1)
            y = oy(k) + sy(k)*t(p, 2)
            z = oz(k) + sz(k)*t(p, 3)
            yz = y*z
            xz = x*z
            xy = x*y
            w = x*yz
            am(k) = am(k) + w*m(p, 1)
            ax(k) = ax(k) + w*m(p, 2)
            ay(k) = ay(k) + w*m(p, 3)
            az(k) = az(k) + w*m(p, 4)
            f11(k) = f11(k) + yz*s(p, 1)
            f12(k) = f12(k) + xz*s(p, 4)
            f13(k) = f13(k) + xy*s(p, 6)
            f21(k) = f21(k) + yz*s(p, 4)
            f22(k) = f22(k) + xz*s(p, 2)
            f23(k) = f23(k) + xy*s(p, 5)
            f31(k) = f31(k) + yz*s(p, 6)
            f32(k) = f32(k) + xz*s(p, 5)
            f33(k) = f33(k) + xy*s(p, 3)
         end do
      end do
      values(:, 1) = am
      values(:, 2) = ax
      values(:, 3) = ay
      values(:, 4) = az
      values(:, 5) = sx*f11 + sy*f12 + sz*f13
      values(:, 6) = sx*f21 + sy*f22 + sz*f23
      values(:, 7) = sx*f31 + sy*f32 + sz*f33
      values(:, 8) = 0
      call add_to_nodes(values, frame%base, tile)
   end subroutine scatter_linear

   !> Add (node,value) to the nodes of a cell.
   pure subroutine add_to_nodes(values, base, tile)
      real(wp), intent(inout) :: values(8, 8)   !! left transposed
      integer, intent(in) :: base
      real(wp), intent(inout) :: tile(8, *)
      integer :: i, k, p

      call turn(values)
      do k = 1, 8
         p = base + off(k)
         !$omp simd
         do i = 1, 8
            tile(i, p) = tile(i, p) + values(i, k)
         end do
      end do
   end subroutine add_to_nodes

   !> Place in the cell, mass and momentum, and minus volume times stress over h of the lanes.
   pure subroutine lane_products(q, frame, t, m, s)
      real(wp), intent(in) :: q(8, 14)
      type(frame_t), intent(in) :: frame
      real(wp), intent(out) :: t(8, 3), m(8, 4), s(8, 6)
      real(wp) :: vol
      integer :: p

      !$omp simd private(vol)
      do p = 1, 8
         t(p, 1) = (q(p, 1) - frame%corner(1))*frame%per_size
         t(p, 2) = (q(p, 2) - frame%corner(2))*frame%per_size
         t(p, 3) = (q(p, 3) - frame%corner(3))*frame%per_size
         m(p, 1) = q(p, 7)
         m(p, 2) = q(p, 7)*q(p, 4)
         m(p, 3) = q(p, 7)*q(p, 5)
         m(p, 4) = q(p, 7)*q(p, 6)
         vol = -frame%per_size*q(p, 8)
         s(p, 1) = vol*q(p, 9)
         s(p, 2) = vol*q(p, 10)
         s(p, 3) = vol*q(p, 11)
         s(p, 4) = vol*q(p, 12)
         s(p, 5) = vol*q(p, 13)
         s(p, 6) = vol*q(p, 14)
      end do
   end subroutine lane_products

   !> Add a vector of each particle to the nodes with the shape function's weight.
   pure subroutine push_linear(n, q, value, frame, tile)
      integer, intent(in) :: n                  !! particles in the chunk
      real(wp), intent(in) :: q(8, 14)          !! x v m vol s of the lanes
      real(wp), intent(in) :: value(8, 3)       !! vector of each lane
      type(frame_t), intent(in) :: frame          !! bin of the chunk
      real(wp), intent(inout) :: tile(4, *)   !! sums of the tile's nodes in 1:3
      real(wp), dimension(8) :: tx, ty, tz, ax, ay, az
      real(wp) :: w, values(8, 4), sums(4, 8)
      integer :: k, p, f

      tx = (q(:, 1) - frame%corner(1))*frame%per_size
      ty = (q(:, 2) - frame%corner(2))*frame%per_size
      tz = (q(:, 3) - frame%corner(3))*frame%per_size
      ax = 0
      ay = 0
      az = 0
      !GCC$ unroll 1
      do p = 1, n
         !$omp simd private(w)
         do k = 1, 8
            w = (ox(k) + sx(k)*tx(p))*(oy(k) + sy(k)*ty(p))*(oz(k) + sz(k)*tz(p))
            ax(k) = ax(k) + w*value(p, 1)
            ay(k) = ay(k) + w*value(p, 2)
            az(k) = az(k) + w*value(p, 3)
         end do
      end do
      values(:, 1) = ax
      values(:, 2) = ay
      values(:, 3) = az
      values(:, 4) = 0
      call turn_4(values, sums)
      do k = 1, 8
         p = frame%base + off(k)
         !$omp simd
         do f = 1, 4
            tile(f, p) = tile(f, p) + sums(f, k)
         end do
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
