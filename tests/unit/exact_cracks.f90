!> Cracks and particles around their fronts, 8 in a cell of size 1, for tests with exact fields.
module exact_cracks
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_surface, only: build_surface
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_disc, make_rectangle
   use xmpm_front, only: front_test_points, mark_front
   use xmpm_crack, only: crack_t
   use xmpm_samples, only: sample_t, place_sample
   use xmpm_near_tip, only: strain_of
   use near_tip_states, only: near_tip_fields
   use penny_field, only: penny_at
   use running_tip, only: tip_at
   implicit none
   private

   public :: make_penny, make_straight, fill_box, give_penny, give_running

contains

   !> A disc normal to z; its rim is the front.
   subroutine make_penny(centre, a, h, crack)
      real(wp), intent(in) :: centre(3), a, h
      type(crack_t), intent(out) :: crack
      type(crack_plane_t) :: plane
      type(error_t), allocatable :: error
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)

      call set_plane(centre, [1.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 1.0_wp, 0.0_wp], plane, error)
      call make_disc(plane, a, h, x, tri, error)
      call build_surface(x, tri, crack%surface, error)
      call make_front(-huge(1.0_wp), h, crack)
   end subroutine make_penny

   !> A rectangle normal to z that ends at `tip` in a straight front along y.
   subroutine make_straight(tip, length, width, h, crack)
      real(wp), intent(in) :: tip(3)             !! middle of the front
      real(wp), intent(in) :: length, width, h   !! behind the front, along it, of the elements
      type(crack_t), intent(out) :: crack
      type(crack_plane_t) :: plane
      type(error_t), allocatable :: error
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: tri(:, :)

      call set_plane(tip - [0.5_wp*length, 0.0_wp, 0.0_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         [0.0_wp, 1.0_wp, 0.0_wp], plane, error)
      call make_rectangle(plane, [length, width], h, x, tri, error)
      call build_surface(x, tri, crack%surface, error)
      call make_front(tip(1), h, crack)
   end subroutine make_straight

   !> Edges whose test points lie beyond `least` along x are the front.
   subroutine make_front(least, h, crack)
      real(wp), intent(in) :: least, h
      type(crack_t), intent(inout) :: crack
      real(wp), allocatable :: test(:, :)

      call front_test_points(crack%surface, h, test)
      call mark_front(crack%surface, test(1, :) > least, crack%front)
   end subroutine make_front

   !> The particles of a box within reach of the front of a crack normal to z, without a field.
   subroutine fill_box(crack, height, low, high, reach, samples)
      type(crack_t), intent(in) :: crack
      real(wp), intent(in) :: height               !! z of the crack
      real(wp), intent(in) :: low(3), high(3)      !! whole numbers: cells are full
      real(wp), intent(in) :: reach
      type(sample_t), allocatable, intent(out) :: samples(:)
      integer :: ix, iy, iz, n, m(3)
      logical :: inside

      m = nint(2*(high - low))
      allocate (samples(product(m)))
      n = 0
      do iz = 1, m(3)
         do iy = 1, m(2)
            do ix = 1, m(1)
               associate (s => samples(n + 1))
                  s%x = low + 0.5_wp*real([ix, iy, iz], wp) - 0.25_wp
                  s%side = sign(1.0_wp, s%x(3) - height)
                  call place_sample(crack%front, reach, s, inside)
                  s%volume = 0.125_wp
               end associate
               if (inside) n = n + 1
            end do
         end do
      end do
      samples = samples(:n)
   end subroutine fill_box

   !> The field of a penny under tension along z.
   subroutine give_penny(s, centre, a, tension, lambda, mu)
      type(sample_t), intent(inout) :: s
      real(wp), intent(in) :: centre(3), a, tension, lambda, mu
      real(wp) :: gradient(3, 3), poisson
      integer :: i

      s%density = 1
      s%lambda = lambda
      s%mu = mu
      poisson = 0.5_wp*lambda/(lambda + mu)
      call penny_at(s%x - centre, a, tension, 2*mu*(1 + poisson), poisson, s%stress, gradient)
      s%back = -gradient
      do i = 1, 3
         s%back(i, i) = 1 - gradient(i, i)
      end do
      s%work = density_of(s%stress, mu, poisson)
   end subroutine give_penny

   !> Mode I with K = 1 at a straight front along y, at rest or moving along x.
   subroutine give_running(s, tip, speed, lambda, mu, density)
      type(sample_t), intent(inout) :: s
      real(wp), intent(in) :: tip(3), speed, lambda, mu, density
      real(wp) :: gradient(3, 3), second(3), t(6), g(3, 3), unit(6, 3), x, y, poisson

      x = s%x(1) - tip(1)
      y = s%x(3) - tip(3)
      poisson = 0.5_wp*lambda/(lambda + mu)
      if (speed > 0) then
         call tip_at(x, y, speed, lambda, mu, density, gradient, t, second)
      else
         call near_tip_fields(x, y, s%side, mu, poisson, unit, g)
         t = unit(:, 1)
         gradient = 0
         gradient(:, 1) = g(:, 1)
         second = 0
      end if
      s%lambda = lambda
      s%mu = mu
      s%density = density
      ! the field has its second axis along z, its third along -y
      s%stress = [t(1), t(3), t(2), 0.0_wp, 0.0_wp, t(4)]
      s%work = density_of(s%stress, mu, poisson)
      s%back = 0
      s%back(:, 1) = [1 - gradient(1, 1), 0.0_wp, -gradient(2, 1)]
      s%v = -speed*[gradient(1, 1), 0.0_wp, gradient(2, 1)]
      s%rate = 0
      s%rate(:, 1) = -speed*[second(1), 0.0_wp, second(2)]
      s%pull = s%volume*density*speed**2*[second(1), 0.0_wp, second(2)]
   end subroutine give_running

   !> Energy of a stress.
   pure function density_of(stress, mu, poisson) result(w)
      real(wp), intent(in) :: stress(6), mu, poisson
      real(wp) :: w

      w = 0.5_wp*sum(stress*strain_of(stress, mu, poisson)*real([1, 1, 1, 2, 2, 2], wp))
   end function density_of
end module exact_cracks
