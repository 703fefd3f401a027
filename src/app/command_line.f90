!> The options of the program: xmpm3d [options] [deck].
module xmpm_command_line
   use xmpm_error, only: error_t, raise, code_usage
   use xmpm_text, only: string_t
   use xmpm_text_lists, only: append
   use xmpm_deck_hints, only: did_you_mean
   implicit none
   private

   public :: options_t, parse_command_line, get_arguments, help_text

   !> What the command line asks for.
   type :: options_t
      character(len=:), allocatable :: deck     !! file of the deck; blank for standard input
      character(len=:), allocatable :: folder   !! where output files go
      logical :: help = .false.                 !! print the help and stop
      logical :: version = .false.              !! print version and libraries and stop
      logical :: keywords = .false.             !! print the keyword table and stop
      logical :: markdown = .false.             !! the keyword table as tables of the manual
      logical :: check = .false.                !! set up, report, write step 0, run nothing
      logical :: quiet = .false.                !! no log on standard output
   end type options_t

   character(len=*), parameter :: known(9) = [character(len=12) :: '--help', '--version', &
      '--check', &
      '--keywords', '--quiet', '--restart', '--max-wall', '-o', '-h']
   character(len=*), parameter :: see_help = ' (xmpm3d --help lists the options)'

contains

   !> Options from the arguments of the program.
   subroutine parse_command_line(arguments, options, error)
      type(string_t), intent(in) :: arguments(:)          !! without the name of the program
      type(options_t), intent(out) :: options             !! what is asked for
      type(error_t), allocatable, intent(out) :: error    !! the first thing that is wrong
      integer :: i
      logical :: only_files, has_deck

      options%deck = ''
      options%folder = '.'
      only_files = .false.
      has_deck = .false.
      i = 0
      do while (i < size(arguments))
         i = i + 1
         if (.not. only_files .and. arguments(i)%s == '--') then
            only_files = .true.
         else if (.not. only_files .and. is_option(arguments(i)%s)) then
            call take_option(arguments, i, options, error)
         else
            call take_deck(arguments(i)%s, has_deck, options, error)
         end if
         if (allocated(error)) return
      end do
   end subroutine parse_command_line

   !> The arguments that the program was started with.
   subroutine get_arguments(arguments)
      type(string_t), allocatable, intent(out) :: arguments(:)   !! without the name of the program
      character(len=:), allocatable :: argument
      integer :: i, length

      allocate (arguments(0))
      do i = 1, command_argument_count()
         call get_command_argument(i, length=length)
         allocate (character(len=length) :: argument)
         call get_command_argument(i, argument)
         call append(arguments, argument)
         deallocate (argument)
      end do
   end subroutine get_arguments

   !> What --help prints.
   pure function help_text() result(text)
      character(len=:), allocatable :: text   !! lines split by new_line
      character(len=1), parameter :: nl = new_line('a')

      text = 'Usage: xmpm3d [options] [deck]'//nl &
         //'       mpirun -n 2 xmpm3d [options] < deck'//nl//nl &
         //'Three-dimensional material point method with cracks independent of the grid.'//nl &
         //'The deck is read from the file, or from standard input.'//nl//nl &
         //'  --check              set up the deck, report its size and time step, write'//nl &
         //'                       the output of step 0, and run nothing'//nl &
         //'  --keywords           list all keywords and keys of the deck'//nl &
         //'  --keywords=markdown  the same as tables of the manual'//nl &
         //'  -o DIR               folder for the output files (default: the current one)'//nl &
         //'  --quiet              no log on standard output (it is in NAME.log)'//nl &
         //'  --version            version, compiler, flags and libraries'//nl &
         //'  -h, --help           this text'//nl//nl &
         //'Exit codes: 0 finished; 2 usage or deck; 3 numerical failure; 4 files; '//nl &
         //'5 partition or MPI; 75 stopped early with a valid checkpoint.'
   end function help_text

   !> A minus alone is standard input, no option.
   pure function is_option(argument) result(is)
      character(len=*), intent(in) :: argument
      logical :: is

      is = .false.
      if (len(argument) > 1) is = argument(1:1) == '-'
   end function is_option

   subroutine take_option(arguments, i, options, error)
      type(string_t), intent(in) :: arguments(:)
      integer, intent(inout) :: i                         !! place of the option; then of its value
      type(options_t), intent(inout) :: options
      type(error_t), allocatable, intent(out) :: error

      select case (before_equals(arguments(i)%s))
      case ('--restart', '--max-wall')
         call raise(error, code_usage, "'"//before_equals(arguments(i)%s) &
            //"' needs checkpoints, which this " &
            //'version does not write: it can only run a deck from the start to its end')
         return
      end select
      select case (arguments(i)%s)
      case ('--help', '-h'); options%help = .true.
      case ('--version'); options%version = .true.
      case ('--check'); options%check = .true.
      case ('--quiet'); options%quiet = .true.
      case ('--keywords'); options%keywords = .true.
      case ('--keywords=markdown')
         options%keywords = .true.
         options%markdown = .true.
      case ('-o'); call take_folder(arguments, i, options, error)
      case default
         call raise(error, code_usage, "unknown option '"//arguments(i)%s//"'" &
            //did_you_mean(arguments(i)%s, known_options())//see_help)
      end select
   end subroutine take_option

   subroutine take_folder(arguments, i, options, error)
      type(string_t), intent(in) :: arguments(:)
      integer, intent(inout) :: i
      type(options_t), intent(inout) :: options
      type(error_t), allocatable, intent(out) :: error

      i = i + 1
      if (i <= size(arguments)) then
         if (len(arguments(i)%s) > 0 .and. .not. is_option(arguments(i)%s)) then
            options%folder = arguments(i)%s
            return
         end if
      end if
      call raise(error, code_usage, "'-o' must be followed by a folder"//see_help)
   end subroutine take_folder

   subroutine take_deck(argument, has_deck, options, error)
      character(len=*), intent(in) :: argument
      logical, intent(inout) :: has_deck
      type(options_t), intent(inout) :: options
      type(error_t), allocatable, intent(out) :: error

      if (has_deck) then
         call raise(error, code_usage, "only one deck can be run, and '"//argument &
            //"' is a second one"//see_help)
      else if (len_trim(argument) == 0) then
         call raise(error, code_usage, 'the name of the deck is blank'//see_help)
      else if (argument /= '-') then
         options%deck = argument
      end if
      has_deck = .true.
   end subroutine take_deck

   pure function before_equals(argument) result(option)
      character(len=*), intent(in) :: argument
      character(len=:), allocatable :: option

      option = argument
      if (index(argument, '=') > 0) option = argument(:index(argument, '=') - 1)
   end function before_equals

   pure function known_options() result(names)
      type(string_t), allocatable :: names(:)
      integer :: i

      allocate (names(0))
      do i = 1, size(known)
         call append(names, trim(known(i)))
      end do
   end function known_options
end module xmpm_command_line
