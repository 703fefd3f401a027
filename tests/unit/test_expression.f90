!> Tests of the arithmetic in the deck.
program test_expression
   use xmpm_kinds, only: wp, pi
   use xmpm_error, only: error_t
   use xmpm_expression, only: variables_t, evaluate, define, is_reserved, is_identifier
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   type(variables_t) :: variables

   suite%name = 'expression'
   call define(variables, 'h', 2.0_wp)
   call define(variables, 'Slope', atan(2.0_wp))
   call follows_the_rules_of_arithmetic()
   call knows_functions()
   call knows_names()
   call refuses_what_has_no_value()
   call refuses_what_is_no_expression()
   call survives_deep_nesting()
   call finish(suite)

contains

   subroutine follows_the_rules_of_arithmetic()
      call expect('2+3*4', 14.0_wp)
      call expect('(2 + 3) * 4', 20.0_wp)
      call expect('10-4-3', 3.0_wp)
      call expect('16/4/2', 2.0_wp)
      call expect('-2**2', -4.0_wp)
      call expect('2**3**2', 512.0_wp)
      call expect('2^-1', 0.5_wp)
      call expect('(-8)**3', -512.0_wp)
      call expect('--1', 1.0_wp)
      call expect('2*-3', -6.0_wp)
      call expect('1.5+3', 4.5_wp)   ! and not 1.5e3, though Fortran would read it so
      call expect('2.d9*1e-9', 2.0_wp)
      call expect('4**0.5', 2.0_wp)
      call expect('10**100/10**98', 100.0_wp)
   end subroutine follows_the_rules_of_arithmetic

   subroutine knows_functions()
      call expect('sqrt(2)', sqrt(2.0_wp))
      call expect('abs(-3)', 3.0_wp)
      call expect('exp(1)', exp(1.0_wp))
      call expect('log(2)+ln(2)', 2*log(2.0_wp))
      call expect('log10(1000)', 3.0_wp)
      call expect('sin(1)', sin(1.0_wp))
      call expect('cos(1)', cos(1.0_wp))
      call expect('tan(1)', tan(1.0_wp))
      call expect('asin(0.5)', asin(0.5_wp))
      call expect('acos(0.5)', acos(0.5_wp))
      call expect('atan(2)', atan(2.0_wp))
      call expect('sinh(1)', sinh(1.0_wp))
      call expect('cosh(1)', cosh(1.0_wp))
      call expect('tanh(1)', tanh(1.0_wp))
      call expect('floor(-2.5)', -3.0_wp)
      call expect('ceiling(2.1)+ceil(-2.1)', 1.0_wp)
      call expect('round(2.6)+nint(-2.6)', 0.0_wp)
      call expect('sin(deg(30))', 0.5_wp)
      call expect('atan2(1, -1)', atan2(1.0_wp, -1.0_wp))
      call expect('mod(7, 4)', 3.0_wp)
      call expect('min(1, 2)', 1.0_wp)
      call expect('max(1, 2)', 2.0_wp)
      call expect('hypot(3, 4)', 5.0_wp)
      call expect('sign(3, -1)', -3.0_wp)
   end subroutine knows_functions

   subroutine knows_names()
      call expect('3*h', 6.0_wp)
      call expect('H*COS(SLOPE)', 2*cos(atan(2.0_wp)))
      call expect('2*pi', 2*pi)
      call define(variables, 'H', 5.0_wp)
      call expect('h', 5.0_wp)
      call check(suite, 'functions are reserved', is_reserved('Atan2') .and. is_reserved('sqrt'))
      call check(suite, 'pi and words for no number are reserved', is_reserved('pi') &
         .and. is_reserved('NaN') .and. is_reserved('inf'))
      call check(suite, 'other names are free', .not. is_reserved('h'))
      call check(suite, 'a name starts with a letter', is_identifier('a_1') .and. &
         .not. is_identifier('1a') .and. .not. is_identifier('') .and. .not. is_identifier('a-b'))
   end subroutine knows_names

   subroutine refuses_what_has_no_value()
      call refuse('1/0', 'division by zero')
      call refuse('0/0', 'division by zero')
      call refuse('1e308*10', 'not a finite number')
      call refuse('1e308+1e308', 'not a finite number')
      call refuse('0**-1', 'not a finite number')
      call refuse('(-8)**0.5', 'not a finite number')
      call refuse('sqrt(-1)', 'sqrt has no value there')
      call refuse('log(0)', 'log has no value there')
      call refuse('exp(1000)', 'exp has no value there')
      call refuse('mod(5, 0)', 'mod has no value there')
      call refuse('1e400', 'out of the range')
      call refuse('nan', "'nan' is not a number")
      call refuse('-Inf', "'inf' is not a number")
   end subroutine refuses_what_has_no_value

   subroutine refuses_what_is_no_expression()
      logical :: unknown
      real(wp) :: value
      type(error_t), allocatable :: error

      call refuse('', 'a number is missing at the end')
      call refuse('1+', 'a number is missing at the end')
      call refuse('3h', "'3h' is not a number")
      call refuse('1.2.3', "'1.2.3' is not a number")
      call refuse('2e', "'2e' is not a number")
      call refuse('0x1F', "'0x1f' is not a number")
      call refuse('.', "'.' is not a number")
      call refuse('1)', "unexpected ')'")
      call refuse('1 2', "unexpected '2'")
      call refuse('#', "unexpected '#'")
      call refuse('(1', "')' is missing at the end")
      call refuse('(1 2)', "')' is missing before '2'")
      call refuse('atan2(1)', "',' is missing before ')'")
      call refuse('sin(1, 2)', "')' is missing before ','")
      call refuse('sin', "the function 'sin' needs its argument in parentheses")
      call refuse('sinn(1)', "unknown name 'sinn'; did you mean 'sin'?")
      call refuse('slop*2', "unknown name 'slop'; did you mean 'slope'?")
      call evaluate('slop', variables, value, error, unknown)
      call check(suite, 'an unknown name is told apart from other faults', unknown)
      call evaluate('1/0', variables, value, error, unknown)
      call check(suite, 'and other faults from it', .not. unknown)
   end subroutine refuses_what_is_no_expression

   subroutine survives_deep_nesting()
      call expect(repeat('(', 90)//'1'//repeat(')', 90), 1.0_wp)
      call refuse(repeat('(', 100000)//'1'//repeat(')', 100000), 'nested too deeply')
      call refuse(repeat('-', 100000)//'1', 'nested too deeply')
      call refuse('1'//repeat('^1', 100000), 'nested too deeply')
      call expect('0'//repeat('+1', 10000), 10000.0_wp)
   end subroutine survives_deep_nesting

   !> Two roundings are the most that any expression here may differ by.
   subroutine expect(text, value)
      character(len=*), intent(in) :: text
      real(wp), intent(in) :: value
      real(wp) :: got
      type(error_t), allocatable :: error

      call evaluate(text, variables, got, error)
      call check_no_error(suite, text//' is an expression', error)
      call check_close(suite, text//' has its value', got, value, 0.0_wp, 2*epsilon(value))
   end subroutine expect

   subroutine refuse(text, part)
      character(len=*), intent(in) :: text
      character(len=*), intent(in) :: part
      real(wp) :: got
      type(error_t), allocatable :: error

      call evaluate(text, variables, got, error)
      call check_error(suite, "'"//text(:min(len(text), 30))//"' is refused", error, part)
      call check(suite, 'what is refused is zero', abs(got) <= 0.0_wp)
   end subroutine refuse
end program test_expression
