!> Where fronts meet the surface of the material: an open end that has come inside is led out again,
!> and what little is left ahead of a front is cut at once.
module xmpm_front_reach
   use xmpm_kinds, only: wp, pi
   use xmpm_vectors, only: unit_vector
   use xmpm_front, only: front_t
   use xmpm_material_test, only: material_test_t
   use xmpm_front_line, only: line_t, front_limits_t, insert_node, parent_of
   implicit none
   private

   public :: reach_out, way_through

   real(wp), parameter :: stride = 0.25_wp             !! between places that are tried [cells]
   integer, parameter :: most_strides = 12             !! an end is led out by so many at most
   real(wp), parameter :: angles(8) = [0.0_wp, 15.0_wp, -15.0_wp, 30.0_wp, -30.0_wp, 45.0_wp, &
      60.0_wp, 75.0_wp]*pi/180.0_wp                    !! by which it may turn ahead [rad]
   real(wp), parameter :: leaning = 0.1_wp             !! an end leans back by so much at most,
                                                       !! before it turns [rad]
   real(wp), parameter :: dear = pi/3                  !! turning by this doubles a way [rad]
   real(wp), parameter :: rest = 1.5_wp                !! material ahead that is cut at once [cells]

contains

   !> Give an open end that has come to lie in the material a further node outside.
   !>
   !> The shortest way out is taken, in the surface, and rather straight on: a front that runs along
   !> a wall would else be led on by many cells. An end that already leans back is first turned
   !> straight out, or it would lean further at each growth. Where there is no way out, and for a
   !> front whose triangles did not hold, the old end stays and the front turns about it.
   pure subroutine reach_out(line, front, chain, limits, material, turns)
      type(line_t), intent(inout) :: line
      type(front_t), intent(in) :: front               !! old fronts
      integer, intent(in) :: chain                     !! of the line
      type(front_limits_t), intent(in) :: limits
      class(material_test_t), intent(in) :: material   !! where material is
      logical, intent(in) :: turns                     !! the old end stays
      integer :: side, end_node, before, inner, old
      real(wp) :: x(3), t(3)
      logical :: found

      if (line%closed .or. line%n < 2) return
      do side = 1, 2
         end_node = merge(1, line%n, side == 1)
         before = merge(2, line%n - 1, side == 1)
         if (line%vertex(end_node) > 0) cycle
         if (.not. material%inside(line%x(:, end_node))) cycle
         old = merge(front%chain_offset(chain), front%chain_offset(chain + 1) - 1, side == 1)
         found = .false.
         inner = merge(min(3, line%n), max(1, line%n - 2), side == 1)
         t = unit_vector(line%x(:, end_node) - line%x(:, before))
         if (.not. turns) call way_out(line%x(:, end_node), &
            not_behind(t, front%e1(:, parent_of(line, inner))), &
            front%e1(:, parent_of(line, end_node)), limits%cell, material, x, found)
         if (found) then
            call insert_node(line, merge(0, line%n, side == 1), x, line%from(:, end_node), &
               line%share(end_node))
         else if (.not. material%inside(front%x(:, old))) then
            call insert_node(line, merge(0, line%n, side == 1), front%x(:, old), [old, old], &
               0.0_wp)
            line%vertex(merge(1, line%n, side == 1)) = front%vertex(old)
         end if
      end do
   end subroutine reach_out

   !> A direction out of a front's end that leans back by an angle at the most.
   pure function not_behind(t, ahead) result(d)
      real(wp), intent(in) :: t(3)       !! out of the front
      real(wp), intent(in) :: ahead(3)   !! e1 further inside
      real(wp) :: d(3), back, out

      back = dot_product(t, ahead)
      out = norm2(t - back*ahead)
      d = t
      if (back < -tan(leaning)*out) d = unit_vector(t - (back + tan(leaning)*out)*ahead)
   end function not_behind

   !> The nearest place outside, in the plane of two directions; turning away counts as longer.
   pure subroutine way_out(x, t, ahead, h, material, place, found)
      real(wp), intent(in) :: x(3)          !! in the material [length]
      real(wp), intent(in) :: t(3)          !! out of the front
      real(wp), intent(in) :: ahead(3)      !! e1 of the front
      real(wp), intent(in) :: h             !! cell size [length]
      class(material_test_t), intent(in) :: material
      real(wp), intent(out) :: place(3)     !! [length]
      logical, intent(out) :: found
      real(wp) :: d(3), e(3), cost, best
      integer :: i, n

      best = huge(1.0_wp)
      place = x
      e = unit_vector(ahead - dot_product(ahead, t)*t)
      do i = 1, size(angles)
         d = cos(angles(i))*t + sin(angles(i))*e
         n = strides_to_outside(x, stride*h*d, most_strides, material)
         cost = real(n, wp)*(1 + (angles(i)/dear)**2)
         if (n == 0 .or. cost >= best) cycle
         best = cost
         place = x + real(n + 1, wp)*stride*h*d
      end do
      found = best < huge(1.0_wp)
   end subroutine way_out

   !> Number of strides after which a place is outside, 0 if none of them is.
   pure function strides_to_outside(x, step, most, material) result(n)
      real(wp), intent(in) :: x(3), step(3)
      integer, intent(in) :: most
      class(material_test_t), intent(in) :: material
      integer :: n

      do n = 1, most
         if (.not. material%inside(x + real(n, wp)*step)) return
      end do
      n = 0
   end function strides_to_outside

   !> Ways by which the nodes of a chain leave the material, if there is so little ahead of every
   !> one of them that it is cut at once.
   pure subroutine way_through(front, chain, limits, material, advance, ready)
      type(front_t), intent(in) :: front               !! fronts of one crack
      integer, intent(in) :: chain
      type(front_limits_t), intent(in) :: limits
      class(material_test_t), intent(in) :: material
      real(wp), intent(inout) :: advance(:, :)         !! (3,nn) of all nodes; changed if ready
      logical, intent(out) :: ready
      real(wp) :: way(front%node_count), step
      integer :: i, first, last, n

      first = front%chain_offset(chain)
      last = front%chain_offset(chain + 1) - 1
      step = stride*limits%cell
      way = 0
      ready = .false.
      do i = first, last
         if (.not. material%inside(front%x(:, i))) cycle
         n = strides_to_outside(front%x(:, i), step*front%e1(:, i), nint(rest/stride), material)
         ready = n > 0
         if (.not. ready) return
         way(i) = real(n + 1, wp)*step
      end do
      if (.not. ready) return
      do i = first, last
         advance(:, i) = max(way(i), norm2(advance(:, i)))*front%e1(:, i)
      end do
   end subroutine way_through
end module xmpm_front_reach
