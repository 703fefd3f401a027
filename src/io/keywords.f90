!> What a keyword of the deck and its keys may be: the types of the one table, and look-up in it.
module xmpm_keywords
   use xmpm_kinds, only: wp
   use xmpm_text, only: string_t
   use xmpm_text_lists, only: append, upper
   use xmpm_numbers, only: parse_real, number_good
   implicit none
   private

   public :: keyword_t, key_t, add_keyword, add_key, keyword_place, key_place
   public :: keyword_names, key_names, split_words, in_range, is_number_kind
   public :: kind_real, kind_integer, kind_word, kind_text, kind_flag, kind_axis
   public :: no_name, may_have_name, must_have_name

   integer, parameter :: kind_real = 1      !! numbers or expressions
   integer, parameter :: kind_integer = 2   !! whole numbers
   integer, parameter :: kind_word = 3      !! words out of a list
   integer, parameter :: kind_text = 4      !! free text
   integer, parameter :: kind_flag = 5      !! the key alone, or = yes or no
   integer, parameter :: kind_axis = 6      !! x, y or z and a number

   integer, parameter :: no_name = 0          !! the keyword takes no name
   integer, parameter :: may_have_name = 1    !! a name may follow the keyword
   integer, parameter :: must_have_name = 2   !! a name must follow the keyword

   !> One key of a keyword.
   type :: key_t
      character(len=20) :: name = ''       !! lower case
      integer :: kind = kind_real          !! one of the kinds above
      integer :: least = 1                 !! fewest values
      integer :: most = 1                  !! most values
      character(len=12) :: dimension = ''  !! dimension of its numbers, blank for a plain number
      character(len=12) :: range = ''      !! interval such as '(0, inf)', blank for any number
      character(len=32) :: default = ''    !! as it would stand in the deck; blank for none
      character(len=96) :: words = ''      !! allowed words
      logical :: required = .false.        !! must be written
      logical :: repeatable = .false.      !! may be written more than once
      character(len=120) :: meaning = ''   !! one line
   end type key_t

   !> One keyword and its keys.
   type :: keyword_t
      character(len=12) :: name = ''        !! lower case, without the star
      integer :: naming = no_name           !! whether a name follows
      logical :: required = .false.         !! at least one must be in the deck
      logical :: repeatable = .false.       !! may be in the deck more than once
      logical :: always = .false.   !! put into the deck with its defaults where it is not written
      logical :: directive = .false.        !! parameter, include or end: no block of data
      character(len=120) :: meaning = ''    !! one line
      type(key_t), allocatable :: keys(:)   !! in the order of the documentation
   end type keyword_t

contains

   !> Put one more keyword into the table.
   pure subroutine add_keyword(table, keyword)
      type(keyword_t), allocatable, intent(inout) :: table(:)   !! made where it is not yet
      type(keyword_t), intent(in) :: keyword                    !! without keys
      type(keyword_t), allocatable :: longer(:)
      integer :: n

      n = 0
      if (allocated(table)) n = size(table)
      allocate (longer(n + 1))
      if (n > 0) longer(:n) = table
      longer(n + 1) = keyword
      allocate (longer(n + 1)%keys(0))
      call move_alloc(longer, table)
   end subroutine add_keyword

   !> Give the last keyword of the table one more key.
   pure subroutine add_key(table, key)
      type(keyword_t), intent(inout) :: table(:)   !! at least one keyword
      type(key_t), intent(in) :: key               !! added
      type(key_t), allocatable :: longer(:)
      integer :: n

      associate (keyword => table(size(table)))
         n = size(keyword%keys)
         allocate (longer(n + 1))
         longer(:n) = keyword%keys
         longer(n + 1) = key
         call move_alloc(longer, keyword%keys)
      end associate
   end subroutine add_key

   !> Where a keyword stands in the table; 0 where it is not known.
   pure function keyword_place(table, name) result(place)
      type(keyword_t), intent(in) :: table(:)   !! all keywords
      character(len=*), intent(in) :: name      !! lower case
      integer :: place, i

      place = 0
      do i = 1, size(table)
         if (table(i)%name == name) place = i
      end do
   end function keyword_place

   !> Where a key stands among those of its keyword; 0 where it is not known.
   pure function key_place(keyword, name) result(place)
      type(keyword_t), intent(in) :: keyword   !! of the table
      character(len=*), intent(in) :: name     !! lower case
      integer :: place, i

      place = 0
      do i = 1, size(keyword%keys)
         if (keyword%keys(i)%name == name) place = i
      end do
   end function key_place

   !> All keywords with their star, in upper case.
   pure function keyword_names(table) result(names)
      type(keyword_t), intent(in) :: table(:)   !! all keywords
      type(string_t), allocatable :: names(:)
      integer :: i

      allocate (names(size(table)))
      do i = 1, size(table)
         names(i)%s = '*'//upper(trim(table(i)%name))
      end do
   end function keyword_names

   !> All keys of a keyword.
   pure function key_names(keyword) result(names)
      type(keyword_t), intent(in) :: keyword   !! of the table
      type(string_t), allocatable :: names(:)
      integer :: i

      allocate (names(size(keyword%keys)))
      do i = 1, size(keyword%keys)
         names(i)%s = trim(keyword%keys(i)%name)
      end do
   end function key_names

   !> The words of a text that blanks separate.
   pure subroutine split_words(text, words)
      character(len=*), intent(in) :: text                     !! for example 'linear gimp'
      type(string_t), allocatable, intent(out) :: words(:)     !! for example 'linear', 'gimp'
      integer :: first, last

      allocate (words(0))
      first = verify(text, ' ')
      do while (first > 0)
         last = first + scan(text(first:)//' ', ' ') - 2
         call append(words, text(first:last))
         first = verify(text(min(last + 1, len(text)):), ' ')
         if (last >= len(text)) exit
         if (first > 0) first = first + last
      end do
   end subroutine split_words

   !> Whether a number lies in an interval such as '(0, 0.5]'; a blank interval holds every number.
   function in_range(range, value) result(inside)
      character(len=*), intent(in) :: range   !! of the table
      real(wp), intent(in) :: value           !! finite
      logical :: inside
      real(wp) :: low, high
      integer :: comma, last

      inside = .true.
      last = len_trim(range)
      if (last == 0) return
      comma = index(range, ',')
      low = bound(range(2:comma - 1), -huge(low))
      high = bound(trim(adjustl(range(comma + 1:last - 1))), huge(high))
      inside = value > low .or. (value >= low .and. range(1:1) == '[')
      inside = inside .and. (value < high .or. (value <= high .and. range(last:last) == ']'))
   end function in_range

   !> Whether values of this kind are numbers only.
   elemental function is_number_kind(kind) result(is)
      integer, intent(in) :: kind   !! of a key
      logical :: is

      is = kind == kind_real .or. kind == kind_integer
   end function is_number_kind

   function bound(text, otherwise) result(value)
      character(len=*), intent(in) :: text
      real(wp), intent(in) :: otherwise
      real(wp) :: value
      integer :: status

      call parse_real(text, value, status)
      if (status /= number_good) value = otherwise
   end function bound
end module xmpm_keywords
