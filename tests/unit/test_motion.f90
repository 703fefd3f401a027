!> Velocity and position of lanes, and what is counted on the way.
program test_motion
   use xmpm_kinds, only: wp
   use xmpm_frame, only: frame_t
   use xmpm_storage, only: lanes, c_x, c_v, c_m, c_vol
   use xmpm_motion, only: tally_t, lane_tally_t, reduce_tally, change_velocity, note_motion, &
      move_lanes
   use testing, only: suite_t, check, check_close, finish
   implicit none
   real(wp), parameter :: rounding = 1e-15_wp   !! a few operations on numbers of order one
   integer, parameter :: n = 5                  !! particles in the chunk, the other lanes are empty
   type(suite_t) :: suite

   suite%name = 'motion'
   call test_velocity()
   call test_leaving()
   call finish(suite)

contains

   !> A chunk of a bin at 2 3 4 of width 0.5; particles at its middle.
   subroutine make_chunk(frame, q)
      type(frame_t), intent(out) :: frame
      real(wp), intent(out) :: q(lanes, 14)
      integer :: i

      frame%corner = [2.0_wp, 3.0_wp, 4.0_wp]
      frame%per_size = 2
      q = 0
      do i = 1, 3
         q(:, c_x + i - 1) = frame%corner(i) + 0.25_wp
      end do
      do i = 1, n
         q(i, c_v:c_v + 2) = [1.0_wp, -2.0_wp, 0.5_wp]*real(i, wp)
         q(i, c_m) = 0.1_wp*real(i, wp)
         q(i, c_vol) = 7 - real(i, wp)
      end do
   end subroutine make_chunk

   !> v = keep v + change, m v, m v**2 and the largest speed; empty lanes stay at rest.
   subroutine test_velocity()
      type(frame_t) :: frame
      type(lane_tally_t) :: part, again
      type(tally_t) :: tally
      real(wp) :: q(lanes, 14), before(lanes, 14), value(lanes, 3), v(3), energy, speed2
      integer :: i

      call make_chunk(frame, before)
      q = before
      value = 0.25_wp
      call change_velocity(0.5_wp, q, value, part%kinetic, part%speed2)
      energy = 0
      speed2 = 0
      do i = 1, n
         v = 0.5_wp*before(i, c_v:c_v + 2) + 0.25_wp
         call check_close(suite, 'the velocity is the kept share and the change', &
            norm2(q(i, c_v:c_v + 2) - v), 0.0_wp, rounding, 0.0_wp)
         call check_close(suite, 'the value becomes the momentum', &
            norm2(value(i, :) - before(i, c_m)*v), 0.0_wp, rounding, 0.0_wp)
         energy = energy + 0.5_wp*before(i, c_m)*dot_product(v, v)
         speed2 = max(speed2, dot_product(v, v))
      end do
      call check(suite, 'empty lanes stay at rest', all(abs(q(n + 1:, c_v:c_v + 2)) <= 0) &
         .and. all(abs(value(n + 1:, :)) <= 0))
      call reduce_tally(part, tally)
      call check_close(suite, 'the kinetic energy is that of the particles', &
         tally%kinetic, energy, 0.0_wp, 10*rounding)
      call check_close(suite, 'the largest speed is found', &
         tally%speed2, speed2, 0.0_wp, 10*rounding)
      call note_motion(q, again%kinetic, again%speed2)
      call check_close(suite, 'velocities changed elsewhere count the same', sum(again%kinetic), &
         sum(part%kinetic), 0.0_wp, 10*rounding)
      call check_close(suite, 'and so does their speed', maxval(again%speed2), speed2, 0.0_wp, &
         10*rounding)
   end subroutine test_velocity

   !> One particle leaves through each face in turn; otherwise nobody does.
   subroutine test_leaving()
      type(frame_t) :: frame
      type(lane_tally_t) :: part
      type(tally_t) :: tally
      real(wp) :: q(lanes, 14), start(lanes, 14), value(lanes, 3)
      logical :: left
      integer :: i, side

      call make_chunk(frame, start)
      q = start
      value = 0
      value(n + 1:, :) = 100
      call move_lanes(value, 0.1_wp, frame, q, part%volume, left)
      call check(suite, 'nobody leaves who does not move', .not. left)
      call check(suite, 'empty lanes stay where they are', all(abs(q - start) <= 0))
      call reduce_tally(part, tally)
      call check_close(suite, 'the smallest volume is that of a particle', tally%volume, 2.0_wp, &
         0.0_wp, 0.0_wp)
      do i = 1, 3
         do side = -1, 1, 2
            q = start
            value = 0
            value(2, i) = 2.4_wp*real(side, wp)
            call move_lanes(value, 0.1_wp, frame, q, part%volume, left)
            call check(suite, 'a particle moves within its bin', .not. left .and. &
               abs(q(2, i) - start(2, i) - 0.24_wp*real(side, wp)) < 10*rounding)
            value(2, i) = 0.2_wp*real(side, wp)
            call move_lanes(value, 0.1_wp, frame, q, part%volume, left)
            call check(suite, 'a particle that leaves is noticed', left)
         end do
      end do
   end subroutine test_leaving
end program test_motion
