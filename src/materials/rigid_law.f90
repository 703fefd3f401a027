!> A body that does not strain: no stress, no change of volume, no limit of the time step.
module xmpm_rigid_law
   use xmpm_kinds, only: wp
   use xmpm_law, only: law_t
   implicit none
   private

   public :: rigid_law_t, new_rigid_law

   !> No stress at all; the solver moves the body as a whole.
   type, extends(law_t) :: rigid_law_t
   contains
      procedure :: update => keep_lanes
      procedure :: wave_speed => no_speed
      procedure :: strain_energy => no_energy
   end type rigid_law_t

contains

   !> A law with the density of a material.
   pure function new_rigid_law(name, density) result(law)
      character(len=*), intent(in) :: name   !! of the material
      real(wp), intent(in) :: density        !! [mass/length^3]
      type(rigid_law_t) :: law

      law%name = name
      law%density = density
   end function new_rigid_law

   !> Nothing changes; the dummies are those of all laws.
   pure subroutine keep_lanes(law, gradient, dt, q, work)
      class(rigid_law_t), intent(in) :: law
      real(wp), intent(in) :: gradient(8, 9)
      real(wp), intent(in) :: dt
      real(wp), intent(inout) :: q(8, 14)
      real(wp), intent(inout) :: work(8)

      if (law%density < 0 .and. dt < 0) work = gradient(:, 1) + q(:, 1)   ! never: all are looked at
   end subroutine keep_lanes

   !> No wave runs in it.
   pure function no_speed(law) result(speed)
      class(rigid_law_t), intent(in) :: law
      real(wp) :: speed

      speed = 0*law%density
   end function no_speed

   !> No energy is stored in it.
   pure function no_energy(law, stress) result(energy)
      class(rigid_law_t), intent(in) :: law
      real(wp), intent(in) :: stress(6)
      real(wp) :: energy

      energy = 0*law%density*stress(1)
   end function no_energy
end module xmpm_rigid_law
