!> What growth asks of the bodies: whether there is material at a point.
module xmpm_material_test
   use xmpm_kinds, only: wp
   implicit none
   private

   public :: material_test_t

   !> A test for material.
   type, abstract :: material_test_t
   contains
      procedure(inside_i), deferred :: inside
   end type material_test_t

   abstract interface
      !> Whether there is material at a point; the same answer on all ranks.
      pure function inside_i(material, x) result(is)
         import :: material_test_t, wp
         class(material_test_t), intent(in) :: material
         real(wp), intent(in) :: x(3)   !! [length]
         logical :: is
      end function inside_i
   end interface
end module xmpm_material_test
