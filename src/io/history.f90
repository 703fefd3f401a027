!> Histories as CSV: comments, units and one header line, then rows that are flushed one by one.
!>
!> One rank opens and writes a history. A failure is kept and reported when it is closed, so that
!> writing a row needs no check of its own.
module xmpm_history
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t, raise, code_files
   use xmpm_text, only: string_t, to_text
   use xmpm_provenance, only: provenance_t, provenance_names, provenance_values
   implicit none
   private

   public :: history_t, open_history, write_row, write_row_text, close_history, cell

   !> An open history.
   type :: history_t
      character(len=:), allocatable :: path      !! of the file
      character(len=:), allocatable :: failure   !! the first failure; unallocated where all is well
      integer :: unit = -1                       !! -1 where it is not open
      integer :: columns = 0                     !! values a row
      integer(i8) :: bytes = 0                   !! written so far
   end type history_t

   !> Text of one value in a row; reals have 17 significant digits, so that they keep every bit.
   interface cell
      module procedure real_cell, integer_cell, long_cell, text_cell
   end interface cell

contains

   !> Create the file of a history and write what stands above its rows.
   subroutine open_history(history, path, names, units, provenance, error)
      type(history_t), intent(out) :: history              !! open on return
      character(len=*), intent(in) :: path                 !! for example 'plate_energy.csv'
      character(len=*), intent(in) :: names(:)             !! (n) of the columns
      character(len=*), intent(in) :: units(:)             !! (n) of the columns, '1' where none
      type(provenance_t), intent(in) :: provenance         !! of the run
      type(error_t), allocatable, intent(out) :: error     !! the file cannot be written
      integer :: status

      history%path = path
      history%columns = size(names)
      open (newunit=history%unit, file=path, status='replace', action='write', iostat=status)
      if (status /= 0) then
         history%unit = -1
         call raise(error, code_files, path//': the file cannot be created')
         return
      end if
      call write_comments(history, provenance)
      call write_text(history, '# units: '//joined(units))
      call write_text(history, joined(names))
      if (allocated(history%failure)) call raise(error, code_files, history%failure)
   end subroutine open_history

   !> Write a row of reals.
   subroutine write_row(history, values)
      type(history_t), intent(inout) :: history   !! written to
      real(wp), intent(in) :: values(:)           !! one for each column
      type(string_t) :: cells(size(values))
      integer :: i

      do i = 1, size(values)
         cells(i) = cell(values(i))
      end do
      call write_row_text(history, cells)
   end subroutine write_row

   !> Write a row of any values: `call write_row_text(history, [cell(time), cell(step)])`.
   subroutine write_row_text(history, cells)
      type(history_t), intent(inout) :: history   !! written to
      type(string_t), intent(in) :: cells(:)      !! one for each column
      character(len=:), allocatable :: row
      integer :: i

      if (size(cells) /= history%columns) then
         if (.not. allocated(history%failure)) history%failure = history%path//': a row has '// &
            to_text(size(cells))//' values for '//to_text(history%columns)//' columns'
         return
      end if
      row = ''
      do i = 1, size(cells)
         if (i > 1) row = row//','
         row = row//cells(i)%s
      end do
      call write_text(history, row)
   end subroutine write_row_text

   !> Close a history and report the first failure since it was opened.
   subroutine close_history(history, error)
      type(history_t), intent(inout) :: history            !! closed on return
      type(error_t), allocatable, intent(out) :: error     !! what could not be written
      integer :: status

      if (history%unit /= -1) then
         close (history%unit, iostat=status)
         if (status /= 0 .and. .not. allocated(history%failure)) then
            history%failure = history%path//': the file cannot be closed (disk full?)'
         end if
      end if
      history%unit = -1
      if (allocated(history%failure)) call raise(error, code_files, history%failure)
   end subroutine close_history

   !> One comment line for each fact of the run.
   subroutine write_comments(history, provenance)
      type(history_t), intent(inout) :: history
      type(provenance_t), intent(in) :: provenance
      character(len=11) :: names(12)
      type(string_t) :: values(12)
      integer :: i

      names = provenance_names()
      values = provenance_values(provenance)
      do i = 1, size(names)
         call write_text(history, '# '//trim(names(i))//': '//values(i)%s)
      end do
   end subroutine write_comments

   !> Write a line; a full disk shows in the size of the file only, flushing does not report it.
   subroutine write_text(history, text)
      type(history_t), intent(inout) :: history
      character(len=*), intent(in) :: text
      integer(i8) :: bytes
      integer :: status

      if (history%unit == -1) return
      write (history%unit, '(a)', iostat=status) text
      if (status == 0) flush (history%unit)
      history%bytes = history%bytes + len(text, i8) + 1
      inquire (file=history%path, size=bytes)
      if (status == 0 .and. bytes >= history%bytes) return
      if (.not. allocated(history%failure)) then
         history%failure = history%path//': a row cannot be written (disk full?)'
      end if
   end subroutine write_text

   pure function joined(words) result(line)
      character(len=*), intent(in) :: words(:)
      character(len=:), allocatable :: line
      integer :: i

      line = trim(words(1))
      do i = 2, size(words)
         line = line//','//trim(words(i))
      end do
   end function joined

   pure function real_cell(value) result(text)
      real(wp), intent(in) :: value
      type(string_t) :: text
      character(len=32) :: buffer

      write (buffer, '(es25.16e3)') value
      text%s = trim(adjustl(buffer))
   end function real_cell

   pure function integer_cell(value) result(text)
      integer, intent(in) :: value
      type(string_t) :: text

      text%s = to_text(value)
   end function integer_cell

   pure function long_cell(value) result(text)
      integer(i8), intent(in) :: value
      type(string_t) :: text

      text%s = to_text(value)
   end function long_cell

   !> A text, quoted where a comma or a quote in it would split the row.
   pure function text_cell(value) result(text)
      character(len=*), intent(in) :: value
      type(string_t) :: text
      integer :: i

      if (scan(value, ',"'//new_line('a')) == 0) then
         text%s = value
         return
      end if
      text%s = '"'
      do i = 1, len(value)
         if (value(i:i) == '"') text%s = text%s//'"'
         text%s = text%s//value(i:i)
      end do
      text%s = text%s//'"'
   end function text_cell
end module xmpm_history
