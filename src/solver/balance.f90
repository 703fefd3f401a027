!> One row of the energy history: energies, balance and momenta at one time, over all ranks.
module xmpm_balance
   use xmpm_kinds, only: wp, i8
   use xmpm_text, only: string_t
   use xmpm_vectors, only: cross
   use xmpm_communicator, only: sum_all
   use xmpm_deck, only: deck_t, unit_text
   use xmpm_storage, only: c_x, c_v, c_m
   use xmpm_history, only: cell
   use xmpm_model, only: model_t
   implicit none
   private

   public :: balance_t, balance_names, balance_units, balance_cells, momenta, balance_columns

   integer, parameter :: balance_columns = 22   !! values of a row

   !> Energies of all ranks at one time.
   type :: balance_t
      real(wp) :: time = 0             !! [time]
      integer(i8) :: step = 0          !! steps taken
      real(wp) :: dt = 0               !! of the last step [time]
      real(wp) :: kinetic = 0          !! [energy]
      real(wp) :: strain = 0           !! stress work [energy]
      real(wp) :: external = 0         !! work of loads, body forces and conditions [energy]
      real(wp) :: damping = 0          !! lost to damping [energy]
      real(wp) :: transfer = 0         !! lost in transfers: PIC, XPIC, USL [energy]
      real(wp) :: transfer_seen = 0    !! the part of it that nodes saw, since cracks began to
                                       !! grow [energy]
      real(wp) :: plastic = 0          !! plastic work [energy]
      real(wp) :: contact = 0          !! lost in contact: impact and friction [energy]
      real(wp) :: fracture = 0         !! taken by crack growth: G dA with G from J [energy]
      real(wp) :: unresolved = 0       !! kinetic and elastic energy that particles carry and no
                                       !! node sees, where cracks grow [energy]
      real(wp) :: error = 0            !! what the balance lacks [energy]
      real(wp) :: relative_error = 0   !! error over the largest energy so far
      real(wp) :: fracture_error = 0   !! what the balance of the energy that nodes see, with
                                       !! fracture, lacks; over the largest energy so far
      real(wp) :: linear(3) = 0        !! linear momentum [momentum]
      real(wp) :: angular(3) = 0       !! angular momentum about the origin [angular momentum]
   end type balance_t

contains

   !> Names of the columns.
   pure function balance_names() result(names)
      character(len=16) :: names(balance_columns)

      names = [character(len=16) :: 'time', 'step', 'dt', 'kinetic', 'strain', 'external', &
         'damping', 'transfer', 'plastic', 'contact', 'fracture', 'unresolved', 'transfer_seen', &
         'balance_error', 'relative_error', 'fracture_error', &
         'momentum_x', 'momentum_y', 'momentum_z', &
         'angular_x', 'angular_y', 'angular_z']
   end function balance_names

   !> Units of the columns.
   pure function balance_units(deck) result(units)
      type(deck_t), intent(in) :: deck   !! with its *UNITS
      character(len=32) :: units(balance_columns)

      units(1) = unit_text(deck, 'time')
      units(2) = '1'
      units(3) = unit_text(deck, 'time')
      units(4:14) = unit_text(deck, 'energy')
      units(15:16) = '1'
      units(17:19) = unit_text(deck, 'momentum')
      units(20:22) = unit_text(deck, 'angular momentum')
   end function balance_units

   !> The row in the order of the columns.
   pure function balance_cells(b) result(cells)
      type(balance_t), intent(in) :: b   !! of all ranks
      type(string_t) :: cells(balance_columns)
      real(wp) :: values(20)
      integer :: i

      values = [b%dt, b%kinetic, b%strain, b%external, b%damping, b%transfer, b%plastic, &
         b%contact, b%fracture, b%unresolved, b%transfer_seen, b%error, b%relative_error, &
         b%fracture_error, b%linear, b%angular]
      cells(1) = cell(b%time)
      cells(2) = cell(b%step)
      do i = 1, size(values)
         cells(2 + i) = cell(values(i))
      end do
   end function balance_cells

   !> Sums of m v and x cross m v over the particles of all ranks. Collective.
   subroutine momenta(m, linear, angular)
      type(model_t), intent(in) :: m
      real(wp), intent(out) :: linear(3)    !! [momentum]
      real(wp), intent(out) :: angular(3)   !! about the origin [angular momentum]
      real(wp) :: sums(6), x(3), p(3)
      integer :: c, i

      sums = 0
      associate (q => m%particles%q)
         do c = 1, m%particles%n_chunks
            do i = 1, m%particles%count(c)
               x = q(i, c_x:c_x + 2, c)
               p = q(i, c_m, c)*q(i, c_v:c_v + 2, c)
               sums(1:3) = sums(1:3) + p
               sums(4:6) = sums(4:6) + cross(x, p)
            end do
         end do
      end associate
      call sum_all(m%comm, sums)
      linear = sums(1:3)
      angular = sums(4:6)
   end subroutine momenta
end module xmpm_balance
