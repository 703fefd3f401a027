!> Cells and nodes that a crack cuts, against plane cracks with straight fronts.
program test_cell_rules
   use xmpm_kinds, only: wp
   use xmpm_front, only: beyond_reach, fully_cracked
   use xmpm_cell_rules, only: cell_is_crossed, cell_is_touched, cell_is_completely_cut, &
      node_is_behind_front, node_is_near_front
   use testing, only: suite_t, check, finish
   implicit none
   type(suite_t) :: suite
   real(wp) :: corner(3, 8), psi(8), phi(8)
   integer :: i

   suite%name = 'cell_rules'
   do i = 1, 8
      corner(:, i) = real([ibits(i - 1, 0, 1), ibits(i - 1, 1, 1), ibits(i - 1, 2, 1)], wp)
   end do
   call level_crack()
   call tilted_cracks()
   call through_crack()
   call nodes()
   call finish(suite)

contains

   !> A crack in the plane z = 0.3 with its front at a place along x.
   subroutine level_crack()
      psi = corner(3, :) - 0.3_wp
      phi = corner(1, :) - 0.5_wp
      call check(suite, 'a front inside the cell touches it and does not cut it completely', &
         cell_is_crossed(psi) .and. cell_is_touched(psi, phi) .and. &
         .not. cell_is_completely_cut(psi, phi))
      phi = corner(1, :) - 1.01_wp
      call check(suite, 'a front behind the last face cuts it completely', &
         cell_is_completely_cut(psi, phi))
      phi = corner(1, :) + 0.01_wp
      call check(suite, 'a front before the first face does not touch it', &
         cell_is_crossed(psi) .and. .not. cell_is_touched(psi, phi))
      psi = corner(3, :) + 0.3_wp
      call check(suite, 'a surface below the cell does not cross it', &
         .not. (cell_is_crossed(psi) .or. cell_is_touched(psi, phi) .or. &
         cell_is_completely_cut(psi, phi)))
      psi = corner(3, :)
      call check(suite, 'a surface through the lowest nodes crosses the cell above', &
         cell_is_crossed(psi))
      psi = corner(3, :) - 1.0_wp
      call check(suite, 'and not the cell below', .not. cell_is_crossed(psi))
      psi(3) = beyond_reach
      call check(suite, 'a cell with a node beyond reach is not crossed', &
         .not. cell_is_crossed(psi))
   end subroutine level_crack

   !> Planes in many directions: the verdict is that of many points of the plane inside the cell.
   subroutine tilted_cracks()
      real(wp) :: n(3), e1(3), p(3), origin(3), low, high
      logical :: agrees, met(3)
      integer :: k, m

      agrees = .true.
      met = .false.
      do k = 1, 200
         n = sin([1.1_wp, 2.3_wp, 3.7_wp]*real(k, wp))
         n = n/norm2(n)
         e1 = cos([0.7_wp, 1.9_wp, 3.1_wp]*real(k, wp))
         e1 = e1 - dot_product(e1, n)*n
         e1 = e1/norm2(e1)
         origin = 0.5_wp + 0.5_wp*sin([5.1_wp, 4.7_wp, 6.3_wp]*real(k, wp))
         psi = matmul(n, corner - spread(origin, 2, 8))
         phi = matmul(e1, corner - spread(origin, 2, 8))
         low = huge(low)
         high = -huge(high)
         do m = 1, 20000
            p = origin + 2.0_wp*(fraction_of(m, 0.754877666_wp) - 0.5_wp)*1.8_wp*e1 &
               + 2.0_wp*(fraction_of(m, 0.569840291_wp) - 0.5_wp)*1.8_wp*across(n, e1)
            if (minval(p) < 0.0_wp .or. maxval(p) > 1.0_wp) cycle
            low = min(low, dot_product(p - origin, e1))
            high = max(high, dot_product(p - origin, e1))
         end do
         if (abs(low) < 0.05_wp .or. abs(high) < 0.05_wp) cycle   ! sampled too coarsely to tell
         agrees = agrees .and. (cell_is_touched(psi, phi) .eqv. low < 0.0_wp)
         agrees = agrees .and. (cell_is_completely_cut(psi, phi) .eqv. high < 0.0_wp)
         met = met .or. [low > 0.0_wp, high < 0.0_wp, low < 0.0_wp .and. high > 0.0_wp]
      end do
      call check(suite, 'plane cracks of any direction are judged as their points say', agrees)
      call check(suite, 'cut and uncut cells were met', met(3))
   end subroutine tilted_cracks

   pure function across(n, e1) result(c)
      real(wp), intent(in) :: n(3), e1(3)
      real(wp) :: c(3)

      c = [n(2)*e1(3) - n(3)*e1(2), n(3)*e1(1) - n(1)*e1(3), n(1)*e1(2) - n(2)*e1(1)]
   end function across

   pure function fraction_of(m, step) result(f)
      integer, intent(in) :: m
      real(wp), intent(in) :: step
      real(wp) :: f

      f = modulo(real(m, wp)*step, 1.0_wp)
   end function fraction_of

   subroutine through_crack()
      psi = corner(3, :) - 0.3_wp
      phi = fully_cracked
      call check(suite, 'a crack without front cuts every cell that it crosses completely', &
         cell_is_completely_cut(psi, phi))
      phi(1:4) = 0.1_wp
      call check(suite, 'nodes with and without a front near them can stand in one cell', &
         cell_is_touched(psi, phi))
   end subroutine through_crack

   subroutine nodes()
      call check(suite, 'rule node splits behind -0.2 h', &
         all(node_is_behind_front([-0.21_wp, -0.19_wp, fully_cracked], 1.0_wp) .eqv. &
         [.true., .false., .true.]))
      call check(suite, 'rule graded splits up to 1.7 h', &
         all(node_is_near_front([1.69_wp, 1.71_wp, beyond_reach, fully_cracked]*2.0_wp, &
         2.0_wp) .eqv. &
         [.true., .false., .false., .true.]))
   end subroutine nodes
end program test_cell_rules
