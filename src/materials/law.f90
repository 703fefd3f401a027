!> What the solver asks of a constitutive law. A new law is one file that extends law_t.
module xmpm_law
   use xmpm_kinds, only: wp
   implicit none
   private

   public :: law_t

   !> A constitutive law with its parameters.
   type, abstract :: law_t
      character(len=:), allocatable :: name   !! of the material
      real(wp) :: density = 0                 !! at rest [mass/length^3]
   contains
      procedure(update_i), deferred :: update
      procedure(speed_i), deferred :: wave_speed
      procedure(energy_i), deferred :: strain_energy
   end type law_t

   abstract interface
      !> Carry stress and volume of a chunk through one step.
      pure subroutine update_i(law, gradient, dt, q, work)
         import :: law_t, wp
         class(law_t), intent(in) :: law
         real(wp), intent(in) :: gradient(8, 9)   !! dv_i/dx_j at 3 (i - 1) + j [1/time]
         real(wp), intent(in) :: dt               !! [time]
         real(wp), intent(inout) :: q(8, 14)      !! x v m vol s of the lanes
         real(wp), intent(inout) :: work(8)       !! stress power times dt is added [energy]
      end subroutine update_i

      !> Speed of the fastest wave, for the step limit [length/time].
      pure function speed_i(law) result(speed)
         import :: law_t, wp
         class(law_t), intent(in) :: law
         real(wp) :: speed
      end function speed_i

      !> Elastic energy per volume that goes with a stress [stress].
      pure function energy_i(law, stress) result(energy)
         import :: law_t, wp
         class(law_t), intent(in) :: law
         real(wp), intent(in) :: stress(6)   !! xx yy zz xy yz xz
         real(wp) :: energy
      end function energy_i
   end interface
end module xmpm_law
