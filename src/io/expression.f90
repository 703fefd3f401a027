!> Arithmetic in the deck: numbers, names, + - * / ** ^, parentheses, functions (radians).
module xmpm_expression
   use, intrinsic :: ieee_arithmetic, only: ieee_get_halting_mode, ieee_set_halting_mode, &
      ieee_set_flag, ieee_is_finite
   use, intrinsic :: ieee_exceptions, only: ieee_usual
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t, raise, code_usage
   use xmpm_text, only: string_t, lower
   use xmpm_numbers, only: parse_real, number_length, number_good
   use xmpm_text_lists, only: append, slice, shown
   use xmpm_deck_hints, only: did_you_mean, nearest_name, edit_distance
   implicit none
   private

   public :: variables_t, evaluate, define, is_reserved, is_identifier

   !> Names and what they stand for.
   type :: variables_t
      type(string_t), allocatable :: names(:)   !! (n) lower case
      real(wp), allocatable :: values(:)        !! (n)
   end type variables_t

   !> A text being read: `place` is the next character.
   type :: reader_t
      character(len=:), allocatable :: text    !! lower case
      integer :: place = 1                     !! 1 .. len + 1
      integer :: depth = 0                     !! parentheses and signs that are open
      type(variables_t) :: variables           !! known names
      character(len=:), allocatable :: fault   !! what is wrong, if anything is
      logical :: unknown = .false.             !! the fault is a name that is not known
   end type reader_t

   integer, parameter :: deepest = 100   !! nesting allowed
   character(len=*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyz_'
   character(len=*), parameter :: digits = '0123456789'
   character(len=*), parameter :: blanks = ' '//achar(9)
   character(len=*), parameter :: functions_of_one(21) = [character(len=7) :: &
      'sqrt', 'abs', 'exp', 'log', 'ln', 'log10', 'sin', 'cos', 'tan', 'asin', 'acos', 'atan', &
      'sinh', 'cosh', 'tanh', 'floor', 'ceiling', 'ceil', 'round', 'deg', 'nint']
   character(len=*), parameter :: functions_of_two(6) = [character(len=5) :: &
      'atan2', 'mod', 'min', 'max', 'hypot', 'sign']
   character(len=*), parameter :: words_of_no_number(4) = [character(len=8) :: &
      'nan', 'inf', 'infinity', 'infinite']

contains

   !> The value of an expression; what is not a finite number is an error that says why.
   subroutine evaluate(text, variables, value, error, unknown)
      character(len=*), intent(in) :: text               !! for example '3*h' or 'cos(slope)'
      type(variables_t), intent(in) :: variables         !! names that may stand in it
      real(wp), intent(out) :: value                     !! 0 on error
      type(error_t), allocatable, intent(out) :: error   !! set where the text has no value
      logical, intent(out), optional :: unknown          !! the error is a name that is not known
      type(reader_t) :: reader
      logical :: halting(size(ieee_usual))

      reader%text = lower(text)
      reader%variables = variables
      call ieee_get_halting_mode(ieee_usual, halting)
      call ieee_set_halting_mode(ieee_usual, .false.)
      call read_sum(reader, value)
      call ieee_set_flag(ieee_usual, .false.)
      call ieee_set_halting_mode(ieee_usual, halting)
      if (.not. allocated(reader%fault)) then
         if (next(reader) /= '') call blame(reader, "unexpected '"//next(reader)//"'")
      end if
      if (present(unknown)) unknown = reader%unknown
      if (.not. allocated(reader%fault)) return
      value = 0.0_wp
      call raise(error, code_usage, reader%fault)
   end subroutine evaluate

   !> Give a name its value; a name that is already known gets the new one.
   subroutine define(variables, name, value)
      type(variables_t), intent(inout) :: variables   !! changed
      character(len=*), intent(in) :: name            !! an identifier
      real(wp), intent(in) :: value                   !! finite
      integer :: place

      if (.not. allocated(variables%names)) allocate (variables%names(0), variables%values(0))
      place = place_of(variables, lower(name))
      if (place == 0) then
         call append(variables%names, lower(name))
         variables%values = [variables%values, value]
      else
         variables%values(place) = value
      end if
   end subroutine define

   !> Whether a name is taken by a function, a constant or a word for what is no number.
   pure function is_reserved(name) result(reserved)
      character(len=*), intent(in) :: name   !! in any case of letters
      logical :: reserved
      character(len=len(name)) :: low

      low = lower(name)
      reserved = any(functions_of_one == low) .or. any(functions_of_two == low) &
         .or. any(words_of_no_number == low) .or. low == 'pi'
   end function is_reserved

   !> Whether a text is a letter or underscore, then letters, digits and underscores.
   pure function is_identifier(text) result(is)
      character(len=*), intent(in) :: text   !! any
      logical :: is

      is = .false.
      if (len(text) == 0) return
      is = verify(lower(text), letters//digits) == 0 .and. verify(lower(text(1:1)), letters) == 0
   end function is_identifier

   !> sum = product { (+|-) product }
   recursive subroutine read_sum(reader, value)
      type(reader_t), intent(inout) :: reader
      real(wp), intent(out) :: value
      real(wp) :: right
      character(len=1) :: operator

      call read_product(reader, value)
      do while (.not. allocated(reader%fault))
         operator = next(reader)
         if (operator /= '+' .and. operator /= '-') exit
         call skip(reader, 1)
         call read_product(reader, right)
         value = value + merge(right, -right, operator == '+')
         call check_finite(reader, value)
      end do
   end subroutine read_sum

   !> product = signed { (*|/) signed }
   recursive subroutine read_product(reader, value)
      type(reader_t), intent(inout) :: reader
      real(wp), intent(out) :: value
      real(wp) :: right
      character(len=1) :: operator

      call read_signed(reader, value)
      do while (.not. allocated(reader%fault))
         operator = next(reader)
         if (operator /= '*' .and. operator /= '/') exit
         call skip(reader, 1)
         call read_signed(reader, right)
         if (allocated(reader%fault)) exit
         if (operator == '*') then
            value = value*right
         else if (abs(right) > 0.0_wp) then
            value = value/right
         else
            call blame(reader, 'division by zero')
         end if
         call check_finite(reader, value)
      end do
   end subroutine read_product

   !> signed = [+|-] power; a sign binds weaker than a power, as in Fortran.
   recursive subroutine read_signed(reader, value)
      type(reader_t), intent(inout) :: reader
      real(wp), intent(out) :: value
      character(len=1) :: sign_of

      value = 0.0_wp
      sign_of = next(reader)
      if (sign_of /= '+' .and. sign_of /= '-') then
         call read_power(reader, value)
         return
      end if
      call skip(reader, 1)
      call descend(reader)
      if (.not. allocated(reader%fault)) call read_signed(reader, value)
      reader%depth = reader%depth - 1
      if (sign_of == '-') value = -value
   end subroutine read_signed

   !> power = atom [(**|^) signed], from right to left.
   recursive subroutine read_power(reader, value)
      type(reader_t), intent(inout) :: reader
      real(wp), intent(out) :: value
      real(wp) :: exponent

      call read_atom(reader, value)
      if (allocated(reader%fault)) return
      if (next(reader) == '^') then
         call skip(reader, 1)
      else if (starts_with(reader, '**')) then
         call skip(reader, 2)
      else
         return
      end if
      call descend(reader)
      if (.not. allocated(reader%fault)) call read_signed(reader, exponent)
      reader%depth = reader%depth - 1
      if (allocated(reader%fault)) return
      value = power(value, exponent)
      call check_finite(reader, value)
   end subroutine read_power

   !> atom = number | name | function(...) | (sum)
   recursive subroutine read_atom(reader, value)
      type(reader_t), intent(inout) :: reader
      real(wp), intent(out) :: value
      character(len=1) :: c

      value = 0.0_wp
      c = next(reader)
      if (c == '(') then
         call skip(reader, 1)
         call descend(reader)
         if (.not. allocated(reader%fault)) call read_sum(reader, value)
         reader%depth = reader%depth - 1
         call expect(reader, ')')
      else if (c == '') then
         call blame(reader, 'a number is missing at the end')
      else if (index(digits//'.', c) > 0) then
         call read_number(reader, value)
      else if (index(letters, c) > 0) then
         call read_name(reader, value)
      else
         call blame(reader, "unexpected '"//c//"'")
      end if
   end subroutine read_atom

   subroutine read_number(reader, value)
      type(reader_t), intent(inout) :: reader
      real(wp), intent(out) :: value
      character(len=:), allocatable :: number
      integer :: length, status, last

      value = 0.0_wp
      length = number_length(reader%text(reader%place:))
      last = word_end(reader, digits//letters//'.')
      if (length == 0 .or. last >= reader%place + length) then
         call blame(reader, "'"//shown(slice(reader%text, reader%place, last)) &
            //"' is not a number")
         return
      end if
      number = slice(reader%text, reader%place, reader%place + length - 1)
      call parse_real(number, value, status)
      if (status /= number_good) call blame(reader, "'"//number &
         //"' is out of the range of double precision")
      reader%place = reader%place + length
   end subroutine read_number

   !> A parameter, pi, or a function with its arguments.
   recursive subroutine read_name(reader, value)
      type(reader_t), intent(inout) :: reader
      real(wp), intent(out) :: value
      character(len=:), allocatable :: name
      integer :: last, place

      value = 0.0_wp
      last = word_end(reader, digits//letters)
      name = slice(reader%text, reader%place, last)
      reader%place = last + 1
      place = place_of(reader%variables, name)
      if (any(functions_of_one == name) .or. any(functions_of_two == name)) then
         call read_function(reader, name, value)
      else if (name == 'pi') then
         value = pi
      else if (place > 0) then
         value = reader%variables%values(place)
      else if (any(words_of_no_number == name)) then
         call blame(reader, "'"//name//"' is not a number")
      else
         call blame(reader, "unknown name '"//shown(name)//"'"//hint(reader, name))
         reader%unknown = .true.
      end if
   end subroutine read_name

   recursive subroutine read_function(reader, name, value)
      type(reader_t), intent(inout) :: reader
      character(len=*), intent(in) :: name
      real(wp), intent(out) :: value
      real(wp) :: second

      value = 0.0_wp
      second = 0.0_wp
      if (next(reader) /= '(') then
         call blame(reader, "the function '"//name//"' needs its argument in parentheses")
         return
      end if
      call skip(reader, 1)
      call descend(reader)
      if (.not. allocated(reader%fault)) call read_sum(reader, value)
      if (any(functions_of_two == name)) then
         call expect(reader, ',')
         if (.not. allocated(reader%fault)) call read_sum(reader, second)
      end if
      reader%depth = reader%depth - 1
      call expect(reader, ')')
      if (allocated(reader%fault)) return
      if (any(functions_of_two == name)) then
         value = value_of_two(name, value, second)
      else
         value = value_of_one(name, value)
      end if
      if (.not. ieee_is_finite(value)) call blame(reader, name//' has no value there')
   end subroutine read_function

   function value_of_one(name, x) result(y)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: x
      real(wp) :: y

      select case (name)
      case ('sqrt'); y = sqrt(x)
      case ('abs'); y = abs(x)
      case ('exp'); y = exp(x)
      case ('log', 'ln'); y = log(x)
      case ('log10'); y = log10(x)
      case ('sin'); y = sin(x)
      case ('cos'); y = cos(x)
      case ('tan'); y = tan(x)
      case ('asin'); y = asin(x)
      case ('acos'); y = acos(x)
      case ('atan'); y = atan(x)
      case ('sinh'); y = sinh(x)
      case ('cosh'); y = cosh(x)
      case ('tanh'); y = tanh(x)
      case ('floor'); y = aint(x) - merge(1.0_wp, 0.0_wp, aint(x) > x)
      case ('ceiling', 'ceil'); y = aint(x) + merge(1.0_wp, 0.0_wp, aint(x) < x)
      case ('round', 'nint'); y = anint(x)
      case default; y = x*pi/180.0_wp   ! deg
      end select
   end function value_of_one

   function value_of_two(name, x, y) result(z)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: x
      real(wp), intent(in) :: y
      real(wp) :: z

      select case (name)
      case ('atan2'); z = atan2(x, y)
      case ('mod'); z = mod(x, y)
      case ('min'); z = min(x, y)
      case ('max'); z = max(x, y)
      case ('hypot'); z = hypot(x, y)
      case default; z = sign(x, y)
      end select
   end function value_of_two

   !> x**y, with whole exponents by multiplication, so that a negative x has its powers.
   function power(x, y) result(z)
      real(wp), intent(in) :: x
      real(wp), intent(in) :: y
      real(wp) :: z

      if (abs(y) <= 64.0_wp .and. abs(y - anint(y)) <= 0.0_wp) then
         z = x**nint(y)
      else
         z = x**y
      end if
   end function power

   !> The next character that is not a blank; a blank at the end.
   pure function next(reader) result(c)
      type(reader_t), intent(in) :: reader
      character(len=1) :: c
      integer :: step

      c = ''
      if (reader%place > len(reader%text)) return
      step = verify(reader%text(reader%place:), blanks)
      if (step > 0) c = reader%text(reader%place + step - 1:reader%place + step - 1)
   end function next

   pure function starts_with(reader, text) result(does)
      type(reader_t), intent(in) :: reader
      character(len=*), intent(in) :: text
      logical :: does
      integer :: first

      does = .false.
      first = reader%place + verify(reader%text(reader%place:), blanks) - 1
      if (first < reader%place .or. first + len(text) - 1 > len(reader%text)) return
      does = slice(reader%text, first, first + len(text) - 1) == text
   end function starts_with

   !> Go over blanks, then over `count` characters, then over blanks.
   subroutine skip(reader, count)
      type(reader_t), intent(inout) :: reader
      integer, intent(in) :: count
      integer :: step

      step = verify(reader%text(reader%place:), blanks)
      if (step > 0) reader%place = reader%place + step - 1 + count
      if (reader%place > len(reader%text)) return
      step = verify(reader%text(reader%place:), blanks)
      if (step > 0) reader%place = reader%place + step - 1
   end subroutine skip

   !> Last place of the run of `allowed` characters that starts at the reader's place.
   pure function word_end(reader, allowed) result(last)
      type(reader_t), intent(in) :: reader
      character(len=*), intent(in) :: allowed
      integer :: last

      last = reader%place + verify(reader%text(reader%place:), allowed) - 2
      if (last < reader%place - 1) last = len(reader%text)
   end function word_end

   subroutine expect(reader, c)
      type(reader_t), intent(inout) :: reader
      character(len=1), intent(in) :: c

      if (allocated(reader%fault)) return
      if (next(reader) == c) then
         call skip(reader, 1)
      else if (next(reader) == '') then
         call blame(reader, "'"//c//"' is missing at the end")
      else
         call blame(reader, "'"//c//"' is missing before '"//next(reader)//"'")
      end if
   end subroutine expect

   subroutine descend(reader)
      type(reader_t), intent(inout) :: reader

      reader%depth = reader%depth + 1
      if (reader%depth > deepest) call blame(reader, 'nested too deeply')
   end subroutine descend

   subroutine check_finite(reader, value)
      type(reader_t), intent(inout) :: reader
      real(wp), intent(in) :: value

      if (.not. ieee_is_finite(value)) call blame(reader, 'the result is not a finite number')
   end subroutine check_finite

   !> Keep the first fault.
   subroutine blame(reader, fault)
      type(reader_t), intent(inout) :: reader
      character(len=*), intent(in) :: fault

      if (.not. allocated(reader%fault)) reader%fault = fault
   end subroutine blame

   pure function place_of(variables, name) result(place)
      type(variables_t), intent(in) :: variables
      character(len=*), intent(in) :: name
      integer :: place, i

      place = 0
      if (.not. allocated(variables%names)) return
      do i = 1, size(variables%names)
         if (variables%names(i)%s == name) place = i
      end do
   end function place_of

   !> The nearest parameter or function, if it is near.
   function hint(reader, name) result(text)
      type(reader_t), intent(in) :: reader
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: text
      type(string_t), allocatable :: names(:)
      integer :: i

      if (allocated(reader%variables%names)) names = reader%variables%names
      do i = 1, size(functions_of_one)
         call append(names, trim(functions_of_one(i)))
      end do
      do i = 1, size(functions_of_two)
         call append(names, trim(functions_of_two(i)))
      end do
      call append(names, 'pi')
      text = ''
      i = nearest_name(name, names)
      if (2*edit_distance(name, names(i)%s) <= len(name) + 1) text = did_you_mean(name, names)
   end function hint
end module xmpm_expression
