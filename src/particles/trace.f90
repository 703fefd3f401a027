!> The trace of a particle near a crack front: its deformation gradient and the work done on it,
!> which the J integral needs beside the stress.
module xmpm_trace
   use xmpm_kinds, only: wp
   use xmpm_storage, only: particles_t, lanes, n_trace, trace_f, trace_work
   implicit none
   private

   public :: start_trace, follow_chunk

contains

   !> Begin the trace of a particle whose chunk has room for it; one that is traced already goes on.
   pure subroutine start_trace(p, lane, chunk, strain, work)
      type(particles_t), intent(inout) :: p
      integer, intent(in) :: lane, chunk
      real(wp), intent(in) :: strain(6)   !! that goes with the stress now: xx yy zz xy yz xz
      real(wp), intent(in) :: work        !! stored in the particle now [energy]
      real(wp) :: trace(n_trace)
      integer :: first, last

      first = p%trace + 1
      last = p%trace + n_trace
      trace = p%near(lane, first:last, p%attached(chunk))
      if (any(abs(trace(trace_f:trace_f + 8)) > 0)) return
      trace(trace_f:trace_f + 8) = [1 + strain(1), strain(4), strain(6), &
         strain(4), 1 + strain(2), strain(5), strain(6), strain(5), 1 + strain(3)]
      trace(trace_work) = work
      p%near(lane, first:last, p%attached(chunk)) = trace
   end subroutine start_trace

   !> Carry the traces of a chunk through a step: F' = (1 + dt L + (dt L)**2/2) F, exact to second
   !> order, so that a body that turns is not stretched. Lanes without a trace keep F = 0.
   pure subroutine follow_chunk(p, chunk, gradient, dt, work)
      type(particles_t), intent(inout) :: p
      integer, intent(in) :: chunk
      real(wp), intent(in) :: gradient(lanes, 9)   !! L = dv_i/dx_j at 3 (i - 1) + j [1/time]
      real(wp), intent(in) :: dt                   !! [time]
      real(wp), intent(in) :: work(lanes)          !! done on the particles in this step [energy]
      integer :: r

      r = p%attached(chunk)
      call follow_lanes(gradient, dt, p%near(:, p%trace + trace_f:p%trace + trace_f + 8, r))
      p%near(:, p%trace + trace_work, r) = p%near(:, p%trace + trace_work, r) + work
   end subroutine follow_chunk

   !> Deformation gradients of all lanes, column by column of F.
   pure subroutine follow_lanes(l, dt, f)
      real(wp), intent(in) :: l(lanes, 9), dt
      real(wp), intent(inout) :: f(lanes, 9)
      real(wp) :: x, y, z, a, b, c
      integer :: i, j

      do j = 1, 3
         !$omp simd private(x, y, z, a, b, c)
         do i = 1, lanes
            x = f(i, j)
            y = f(i, j + 3)
            z = f(i, j + 6)
            a = l(i, 1)*x + l(i, 2)*y + l(i, 3)*z
            b = l(i, 4)*x + l(i, 5)*y + l(i, 6)*z
            c = l(i, 7)*x + l(i, 8)*y + l(i, 9)*z
            f(i, j) = x + dt*(a + 0.5_wp*dt*(l(i, 1)*a + l(i, 2)*b + l(i, 3)*c))
            f(i, j + 3) = y + dt*(b + 0.5_wp*dt*(l(i, 4)*a + l(i, 5)*b + l(i, 6)*c))
            f(i, j + 6) = z + dt*(c + 0.5_wp*dt*(l(i, 7)*a + l(i, 8)*b + l(i, 9)*c))
         end do
      end do
   end subroutine follow_lanes
end module xmpm_trace
