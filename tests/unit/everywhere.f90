!> A body without end, for tests of growth.
module everywhere
   use xmpm_kinds, only: wp
   use xmpm_material_test, only: material_test_t
   implicit none
   private

   public :: everywhere_t

   !> Material at every point.
   type, extends(material_test_t) :: everywhere_t
   contains
      procedure :: inside => always
   end type everywhere_t

contains

   pure function always(material, x) result(is)
      class(everywhere_t), intent(in) :: material
      real(wp), intent(in) :: x(3)
      logical :: is

      associate (unused => material)
      end associate
      is = x(1) < huge(1.0_wp)
   end function always
end module everywhere
