!> Which cells a crack crosses and which nodes it splits, from the level sets at the nodes.
!>
!> The nodes of a cell are numbered with x fastest: (0,0,0), (1,0,0), (0,1,0), ... (1,1,1). The
!> extended surface (psi = 0 past the front) leaves a cell through its edges; psi and phi are
!> taken as linear along an edge, so for a plane crack with a straight front phi is largest and
!> smallest on the crossed edges.
module xmpm_cell_rules
   use xmpm_kinds, only: wp
   use xmpm_front, only: beyond_reach
   implicit none
   private

   public :: cell_is_crossed, cell_is_touched, cell_is_completely_cut
   public :: node_is_behind_front, node_is_near_front

   real(wp), parameter :: behind = -0.2_wp   !! phi of the last split node by the rule `node`
                                             !! [cells]
   real(wp), parameter :: near = 1.7_wp   !! phi of the last split node by the rule `graded` [cells]

contains

   !> Whether the extended surface crosses a cell: its nodes lie on both sides (psi = 0 counts as
   !> minus).
   !>
   !> A cell with a node beyond reach is not crossed; the reach must be 1.75 h at least for cells
   !> that the surface itself crosses, and 3 h for those within 1.7 h ahead of the front.
   pure function cell_is_crossed(psi) result(crossed)
      real(wp), intent(in) :: psi(8)   !! at the nodes [length]
      logical :: crossed

      crossed = any(psi > 0.0_wp) .and. .not. all(psi > 0.0_wp) .and. all(psi < beyond_reach)
   end function cell_is_crossed

   !> Rule `cut`: some part of the extended surface inside the cell lies behind the front.
   pure function cell_is_touched(psi, phi) result(touched)
      real(wp), intent(in) :: psi(8)   !! at the nodes [length]
      real(wp), intent(in) :: phi(8)   !! at the nodes [length]
      logical :: touched
      real(wp) :: low, high

      call phi_on_surface(psi, phi, low, high)
      touched = cell_is_crossed(psi) .and. low < 0.0_wp
   end function cell_is_touched

   !> Rule `full`: all of the extended surface inside the cell lies behind the front.
   pure function cell_is_completely_cut(psi, phi) result(cut)
      real(wp), intent(in) :: psi(8)   !! at the nodes [length]
      real(wp), intent(in) :: phi(8)   !! at the nodes [length]
      logical :: cut
      real(wp) :: low, high

      call phi_on_surface(psi, phi, low, high)
      cut = cell_is_crossed(psi) .and. high < 0.0_wp
   end function cell_is_completely_cut

   !> Rule `node`: a node of a crossed cell is split where phi < -0.2 h.
   elemental function node_is_behind_front(phi, h) result(is)
      real(wp), intent(in) :: phi   !! at the node [length]
      real(wp), intent(in) :: h     !! cell size [length]
      logical :: is

      is = phi < behind*h
   end function node_is_behind_front

   !> Rule `graded`: a node of a crossed cell is split where phi < 1.7 h, which the ramp does not
   !> reach.
   elemental function node_is_near_front(phi, h) result(is)
      real(wp), intent(in) :: phi   !! at the node [length]
      real(wp), intent(in) :: h     !! cell size [length]
      logical :: is

      is = phi < near*h
   end function node_is_near_front

   !> Smallest and largest phi where the surface meets the twelve edges of a cell.
   pure subroutine phi_on_surface(psi, phi, low, high)
      real(wp), intent(in) :: psi(8), phi(8)
      real(wp), intent(out) :: low, high
      integer :: axis, a, b, step
      real(wp) :: f, value

      low = huge(low)
      high = -huge(high)
      do axis = 1, 3
         step = 2**(axis - 1)
         do a = 1, 8
            if (btest(a - 1, axis - 1)) cycle
            b = a + step
            if ((psi(a) > 0.0_wp) .eqv. (psi(b) > 0.0_wp)) cycle
            f = psi(a)/(psi(a) - psi(b))
            value = (1.0_wp - f)*phi(a) + f*phi(b)
            low = min(low, value)
            high = max(high, value)
         end do
      end do
   end subroutine phi_on_surface
end module xmpm_cell_rules
