!> The velocity of the material at the points of moving fronts.
module xmpm_material_drift
   use xmpm_kinds, only: wp
   use xmpm_samples, only: sample_t
   use xmpm_front_points, only: front_points_t
   implicit none
   private

   public :: drift_sums, drift_of

   real(wp), parameter :: reach = 4.0_wp   !! of the mean, in edges of particles: 2 cells at 8 a
                                           !! cell

contains

   !> Sums of this rank over the particles near each point that moves: V (v + C u_,1) and V.
   !>
   !> At the tip v is - C u_,1, singular, plus what is wanted; the mean of v alone would hold a part
   !> of the first.
   pure function drift_sums(samples, points, speed) result(sums)
      type(sample_t), intent(in) :: samples(:)
      type(front_points_t), intent(in) :: points
      real(wp), intent(in) :: speed(:)           !! (n) C [length/time]
      real(wp) :: sums(4, points%n), u1(3)
      integer :: i, m

      sums = 0
      do m = 1, points%n
         if (.not. speed(m) > 0) cycle
         associate (e1 => points%frame(:, 1, m))
            do i = 1, size(samples)
               associate (s => samples(i))
                  if (norm2(s%x - points%x(:, m)) > reach*s%volume**(1/3.0_wp)) cycle
                  u1 = e1 - matmul(points%turn(:, :, m), matmul(s%back, e1))
                  sums(:, m) = sums(:, m) + s%volume*[s%v + speed(m)*u1, 1.0_wp]
               end associate
            end do
         end associate
      end do
   end function drift_sums

   !> The means, 0 where nothing moves or there is no particle.
   pure function drift_of(sums) result(drift)
      real(wp), intent(in) :: sums(:, :)          !! (4,n) of all ranks
      real(wp) :: drift(3, size(sums, 2))         !! [length/time]
      integer :: m

      drift = 0
      do m = 1, size(sums, 2)
         if (sums(4, m) > 0) drift(:, m) = sums(:3, m)/sums(4, m)
      end do
   end function drift_of
end module xmpm_material_drift
