!> Histories keep every bit, say their units, and report what could not be written.
program test_history
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t
   use xmpm_text, only: string_t
   use xmpm_communicator, only: comm_t, start_parallel, stop_parallel
   use xmpm_history, only: history_t, open_history, write_row, write_row_text, close_history, cell
   use xmpm_provenance, only: provenance_t, start_provenance
   use testing, only: suite_t, check, check_error, check_no_error, finish
   implicit none
   type(comm_t) :: comm
   type(suite_t) :: suite
   type(provenance_t) :: provenance

   call start_parallel(comm)
   suite%name = 'history'
   call start_provenance(provenance, comm)
   provenance%job = 'plate-1'
   call test_rows(suite)
   call test_cells(suite)
   call test_failures(suite)
   call finish(suite)
   call stop_parallel(comm, 0)

contains

   subroutine test_rows(suite)
      type(suite_t), intent(inout) :: suite
      type(history_t) :: history
      type(error_t), allocatable :: error
      real(wp) :: values(3), back(3)
      character(len=200) :: line, before
      integer :: unit, status, rows

      values = [1.0_wp/3, -1.0e-300_wp, 6.02214076e23_wp]
      call open_history(history, 'test_history.csv', [character(len=6) :: 'time', 'a', 'energy'], &
         [character(len=2) :: 's', '1', 'mJ'], provenance, error)
      call check_no_error(suite, 'a history opens', error)
      call write_row(history, values)
      call write_row(history, -values)
      ! read while it is still open for writing: a killed run must leave its rows
      open (newunit=unit, file='test_history_copy.csv', status='replace')
      close (unit)
      call execute_command_line('cat test_history.csv > test_history_copy.csv')
      open (newunit=unit, file='test_history_copy.csv', status='old', action='read')
      rows = 0
      before = ''
      do
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         if (line == '# job: plate-1') call check(suite, 'the run is named', .true.)
         if (line == 'time,a,energy') call check(suite, 'units stand above the header', &
            before == '# units: s,1,mJ')
         if (line(1:1) == '#' .or. line(1:1) == 't') then
            before = line
            cycle
         end if
         rows = rows + 1
         read (line, *) back
         ! exact: 17 digits give every real back
         if (rows == 1) call check(suite, 'reals keep every bit', all(abs(back - values) <= 0))
         if (rows == 2) call check(suite, 'signs are kept', all(abs(back + values) <= 0))
      end do
      close (unit)
      call check(suite, 'each row is on disk as soon as it is written', rows == 2)
      call close_history(history, error)
      call check_no_error(suite, 'a history closes', error)
      call check(suite, 'run, units and rows were all met', suite%passed + suite%failed == 7)
   end subroutine test_rows

   subroutine test_cells(suite)
      type(suite_t), intent(inout) :: suite
      type(string_t) :: cells(6)

      cells(1) = cell(12)
      cells(2) = cell(2_i8**40)
      cells(3) = cell('plain')
      cells(4) = cell('a "b", c')
      cells(5) = cell(1.0_wp)
      cells(6) = cell(ieee_value(1.0_wp, ieee_quiet_nan))
      call check(suite, 'integers have no decimal point', cells(1)%s == '12')
      call check(suite, 'long integers are whole', cells(2)%s == '1099511627776')
      call check(suite, 'a plain text stands as it is', cells(3)%s == 'plain')
      call check(suite, 'a text with commas is quoted', cells(4)%s == '"a ""b"", c"')
      call check(suite, 'reals have 17 digits', cells(5)%s == '1.0000000000000000E+000')
      call check(suite, 'what is not a number says so', cells(6)%s == 'NaN')
   end subroutine test_cells

   subroutine test_failures(suite)
      type(suite_t), intent(inout) :: suite
      type(history_t) :: history
      type(error_t), allocatable :: error

      call open_history(history, 'no/folder/x.csv', ['a'], ['1'], provenance, error)
      call check_error(suite, 'a file in no folder is reported', error, &
         'no/folder/x.csv: the file cannot be created')
      call open_history(history, 'test_short.csv', ['a', 'b'], ['1', '1'], provenance, error)
      call write_row_text(history, [cell(1)])
      call close_history(history, error)
      call check_error(suite, 'a row of the wrong length is reported', error, &
         'a row has 1 values for 2 columns')
      call open_history(history, '/dev/full', ['a', 'b'], ['1', '1'], provenance, error)
      call check_error(suite, 'a full disk is reported', error, &
         '/dev/full: a row cannot be written')
   end subroutine test_failures
end program test_history
