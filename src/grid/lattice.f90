!> The lattice: cells, nodes, bins and blocks of an unbounded regular grid.
!>
!> A bin collects the particles that touch the same nodes: a cell for linear functions, the cube
!> around a node for GIMP. A block is 4 x 4 x 4 bins; its tile is the cube of nodes that its bins
!> touch.
module xmpm_lattice
   use xmpm_kinds, only: wp, i8
   implicit none
   private

   public :: lattice_t, make_lattice, bin_of, block_of, local_bin, block_key, key_place
   public :: bin_corner, tile_base, stencil_offsets
   public :: linear_shape, gimp_shape, block_width, bins_per_block

   integer, parameter :: linear_shape = 1    !! hat functions, 8 nodes
   integer, parameter :: gimp_shape = 2      !! uniform GIMP, 27 nodes
   integer, parameter :: block_width = 4     !! bins of a block along one direction
   integer, parameter :: bins_per_block = block_width**3

   integer, parameter :: offset = 2**20      !! makes packed block coordinates positive

   !> Geometry of the background grid and of its shape functions.
   type :: lattice_t
      real(wp) :: size = 1            !! cell size h [length]
      real(wp) :: origin(3) = 0       !! place of node 0 0 0 [length]
      integer :: shape = linear_shape !! shape function
      integer :: reach = 2            !! nodes of a stencil along one direction
      integer :: width = 5            !! nodes of a tile along one direction
      integer :: low = 0              !! first node of a bin's stencil, less the bin
   end type lattice_t

contains

   !> A lattice with cells of the given size.
   pure function make_lattice(size, origin, shape) result(lattice)
      real(wp), intent(in) :: size        !! cell size [length]
      real(wp), intent(in) :: origin(3)   !! place of node 0 0 0 [length]
      integer, intent(in) :: shape        !! linear_shape or gimp_shape
      type(lattice_t) :: lattice

      lattice%size = size
      lattice%origin = origin
      lattice%shape = shape
      lattice%reach = merge(2, 3, shape == linear_shape)
      lattice%width = block_width + lattice%reach - 1
      lattice%low = merge(0, -1, shape == linear_shape)
   end function make_lattice

   !> Bin that holds a point.
   pure function bin_of(lattice, x) result(bin)
      type(lattice_t), intent(in) :: lattice
      real(wp), intent(in) :: x(3)   !! [length]
      integer :: bin(3)

      bin = floor((x - bin_corner(lattice, [0, 0, 0]))/lattice%size)
   end function bin_of

   !> Lower corner of a bin [length].
   pure function bin_corner(lattice, bin) result(corner)
      type(lattice_t), intent(in) :: lattice
      integer, intent(in) :: bin(3)
      real(wp) :: corner(3)

      corner = lattice%origin + (real(bin, wp) + 0.5_wp*real(lattice%low, wp))*lattice%size
   end function bin_corner

   !> Block that holds a bin.
   elemental function block_of(bin) result(place)
      integer, intent(in) :: bin
      integer :: place

      place = shifta(bin, 2)
   end function block_of

   !> Number of a bin within its block, 1 to 64.
   pure function local_bin(bin) result(n)
      integer, intent(in) :: bin(3)
      integer :: n

      n = 1 + iand(bin(1), 3) + 4*iand(bin(2), 3) + 16*iand(bin(3), 3)
   end function local_bin

   !> One number for a block's (or any lattice) place, ordered by z, then y, then x.
   pure function block_key(place) result(key)
      integer, intent(in) :: place(3)   !! each between -2**20 and 2**20 - 1
      integer(i8) :: key

      key = ior(int(place(1) + offset, i8), &
         ior(ishft(int(place(2) + offset, i8), 21), ishft(int(place(3) + offset, i8), 42)))
   end function block_key

   !> Place of a key.
   pure function key_place(key) result(place)
      integer(i8), intent(in) :: key
      integer :: place(3)

      place = int(iand([key, ishft(key, -21), ishft(key, -42)], 2_i8**21 - 1)) - offset
   end function key_place

   !> Tile node at the lower corner of the stencil of each bin of a block.
   pure function tile_base(lattice) result(base)
      type(lattice_t), intent(in) :: lattice
      integer :: base(bins_per_block), ix, iy, iz

      do iz = 0, 3
         do iy = 0, 3
            do ix = 0, 3
               base(1 + ix + 4*iy + 16*iz) = 1 + ix + lattice%width*(iy + lattice%width*iz)
            end do
         end do
      end do
   end function tile_base

   !> Tile nodes of a stencil, less its first; x runs fastest.
   pure function stencil_offsets(lattice) result(offsets)
      type(lattice_t), intent(in) :: lattice
      integer, allocatable :: offsets(:)
      integer :: a, b, c, n, w

      allocate (offsets(lattice%reach**3))
      n = 0
      w = lattice%width
      do c = 0, lattice%reach - 1
         do b = 0, lattice%reach - 1
            do a = 0, lattice%reach - 1
               n = n + 1
               offsets(n) = a + w*(b + w*c)
            end do
         end do
      end do
   end function stencil_offsets
end module xmpm_lattice
