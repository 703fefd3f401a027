!> Points on the closed faces of a crack around its fronts, with the traction that contact gives
!> them and the gradient of the jump of displacement.
module xmpm_face_points
   use xmpm_kinds, only: wp
   use xmpm_hash_map, only: hash_map_t, clear_map, set_value, value_of
   use xmpm_communicator, only: comm_t, sum_all
   use xmpm_lattice, only: lattice_t, bin_of, bin_corner, block_of, local_bin, block_key, gimp_shape
   use xmpm_blocks, only: local_block
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, c_vol
   use xmpm_linear_kernels, only: weights_linear
   use xmpm_gimp_kernels, only: weights_gimp
   use xmpm_vectors, only: cross
   use xmpm_front, only: front_place_t, nearest_on_front, beyond_reach
   use xmpm_crack, only: crack_t, rule_graded
   implicit none
   private

   public :: face_forces_t, face_points_t, list_face_points, find_shares, find_tractions

   real(wp), parameter :: least = 0.05_wp   !! length ahead of the front on which the jump falls to
                                            !! 0 [cells]
   real(wp), parameter :: smooth = 0.9_wp   !! distance from the front from which on the root of it
                                            !! has a gradient that points can add up [cells]

   !> Forces of contact between the faces of one crack.
   type :: face_forces_t
      logical :: meet = .false.              !! the deck wants contact of them
      real(wp), allocatable :: x(:, :)       !! (3,n) nodes, each on one rank [length]
      real(wp), allocatable :: force(:, :)   !! (3,n) on the plus face [force]
   end type face_forces_t

   !> Points of the faces, each for a part of their area; alike on all ranks.
   type :: face_points_t
      integer :: n = 0
      real(wp), allocatable :: x(:, :)          !! (3,n) places [length]
      real(wp), allocatable :: area(:)          !! (n) [length^2]
      real(wp), allocatable :: slope(:, :, :)   !! (3,3,n) d(u+ - u-)_i/dx_k
      real(wp), allocatable :: traction(:, :)   !! (3,n) on the plus face [stress]
   end type face_points_t

contains

   !> List the points of all triangles near the fronts, and of the strip ahead of the fronts of the
   !> mesh on which the jump falls to 0: to the middle of the ramp.
   !>
   !> The jump is linear between the vertices, so that its whole change next to the front counts;
   !> further behind it is linear over the root of the distance from the front.
   subroutine list_face_points(crack, h, reach, points)
      type(crack_t), intent(in) :: crack             !! gathered, its front as the mesh has it
      real(wp), intent(in) :: h                      !! cell size [length]
      real(wp), intent(in) :: reach                  !! from the fronts [length]
      type(face_points_t), intent(out) :: points     !! without tractions
      integer :: parts(crack%surface%triangle_count), t, n

      do t = 1, size(parts)
         call divide(crack, t, h, reach, parts(t))
      end do
      n = 3*sum(parts**2) + 2*crack%front%edge_count
      allocate (points%x(3, n), points%area(n), points%slope(3, 3, n))
      allocate (points%traction(3, n), source=0.0_wp)
      do t = 1, size(parts)
         if (parts(t) > 0) call add_triangle(crack, t, parts(t), h, points)
      end do
      do t = 1, crack%front%edge_count
         call add_strip(crack, t, h, points)
      end do
   end subroutine list_face_points

   !> Parts of each side of a triangle, not longer than a cell; 0 where it is far from the fronts.
   subroutine divide(crack, t, h, reach, parts)
      type(crack_t), intent(in) :: crack
      integer, intent(in) :: t
      real(wp), intent(in) :: h, reach
      integer, intent(out) :: parts
      type(front_place_t) :: place
      real(wp) :: corner(3, 3), longest

      corner = crack%surface%x(:, crack%surface%tri(:, t))
      longest = maxval(norm2(corner - corner(:, [2, 3, 1]), 1))
      parts = 0
      call nearest_on_front(crack%front, sum(corner, 2)/3, reach + longest, place)
      if (place%edge > 0) parts = max(1, ceiling(longest/h))
   end subroutine divide

   !> Three points for each of the equal parts of a triangle.
   subroutine add_triangle(crack, t, parts, h, points)
      type(crack_t), intent(in) :: crack
      integer, intent(in) :: t, parts
      real(wp), intent(in) :: h
      type(face_points_t), intent(inout) :: points
      real(wp) :: corner(3, 3), jump(3, 3), behind(3), at(2, 3), weight(2)
      integer :: i, j, k, way

      corner = crack%surface%x(:, crack%surface%tri(:, t))
      jump = crack%surface%up(:, crack%surface%tri(:, t)) &
         - crack%surface%um(:, crack%surface%tri(:, t))
      do k = 1, 3
         behind(k) = distance_behind(crack, corner(:, k))
      end do
      if (minval(behind) < smooth*h .or. maxval(behind) > huge(1.0_wp)/2) behind = 1
      at = reshape([1.0_wp, 1.0_wp, 4.0_wp, 1.0_wp, 1.0_wp, 4.0_wp], [2, 3])/6
      do i = 0, parts - 1
         do j = 0, parts - 1 - i
            do way = 0, merge(1, 0, i + j < parts - 1)
               do k = 1, 3
                  weight = real([i, j], wp) + at(:, k)
                  if (way == 1) weight = real([i, j] + 1, wp) - at(:, k)
                  weight = weight/real(parts, wp)
                  points%n = points%n + 1
                  points%x(:, points%n) = corner(:, 1) + weight(1)*(corner(:, 2) - corner(:, 1)) &
                     + weight(2)*(corner(:, 3) - corner(:, 1))
                  points%area(points%n) = crack%surface%area(t)/real(3*parts**2, wp)
                  points%slope(:, :, points%n) = slope_at(crack, t, corner, jump, behind, &
                     [1 - sum(weight), weight])
               end do
            end do
         end do
      end do
   end subroutine add_triangle

   !> Distance from the front of the mesh.
   pure function distance_behind(crack, x) result(distance)
      type(crack_t), intent(in) :: crack
      real(wp), intent(in) :: x(3)   !! [length]
      real(wp) :: distance           !! [length], huge where no front is near
      type(front_place_t) :: place

      call nearest_on_front(crack%front, x, beyond_reach, place)
      distance = merge(place%distance, huge(1.0_wp), place%edge > 0)
   end function distance_behind

   !> Gradient in the plane of a triangle of the jump: linear over the root of the distance that is
   !> linear between its corners.
   pure function slope_at(crack, t, corner, jump, behind, weight) result(slope)
      type(crack_t), intent(in) :: crack
      integer, intent(in) :: t
      real(wp), intent(in) :: corner(3, 3), jump(3, 3)   !! of the corners [length]
      real(wp), intent(in) :: behind(3)                  !! likewise [length]; 1 for a linear jump
      real(wp), intent(in) :: weight(3)                  !! of the corners at the point
      real(wp) :: slope(3, 3), gradient(3, 3), part(3, 3), distance
      integer :: k

      associate (s => crack%surface)
         do k = 1, 3
            gradient(k, :) = cross(s%normal(:, t), corner(:, 1 + mod(k + 1, 3)) &
               - corner(:, 1 + mod(k, 3)))/(2*s%area(t))
            part(:, k) = jump(:, k)/sqrt(behind(k))
         end do
      end associate
      distance = dot_product(weight, behind)
      slope = sqrt(distance)*matmul(part, gradient)
      part(:, 1) = matmul(part, weight)/(2*sqrt(distance))
      gradient(1, :) = matmul(behind, gradient)
      do k = 1, 3
         slope(:, k) = slope(:, k) + part(:, 1)*gradient(1, k)
      end do
   end function slope_at

   !> Two points ahead of an edge of the front, where what its vertices have of a jump goes to 0.
   subroutine add_strip(crack, edge, h, points)
      type(crack_t), intent(in) :: crack
      integer, intent(in) :: edge
      real(wp), intent(in) :: h
      type(face_points_t), intent(inout) :: points
      real(wp) :: x(3, 2), jump(3, 2), length(2), share(2), ahead
      integer :: k, i

      associate (s => crack%surface, f => crack%front)
         associate (node => f%edge_node(:, edge))
            x = s%x(:, f%vertex(node))
            jump = s%up(:, f%vertex(node)) - s%um(:, f%vertex(node))
            length = 0
            if (crack%rule == rule_graded) length = (crack%ramp_end - 0.5_wp*crack%ramp)*h
            if (allocated(crack%offset)) length = length + crack%offset(node)
         end associate
         length = max(length, least*h)
         do k = 1, 2
            share = 0.5_wp + [0.5_wp, -0.5_wp]*real(2*k - 3, wp)/sqrt(3.0_wp)
            ahead = dot_product(share, length)
            points%n = points%n + 1
            points%x(:, points%n) = matmul(x, share) + 0.5_wp*ahead*f%edge_e1(:, edge)
            points%area(points%n) = 0.5_wp*ahead*norm2(x(:, 2) - x(:, 1))
            do i = 1, 3
               points%slope(:, i, points%n) = -matmul(jump, share)*f%edge_e1(i, edge)/ahead
            end do
         end do
      end associate
   end subroutine add_strip

   !> Shares of the bins of the points that this rank's particles fill, at most 1 over all ranks.
   subroutine find_shares(points, grid, p, share)
      type(face_points_t), intent(in) :: points
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      real(wp), intent(out) :: share(:)   !! (n)
      integer :: i, b, c, bin(3)

      share = 0
      do i = 1, points%n
         bin = bin_of(grid%lattice, points%x(:, i))
         b = local_block(grid%blocks, block_of(bin))
         if (b == 0) cycle
         c = p%head(local_bin(bin), b)
         do while (c > 0)
            share(i) = share(i) + sum(p%q(:p%count(c), c_vol, c))/grid%lattice%size**3
            c = p%next(c)
         end do
      end do
   end subroutine find_shares

   !> Tractions at the points, between those of the nodes: the force of a node over the area that it
   !> stands for, the integral of its shape function over the faces in the material. Collective.
   subroutine find_tractions(forces, comm, lattice, share, points)
      type(face_forces_t), intent(in) :: forces
      type(comm_t), intent(in) :: comm
      type(lattice_t), intent(in) :: lattice
      real(wp), intent(in) :: share(:)              !! (n) of `find_shares`, all ranks
      type(face_points_t), intent(inout) :: points
      type(hash_map_t) :: nodes
      real(wp) :: w(lattice%reach**3), sums(4, points%n), area(size(forces%x, 2))
      integer :: node(lattice%reach**3), i, k

      call clear_map(nodes, size(area))
      do i = 1, size(area)
         call set_value(nodes, block_key(nint((forces%x(:, i) - lattice%origin)/lattice%size)), i)
      end do
      points%area = points%area*min(share, 1.0_wp)
      area = 0
      do i = 1, points%n
         call nodes_around(lattice, nodes, points%x(:, i), node, w)
         do k = 1, size(w)
            if (node(k) > 0) area(node(k)) = area(node(k)) + w(k)*points%area(i)
         end do
      end do
      sums = 0
      do i = 1, points%n
         call nodes_around(lattice, nodes, points%x(:, i), node, w)
         do k = 1, size(w)
            if (node(k) == 0) cycle
            if (.not. area(node(k)) > 0) cycle
            sums(:, i) = sums(:, i) + w(k)*[forces%force(:, node(k))/area(node(k)), 1.0_wp]
         end do
      end do
      call sum_all(comm, sums)
      do i = 1, points%n
         if (sums(4, i) > 0) points%traction(:, i) = sums(:3, i)/sums(4, i)
      end do
   end subroutine find_tractions

   !> Nodes of a map whose shape functions are not 0 at a point, as cracks see them; 0 for those
   !> that are not in the map.
   pure subroutine nodes_around(lattice, nodes, x, node, w)
      type(lattice_t), intent(in) :: lattice
      type(hash_map_t), intent(in) :: nodes
      real(wp), intent(in) :: x(3)      !! [length]
      integer, intent(out) :: node(:)   !! numbers in the map
      real(wp), intent(out) :: w(:)     !! shape functions
      real(wp) :: t(3)
      integer :: bin(3), a, b, c, k

      bin = bin_of(lattice, x)
      t = (x - bin_corner(lattice, bin))/lattice%size
      if (lattice%shape == gimp_shape) then
         w = weights_gimp(t - 0.5_wp, 0.25_wp)
      else
         w = weights_linear(t)
      end if
      k = 0
      do c = 0, lattice%reach - 1
         do b = 0, lattice%reach - 1
            do a = 0, lattice%reach - 1
               k = k + 1
               node(k) = value_of(nodes, block_key(bin + lattice%low + [a, b, c]), 0)
            end do
         end do
      end do
   end subroutine nodes_around
end module xmpm_face_points
