!> Tokens to blocks and entries, checked against the names in the keyword table.
module xmpm_deck_parser
   use xmpm_text, only: lower
   use xmpm_text_lists, only: append, join, upper, shown
   use xmpm_expression, only: is_identifier
   use xmpm_keywords, only: keyword_t, keyword_place, key_place, keyword_names, key_names, &
      kind_flag, kind_text, kind_word, no_name, must_have_name
   use xmpm_deck_data, only: deck_t, block_t, entry_t, note_problem, add_block, add_entry, &
      block_named, complain, has, entry_place, find_block
   use xmpm_deck_lexer, only: tokens_t, place_of_row, token_value, token_equals, token_comma, &
      token_keyword
   use xmpm_deck_hints, only: did_you_mean
   use xmpm_text, only: to_text
   implicit none
   private

   public :: build_blocks

contains

   !> All blocks of a deck.
   subroutine build_blocks(tokens, table, deck)
      type(tokens_t), intent(in) :: tokens     !! of the whole deck
      type(keyword_t), intent(in) :: table(:)  !! all keywords
      type(deck_t), intent(inout) :: deck      !! gets blocks, definitions and problems
      integer :: place
      logical :: ended

      ended = .false.
      place = 1
      if (kind_at(tokens, 1) /= token_keyword .and. tokens%count > 0) then
         call blame(deck, tokens, 1, "'"//shown(tokens%list(1)%text) &
            //"' stands before the first keyword")
         call skip_to_keyword(tokens, place)
      end if
      do while (place <= tokens%count)
         ended = ended .or. tokens%list(place)%text == 'end'
         call read_block(tokens, table, deck, place)
      end do
      if (.not. ended) call note_problem(deck, huge(place), deck%name &
         //': the deck does not end with *END: is it truncated?')
   end subroutine build_blocks

   !> One keyword and all up to the next one.
   subroutine read_block(tokens, table, deck, place)
      type(tokens_t), intent(in) :: tokens
      type(keyword_t), intent(in) :: table(:)
      type(deck_t), intent(inout) :: deck
      integer, intent(inout) :: place            !! of the keyword; then of the next one
      integer :: start, found
      character(len=:), allocatable :: name

      start = place
      name = tokens%list(start)%text
      place = place + 1
      found = keyword_place(table, name)
      if (found == 0) then
         call blame(deck, tokens, start, "unknown keyword '*"//shown(upper(name))//"'" &
            //did_you_mean('*'//upper(name), keyword_names(table)))
         call skip_to_keyword(tokens, place)
      else if (name == 'parameter') then
         call read_parameters(tokens, deck, place)
      else if (name == 'include') then
         call blame(deck, tokens, start, &
            '*INCLUDE can stand only in a deck that is read from a file')
         call skip_to_keyword(tokens, place)
      else if (.not. table(found)%directive) then
         call read_data(tokens, table(found), deck, place)
      else
         call skip_to_keyword(tokens, place)
      end if
   end subroutine read_block

   !> A keyword that holds data: its name and its entries.
   subroutine read_data(tokens, keyword, deck, place)
      type(tokens_t), intent(in) :: tokens
      type(keyword_t), intent(in) :: keyword
      type(deck_t), intent(inout) :: deck
      integer, intent(inout) :: place            !! behind the keyword; then of the next one
      type(block_t) :: block

      block%keyword = trim(keyword%name)
      block%row = tokens%list(place - 1)%row
      block%file = tokens%files(tokens%row_file(block%row))%s
      block%line = tokens%row_line(block%row)
      allocate (block%entries(0))
      call read_name(tokens, keyword, deck, block, place)
      call check_twin(deck, keyword, block)
      do while (place <= tokens%count)
         if (kind_at(tokens, place) == token_keyword) exit
         call read_entry(tokens, keyword, deck, block, place)
      end do
      call add_block(deck, block)
   end subroutine read_data

   !> A value that is not the key before a '='.
   pure function is_free_value(tokens, place) result(is)
      type(tokens_t), intent(in) :: tokens
      integer, intent(in) :: place
      logical :: is

      is = kind_at(tokens, place) == token_value .and. kind_at(tokens, place + 1) /= token_equals
   end function is_free_value

   subroutine read_name(tokens, keyword, deck, block, place)
      type(tokens_t), intent(in) :: tokens
      type(keyword_t), intent(in) :: keyword
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      integer, intent(inout) :: place

      block%name = ''
      if (keyword%naming == no_name) return
      if (is_free_value(tokens, place) .and. row_at(tokens, place) == block%row) then
         block%name = tokens%list(place)%text
         place = place + 1
      end if
      if (len(block%name) == 0 .and. keyword%naming == must_have_name) then
         call complain(deck, block, '', 'a name must follow the keyword on its line')
      end if
      if (.not. is_free_value(tokens, place)) return
      if (row_at(tokens, place) /= block%row .or. kind_at(tokens, place - 1) /= token_value) return
      if (key_place(keyword, lower(tokens%list(place)%text)) > 0) return
      call complain(deck, block, '', "'"//shown(tokens%list(place)%text) &
         //"' follows the name: a name with blanks must be in quotes")
      do while (is_free_value(tokens, place) .and. row_at(tokens, place) == block%row)
         place = place + 1
      end do
   end subroutine read_name

   !> Only one block of some keywords, and only one block of a name.
   subroutine check_twin(deck, keyword, block)
      type(deck_t), intent(inout) :: deck
      type(keyword_t), intent(in) :: keyword
      type(block_t), intent(in) :: block
      type(block_t) :: first
      integer :: twin

      twin = 0
      if (.not. keyword%repeatable) then
         first = find_block(deck, block%keyword, 1)
         if (first%line > 0) call complain(deck, block, '', &
            'only one is allowed, and the first is at ' &
            //first%file//':'//to_text(first%line))
      else if (len(block%name) > 0) then
         twin = block_named(deck, block%keyword, block%name)
      end if
      if (twin == 0) return
      first = find_block(deck, block%keyword, twin)
      call complain(deck, block, '', 'the name is already taken at '//first%file//':' &
         //to_text(first%line))
   end subroutine check_twin

   !> `key = values`, or a flag.
   subroutine read_entry(tokens, keyword, deck, block, place)
      type(tokens_t), intent(in) :: tokens
      type(keyword_t), intent(in) :: keyword
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      integer, intent(inout) :: place            !! at the entry; then behind it
      type(entry_t) :: entry
      integer :: found

      if (kind_at(tokens, place) == token_comma) then
         place = place + 1
         return
      else if (kind_at(tokens, place) == token_equals) then
         call blame(deck, tokens, place, "'=' without a key before it")
         place = place + 1
         call skip_values(tokens, place)
         return
      end if
      call start_entry(tokens, place, entry)
      found = key_place(keyword, entry%key)
      if (found == 0) then
         call blame_key(deck, tokens, place, keyword)
         place = place + 1
         if (kind_at(tokens, place) == token_equals) place = place + 1
         call skip_values(tokens, place)
      else
         call read_values(tokens, keyword, found, deck, entry, place)
         call keep_entry(deck, block, entry, keyword%keys(found)%repeatable)
      end if
   end subroutine read_entry

   subroutine start_entry(tokens, place, entry)
      type(tokens_t), intent(in) :: tokens
      integer, intent(in) :: place
      type(entry_t), intent(inout) :: entry

      entry%key = lower(tokens%list(place)%text)
      entry%row = tokens%list(place)%row
      entry%file = tokens%files(tokens%row_file(entry%row))%s
      entry%line = tokens%row_line(entry%row)
      allocate (entry%texts(0), entry%quoted(0))
   end subroutine start_entry

   subroutine blame_key(deck, tokens, place, keyword)
      type(deck_t), intent(inout) :: deck
      type(tokens_t), intent(in) :: tokens
      integer, intent(in) :: place
      type(keyword_t), intent(in) :: keyword

      if (size(keyword%keys) == 0) then
         call blame(deck, tokens, place, '*'//upper(trim(keyword%name)) &
            //" takes no keys, but here is '" &
            //shown(tokens%list(place)%text)//"'")
      else if (is_identifier(tokens%list(place)%text)) then
         call blame(deck, tokens, place, "unknown key '"//shown(tokens%list(place)%text)//"' of *" &
            //upper(trim(keyword%name))//did_you_mean(tokens%list(place)%text, key_names(keyword)) &
            //' Known: '//join(key_names(keyword), ', '))
      else
         call blame(deck, tokens, place, "'"//shown(tokens%list(place)%text) &
            //"' stands where a key of *" &
            //upper(trim(keyword%name))//' must be: '//join(key_names(keyword), ', '))
      end if
   end subroutine blame_key

   !> The values behind `key =`; a flag may stand alone.
   subroutine read_values(tokens, keyword, found, deck, entry, place)
      type(tokens_t), intent(in) :: tokens
      type(keyword_t), intent(in) :: keyword
      integer, intent(in) :: found               !! place of the key
      type(deck_t), intent(inout) :: deck
      type(entry_t), intent(inout) :: entry
      integer, intent(inout) :: place            !! at the key; then behind its values

      place = place + 1
      if (kind_at(tokens, place) == token_equals) then
         place = place + 1
         call collect_values(tokens, keyword, found, deck, entry, place)
         if (size(entry%texts) == 0) then
            call blame(deck, tokens, place - 1, "'"//entry%key//" =' has no value")
            entry%valid = .false.
         end if
      else if (keyword%keys(found)%kind == kind_flag) then
         call append(entry%texts, 'yes')
         entry%quoted = [.false.]
      else
         call blame(deck, tokens, place - 1, "'"//entry%key//"' must be followed by '= value'")
         entry%valid = .false.
         call skip_values(tokens, place)
      end if
   end subroutine read_values

   subroutine collect_values(tokens, keyword, found, deck, entry, place)
      type(tokens_t), intent(in) :: tokens
      type(keyword_t), intent(in) :: keyword
      integer, intent(in) :: found
      type(deck_t), intent(inout) :: deck
      type(entry_t), intent(inout) :: entry
      integer, intent(inout) :: place            !! behind '='; then behind the values
      integer :: last, i, count

      last = last_value(tokens, keyword, found, place)
      count = 0
      do i = place, last
         if (kind_at(tokens, i) == token_value) count = count + 1
      end do
      deallocate (entry%texts, entry%quoted)
      allocate (entry%texts(count), entry%quoted(count))
      count = 0
      do i = place, last
         if (kind_at(tokens, i) == token_value) then
            count = count + 1
            entry%texts(count)%s = tokens%list(i)%text
            entry%quoted(count) = tokens%list(i)%quoted
         else if (kind_at(tokens, i - 1) /= token_value) then
            call blame(deck, tokens, i, "a value of '"//entry%key//"' is missing before a comma")
            entry%valid = .false.
         end if
      end do
      place = last + 1
   end subroutine collect_values

   !> Where a list of values ends: before a keyword, before `word =`, or before a flag.
   pure function last_value(tokens, keyword, found, first) result(last)
      type(tokens_t), intent(in) :: tokens
      type(keyword_t), intent(in) :: keyword
      integer, intent(in) :: found
      integer, intent(in) :: first
      integer :: last, count

      count = 0
      last = first - 1
      do while (last < tokens%count)
         if (kind_at(tokens, last + 1) /= token_value .and. kind_at(tokens, &
            last + 1) /= token_comma) return
         if (kind_at(tokens, last + 2) == token_equals) return
         if (kind_at(tokens, last + 1) == token_value) then
            if (is_flag(tokens, keyword, last + 1) .and. ends_at_flag(keyword, found, count)) return
            count = count + 1
         end if
         last = last + 1
      end do
   end function last_value

   !> A list of numbers ends at a flag; a list of words does when it has all its words.
   pure function ends_at_flag(keyword, found, count) result(ends)
      type(keyword_t), intent(in) :: keyword
      integer, intent(in) :: found
      integer, intent(in) :: count    !! values so far
      logical :: ends

      associate (key => keyword%keys(found))
         ends = count >= key%most .or. (key%kind /= kind_text .and. key%kind /= kind_word)
      end associate
   end function ends_at_flag

   pure function is_flag(tokens, keyword, place) result(is)
      type(tokens_t), intent(in) :: tokens
      type(keyword_t), intent(in) :: keyword
      integer, intent(in) :: place
      logical :: is
      integer :: found

      is = .false.
      if (tokens%list(place)%quoted) return
      found = key_place(keyword, lower(tokens%list(place)%text))
      if (found > 0) is = keyword%keys(found)%kind == kind_flag
   end function is_flag

   subroutine keep_entry(deck, block, entry, repeatable)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(inout) :: block
      type(entry_t), intent(in) :: entry
      logical, intent(in) :: repeatable

      if (has(block, entry%key) .and. .not. repeatable) then
         associate (first => block%entries(entry_place(block, entry%key)))
            call note_problem(deck, entry%row, entry%file//':'//to_text(entry%line)//": '" &
               //entry%key &
               //"' is given twice, first at "//first%file//':'//to_text(first%line))
         end associate
      else
         call add_entry(block%entries, entry)
      end if
   end subroutine keep_entry

   !> name = expression, name = expression ...
   subroutine read_parameters(tokens, deck, place)
      type(tokens_t), intent(in) :: tokens
      type(deck_t), intent(inout) :: deck
      integer, intent(inout) :: place            !! behind the keyword; then of the next one
      type(entry_t) :: entry

      do while (place <= tokens%count)
         if (kind_at(tokens, place) == token_keyword) exit
         if (kind_at(tokens, place) == token_value .and. kind_at(tokens, &
            place + 1) == token_equals) then
            entry = entry_t()
            call start_entry(tokens, place, entry)
            if (kind_at(tokens, place + 2) == token_value .and. kind_at(tokens, &
               place + 3) /= token_equals) then
               call append(entry%texts, tokens%list(place + 2)%text)
               entry%quoted = [tokens%list(place + 2)%quoted]
               place = place + 3
            else
               call blame(deck, tokens, place, "'"//entry%key//" =' has no value")
               place = place + 2
               entry%valid = .false.
            end if
            call add_entry(deck%definitions, entry)
         else if (kind_at(tokens, place) == token_comma) then
            place = place + 1
         else
            call blame(deck, tokens, place, "'"//shown(tokens%list(place)%text) &
               //"' stands where 'name = expression' " &
               //'must be; blanks may stand only inside parentheses')
            place = place + 1
            call skip_values(tokens, place)
         end if
      end do
   end subroutine read_parameters

   pure subroutine skip_to_keyword(tokens, place)
      type(tokens_t), intent(in) :: tokens
      integer, intent(inout) :: place

      do while (place <= tokens%count)
         if (kind_at(tokens, place) == token_keyword) exit
         place = place + 1
      end do
   end subroutine skip_to_keyword

   !> Go to the next keyword or `word =`.
   pure subroutine skip_values(tokens, place)
      type(tokens_t), intent(in) :: tokens
      integer, intent(inout) :: place

      do while (kind_at(tokens, place) == token_value .or. kind_at(tokens, place) == token_comma)
         if (kind_at(tokens, place + 1) == token_equals) exit
         place = place + 1
      end do
   end subroutine skip_values

   !> Kind of a token; 0 outside of the list.
   pure function kind_at(tokens, place) result(kind)
      type(tokens_t), intent(in) :: tokens
      integer, intent(in) :: place
      integer :: kind

      kind = 0
      if (place >= 1 .and. place <= tokens%count) kind = tokens%list(place)%kind
   end function kind_at

   pure function row_at(tokens, place) result(row)
      type(tokens_t), intent(in) :: tokens
      integer, intent(in) :: place
      integer :: row

      row = 0
      if (place >= 1 .and. place <= tokens%count) row = tokens%list(place)%row
   end function row_at

   subroutine blame(deck, tokens, place, message)
      type(deck_t), intent(inout) :: deck
      type(tokens_t), intent(in) :: tokens
      integer, intent(in) :: place               !! of a token
      character(len=*), intent(in) :: message

      associate (row => tokens%list(place)%row)
         call note_problem(deck, row, place_of_row(tokens, row)//message)
      end associate
   end subroutine blame
end module xmpm_deck_parser
