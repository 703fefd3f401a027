!> Energy that particles carry in parts of stress and velocity which no node sees.
module xmpm_unseen
   use xmpm_kinds, only: wp
   use xmpm_communicator, only: sum_all
   use xmpm_storage, only: lanes, c_s, c_v, c_m, c_vol
   use xmpm_elastic, only: elastic_t
   use xmpm_resolved, only: resolve_fields
   use xmpm_model, only: model_t
   implicit none
   private

   public :: unseen_energy

contains

   !> Kinetic and elastic energy of all particles less that of the fields that the grid resolves.
   !> Collective.
   function unseen_energy(m) result(energy)
      type(model_t), intent(inout) :: m
      real(wp) :: energy   !! [energy]
      real(wp), allocatable :: fields(:, :, :)
      integer, allocatable :: chunks(:)
      integer :: c, i

      chunks = pack([(c, c=1, m%particles%n_chunks)], &
         m%particles%count(:m%particles%n_chunks) > 0)
      allocate (fields(lanes, 9, size(chunks)))
      do i = 1, size(chunks)
         fields(:, :6, i) = m%particles%q(:, c_s:c_s + 5, chunks(i))
         fields(:, 7:, i) = m%particles%q(:, c_v:c_v + 2, chunks(i))
      end do
      call resolve_fields(chunks, m%comm, m%halo, m%grid, m%particles, m%bodies, m%kernels, &
         m%sided, fields)
      energy = 0
      do i = 1, size(chunks)
         energy = energy + difference(m, chunks(i), fields(:, :, i))
      end do
      call sum_all(m%comm, energy)
   end function unseen_energy

   !> Energy of the particles of one chunk less that of other fields.
   function difference(m, c, fields) result(energy)
      type(model_t), intent(in) :: m
      integer, intent(in) :: c
      real(wp), intent(in) :: fields(lanes, 9)   !! stress, velocity
      real(wp) :: energy, stress(6), seen(6)
      integer :: i

      energy = 0
      do i = 1, m%particles%count(c)
         associate (q => m%particles%q(i, :, c))
            energy = energy + 0.5_wp*q(c_m)*(sum(q(c_v:c_v + 2)**2) - sum(fields(i, 7:)**2))
            stress = q(c_s:c_s + 5)
            seen = fields(i, :6)
            select type (law => m%bodies%laws(m%bodies%law_of(m%particles%body(c)))%law)
            type is (elastic_t)
               energy = energy + q(c_vol)*(law%strain_energy(stress) - law%strain_energy(seen))
            end select
         end associate
      end do
   end function difference
end module xmpm_unseen
