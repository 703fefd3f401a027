!> Forces between the faces of cracks that meet, as the next nodal update would give them.
module xmpm_face_forces
   use xmpm_kinds, only: wp
   use xmpm_grid, only: f_velocity, f_change
   use xmpm_momentum, only: advance_momentum
   use xmpm_contact, only: apply_impulses, note_reach
   use xmpm_meet, only: note_conditions
   use xmpm_model, only: model_t
   implicit none
   private

   public :: faces_meet, find_face_forces, part_faces

contains

   !> Whether the deck wants contact of the faces of some crack.
   pure function faces_meet(m) result(meet)
      type(model_t), intent(in) :: m
      logical :: meet

      meet = m%bodies_meet
      if (meet) meet = allocated(m%contact%face_friction)
      if (meet) meet = any(m%contact%face_friction >= 0)
   end function faces_meet

   !> Contact forces of all pairs, from rows that hold mass, momentum and force as P2G leaves them;
   !> nothing of the model is changed.
   subroutine find_face_forces(m, body_force, rate, force)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: body_force(3)              !! [length/time^2]
      real(wp), intent(in) :: rate                       !! of nodal damping [1/time]
      real(wp), allocatable, intent(out) :: force(:, :)  !! (3,pairs) on the second row [force]
      real(wp), allocatable :: node(:, :), impulse(:, :), reach(:)
      real(wp) :: dt

      node = m%grid%node
      impulse = m%contact%impulse
      reach = m%contact%reach
      dt = m%options%cfl*m%grid%lattice%size/(m%wave_speed + m%speed)
      if (m%options%fixed_step > 0) dt = m%options%fixed_step
      call advance_momentum(m%grid, dt, body_force, rate)
      call note_conditions(m)
      call note_reach(m%contact, m%grid%lattice%size, dt)
      call apply_impulses(m%contact, m%grid, f_velocity, .true.)
      force = m%contact%impulse/dt
      m%grid%node = node
      m%contact%impulse = impulse
      m%contact%reach = reach
   end subroutine find_face_forces

   !> Note the forces between the faces of one crack for the work that they do, and add them to the
   !> forces of the rows, which then are those of the stress inside alone.
   subroutine part_faces(m, crack, force)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: crack
      real(wp), intent(in) :: force(:, :)   !! (3,pairs) on the second row [force]
      integer :: i, side

      associate (f => m%fracture%faces)
         f%meet = m%contact%face_friction(crack) >= 0
         if (.not. f%meet) return
         call sum_over_nodes(m, crack, force)
         do i = 1, m%contact%n
            if (m%contact%crack(i) /= crack) cycle
            do side = 1, 2
               associate (row => m%grid%node(f_change:f_change + 2, m%contact%row(side, i)))
                  row = row + real(2*side - 3, wp)*force(:, i)
               end associate
            end do
         end do
      end associate
   end subroutine part_faces

   !> Forces on the plus face of a crack at the nodes that this rank counts, over all pairs of each.
   subroutine sum_over_nodes(m, crack, force)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: crack
      real(wp), intent(in) :: force(:, :)
      integer :: i, n, first
      integer :: node(m%contact%n)

      associate (f => m%fracture%faces, c => m%contact)
         f%x = 0*c%place
         f%force = 0*c%place
         n = 0
         node = 0
         do i = 1, c%n
            if (c%crack(i) /= crack .or. .not. m%grid%mine(c%row(1, i))) cycle
            first = c%first(c%row(1, i))
            if (node(first) == 0) then
               n = n + 1
               node(first) = n
               f%x(:, n) = c%place(:, i)
            end if
            f%force(:, node(first)) = f%force(:, node(first)) + force(:, i)
         end do
         f%x = f%x(:, :n)
         f%force = f%force(:, :n)
      end associate
   end subroutine sum_over_nodes
end module xmpm_face_forces
