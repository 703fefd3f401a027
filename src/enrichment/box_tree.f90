!> A tree of boxes over items in space (triangles, edges), so that the nearest is found without
!> looking at all.
module xmpm_box_tree
   use xmpm_kinds, only: wp
   implicit none
   private

   public :: box_tree_t, build_tree, refit_tree, box_distance2, tree_depth

   integer, parameter :: leaf_size = 4     !! most items in a leaf
   integer, parameter :: tree_depth = 64   !! places that a walk through a tree needs at most

   !> Nodes in depth-first order: the first child of a node stands behind it, so children have
   !> larger numbers.
   type :: box_tree_t
      integer :: nodes = 0   !! number of nodes; the root is 1, none if there are no items
      real(wp), allocatable :: box(:, :)     !! (6, nodes) lowest and highest corner [length]
      integer, allocatable :: second(:)      !! (nodes) second child, 0 for a leaf
      integer, allocatable :: first(:)       !! (nodes) first place in `item` of a leaf
      integer, allocatable :: last(:)        !! (nodes) last place in `item` of a leaf
      integer, allocatable :: item(:)        !! (items) numbers of the items, leaf after leaf
   end type box_tree_t

contains

   !> Build a tree over items that are given by their boxes.
   subroutine build_tree(box, tree)
      real(wp), intent(in) :: box(:, :)   !! (6, items) lowest and highest corner of each item
                                          !! [length]
      type(box_tree_t), intent(out) :: tree     !! ready for walks
      integer :: i, n

      n = size(box, 2)
      tree%item = [(i, i=1, n)]
      allocate (tree%box(6, 2*n), tree%second(2*n), tree%first(2*n), tree%last(2*n))
      if (n > 0) call split(tree, box, 1, n)
      call refit_tree(tree, box)
   end subroutine build_tree

   !> Give the nodes the boxes of items that have moved; the tree stays as it is.
   subroutine refit_tree(tree, box)
      type(box_tree_t), intent(inout) :: tree   !! boxes are renewed
      real(wp), intent(in) :: box(:, :)   !! (6, items) lowest and highest corner of each item
                                          !! [length]
      integer :: node, i

      do node = tree%nodes, 1, -1
         if (tree%second(node) > 0) then
            tree%box(:, node) = joined(tree%box(:, node + 1), tree%box(:, tree%second(node)))
         else
            tree%box(:, node) = box(:, tree%item(tree%first(node)))
            do i = tree%first(node) + 1, tree%last(node)
               tree%box(:, node) = joined(tree%box(:, node), box(:, tree%item(i)))
            end do
         end if
      end do
   end subroutine refit_tree

   !> Square of the distance from a point to a box; 0 inside.
   pure function box_distance2(box, x) result(d2)
      real(wp), intent(in) :: box(6)   !! lowest and highest corner [length]
      real(wp), intent(in) :: x(3)     !! point [length]
      real(wp) :: d2, d(3)             !! [length**2]

      d = max(0.0_wp, box(1:3) - x, x - box(4:6))
      d2 = d(1)*d(1) + d(2)*d(2) + d(3)*d(3)
   end function box_distance2

   pure function joined(a, b) result(box)
      real(wp), intent(in) :: a(6), b(6)
      real(wp) :: box(6)

      box(1:3) = min(a(1:3), b(1:3))
      box(4:6) = max(a(4:6), b(4:6))
   end function joined

   !> Make a node of the items from `first` to `last`: halve them along the longest direction
   !> until few are left.
   recursive subroutine split(tree, box, first, last)
      type(box_tree_t), intent(inout) :: tree
      real(wp), intent(in) :: box(:, :)
      integer, intent(in) :: first, last
      integer :: node, middle, axis
      real(wp) :: spread(3)

      tree%nodes = tree%nodes + 1
      node = tree%nodes
      tree%second(node) = 0
      tree%first(node) = first
      tree%last(node) = last
      if (last - first < leaf_size) return
      associate (centre => box(1:3, tree%item(first:last)) + box(4:6, tree%item(first:last)))
         spread = maxval(centre, 2) - minval(centre, 2)
      end associate
      axis = maxloc(spread, 1)
      call sort_items(tree%item(first:last), box, axis)
      middle = (first + last)/2
      call split(tree, box, first, middle)
      tree%second(node) = tree%nodes + 1
      call split(tree, box, middle + 1, last)
   end subroutine split

   !> Heap sort of items by the middle of their boxes; equal ones by number, so that the order is
   !> always the same.
   pure subroutine sort_items(item, box, axis)
      integer, intent(inout) :: item(:)
      real(wp), intent(in) :: box(:, :)
      integer, intent(in) :: axis
      integer :: i, n, held

      n = size(item)
      do i = n/2, 1, -1
         call sift(item, box, axis, i)
      end do
      do i = n, 2, -1
         held = item(i)
         item(i) = item(1)
         item(1) = held
         call sift(item(:i - 1), box, axis, 1)
      end do
   end subroutine sort_items

   pure subroutine sift(item, box, axis, start)
      integer, intent(inout) :: item(:)
      real(wp), intent(in) :: box(:, :)
      integer, intent(in) :: axis, start
      integer :: root, child, held

      held = item(start)
      root = start
      do
         child = 2*root
         if (child > size(item)) exit
         if (child < size(item)) then
            if (stands_before(item(child), item(child + 1), box, axis)) child = child + 1
         end if
         if (.not. stands_before(held, item(child), box, axis)) exit
         item(root) = item(child)
         root = child
      end do
      item(root) = held
   end subroutine sift

   pure function stands_before(i, j, box, axis) result(before)
      integer, intent(in) :: i, j, axis
      real(wp), intent(in) :: box(:, :)
      logical :: before
      real(wp) :: gap

      gap = box(axis, i) + box(axis + 3, i) - box(axis, j) - box(axis + 3, j)
      before = gap < 0.0_wp .or. (gap <= 0.0_wp .and. i < j)
   end function stands_before
end module xmpm_box_tree
