!> The trace of a particle near a crack front: its deformation gradient and the work done on it,
!> which the J integral needs beside the stress.
module xmpm_trace
   use xmpm_kinds, only: wp
   use xmpm_storage, only: particles_t, lanes, trace_f, trace_work
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

      associate (trace => p%near(lane, p%trace + 1:, p%attached(chunk)))
         if (any(abs(trace(trace_f:trace_f + 8)) > 0)) return
         trace(trace_f:trace_f + 8) = [1 + strain(1), strain(4), strain(6), &
            strain(4), 1 + strain(2), strain(5), strain(6), strain(5), 1 + strain(3)]
         trace(trace_work) = work
      end associate
   end subroutine start_trace

   !> Carry the traces of a chunk through a step: F' = (1 + dt L + (dt L)**2/2) F, exact to second
   !> order, so that a body that turns is not stretched. Lanes without a trace keep F = 0.
   pure subroutine follow_chunk(p, chunk, gradient, dt, work)
      type(particles_t), intent(inout) :: p
      integer, intent(in) :: chunk
      real(wp), intent(in) :: gradient(lanes, 9)   !! L = dv_i/dx_j at 3 (i - 1) + j [1/time]
      real(wp), intent(in) :: dt                   !! [time]
      real(wp), intent(in) :: work(lanes)          !! done on the particles in this step [energy]
      real(wp) :: l(3, 3), f(3, 3), lf(3, 3)
      integer :: i

      associate (trace => p%near(:, p%trace + 1:, p%attached(chunk)))
         do i = 1, p%count(chunk)
            l = dt*transpose(reshape(gradient(i, :), [3, 3]))
            f = transpose(reshape(trace(i, trace_f:trace_f + 8), [3, 3]))
            lf = matmul(l, f)
            f = f + lf + 0.5_wp*matmul(l, lf)
            trace(i, trace_f:trace_f + 8) = reshape(transpose(f), [9])
            trace(i, trace_work) = trace(i, trace_work) + work(i)
         end do
      end associate
   end subroutine follow_chunk
end module xmpm_trace
