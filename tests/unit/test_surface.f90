!> The crack surface: topology, normals, motion, and the messages about wrong meshes.
program test_surface
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t
   use xmpm_surface, only: surface_t, build_surface, refresh_geometry, surface_area, fill_void
   use xmpm_crack_shapes, only: crack_plane_t, make_rectangle, make_disc
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   type(surface_t) :: surface
   type(error_t), allocatable :: error
   real(wp), allocatable :: x(:, :)
   integer, allocatable :: tri(:, :)
   real(wp), parameter :: corners(3, 5) = reshape([0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
      0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, &
      0.0_wp, 1.0_wp, 0.0_wp, 2.0_wp, 2.0_wp, 0.0_wp], [3, 5])

   suite%name = 'surface'
   call two_triangles()
   call topology()
   call ring_has_two_loops()
   call pseudo_normals()
   call motion()
   call void_follows()
   call messages()
   call finish(suite)

contains

   subroutine two_triangles()
      call build_surface(corners(:, 1:4), reshape([1, 2, 3, 1, 3, 4], [3, 2]), surface, error)
      call check_no_error(suite, 'a square of two triangles is a surface', error)
      call check(suite, 'it has five edges', surface%edge_count == 5)
      call check(suite, 'its normal is right-handed about the order of the vertices', &
         all(surface%normal(3, :) > 0.999_wp))
      ! exact in binary arithmetic
      call check_close(suite, 'its area is one', surface_area(surface), 1.0_wp, 0.0_wp, 0.0_wp)
      call check(suite, 'its boundary runs with the surface on its left', &
         all(surface%edge(1, surface%boundary) == [1, 2, 3, 4]) .and. &
         all(surface%edge(2, surface%boundary) == [2, 3, 4, 1]))
   end subroutine two_triangles

   !> Edges and triangles know each other, in a disc of many triangles.
   subroutine topology()
      integer :: t, k, e, v, i
      logical :: known

      call make_disc(crack_plane_t(), 1.0_wp, 0.2_wp, x, tri, error)
      call build_surface(x, tri, surface, error)
      known = .true.
      do t = 1, surface%triangle_count
         do k = 1, 3
            e = surface%triangle_edge(k, t)
            known = known .and. any(surface%edge_triangle(:, e) == t)
            known = known .and. any(surface%edge(:, e) == tri(k, t)) .and. &
               any(surface%edge(:, e) == tri(mod(k, 3) + 1, t))
         end do
      end do
      call check(suite, 'edge k of a triangle joins its vertices k and k + 1 and knows the '// &
         'triangle', known)
      known = surface%vertex_offset(surface%vertex_count + 1) == 3*surface%triangle_count + 1
      do v = 1, surface%vertex_count
         do i = surface%vertex_offset(v), surface%vertex_offset(v + 1) - 1
            known = known .and. any(tri(:, surface%vertex_triangle(i)) == v)
         end do
      end do
      call check(suite, 'a vertex knows the triangles around it', known)
      call check(suite, 'a disc has one rim of 6 edges a ring', &
         size(surface%boundary) == 30 .and. size(surface%loop_offset) == 2)
      call check(suite, 'vertices on the rim are on the boundary', &
         all(surface%on_boundary .eqv. norm2(x, 1) > 1.0_wp - 1.0e-12_wp))
   end subroutine topology

   !> A square with a hole.
   subroutine ring_has_two_loops()
      logical :: keep(18)

      call make_rectangle(crack_plane_t(), [3.0_wp, 3.0_wp], 1.0_wp, x, tri, error)
      keep = .true.
      keep(9:10) = .false.
      tri = reshape(pack(tri, spread(keep, 1, 3)), [3, 16])
      call build_surface(x, tri, surface, error)
      call check_no_error(suite, 'a surface may have a hole', error)
      call check(suite, 'a hole is a second loop', size(surface%loop_offset) == 3 .and. &
         size(surface%boundary) == 16)
   end subroutine ring_has_two_loops

   !> The tip of a pyramid: its pseudo-normal is along the axis however its sides are divided.
   subroutine pseudo_normals()
      real(wp) :: p(3, 6)
      integer :: k
      real(wp), parameter :: angle(5) = [0.0_wp, 1.0_wp, 2.0_wp, 3.0_wp, 3.5_wp]*0.5_wp*pi

      do k = 1, 5
         p(:, k) = [cos(angle(k)), sin(angle(k)), 0.0_wp]
      end do
      p(:, 5) = 0.5_wp*(p(:, 4) + p(:, 1))   ! divides one side of the pyramid
      p(:, 6) = [0.0_wp, 0.0_wp, 1.0_wp]
      call build_surface(p, reshape([1, 2, 6, 2, 3, 6, 3, 4, 6, 4, 5, 6, 5, 1, 6], [3, 5]), &
         surface, error)
      call check_no_error(suite, 'a pyramid is a surface', error)
      ! a sum of five products: rounding
      call check_close(suite, 'the pseudo-normal of a tip weighs by angle, not by number', &
         norm2(surface%vertex_normal(:, 6) - [0.0_wp, 0.0_wp, 1.0_wp]), 0.0_wp, 1.0e-15_wp, 0.0_wp)
      k = surface%triangle_edge(2, 1)
      call check_close(suite, 'the pseudo-normal of an edge halves the angle of its triangles', &
         dot_product(surface%edge_normal(:, k), surface%normal(:, 1) - surface%normal(:, 2)), &
         0.0_wp, 1.0e-15_wp, 0.0_wp)
   end subroutine pseudo_normals

   subroutine motion()
      call make_rectangle(crack_plane_t(), [2.0_wp, 1.0_wp], 0.5_wp, x, tri, error)
      call build_surface(x, tri, surface, error)
      surface%up(3, :) = 0.25_wp
      surface%um(3, :) = -0.25_wp
      call refresh_geometry(surface)
      call check(suite, 'opening alone moves no vertex', all(abs(surface%x - x) <= 0.0_wp))
      surface%up(3, :) = x(1, :) + 0.25_wp
      surface%um(3, :) = x(1, :) - 0.25_wp
      call refresh_geometry(surface)
      ! halves and quarters are exact; the area is one square root
      call check(suite, 'the mean of both faces moves the vertices', &
         all(abs(surface%x(3, :) - x(1, :)) <= 0.0_wp))
      call check_close(suite, 'normals and areas follow', surface_area(surface), &
         2.0_wp*sqrt(2.0_wp), 0.0_wp, 1.0e-15_wp)
   end subroutine motion

   !> Vertices beyond x = 0.5 are in a void: they take what stands next to them.
   subroutine void_follows()
      logical, allocatable :: has(:)

      call make_rectangle(crack_plane_t(), [4.0_wp, 1.0_wp], 0.5_wp, x, tri, error)
      call build_surface(x, tri, surface, error)
      has = x(1, :) < 0.25_wp
      where (has)
         surface%up(1, :) = 2.0_wp
         surface%um(2, :) = 3.0_wp
      else where
         surface%up(1, :) = -9.0_wp
      end where
      call fill_void(surface, has)
      ! means of equal numbers
      call check(suite, 'a void follows a uniform displacement exactly', &
         all(abs(surface%up(1, :) - 2.0_wp) <= 0.0_wp) .and. &
         all(abs(surface%um(2, :) - 3.0_wp) <= 0.0_wp))
      surface%up(1, :) = x(2, :)
      call fill_void(surface, has)
      call check(suite, 'a void takes no value beyond those of its neighbours', &
         maxval(abs(surface%up(1, :))) <= 0.5_wp)
      call check(suite, 'material keeps its displacement', &
         all(abs(surface%up(1, :) - x(2, :)) <= 0.0_wp .or. .not. has))
      has = .false.
      surface%up(1, :) = x(2, :)
      call fill_void(surface, has)
      call check(suite, 'a crack that is nowhere in material stays as it is', &
         all(abs(surface%up(1, :) - x(2, :)) <= 0.0_wp))
   end subroutine void_follows

   subroutine messages()
      real(wp) :: raised(3, 5)

      call build_surface(corners, reshape([1, 2, 3, 1, 3, 4, 3, 2, 1], [3, 3]), surface, error)
      call check_error(suite, 'a triangle that is there twice is refused', error, &
         'triangles 1 and 3 have the same three')
      call build_surface(corners(:, 1:4), reshape([1, 2, 3, 1, 4, 3], [3, 2]), surface, error)
      call check_error(suite, 'a triangle turned over is refused', error, &
         'run along their common edge in the same direction')
      raised = corners
      raised(3, 5) = 1
      call build_surface(raised, reshape([1, 2, 3, 1, 3, 4, 3, 1, 5], [3, 3]), surface, error)
      call check_error(suite, 'a third triangle at an edge is refused', error, &
         'is the third at the edge')
      call build_surface(corners, reshape([1, 2, 3, 1, 3, 5], [3, 2]), surface, error)
      call check_error(suite, 'a triangle without area is refused', error, &
         'is degenerate (it has no area)')
      call build_surface(corners, reshape([1, 2, 2], [3, 1]), surface, error)
      call check_error(suite, 'a triangle that names a vertex twice is refused', error, &
         'triangle 1')
      call build_surface(corners, reshape([1, 2, 6], [3, 1]), surface, error)
      call check_error(suite, 'an unknown vertex is refused', error, 'allowed are 1 to 5')
      call build_surface(corners, reshape([1, 2, 3], [3, 1]), surface, error)
      call check_error(suite, 'a vertex without triangle is refused', error, &
         'belongs to no triangle')
      call build_surface(corners(:, :0), reshape([1], [3, 0]), surface, error)
      call check_error(suite, 'a surface without triangles is refused', error, &
         'it has no triangle; at least one')
      call build_surface(reshape([corners, corners + 3.0_wp], [3, 10]), &
         reshape([1, 2, 4, 3, 5, 10, 3, 8, 9, 3, 6, 7], [3, 4]), &
         surface, error)
      call check_error(suite, 'parts that touch at a vertex only are refused', error, &
         'touch at vertex 3')
   end subroutine messages
end program test_surface
