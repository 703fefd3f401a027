!> Where material is around some points: the bins that hold particles, known alike on all ranks.
module xmpm_occupancy
   use xmpm_kinds, only: wp
   use xmpm_hash_map, only: hash_map_t, clear_map, set_value, value_of
   use xmpm_communicator, only: comm_t, max_all
   use xmpm_lattice, only: lattice_t, bin_of, block_of, local_bin, block_key
   use xmpm_blocks, only: local_block
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t
   use xmpm_material_test, only: material_test_t
   implicit none
   private

   public :: occupancy_t, look_around, body_at

   real(wp), parameter :: tie = 1e-6_wp   !! a point so near to a bin is in it [cells]

   !> Bins with their bodies; what was not looked at counts as empty.
   type, extends(material_test_t) :: occupancy_t
      type(lattice_t) :: lattice
      type(hash_map_t) :: body      !! highest body number in each bin that holds particles
   contains
      procedure :: inside => inside_bin
   end type occupancy_t

contains

   !> Look at all bins within some bins of some points. Collective; the points are the same on all
   !> ranks.
   subroutine look_around(occupancy, points, width, comm, grid, p)
      type(occupancy_t), intent(out) :: occupancy
      real(wp), intent(in) :: points(:, :)   !! (3,n) [length]
      integer, intent(in) :: width           !! bins on each side
      type(comm_t), intent(in) :: comm
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      integer, allocatable :: bins(:, :)
      real(wp), allocatable :: body(:)
      integer :: i

      occupancy%lattice = grid%lattice
      call list_bins(grid%lattice, points, width, bins)
      allocate (body(size(bins, 2)))
      do i = 1, size(body)
         body(i) = real(body_in_bin(grid, p, bins(:, i)), wp)
      end do
      call max_all(comm, body)
      call clear_map(occupancy%body, size(body))
      do i = 1, size(body)
         if (body(i) > 0.5_wp) call set_value(occupancy%body, block_key(bins(:, i)), nint(body(i)))
      end do
   end subroutine look_around

   !> All bins around the points, each once.
   subroutine list_bins(lattice, points, width, bins)
      type(lattice_t), intent(in) :: lattice
      real(wp), intent(in) :: points(:, :)
      integer, intent(in) :: width
      integer, allocatable, intent(out) :: bins(:, :)
      type(hash_map_t) :: known
      integer, allocatable :: list(:, :)
      integer :: i, n, a, b, c, place(3)

      allocate (list(3, (2*width + 1)**3*size(points, 2)))
      call clear_map(known, 64*size(points, 2))
      n = 0
      do i = 1, size(points, 2)
         do c = -width, width
            do b = -width, width
               do a = -width, width
                  place = bin_of(lattice, points(:, i)) + [a, b, c]
                  if (value_of(known, block_key(place), 0) > 0) cycle
                  n = n + 1
                  list(:, n) = place
                  call set_value(known, block_key(place), n)
               end do
            end do
         end do
      end do
      bins = list(:, :n)
   end subroutine list_bins

   !> Highest body number among the particles of a bin on this rank, 0 for none.
   pure function body_in_bin(grid, p, bin) result(body)
      type(grid_t), intent(in) :: grid
      type(particles_t), intent(in) :: p
      integer, intent(in) :: bin(3)
      integer :: body, b, c

      body = 0
      b = local_block(grid%blocks, block_of(bin))
      if (b == 0) return
      c = p%head(local_bin(bin), b)
      do while (c > 0)
         if (p%count(c) > 0) body = max(body, p%body(c))
         c = p%next(c)
      end do
   end function body_in_bin

   pure function inside_bin(material, x) result(is)
      class(occupancy_t), intent(in) :: material
      real(wp), intent(in) :: x(3)   !! [length]
      logical :: is

      is = body_at(material, x) > 0
   end function inside_bin

   !> Body at a point, 0 where there is no material. A point between bins belongs to all of them:
   !> bodies end there more often than not, and rounding must not decide.
   pure function body_at(occupancy, x) result(body)
      class(occupancy_t), intent(in) :: occupancy
      real(wp), intent(in) :: x(3)   !! [length]
      integer :: body, a, b, c, low(3), high(3)

      low = bin_of(occupancy%lattice, x - tie*occupancy%lattice%size)
      high = bin_of(occupancy%lattice, x + tie*occupancy%lattice%size)
      body = 0
      do c = low(3), high(3)
         do b = low(2), high(2)
            do a = low(1), high(1)
               body = max(body, value_of(occupancy%body, block_key([a, b, c]), 0))
            end do
         end do
      end do
   end function body_at
end module xmpm_occupancy
