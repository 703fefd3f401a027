!> What a kernel must know of the bin whose chunk it works on.
module xmpm_frame
   use xmpm_kinds, only: wp
   implicit none
   private

   public :: frame_t

   !> Place and scale of one bin.
   type :: frame_t
      real(wp) :: corner(3) = 0   !! lower corner of the bin [length]
      real(wp) :: per_size = 1    !! 1/h [1/length]
      real(wp) :: half = 0.25_wp  !! half a particle's width, used by GIMP [cells]
      integer :: base = 1         !! tile node at the lower corner of the bin's stencil
   end type frame_t
end module xmpm_frame
