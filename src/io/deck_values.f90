!> Texts of the deck to values: parameters, expressions, counts, ranges, allowed words and defaults.
module xmpm_deck_values
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_text, only: string_t, to_text, lower
   use xmpm_text_lists, only: join, upper, shown
   use xmpm_numbers, only: parse_real, number_good
   use xmpm_expression, only: variables_t, evaluate, define, is_reserved, is_identifier
   use xmpm_keywords, only: keyword_t, key_t, keyword_place, key_place, split_words, in_range, &
      kind_real, kind_integer, kind_word, kind_text, kind_flag, kind_axis
   use xmpm_deck_data, only: deck_t, block_t, entry_t, note_problem, has, add_block, add_entry, &
      count_blocks, complain
   use xmpm_deck_hints, only: did_you_mean
   implicit none
   private

   public :: evaluate_parameters, evaluate_entries, fill_defaults, check_required

contains

   !> Give all parameters their values, whatever the order in which they are written.
   subroutine evaluate_parameters(deck)
      type(deck_t), intent(inout) :: deck   !! gets parameters and problems
      logical :: done(size(deck%definitions)), unknown
      type(error_t), allocatable :: error
      real(wp) :: value
      type(entry_t) :: definition
      integer :: i, before

      done = .false.
      call check_definitions(deck, done)
      before = -1
      do while (count(done) > before)
         before = count(done)
         do i = 1, size(done)
            if (done(i)) cycle
            definition = deck%definitions(i)
            call value_of(definition, 1, deck%parameters, value, error, unknown)
            if (.not. allocated(error)) call define(deck%parameters, definition%key, value)
            if (allocated(error) .and. .not. unknown) call blame(deck, definition, 1, error%message)
            done(i) = .not. (allocated(error) .and. unknown)
         end do
      end do
      do i = 1, size(done)
         if (.not. done(i)) call blame_pending(deck, i, done)
      end do
   end subroutine evaluate_parameters

   !> Names of parameters must be new and free; those that are not are done with.
   subroutine check_definitions(deck, done)
      type(deck_t), intent(inout) :: deck
      logical, intent(inout) :: done(:)
      type(entry_t) :: definition
      integer :: i, first

      do i = 1, size(done)
         definition = deck%definitions(i)
         done(i) = .true.
         first = first_definition(deck, definition%key)
         if (.not. is_identifier(definition%key)) then
            call blame(deck, definition, 0, &
               'the name of a parameter is letters, digits and _, a letter first')
         else if (is_reserved(definition%key)) then
            call blame(deck, definition, 0, 'this name is that of a function or a constant')
         else if (first < i) then
            call blame(deck, definition, 0, 'this parameter is already set at ' &
               //deck%definitions(first)%file//':'//to_text(deck%definitions(first)%line))
         else
            done(i) = .not. definition%valid
         end if
      end do
   end subroutine check_definitions

   pure function first_definition(deck, name) result(first)
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: name
      integer :: first

      do first = 1, size(deck%definitions)
         if (deck%definitions(first)%key == name) return
      end do
   end function first_definition

   !> Say why a parameter could not be evaluated: an unknown name, or one of a circle.
   subroutine blame_pending(deck, i, done)
      type(deck_t), intent(inout) :: deck
      integer, intent(in) :: i
      logical, intent(in) :: done(:)
      type(variables_t) :: all_names
      type(entry_t) :: definition
      type(error_t), allocatable :: error
      logical :: unknown
      real(wp) :: value
      integer :: j

      all_names = deck%parameters
      do j = 1, size(done)
         if (.not. done(j)) call define(all_names, deck%definitions(j)%key, 1.0_wp)
      end do
      definition = deck%definitions(i)
      call value_of(definition, 1, all_names, value, error, unknown)
      if (allocated(error)) then
         call blame(deck, definition, 1, error%message)
      else
         call blame(deck, definition, 1, &
            'it depends on itself or on another parameter without a value')
      end if
   end subroutine blame_pending

   !> Check and evaluate the values of all entries.
   subroutine evaluate_entries(deck, table)
      type(deck_t), intent(inout) :: deck        !! gets numbers and problems
      type(keyword_t), intent(in) :: table(:)    !! all keywords
      type(entry_t) :: entry
      integer :: i, j, keyword, key

      do i = 1, size(deck%blocks)
         keyword = keyword_place(table, deck%blocks(i)%keyword)
         do j = 1, size(deck%blocks(i)%entries)
            entry = deck%blocks(i)%entries(j)
            if (.not. entry%valid) cycle
            key = key_place(table(keyword), entry%key)
            call evaluate_entry(deck, table(keyword)%keys(key), entry)
            deck%blocks(i)%entries(j) = entry
         end do
      end do
   end subroutine evaluate_entries

   subroutine evaluate_entry(deck, key, entry)
      type(deck_t), intent(inout) :: deck
      type(key_t), intent(in) :: key
      type(entry_t), intent(inout) :: entry

      call check_count(deck, key, entry)
      if (.not. entry%valid) return
      select case (key%kind)
      case (kind_real, kind_integer)
         call evaluate_numbers(deck, key, entry, 1)
      case (kind_axis)
         call check_words(deck, entry, 'x y z', 1)
         call evaluate_numbers(deck, key, entry, 2)
      case (kind_word)
         call check_words(deck, entry, trim(key%words), size(entry%texts))
      case (kind_flag)
         call read_flag(deck, entry)
      case (kind_text)
         call check_texts(deck, entry)
      end select
   end subroutine evaluate_entry

   subroutine check_count(deck, key, entry)
      type(deck_t), intent(inout) :: deck
      type(key_t), intent(in) :: key
      type(entry_t), intent(inout) :: entry
      integer :: least, most
      character(len=:), allocatable :: allowed

      least = key%least
      most = key%most
      if (key%kind == kind_axis) then
         least = 2
         most = 2
      end if
      if (size(entry%texts) >= least .and. size(entry%texts) <= most) return
      if (least == most) then
         allowed = to_text(least)
      else if (most == huge(most)) then
         allowed = 'at least '//to_text(least)
      else
         allowed = to_text(least)//' to '//to_text(most)
      end if
      call blame(deck, entry, 0, 'it needs '//allowed//' '//trim(merge('values', 'value ', &
         most > 1)) &
         //' and got '//to_text(size(entry%texts))//': '//shown(join(entry%texts, ' ')))
      entry%valid = .false.
   end subroutine check_count

   !> Numbers from the texts, from the `first` on.
   subroutine evaluate_numbers(deck, key, entry, first)
      type(deck_t), intent(inout) :: deck
      type(key_t), intent(in) :: key
      type(entry_t), intent(inout) :: entry
      integer, intent(in) :: first
      type(error_t), allocatable :: error
      real(wp) :: value
      integer :: i

      allocate (entry%numbers(size(entry%texts) - first + 1), source=0.0_wp)
      do i = first, size(entry%texts)
         call value_of(entry, i, deck%parameters, value, error)
         if (allocated(error)) then
            call blame(deck, entry, i, error%message)
            entry%valid = .false.
            cycle
         end if
         entry%numbers(i - first + 1) = value
         if (.not. in_range(key%range, value)) then
            call blame(deck, entry, i, out_of_range(key, value))
            entry%valid = .false.
         else if (key%kind == kind_integer .and. .not. is_whole(value)) then
            call blame(deck, entry, i, to_text(value)//' is not a whole number that fits')
            entry%valid = .false.
         end if
      end do
   end subroutine evaluate_numbers

   !> The value of one text of an entry.
   subroutine value_of(entry, i, variables, value, error, unknown)
      type(entry_t), intent(in) :: entry
      integer, intent(in) :: i
      type(variables_t), intent(in) :: variables
      real(wp), intent(out) :: value
      type(error_t), allocatable, intent(out) :: error
      logical, intent(out), optional :: unknown
      logical :: not_known
      integer :: status

      not_known = .false.
      call parse_real(entry%texts(i)%s, value, status)
      if (entry%quoted(i)) then
         allocate (error)
         error%message = 'a text in quotes stands where a number must be'
      else if (scan(entry%texts(i)%s, '+-*/^') == 1 .and. verify(entry%texts(i)%s, &
         '+-*/^') == 0) then
         allocate (error)
         error%message = 'an expression has no blanks outside its parentheses'
      else if (status /= number_good) then
         call evaluate(entry%texts(i)%s, variables, value, error, not_known)
      end if
      if (present(unknown)) unknown = not_known
   end subroutine value_of

   function out_of_range(key, value) result(text)
      type(key_t), intent(in) :: key
      real(wp), intent(in) :: value
      character(len=:), allocatable :: text

      text = to_text(value)//' is outside of '//trim(key%range)
   end function out_of_range

   elemental function is_whole(value) result(whole)
      real(wp), intent(in) :: value
      logical :: whole

      whole = abs(value) <= real(huge(1), wp) .and. abs(value - anint(value)) <= 0.0_wp
   end function is_whole

   !> The first `n` texts must be out of a list of words; they are put in lower case.
   subroutine check_words(deck, entry, words, n)
      type(deck_t), intent(inout) :: deck
      type(entry_t), intent(inout) :: entry
      character(len=*), intent(in) :: words
      integer, intent(in) :: n
      type(string_t), allocatable :: allowed(:)
      logical :: known
      integer :: i, j

      call split_words(words, allowed)
      do i = 1, n
         entry%texts(i)%s = lower(entry%texts(i)%s)
         known = .false.
         do j = 1, size(allowed)
            known = known .or. same(allowed(j)%s, entry%texts(i)%s)
         end do
         if (known) cycle
         call blame(deck, entry, i, 'is not one of '//join(allowed, ', ') &
            //did_you_mean(entry%texts(i)%s, allowed))
         entry%valid = .false.
      end do
   end subroutine check_words

   !> Equal texts of equal length (Fortran would pad the shorter with blanks).
   pure function same(a, b)
      character(len=*), intent(in) :: a
      character(len=*), intent(in) :: b
      logical :: same

      same = len(a) == len(b) .and. a == b
   end function same

   subroutine read_flag(deck, entry)
      type(deck_t), intent(inout) :: deck
      type(entry_t), intent(inout) :: entry

      select case (lower(entry%texts(1)%s))
      case ('yes', 'true', 'on', '.true.')
         entry%texts(1)%s = 'yes'
      case ('no', 'false', 'off', '.false.')
         entry%texts(1)%s = 'no'
      case default
         call blame(deck, entry, 1, 'is neither yes nor no')
         entry%valid = .false.
      end select
   end subroutine read_flag

   subroutine check_texts(deck, entry)
      type(deck_t), intent(inout) :: deck
      type(entry_t), intent(inout) :: entry
      integer :: i

      do i = 1, size(entry%texts)
         if (len_trim(entry%texts(i)%s) > 0) cycle
         call blame(deck, entry, 0, 'the text is empty')
         entry%valid = .false.
      end do
   end subroutine check_texts

   !> Put in all keys and keywords that have defaults and are not written.
   subroutine fill_defaults(deck, table)
      type(deck_t), intent(inout) :: deck        !! gets entries and blocks
      type(keyword_t), intent(in) :: table(:)    !! all keywords
      type(block_t) :: block
      integer :: i, j

      do i = 1, size(table)
         if (.not. table(i)%always .or. count_blocks(deck, trim(table(i)%name)) > 0) cycle
         block%keyword = trim(table(i)%name)
         block%name = ''
         block%file = deck%name
         if (allocated(block%entries)) deallocate (block%entries)
         allocate (block%entries(0))
         call add_block(deck, block)
      end do
      do i = 1, size(deck%blocks)
         associate (keyword => table(keyword_place(table, deck%blocks(i)%keyword)))
            do j = 1, size(keyword%keys)
               if (keyword%keys(j)%default == '' .or. has(deck%blocks(i), &
                  trim(keyword%keys(j)%name))) cycle
               call add_entry(deck%blocks(i)%entries, default_entry(keyword%keys(j)))
            end do
         end associate
      end do
   end subroutine fill_defaults

   function default_entry(key) result(entry)
      type(key_t), intent(in) :: key
      type(entry_t) :: entry
      type(deck_t) :: scratch

      entry%key = trim(key%name)
      call split_words(trim(key%default), entry%texts)
      allocate (entry%quoted(size(entry%texts)), source=.false.)
      entry%file = ''
      entry%given = .false.
      call evaluate_entry(scratch, key, entry)
   end function default_entry

   !> Keywords and keys that must be in the deck.
   subroutine check_required(deck, table)
      type(deck_t), intent(inout) :: deck        !! gets problems
      type(keyword_t), intent(in) :: table(:)    !! all keywords
      type(block_t) :: block
      integer :: i

      do i = 1, size(table)
         if (.not. table(i)%required .or. table(i)%directive) cycle
         if (count_blocks(deck, trim(table(i)%name)) > 0) cycle
         call note_problem(deck, huge(i), deck%name//': there is no *' &
            //upper(trim(table(i)%name))//' ('// &
            trim(table(i)%meaning)//')')
      end do
      do i = 1, size(deck%blocks)
         block = deck%blocks(i)
         call check_required_keys(deck, block, table(keyword_place(table, block%keyword)))
      end do
   end subroutine check_required

   subroutine check_required_keys(deck, block, keyword)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(keyword_t), intent(in) :: keyword
      integer :: i

      do i = 1, size(keyword%keys)
         if (.not. keyword%keys(i)%required) cycle
         if (has(block, trim(keyword%keys(i)%name))) cycle
         call complain(deck, block, '', "the key '"//trim(keyword%keys(i)%name)//"' is missing (" &
            //trim(keyword%keys(i)%meaning)//')')
      end do
   end subroutine check_required_keys

   !> 'file:line: key = text: message', with the i-th text, or none where i is 0.
   subroutine blame(deck, entry, i, message)
      type(deck_t), intent(inout) :: deck
      type(entry_t), intent(in) :: entry
      integer, intent(in) :: i
      character(len=*), intent(in) :: message
      character(len=:), allocatable :: text

      text = entry%file//':'//to_text(entry%line)//": '"//shown(entry%key)
      if (i > 0) text = text//' = '//shown(entry%texts(i)%s)
      call note_problem(deck, entry%row, text//"': "//message)
   end subroutine blame
end module xmpm_deck_values
