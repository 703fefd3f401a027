!> The common normal and the gap of two bodies at the nodes that both reach.
!>
!> Each body's own normal points from the centre of its part around the node to the node. It is
!> right
!> where the body is flat there and wrong at its corners; a flat body spreads as far across its
!> normal as the shape function does. So there are two directions for the
!> common normal: the distance of both centres, right where both are alike, and one that leaves out
!> a
!> body which spreads less. The one with the larger gap separates the bodies better and is the
!> normal.
!>
!> The gap along the normal n is that between the particles of both bodies around the node, which
!> reach r from their middle: least of n.x - r of the second less largest of n.x + r of the
!> first. It is exact for flat faces along the particles' rows, wherever the grid's nodes are.
module xmpm_contact_gap
   use xmpm_kinds, only: wp
   use xmpm_communicator, only: comm_t
   use xmpm_halo, only: start_sum, finish_sum, take_largest
   use xmpm_lattice, only: lattice_t, bins_per_block, bin_corner, gimp_shape
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, lanes, bin_of_chunk, c_x, c_m, c_vol
   use xmpm_linear_kernels, only: weights_linear
   use xmpm_gimp_kernels, only: weights_gimp
   use xmpm_sided, only: sided_t, side_weights
   use xmpm_contact_pairs, only: contact_t
   implicit none
   private

   public :: measure_gaps

   integer, parameter :: flatness = 16    !! power of the ratio of spreads in the weight of a body
   real(wp), parameter :: alike = 0.6_wp  !! ratio of spreads from which both may count alike

contains

   !> Normal and gap of all pairs, from the particles as they are now. Collective over neighbours.
   subroutine measure_gaps(contact, comm, p, half, sided, grid)
      type(contact_t), intent(inout) :: contact
      type(comm_t), intent(in) :: comm
      type(particles_t), intent(in) :: p
      real(wp), intent(in) :: half(:)          !! (bodies) half a particle's width [cells]
      type(sided_t), intent(in) :: sided
      type(grid_t), intent(in) :: grid
      real(wp) :: moment(20, contact%n), normal(3, 2, contact%n), extent(4, contact%n), gap(2)
      integer, allocatable :: bins(:, :)
      integer :: i

      call list_bins(contact, p, sided, bins)
      moment = 0
      do i = 1, size(bins, 2)
         call add_moments(contact, p, half, sided, grid, bins(1, i), bins(2, i), moment)
      end do
      call start_sum(contact%halo, comm, moment, 1, 20)
      call finish_sum(contact%halo, moment, 1, 20)
      do i = 1, contact%n
         normal(:, :, i) = spread(contact%normal(:, i), 2, 2)
         if (contact%crack(i) > 0) cycle
         normal(:, :, i) = spread(contact%given_normal(:, contact%group(1, i), &
            contact%group(2, i)), 2, 2)
         if (any(abs(normal(:, :, i)) > 0)) cycle
         normal(:, :, i) = common_normals(moment(:10, i), moment(11:, i), grid%lattice%size)
      end do
      extent = -huge(1.0_wp)
      do i = 1, size(bins, 2)
         call widen(contact, p, half, sided, grid%lattice, bins(1, i), bins(2, i), normal, &
            extent)
      end do
      call take_largest(contact%halo, comm, extent)
      do i = 1, contact%n
         contact%gap(i) = huge(1.0_wp)
         if (contact%crack(i) > 0) then
            contact%gap(i) = face_gap(moment(:10, i), moment(11:, i), contact%normal(:, i))
            cycle
         end if
         contact%normal(:, i) = 0
         if (.not. (moment(1, i) > 0 .and. moment(11, i) > 0)) cycle
         if (.not. any(abs(normal(:, 1, i)) > 0)) cycle
         gap = -extent(1:2, i) - extent(3:4, i)
         contact%gap(i) = maxval(gap)
         contact%normal(:, i) = normal(:, maxloc(gap, dim=1), i)
      end do
   end subroutine measure_gaps

   !> Chunks at the head of the bins that touch rows of pairs, and the number of the sided bin.
   subroutine list_bins(contact, p, sided, bins)
      type(contact_t), intent(in) :: contact
      type(particles_t), intent(in) :: p
      type(sided_t), intent(in) :: sided
      integer, allocatable, intent(out) :: bins(:, :)   !! (2,n)
      integer :: b, k, s, n

      allocate (bins(2, sided%n))
      n = 0
      if (contact%n > 0) then
         do b = 1, size(sided%bin, 2)
            do k = 1, bins_per_block
               s = sided%bin(k, b)
               if (s == 0 .or. p%head(k, b) == 0) cycle
               if (.not. any(contact%many(sided%rows(:, 0, s)) > 0)) cycle
               n = n + 1
               bins(:, n) = [p%head(k, b), s]
            end do
         end do
      end if
      bins = bins(:, :n)
   end subroutine list_bins

   !> Add volume, first and second moments about the node of a bin's particles to both sides of the
   !> pairs: 1, x, y, z, xx, yy, zz, xy, yz, xz.
   subroutine add_moments(contact, p, half, sided, grid, head, s, moment)
      type(contact_t), intent(in) :: contact
      type(particles_t), intent(in) :: p
      real(wp), intent(in) :: half(:)
      type(sided_t), intent(in) :: sided
      type(grid_t), intent(in) :: grid
      integer, intent(in) :: head, s
      real(wp), intent(inout) :: moment(:, :)
      real(wp) :: w(grid%lattice%reach**3), g(lanes), slope(lanes, 3), corner(3), x(3)
      integer :: c, i, k, set

      corner = bin_corner(grid%lattice, bin_of_chunk(p, grid%blocks, head))
      do set = 0, 2**sided%n_cracks(s) - 1
         c = head
         do while (c > 0)
            call side_weights(p, c, sided%crack(:sided%n_cracks(s), s), set, g, slope)
            do i = 1, p%count(c)
               if (.not. g(i) > 0) cycle
               x = p%q(i, c_x:c_x + 2, c)
               if (grid%lattice%shape == gimp_shape) then
                  w = weights_gimp((x - corner)/grid%lattice%size - 0.5_wp, half(p%body(c)))
               else
                  w = weights_linear((x - corner)/grid%lattice%size)
               end if
               w = w*g(i)*p%q(i, c_vol, c)
               do k = 1, size(w)
                  call add_particle(contact, sided%rows(k, set, s), x, x - p%x0(i, :, c), w(k), &
                     p%q(i, c_m, c)/p%q(i, c_vol, c), moment)
               end do
            end do
            c = p%next(c)
         end do
      end do
   end subroutine add_moments

   !> Gap of the faces of a crack: the difference of their mass-weighted displacements.
   pure function face_gap(minus, plus, n) result(gap)
      real(wp), intent(in) :: minus(10), plus(10), n(3)
      real(wp) :: gap

      gap = huge(1.0_wp)
      if (minus(1) > 0 .and. plus(1) > 0) then
         gap = dot_product(plus(2:4)/plus(1) - minus(2:4)/minus(1), n)
      end if
   end function face_gap

   !> Add the moments of one particle to the pairs of a row; for the faces of a crack the
   !> displacement
   !> stands for the place, and the mass for the volume.
   pure subroutine add_particle(contact, row, x, u, w, density, moment)
      type(contact_t), intent(in) :: contact
      integer, intent(in) :: row
      real(wp), intent(in) :: x(3), u(3), w, density
      real(wp), intent(inout) :: moment(:, :)
      real(wp) :: d(3)
      integer :: j, k

      do j = contact%first(row), contact%first(row) + contact%many(row) - 1
         if (all(contact%row(:, j) /= row)) cycle
         d = x - contact%place(:, j)
         k = merge(0, 10, contact%row(1, j) == row)
         if (contact%crack(j) > 0) then
            moment(k + 1:k + 4, j) = moment(k + 1:k + 4, j) + w*density*[1.0_wp, u]
            cycle
         end if
         moment(k + 1:k + 10, j) = moment(k + 1:k + 10, j) + w*[1.0_wp, d, d*d, d*cshift(d, 1)]
      end do
   end subroutine add_particle

   !> Two normals from the first body to the second; 0 where one is missing.
   pure function common_normals(a, b, h) result(n)
      real(wp), intent(in) :: a(10), b(10)   !! moments of both
      real(wp), intent(in) :: h              !! cell size [length]
      real(wp) :: n(3, 2), s(2)
      integer :: k

      n = 0
      if (.not. (a(1) > 0 .and. b(1) > 0)) return
      s = [spread_across(a, h), spread_across(b, h)]
      s = s/maxval(s)
      n(:, 1) = b(2:4)/b(1) - a(2:4)/a(1)
      n(:, 2) = s(2)**flatness*b(2:4)/b(1) - s(1)**flatness*a(2:4)/a(1)
      if (minval(s) < alike) n(:, 1) = n(:, 2)
      do k = 1, 2
         n(:, k) = n(:, k)/max(norm2(n(:, k)), tiny(1.0_wp))
      end do
   end function common_normals

   !> Variance of a body's part across its own normal, over that of a shape function's whole.
   pure function spread_across(m, h) result(ratio)
      real(wp), intent(in) :: m(10), h
      real(wp) :: ratio, centre(3), n(3), covariance(3, 3)

      centre = m(2:4)/m(1)
      n = centre/max(norm2(centre), tiny(1.0_wp))
      covariance(:, 1) = m([5, 8, 10])/m(1) - centre(1)*centre
      covariance(:, 2) = m([8, 6, 9])/m(1) - centre(2)*centre
      covariance(:, 3) = m([10, 9, 7])/m(1) - centre(3)*centre
      ratio = covariance(1, 1) + covariance(2, 2) + covariance(3, 3) &
         - dot_product(n, matmul(covariance, n))
      ratio = max(ratio*3/h**2, 1e-3_wp)
   end function spread_across

   !> Widen the extents along both normals by the particles of a bin: n.x + r of the first bodies,
   !> -n.x + r of the second ones.
   subroutine widen(contact, p, half, sided, lattice, head, s, normal, extent)
      type(contact_t), intent(in) :: contact
      type(particles_t), intent(in) :: p
      real(wp), intent(in) :: half(:)
      type(sided_t), intent(in) :: sided
      type(lattice_t), intent(in) :: lattice
      integer, intent(in) :: head, s
      real(wp), intent(in) :: normal(:, :, :)
      real(wp), intent(inout) :: extent(:, :)
      real(wp) :: g(lanes), slope(lanes, 3), radius(lanes), reach
      integer :: c, i, j, row, set, side

      do set = 0, 2**sided%n_cracks(s) - 1
         c = head
         do while (c > 0)
            call side_weights(p, c, sided%crack(:sided%n_cracks(s), s), set, g, slope)
            reach = lattice%size
            if (lattice%shape == gimp_shape) reach = reach*(1 + half(p%body(c)))
            radius = radii(p%q(:, c_vol, c), contact%spacing(p%body(c)))
            do i = 1, size(sided%rows, 1)
               if (.not. any(g > 0)) exit
               row = sided%rows(i, set, s)
               do j = contact%first(row), contact%first(row) + contact%many(row) - 1
                  do side = 1, 2
                     if (contact%row(side, j) /= row .or. contact%crack(j) > 0) cycle
                     call widen_by_lanes(p%count(c), p%q(:, :, c), g, radius, contact%place(:, j), &
                        reach, real(3 - 2*side, wp)*normal(:, :, j), &
                        extent(2*side - 1:2*side, j))
                  end do
               end do
            end do
            c = p%next(c)
         end do
      end do
   end subroutine widen

   !> How far particles reach from their middle. Of the cells of a body of shapes, cut by a flat
   !> face
   !> or strained in one direction, it is half the thickness.
   pure function radii(volume, spacing) result(radius)
      real(wp), intent(in) :: volume(lanes)   !! [length^3]
      real(wp), intent(in) :: spacing         !! of the particles, 0 where not known [length]
      real(wp) :: radius(lanes)

      if (spacing > 0) then
         radius = 0.5_wp*volume/spacing**2
      else
         radius = 0.5_wp*volume**(1.0_wp/3)
      end if
   end function radii

   !> Largest n.(x - place) + r of the lanes within reach of the node.
   pure subroutine widen_by_lanes(n, q, g, radius, place, reach, direction, extent)
      integer, intent(in) :: n
      real(wp), intent(in) :: q(lanes, 14), g(lanes), radius(lanes), place(3), reach, &
         direction(3, 2)
      real(wp), intent(inout) :: extent(2)
      real(wp) :: d(3)
      integer :: i

      do i = 1, n
         if (.not. g(i) > 0) cycle
         d = q(i, c_x:c_x + 2) - place
         if (any(abs(d) >= reach)) cycle
         extent = max(extent, matmul(d, direction) + radius(i))
      end do
   end subroutine widen_by_lanes
end module xmpm_contact_gap
