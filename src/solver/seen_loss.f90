!> What PIC and XPIC take from the velocities that the nodes see.
!>
!> The transfer takes d = b - c from a particle, b being what FLIP would give it. Nodes see B f =
!> 2 S f - S S f of a field, with S = N S+ and S+ the map back to them with mass weights. Of the
!> loss, the sum of m d.(v + c)/2 over the particles, that of m (B d).(B (v + c)/2) is theirs. On
!> the nodes, with G = S+ N and q = S+ d = eta u + G (dv - change), it is the sum of
!> m (2 q - G q).(2 r - G r), r = G z, z = S+ (v + c)/2 = u + G dv/2 - q/2.
module xmpm_seen_loss
   use xmpm_kinds, only: wp
   use xmpm_halo, only: start_sum, finish_sum
   use xmpm_grid, only: active_rows
   use xmpm_transfer, only: smooth_velocity
   use xmpm_model, only: model_t
   implicit none
   private

   public :: smooth, seen_loss, wants_seen_loss, look_interval

   integer, parameter :: look_interval = 5   !! steps, one of which is looked at

contains

   !> Momentum of three smoothed fields in grid%second, which must be clear. Collective.
   subroutine smooth(m, field)
      type(model_t), intent(inout) :: m
      integer, intent(in) :: field   !! first of the three: 2 or 5

      call smooth_velocity(m%particles, m%bodies, m%kernels, m%sided, 1, m%grid%blocks%n, field, &
         m%grid)
      call start_sum(m%halo, m%comm, m%grid%second, 1, 3)
      call finish_sum(m%halo, m%grid%second, 1, 3)
   end subroutine smooth

   !> Whether the loss of this step is looked at: where cracks have begun to grow.
   pure function wants_seen_loss(m) result(wants)
      type(model_t), intent(in) :: m
      logical :: wants

      wants = .false.
      if (.not. allocated(m%growth) .or. m%relaxing) return
      wants = any(m%growth%energy > 0) .and. modulo(m%step, int(look_interval, kind(m%step))) == 0
   end function wants_seen_loss

   !> Loss of the velocities that nodes see in this step, of the rows of this rank. Fields 2:4 hold
   !> the new velocity and 5:7 what the particles will get. Collective.
   function seen_loss(m, eta, dv) result(energy)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: eta        !! share of their velocity that the particles lose
      real(wp), intent(in) :: dv(:, :)   !! (3,rows) change of the nodes' velocity
      real(wp) :: energy
      real(wp), allocatable :: change(:, :), u(:, :), q(:, :), r(:, :), gain(:, :)

      change = m%grid%node(5:7, :)
      u = m%grid%node(2:4, :) - dv
      gain = smoothed(m, dv)
      q = eta*u + gain - smoothed(m, change)
      r = smoothed(m, u + 0.5_wp*gain - 0.5_wp*q)
      q = 2*q - smoothed(m, q)
      r = 2*r - smoothed(m, r)
      energy = dot_rows(m, q, r)
      m%grid%node(5:7, :) = change
   end function seen_loss

   !> G f. Changes fields 5:7 of the rows. Collective.
   function smoothed(m, f) result(g)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: f(:, :)   !! (3,rows)
      real(wp) :: g(3, size(f, 2))
      integer :: b, i, first, last

      m%grid%node(5:7, :) = f
      call smooth(m, 5)
      g = 0
      do b = 1, m%grid%blocks%n_node_blocks + 1
         call active_rows(m%grid, b, first, last)
         do i = first, last
            if (m%grid%node(1, i) > 0) g(:, i) = m%grid%second(:, i)/m%grid%node(1, i)
            m%grid%second(:, i) = 0
         end do
      end do
   end function smoothed

   !> Sum of m a.b over the rows that this rank counts.
   pure function dot_rows(m, a, b) result(energy)
      type(model_t), intent(in) :: m
      real(wp), intent(in) :: a(:, :), b(:, :)   !! (3,rows)
      real(wp) :: energy
      integer :: k, i, first, last

      energy = 0
      do k = 1, m%grid%blocks%n_node_blocks + 1
         call active_rows(m%grid, k, first, last)
         do i = first, last
            if (m%grid%mine(i)) energy = energy &
               + m%grid%node(1, i)*dot_product(a(:, i), b(:, i))
         end do
      end do
   end function dot_rows
end module xmpm_seen_loss
