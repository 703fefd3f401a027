!> What a step takes out of the energies besides forces: a part of PIC, XPIC, the strain of USL.
!>
!> FLIP would give a particle the velocity b = v + S dv, where dv is the change of the nodes and S
!> interpolates; the transfer gives it c = b - d. The impulse - m d works with the mean of the
!> velocities before and after, as nodal damping does: the loss is the sum of m (v + c).d/2. USL
!> strains with the nodes' own velocity and not with that which the particles bring back to them, k
!> less; that costs the sum over nodes of m dv.k = m dv.dv less that over particles of
!> m S dv.(c - v).
module xmpm_transfer_loss
   use xmpm_kinds, only: wp
   use xmpm_lattice, only: stencil_offsets
   use xmpm_grid, only: grid_t
   use xmpm_storage, only: particles_t, lanes, c_m, c_v
   use xmpm_kernels, only: kernels_t
   use xmpm_sided, only: sided_t
   use xmpm_loads, only: gather_chunk
   implicit none
   private

   public :: flip_step_t, note_flip, loss_of_transfer

   !> The step that FLIP would make, kept until the velocities are known.
   type :: flip_step_t
      real(wp), allocatable :: change(:, :, :)   !! (8,3,chunks) S dv [length/time]
      real(wp) :: kinetic = 0                    !! sum of m v.v/2 [energy]
      real(wp) :: gain = 0                       !! sum of m v.S dv [energy]
   end type flip_step_t

contains

   !> Keep what FLIP would do; fields 5:7 of the rows hold the change of velocity.
   subroutine note_flip(p, half, kernels, sided, grid, flip)
      type(particles_t), intent(in) :: p
      real(wp), intent(in) :: half(:)         !! (bodies) half a particle's width [cells]
      type(kernels_t), intent(in) :: kernels
      type(sided_t), intent(in) :: sided
      type(grid_t), intent(in) :: grid
      type(flip_step_t), intent(inout) :: flip
      integer :: c, offsets(grid%lattice%reach**3)

      if (allocated(flip%change)) then
         if (size(flip%change, 3) < p%n_chunks) deallocate (flip%change)
      end if
      if (.not. allocated(flip%change)) allocate (flip%change(lanes, 3, size(p%count)))
      offsets = stencil_offsets(grid%lattice)
      do c = 1, p%n_chunks
         if (p%count(c) == 0) cycle
         call gather_chunk(p, c, half(p%body(c)), kernels, sided, offsets, grid, 5, &
            flip%change(:, :, c))
      end do
      call sum_up(p, flip%change, flip%kinetic, flip%gain)
   end subroutine note_flip

   !> Sums of m v.v/2 and of m v.change over the particles.
   pure subroutine sum_up(p, change, kinetic, gain)
      type(particles_t), intent(in) :: p
      real(wp), intent(in) :: change(:, :, :)       !! (8,3,chunks)
      real(wp), intent(out) :: kinetic, gain
      real(wp) :: momentum(lanes)
      integer :: c, i

      kinetic = 0
      gain = 0
      do c = 1, p%n_chunks
         if (p%count(c) == 0) cycle
         do i = 1, 3
            momentum = p%q(:, c_m, c)*p%q(:, c_v - 1 + i, c)
            kinetic = kinetic + 0.5_wp*sum(momentum*p%q(:, c_v - 1 + i, c))
            gain = gain + sum(momentum*change(:, i, c))
         end do
      end do
   end subroutine sum_up

   !> Loss of the step, when the particles have their new velocities [energy].
   pure function loss_of_transfer(p, flip, by_nodes, impulses) result(energy)
      type(particles_t), intent(in) :: p
      type(flip_step_t), intent(in) :: flip
      logical, intent(in) :: by_nodes      !! whether the nodes' own velocity strains (USL)
      real(wp), intent(in) :: impulses     !! sum of m dv.dv over the nodes [energy]
      real(wp) :: energy, kinetic, gain

      call sum_up(p, flip%change, kinetic, gain)
      energy = flip%kinetic - kinetic + 0.5_wp*(flip%gain + gain)
      if (by_nodes) energy = energy + impulses - (gain - flip%gain)
   end function loss_of_transfer
end module xmpm_transfer_loss
