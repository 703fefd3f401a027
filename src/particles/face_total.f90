!> Area and area vector of whole faces, to which the shares of the particles are scaled.
module xmpm_face_total
   use xmpm_kinds, only: wp, pi
   use xmpm_geometry, only: geometry_t, inside
   use xmpm_primitive, only: primitive_t, shape_box, shape_sphere
   use xmpm_faces, only: flat_face, has_flat_face, has_wall, wall_radius
   implicit none
   private

   public :: face_total

   integer, parameter :: around = 256    !! points around a wall
   integer, parameter :: along = 1024    !! points along its axis

contains

   !> Area of a face and its vector; a negative area where particles know it better.
   !>
   !> In closed form for a body of one shape. Walls of other bodies are the points of the wall with
   !> material on one side only (256 around by 1024 along). Flat faces of other bodies are left to
   !> the particles, whose areas are exact where the body goes straight in behind the face.
   pure function face_total(g, name) result(total)
      type(geometry_t), intent(in) :: g      !! the body
      character(len=*), intent(in) :: name   !! see find_face
      real(wp) :: total(4)                   !! area, and the components of its vector [length^2]
      integer :: face, i

      total = [-1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
      face = flat_face(name)
      if (.not. allocated(g%part)) return
      if (face > 0) then
         if (size(g%part) > 1 .or. .not. has_flat_face(g, face)) return
         total(1) = flat_total(g%part(1), (face + 1)/2)
         total(1 + (face + 1)/2) = merge(total(1), -total(1), modulo(face, 2) == 0)
      else if (has_wall(g, name == 'inside')) then
         total(1) = 0.0_wp
         do i = 1, size(g%part)
            total = total + wall_total(g, g%part(i), name == 'inside')
         end do
      end if
   end function face_total

   pure function flat_total(p, direction) result(area)
      type(primitive_t), intent(in) :: p
      integer, intent(in) :: direction
      real(wp) :: area, edges(3)

      area = pi*(p%r_out**2 - p%r_in**2)
      if (p%shape /= shape_box) return
      edges = p%high - p%low
      area = product(edges, mask=[1, 2, 3] /= direction)
   end function flat_total

   pure function wall_total(g, p, inward) result(total)
      type(geometry_t), intent(in) :: g
      type(primitive_t), intent(in) :: p
      logical, intent(in) :: inward
      real(wp) :: total(4), radius, whole

      total = 0.0_wp
      radius = wall_radius(p, inward)
      if (radius <= 0.0_wp) return
      whole = 2*pi*radius*p%length
      if (p%shape == shape_sphere) whole = 4*pi*radius**2
      if (size(g%part) == 1) then
         total(1) = whole
      else
         total = whole*wall_share(g, p, radius, merge(-1.0_wp, 1.0_wp, inward))
      end if
   end function wall_total

   !> Share of a wall that bounds the body, and mean of its normal there over the whole wall.
   pure function wall_share(g, p, radius, sense) result(share)
      type(geometry_t), intent(in) :: g
      type(primitive_t), intent(in) :: p
      real(wp), intent(in) :: radius   !! of the wall [length]
      real(wp), intent(in) :: sense    !! 1: material within, -1: material around
      real(wp) :: share(4), point(3), normal(3), frame(3, 3), step
      integer :: i, j

      share = 0.0_wp
      frame = frame_of(p)
      step = 1.0e-6_wp*radius
      do j = 1, along
         do i = 1, around
            call place_on_wall(p, radius, frame, (real(i, wp) - 0.5_wp)/real(around, wp), &
               (real(j, wp) - 0.5_wp)/real(along, wp), point, normal)
            normal = sense*normal
            if (inside(g, point + step*normal)) cycle
            if (inside(g, point - step*normal)) share = share + [1.0_wp, normal]
         end do
      end do
      share = share/(real(around, wp)*real(along, wp))
   end function wall_share

   !> A point of a wall from its places around and along the axis, even in area, and its normal.
   pure subroutine place_on_wall(p, radius, frame, turn, height, point, normal)
      type(primitive_t), intent(in) :: p
      real(wp), intent(in) :: radius         !! [length]
      real(wp), intent(in) :: frame(3, 3)    !! two directions across and the axis
      real(wp), intent(in) :: turn, height   !! 0 to 1
      real(wp), intent(out) :: point(3), normal(3)
      real(wp) :: z

      normal = cos(2*pi*turn)*frame(:, 1) + sin(2*pi*turn)*frame(:, 2)
      if (p%shape == shape_sphere) then
         z = 2*height - 1.0_wp
         normal = sqrt(1.0_wp - z**2)*normal + z*frame(:, 3)
         point = p%base + radius*normal
      else
         point = p%base + height*p%length*p%axis + radius*normal
      end if
   end subroutine place_on_wall

   pure function frame_of(p) result(frame)
      type(primitive_t), intent(in) :: p
      real(wp) :: frame(3, 3)
      integer :: i

      frame = 0.0_wp
      frame(:, 3) = p%axis
      if (p%shape == shape_sphere) frame(3, 3) = 1.0_wp
      i = minloc(abs(frame(:, 3)), dim=1)
      frame(i, 1) = 1.0_wp
      frame(:, 1) = frame(:, 1) - frame(i, 3)*frame(:, 3)
      frame(:, 1) = frame(:, 1)/norm2(frame(:, 1))
      frame(:, 2) = [frame(2, 3)*frame(3, 1) - frame(3, 3)*frame(2, 1), &
         frame(3, 3)*frame(1, 1) - frame(1, 3)*frame(3, 1), &
         frame(1, 3)*frame(2, 1) - frame(2, 3)*frame(1, 1)]
   end function frame_of
end module xmpm_face_total
