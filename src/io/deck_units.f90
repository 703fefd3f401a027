!> What the numbers of a deck mean in SI units, by its *UNITS; the run converts nothing.
module xmpm_deck_units
   use xmpm_kinds, only: wp
   use xmpm_deck_data, only: deck_t, block_t, find_block, text_of
   implicit none
   private

   public :: si_factor, unit_text, sound_speed

   character(len=16), parameter :: dimensions(13) = [character(len=16) :: 'length', 'mass', &
      'time', 'velocity', &
      'acceleration', 'rate', 'density', 'stress', 'toughness', 'force', 'energy', 'momentum', &
      'angular momentum']

   !> Twice the powers of length, mass and time in each dimension.
   integer, parameter :: powers(3, 13) = reshape([2, 0, 0, 0, 2, 0, 0, 0, 2, 2, 0, -2, 2, 0, -4, &
      0, 0, -2, -6, 2, 0, -2, 2, -4, -1, 2, -4, 2, 2, -4, 4, 2, -4, 2, 2, -2, 4, 2, -2], [3, 13])

contains

   !> Factor from the units of the deck to SI units; 1 for an unknown dimension.
   pure function si_factor(deck, dimension) result(factor)
      type(deck_t), intent(in) :: deck             !! with its *UNITS filled in
      character(len=*), intent(in) :: dimension    !! for example 'stress'
      real(wp) :: factor
      type(block_t) :: units
      real(wp) :: base(3)
      integer :: i

      units = find_block(deck, 'units', 1)
      base = [length_in_metres(text_of(units, 'length')), mass_in_kilograms(text_of(units, &
         'mass')), &
         time_in_seconds(text_of(units, 'time'))]
      factor = 1.0_wp
      do i = 1, size(dimensions)
         if (dimensions(i) == dimension) factor = product(base**(powers(:, &
            i)/2)*sqrt(base)**mod(powers(:, i), 2))
      end do
   end function si_factor

   !> The unit of a dimension in the deck, for example 'g/(mm ms2)'; 'deg' for an angle.
   pure function unit_text(deck, dimension) result(text)
      type(deck_t), intent(in) :: deck             !! with its *UNITS filled in
      character(len=*), intent(in) :: dimension    !! for example 'stress'
      character(len=:), allocatable :: text
      type(block_t) :: units

      units = find_block(deck, 'units', 1)
      text = product_text(text_of(units, 'length'), text_of(units, 'mass'), text_of(units, &
         'time'), dimension)
   end function unit_text

   pure function product_text(l, m, t, dimension) result(text)
      character(len=*), intent(in) :: l, m, t      !! units of length, mass and time
      character(len=*), intent(in) :: dimension
      character(len=:), allocatable :: text

      select case (dimension)
      case ('length'); text = l
      case ('mass'); text = m
      case ('time'); text = t
      case ('velocity'); text = l//'/'//t
      case ('acceleration'); text = l//'/'//t//'2'
      case ('rate'); text = '1/'//t
      case ('density'); text = m//'/'//l//'3'
      case ('stress'); text = m//'/('//l//' '//t//'2)'
      case ('toughness'); text = m//'/('//l//'^0.5 '//t//'2)'
      case ('force'); text = m//' '//l//'/'//t//'2'
      case ('release rate'); text = m//'/'//t//'2'
      case ('energy'); text = m//' '//l//'2/'//t//'2'
      case ('momentum'); text = m//' '//l//'/'//t
      case ('angular momentum'); text = m//' '//l//'2/'//t
      case ('angle'); text = 'deg'
      case default; text = ''
      end select
   end function product_text

   !> Speed of a longitudinal wave, sqrt((lambda + 2 mu)/density).
   pure function sound_speed(young, poisson, density) result(speed)
      real(wp), intent(in) :: young     !! [stress]
      real(wp), intent(in) :: poisson   !! in (-1, 0.5)
      real(wp), intent(in) :: density   !! [mass/length**3]
      real(wp) :: speed                 !! [length/time]

      speed = sqrt(young*(1.0_wp - poisson)/((1.0_wp + poisson)*(1.0_wp - 2.0_wp*poisson)*density))
   end function sound_speed

   pure function length_in_metres(unit) result(factor)
      character(len=*), intent(in) :: unit
      real(wp) :: factor

      select case (unit)
      case ('mm'); factor = 1.0e-3_wp
      case ('cm'); factor = 1.0e-2_wp
      case ('um'); factor = 1.0e-6_wp
      case ('km'); factor = 1.0e3_wp
      case ('in'); factor = 0.0254_wp
      case ('ft'); factor = 0.3048_wp
      case default; factor = 1.0_wp
      end select
   end function length_in_metres

   pure function mass_in_kilograms(unit) result(factor)
      character(len=*), intent(in) :: unit
      real(wp) :: factor

      select case (unit)
      case ('g'); factor = 1.0e-3_wp
      case ('mg'); factor = 1.0e-6_wp
      case ('t'); factor = 1.0e3_wp
      case default; factor = 1.0_wp
      end select
   end function mass_in_kilograms

   pure function time_in_seconds(unit) result(factor)
      character(len=*), intent(in) :: unit
      real(wp) :: factor

      select case (unit)
      case ('ms'); factor = 1.0e-3_wp
      case ('us'); factor = 1.0e-6_wp
      case ('ns'); factor = 1.0e-9_wp
      case default; factor = 1.0_wp
      end select
   end function time_in_seconds
end module xmpm_deck_units
