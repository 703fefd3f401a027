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
   use xmpm_storage, only: lanes
   use xmpm_samples, only: sample_t
   use xmpm_cosine_fall, only: cosine_fall
   use xmpm_front_points, only: front_points_t, window_at, direction_at, same_part
   use xmpm_domain_lanes, only: view_t, look, aim, flux_along, strain_along
   implicit none
   private

   public :: domain_sums_t, domain_shape_t, sum_domains, plateau_area, clear_sums
   public :: points_near, sees, profile, full

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
      integer :: sample(lanes) = 0
   end type batch_t

   !> Along e3, in all lanes.
   real(wp), parameter :: along_front(lanes, 3) = spread([0.0_wp, 0.0_wp, 1.0_wp], 1, lanes)

   !> Sums of one point in lanes.
   type :: lane_sums_t
      real(wp), allocatable :: part(:, :, :)   !! (lanes,6,nr) J, four interactions, volume
      real(wp) :: mean(lanes, 9) = 0           !! material (4), along (5)
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
      real(wp) :: reach
      integer :: near(points%n), i, k, n, m

      reach = maxval(shape%radius)
      do m = 1, points%n
         allocate (lane_sums(m)%part(lanes, 6, size(shape%radius)), source=0.0_wp)
      end do
      do i = 1, size(samples)
         if (samples(i)%r >= reach) cycle
         call points_near(front, points, samples(i), shape%reach, near, n)
         do k = 1, n
            m = near(k)
            if (.not. sees(front, points, m, shape%half_width, samples(i))) cycle
            batch(m)%n = batch(m)%n + 1
            batch(m)%sample(batch(m)%n) = i
            if (batch(m)%n < lanes) cycle
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

   !> Whether a sample is in the window of a point and belongs to its part of the front.
   pure function sees(front, points, m, half_width, s)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      integer, intent(in) :: m                !! point
      real(wp), intent(in) :: half_width      !! of the window [length]
      type(sample_t), intent(in) :: s
      logical :: sees

      sees = abs((s%x(1) - points%x(1, m))*points%frame(1, 3, m) &
         + (s%x(2) - points%x(2, m))*points%frame(2, 3, m) &
         + (s%x(3) - points%x(3, m))*points%frame(3, 3, m)) < half_width
      if (sees) sees = same_part(front, points, m, s%edge)
   end function sees

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

   !> Points within reach of a sample's place on the front, along the front to both sides.
   pure subroutine points_near(front, points, s, reach, near, n)
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      type(sample_t), intent(in) :: s
      real(wp), intent(in) :: reach          !! [length]
      integer, intent(inout) :: near(:)      !! filled up to n
      integer, intent(out) :: n
      real(wp) :: d(3)
      integer :: node, edge, way

      n = 0
      do way = 2, 1, -1
         node = front%edge_node(way, s%edge)
         do while (n < size(near))
            d = s%foot - points%x(:, node)
            if (d(1)*d(1) + d(2)*d(2) + d(3)*d(3) > reach*reach) exit
            if (n > 0) then
               if (node == near(1) .and. way == 2) return
               if (way == 1 .and. front%closed(points%chain(node))) then
                  if (any(near(:n) == node)) return
               end if
            end if
            n = n + 1
            near(n) = node
            edge = front%node_edge(way, node)
            if (edge == 0) exit
            node = front%edge_node(way, edge)
         end do
      end do
   end subroutine points_near

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
      real(wp) :: across(lanes, 5), rest(lanes, 6), l(lanes), slope(lanes), fade(lanes)
      real(wp) :: direction(lanes, 3)
      integer :: k

      call look(samples, chosen, points, m, view)
      call window_at(lanes, view%d(:, 3), shape%half_width, l, slope)
      call direction_at(lanes, points, m, view%d, shape%half_width, direction, fade)
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
      real(wp), intent(in) :: r(lanes), inner, outer          !! [length]
      real(wp), intent(in) :: across(lanes, 5), rest(lanes, 6)
      real(wp), intent(inout) :: part(lanes, 6)
      real(wp) :: w(lanes), dw(lanes)
      integer :: k

      call profile(lanes, r, inner, outer, w, dw)
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
      real(wp), intent(in) :: inner, l(lanes)
      real(wp), intent(inout) :: along(lanes, 5)
      real(wp) :: products(lanes, 5), inside(lanes)
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
