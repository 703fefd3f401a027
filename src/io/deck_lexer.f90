!> The text of a deck cut into tokens, each with the file and line it came from.
module xmpm_deck_lexer
   use xmpm_text, only: string_t, to_text, lower
   use xmpm_text_lists, only: append
   use xmpm_numbers, only: parse_integer, number_good
   use xmpm_deck_data, only: deck_t, note_problem
   implicit none
   private

   public :: token_t, tokens_t, cut_into_tokens, cut_line, place_of_row
   public :: token_value, token_equals, token_comma, token_keyword
   public :: marker, file_marker, fault_marker

   integer, parameter :: token_value = 1     !! a number, a word, a quoted text, an expression
   integer, parameter :: token_equals = 2    !! =
   integer, parameter :: token_comma = 3     !! ,
   integer, parameter :: token_keyword = 4   !! a word behind a star at the start of a line

   character(len=1), parameter :: marker = achar(1)   !! starts a line put in by the reader of files
   character(len=1), parameter :: file_marker = 'F'   !! then 'line file' of the next line
   character(len=1), parameter :: fault_marker = 'E'  !! then what could not be read at this place
   character(len=1), parameter :: tab = achar(9)
   character(len=3), parameter :: byte_order_mark = char(239)//char(187)//char(191)

   !> One token.
   type :: token_t
      integer :: kind = token_value          !! one of the kinds above
      character(len=:), allocatable :: text  !! without quotes or star; keywords in lower case
      logical :: quoted = .false.            !! some of it was in quotes
      integer :: row = 0                     !! line counted through all included files
   end type token_t

   !> All tokens, and the place of each row.
   type :: tokens_t
      type(token_t), allocatable :: list(:)    !! (count) and room for more
      integer :: count = 0                     !! tokens in the list
      type(string_t), allocatable :: files(:)  !! names of the files
      integer, allocatable :: row_file(:)      !! (rows) place in files
      integer, allocatable :: row_line(:)      !! (rows) line in its file
   end type tokens_t

contains

   !> Cut a whole deck up to its *END.
   subroutine cut_into_tokens(text, deck, tokens)
      character(len=*), intent(in) :: text      !! lines split by new_line
      type(deck_t), intent(inout) :: deck       !! gets problems
      type(tokens_t), intent(out) :: tokens     !! the result
      integer :: first, last, row, line
      character(len=:), allocatable :: fault
      logical :: ended

      call append(tokens%files, deck%name)
      row = count_lines(text)
      allocate (tokens%row_file(row), source=1)
      allocate (tokens%row_line(row), source=0)
      allocate (tokens%list(64))
      first = 1
      if (index(text, byte_order_mark) == 1) first = 1 + len(byte_order_mark)
      line = 0
      ended = .false.
      do row = 1, size(tokens%row_file)
         last = first + index(text(first:), new_line('a')) - 2
         if (last < first - 1) last = len(text)
         line = line + 1
         tokens%row_line(row) = line
         if (row > 1) tokens%row_file(row) = tokens%row_file(row - 1)
         if (is_marker(text(first:last))) then
            call obey_marker(text(first + 1:last), deck, tokens, row, line)
         else if (.not. ended) then
            call cut_line(text(first:last), row, tokens, fault)
            if (allocated(fault)) call note_problem(deck, row, place_of_row(tokens, row)//fault)
            ended = ends_deck(tokens)
         else if (has_content(text(first:last))) then
            call append(deck%warnings, place_of_row(tokens, row)//'text behind *END is not read')
            exit
         end if
         first = last + 2
         if (too_many_problems(deck)) then
            call note_problem(deck, row, place_of_row(tokens, row)//'too many problems: is this ' &
               //'a deck? The rest is not read')
            exit
         end if
      end do
   end subroutine cut_into_tokens

   !> Whether so much is wrong with the characters alone that the text is hardly a deck.
   pure function too_many_problems(deck) result(too_many)
      type(deck_t), intent(in) :: deck
      logical :: too_many
      integer, parameter :: most = 100

      too_many = .false.
      if (allocated(deck%problems)) too_many = size(deck%problems) >= most
   end function too_many_problems

   !> 'file:line: ' of a row.
   pure function place_of_row(tokens, row) result(text)
      type(tokens_t), intent(in) :: tokens   !! cut
      integer, intent(in) :: row             !! 1 .. rows
      character(len=:), allocatable :: text

      text = tokens%files(tokens%row_file(row))%s//':'//to_text(tokens%row_line(row))//': '
   end function place_of_row

   !> Cut one line.
   pure subroutine cut_line(line, row, tokens, fault)
      character(len=*), intent(in) :: line                   !! without its end
      integer, intent(in) :: row                                   !! its number
      type(tokens_t), intent(inout) :: tokens                      !! gets its tokens
      character(len=:), allocatable, intent(out) :: fault          !! what is wrong, if anything is
      integer :: place, length, bad

      length = len_trim(line)
      if (length > 0) then
         if (line(length:length) == achar(13)) length = length - 1
      end if
      bad = first_control(line(:length))
      if (bad > 0) then
         fault = 'the line holds a control character (code '//to_text(iachar(line(bad:bad)))//')'
         return
      end if
      place = verify(line(:length), ' '//tab)
      if (place == 0) return
      if (line(place:place) == '#') return
      if (line(place:place) == '*') call cut_keyword(line(:length), row, tokens, place)
      do while (place <= length)
         if (scan(line(place:place), '!$') == 1) exit
         call cut_token(line(:length), row, tokens, place, fault)
      end do
   end subroutine cut_line

   !> One token, or a blank, at `place`.
   pure subroutine cut_token(line, row, tokens, place, fault)
      character(len=*), intent(in) :: line
      integer, intent(in) :: row
      type(tokens_t), intent(inout) :: tokens
      integer, intent(inout) :: place                                !! behind the token on return
      character(len=:), allocatable, intent(inout) :: fault

      select case (line(place:place))
      case (' ', tab)
         place = place + 1
      case (',')
         call add_token(tokens, token_comma, ',', .false., row)
         place = place + 1
      case ('=')
         call add_token(tokens, token_equals, '=', .false., row)
         place = place + 1
      case default
         call cut_value(line, row, tokens, place, fault)
      end select
   end subroutine cut_token

   pure subroutine cut_keyword(line, row, tokens, place)
      character(len=*), intent(in) :: line
      integer, intent(in) :: row
      type(tokens_t), intent(inout) :: tokens
      integer, intent(inout) :: place
      integer :: first

      first = place + 1
      if (first <= len(line)) first = max(first, place + verify(line(first:), ' '//tab))
      place = first
      do while (place <= len(line))
         if (scan(line(place:place), ' ,=!$'//tab) == 1) exit
         place = place + 1
      end do
      call add_token(tokens, token_keyword, lower(line(first:place - 1)), .false., row)
   end subroutine cut_keyword

   !> A value: up to a blank, comma, = or comment outside of quotes and parentheses.
   pure subroutine cut_value(line, row, tokens, place, fault)
      character(len=*), intent(in) :: line
      integer, intent(in) :: row
      type(tokens_t), intent(inout) :: tokens
      integer, intent(inout) :: place
      character(len=:), allocatable, intent(inout) :: fault
      character(len=:), allocatable :: text
      integer :: depth, last, length
      logical :: quoted
      character(len=1) :: c

      allocate (character(len=len(line) - place + 1) :: text)
      length = 0
      depth = 0
      quoted = .false.
      do while (place <= len(line))
         c = line(place:place)
         if (c == '!' .or. c == '$') exit
         if (depth == 0 .and. scan(c, ' ,='//tab) == 1) exit
         if (c == '"' .or. c == "'") then
            last = place + index(line(place + 1:), c)
            if (last == place) then
               fault = 'a quote is opened and not closed on this line'
               last = len(line) + 1
            end if
            text(length + 1:length + last - place - 1) = line(place + 1:last - 1)
            length = length + last - place - 1
            quoted = .true.
            place = last + 1
         else
            if (c == '(') depth = depth + 1
            if (c == ')') depth = max(0, depth - 1)
            length = length + 1
            text(length:length) = c
            place = place + 1
         end if
      end do
      if (depth > 0) fault = 'a parenthesis is opened and not closed on this line'
      call add_token(tokens, token_value, text(:length), quoted, row)
   end subroutine cut_value

   pure subroutine add_token(tokens, kind, text, quoted, row)
      type(tokens_t), intent(inout) :: tokens
      integer, intent(in) :: kind
      character(len=*), intent(in) :: text
      logical, intent(in) :: quoted
      integer, intent(in) :: row
      type(token_t), allocatable :: longer(:)
      integer :: i

      if (.not. allocated(tokens%list)) allocate (tokens%list(16))
      if (tokens%count == size(tokens%list)) then
         allocate (longer(2*tokens%count))
         do i = 1, tokens%count
            longer(i)%kind = tokens%list(i)%kind
            longer(i)%quoted = tokens%list(i)%quoted
            longer(i)%row = tokens%list(i)%row
            call move_alloc(tokens%list(i)%text, longer(i)%text)
         end do
         call move_alloc(longer, tokens%list)
      end if
      tokens%count = tokens%count + 1
      tokens%list(tokens%count)%kind = kind
      tokens%list(tokens%count)%text = text
      tokens%list(tokens%count)%quoted = quoted
      tokens%list(tokens%count)%row = row
   end subroutine add_token

   !> Take the place of the next line, or a fault, from a line that the reader of files put in.
   subroutine obey_marker(text, deck, tokens, row, line)
      character(len=*), intent(in) :: text        !! behind the marker
      type(deck_t), intent(inout) :: deck         !! gets the fault
      type(tokens_t), intent(inout) :: tokens     !! gets the file
      integer, intent(in) :: row
      integer, intent(inout) :: line   !! of this row; on return of the row before the next one
      integer :: blank, status, next

      if (text(1:1) == fault_marker) then
         call note_problem(deck, row, place_of_row(tokens, row)//text(2:))
         return
      end if
      line = line - 1
      tokens%row_line(row) = line
      blank = index(text, ' ')
      if (blank < 3) return
      call parse_integer(text(2:blank - 1), next, status)
      if (status /= number_good) return
      line = next - 1
      tokens%row_line(row) = line
      call append(tokens%files, text(blank + 1:))
      tokens%row_file(row) = size(tokens%files)
   end subroutine obey_marker

   pure function is_marker(line) result(is)
      character(len=*), intent(in) :: line
      logical :: is

      is = .false.
      if (len(line) < 2) return
      is = line(1:1) == marker .and. (line(2:2) == file_marker .or. line(2:2) == fault_marker)
   end function is_marker

   pure function ends_deck(tokens) result(ended)
      type(tokens_t), intent(in) :: tokens
      logical :: ended
      integer :: i

      ended = .false.
      do i = tokens%count, 1, -1
         if (tokens%list(i)%row /= tokens%list(tokens%count)%row) exit
         ended = tokens%list(i)%kind == token_keyword .and. tokens%list(i)%text == 'end'
      end do
   end function ends_deck

   pure function has_content(line) result(has)
      character(len=*), intent(in) :: line
      logical :: has
      integer :: place

      place = verify(line, ' '//tab//achar(13))
      has = place > 0
      if (has) has = scan(line(place:place), '!$#') == 0
   end function has_content

   pure function first_control(line) result(place)
      character(len=*), intent(in) :: line
      integer :: place

      do place = 1, len(line)
         if (iachar(line(place:place)) < 32 .and. line(place:place) /= tab) return
         if (iachar(line(place:place)) == 127) return
      end do
      place = 0
   end function first_control

   pure function count_lines(text) result(n)
      character(len=*), intent(in) :: text
      integer :: n, i

      n = 1
      do i = 1, len(text)
         if (text(i:i) == new_line('a')) n = n + 1
      end do
   end function count_lines
end module xmpm_deck_lexer
