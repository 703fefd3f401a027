!> Rows of the verification case exact-field: what the domain integrals make of exact fields on
!> particles. Columns: method, h, quantity, value, reference, error, limit, cpu_s.
program exact_field
   use xmpm_kinds, only: wp
   use xmpm_text, only: to_text
   use exact_errors, only: errors_t, penny_errors, running_k, worst_velocity_function, worst_places
   implicit none
   real(wp), parameter :: aims(3) = [0.008_wp, 0.005_wp, 0.005_wp]   !! at R = 3 h, 4 h, 5 h

   print '(a)', 'method,h,quantity,value,reference,error,limit,cpu_s'
   call penny()
   call penny_converges()
   call running(0.0_wp, 'at rest')
   call running(0.3_wp, '0.3 c_R')
   call running(0.6_wp, '0.6 c_R')
   call functions()

contains

   !> A penny of 10 cells; h over its radius.
   subroutine penny()
      type(errors_t) :: e
      real(wp) :: began
      integer :: i

      began = seconds()
      call penny_errors(10.0_wp, [3.0_wp, 4.0_wp, 5.0_wp], e)
      do i = 1, 3
         call row('penny', 0.1_wp, 'mean K at R = '//to_text(i + 2)//' h', 1 + e%mean(i), 1.0_wp, &
            abs(e%mean(i)), to_text(aims(i)), seconds() - began)
      end do
      do i = 1, 3
         call row('penny', 0.1_wp, 'worst K at R = '//to_text(i + 2)//' h', 1 + e%worst(i), &
            1.0_wp, e%worst(i), '', seconds() - began)
      end do
   end subroutine penny

   !> At R = a/2; the order in h of the error must be 1 at least.
   subroutine penny_converges()
      real(wp), parameter :: cells(4) = [6.0_wp, 8.0_wp, 12.0_wp, 16.0_wp]
      type(errors_t) :: e
      real(wp) :: began, first, order, all
      integer :: i

      all = seconds()
      first = 0
      do i = 1, size(cells)
         began = seconds()
         call penny_errors(cells(i), cells(i)*[0.3_wp, 0.4_wp, 0.5_wp], e)
         if (i == 1) first = abs(e%mean(3))
         call row('penny', 1/cells(i), 'mean K at R = a/2', 1 + e%mean(3), 1.0_wp, &
            abs(e%mean(3)), '', seconds() - began)
      end do
      order = log(first/abs(e%mean(3)))/log(cells(size(cells))/cells(1))
      call row('penny', 1/cells(size(cells)), 'order of K in h', order, 1.0_wp, &
         max(0.0_wp, 1 - order), '0', seconds() - all)
   end subroutine penny_converges

   !> The worst of five places of a straight front in its cell; h over the radius. The field has no
   !> length of its own, so that more cells in R are smaller cells.
   subroutine running(part, method)
      real(wp), intent(in) :: part                !! speed over the Rayleigh speed
      character(len=*), intent(in) :: method
      real(wp), parameter :: none(3) = 0
      real(wp) :: began, k(3, size(worst_places, 2)), wide(3)
      integer :: i

      began = seconds()
      do i = 1, size(k, 2)
         call running_k(part, worst_places(:, i), none, [3.0_wp, 4.0_wp, 5.0_wp], k(:, i))
      end do
      do i = 1, 3
         call worst_row(method, i + 2, k(i, :), to_text(aims(i)), seconds() - began)
      end do
      began = seconds()
      do i = 1, size(k, 2)
         call running_k(part, worst_places(:, i), none, [6.0_wp, 7.0_wp, 8.0_wp], wide)
         k(:, i) = wide
      end do
      call worst_row(method, 8, k(3, :), to_text(aims(3)), seconds() - began)
   end subroutine running

   subroutine worst_row(method, cells, k, limit, cpu)
      character(len=*), intent(in) :: method, limit
      integer, intent(in) :: cells
      real(wp), intent(in) :: k(:), cpu
      real(wp) :: worst

      worst = k(maxloc(abs(k - 1), 1))
      call row(method, 1/real(cells, wp), 'worst K at R = '//to_text(cells)//' h', worst, 1.0_wp, &
         abs(worst - 1), limit, cpu)
   end subroutine worst_row

   subroutine functions()
      real(wp) :: began, worst

      began = seconds()
      worst = worst_velocity_function()
      call row('A_M', 0.0_wp, 'rest to 0.95 c_R', 1 + worst, 1.0_wp, worst, '1e-12', &
         seconds() - began)
   end subroutine functions

   subroutine row(method, h, quantity, value, reference, error, limit, cpu)
      character(len=*), intent(in) :: method, quantity, limit
      real(wp), intent(in) :: h, value, reference, error, cpu

      print '(15a)', method, ',', to_text(h), ',', quantity, ',', to_text(value), ',', &
         to_text(reference), ',', to_text(error), ',', limit, ',', to_text(cpu)
   end subroutine row

   !> Processor time.
   function seconds() result(t)
      real(wp) :: t

      call cpu_time(t)
   end function seconds
end program exact_field
