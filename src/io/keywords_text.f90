!> The keyword table as text, for `--keywords` and for the manual.
module xmpm_keywords_text
   use xmpm_text, only: string_t, to_text
   use xmpm_text_lists, only: join, upper
   use xmpm_keywords, only: keyword_t, key_t, split_words, kind_integer, kind_word, kind_text, &
      kind_flag, kind_axis, may_have_name, must_have_name
   use xmpm_keywords_table, only: make_keyword_table
   implicit none
   private

   public :: keyword_table_text, write_keywords

   character(len=1), parameter :: nl = new_line('a')

contains

   !> Print the table.
   subroutine write_keywords(unit, markdown)
      integer, intent(in) :: unit       !! open for writing
      logical, intent(in) :: markdown   !! tables of the manual, or plain text

      write (unit, '(a)') keyword_table_text(markdown)
   end subroutine write_keywords

   !> All keywords and keys with what the table holds about them.
   pure function keyword_table_text(markdown) result(text)
      logical, intent(in) :: markdown               !! tables of the manual, or plain text
      character(len=:), allocatable :: text         !! lines split by new_line
      type(keyword_t), allocatable :: table(:)
      integer :: i

      call make_keyword_table(table)
      text = ''
      do i = 1, size(table)
         if (i > 1) text = text//nl
         if (markdown) then
            text = text//markdown_keyword(table(i))
         else
            text = text//plain_keyword(table(i))
         end if
      end do
   end function keyword_table_text

   pure function plain_keyword(keyword) result(text)
      type(keyword_t), intent(in) :: keyword
      character(len=:), allocatable :: text
      integer :: i

      text = '*'//upper(trim(keyword%name))//name_text(keyword)//'   '//trim(keyword%meaning) &
         //' ('//how_often(keyword)//')'//nl
      do i = 1, size(keyword%keys)
         associate (key => keyword%keys(i))
            text = text//'   '//key%name//trim(key%meaning)//nl
            text = text//repeat(' ', 6)//facts(key)//nl
         end associate
      end do
   end function plain_keyword

   !> What a key takes, in one line.
   pure function facts(key) result(text)
      type(key_t), intent(in) :: key
      character(len=:), allocatable :: text

      text = values_text(key)
      if (key%dimension /= '') text = text//'; unit: '//trim(key%dimension)
      if (key%range /= '') text = text//'; range: '//trim(key%range)
      if (key%default /= '') then
         text = text//'; default: '//trim(key%default)
      else
         text = text//'; '//default_text(key)
      end if
      if (key%repeatable) text = text//'; may be repeated'
   end function facts

   pure function markdown_keyword(keyword) result(text)
      type(keyword_t), intent(in) :: keyword
      character(len=:), allocatable :: text
      integer :: i

      text = '### `*'//upper(trim(keyword%name))//name_text(keyword)//'`'//nl//nl &
         //capital(trim(keyword%meaning)) &
         //'. '//capital(how_often(keyword))//'.'//nl
      if (size(keyword%keys) == 0) return
      text = text//nl//'| key | values | unit | range | default | meaning |'//nl &
         //'|---|---|---|---|---|---|'//nl
      do i = 1, size(keyword%keys)
         associate (key => keyword%keys(i))
            text = text//'| `'//trim(key%name)//'` | '//values_text(key)//' | ' &
               //trim(key%dimension)//' | ' &
               //trim(key%range)//' | '//default_text(key)//' | '//trim(key%meaning)
            if (key%repeatable) text = text//' (may be repeated)'
            text = text//' |'//nl
         end associate
      end do
   end function markdown_keyword

   pure function name_text(keyword) result(text)
      type(keyword_t), intent(in) :: keyword
      character(len=:), allocatable :: text

      select case (keyword%naming)
      case (must_have_name); text = ' NAME'
      case (may_have_name); text = ' [NAME]'
      case default; text = ''
      end select
      if (keyword%name == 'include') text = ' FILE'
   end function name_text

   pure function how_often(keyword) result(text)
      type(keyword_t), intent(in) :: keyword
      character(len=:), allocatable :: text

      if (keyword%required .and. keyword%repeatable) then
         text = 'required, one or more'
      else if (keyword%required) then
         text = 'required, once'
      else if (keyword%repeatable) then
         text = 'optional, any number'
      else
         text = 'optional, once'
      end if
   end function how_often

   pure function values_text(key) result(text)
      type(key_t), intent(in) :: key
      character(len=:), allocatable :: text
      type(string_t), allocatable :: words(:)

      select case (key%kind)
      case (kind_word)
         call split_words(trim(key%words), words)
         text = join(words, ', ')
         if (key%most > 1) text = 'any of '//text
      case (kind_flag)
         text = 'flag'
      case (kind_axis)
         text = 'x, y or z and a number'
      case (kind_text)
         text = 'text'
      case (kind_integer)
         text = count_text(key)//'integer'
      case default
         text = count_text(key)//'real'
      end select
   end function values_text

   pure function count_text(key) result(text)
      type(key_t), intent(in) :: key
      character(len=:), allocatable :: text

      if (key%most == huge(key%most)) then
         text = to_text(key%least)//' or more '
      else if (key%most > key%least) then
         text = to_text(key%least)//' to '//to_text(key%most)//' '
      else if (key%most > 1) then
         text = to_text(key%most)//' '
      else
         text = ''
      end if
   end function count_text

   pure function default_text(key) result(text)
      type(key_t), intent(in) :: key
      character(len=:), allocatable :: text

      if (key%required) then
         text = 'required'
      else if (key%default /= '') then
         text = trim(key%default)
      else
         text = 'optional'
      end if
   end function default_text

   pure function capital(text) result(big)
      character(len=*), intent(in) :: text
      character(len=len(text)) :: big

      big = upper(text(1:1))//text(2:)
   end function capital
end module xmpm_keywords_text
