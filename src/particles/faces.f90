!> Surface layers of bodies: which particles carry a face, each with its outward area vector.
!>
!> Flat faces are the planes across x, y or z that bound the body: `+x -x +y -y +z -z`. `side` is
!> the lateral surface of cylinders, tubes and spheres; `inside` the inner wall of tubes and the
!> wall of cylinders and spheres that were taken away.
module xmpm_faces
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t, raise, code_usage
   use xmpm_geometry, only: geometry_t, inside
   use xmpm_primitive, only: primitive_t, axial_and_radial, shape_box, shape_tube, shape_sphere
   implicit none
   private

   public :: find_face, faces_of, sum_areas, scale_areas
   public :: flat_face, has_flat_face, has_wall, wall_radius

   character(len=2), parameter :: flat_names(6) = ['-x', '+x', '-y', '+y', '-z', '+z']
   !> Deepest centroid of an outermost layer in sub-cells, with slivers of 1 % and a margin.
   real(wp), parameter :: deepest = 0.5075_wp

contains

   !> Outward area vectors of the particles of a face, zero for those that do not lie on it.
   !>
   !> The part V of a sub-cell below a flat face has its centroid at half its height, so its area is
   !> V / 2 d. Along a curved face the particles of a shell one sub-cell thick, whose lower edge is
   !> blurred by half a sub-cell either way, share its area in proportion to their volumes.
   subroutine find_face(g, name, x, volume, spacing, area, offset, error)
      type(geometry_t), intent(in) :: g                  !! the body
      character(len=*), intent(in) :: name               !! +x -x +y -y +z -z side inside
      real(wp), intent(in) :: x(:, :)                    !! (3,n) particles as filled [length]
      real(wp), intent(in) :: volume(:)                  !! (n) their volumes [length^3]
      real(wp), intent(in) :: spacing                    !! edge of a sub-cell [length]
      real(wp), intent(out) :: area(:, :)                !! (3,n) outward [length^2]
      real(wp), intent(out) :: offset(:, :)              !! (3,n) from the particle to the face,
                                                         !! along its normal [length]
      type(error_t), allocatable, intent(out) :: error   !! the body has no such face
      integer :: i, face

      area = 0.0_wp
      offset = 0.0_wp
      call check_name(g, name, error)
      if (allocated(error)) return
      face = flat_face(name)
      do i = 1, size(volume)
         if (face > 0) then
            call flat_area(g, face, x(:, i), volume(i), spacing, area(:, i), offset(:, i))
         else
            call wall_area(g, name == 'inside', x(:, i), volume(i), spacing, area(:, i), &
               offset(:, i))
         end if
      end do
   end subroutine find_face

   subroutine check_name(g, name, error)
      type(geometry_t), intent(in) :: g
      character(len=*), intent(in) :: name
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: known

      known = faces_of(g)
      if (index(' '//known//' ', ' '//trim(name)//' ') > 0 .and. scan(trim(name), ' ') == 0 &
         .and. len_trim(name) > 0) return
      if (flat_face(name) > 0 .or. name == 'side' .or. name == 'inside') then
         call raise(error, code_usage, 'the body has no face '//trim(name)//'; it has: '//known)
      else
         call raise(error, code_usage, "'"//trim(name)//"' is not a face; the body has: "//known)
      end if
   end subroutine check_name

   !> Names of the faces that a body has, separated by blanks.
   pure function faces_of(g) result(names)
      type(geometry_t), intent(in) :: g            !! the body
      character(len=:), allocatable :: names
      integer :: face

      names = ''
      do face = 1, 6
         if (has_flat_face(g, face)) names = names//' '//flat_names(face)
      end do
      if (has_wall(g, .false.)) names = names//' side'
      if (has_wall(g, .true.)) names = names//' inside'
      if (len(names) == 0) then
         names = 'none'
      else
         names = names(2:)
      end if
   end function faces_of

   !> Number of a flat face: 2 d - 1 and 2 d for the two across direction d; 0 if it is none.
   pure function flat_face(name) result(face)
      character(len=*), intent(in) :: name   !! for example '+x'
      integer :: face

      do face = size(flat_names), 1, -1
         if (flat_names(face) == name) return
      end do
      face = 0
   end function flat_face

   !> Whether the body is bounded by a plane on one of its six sides.
   pure function has_flat_face(g, face) result(holds)
      type(geometry_t), intent(in) :: g   !! the body
      integer, intent(in) :: face         !! see flat_face
      logical :: holds
      integer :: i, d

      holds = .false.
      if (.not. allocated(g%part)) return
      d = (face + 1)/2
      do i = 1, size(g%part)
         associate (p => g%part(i))
            if (p%shape /= shape_box .and. p%along /= d) cycle
            holds = min(abs(p%low(d) - plane_of(g, face)), abs(p%high(d) - plane_of(g, face))) &
               <= g%tolerance
         end associate
         if (holds) return
      end do
   end function has_flat_face

   pure function plane_of(g, face) result(plane)
      type(geometry_t), intent(in) :: g
      integer, intent(in) :: face
      real(wp) :: plane

      plane = merge(g%high((face + 1)/2), g%low((face + 1)/2), modulo(face, 2) == 0)
   end function plane_of

   !> Whether some shape of the body has a wall that faces outward, or inward.
   pure function has_wall(g, inward) result(holds)
      type(geometry_t), intent(in) :: g   !! the body
      logical, intent(in) :: inward       !! inner walls, not outer ones
      logical :: holds
      integer :: i

      holds = .false.
      if (.not. allocated(g%part)) return
      do i = 1, size(g%part)
         holds = wall_radius(g%part(i), inward) > 0.0_wp
         if (holds) return
      end do
   end function has_wall

   !> Radius of the outward or inward wall that a shape gives its body; 0 where it gives none.
   pure function wall_radius(p, inward) result(radius)
      type(primitive_t), intent(in) :: p   !! the shape
      logical, intent(in) :: inward        !! inner walls, not outer ones
      real(wp) :: radius                   !! [length]

      radius = 0.0_wp
      if (p%shape == shape_box) return
      if (p%subtract) then
         if (inward .and. p%shape /= shape_tube) radius = p%r_out
      else
         radius = merge(p%r_in, p%r_out, inward)
      end if
   end function wall_radius

   pure subroutine flat_area(g, face, x, volume, spacing, area, offset)
      type(geometry_t), intent(in) :: g
      integer, intent(in) :: face
      real(wp), intent(in) :: x(3), volume, spacing
      real(wp), intent(inout) :: area(3), offset(3)   !! 0 as they come
      real(wp) :: depth
      integer :: d

      d = (face + 1)/2
      depth = abs(x(d) - plane_of(g, face))
      if (depth > deepest*spacing .or. depth <= 0.0_wp) return
      area(d) = merge(1.0_wp, -1.0_wp, modulo(face, 2) == 0)*volume/(2*depth)
      offset(d) = sign(depth, area(d))
   end subroutine flat_area

   !> Share of a particle in the first wall whose shell it lies in and which bounds the body there.
   pure subroutine wall_area(g, inward, x, volume, spacing, area, offset)
      type(geometry_t), intent(in) :: g
      logical, intent(in) :: inward
      real(wp), intent(in) :: x(3), volume, spacing
      real(wp), intent(inout) :: area(3), offset(3)   !! 0 as they come
      real(wp) :: normal(3), depth, radius, thickness, weight
      integer :: i

      do i = 1, size(g%part)
         radius = wall_radius(g%part(i), inward)
         if (radius <= 0.0_wp) cycle
         call wall_depth(g%part(i), inward, x, depth, normal)
         thickness = min(spacing, radius)
         if (g%part(i)%shape == shape_tube) then
            thickness = min(thickness, g%part(i)%r_out - g%part(i)%r_in)
         end if
         weight = min(1.0_wp, 0.5_wp + (thickness - depth)/spacing)
         if (weight <= 0.0_wp) cycle
         if (inside(g, x + (depth + 0.01_wp*spacing)*normal)) cycle
         if (inward) thickness = -thickness
         area = weight*volume/shell_height(g%part(i), radius, thickness)*normal
         offset = depth*normal
         return
      end do
   end subroutine wall_area

   !> How far a point lies from a wall into the material, and the wall's normal out of it.
   pure subroutine wall_depth(p, inward, x, depth, normal)
      type(primitive_t), intent(in) :: p
      logical, intent(in) :: inward
      real(wp), intent(in) :: x(3)
      real(wp), intent(out) :: depth, normal(3)
      real(wp) :: s, rho

      depth = huge(1.0_wp)
      normal = 0.0_wp
      s = 0.0_wp
      if (p%shape == shape_sphere) then
         rho = norm2(x - p%base)
      else
         call axial_and_radial(p, x, s, rho)
         if (s < 0.0_wp .or. s > p%length) return
      end if
      if (rho <= 0.0_wp) return
      normal = (x - p%base - s*p%axis)/rho
      depth = p%r_out - rho
      if (.not. inward) return
      normal = -normal
      depth = rho - wall_radius(p, inward)
   end subroutine wall_depth

   !> Volume over area of a shell below a wall; a negative thickness is that of an inner wall.
   pure function shell_height(p, radius, thickness) result(height)
      type(primitive_t), intent(in) :: p
      real(wp), intent(in) :: radius, thickness
      real(wp) :: height

      if (p%shape == shape_sphere) then
         height = abs(radius**3 - (radius - thickness)**3)/(3*radius**2)
      else
         height = abs(radius**2 - (radius - thickness)**2)/(2*radius)
      end if
   end function shell_height

   !> Sums over particles for scale_areas: of the sizes of their areas and of the vectors.
   pure function sum_areas(area) result(sums)
      real(wp), intent(in) :: area(:, :)   !! (3,n) [length^2]
      real(wp) :: sums(4)                  !! to be added over the ranks [length^2]

      sums = [sum(norm2(area, dim=1)), sum(area, dim=2)]
   end function sum_areas

   !> Scale area vectors by f and shift them against e to the known sums of their face.
   !>
   !> With a' = f a - |a| e, the sums of a' and of the part of a' along a are those of the face: of
   !> the vectors, and of the work that a pressure does when the face moves along its normals.
   pure subroutine scale_areas(area, found, known)
      real(wp), intent(inout) :: area(:, :)   !! (3,n) [length^2]
      real(wp), intent(in) :: found(4)        !! sum_areas over all ranks [length^2]
      real(wp), intent(in) :: known(4)        !! of face_total; a negative area: not known
      real(wp) :: factor, excess(3), mean(3)
      integer :: i

      if (known(1) < 0.0_wp .or. found(1) <= 0.0_wp) return
      mean = found(2:4)/found(1)
      factor = known(1)/found(1)
      if (norm2(mean) < 0.99_wp) then
         factor = (factor - dot_product(known(2:4), mean)/found(1))/(1.0_wp - norm2(mean)**2)
      end if
      excess = factor*mean - known(2:4)/found(1)
      do i = 1, size(area, 2)
         area(:, i) = factor*area(:, i) - norm2(area(:, i))*excess
      end do
   end subroutine scale_areas
end module xmpm_faces
