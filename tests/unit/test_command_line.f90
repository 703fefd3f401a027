!> Tests of the options of the program.
program test_command_line
   use xmpm_error, only: error_t, code_usage
   use xmpm_text, only: string_t
   use xmpm_text_lists, only: append
   use xmpm_command_line, only: options_t, parse_command_line, get_arguments, help_text
   use testing, only: suite_t, check, check_error, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   type(options_t) :: options
   type(error_t), allocatable :: error

   suite%name = 'command_line'
   call takes_what_it_knows()
   call refuses_what_it_does_not_know()
   call tells_what_it_knows()
   call finish(suite)

contains

   subroutine takes_what_it_knows()
      type(string_t), allocatable :: arguments(:)

      call parse('')
      call check_no_error(suite, 'no argument is fine', error)
      call check(suite, 'the deck then comes from standard input', options%deck == '')
      call check(suite, 'and output goes to the current folder', options%folder == '.')
      call check(suite, 'and nothing else is asked for', .not. (options%help .or. options%version &
         .or. options%check .or. options%keywords .or. options%quiet))
      call parse('--check|-o|out|--quiet|plate.inp')
      call check_no_error(suite, 'options stand before the deck', error)
      call check(suite, 'all of them are taken', options%check .and. options%quiet .and. &
         options%folder == 'out' .and. options%deck == 'plate.inp')
      call parse('plate.inp|--check')
      call check(suite, 'or behind it', options%check .and. options%deck == 'plate.inp')
      call parse('--help')
      call check(suite, 'help can be asked for', options%help)
      call parse('-h')
      call check(suite, 'also in short', options%help)
      call parse('--version')
      call check(suite, 'so can the version', options%version)
      call parse('--keywords')
      call check(suite, 'and the keywords', options%keywords .and. .not. options%markdown)
      call parse('--keywords=markdown')
      call check(suite, 'also for the manual', options%keywords .and. options%markdown)
      call parse('-')
      call check(suite, 'a minus is standard input', &
         options%deck == '' .and. .not. allocated(error))
      call parse('--|-odd.inp')
      call check(suite, 'behind -- a deck may start with a minus', options%deck == '-odd.inp')
      call get_arguments(arguments)
      call check(suite, 'this test was started without arguments', size(arguments) == 0)
   end subroutine takes_what_it_knows

   subroutine refuses_what_it_does_not_know()
      call refuse('--chek', "unknown option '--chek'; did you mean '--check'?")
      call refuse('-x', 'xmpm3d --help lists the options')
      call refuse('--keywords=html', "unknown option '--keywords=html'")
      call refuse('a.inp|b.inp', "only one deck can be run, and 'b.inp' is a second one")
      call refuse('-o', "'-o' must be followed by a folder")
      call refuse('-o|--check', "'-o' must be followed by a folder")
      call refuse(' ', 'the name of the deck is blank')
      call refuse('--restart|latest', &
         "'--restart' needs checkpoints, which this version does not write")
      call refuse('--restart=a.h5', "'--restart' needs checkpoints")
      call refuse('--max-wall|01:00:00', "'--max-wall' needs checkpoints")
   end subroutine refuses_what_it_does_not_know

   subroutine tells_what_it_knows()
      character(len=10), parameter :: named(7) = [character(len=10) :: '--check', '--keywords', &
         '-o DIR', &
         '--quiet', '--version', '--help', 'Exit codes']
      integer :: i

      do i = 1, size(named)
         call check(suite, 'the help names '//trim(named(i)), index(help_text(), &
            trim(named(i))) > 0)
      end do
   end subroutine tells_what_it_knows

   subroutine refuse(line, part)
      character(len=*), intent(in) :: line
      character(len=*), intent(in) :: part

      call parse(line)
      call check_error(suite, "'"//line//"' is refused", error, part)
      if (allocated(error)) call check(suite, 'as a fault of usage', error%code == code_usage)
   end subroutine refuse

   !> Arguments are split at bars.
   subroutine parse(line)
      character(len=*), intent(in) :: line
      type(string_t), allocatable :: arguments(:)
      integer :: first, last

      allocate (arguments(0))
      first = 1
      do while (first <= len(line))
         last = first + index(line(first:)//'|', '|') - 2
         call append(arguments, line(first:last))
         first = last + 2
      end do
      call parse_command_line(arguments, options, error)
   end subroutine parse
end program test_command_line
