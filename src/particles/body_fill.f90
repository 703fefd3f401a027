!> Particles of a body: the cells of a regular sub-lattice, and what the surface leaves of them.
!>
!> A sub-cell inside the body is one particle at its centre. One that is cut is a particle with
!> the volume and the centroid of its part inside, so that mass, centre of mass and spin are those
!> of the body. A part below 1 % joins the parts of its neighbours and takes its volume and moment
!> there: nothing is lost. What a sub-cell becomes depends on the body near it alone, never on the
!> blocks in which the caller asks.
module xmpm_body_fill
   use xmpm_kinds, only: wp
   use xmpm_geometry, only: geometry_t, region_of
   use xmpm_cut_cell, only: cut_cell
   use xmpm_primitive, only: region_out, region_cut, region_in
   implicit none
   private

   public :: sub_lattice_t, fill_bins, count_in_bins, cell_range

   real(wp), parameter :: least_part = 0.01_wp*(1.0_wp - 1.0e-6_wp)   !! smallest that stands alone
   real(wp), parameter :: whole_part = 1.0_wp - 1.0e-9_wp             !! taken for the whole

   !> Where cells and their sub-cells lie: cell c fills origin + c*spacing to the next.
   type :: sub_lattice_t
      real(wp) :: origin(3) = 0.0_wp   !! (3) corner of cell 0 0 0 [length]
      real(wp) :: spacing = 1.0_wp     !! edge of a cell [length]
      integer :: per_direction = 2     !! sub-cells a cell and direction
   end type sub_lattice_t

   !> Parts of the sub-cells of a region and of two layers around it, found when asked for.
   type :: parts_t
      real(wp), allocatable :: part(:, :, :)        !! 0 to 1; negative: not yet known
      real(wp), allocatable :: moment(:, :, :, :)   !! (3,:,:,:) about the centre, in units of edges
   end type parts_t

contains

   !> Particles of a body in a box of cells: cell by cell, x fastest, and so in each cell.
   pure subroutine fill_bins(g, lattice, low_cell, high_cell, x, volume)
      type(geometry_t), intent(in) :: g                 !! the body
      type(sub_lattice_t), intent(in) :: lattice        !! cells and sub-cells
      integer, intent(in) :: low_cell(3)                !! (3) first cell
      integer, intent(in) :: high_cell(3)               !! (3) last cell
      real(wp), allocatable, intent(out) :: x(:, :)     !! (3,n) positions [length]
      real(wp), allocatable, intent(out) :: volume(:)   !! (n) volumes [length^3]
      type(parts_t) :: parts
      integer :: n, region, room, i, j, k

      region = region_of_cells(g, lattice, low_cell, high_cell, 0.0_wp)
      room = 0
      if (region /= region_out) room = lattice%per_direction**3*product(high_cell - low_cell + 1)
      allocate (x(3, room), volume(room))
      n = 0
      if (region == region_out) return
      if (region == region_cut) call forget_parts(parts, lattice%per_direction, low_cell, high_cell)
      do k = low_cell(3), high_cell(3)
         do j = low_cell(2), high_cell(2)
            do i = low_cell(1), high_cell(1)
               if (region == region_cut) then
                  call fill_cell(g, lattice, parts, [i, j, k], x, volume, n)
               else
                  call fill_whole_cell(lattice, [i, j, k], x, volume, n)
               end if
            end do
         end do
      end do
      if (n == room) return
      x = x(:, :n)
      volume = volume(:n)
   end subroutine fill_bins

   !> Number of particles that fill_bins would make.
   pure function count_in_bins(g, lattice, low_cell, high_cell) result(n)
      type(geometry_t), intent(in) :: g            !! the body
      type(sub_lattice_t), intent(in) :: lattice   !! cells and sub-cells
      integer, intent(in) :: low_cell(3)           !! (3) first cell
      integer, intent(in) :: high_cell(3)          !! (3) last cell
      integer :: n
      real(wp), allocatable :: x(:, :), volume(:)

      if (region_of_cells(g, lattice, low_cell, high_cell, 0.0_wp) == region_in) then
         n = lattice%per_direction**3*product(high_cell - low_cell + 1)
      else
         call fill_bins(g, lattice, low_cell, high_cell, x, volume)
         n = size(volume)
      end if
   end function count_in_bins

   !> The cells that bounds reach into, touching not counted.
   pure subroutine cell_range(g, lattice, low_cell, high_cell)
      type(geometry_t), intent(in) :: g            !! the body
      type(sub_lattice_t), intent(in) :: lattice   !! cells and sub-cells
      integer, intent(out) :: low_cell(3)          !! (3) first cell
      integer, intent(out) :: high_cell(3)         !! (3) last cell; below the first: none

      low_cell = floor((g%low + g%tolerance - lattice%origin)/lattice%spacing)
      high_cell = ceiling((g%high - g%tolerance - lattice%origin)/lattice%spacing) - 1
   end subroutine cell_range

   !> Where a box of cells, widened by some sub-cells, lies: see region_of.
   pure function region_of_cells(g, lattice, low_cell, high_cell, margin) result(region)
      type(geometry_t), intent(in) :: g
      type(sub_lattice_t), intent(in) :: lattice
      integer, intent(in) :: low_cell(3), high_cell(3)
      real(wp), intent(in) :: margin
      integer :: region, cuts, last
      real(wp) :: low(3), high(3)

      region = region_out
      if (any(high_cell < low_cell)) return
      low = lattice%origin + lattice%spacing*real(low_cell, wp) - margin*edge_of(lattice)
      high = lattice%origin + lattice%spacing*real(high_cell + 1, wp) + margin*edge_of(lattice)
      call region_of(g, 0.5_wp*(low + high), 0.5_wp*(high - low), region, cuts, last)
   end function region_of_cells

   pure subroutine forget_parts(parts, per_direction, low_cell, high_cell)
      type(parts_t), intent(out) :: parts
      integer, intent(in) :: per_direction, low_cell(3), high_cell(3)
      integer :: low(3), high(3)

      low = per_direction*low_cell - 2
      high = per_direction*(high_cell + 1) + 1
      allocate (parts%part(low(1):high(1), low(2):high(2), low(3):high(3)), source=-1.0_wp)
      allocate (parts%moment(3, low(1):high(1), low(2):high(2), low(3):high(3)))
   end subroutine forget_parts

   !> Add the particles of one cell that the surface may cut.
   pure subroutine fill_cell(g, lattice, parts, cell, x, volume, n)
      type(geometry_t), intent(in) :: g
      type(sub_lattice_t), intent(in) :: lattice
      type(parts_t), intent(inout) :: parts
      integer, intent(in) :: cell(3)
      real(wp), intent(inout) :: x(:, :), volume(:)
      integer, intent(inout) :: n
      integer :: i, j, k, s(3), region
      real(wp) :: edge, part, moment(3)

      region = region_of_cells(g, lattice, cell, cell, 1.0_wp)
      if (region == region_in) call fill_whole_cell(lattice, cell, x, volume, n)
      if (region /= region_cut) return
      edge = edge_of(lattice)
      do k = 0, lattice%per_direction - 1
         do j = 0, lattice%per_direction - 1
            do i = 0, lattice%per_direction - 1
               s = lattice%per_direction*cell + [i, j, k]
               call particle_of(g, lattice, parts, s, part, moment)
               if (part <= 0.0_wp) cycle
               n = n + 1
               x(:, n) = centre_of(lattice, s) + edge*moment/part
               volume(n) = part*edge**3
            end do
         end do
      end do
   end subroutine fill_cell

   pure subroutine fill_whole_cell(lattice, cell, x, volume, n)
      type(sub_lattice_t), intent(in) :: lattice
      integer, intent(in) :: cell(3)
      real(wp), intent(inout) :: x(:, :), volume(:)
      integer, intent(inout) :: n
      integer :: i, j, k
      real(wp) :: part

      part = edge_of(lattice)**3
      do k = 0, lattice%per_direction - 1
         do j = 0, lattice%per_direction - 1
            do i = 0, lattice%per_direction - 1
               n = n + 1
               x(:, n) = centre_of(lattice, lattice%per_direction*cell + [i, j, k])
               volume(n) = part
            end do
         end do
      end do
   end subroutine fill_whole_cell

   pure function edge_of(lattice) result(edge)
      type(sub_lattice_t), intent(in) :: lattice
      real(wp) :: edge

      edge = lattice%spacing/real(lattice%per_direction, wp)
   end function edge_of

   pure function centre_of(lattice, s) result(x)
      type(sub_lattice_t), intent(in) :: lattice
      integer, intent(in) :: s(3)
      real(wp) :: x(3)

      x = lattice%origin + (0.5_wp*edge_of(lattice))*real(2*s + 1, wp)
   end function centre_of

   !> What a sub-cell ends up with: its own part and its shares of the slivers around it.
   pure subroutine particle_of(g, lattice, parts, s, part, moment)
      type(geometry_t), intent(in) :: g
      type(sub_lattice_t), intent(in) :: lattice
      type(parts_t), intent(inout) :: parts
      integer, intent(in) :: s(3)                !! the sub-cell
      real(wp), intent(out) :: part              !! volume over that of a sub-cell; 0: no particle
      real(wp), intent(out) :: moment(3)         !! (3) of it about the centre, in units of edges
      integer :: i, j, k, t(3), class
      real(wp) :: own, sliver, share, total

      call find_part(g, lattice, parts, s)
      own = parts%part(s(1), s(2), s(3))
      part = own
      if (own <= 0.0_wp) return
      moment = parts%moment(:, s(1), s(2), s(3))
      if (own < least_part) then
         call find_takers(g, lattice, parts, s, class, total)
         if (class > 0) part = 0.0_wp
         return
      end if
      do k = -1, 1
         do j = -1, 1
            do i = -1, 1
               t = s + [i, j, k]
               call find_part(g, lattice, parts, t)
               sliver = parts%part(t(1), t(2), t(3))
               if (sliver <= 0.0_wp .or. sliver >= least_part) cycle
               call find_takers(g, lattice, parts, t, class, total)
               if (sum(abs(t - s)) /= class) cycle
               share = own/total
               part = part + share*sliver
               moment = moment + share*(parts%moment(:, t(1), t(2), t(3)) + sliver*real(t - s, wp))
            end do
         end do
      end do
   end subroutine particle_of

   !> Who takes a sliver: the nearest class of neighbours (1 over a face, 2 an edge, 3 a corner) of
   !> which any stands alone, each in proportion to its part; class 0: nobody.
   pure subroutine find_takers(g, lattice, parts, s, class, total)
      type(geometry_t), intent(in) :: g
      type(sub_lattice_t), intent(in) :: lattice
      type(parts_t), intent(inout) :: parts
      integer, intent(in) :: s(3)        !! sub-cell of the sliver
      integer, intent(out) :: class      !! 0 to 3
      real(wp), intent(out) :: total     !! parts of the takers
      real(wp) :: totals(3), part
      integer :: i, j, k, distance

      totals = 0.0_wp
      do k = -1, 1
         do j = -1, 1
            do i = -1, 1
               distance = abs(i) + abs(j) + abs(k)
               if (distance == 0) cycle
               call find_part(g, lattice, parts, s + [i, j, k])
               part = parts%part(s(1) + i, s(2) + j, s(3) + k)
               if (part >= least_part) totals(distance) = totals(distance) + part
            end do
         end do
      end do
      total = 0.0_wp
      do class = 1, 3
         total = totals(class)
         if (total > 0.0_wp) return
      end do
      class = 0
   end subroutine find_takers

   !> Make sure that the part of a sub-cell is known.
   pure subroutine find_part(g, lattice, parts, s)
      type(geometry_t), intent(in) :: g
      type(sub_lattice_t), intent(in) :: lattice
      type(parts_t), intent(inout) :: parts
      integer, intent(in) :: s(3)
      real(wp) :: edge, half(3), volume, moment(3)

      if (parts%part(s(1), s(2), s(3)) >= 0.0_wp) return
      edge = edge_of(lattice)
      half = 0.5_wp*edge
      call cut_cell(g, centre_of(lattice, s), half, volume, moment)
      if (volume >= whole_part*edge**3) then
         volume = edge**3
         moment = 0.0_wp
      end if
      parts%part(s(1), s(2), s(3)) = volume/edge**3
      parts%moment(:, s(1), s(2), s(3)) = moment/edge**4
   end subroutine find_part
end module xmpm_body_fill
