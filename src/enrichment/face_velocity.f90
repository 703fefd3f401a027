!> Velocity of the material on the two sides of a crack, at points of its surface.
!>
!> A side's rows end beyond its face. Some have no mass. Others are reached by corners of GIMP
!> particles alone: a velocity that is theirs and not that of the node, since next to no force
!> makes the row follow the others. In a body that turns it is off by the spin times that way, to
!> opposite directions on the two sides, and the faces would slip without end. So with GIMP rows
!> count by their share of the node's mass, and what that takes from the sum of the weights is made
!> up for by the gradient of the rows that count. (The slopes of linear functions do not fall with
!> the weight, and stress keeps such rows in line.)
module xmpm_face_velocity
   use xmpm_kinds, only: wp
   use xmpm_lattice, only: lattice_t, bin_corner, local_bin, gimp_shape, stencil_offsets, &
      bins_per_block
   use xmpm_vectors, only: inverse
   use xmpm_grid, only: grid_t
   use xmpm_linear_kernels, only: weights_linear
   use xmpm_gimp_kernels, only: weights_gimp
   use xmpm_sided, only: sided_t
   use xmpm_loads, only: rows_of_bin
   implicit none
   private

   public :: face_velocities

   real(wp), parameter :: whole = 0.1_wp     !! share of a node's mass from which on a row counts in
                                             !! full: that of particles that reach the node with
                                             !! about all their width
   real(wp), parameter :: least = 1e-4_wp    !! added to the spread of the rows in any direction:
                                             !! there is no gradient across one layer of nodes
                                             !! [cells^2]
   real(wp), parameter :: nothing = 1e-6_wp  !! sum of weights of a side without material

contains

   !> Velocities of fields 5:7 on both sides of a crack at a point: nodes without mass on a side do
   !> not count, and where the faces have come apart, neither do those of the other face.
   subroutine face_velocities(grid, sided, number, x, normal, bin, b, plus, minus, material)
      type(grid_t), intent(in) :: grid
      type(sided_t), intent(in) :: sided
      integer, intent(in) :: number            !! of the crack
      real(wp), intent(in) :: x(3)             !! the point [length]
      real(wp), intent(in) :: normal(3)        !! where the faces have come apart, else 0
      integer, intent(in) :: bin(3), b         !! its bin and block
      real(wp), intent(out) :: plus(3)         !! [length/time]
      real(wp), intent(out) :: minus(3)        !! [length/time]
      logical, intent(out) :: material         !! whether both sides have some
      real(wp) :: w(grid%lattice%reach**3, 2), t(3), total(2)
      integer :: rows(grid%lattice%reach**3, 2)

      t = (x - bin_corner(grid%lattice, bin))/grid%lattice%size
      if (grid%lattice%shape == gimp_shape) then
         w(:, 1) = weights_gimp(t - 0.5_wp, 0.25_wp)
      else
         w(:, 1) = weights_linear(t)
      end if
      w(:, 2) = w(:, 1)
      call rows_of_sides(grid, sided, number, local_bin(bin), b, rows)
      if (any(abs(normal) > 0)) call part_nodes(grid%lattice, t, normal, rows, w)
      call side_velocity(grid, rows, 1, w(:, 1), t, minus, total(1))
      call side_velocity(grid, rows, 2, w(:, 2), t, plus, total(2))
      material = all(total > nothing)
      if (total(1) <= nothing) minus = plus
      if (total(2) <= nothing) plus = minus
   end subroutine face_velocities

   !> Rows of a bin's nodes on the minus and the plus side of a crack.
   pure subroutine rows_of_sides(grid, sided, number, k, b, rows)
      type(grid_t), intent(in) :: grid
      type(sided_t), intent(in) :: sided
      integer, intent(in) :: number, k, b     !! crack, bin within its block, block
      integer, intent(out) :: rows(:, :)      !! (nodes,2)
      integer :: s, i

      rows(:, 1) = rows_of_bin(grid, bins_per_block*(b - 1) + k, stencil_offsets(grid%lattice))
      rows(:, 2) = rows(:, 1)
      if (sided%n == 0) return
      s = sided%bin(k, b)
      if (s == 0) return
      do i = 1, sided%n_cracks(s)
         if (sided%crack(i, s) /= number) cycle
         rows(:, 1) = sided%rows(:, 0, s)
         rows(:, 2) = sided%rows(:, 2**(i - 1), s)
      end do
   end subroutine rows_of_sides

   !> A node that is not split has mass of one side alone once the faces have come apart: that on
   !> which it lies.
   pure subroutine part_nodes(lattice, t, normal, rows, w)
      type(lattice_t), intent(in) :: lattice
      real(wp), intent(in) :: t(3)          !! place in the bin [cells]
      real(wp), intent(in) :: normal(3)
      integer, intent(in) :: rows(:, :)     !! (nodes,2) of the minus and the plus side
      real(wp), intent(inout) :: w(:, :)    !! (nodes,2) weights
      integer :: i, k, n, other
      real(wp) :: node(3)

      n = lattice%reach
      do i = 1, size(rows, 1)
         if (rows(i, 1) /= rows(i, 2)) cycle
         node = [(real(mod((i - 1)/n**k, n), wp), k=0, 2)] + 0.5_wp*real(lattice%low, wp) - t
         other = merge(1, 2, dot_product(node, normal) > 0)
         w(i, other) = 0
      end do
   end subroutine part_nodes

   !> Velocity of one side at a point.
   pure subroutine side_velocity(grid, rows, side, w, t, v, total)
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: rows(:, :)       !! (nodes,2)
      integer, intent(in) :: side             !! 1 or 2
      real(wp), intent(in) :: w(:)            !! (nodes) weights of the point
      real(wp), intent(in) :: t(3)            !! the point in its bin [cells]
      real(wp), intent(out) :: v(3)           !! [length/time]
      real(wp), intent(out) :: total          !! sum of what the weights count
      real(wp) :: counts(size(w)), share
      integer :: i

      v = 0
      do i = 1, size(w)
         counts(i) = 0
         if (.not. grid%node(1, rows(i, side)) > 0) cycle
         counts(i) = w(i)
         if (rows(i, 1) /= rows(i, 2) .and. grid%lattice%shape == gimp_shape) then
            share = grid%node(1, rows(i, side))/sum(grid%node(1, rows(i, :)))
            counts(i) = w(i)*min(1.0_wp, share/whole)**2
         end if
         v = v + counts(i)*grid%node(5:7, rows(i, side))
      end do
      total = sum(counts)
      if (.not. total > 0) return
      v = v/total
      if (grid%lattice%shape == gimp_shape .and. total < 1 - nothing) then
         v = v + change(grid%node(5:7, rows(:, side)), v, counts/total, t + 0.5_wp)
      end if
   end subroutine side_velocity

   !> What a velocity changes by from the middle of the nodes of a stencil that count to a point.
   pure function change(u, mean, counts, t) result(dv)
      real(wp), intent(in) :: u(:, :)      !! (3,27) at the nodes [length/time]
      real(wp), intent(in) :: mean(3)      !! [length/time]
      real(wp), intent(in) :: counts(:)    !! (27) what they count, 1 in all
      real(wp), intent(in) :: t(3)         !! from the first node to the point [cells]
      real(wp) :: dv(3), d(3, 27), middle(3), spread(3, 3), product(3, 3)
      integer :: i, k

      do i = 1, 27
         d(:, i) = real([mod(i - 1, 3), mod((i - 1)/3, 3), (i - 1)/9], wp) - t
      end do
      middle = matmul(d, counts)
      spread = 0
      product = 0
      do i = 1, 27
         if (.not. counts(i) > 0) cycle
         d(:, i) = d(:, i) - middle
         do k = 1, 3
            spread(:, k) = spread(:, k) + counts(i)*d(k, i)*d(:, i)
            product(:, k) = product(:, k) + counts(i)*d(k, i)*(u(:, i) - mean)
         end do
      end do
      do k = 1, 3
         spread(k, k) = spread(k, k) + least
      end do
      dv = -matmul(product, matmul(inverse(spread), middle))
   end function change
end module xmpm_face_velocity
