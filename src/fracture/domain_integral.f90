!> The domain form of the dynamic J integral and of the interaction integral, as sums over
!> particles.
!>
!> With q = w(r) l(xi) e1, where r is the distance from the front and xi runs along e3 of the point,
!>
!>    G int l e1 . n ds = sum_p { V [s_ij u_i,k - W d_jk] q_k,j + f_i u_i,k q_k }
!>
!> holds for any front, straight or curved, since q is any field that is l e1 on the front and
!> tangent to the faces. f = V s_ij,j is what the nodes say, so that inertia, body forces and
!> damping need no terms of their own (tractions between the faces: xmpm_face_work).
!> For a front that moves at C > 0 the
!> kinetic energy adds - V E q_k,k - V rho v_i v_i,k q_k, v relative to the material at the front
!> (the two cancel in the sum at C = 0, where their quadrature would only add noise).
module xmpm_domain_integral
   use xmpm_kinds, only: wp, pi
   use xmpm_front, only: front_t
   use xmpm_samples, only: sample_t
   use xmpm_cosine_fall, only: cosine_fall
   use xmpm_front_points, only: front_points_t, window_at, direction_at, same_part
   use xmpm_edge_points, only: edge_points_t, list_edge_points
   use xmpm_domain_lanes, only: width, view_t, look, aim, flux_along, strain_along
   implicit none
   private

   public :: domain_sums_t, domain_shape_t, sum_domains, plateau_area, clear_sums
   public :: list_same_part, sees, within, profile, full

   !> The field q.
   type :: domain_shape_t
      real(wp) :: inner = 0                    !! w = 1 up to here [length]
      real(wp), allocatable :: radius(:)       !! (nr) w = 0 from here, ascending [length]
      real(wp) :: half_width = 0               !! of the window along the front [length]
      real(wp) :: reach = 0                    !! particles at parts of the front further away
                                               !! than this do not count [length]
      real(wp) :: support = 0                  !! of the fits on circles [length]
   end type domain_shape_t

   !> Sums of this rank for each point.
   type :: domain_sums_t
      real(wp), allocatable :: j(:, :)               !! (nr,n) J times window length [energy/length]
      real(wp), allocatable :: interaction(:, :, :)  !! (4,nr,n) with unit modes I, II, III and
                                                     !! with a unit line force
      real(wp), allocatable :: faces(:, :)           !! (nr,n) part of J from tractions between the
                                                     !! faces, l without w
      real(wp), allocatable :: volume(:, :)          !! (nr,n) integral of w l [length^3]
      real(wp), allocatable :: material(:, :)        !! (4,n) volume, and it times lambda, mu, rho
      real(wp), allocatable :: along(:, :)           !! (5,n) fit of the strain along the front
   end type domain_sums_t

   !> Samples that wait for a point to see them.
   type :: batch_t
      integer :: n = 0
      integer :: sample(width) = 0
   end type batch_t

   !> Along e3, in all lanes.
   real(wp), parameter :: along_front(width, 3) = spread([0.0_wp, 0.0_wp, 1.0_wp], 1, width)

   !> Sums of one point in lanes.
   type :: lane_sums_t
      real(wp), allocatable :: part(:, :, :)   !! (width,6,nr) J, four interactions, volume
      real(wp) :: mean(width, 9) = 0           !! material (4), along (5)
   end type lane_sums_t

contains

   !> Room for the sums of n points, all 0.
   pure subroutine clear_sums(sums, n_radii, n)
      type(domain_sums_t), intent(out) :: sums
      integer, intent(in) :: n_radii, n

      allocate (sums%j(n_radii, n), sums%interaction(4, n_radii, n), sums%volume(n_radii, n), &
                sums%faces(n_radii, n), sums%material(4, n), sums%along(5, n), source=0.0_wp)
   end subroutine clear_sums

   !> Add all samples to the points near them.
   pure subroutine sum_domains(samples, front, points, shape, speed, drift, sums)
      type(sample_t), intent(in) :: samples(:)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      type(domain_shape_t), intent(in) :: shape
      real(wp), intent(in) :: speed(:)      !! (n) of the front at the points [length/time]
      real(wp), intent(in) :: drift(:, :)   !! (3,n) velocity of the material there [length/time]
      type(domain_sums_t), intent(inout) :: sums
      type(batch_t) :: batch(points%n)
      type(lane_sums_t) :: lane_sums(points%n)
      type(edge_points_t), allocatable :: near(:)
      real(wp) :: x(3, points%n), e3(3, points%n), largest
      integer :: i, k, m, edge

      x = points%x
      e3 = points%frame(:, 3, :)
      largest = maxval(shape%radius)
      call list_same_part(front, points, shape%reach, near)
      do m = 1, points%n
         allocate (lane_sums(m)%part(width, 6, size(shape%radius)), source=0.0_wp)
      end do
      do i = 1, size(samples)
         if (samples(i)%r >= largest) cycle
         edge = samples(i)%edge
         do k = 1, size(near(edge)%point)
            m = near(edge)%point(k)
            if (.not. sees(x(:, m), e3(:, m), shape, samples(i))) cycle
            batch(m)%n = batch(m)%n + 1
            batch(m)%sample(batch(m)%n) = i
            if (batch(m)%n < width) cycle
            call add_batch(samples, batch(m)%sample, points, m, shape, speed(m), drift(:, m), &
               lane_sums(m))
            batch(m)%n = 0
         end do
      end do
      do m = 1, points%n
         if (batch(m)%n > 0) call add_batch(samples, batch(m)%sample(:batch(m)%n), points, m, &
            shape, speed(m), drift(:, m), lane_sums(m))
         call add_lane_sums(lane_sums(m), m, sums)
      end do
   end subroutine sum_domains

   !> Points within reach of each edge that look at the part of the front to which it belongs.
   pure subroutine list_same_part(front, points, reach, near)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      real(wp), intent(in) :: reach                               !! [length]
      type(edge_points_t), allocatable, intent(out) :: near(:)    !! (edges)
      integer, allocatable :: list(:)
      integer :: edge, k

      call list_edge_points(front, points, reach, near)
      do edge = 1, size(near)
         list = near(edge)%point
         near(edge)%point = pack(list, [(same_part(front, points, list(k), edge), k=1, size(list))])
      end do
   end subroutine list_same_part

   !> Whether a sample is in the window of a point, and its part of the front within reach.
   pure function sees(x, e3, shape, s)
      real(wp), intent(in) :: x(3), e3(3)     !! the point and the front's direction there
      type(domain_shape_t), intent(in) :: shape
      type(sample_t), intent(in) :: s
      logical :: sees

      sees = abs((s%x(1) - x(1))*e3(1) + (s%x(2) - x(2))*e3(2) + (s%x(3) - x(3))*e3(3)) &
         < shape%half_width
      if (sees) sees = within(x, s%foot, shape%reach)
   end function sees

   !> Whether two places are within reach of each other.
   pure function within(a, b, reach)
      real(wp), intent(in) :: a(3), b(3), reach   !! [length]
      logical :: within

      within = (a(1) - b(1))**2 + (a(2) - b(2))**2 + (a(3) - b(3))**2 <= reach*reach
   end function within

   !> Sums over the lanes of one point.
   pure subroutine add_lane_sums(lane_sums, m, sums)
      type(lane_sums_t), intent(in) :: lane_sums
      integer, intent(in) :: m
      type(domain_sums_t), intent(inout) :: sums
      real(wp) :: part(6, size(sums%j, 1))

      part = sum(lane_sums%part, dim=1)
      sums%j(:, m) = sums%j(:, m) + part(1, :)
      sums%interaction(:, :, m) = sums%interaction(:, :, m) + part(2:5, :)
      sums%volume(:, m) = sums%volume(:, m) + part(6, :)
      sums%material(:, m) = sums%material(:, m) + sum(lane_sums%mean(:, :4), dim=1)
      sums%along(:, m) = sums%along(:, m) + sum(lane_sums%mean(:, 5:), dim=1)
   end subroutine add_lane_sums

   !> Add samples to one point.
   pure subroutine add_batch(samples, chosen, points, m, shape, speed, drift, lane_sums)
      type(sample_t), intent(in) :: samples(:)
      integer, intent(in) :: chosen(:)              !! one for each lane, or less
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: m
      type(domain_shape_t), intent(in) :: shape
      real(wp), intent(in) :: speed, drift(3)
      type(lane_sums_t), intent(inout) :: lane_sums
      type(view_t) :: view
      real(wp) :: across(width, 5), rest(width, 6), l(width), slope(width), fade(width)
      real(wp) :: direction(width, 3)
      integer :: k

      call look(samples, chosen, points, m, view)
      call window_at(width, view%d(:, 3), shape%half_width, l, slope)
      call direction_at(width, points, m, view%d, shape%half_width, direction, fade)
      rest = 0
      if (any(abs(fade) > 0)) then
         do k = 1, 3
            view%g(:, k) = points%outward(k, m)
         end do
         call aim(samples, chosen, points, m, speed, drift, view)
         call flux_along(view, view%g, across)
         do k = 1, 5
            rest(:, k) = l*fade*view%volume*across(:, k)
         end do
      end if
      view%g = direction
      call aim(samples, chosen, points, m, speed, drift, view)
      call flux_along(view, along_front, across)
      do k = 1, 5
         rest(:, k) = rest(:, k) + view%volume*slope*across(:, k) + l*view%source(:, k)
      end do
      rest(:, 6) = view%volume*l
      call flux_along(view, view%away, across)
      do k = 1, 5
         across(:, k) = rest(:, 6)*across(:, k)
      end do
      do k = 1, size(shape%radius)
         call add_radius(view%r, shape%inner, shape%radius(k), across, rest, &
            lane_sums%part(:, :, k))
      end do
      lane_sums%mean(:, :4) = lane_sums%mean(:, :4) + view%mean
      call add_strains(view, points, m, shape%inner, l, lane_sums%mean(:, 5:))
   end subroutine add_batch

   !> Add what counts within one radius.
   pure subroutine add_radius(r, inner, outer, across, rest, part)
      real(wp), intent(in) :: r(width), inner, outer          !! [length]
      real(wp), intent(in) :: across(width, 5), rest(width, 6)
      real(wp), intent(inout) :: part(width, 6)
      real(wp) :: w(width), dw(width)
      integer :: k

      call profile(width, r, inner, outer, w, dw)
      do k = 1, 5
         part(:, k) = part(:, k) + dw*across(:, k) + w*rest(:, k)
      end do
      part(:, 6) = part(:, 6) + w*rest(:, 6)
   end subroutine add_radius

   !> Add the samples within the inner radius to the fit of the strain along the front.
   pure subroutine add_strains(view, points, m, inner, l, along)
      type(view_t), intent(in) :: view
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: m
      real(wp), intent(in) :: inner, l(width)
      real(wp), intent(inout) :: along(width, 5)
      real(wp) :: products(width, 5), inside(width)
      integer :: k

      if (.not. minval(view%r) < inner) return
      inside = merge(l, 0.0_wp, view%r < inner)
      call strain_along(view, points, m, inner, products)
      do k = 1, 5
         along(:, k) = along(:, k) + inside*products(:, k)
      end do
   end subroutine add_strains

   !> w and dw/dr at n places: 1 up to the inner radius, then a cosine to 0 at the outer one.
   pure subroutine profile(n, r, inner, outer, w, dw)
      integer, intent(in) :: n
      real(wp), intent(in) :: r(n), inner, outer   !! [length]
      real(wp), intent(out) :: w(n), dw(n)         !! 0 to 1, [1/length]

      call cosine_fall(n, (r - inner)/(outer - inner), w, dw)
      dw = dw/(outer - inner)
   end subroutine profile

   !> Integral of w over the plane normal to a front: what the volume is over the window length.
   pure function plateau_area(inner, outer) result(area)
      real(wp), intent(in) :: inner, outer   !! [length]
      real(wp) :: area, d                    !! [length^2]

      d = outer - inner
      area = pi*inner**2 + pi*(inner*d + d*d*(0.5_wp - 2/pi**2))
   end function plateau_area

   !> A symmetric tensor from its components 11 22 33 12 23 13.
   pure function full(s) result(t)
      real(wp), intent(in) :: s(6)
      real(wp) :: t(3, 3)

      t(:, 1) = [s(1), s(4), s(6)]
      t(:, 2) = [s(4), s(2), s(5)]
      t(:, 3) = [s(6), s(5), s(3)]
   end function full
end module xmpm_domain_integral
