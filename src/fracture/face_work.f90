!> What the tractions between the closed faces of a crack add to the domain integrals.
!>
!> With the traction t of contact on the plus face, -t on the minus face and the jump [u] = u+ - u-,
!> the faces within the domain add
!>
!>    - int t_i [u_i],k q_k dA
!>
!> to the sum over the particles, which then has no force of contact in it. Friction takes that much
!> of the energy that flows to the front. The jump is that of the surface itself, linear between its
!> vertices, so that the whole change of it counts, also that next to the front.
module xmpm_face_work
   use xmpm_kinds, only: wp
   use xmpm_front, only: front_t
   use xmpm_samples, only: sample_t, place_sample
   use xmpm_near_tip, only: unit_states
   use xmpm_front_points, only: front_points_t, window_at, direction_at
   use xmpm_domain_integral, only: domain_shape_t, domain_sums_t, list_same_part, sees, &
      profile
   use xmpm_edge_points, only: edge_points_t
   use xmpm_face_points, only: face_points_t
   implicit none
   private

   public :: add_face_work

contains

   !> Add the faces to the sums of all points.
   pure subroutine add_face_work(faces, front, points, shape, sums)
      type(face_points_t), intent(in) :: faces
      type(front_t), intent(in) :: front
      type(front_points_t), intent(in) :: points
      type(domain_shape_t), intent(in) :: shape
      type(domain_sums_t), intent(inout) :: sums   !! of all ranks
      type(sample_t) :: s
      type(edge_points_t), allocatable :: near(:)
      integer :: i, k, m
      logical :: inside

      if (faces%n > 0) call list_same_part(front, points, shape%reach, near)
      do i = 1, faces%n
         if (.not. (faces%area(i) > 0 .and. any(abs(faces%traction(:, i)) > 0))) cycle
         s%x = faces%x(:, i)
         call place_sample(front, maxval(shape%radius), s, inside)
         if (.not. inside) cycle
         do k = 1, size(near(s%edge)%point)
            m = near(s%edge)%point(k)
            if (.not. sums%material(1, m) > 0) cycle
            if (sees(points%x(:, m), points%frame(:, 3, m), shape, s)) call add_point(faces, i, s, &
               points, m, shape, sums)
         end do
      end do
   end subroutine add_face_work

   !> Add one point of the faces to one point of the front.
   pure subroutine add_point(faces, i, s, points, m, shape, sums)
      type(face_points_t), intent(in) :: faces
      integer, intent(in) :: i, m                  !! point of the faces, of the front
      type(sample_t), intent(in) :: s
      type(front_points_t), intent(in) :: points
      type(domain_shape_t), intent(in) :: shape
      type(domain_sums_t), intent(inout) :: sums
      real(wp) :: e(3, 3), d(3), g(1, 3), l(1), slope(1), fade(1), w(1), dw(1), power(4)
      integer :: r

      e = points%frame(:, :, m)
      d = matmul(s%x - points%x(:, m), e)
      call window_at(1, d(3:), shape%half_width, l, slope)
      call direction_at(1, points, m, d, shape%half_width, g, fade)
      associate (t => faces%traction(:, i), rest => sums%material(:, m))
         power(1) = dot_product(t, matmul(faces%slope(:, :, i), matmul(e, g(1, :))))
         power(2:) = g(1, 1)*unit_powers(matmul(t, e), d, rest(3)/rest(1), &
            0.5_wp*rest(2)/(rest(2) + rest(3)), sqrt(faces%area(i)))
      end associate
      power = -faces%area(i)*l(1)*power
      do r = 1, size(shape%radius)
         call profile(1, [s%r], shape%inner, shape%radius(r), w, dw)
         sums%j(r, m) = sums%j(r, m) + w(1)*power(1)
         sums%interaction(:3, r, m) = sums%interaction(:3, r, m) + w(1)*power(2:)
         if (s%r < shape%radius(r)) sums%faces(r, m) = sums%faces(r, m) + power(1)
      end do
   end subroutine add_point

   !> A traction times the jump of u_i,1 of unit modes I to III, behind the front: its mean over
   !> the width of a point, since it goes with 1 over the root of the distance.
   pure function unit_powers(t, d, mu, poisson, width) result(power)
      real(wp), intent(in) :: t(3), d(3)     !! in the frame of the front [stress], [length]
      real(wp), intent(in) :: mu, poisson    !! shear modulus [stress], Poisson's ratio
      real(wp), intent(in) :: width          !! [length]
      real(wp) :: power(3)                   !! [stress/K]
      real(wp) :: plane(2, 6, 3), shear(2, 3), x(2), near, far

      power = 0
      if (.not. d(1) < 0) return
      far = norm2(d(:2)) + 0.5_wp*width
      near = max(far - width, 0.0_wp)
      x = -(0.5_wp*width/(sqrt(far) - sqrt(near)))**2
      call unit_states(2, x, 0*x, [1.0_wp, -1.0_wp], spread(mu, 1, 2), spread(poisson, 1, 2), &
         plane, shear)
      power(:2) = matmul(t(:2), plane(1, 5:, :2) - plane(2, 5:, :2))
      power(3) = t(3)*(shear(1, 3) - shear(2, 3))
   end function unit_powers
end module xmpm_face_work
