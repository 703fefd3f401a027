!> Faces of cracks that pass through each other because their contact is off.
module xmpm_overlap
   use xmpm_kinds, only: wp
   use xmpm_text, only: to_text
   use xmpm_communicator, only: max_all
   use xmpm_model, only: model_t
   implicit none
   private

   public :: overlap_of_faces

   real(wp), parameter :: visible = 1e-3_wp   !! overlap that is told [cells]

contains

   !> What to say of the crack without contact whose faces overlap most; empty where none does by
   !> more than a thousandth of a cell. Collective.
   subroutine overlap_of_faces(m, text)
      type(model_t), intent(in) :: m
      character(len=:), allocatable, intent(out) :: text
      real(wp) :: most, place(3), worst(size(m%cracks))
      integer :: k

      text = ''
      do k = 1, size(m%cracks)
         worst(k) = 0
         if (m%contact%face_friction(k) >= 0) cycle
         call find_worst(m, k, worst(k), place)
      end do
      call max_all(m%comm, worst)
      if (.not. any(worst > visible*m%grid%lattice%size)) return
      k = maxloc(worst, dim=1)
      call find_worst(m, k, most, place)
      if (most < worst(k)) place = -huge(1.0_wp)
      call max_all(m%comm, place)
      text = 'the faces of crack '//m%cracks(k)%name//' overlap by '//to_text(worst(k))//', '// &
         to_text(worst(k)/m%grid%lattice%size)//' of a cell, at '//to_text(place)//', time '// &
         to_text(m%time)//': its contact is off (contact = frictionless or friction in *CRACK)'
   end subroutine overlap_of_faces

   !> Largest overlap of one crack's faces among the vertices of this rank, and its place.
   pure subroutine find_worst(m, k, most, place)
      type(model_t), intent(in) :: m
      integer, intent(in) :: k               !! crack
      real(wp), intent(out) :: most          !! [length]
      real(wp), intent(out) :: place(3)      !! [length]
      real(wp) :: overlap
      integer :: i

      most = 0
      place = 0
      associate (crack => m%cracks(k))
         do i = 1, crack%surface%vertex_count
            if (.not. (crack%mine(i) .and. crack%material(i))) cycle
            overlap = dot_product(crack%surface%um(:, i) - crack%surface%up(:, i), &
               crack%surface%vertex_normal(:, i))
            if (overlap <= most) cycle
            most = overlap
            place = crack%surface%x(:, i)
         end do
      end associate
   end subroutine find_worst
end module xmpm_overlap
