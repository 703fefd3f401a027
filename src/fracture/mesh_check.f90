!> Soundness of triangles that growth has added: none degenerate, folded back or overlapping.
module xmpm_mesh_check
   use xmpm_kinds, only: wp
   use xmpm_text, only: to_text
   use xmpm_error, only: error_t, raise, code_numerics
   use xmpm_vectors, only: cross
   use xmpm_box_tree, only: box_tree_t, build_tree, tree_depth
   use xmpm_surface, only: surface_t
   implicit none
   private

   public :: mesh_quality_t, check_new_triangles, triangles_overlap

   !> What was found in the new triangles.
   type :: mesh_quality_t
      integer :: triangles = 0                !! new triangles
      real(wp) :: area = 0.0_wp               !! theirs [length**2]
      real(wp) :: worst_shape = 1.0_wp        !! smallest 4 sqrt(3) area/(sum of edges squared): 1
                                              !! for equal edges, 0 for no area
      real(wp) :: sharpest_fold = 0.0_wp      !! largest angle between the normals at an edge [rad]
      integer :: degenerate = 0               !! triangles without area
      integer :: folded = 0                   !! edges where the surface turns back on itself
      integer :: overlapping = 0              !! new triangles that pass through or cover another
      logical, allocatable :: faulty(:)       !! (new triangles) which are not sound
   end type mesh_quality_t

   real(wp), parameter :: flat_shape = 1.0e-3_wp   !! shape of a degenerate triangle
   real(wp), parameter :: turned_back = -0.5_wp    !! cosine between the normals of a fold (120
                                                   !! degrees; the largest kink is 70.5)
   real(wp), parameter :: touching = 1.0e-6_wp     !! depth over edge that is no overlap
   real(wp), parameter :: coplanar = 1.0e-3_wp     !! distance over edge of triangles on each other

contains

   !> Measure all triangles from `first` on; an error where one is not sound.
   subroutine check_new_triangles(surface, first, quality, error)
      type(surface_t), intent(in) :: surface             !! the grown surface
      integer, intent(in) :: first                       !! first new triangle
      type(mesh_quality_t), intent(out) :: quality       !! what was found
      type(error_t), allocatable, intent(out) :: error   !! code_numerics, with the first place
      character(len=:), allocatable :: fault

      fault = ''
      quality%triangles = surface%triangle_count - first + 1
      allocate (quality%faulty(max(0, quality%triangles)), source=.false.)
      if (quality%triangles < 1) return
      quality%area = sum(surface%area(first:))
      call measure_shapes(surface, first, quality, fault)
      call measure_folds(surface, first, quality, fault)
      call find_overlaps(surface, first, quality, fault)
      if (len(fault) == 0) return
      call raise(error, code_numerics, 'growth found no valid triangles: '// &
         to_text(quality%degenerate)//' degenerate, '//to_text(quality%folded)//' folded, '// &
         to_text(quality%overlapping)//' overlapping; the first '//fault)
   end subroutine check_new_triangles

   subroutine measure_shapes(surface, first, quality, fault)
      type(surface_t), intent(in) :: surface
      integer, intent(in) :: first
      type(mesh_quality_t), intent(inout) :: quality
      character(len=:), allocatable, intent(inout) :: fault
      real(wp) :: shape
      integer :: t

      do t = first, surface%triangle_count
         associate (x => surface%x(:, surface%tri(:, t)))
            shape = 4.0_wp*sqrt(3.0_wp)*surface%area(t) &
               /(sum((x(:, 2) - x(:, 1))**2) + sum((x(:, 3) - x(:, 2))**2) &
               + sum((x(:, 1) - x(:, 3))**2))
            quality%worst_shape = min(quality%worst_shape, shape)
            if (shape > flat_shape) cycle
            quality%degenerate = quality%degenerate + 1
            quality%faulty(t - first + 1) = .true.
            if (len(fault) == 0) fault = 'is degenerate, at '//to_text(x(:, 1))
         end associate
      end do
   end subroutine measure_shapes

   subroutine measure_folds(surface, first, quality, fault)
      type(surface_t), intent(in) :: surface
      integer, intent(in) :: first
      type(mesh_quality_t), intent(inout) :: quality
      character(len=:), allocatable, intent(inout) :: fault
      real(wp) :: c
      integer :: e

      do e = 1, surface%edge_count
         associate (t => surface%edge_triangle(:, e))
            if (t(2) == 0 .or. maxval(t) < first) cycle
            c = dot_product(surface%normal(:, t(1)), surface%normal(:, t(2)))
            quality%sharpest_fold = max(quality%sharpest_fold, acos(max(-1.0_wp, min(1.0_wp, c))))
            if (c > turned_back) cycle
            quality%folded = quality%folded + 1
            if (t(1) >= first) quality%faulty(t(1) - first + 1) = .true.
            if (t(2) >= first) quality%faulty(t(2) - first + 1) = .true.
            if (len(fault) == 0) fault = 'is folded, at '// &
               to_text(surface%x(:, surface%edge(1, e)))
         end associate
      end do
   end subroutine measure_folds

   !> Each new triangle against all whose boxes meet its own.
   subroutine find_overlaps(surface, first, quality, fault)
      type(surface_t), intent(in) :: surface
      integer, intent(in) :: first
      type(mesh_quality_t), intent(inout) :: quality
      character(len=:), allocatable, intent(inout) :: fault
      type(box_tree_t) :: tree
      real(wp) :: box(6, surface%triangle_count)
      integer :: t, hit

      do t = 1, surface%triangle_count
         associate (x => surface%x(:, surface%tri(:, t)))
            box(1:3, t) = minval(x, 2)
            box(4:6, t) = maxval(x, 2)
         end associate
      end do
      call build_tree(box, tree)
      do t = first, surface%triangle_count
         hit = first_overlap(surface, tree, box, t)
         if (hit == 0) cycle
         quality%overlapping = quality%overlapping + 1
         quality%faulty(t - first + 1) = .true.
         if (len(fault) == 0) fault = 'meets another part of the surface, at '// &
            to_text(surface%x(:, surface%tri(1, t)))
      end do
   end subroutine find_overlaps

   !> Some triangle that overlaps a given one, 0 for none.
   pure function first_overlap(surface, tree, box, t) result(hit)
      type(surface_t), intent(in) :: surface
      type(box_tree_t), intent(in) :: tree
      real(wp), intent(in) :: box(:, :)
      integer, intent(in) :: t
      integer :: hit, waiting(tree_depth), count, node, i

      waiting(1) = 1
      count = 1
      do while (count > 0)
         node = waiting(count)
         count = count - 1
         if (any(tree%box(1:3, node) > box(4:6, t)) .or. &
            any(tree%box(4:6, node) < box(1:3, t))) then
            cycle
         end if
         if (tree%second(node) > 0) then
            waiting(count + 1:count + 2) = [tree%second(node), node + 1]
            count = count + 2
            cycle
         end if
         do i = tree%first(node), tree%last(node)
            hit = tree%item(i)
            if (hit == t) cycle
            if (triangles_overlap(surface%x(:, surface%tri(:, t)), &
               surface%x(:, surface%tri(:, hit)))) return
         end do
      end do
      hit = 0
   end function first_overlap

   !> Whether two triangles pass through each other or cover each other; to touch is no overlap.
   !>
   !> They do not if an axis separates them: a normal, a product of two edges, or in one plane a
   !> normal of an edge (separating axes).
   pure function triangles_overlap(a, b) result(overlap)
      real(wp), intent(in) :: a(3, 3)   !! corners, one a column [length]
      real(wp), intent(in) :: b(3, 3)   !! likewise
      logical :: overlap
      real(wp) :: edge_a(3, 3), edge_b(3, 3), n(3), m(3), size
      integer :: i, j

      edge_a = cshift(a, 1, 2) - a
      edge_b = cshift(b, 1, 2) - b
      size = sqrt(max(maxval(sum(edge_a**2, 1)), maxval(sum(edge_b**2, 1))))
      n = cross(edge_a(:, 1), edge_a(:, 2))
      m = cross(edge_b(:, 1), edge_b(:, 2))
      overlap = .false.
      if (in_plane(a(:, 1), n, b, coplanar*size)) then
         do i = 1, 3
            if (apart(cross(n, edge_a(:, i)), a, b, touching*size)) return
            if (apart(cross(n, edge_b(:, i)), a, b, touching*size)) return
         end do
      else
         if (apart(n, a, b, touching*size) .or. apart(m, a, b, touching*size)) return
         do i = 1, 3
            do j = 1, 3
               if (apart(cross(edge_a(:, i), edge_b(:, j)), a, b, touching*size)) return
            end do
         end do
      end if
      overlap = .true.
   end function triangles_overlap

   pure function in_plane(origin, normal, b, distance) result(is)
      real(wp), intent(in) :: origin(3), normal(3), b(3, 3), distance
      logical :: is
      integer :: k

      is = .true.
      do k = 1, 3
         is = is .and. abs(dot_product(b(:, k) - origin, normal)) <= distance*norm2(normal)
      end do
   end function in_plane

   !> Whether the shadows of two triangles on an axis overlap by less than a depth.
   pure function apart(axis, a, b, depth) result(are)
      real(wp), intent(in) :: axis(3), a(3, 3), b(3, 3), depth
      logical :: are
      real(wp) :: pa(3), pb(3), length

      are = .false.
      length = norm2(axis)
      if (.not. length > tiny(1.0_wp)) return
      pa = matmul(axis, a)
      pb = matmul(axis, b)
      are = min(maxval(pa) - minval(pb), maxval(pb) - minval(pa)) <= depth*length
   end function apart
end module xmpm_mesh_check
