!> Surfaces that grow in bodies without any mechanics: what the tests of growth share.
module growing_surface
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_surface, only: surface_t, build_surface
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_rectangle
   use xmpm_front, only: front_t
   use xmpm_material_test, only: material_test_t
   use xmpm_front_line, only: front_limits_t
   use xmpm_front_search, only: find_front
   use xmpm_grow_surface, only: grown_t, grow_surface
   implicit none
   private

   public :: tube_t, make_cut, grow_cut

   !> A tube along z, by default without end and without a hole.
   type, extends(material_test_t) :: tube_t
      real(wp) :: inner = -1.0_wp            !! radius of the hole, negative for none
      real(wp) :: outer = 1.0e9_wp           !! radius
      real(wp) :: y(2) = [-1e9_wp, 1e9_wp]   !! faces across y
   contains
      procedure :: inside => inside_tube
   end type tube_t

contains

   pure function inside_tube(material, x) result(is)
      class(tube_t), intent(in) :: material
      real(wp), intent(in) :: x(3)
      logical :: is

      is = norm2(x(1:2)) < material%outer .and. norm2(x(1:2)) > material%inner &
         .and. x(2) > material%y(1) .and. x(2) < material%y(2)
   end function inside_tube

   !> A rectangle of triangles with edges of 1, and its fronts in a body.
   subroutine make_cut(size, centre, along, across, body, surface, front, error)
      real(wp), intent(in) :: size(2), centre(3), along(3), across(3)
      class(material_test_t), intent(in) :: body
      type(surface_t), intent(out) :: surface
      type(front_t), intent(out) :: front
      type(error_t), allocatable, intent(out) :: error
      type(crack_plane_t) :: plane
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)

      call set_plane(centre, along, across, plane, error)
      call make_rectangle(plane, size, 1.0_wp, x, tri, error)
      call build_surface(x, tri, surface, error)
      call find_front(surface, surface%edge(:, surface%boundary), 1.0_wp, body, front)
   end subroutine make_cut

   !> Grow by an advance; the surface and its front are then the new ones.
   subroutine grow_cut(advance, limits, body, surface, front, grown, error)
      real(wp), intent(in) :: advance(:, :)           !! (3,nn)
      type(front_limits_t), intent(in) :: limits
      class(material_test_t), intent(in) :: body
      type(surface_t), intent(inout) :: surface
      type(front_t), intent(inout) :: front
      type(grown_t), intent(out) :: grown
      type(error_t), allocatable, intent(out) :: error
      logical :: waits(size(advance, 2))

      waits = .false.
      call grow_surface(surface, front, advance, waits, limits, body, grown, error)
      if (allocated(error)) return
      surface = grown%surface
      front = grown%front
   end subroutine grow_cut
end module growing_surface
