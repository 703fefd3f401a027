!> Reading the text of a deck from a file or from standard input, with the files it includes.
module xmpm_deck_files
   use, intrinsic :: iso_fortran_env, only: input_unit, iostat_end, iostat_eor
   use xmpm_kinds, only: i8
   use xmpm_error, only: error_t, raise, code_files
   use xmpm_text, only: string_t, to_text
   use xmpm_text_lists, only: append
   use xmpm_deck_lexer, only: tokens_t, cut_line, marker, file_marker, fault_marker, &
      token_keyword, token_value
   implicit none
   private

   public :: read_deck, deck_name

   integer, parameter :: deepest = 16   !! includes inside of includes

   !> A text that grows without being copied at every line.
   type :: buffer_t
      character(len=:), allocatable :: text   !! with room behind `length`
      integer(i8) :: length = 0               !! characters in use
   end type buffer_t

contains

   !> The whole text of a deck, its included files put in place, ready for parse_deck.
   subroutine read_deck(path, text, error)
      character(len=*), intent(in) :: path                  !! file; blank for standard input
      character(len=:), allocatable, intent(out) :: text    !! lines split by new_line
      type(error_t), allocatable, intent(out) :: error      !! set where the file cannot be read
      type(buffer_t) :: buffer
      type(string_t), allocatable :: open_files(:)
      character(len=:), allocatable :: fault

      call append(open_files, deck_name(path))
      if (len_trim(path) == 0) then
         call add_lines(input_unit, open_files, buffer, fault)
      else
         call add_file(path, open_files, buffer, fault)
      end if
      text = ''
      if (allocated(fault)) then
         call raise(error, code_files, deck_name(path)//': '//fault)
      else if (buffer%length > 0) then
         text = buffer%text(:buffer%length)
      end if
   end subroutine read_deck

   !> How messages call a deck: its path, or that it is standard input.
   pure function deck_name(path) result(name)
      character(len=*), intent(in) :: path   !! file; blank for standard input
      character(len=:), allocatable :: name

      name = trim(path)
      if (len(name) == 0) name = 'standard input'
   end function deck_name

   recursive subroutine add_file(path, open_files, buffer, fault)
      character(len=*), intent(in) :: path
      type(string_t), intent(in) :: open_files(:)   !! this file is the last of them
      type(buffer_t), intent(inout) :: buffer
      character(len=:), allocatable, intent(inout) :: fault   !! set where it cannot be opened
      integer :: unit, status
      character(len=200) :: message
      logical :: is_folder

      inquire (file=path//'/.', exist=is_folder)
      if (is_folder) then
         fault = 'it is a folder, not a file'
         return
      end if
      open (newunit=unit, file=path, status='old', action='read', iostat=status, iomsg=message)
      if (status /= 0) then
         fault = 'the file cannot be opened: '//trim(message)
         return
      end if
      call add_lines(unit, open_files, buffer, fault)
      close (unit)
   end subroutine add_file

   !> All lines of a file that is open.
   recursive subroutine add_lines(unit, open_files, buffer, fault)
      integer, intent(in) :: unit
      type(string_t), intent(in) :: open_files(:)
      type(buffer_t), intent(inout) :: buffer
      character(len=:), allocatable, intent(inout) :: fault
      character(len=:), allocatable :: line, name, keyword
      integer :: number, status
      logical :: included

      included = size(open_files) > 1
      number = 0
      do
         call read_line(unit, line, status)
         if (status == iostat_end) exit
         if (status > 0) then
            fault = 'the file cannot be read behind line '//to_text(number)
            exit
         end if
         number = number + 1
         call first_words(line, keyword, name)
         if (included .and. keyword == 'end') exit
         if (keyword == 'include') then
            call include_file(name, open_files, number, buffer)
         else
            call add_text(buffer, without_markers(line)//new_line('a'))
         end if
      end do
   end subroutine add_lines

   !> Put an included file in place of its line, or say there why it cannot be.
   recursive subroutine include_file(name, open_files, number, buffer)
      character(len=*), intent(in) :: name              !! as written
      type(string_t), intent(in) :: open_files(:)
      integer, intent(in) :: number                     !! line of the *INCLUDE
      type(buffer_t), intent(inout) :: buffer
      character(len=:), allocatable :: path, fault
      type(string_t), allocatable :: deeper(:)
      integer(i8) :: start
      integer :: i

      path = beside(name, open_files(size(open_files))%s)
      start = buffer%length
      if (len_trim(name) == 0) fault = 'the name of a file must follow on the same line'
      if (size(open_files) >= deepest) fault = 'files are included more than ' &
         //to_text(deepest)//' deep'
      do i = 1, size(open_files)
         if (open_files(i)%s == path) fault = 'the file includes itself'
      end do
      if (.not. allocated(fault)) then
         deeper = open_files
         call append(deeper, path)
         call add_text(buffer, marker//file_marker//'1 '//path//new_line('a'))
         call add_file(path, deeper, buffer, fault)
      end if
      if (allocated(fault)) then
         buffer%length = start
         call add_text(buffer, marker//fault_marker//"*INCLUDE '"//name//"': "//fault &
            //new_line('a'))
      else
         call add_text(buffer, marker//file_marker//to_text(number + 1)//' ' &
            //open_files(size(open_files))%s//new_line('a'))
      end if
   end subroutine include_file

   !> Path of a file that is named in another one.
   pure function beside(name, file) result(path)
      character(len=*), intent(in) :: name   !! absolute, or relative to the folder of `file`
      character(len=*), intent(in) :: file
      character(len=:), allocatable :: path

      path = name
      if (index(name, '/') == 1) return
      path = file(:index(file, '/', back=.true.))//name
   end function beside

   !> The keyword of a line and the first value behind it; blank where it has none.
   subroutine first_words(line, keyword, name)
      character(len=*), intent(in) :: line
      character(len=:), allocatable, intent(out) :: keyword
      character(len=:), allocatable, intent(out) :: name
      type(tokens_t) :: tokens
      character(len=:), allocatable :: fault

      keyword = ''
      name = ''
      if (index(adjustl(line), '*') /= 1 .and. index(line, achar(9)) == 0) return
      call cut_line(line, 1, tokens, fault)
      if (tokens%count == 0) return
      if (tokens%list(1)%kind == token_keyword) keyword = tokens%list(1)%text
      if (tokens%count == 1) return
      if (tokens%list(2)%kind == token_value) name = tokens%list(2)%text
   end subroutine first_words

   !> A line of any length.
   subroutine read_line(unit, line, status)
      integer, intent(in) :: unit
      character(len=:), allocatable, intent(out) :: line
      integer, intent(out) :: status     !! 0, iostat_end, or positive for a failure
      character(len=512) :: piece
      integer :: length

      line = ''
      do
         read (unit, '(a)', advance='no', size=length, iostat=status) piece
         if (status > 0) return
         line = line//piece(:length)
         if (status /= 0) exit
      end do
      if (status == iostat_eor .or. len(line) > 0) status = 0
   end subroutine read_line

   !> A line that does not look like one that this module puts in.
   pure function without_markers(line) result(clean)
      character(len=*), intent(in) :: line
      character(len=:), allocatable :: clean

      clean = line
      if (len(line) == 0) return
      if (line(1:1) == marker) clean(1:1) = achar(2)
   end function without_markers

   subroutine add_text(buffer, text)
      type(buffer_t), intent(inout) :: buffer
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: longer
      integer(i8) :: needed

      needed = buffer%length + len(text, i8)
      if (.not. allocated(buffer%text)) allocate (character(len=4096) :: buffer%text)
      if (needed > len(buffer%text, i8)) then
         allocate (character(len=2*needed) :: longer)
         longer(:buffer%length) = buffer%text(:buffer%length)
         call move_alloc(longer, buffer%text)
      end if
      buffer%text(buffer%length + 1:needed) = text
      buffer%length = needed
   end subroutine add_text
end module xmpm_deck_files
