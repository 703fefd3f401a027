!> How loads and boundary values change with time.
module xmpm_curves
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t, raise, code_usage
   use xmpm_text, only: to_text
   implicit none
   private

   public :: curve_t, step_curve, make_ramp, make_table, curve_value, curve_integral

   !> A factor of time, linear between its points and constant outside.
   type :: curve_t
      real(wp) :: start = 0.0_wp                !! time that the curve counts from [time]
      logical :: from_start = .true.            !! it is 0 before `start`
      real(wp), allocatable :: times(:)         !! (n) since `start`, increasing [time]
      real(wp), allocatable :: values(:)        !! (n) factors [-]; none: 1 throughout
   end type curve_t

contains

   !> 0 before the start, 1 from there on.
   pure function step_curve(start) result(curve)
      real(wp), intent(in) :: start   !! [time]
      type(curve_t) :: curve

      curve%start = start
      allocate (curve%times(1), source=0.0_wp)
      allocate (curve%values(1), source=1.0_wp)
   end function step_curve

   !> 0 before the start, rising linearly to 1 over the time of the rise.
   subroutine make_ramp(curve, rise, start, error)
      type(curve_t), intent(out) :: curve                !! made
      real(wp), intent(in) :: rise                       !! duration, positive [time]
      real(wp), intent(in) :: start                      !! [time]
      type(error_t), allocatable, intent(out) :: error   !! no positive rise

      if (.not. (rise > 0.0_wp .and. ieee_is_finite(rise))) then
         call raise(error, code_usage, 'a ramp has rise = '//to_text(rise)// &
            '; it must be positive (use the curve step for a sudden load)')
         return
      end if
      curve%start = start
      curve%times = [0.0_wp, rise]
      curve%values = [0.0_wp, 1.0_wp]
   end subroutine make_ramp

   !> Linear between the pairs of a table, which count from the start, and constant outside.
   subroutine make_table(curve, pairs, start, error)
      type(curve_t), intent(out) :: curve                !! made
      real(wp), intent(in) :: pairs(:)                   !! (2n) t1 f1 t2 f2 ... [time, -]
      real(wp), intent(in) :: start                      !! shifts the table [time]
      type(error_t), allocatable, intent(out) :: error   !! odd count, or times that do not increase
      integer :: i

      if (size(pairs) == 0 .or. modulo(size(pairs), 2) == 1) then
         call raise(error, code_usage, 'a table takes pairs t1 f1 t2 f2 ..., '// &
            to_text(size(pairs))//' numbers are given')
         return
      end if
      if (.not. all(ieee_is_finite(pairs))) then
         call raise(error, code_usage, 'a table holds a number that is not finite')
         return
      end if
      do i = 3, size(pairs), 2
         if (pairs(i) > pairs(i - 2)) cycle
         call raise(error, code_usage, 'the times of a table must increase, but '// &
            to_text(pairs(i))//' follows '//to_text(pairs(i - 2)))
         return
      end do
      curve%start = start
      curve%from_start = .false.
      curve%times = pairs(1::2)
      curve%values = pairs(2::2)
   end subroutine make_table

   !> The factor at a time.
   pure function curve_value(curve, time) result(value)
      type(curve_t), intent(in) :: curve   !! any curve
      real(wp), intent(in) :: time         !! [time]
      real(wp) :: value                    !! [-]
      real(wp) :: t
      integer :: i

      value = 1.0_wp
      if (.not. allocated(curve%times)) return
      t = time - curve%start
      i = interval_of(curve%times, t)
      if (i == 0) then
         value = merge(0.0_wp, curve%values(1), curve%from_start)
      else if (i == size(curve%times)) then
         value = curve%values(i)
      else
         associate (t1 => curve%times(i), t2 => curve%times(i + 1), &
            f1 => curve%values(i), f2 => curve%values(i + 1))
            value = f1 + (f2 - f1)*((t - t1)/(t2 - t1))
         end associate
      end if
   end function curve_value

   !> The exact integral of the factor between two times.
   pure function curve_integral(curve, from, to) result(integral)
      type(curve_t), intent(in) :: curve   !! any curve
      real(wp), intent(in) :: from         !! [time]
      real(wp), intent(in) :: to           !! [time]
      real(wp) :: integral                 !! [time]

      integral = to - from
      if (allocated(curve%times)) integral = since_first(curve, to) - since_first(curve, from)
   end function curve_integral

   !> Integral from the first point of the curve to a time.
   pure function since_first(curve, time) result(integral)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: time
      real(wp) :: integral
      real(wp) :: t
      integer :: i, last

      t = time - curve%start
      last = interval_of(curve%times, t)
      integral = 0.0_wp
      if (last == 0) then
         integral = (t - curve%times(1))*curve_value(curve, time)
         return
      end if
      do i = 2, last
         integral = integral + 0.5_wp*(curve%values(i - 1) + curve%values(i))* &
            (curve%times(i) - curve%times(i - 1))
      end do
      integral = integral + 0.5_wp*(curve%values(last) + curve_value(curve, time))* &
         (t - curve%times(last))
   end function since_first

   !> Number of points at or before a time, by bisection.
   pure function interval_of(times, t) result(low)
      real(wp), intent(in) :: times(:), t
      integer :: low, high, middle

      low = 0
      high = size(times) + 1
      do while (high - low > 1)
         middle = (low + high)/2
         if (times(middle) <= t) then
            low = middle
         else
            high = middle
         end if
      end do
   end function interval_of
end module xmpm_curves
