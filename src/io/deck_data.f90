!> The deck as data: blocks of entries in written order, their values, and what is wrong.
module xmpm_deck_data
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t, raise, code_usage
   use xmpm_text, only: string_t, to_text, lower
   use xmpm_text_lists, only: append, upper
   use xmpm_expression, only: variables_t
   implicit none
   private

   public :: deck_t, block_t, entry_t
   public :: count_blocks, find_block, block_named, collect_names, entry_place
   public :: has, given, valid, real_of, reals_of, integer_of, text_of, texts_of, flag_of
   public :: complain, warn, note_problem, problems, warnings_of, add_block, add_entry

   !> One `key = values`, or a flag.
   type :: entry_t
      character(len=:), allocatable :: key        !! lower case
      type(string_t), allocatable :: texts(:)     !! values as written; words in lower case
      logical, allocatable :: quoted(:)           !! whether a value was in quotes
      real(wp), allocatable :: numbers(:)         !! values of numeric keys [units of the deck]
      character(len=:), allocatable :: file       !! where it was written
      integer :: line = 0                         !! where it was written
      integer :: row = 0                          !! line counted through all included files
      logical :: given = .true.                   !! written in the deck, not filled in
      logical :: valid = .true.                   !! count, type and range are right
   end type entry_t

   !> One keyword with its entries.
   type :: block_t
      character(len=:), allocatable :: keyword    !! lower case, without the star
      character(len=:), allocatable :: name       !! blank where it has none
      type(entry_t), allocatable :: entries(:)    !! in written order, then those filled in
      character(len=:), allocatable :: file       !! where it was written
      integer :: line = 0                         !! where it was written, 0 where it was filled in
      integer :: row = 0                          !! line counted through all included files
   end type block_t

   !> A whole deck.
   type :: deck_t
      character(len=:), allocatable :: name             !! file name, for messages
      type(block_t), allocatable :: blocks(:)           !! in written order, then those filled in
      type(entry_t), allocatable :: definitions(:)      !! of *PARAMETER, in written order
      type(variables_t) :: parameters                   !! their values
      type(string_t), allocatable :: problems(:)        !! 'file:line: what is wrong'
      integer, allocatable :: problem_rows(:)           !! for their order
      type(string_t), allocatable :: warnings(:)        !! 'file:line: what is odd'
   end type deck_t

contains

   !> How many blocks of a keyword there are.
   pure function count_blocks(deck, keyword) result(n)
      type(deck_t), intent(in) :: deck          !! parsed
      character(len=*), intent(in) :: keyword   !! for example 'body'
      integer :: n, i

      n = 0
      do i = 1, size(deck%blocks)
         if (deck%blocks(i)%keyword == keyword) n = n + 1
      end do
   end function count_blocks

   !> The i-th block of a keyword, as a copy; an empty block where there is none.
   pure function find_block(deck, keyword, i) result(block)
      type(deck_t), intent(in) :: deck          !! parsed
      character(len=*), intent(in) :: keyword   !! for example 'body'
      integer, intent(in) :: i                  !! 1 .. count_blocks
      type(block_t) :: block
      integer :: j, n

      n = 0
      do j = 1, size(deck%blocks)
         if (deck%blocks(j)%keyword == keyword) n = n + 1
         if (n == i .and. deck%blocks(j)%keyword == keyword) then
            block = deck%blocks(j)
            return
         end if
      end do
      block%keyword = keyword
      block%name = ''
      block%file = ''
      allocate (block%entries(0))
   end function find_block

   !> Which block of a keyword has a name, whatever the case of its letters; 0 where none has.
   pure function block_named(deck, keyword, name) result(i)
      type(deck_t), intent(in) :: deck          !! parsed
      character(len=*), intent(in) :: keyword   !! for example 'material'
      character(len=*), intent(in) :: name      !! not blank
      integer :: i, j, n

      i = 0
      n = 0
      do j = 1, size(deck%blocks)
         if (deck%blocks(j)%keyword /= keyword) cycle
         n = n + 1
         if (lower(deck%blocks(j)%name) == lower(name) .and. i == 0) i = n
      end do
   end function block_named

   !> Names of all blocks of a keyword that have one.
   pure subroutine collect_names(deck, keyword, names)
      type(deck_t), intent(in) :: deck                         !! parsed
      character(len=*), intent(in) :: keyword                  !! for example 'material'
      type(string_t), allocatable, intent(out) :: names(:)     !! in written order
      integer :: i

      allocate (names(0))
      do i = 1, size(deck%blocks)
         if (deck%blocks(i)%keyword == keyword .and. len(deck%blocks(i)%name) > 0) then
            call append(names, deck%blocks(i)%name)
         end if
      end do
   end subroutine collect_names

   !> Place of the first entry of a key; 0 where there is none.
   pure function entry_place(block, key) result(place)
      type(block_t), intent(in) :: block    !! of the deck
      character(len=*), intent(in) :: key   !! lower case
      integer :: place

      do place = 1, size(block%entries)
         if (block%entries(place)%key == key) return
      end do
      place = 0
   end function entry_place

   !> Whether a key has a value, written or filled in.
   pure function has(block, key)
      type(block_t), intent(in) :: block    !! of the deck
      character(len=*), intent(in) :: key   !! lower case
      logical :: has

      has = entry_place(block, key) > 0
   end function has

   !> Whether a key was written in the deck.
   pure function given(block, key)
      type(block_t), intent(in) :: block    !! of the deck
      character(len=*), intent(in) :: key   !! lower case
      logical :: given
      integer :: place

      given = .false.
      place = entry_place(block, key)
      if (place > 0) given = block%entries(place)%given
   end function given

   !> Whether a key has a value that passed all checks of its own.
   pure function valid(block, key)
      type(block_t), intent(in) :: block    !! of the deck
      character(len=*), intent(in) :: key   !! lower case
      logical :: valid
      integer :: place

      valid = .false.
      place = entry_place(block, key)
      if (place > 0) valid = block%entries(place)%valid
   end function valid

   !> The (first) number of a key; 0 where the key has none.
   pure function real_of(block, key) result(value)
      type(block_t), intent(in) :: block    !! of the deck
      character(len=*), intent(in) :: key   !! of kind real, integer or axis
      real(wp) :: value                     !! [units of the deck]
      integer :: place

      value = 0.0_wp
      place = entry_place(block, key)
      if (place == 0) return
      if (.not. allocated(block%entries(place)%numbers)) return
      if (size(block%entries(place)%numbers) > 0) value = block%entries(place)%numbers(1)
   end function real_of

   !> All numbers of a key; none where the key has none.
   pure function reals_of(block, key) result(values)
      type(block_t), intent(in) :: block    !! of the deck
      character(len=*), intent(in) :: key   !! of kind real, integer or axis
      real(wp), allocatable :: values(:)    !! (n) [units of the deck]
      integer :: place

      allocate (values(0))
      place = entry_place(block, key)
      if (place == 0) return
      if (allocated(block%entries(place)%numbers)) values = block%entries(place)%numbers
   end function reals_of

   !> The whole number of a key; 0 where the key has none.
   pure function integer_of(block, key) result(value)
      type(block_t), intent(in) :: block    !! of the deck
      character(len=*), intent(in) :: key   !! of kind integer
      integer :: value

      value = nint(real_of(block, key))
   end function integer_of

   !> The (first) text of a key, also an axis; blank where the key has none.
   pure function text_of(block, key) result(text)
      type(block_t), intent(in) :: block    !! of the deck
      character(len=*), intent(in) :: key   !! of kind word, text or axis
      character(len=:), allocatable :: text
      integer :: place

      text = ''
      place = entry_place(block, key)
      if (place == 0) return
      if (size(block%entries(place)%texts) > 0) text = block%entries(place)%texts(1)%s
   end function text_of

   !> All texts of a key; none where the key has none.
   pure function texts_of(block, key) result(texts)
      type(block_t), intent(in) :: block    !! of the deck
      character(len=*), intent(in) :: key   !! of kind word or text
      type(string_t), allocatable :: texts(:)
      integer :: place

      place = entry_place(block, key)
      if (place > 0) then
         texts = block%entries(place)%texts
      else
         allocate (texts(0))
      end if
   end function texts_of

   !> Whether a flag is set.
   pure function flag_of(block, key) result(flag)
      type(block_t), intent(in) :: block    !! of the deck
      character(len=*), intent(in) :: key   !! of kind flag
      logical :: flag

      flag = text_of(block, key) == 'yes'
   end function flag_of

   !> Something is wrong with a key of a block, or with the whole block where the key is blank.
   pure subroutine complain(deck, block, key, message)
      type(deck_t), intent(inout) :: deck       !! gets one problem more
      type(block_t), intent(in) :: block        !! that is wrong
      character(len=*), intent(in) :: key       !! that is wrong, blank for the whole block
      character(len=*), intent(in) :: message   !! what is wrong, and what is allowed

      call note_problem(deck, row_of(block, key), place_text(deck, block, key)//message)
   end subroutine complain

   !> Something is odd with a key of a block, but the run can go on.
   pure subroutine warn(deck, block, key, message)
      type(deck_t), intent(inout) :: deck       !! gets one warning more
      type(block_t), intent(in) :: block        !! that is odd
      character(len=*), intent(in) :: key       !! that is odd, blank for the whole block
      character(len=*), intent(in) :: message   !! what is odd

      call append(deck%warnings, place_text(deck, block, key)//message)
   end subroutine warn

   !> Keep a problem in its place: problems stand in the order of the lines they speak of.
   pure subroutine note_problem(deck, row, text)
      type(deck_t), intent(inout) :: deck    !! gets one problem more
      integer, intent(in) :: row             !! line counted through all included files
      character(len=*), intent(in) :: text   !! 'file:line: what is wrong'
      type(string_t) :: last
      integer :: i

      call append(deck%problems, text)
      if (.not. allocated(deck%problem_rows)) allocate (deck%problem_rows(0))
      deck%problem_rows = [deck%problem_rows, row]
      do i = size(deck%problems), 2, -1
         if (deck%problem_rows(i - 1) <= row) exit
         call move_alloc(deck%problems(i)%s, last%s)
         call move_alloc(deck%problems(i - 1)%s, deck%problems(i)%s)
         call move_alloc(last%s, deck%problems(i - 1)%s)
         deck%problem_rows(i) = deck%problem_rows(i - 1)
         deck%problem_rows(i - 1) = row
      end do
   end subroutine note_problem

   !> All that is wrong with the deck as one error, or none.
   subroutine problems(deck, error)
      type(deck_t), intent(in) :: deck                   !! parsed
      type(error_t), allocatable, intent(out) :: error   !! one line for each problem
      character(len=:), allocatable :: text
      integer :: i

      if (.not. allocated(deck%problems)) return
      text = ''
      do i = 1, size(deck%problems)
         if (i > 1) text = text//new_line('a')
         text = text//deck%problems(i)%s
      end do
      if (size(deck%problems) > 0) call raise(error, code_usage, text)
   end subroutine problems

   !> All that is odd with the deck; an empty list where nothing is.
   pure function warnings_of(deck) result(list)
      type(deck_t), intent(in) :: deck          !! parsed
      type(string_t), allocatable :: list(:)

      if (allocated(deck%warnings)) then
         list = deck%warnings
      else
         allocate (list(0))
      end if
   end function warnings_of

   !> Put a block at the end of the deck.
   pure subroutine add_block(deck, block)
      type(deck_t), intent(inout) :: deck   !! gets one block more
      type(block_t), intent(in) :: block    !! copied
      type(block_t), allocatable :: longer(:)
      integer :: i, n

      n = size(deck%blocks)
      allocate (longer(n + 1))
      do i = 1, n
         call move_block(deck%blocks(i), longer(i))
      end do
      longer(n + 1) = block
      call move_alloc(longer, deck%blocks)
   end subroutine add_block

   !> Put an entry at the end of a list.
   pure subroutine add_entry(entries, entry)
      type(entry_t), allocatable, intent(inout) :: entries(:)   !! gets one entry more
      type(entry_t), intent(in) :: entry                        !! copied
      type(entry_t), allocatable :: longer(:)
      integer :: n

      n = size(entries)
      allocate (longer(n + 1))
      longer(:n) = entries
      longer(n + 1) = entry
      call move_alloc(longer, entries)
   end subroutine add_entry

   pure subroutine move_block(from, to)
      type(block_t), intent(inout) :: from
      type(block_t), intent(inout) :: to

      call move_alloc(from%keyword, to%keyword)
      call move_alloc(from%name, to%name)
      call move_alloc(from%entries, to%entries)
      call move_alloc(from%file, to%file)
      to%line = from%line
      to%row = from%row
   end subroutine move_block

   pure function row_of(block, key) result(row)
      type(block_t), intent(in) :: block
      character(len=*), intent(in) :: key
      integer :: row

      row = block%row
      if (given(block, key)) row = block%entries(entry_place(block, key))%row
   end function row_of

   !> 'file:line: *BODY plate, particles: '
   pure function place_text(deck, block, key) result(text)
      type(deck_t), intent(in) :: deck
      type(block_t), intent(in) :: block
      character(len=*), intent(in) :: key
      character(len=:), allocatable :: text
      integer :: place

      place = 0
      if (given(block, key)) place = entry_place(block, key)
      if (place > 0) then
         text = block%entries(place)%file//':'//to_text(block%entries(place)%line)
      else if (block%line > 0) then
         text = block%file//':'//to_text(block%line)
      else
         text = deck%name
      end if
      text = text//': *'//upper(block%keyword)
      if (len(block%name) > 0) text = text//' '//block%name
      if (len(key) > 0) text = text//', '//key
      text = text//': '
   end function place_text
end module xmpm_deck_data
