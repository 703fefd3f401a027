!> The table of fracture parameters: one row for each front point and time.
module xmpm_front_table
   use xmpm_kinds, only: wp, i8
   use xmpm_text, only: string_t
   use xmpm_deck, only: deck_t, unit_text
   use xmpm_history, only: history_t, write_row_text, cell
   use xmpm_front_values, only: front_values_t
   use xmpm_model, only: model_t
   implicit none
   private

   public :: front_names, front_units, write_fronts

   integer, parameter :: columns = 27   !! of the table
   character(len=10), parameter :: names(columns) = [character(len=10) :: 'time', 'step', 'crack', &
      'front', 'point', 's', 'x', 'y', 'z', 'J', 'K_I', 'K_II', 'K_III', 'J_low', 'J_high', &
      'K_I_low', 'K_I_high', 'K_II_low', 'K_II_high', 'K_III_low', 'K_III_high', 'T', &
      'kink_angle', 'K_star', 'tip_speed', 'flags', 'radius']

contains

   !> Names of the columns.
   pure function front_names() result(list)
      character(len=10) :: list(columns)

      list = names(:columns)
   end function front_names

   !> Units of the columns.
   pure function front_units(deck) result(units)
      type(deck_t), intent(in) :: deck
      character(len=:), allocatable :: units(:)
      character(len=40) :: list(columns)
      character(len=:), allocatable :: k, j, length

      length = unit_text(deck, 'length')
      j = unit_text(deck, 'release rate')
      k = unit_text(deck, 'toughness')
      list = '1'
      list(1) = unit_text(deck, 'time')
      list(6:9) = length
      list(10) = j
      list(11:13) = k
      list(14:15) = j
      list(16:21) = k
      list(22) = unit_text(deck, 'stress')
      list(23) = 'rad'
      list(24) = k
      list(25) = unit_text(deck, 'velocity')
      list(27) = length
      units = list
   end function front_units

   !> Write the rows of all fronts as they were measured last; rank 0 writes, others return.
   subroutine write_fronts(table, m)
      type(history_t), intent(inout) :: table
      type(model_t), intent(in) :: m
      integer :: i, k

      if (m%comm%rank /= 0) return
      do i = 1, size(m%fracture%cracks)
         associate (v => m%fracture%values(i))
            do k = 1, v%points%n
               call write_row_text(table, [cell(m%time), cell(m%step), &
                  cell(m%cracks(m%fracture%cracks(i))%name), cells_of(v, k)])
            end do
         end associate
      end do
   end subroutine write_fronts

   !> Cells of one point from the number of the front on.
   pure function cells_of(v, k) result(cells)
      type(front_values_t), intent(in) :: v
      integer, intent(in) :: k
      type(string_t) :: cells(columns - 3)
      real(wp) :: numbers(20)
      integer :: i

      cells(1) = cell(int(v%points%chain(k), i8))
      cells(2) = cell(int(k - findloc(v%points%chain, v%points%chain(k), 1) + 1, i8))
      numbers = [v%points%s(k), v%points%x(:, k), v%j(k), v%k(:, k), v%j_bar(:, k), &
         v%k_bar(:, :, k), v%t(k), v%kink(k), v%k_star(k), v%speed(k)]
      do i = 1, size(numbers)
         cells(2 + i) = cell(numbers(i))
      end do
      cells(23) = cell(int(v%flags(k), i8))
      cells(24) = cell(v%radius(k))
   end function cells_of
end module xmpm_front_table
