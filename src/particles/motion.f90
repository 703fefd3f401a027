!> Velocity and position of the lanes of a chunk, and what a step must know of them.
!>
!> Sums and extremes are kept lane by lane, so that nothing is added across lanes in the loops;
!> `reduce_tally` does so once a pass. Empty lanes have no mass and stay where they are.
module xmpm_motion
   use xmpm_kinds, only: wp, i8
   use xmpm_frame, only: frame_t
   use xmpm_storage, only: lanes
   implicit none
   private

   public :: tally_t, lane_tally_t, reduce_tally, change_velocity, note_motion, move_lanes

   !> Sums over particles that a step yields as it goes.
   type :: tally_t
      real(wp) :: kinetic = 0                        !! kinetic energy after the velocity update
      real(wp) :: work = 0                           !! stress work of the step
      real(wp) :: speed2 = 0                         !! largest square of a speed
      real(wp) :: volume = huge(1.0_wp)              !! smallest volume
   end type tally_t

   !> The same, lane by lane.
   type :: lane_tally_t
      real(wp) :: kinetic(lanes) = 0                 !! m v**2
      real(wp) :: work(lanes) = 0                    !! stress work
      real(wp) :: speed2(lanes) = 0                  !! largest square of a speed
      real(wp) :: volume(lanes) = huge(1.0_wp)       !! smallest volume
   end type lane_tally_t

contains

   !> Add the sums of a pass to those of the step.
   pure subroutine reduce_tally(part, tally)
      type(lane_tally_t), intent(in) :: part
      type(tally_t), intent(inout) :: tally

      tally%kinetic = tally%kinetic + 0.5_wp*sum(part%kinetic)
      tally%work = tally%work + sum(part%work)
      tally%speed2 = max(tally%speed2, maxval(part%speed2))
      tally%volume = min(tally%volume, minval(part%volume))
   end subroutine reduce_tally

   !> v = keep v + change (eq. 43); the change becomes the momentum m v.
   pure subroutine change_velocity(keep, q, value, kinetic, speed2)
      real(wp), intent(in) :: keep                  !! share of the old velocity that is kept
      real(wp), intent(inout) :: q(lanes, 14)       !! x v m vol s of the lanes
      real(wp), intent(inout) :: value(lanes, 3)    !! change of velocity, then momentum
      real(wp), intent(inout) :: kinetic(lanes)     !! m v**2 is added
      real(wp), intent(inout) :: speed2(lanes)      !! largest v**2
      real(wp) :: vx, vy, vz, square, there
      integer :: p

      !$omp simd private(vx, vy, vz, square, there)
      do p = 1, lanes
         there = merge(1.0_wp, 0.0_wp, q(p, 7) > 0)
         vx = keep*q(p, 4) + there*value(p, 1)
         vy = keep*q(p, 5) + there*value(p, 2)
         vz = keep*q(p, 6) + there*value(p, 3)
         q(p, 4) = vx
         q(p, 5) = vy
         q(p, 6) = vz
         value(p, 1) = q(p, 7)*vx
         value(p, 2) = q(p, 7)*vy
         value(p, 3) = q(p, 7)*vz
         square = vx*vx + vy*vy + vz*vz
         kinetic(p) = kinetic(p) + q(p, 7)*square
         speed2(p) = max(speed2(p), square)
      end do
   end subroutine change_velocity

   !> Kinetic energy and speed of lanes whose velocity was changed elsewhere.
   pure subroutine note_motion(q, kinetic, speed2)
      real(wp), intent(in) :: q(lanes, 14)          !! x v m vol s of the lanes
      real(wp), intent(inout) :: kinetic(lanes)     !! m v**2 is added
      real(wp), intent(inout) :: speed2(lanes)      !! largest v**2
      real(wp) :: square
      integer :: p

      !$omp simd private(square)
      do p = 1, lanes
         square = q(p, 4)**2 + q(p, 5)**2 + q(p, 6)**2
         kinetic(p) = kinetic(p) + q(p, 7)*square
         speed2(p) = max(speed2(p), square)
      end do
   end subroutine note_motion

   !> Move the lanes of a chunk (eq. 44); tells whether one left the bin.
   pure subroutine move_lanes(value, time, frame, q, volume, left)
      real(wp), intent(in) :: value(lanes, 3)       !! [length/time]
      real(wp), intent(in) :: time                  !! [time]
      type(frame_t), intent(in) :: frame            !! bin of the chunk
      real(wp), intent(inout) :: q(lanes, 14)       !! x v m vol s of the lanes
      real(wp), intent(inout) :: volume(lanes)      !! smallest volume
      logical, intent(out) :: left
      real(wp) :: x, y, z, far, there
      integer(i8) :: n
      integer :: p

      n = 0
      !$omp simd private(x, y, z, far, there) reduction(+:n)
      do p = 1, lanes
         there = merge(1.0_wp, 0.0_wp, q(p, 7) > 0)
         x = q(p, 1) + there*time*value(p, 1)
         y = q(p, 2) + there*time*value(p, 2)
         z = q(p, 3) + there*time*value(p, 3)
         q(p, 1) = x
         q(p, 2) = y
         q(p, 3) = z
         far = max(abs((x - frame%corner(1))*frame%per_size - 0.5_wp), &
            abs((y - frame%corner(2))*frame%per_size - 0.5_wp), &
            abs((z - frame%corner(3))*frame%per_size - 0.5_wp))
         n = n + merge(0_i8, 1_i8, far < 0.5_wp)
         volume(p) = min(volume(p), q(p, 8) + (1 - there)*huge(1.0_wp))
      end do
      left = n > 0
   end subroutine move_lanes
end module xmpm_motion
