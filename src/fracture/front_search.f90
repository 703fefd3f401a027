!> The fronts among the edges of a crack: where material is ahead of its boundary.
module xmpm_front_search
   use xmpm_kinds, only: wp, i8
   use xmpm_hash_map, only: hash_map_t, clear_map, set_value, value_of
   use xmpm_vectors, only: cross, unit_vector
   use xmpm_surface, only: surface_t
   use xmpm_front, only: front_t, mark_front
   use xmpm_material_test, only: material_test_t
   implicit none
   private

   public :: find_front

   real(wp), parameter :: test_ahead = 0.3_wp  !! distance of test points ahead of an edge [cells]

contains

   !> Fronts among given edges: those of the boundary with material ahead of any part of them.
   subroutine find_front(surface, pair, h, material, front)
      type(surface_t), intent(in) :: surface           !! mesh
      integer, intent(in) :: pair(:, :)                !! (2,np) vertices of edges that may be
                                                       !! fronts
      real(wp), intent(in) :: h                        !! grid size [length]
      class(material_test_t), intent(in) :: material   !! where material is
      type(front_t), intent(out) :: front              !! chains and frames
      type(hash_map_t) :: may
      logical :: inside(size(surface%boundary))
      integer :: i, e

      call clear_map(may, size(pair, 2))
      do i = 1, size(pair, 2)
         call set_value(may, pair_key(pair(:, i)), 1)
      end do
      do i = 1, size(inside)
         e = surface%boundary(i)
         inside(i) = .false.
         if (value_of(may, pair_key(surface%edge(:, e)), 0) == 0) cycle
         inside(i) = has_material_ahead(surface, e, h, material)
      end do
      call mark_front(surface, inside, front)
      call drop_rests(surface, material, inside, front)
   end subroutine find_front

   !> Chains without a node in the material are done: what is left ahead of them is less than a
   !> segment, and the ramp has reached it.
   subroutine drop_rests(surface, material, inside, front)
      type(surface_t), intent(in) :: surface
      class(material_test_t), intent(in) :: material
      logical, intent(inout) :: inside(:)
      type(front_t), intent(inout) :: front
      logical :: keep(surface%edge_count), any_inside
      integer :: c, i, k

      keep = .false.
      do c = 1, front%chain_count
         any_inside = .false.
         do i = front%chain_offset(c), front%chain_offset(c + 1) - 1
            any_inside = any_inside .or. material%inside(front%x(:, i))
         end do
         do i = front%chain_offset(c), front%chain_offset(c + 1) - 1
            k = front%node_edge(2, i)
            if (k > 0) keep(front%surface_edge(k)) = any_inside
         end do
      end do
      if (count(keep) == count(inside)) return
      inside = inside .and. keep(surface%boundary)
      call mark_front(surface, inside, front)
   end subroutine drop_rests

   pure function pair_key(pair) result(key)
      integer, intent(in) :: pair(2)
      integer(i8) :: key

      key = int(minval(pair), i8)*2_i8**31 + int(maxval(pair), i8)
   end function pair_key

   !> Whether material is at an edge or just ahead of it, at five places along it.
   pure function has_material_ahead(surface, e, h, material) result(has)
      type(surface_t), intent(in) :: surface
      integer, intent(in) :: e
      real(wp), intent(in) :: h
      class(material_test_t), intent(in) :: material
      logical :: has
      real(wp) :: ahead(3), a(3), b(3), f
      integer :: i

      a = surface%x(:, surface%edge(1, e))
      b = surface%x(:, surface%edge(2, e))
      ahead = unit_vector(cross(b - a, surface%normal(:, surface%edge_triangle(1, e))))
      has = .false.
      do i = 1, 9, 2
         f = 0.1_wp*real(i, wp)
         has = has .or. material%inside(a + f*(b - a)) &
            .or. material%inside(a + f*(b - a) + test_ahead*h*ahead)
      end do
   end function has_material_ahead
end module xmpm_front_search
