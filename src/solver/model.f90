!> Everything that a run is made of.
module xmpm_model
   use xmpm_kinds, only: wp, i8
   use xmpm_communicator, only: comm_t
   use xmpm_halo, only: halo_t
   use xmpm_stage_clock, only: stage_clock_t
   use xmpm_grid, only: grid_t
   use xmpm_sharing, only: sharing_t
   use xmpm_boundary, only: boundary_t
   use xmpm_momentum, only: nodal_work_t
   use xmpm_storage, only: particles_t
   use xmpm_kernels, only: kernels_t
   use xmpm_sided, only: sided_t
   use xmpm_transfer, only: tally_t, bodies_t
   use xmpm_migration, only: outbox_t
   use xmpm_loads, only: load_t
   use xmpm_transfer_loss, only: flip_step_t
   use xmpm_curves, only: curve_t
   use xmpm_crack, only: crack_t
   use xmpm_fracture, only: fracture_t
   use xmpm_growth, only: growth_t
   use xmpm_contact_pairs, only: contact_t
   use xmpm_rigid, only: rigid_t
   implicit none
   private

   public :: model_t, gravity_t, options_t, ledger_t, step_i, force_i

   !> A body force with its course in time.
   type :: gravity_t
      real(wp) :: acceleration(3) = 0   !! [length/time^2]
      type(curve_t) :: curve            !! factor over time
   end type gravity_t

   !> What the deck chose of the method.
   type :: options_t
      real(wp) :: end_time = 0               !! [time]
      integer :: most_steps = huge(1)        !! steps to take at most
      real(wp) :: cfl = 0.5_wp               !! step over cell size / wave speed
      real(wp) :: fixed_step = 0             !! given step, 0 for none [time]
      real(wp) :: viscous = 0                !! nodal damping [1/time]
      real(wp) :: pic = 0                    !! PIC fraction per time [1/time]
      real(wp) :: damped_until = huge(1.0_wp)!! end of the damping [time]
      logical :: xpic = .false.              !! XPIC(2) transfer
      logical :: sharp = .false.             !! inertia corrected for the two transfers
      logical :: strain_first = .false.      !! stress before forces (USF)
      logical :: strain_by_nodes = .false.   !! nodal velocities themselves strain (USL)
      real(wp) :: energy_limit = 0.1_wp      !! error of the balance at which a run is given up
      real(wp) :: smallest_step = 1e-3_wp    !! part of the first step at which a run is given up
      real(wp) :: imbalance = 1.2_wp         !! threshold of repartition
   end type options_t

   !> Energies of this rank; those of the last step stand beside those before it, so that the
   !> balance can be taken at one time although velocities are known half a step later.
   type :: ledger_t
      real(wp) :: time = 0                     !! of the balance [time]
      real(wp) :: kinetic(2) = 0               !! before and after the last step
      real(wp) :: strain(2) = 0                !! stress work, likewise
      real(wp) :: external(2) = 0              !! work of loads, conditions and body forces,
                                               !! likewise
      real(wp) :: damping(2) = 0               !! lost to nodal damping, likewise
      real(wp) :: transfer(2) = 0              !! lost in transfers, likewise
      real(wp) :: seen(2) = 0                  !! lost by what nodes see, while cracks grow,
                                               !! likewise
      real(wp) :: contact(2) = 0               !! lost in contact, likewise
      real(wp) :: kinetic_start = 0            !! at the start, all ranks
      real(wp) :: largest = 0                  !! largest energy so far, the measure of the error
      real(wp) :: unseen_start = 0             !! what no node saw, and lost in transfers, when
                                               !! cracks began to grow, all ranks
   end type ledger_t

   !> A whole run.
   type :: model_t
      type(comm_t) :: comm
      type(options_t) :: options
      type(grid_t) :: grid
      type(particles_t) :: particles
      type(bodies_t) :: bodies
      type(kernels_t) :: kernels
      type(sided_t) :: sided
      type(crack_t), allocatable :: cracks(:)
      type(fracture_t) :: fracture            !! what is wanted at the fronts, and the last values
      type(growth_t), allocatable :: growth(:)   !! of the cracks that grow
      type(contact_t) :: contact              !! of bodies
      type(rigid_t) :: rigid                  !! bodies that do not strain
      logical :: bodies_meet = .false.        !! the deck asks for contact of bodies
      type(load_t), allocatable :: loads(:)
      type(gravity_t), allocatable :: gravity(:)
      type(boundary_t), allocatable :: boundaries(:)
      type(curve_t), allocatable :: boundary_curves(:)   !! of each boundary's value
      type(sharing_t) :: sharing              !! shared rows of ordinary nodes
      type(halo_t) :: halo                    !! all shared rows
      type(outbox_t) :: outbox                !! particles on their way out
      type(nodal_work_t) :: nodal_work        !! of all steps so far, this rank
      type(flip_step_t) :: flip               !! FLIP's step beside that of PIC or XPIC
      real(wp) :: impulses = 0                !! sum of m dv.dv of the nodes, this rank [energy]
      real(wp) :: transfer_loss = 0           !! lost in transfers so far, this rank [energy]
      real(wp) :: seen_loss = 0               !! the part of it that nodes saw, while cracks grow
      type(tally_t) :: tally                  !! of the last step, this rank
      type(ledger_t) :: ledger
      type(stage_clock_t) :: clock
      procedure(step_i), pointer, nopass :: take_step => null()   !! the chosen scheme
      procedure(force_i), pointer, nopass :: further_force => null()   !! on particles, from a
                                                                       !! caller
      integer(i8) :: step = 0                 !! steps taken
      real(wp) :: time = 0                    !! [time]
      real(wp) :: dt = 0                      !! of the present step [time]
      real(wp) :: dt_before = 0               !! of the step before, 0 at the start [time]
      real(wp) :: first_dt = 0                !! of the first step [time]
      real(wp) :: wave_speed = 0              !! fastest wave of all ranks [length/time]
      real(wp) :: speed = 0                   !! fastest particle of all ranks [length/time]
      integer(i8) :: n_particles = 0          !! of all ranks
      real(wp) :: imbalance = 1               !! most particles of a rank over the mean
      logical :: split_again = .true.         !! the split nodes must be found anew
      integer, allocatable :: movers(:)       !! chunks that particles left
      integer :: n_movers = 0                 !! number of them
      integer(i8) :: moved = 0                !! particles that changed bin since the last sort
      logical :: mapped = .false.             !! the rows hold mass, momentum and force of now
      logical :: relaxing = .false.           !! before the start, the force out of balance is
                                              !! wanted
      real(wp) :: force = 0                   !! sum of |m a| of the nodes while relaxing, this rank
   end type model_t

   abstract interface
      !> One step of a scheme.
      subroutine step_i(m, dt)
         import :: model_t, wp
         type(model_t), intent(inout) :: m
         real(wp), intent(in) :: dt   !! [time]
      end subroutine step_i

      !> Body force of the particles of one chunk at a time, beyond what the deck knows.
      pure subroutine force_i(time, x0, force)
         import :: wp
         real(wp), intent(in) :: time          !! [time]
         real(wp), intent(in) :: x0(8, 3)      !! first positions [length]
         real(wp), intent(out) :: force(8, 3)  !! on a mass [length/time^2]
      end subroutine force_i
   end interface
end module xmpm_model
