!> J at all points and radii by the methods that the deck names.
module xmpm_rates
   use xmpm_kinds, only: wp
   use xmpm_communicator, only: comm_t, sum_all
   use xmpm_front, only: front_t
   use xmpm_samples, only: sample_t
   use xmpm_front_points, only: front_points_t, window_length
   use xmpm_domain_integral, only: domain_shape_t, domain_sums_t
   use xmpm_contour_integral, only: contour_sums_t, clear_contours, sum_moments, fit_circles, &
      sum_circles, contour_rate
   implicit none
   private

   public :: rates_t, find_rates, method_domain, method_contour, method_paper

   integer, parameter :: method_domain = 1    !! sums over particles
   integer, parameter :: method_contour = 2   !! circles, with the term out of their plane
   integer, parameter :: method_paper = 3     !! circles, eq. 49 as it stands

   !> J of one crack's fronts.
   type :: rates_t
      real(wp), allocatable :: length(:)    !! (n) of the window in the material [length]
      real(wp), allocatable :: j(:, :, :)   !! (nr,methods,n) in the deck's order [energy/length^2]
      logical, allocatable :: found(:, :)   !! (nr,n) no method lacks particles
   end type rates_t

contains

   !> J by all methods. Collective.
   subroutine find_rates(methods, comm, samples, front, points, shape, speed, drift, sums, rates)
      integer, intent(in) :: methods(:)
      type(comm_t), intent(in) :: comm
      type(sample_t), intent(in) :: samples(:)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      type(domain_shape_t), intent(in) :: shape
      real(wp), intent(in) :: speed(:)            !! (n) of the front [length/time]
      real(wp), intent(in) :: drift(:, :)         !! (3,n) of the material [length/time]
      type(domain_sums_t), intent(in) :: sums     !! of all ranks
      type(rates_t), intent(out) :: rates
      type(contour_sums_t) :: circles
      integer :: i, k

      rates%length = [(window_length(front, points, i, shape%half_width, shape%reach), &
         i=1, points%n)]
      allocate (rates%j(size(shape%radius), size(methods), points%n))
      allocate (rates%found(size(shape%radius), points%n), source=.true.)
      if (any(methods /= method_domain)) then
         call sum_over_circles(comm, samples, front, points, shape, drift, circles)
         rates%found = circles%found
      end if
      do k = 1, size(methods)
         do i = 1, points%n
            if (methods(k) == method_domain) then
               rates%j(:, k, i) = sums%j(:, i)/rates%length(i)
            else
               call rates_of_circles(circles, i, shape%radius, rates%length(i), &
                  sums%material(:, i), methods(k) == method_paper, speed(i), drift(:, i), &
                  rates%j(:, k, i))
               if (rates%length(i) > 0) rates%j(:, k, i) = rates%j(:, k, i) &
                  + sums%faces(:, i)/rates%length(i)
            end if
         end do
      end do
   end subroutine find_rates

   !> Fits and fields on all circles. Collective.
   subroutine sum_over_circles(comm, samples, front, points, shape, drift, circles)
      type(comm_t), intent(in) :: comm
      type(sample_t), intent(in) :: samples(:)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      type(domain_shape_t), intent(in) :: shape
      real(wp), intent(in) :: drift(:, :)
      type(contour_sums_t), intent(out) :: circles

      call clear_contours(circles, shape%support, size(shape%radius), points%n)
      call sum_moments(samples, front, points, shape, circles)
      call sum_in_place(comm, size(circles%moment), circles%moment)
      call fit_circles(circles)
      call sum_circles(samples, front, points, shape, drift, circles)
      call sum_in_place(comm, size(circles%field), circles%field)
      call sum_in_place(comm, size(circles%area), circles%area)
   end subroutine sum_over_circles

   !> Sum an array of any shape over the ranks.
   subroutine sum_in_place(comm, n, values)
      type(comm_t), intent(in) :: comm
      integer, intent(in) :: n
      real(wp), intent(inout) :: values(n)

      call sum_all(comm, values)
   end subroutine sum_in_place

   !> J of one point at all radii, 0 without particles.
   pure subroutine rates_of_circles(circles, i, radius, length, material, paper, speed, drift, j)
      type(contour_sums_t), intent(in) :: circles
      integer, intent(in) :: i
      real(wp), intent(in) :: radius(:), length, material(4), speed, drift(3)
      logical, intent(in) :: paper
      real(wp), intent(out) :: j(:)
      integer :: r

      j = 0
      if (.not. material(1) > 0) return
      do r = 1, size(radius)
         j(r) = contour_rate(circles, r, i, radius(r), length, material(4)/material(1), paper, &
            speed, drift)
      end do
   end subroutine rates_of_circles
end module xmpm_rates
