!> Cracks and particles around their fronts, 8 in a cell of size 1, for tests with exact fields.
module exact_cracks
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_surface, only: build_surface
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_disc, make_rectangle
   use xmpm_front, only: front_test_points, mark_front
   use xmpm_crack, only: crack_t
   use xmpm_samples, only: sample_t, place_sample
   implicit none
   private

   public :: make_penny, make_straight, fill_box

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
end module exact_cracks
