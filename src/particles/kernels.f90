!> The kernels of the chosen shape function.
module xmpm_kernels
   use xmpm_kinds, only: wp
   use xmpm_frame, only: frame_t
   use xmpm_lattice, only: linear_shape
   use xmpm_linear_kernels, only: scatter_linear, push_linear, gather_linear, gradient_linear
   use xmpm_gimp_kernels, only: scatter_gimp, push_gimp, gather_gimp, gradient_gimp
   implicit none
   private

   public :: kernels_t, choose_kernels, tile_nodes

   integer, parameter :: tile_nodes = 216   !! nodes of the largest tile

   abstract interface
      !> Add mass, momentum and internal force of a chunk to fields 1:7 of a tile.
      pure subroutine scatter_i(n, q, frame, tile)
         import :: wp, frame_t
         integer, intent(in) :: n                 !! particles in the chunk
         real(wp), intent(in) :: q(8, 14)         !! x v m vol s of the lanes
         type(frame_t), intent(in) :: frame       !! bin of the chunk
         real(wp), intent(inout) :: tile(8, *)    !! values of the tile's nodes
      end subroutine scatter_i

      !> Add a vector of each particle to the nodes of a tile.
      pure subroutine push_i(n, q, value, frame, tile)
         import :: wp, frame_t
         integer, intent(in) :: n                 !! particles in the chunk
         real(wp), intent(in) :: q(8, 14)         !! x v m vol s of the lanes
         real(wp), intent(in) :: value(8, 3)      !! vector of each lane
         type(frame_t), intent(in) :: frame       !! bin of the chunk
         real(wp), intent(inout) :: tile(4, *)    !! sums of the tile's nodes in 1:3
      end subroutine push_i

      !> Interpolate three fields of a tile to the lanes of a chunk.
      pure subroutine gather_i(q, frame, tile, field, value)
         import :: wp, frame_t
         real(wp), intent(in) :: q(8, 14)         !! x v m vol s of the lanes
         type(frame_t), intent(in) :: frame       !! bin of the chunk
         real(wp), intent(in) :: tile(8, *)       !! values of the tile's nodes
         integer, intent(in) :: field             !! first of the three fields
         real(wp), intent(out) :: value(8, 3)     !! at the particles
      end subroutine gather_i

      !> Gradient of fields 5:7 and value of fields 2:4 at the lanes of a chunk.
      pure subroutine gradient_i(q, frame, tile, gradient, value)
         import :: wp, frame_t
         real(wp), intent(in) :: q(8, 14)         !! x v m vol s of the lanes
         type(frame_t), intent(in) :: frame       !! bin of the chunk
         real(wp), intent(in) :: tile(8, *)       !! values of the tile's nodes
         real(wp), intent(out) :: gradient(8, 9)  !! dv_i/dx_j at 3 (i - 1) + j [1/time]
         real(wp), intent(out) :: value(8, 3)     !! velocity that moves the particles
      end subroutine gradient_i
   end interface

   !> Procedures of one shape function, chosen once.
   type :: kernels_t
      procedure(scatter_i), pointer, nopass :: scatter => null()
      procedure(push_i), pointer, nopass :: push => null()
      procedure(gather_i), pointer, nopass :: gather => null()
      procedure(gradient_i), pointer, nopass :: gradient => null()
   end type kernels_t

contains

   !> Kernels of a shape function.
   function choose_kernels(shape) result(kernels)
      integer, intent(in) :: shape   !! linear_shape or gimp_shape
      type(kernels_t) :: kernels

      if (shape == linear_shape) then
         kernels%scatter => scatter_linear
         kernels%push => push_linear
         kernels%gather => gather_linear
         kernels%gradient => gradient_linear
      else
         kernels%scatter => scatter_gimp
         kernels%push => push_gimp
         kernels%gather => gather_gimp
         kernels%gradient => gradient_gimp
      end if
   end function choose_kernels
end module xmpm_kernels
