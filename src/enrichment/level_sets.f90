!> The level sets of a crack: psi, the signed distance to its surface, and phi, the signed
!> distance to its front.
module xmpm_level_sets
   use xmpm_kinds, only: wp
   use xmpm_surface, only: surface_t
   use xmpm_surface_index, only: surface_index_t, nearest_t, nearest_on_surface, on_face, on_edge
   use xmpm_front, only: front_t, front_place_t, nearest_on_front, fully_cracked, beyond_reach
   use xmpm_vectors, only: unit_vector
   implicit none
   private

   public :: evaluate_level_sets, level_sets_at

   real(wp), parameter :: smooth = 0.94_wp   !! cosine of the angle (20 degrees) up to which a rim
                                             !! counts as smooth

contains

   !> psi, phi and the direction ahead of the front at many points.
   !>
   !> psi > 0 on the plus side; past the rim of the surface psi goes on along its tangent plane,
   !> and psi is exactly 0 within rounding of the surface. phi = (x - nearest front point).e1,
   !> negative behind the front; `fully_cracked` where no front is within reach. Points beyond
   !> reach of the surface get `beyond_reach` for both.
   pure subroutine evaluate_level_sets(surface, index, front, reach, x, psi, phi, e1)
      type(surface_t), intent(in) :: surface         !! mesh
      type(surface_index_t), intent(in) :: index     !! its spatial index
      type(front_t), intent(in) :: front             !! its fronts
      real(wp), intent(in) :: reach                  !! largest distance of interest [length]
      real(wp), intent(in) :: x(:, :)   !! (3, n) points, neighbours after each other for speed
                                        !! [length]
      real(wp), intent(out) :: psi(:)                !! (n) signed distance to the surface [length]
      real(wp), intent(out) :: phi(:)                !! (n) signed distance to the front [length]
      real(wp), intent(out) :: e1(:, :)   !! (3, n) gradient of phi, 0 where no front is within
                                          !! reach
      type(nearest_t) :: nearest
      integer :: i, hint

      hint = 0
      do i = 1, size(x, 2)
         call nearest_on_surface(index, surface, x(:, i), reach, nearest, hint)
         call level_sets_at(surface, front, reach, x(:, i), nearest, psi(i), phi(i), e1(:, i))
         hint = nearest%triangle
      end do
   end subroutine evaluate_level_sets

   !> psi, phi and the direction ahead at one point whose nearest point of the surface is known.
   pure subroutine level_sets_at(surface, front, reach, x, nearest, psi, phi, e1, at)
      type(surface_t), intent(in) :: surface     !! mesh
      type(front_t), intent(in) :: front         !! its fronts
      real(wp), intent(in) :: reach              !! largest distance of interest [length]
      real(wp), intent(in) :: x(3)               !! point [length]
      type(nearest_t), intent(in) :: nearest   !! nearest point of the surface, triangle 0 for none
      real(wp), intent(out) :: psi               !! signed distance to the surface [length]
      real(wp), intent(out) :: phi               !! signed distance to the front [length]
      real(wp), intent(out) :: e1(3)             !! gradient of phi
      type(front_place_t), intent(out), optional :: at   !! nearest place of the front, edge 0 where
                                                         !! none is within reach
      type(front_place_t) :: place

      psi = beyond_reach
      phi = beyond_reach
      e1 = 0.0_wp
      if (nearest%triangle == 0) return
      psi = signed_distance(surface, x, nearest)
      if (abs(psi) <= surface%rounding) psi = 0.0_wp
      phi = fully_cracked
      if (front%edge_count == 0) return
      call locate_front(surface, front, reach, x, nearest, place)
      if (present(at)) at = place
      if (place%edge == 0) return
      call distance_to_front(front, x, place, phi, e1)
      if (phi > 0.0_wp .and. .not. on_rim(surface, nearest)) phi = -place%distance
   end subroutine level_sets_at

   !> Distance to the surface with the sign of the pseudo-normal (Baerentzen and Aanaes 2005);
   !> past the rim only its part along the normal of the rim.
   pure function signed_distance(surface, x, nearest) result(psi)
      type(surface_t), intent(in) :: surface
      real(wp), intent(in) :: x(3)
      type(nearest_t), intent(in) :: nearest
      real(wp) :: psi, n(3)

      select case (nearest%feature)
      case (on_face)
         n = surface%normal(:, nearest%part)
      case (on_edge)
         n = surface%edge_normal(:, nearest%part)
         if (on_rim(surface, nearest)) n = rim_normal(surface, nearest)
      case default
         n = surface%vertex_normal(:, nearest%part)
      end select
      psi = dot_product(x - nearest%point, n)
      if (nearest%feature == on_face .or. on_rim(surface, nearest)) return
      psi = sign(nearest%distance, psi)
   end function signed_distance

   pure function on_rim(surface, nearest) result(is)
      type(surface_t), intent(in) :: surface
      type(nearest_t), intent(in) :: nearest
      logical :: is

      is = .false.
      if (nearest%feature == on_face) return
      if (nearest%feature == on_edge) then
         is = surface%edge_triangle(2, nearest%part) == 0
      else
         is = surface%on_boundary(nearest%part)
      end if
   end function on_rim

   !> Normal at a point of a boundary edge, between those of its vertices so that psi is
   !> continuous along a smooth rim; where a vertex stands at the end of a fold, the normal of the
   !> triangle takes its place.
   pure function rim_normal(surface, nearest) result(n)
      type(surface_t), intent(in) :: surface
      type(nearest_t), intent(in) :: nearest
      real(wp) :: n(3), a(3), b(3), t(3), f

      n = surface%edge_normal(:, nearest%part)
      associate (v => surface%edge(:, nearest%part))
         a = surface%vertex_normal(:, v(1))
         b = surface%vertex_normal(:, v(2))
         t = surface%x(:, v(2)) - surface%x(:, v(1))
         f = dot_product(nearest%point - surface%x(:, v(1)), t)/dot_product(t, t)
      end associate
      if (dot_product(a, n) < smooth) a = n
      if (dot_product(b, n) < smooth) b = n
      n = unit_vector((1.0_wp - f)*a + f*b)
   end function rim_normal

   !> The nearest point of the front, which is that of the surface where it lies on a front.
   pure subroutine locate_front(surface, front, reach, x, nearest, place)
      type(surface_t), intent(in) :: surface
      type(front_t), intent(in) :: front
      real(wp), intent(in) :: reach, x(3)
      type(nearest_t), intent(in) :: nearest
      type(front_place_t), intent(out) :: place

      if (on_rim(surface, nearest)) then
         if (nearest%feature == on_edge) then
            place%edge = front%edge_of(nearest%part)
         else
            place%node = front%node_of(nearest%part)
            if (place%node > 0) place%edge = maxval(front%node_edge(:, place%node))
         end if
         place%point = nearest%point
         place%distance = nearest%distance
         if (place%edge > 0) place%fraction = fraction_of(front, place)
      end if
      if (place%edge == 0) call nearest_on_front(front, x, reach, place)
   end subroutine locate_front

   !> How far along its edge a place is, 0 to 1.
   pure function fraction_of(front, place) result(f)
      type(front_t), intent(in) :: front
      type(front_place_t), intent(in) :: place
      real(wp) :: f, t(3)

      associate (a => front%x(:, front%edge_node(1, place%edge)), &
         b => front%x(:, front%edge_node(2, place%edge)))
         t = b - a
         f = max(0.0_wp, min(1.0_wp, dot_product(place%point - a, t)/dot_product(t, t)))
      end associate
   end function fraction_of

   !> Distance ahead of the nearest front point, and its gradient.
   !>
   !> Beside an edge the part of x - p along e1 of the edge; around a node the distance in the
   !> tangent plane, so that phi is continuous from edge to edge; at the open end of a chain the
   !> last edge goes on straight.
   pure subroutine distance_to_front(front, x, place, phi, e1)
      type(front_t), intent(in) :: front
      real(wp), intent(in) :: x(3)
      type(front_place_t), intent(in) :: place
      real(wp), intent(out) :: phi, e1(3)
      real(wp) :: t(3), length

      e1 = front%edge_e1(:, place%edge)
      t = x - place%point
      phi = dot_product(t, e1)
      if (place%node == 0) return
      if (any(front%node_edge(:, place%node) == 0)) return
      t = t - dot_product(t, front%e2(:, place%node))*front%e2(:, place%node)
      length = norm2(t)
      e1 = front%e1(:, place%node)
      phi = sign(length, dot_product(t, e1))
      if (length > 0.0_wp) e1 = t/phi
   end subroutine distance_to_front
end module xmpm_level_sets
