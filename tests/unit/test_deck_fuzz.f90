!> Mutated decks through the string parser: never a crash, a hang, or a number that is not one.
program test_deck_fuzz
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t
   use xmpm_text, only: to_text
   use xmpm_deck, only: deck_t, block_t, parse_deck, deck_echo, find_block, reals_of
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none

   character(len=1), parameter :: nl = new_line('a')
   integer, parameter :: mutants = 10000   !! decks with random damage
   integer, parameter :: numbers = 2000    !! decks with a random text for a number
   real(wp), parameter :: factor = 5.0_wp  !! most time of a damaged deck over a sound one

   !> Texts that stand where a number must be, and are none.
   character(len=12), parameter :: garbage(40) = [character(len=12) :: 'nan', 'NaN', '+nan', &
      'inf', &
      '-inf', 'Infinity', '1e999', '-1e999', '1e-999', '1..2', '1.2.3', '1e', '1e+', '1ee5', &
      '1e5e', &
      '1d5d', '0x10', '1f', '1_0', '1o', 'O', 'l0', '1:2', '1;2', '1&2', '5%', '#1', '@', &
      '1e5.0', '(1', &
      '1)', '()', '(,)', '1**', '*2', '/2', '1/0', '0/0', 'sqrt(-1)', 'log(0)']

   !> Pieces that a mutation may put anywhere.
   character(len=12), parameter :: pieces(24) = [character(len=12) :: '*END', '*GRID', '*', &
      '=', ',', ',,', &
      '"', '''', '(', ')', '!', '$', '#', '1e999', 'nan', '**', 'h', '-', 'box =', '1/0', &
      '*BODY b', &
      'deg(', 'poisson', '*PARAMETER']

   type(suite_t) :: suite
   integer(i8) :: state

   suite%name = 'deck_fuzz'
   state = 20240229_i8
   call damaged_decks_never_hurt()
   call garbage_is_never_a_number()
   call random_texts_are_numbers_only_if_they_are()
   call long_texts_are_no_trouble()
   call finish(suite)

contains

   !> What is still accepted after damage has finite numbers only, and an echo that means the same.
   subroutine damaged_decks_never_hurt()
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      character(len=:), allocatable :: text
      integer :: i, j, accepted, silent
      logical :: sane
      real(wp) :: start, now, once

      once = time_of_a_sound_deck()
      call cpu_time(start)
      accepted = 0
      silent = 0
      sane = .true.
      do i = 1, mutants
         call make_sound_deck(text)
         do j = 1, 1 + random_below(4)
            text = mutated(text)
         end do
         call parse_deck(text, 'fuzz', deck, error)
         if (allocated(error)) then
            if (len_trim(error%message) == 0) silent = silent + 1
         else
            accepted = accepted + 1
            sane = all_finite(deck)
            if (sane) sane = echo_is_the_same(deck)
            if (.not. sane) exit
         end if
      end do
      call cpu_time(now)
      call check(suite, 'damaged decks cost no more than sound ones', &
         now - start < factor*real(mutants + accepted, wp)*once)
      call check(suite, 'an accepted deck is sane (the last was:'//nl//text//')', sane)
      call check(suite, 'every refusal says why', silent == 0)
      call check(suite, 'some damage is harmless', accepted > mutants/100)
      call check(suite, 'most damage is found', accepted < mutants/2)
   end subroutine damaged_decks_never_hurt

   !> Processor time to read a sound deck, in this build and on this machine.
   function time_of_a_sound_deck() result(once)
      real(wp) :: once   !! [s]
      integer, parameter :: repeats = 300
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      character(len=:), allocatable :: text
      real(wp) :: start, now
      integer :: i

      call make_sound_deck(text)
      call cpu_time(start)
      do i = 1, repeats
         call parse_deck(text, 'fuzz', deck, error)
      end do
      call cpu_time(now)
      once = (now - start)/real(repeats, wp)
   end function time_of_a_sound_deck

   !> Each numeric value of the deck in turn is replaced by each text that is no number.
   subroutine garbage_is_never_a_number()
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      character(len=:), allocatable :: text
      integer :: i, hole, kept
      logical :: clean

      kept = 0
      hole = 0
      do
         hole = hole + 1
         text = with_hole_filled(hole, '1')
         if (len(text) == 0) exit
         call parse_deck(text, 'fuzz', deck, error)
         call check_no_error(suite, 'with 1 in hole '//to_text(hole)//' the deck is right', error)
         do i = 1, size(garbage)
            call parse_deck(with_hole_filled(hole, trim(garbage(i))), 'fuzz', deck, error)
            if (.not. allocated(error)) kept = kept + 1
         end do
      end do
      clean = kept == 0 .and. hole > 10
      call check(suite, 'no garbage is taken for a number', clean)
   end subroutine garbage_is_never_a_number

   !> Random texts of digits, points and exponents are accepted exactly where an automaton does.
   subroutine random_texts_are_numbers_only_if_they_are()
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      character(len=:), allocatable :: text
      integer :: i, wrong, right

      wrong = 0
      right = 0
      do i = 1, numbers
         call make_number_text(text)
         call parse_deck(with_hole_filled(1, text), 'fuzz', deck, error)
         if (allocated(error) .eqv. is_number(text)) wrong = wrong + 1
         if (is_number(text)) right = right + 1
      end do
      call check(suite, 'the parser and the automaton agree on what a number is', wrong == 0)
      call check(suite, 'numbers and others were both tried', &
         right > numbers/10 .and. right < numbers*9/10)
   end subroutine random_texts_are_numbers_only_if_they_are

   subroutine long_texts_are_no_trouble()
      type(deck_t) :: deck
      type(error_t), allocatable :: error
      character(len=:), allocatable :: text
      integer :: i

      call parse_deck(repeat('(', 200000), 'fuzz', deck, error)
      call check_error(suite, 'many parentheses are refused', error, &
         'stands before the first keyword')
      call parse_deck(with_hole_filled(1, repeat('(', 50000)//'1'//repeat(')', 50000)), 'fuzz', &
         deck, error)
      call check_error(suite, 'also as an expression', error, 'nested too deeply')
      call parse_deck(repeat('*', 100000)//nl//repeat('*A'//nl, 2000), 'fuzz', deck, error)
      call check_error(suite, 'so are many stars', error, 'unknown keyword')
      call make_sound_deck(text)
      text = text(:index(text, '*END') - 1)//'*CURVE long table = 0 0'
      do i = 1, 20000
         text = text//' '//to_text(i)//' 1'
      end do
      call parse_deck(text//nl//'*END', 'fuzz', deck, error)
      call check_no_error(suite, 'a long table is read', error)
      ! Whole numbers: exact.
      call check_close(suite, 'to its end', maxval(reals_of(find_block(deck, 'curve', 2), &
         'table')), &
         20000.0_wp, 0.0_wp, 0.0_wp)
   end subroutine long_texts_are_no_trouble

   subroutine make_sound_deck(text)
      character(len=:), allocatable, intent(out) :: text

      text = '*JOB fuzz'//nl//'*UNITS length = m mass = kg time = s'//nl &
         //'*PARAMETER h = 2.0, slope = atan(2.0)'//nl//'*GRID size = h, shape = linear'//nl &
         //'*MATERIAL alloy'//nl &
         //'  law = elastic, density = 1.5e3, young = 100.e9, poisson = 0.33'//nl &
         //'*BODY plate'//nl//'  material = alloy, particles = 2'//nl &
         //'  box = -20 -6 -5  20 6 5'//nl &
         //'  without_sphere = 0 0 0 1'//nl//'*CRACK slit'//nl &
         //'  rectangle, centre = 0 0 0, width = 4*h' &
         //nl//'  along = cos(slope) sin(slope) 0, across = 0 0 1, depth = 12'//nl &
         //'*CURVE pulse table = 0 0, 1 1, 2 0'//nl &
         //'*LOAD face = plate:+x, traction = 100 0 0, curve = pulse'//nl &
         //'*BOUNDARY base plane = x -20 type = velocity components = x y value = 0 (1 + 2)'//nl &
         //'*TIME end = 0.025, scheme = musl'//nl//'*OUTPUT every = 0.001, particles = stress'//nl &
         //'*PROBE p reaction = base'//nl//'*END'//nl
   end subroutine make_sound_deck

   !> A sound deck with a text in place of its hole-th number; blank where it has no such hole.
   function with_hole_filled(hole, filling) result(text)
      integer, intent(in) :: hole
      character(len=*), intent(in) :: filling
      character(len=:), allocatable :: text
      character(len=*), parameter :: frame = '*JOB a|*GRID size=? origin=? 0 0|*TIME end=? ' &
         //'cfl=? steps=?|' &
         //'*MATERIAL m density=? young=? poisson=0|*BODY b material=m particles=? sphere=0 0 ' &
         //'? ? velocity=0 ? 0|' &
         //'*CURVE c table=0 ?|*BOUNDARY plane=x ? type=fixed|*PARAMETER p=?|*DAMPING pic=?|*END'
      integer :: i, count

      text = ''
      count = 0
      do i = 1, len(frame)
         if (frame(i:i) == '|') then
            text = text//nl
         else if (frame(i:i) == '?') then
            count = count + 1
            text = text//trim(merge('?', '1', count == hole))
         else
            text = text//frame(i:i)
         end if
      end do
      i = index(text, '?')
      if (i == 0) then
         text = ''
      else
         text = text(:i - 1)//filling//text(i + 1:)
      end if
   end function with_hole_filled

   !> One random damage.
   function mutated(text) result(new)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: new
      integer :: a, b

      a = 1 + random_below(len(text))
      b = min(len(text), a + random_below(12))
      select case (random_below(8))
      case (0); new = text(:a - 1)//text(b + 1:)   ! cut out
      case (1); new = text(:a - 1)//char(random_below(256))//text(a:)   ! any byte
      case (2); new = text(:a - 1)//char(random_below(256))//text(a + 1:)   ! changed
      case (3); new = text(:b)//text(a:)   ! doubled
      case (4); new = text(:a - 1)//trim(pieces(1 + random_below(size(pieces))))//text(a:)  ! piece
      case (5); new = text(:a)   ! cut off
      case (6); new = text(:a - 1)//trim(garbage(1 + random_below(size(garbage))))//text(b + 1:)
      case default; new = text(:a - 1)//text(b:)//text(a:b - 1)   ! moved
      end select
      if (len(new) == 0) new = ' '
   end function mutated

   subroutine make_number_text(text)
      character(len=:), allocatable, intent(out) :: text
      character(len=*), parameter :: characters = &
         '0123456789012345678901234567890123456789......eEdD_fx'
      integer :: i, place

      text = ''
      do i = 1, 1 + random_below(5)
         place = 1 + random_below(len(characters))
         text = text//characters(place:place)
      end do
   end subroutine make_number_text

   !> digits [. digits] [e digits], a digit before or behind the point; not 0, not too large.
   function is_number(text) result(is)
      character(len=*), intent(in) :: text
      logical :: is
      integer :: i, before, behind, exponent, phase, power

      before = 0
      behind = 0
      exponent = 0
      power = 0
      phase = 1
      is = .false.
      do i = 1, len(text)
         if (index('0123456789', text(i:i)) > 0) then
            if (phase == 1) before = before + 1
            if (phase == 2) behind = behind + 1
            if (phase == 3) exponent = exponent + 1
            if (phase == 3) power = 10*power + index('123456789', text(i:i))
         else if (text(i:i) == '.' .and. phase == 1) then
            phase = 2
         else if (index('eEdD', text(i:i)) > 0 .and. phase < 3 .and. before + behind > 0) then
            phase = 3
         else
            return
         end if
      end do
      is = before + behind > 0 .and. (phase < 3 .or. exponent > 0) .and. power < 305
      if (power >= 305 .and. scan(text(:scan(text, 'eEdD')), '123456789') == 0) is = .false.
      is = is .and. scan(text(:scan(text//'e', 'eEdD') - 1), '123456789') > 0
   end function is_number

   function all_finite(deck) result(finite)
      type(deck_t), intent(in) :: deck
      logical :: finite
      integer :: i, j

      finite = .true.
      do i = 1, size(deck%blocks)
         do j = 1, size(deck%blocks(i)%entries)
            if (.not. allocated(deck%blocks(i)%entries(j)%numbers)) cycle
            finite = finite .and. all(ieee_is_finite(deck%blocks(i)%entries(j)%numbers))
         end do
      end do
   end function all_finite

   function echo_is_the_same(deck) result(same)
      type(deck_t), intent(in) :: deck
      logical :: same
      type(deck_t) :: again
      type(error_t), allocatable :: error
      character(len=:), allocatable :: first, second

      first = deck_echo(deck)
      call parse_deck(first, 'echo', again, error)
      same = .not. allocated(error)
      if (.not. same) return
      second = deck_echo(again)
      same = first(index(first, '*JOB'):) == second(index(second, '*JOB'):)
   end function echo_is_the_same

   !> A whole number from 0 to n - 1 (xorshift).
   function random_below(n) result(k)
      integer, intent(in) :: n
      integer :: k

      state = ieor(state, ishft(state, 13))
      state = ieor(state, ishft(state, -7))
      state = ieor(state, ishft(state, 17))
      k = int(modulo(state, int(n, i8)))
   end function random_below
end program test_deck_fuzz
