!> Tests of the deck: what it accepts, what it fills in, and every message about what is wrong.
program test_deck
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t, code_usage, code_files
   use xmpm_deck, only: deck_t, block_t, parse_deck, read_deck, deck_echo, count_blocks, &
      find_block, &
      block_named, has, given, real_of, reals_of, integer_of, text_of, texts_of, flag_of, &
      complain, &
      warn, problems, warnings_of, si_factor, unit_text, sound_speed
   use xmpm_deck_hints, only: edit_distance
   use xmpm_keywords_text, only: keyword_table_text
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   type(deck_t) :: deck
   type(error_t), allocatable :: error

   !> A deck to which each test adds what it is about; a bar stands for the end of a line.
   character(len=*), parameter :: base = '*JOB plate|*GRID size=2|*TIME end=0.5|' &
      //'*MATERIAL alloy density=1500, young=1e11, poisson=0.3|' &
      //'*BODY plate material=alloy box=0 0 0 4 4 4|'

   suite%name = 'deck'
   call reads_the_first_deck()
   call reads_values_however_they_are_written()
   call reads_parameters_in_any_order()
   call keeps_the_order_of_primitives()
   call fills_in_defaults()
   call finds_blocks()
   call echoes_itself()
   call accepts_all_keywords()
   call names_unknown_words()
   call wants_complete_decks()
   call refuses_wrong_syntax()
   call refuses_wrong_parameters()
   call refuses_wrong_values()
   call refuses_wrong_bodies()
   call refuses_wrong_cracks()
   call refuses_wrong_loads()
   call refuses_wrong_boundaries()
   call refuses_the_rest()
   call lists_all_problems_in_order()
   call takes_problems_of_later_stages()
   call warns()
   call knows_units()
   call includes_files()
   call prints_the_table()
   call finish(suite)

contains

   subroutine reads_the_first_deck()
      type(block_t) :: block

      call parse('*JOB plate-1|*UNITS length = mm, mass = g, time = ms ! so stress is MPa|' &
         //'*PARAMETER|' &
         //'  h = 2.0, slope = atan(2.0)|*GRID size = h, shape = linear|*MATERIAL alloy|' &
         //'  law = elastic, density = 1.5e-3, young = 100.e3, poisson = 0.33, toughness = 632|' &
         //'*BODY plate|  material = alloy, particles = 2|  box = -200 -60 -5  200 60 5|' &
         //'*CRACK slit|  rectangle, centre = 0 0 0, along = cos(slope) sin(slope) 0, width = ' &
         //'40, ' &
         //'across = 0 0 1, depth = 12|*LOAD     face = plate:+x, traction = 100 0 0, curve = ' &
         //'step|' &
         //'*LOAD     face = plate:-x, traction = -100 0 0, curve = step|' &
         //'*TIME     end = 0.025, scheme = musl, cfl = 0.5|' &
         //'*OUTPUT   every = 0.001, particles = displacement velocity stress, crack = ' &
         //'opening|*END')
      call check_no_error(suite, 'the deck of the manual is read', error)
      block = find_block(deck, 'body', 1)
      call check(suite, 'its body has a name and a place', &
         block%name == 'plate' .and. block%line == 8 &
         .and. block%file == 'test.inp')
      call check(suite, 'its box has six numbers', size(reals_of(block, 'box')) == 6)
      call check(suite, 'its particles are two', integer_of(block, 'particles') == 2)
      block = find_block(deck, 'crack', 1)
      call check(suite, 'its crack is a rectangle', flag_of(block, 'rectangle'))
      ! The cosine of an arc tangent: a few roundings.
      call check_close(suite, 'expressions have their values', sum(reals_of(block, 'along')), &
         3/sqrt(5.0_wp), 0.0_wp, 4*epsilon(1.0_wp))
      call check(suite, 'there are two loads', count_blocks(deck, 'load') == 2)
      call check(suite, 'nothing is odd', size(warnings_of(deck)) == 0)
   end subroutine reads_the_first_deck

   subroutine reads_values_however_they_are_written()
      type(block_t) :: block

      call parse_with('*body "my bar" MATERIAL=ALLOY, PARTICLES=3 Box=-200 -60,-5' &
         //achar(9)//'2.d2 | (a - b) 3*a, velocity = 1,|2|,3 # no comment here is a key|')
      call check_error(suite, 'a # inside of a line is no comment', error, '1 2 3 # no comment')
      call parse_with('# comment|  # comment|$ comment|! comment|*PARAMETER a=2 b=1|' &
         //'*body "my bar" MATERIAL=ALLOY, PARTICLES=3 $ comment|Box=-200 -60,-5' &
         //achar(9)//'2.d2 | (a - b) 3*a, velocity = 1,|2|,3'//achar(13)//'|')
      call check_no_error(suite, 'blanks, tabs, commas, lines and cases are free', error)
      block = find_block(deck, 'body', 2)
      call check(suite, 'a name in quotes has blanks', block%name == 'my bar')
      call check(suite, 'a reference takes the case of the name', text_of(block, &
         'material') == 'alloy')
      call check(suite, 'values are those written', &
         all(abs(reals_of(block, 'box') - [-200.0_wp, -60.0_wp, -5.0_wp, 200.0_wp, 1.0_wp, &
         6.0_wp]) <= 0.0_wp))
      call check(suite, 'values go on over lines', all(abs(reals_of(block, &
         'velocity') - [1.0_wp, 2.0_wp, 3.0_wp]) <= 0.0_wp))
      call parse_with('*CRACK c width=4 rectangle depth=3 centre=0 0 0 along=1 0 0 across=0 1 0|')
      call check_no_error(suite, 'a flag may follow numbers', error)
      call check(suite, 'and is set', flag_of(find_block(deck, 'crack', 1), 'rectangle'))
      call parse_with('*CRACK c rectangle=yes disc=no centre=0 0 0 along=1 0 0 across=0 1 0 ' &
         //'width=1 depth=1|')
      call check_no_error(suite, 'a flag may be yes or no', error)
      call check(suite, 'no is no', .not. flag_of(find_block(deck, 'crack', 1), 'disc'))
      call parse_with('*LOAD face=''plate'':+X traction=1 2 3|')
      call check(suite, 'quotes may be a part of a value', text_of(find_block(deck, 'load', 1), &
         'face') == 'plate:+x')
      call parse(char(239)//char(187)//char(191)//base//'*END')
      call check_no_error(suite, 'a byte order mark is skipped', error)
   end subroutine reads_values_however_they_are_written

   subroutine reads_parameters_in_any_order()
      call parse(base//'*PARAMETER c = 2*b, b = (a + 1)|*CURVE f table=0 c|*PARAMETER a = 2|*END')
      call check_no_error(suite, 'a parameter may stand behind its use', error)
      ! Small whole numbers are exact.
      call check_close(suite, 'and has its value', maxval(reals_of(find_block(deck, 'curve', &
         1), 'table')), &
         6.0_wp, 0.0_wp, 0.0_wp)
   end subroutine reads_parameters_in_any_order

   subroutine keeps_the_order_of_primitives()
      type(block_t) :: block
      integer :: i
      character(len=:), allocatable :: order

      call parse_with('*BODY b material=alloy box=0 0 0 1 1 1 without_sphere=0 0 0 1 box=1 1 ' &
         //'1 2 2 2 ' &
         //'without_box=0 0 0 1 1 1 tube=0 0 0 0 0 1 1 2 cylinder=0 0 0 0 0 1 1|')
      call check_no_error(suite, 'primitives may repeat', error)
      block = find_block(deck, 'body', 2)
      order = ''
      do i = 1, size(block%entries)
         if (block%entries(i)%given) order = order//' '//block%entries(i)%key
      end do
      call check(suite, 'and keep their order', &
         order == ' material box without_sphere box without_box tube cylinder')
      ! Numbers as written: exact.
      call check_close(suite, 'and their numbers', block%entries(4)%numbers(6), 2.0_wp, 0.0_wp, &
         0.0_wp)
   end subroutine keeps_the_order_of_primitives

   subroutine fills_in_defaults()
      type(block_t) :: block

      call parse_with('*CRACK c disc centre=0 0 0 along=1 0 0 across=0 1 0 radius=1|*PROBE p ' &
         //'point=1 1 1|' &
         //'*BOUNDARY plane=x 0 type=fixed|')
      call check_no_error(suite, 'the deck is right', error)
      block = find_block(deck, 'time', 1)
      call check(suite, 'words have defaults', text_of(block, 'scheme') == 'musl')
      call check(suite, 'that are not given', has(block, 'scheme') .and. .not. given(block, &
         'scheme'))
      ! Defaults are single numbers of the deck: exact.
      call check_close(suite, 'numbers have defaults', real_of(block, 'cfl'), 0.5_wp, 0.0_wp, &
         0.0_wp)
      call check(suite, 'an optional key without default is absent', .not. has(block, 'step'))
      call check(suite, 'absent keys read as nothing', abs(real_of(block, 'step')) <= 0.0_wp .and. &
         text_of(block, 'step') == '' .and. size(reals_of(block, 'step')) == 0 .and. &
         size(texts_of(block, 'step')) == 0 .and. .not. flag_of(block, 'step'))
      call check_close(suite, 'absent keywords come with their defaults', &
         real_of(find_block(deck, 'health', 1), 'energy'), 0.1_wp, 0.0_wp, 0.0_wp)
      call check_close(suite, 'a crack takes the cell size', real_of(find_block(deck, 'crack', &
         1), 'element'), &
         2.0_wp, 0.0_wp, 0.0_wp)
      block = find_block(deck, 'output', 1)
      call check_close(suite, 'output is at the end', real_of(block, 'every'), 0.5_wp, 0.0_wp, &
         0.0_wp)
      call check_close(suite, 'and so is the history', real_of(block, 'history'), 0.5_wp, &
         0.0_wp, 0.0_wp)
      call check(suite, 'lists of words have defaults', &
         size(texts_of(block, 'particles')) == 3 &
         .and. text_of(block, 'particles') == 'displacement')
      call check(suite, 'a probe writes displacement', &
         text_of(find_block(deck, 'probe', 1), 'quantity') == 'displacement')
      call check(suite, 'a boundary holds all components', &
         text_of(find_block(deck, 'boundary', 1), 'components') == 'xyz')
      call check(suite, 'a keyword that is neither written nor always there is absent', &
         count_blocks(deck, 'relax') == 0)
   end subroutine fills_in_defaults

   subroutine finds_blocks()
      type(block_t) :: block

      call parse_with('*MATERIAL Steel density=7900 young=2e11 poisson=0.3|')
      call check(suite, 'blocks are counted', count_blocks(deck, 'material') == 2)
      call check(suite, 'and found by name in any case', block_named(deck, 'material', &
         'STEEL') == 2)
      call check(suite, 'or not', block_named(deck, 'material', 'wood') == 0)
      block = find_block(deck, 'material', 3)
      call check(suite, 'a block that is not there is empty', size(block%entries) == 0)
   end subroutine finds_blocks

   subroutine echoes_itself()
      character(len=:), allocatable :: first, second

      call parse_with('*BODY "a ""b" material=alloy|box=0 0 0 1/3 1e-7 1e22|*BODY ''say ' &
         //'"hi"'' material=alloy file="x y.h5" ' &
         //'part="=,"|*CRACK c ellipse centre=0 0 0 along=1 0 0 across=0 1 0 semi_axes=1 2 ' &
         //'sector=0 90|' &
         //'*CURVE f table=0 0 1 1 2 0 3 1 4 0 5 1 6 0 7 1|*BOUNDARY b box=0 0 0 1 1 1 ' &
         //'type=velocity ' &
         //'components=z x value=1 2 curve=f|*PROBE q reaction=b|*PROBE r section=z 1/7|')
      call check_no_error(suite, 'a deck with everything odd is read', error)
      first = deck_echo(deck)
      call parse_deck(first, 'echo', deck, error)
      call check_no_error(suite, 'its echo is a deck', error)
      second = deck_echo(deck)
      call check(suite, 'which has the same echo, to the last digit', first == second)
      call check(suite, 'a third is exact', index(first, '0.3333333333333333') > 0)
      call check(suite, 'defaults are in it', index(first, '*HEALTH'//new_line('a')) > 0)
      call parse('*PARAMETER h=2|'//base//'*END')
      call check(suite, 'parameters are named in a comment', index(deck_echo(deck), &
         '! parameter h = 2') == 1)
   end subroutine echoes_itself

   subroutine accepts_all_keywords()
      type(deck_t) :: again
      character(len=:), allocatable :: text

      call parse_with('*GRAVITY acceleration=0 0 -9.81 curve=ramp rise=0.1 start=0.2|' &
         //'*SET s body=plate box=0 0 0 0 1 1|*LOAD pull set=s traction=1 0 0 curve=RAMP rise=1|' &
         //'*LOAD face=plate:-z pressure=3 curve=f|*CURVE F table=0 0 1 1|' &
         //'*BOUNDARY b plane=x 0 type=symmetry|*BOUNDARY c set=s type=roller components=y|' &
         //'*BOUNDARY e plane=y 0 type=fixed|*BOUNDARY d plane=Z -1 type=acceleration value=0 ' &
         //'0 1|' &
         //'*DAMPING viscous=1 pic=2 until=3|*RELAX method=viscous rate=3 limit=1|' &
         //'*HEALTH energy=0|*PARTITION imbalance=1.5|*PROBE a section=x 1|*PROBE b reaction=B|' &
         //'*CRACK p polygon points=0 0 1 1 0 1 0 1 1|*CRACK q file=a.stl element=3 front=cut|' &
         //'*UNITS length=m|*OUTPUT particles=none history=0.1|')
      call check_no_error(suite, 'every keyword is known', error)
      text = deck_echo(deck)
      call parse_deck(text, 'echo', again, error)
      call check_no_error(suite, 'also in the echo', error)
      call check(suite, 'which says the same', deck_echo(again) == text)
      call check(suite, 'a reaction takes the name of the boundary', &
         text_of(find_block(deck, 'probe', 2), 'reaction') == 'b')
      call check(suite, 'a curve takes the name of the curve', &
         text_of(find_block(deck, 'load', 2), 'curve') == 'F')
      call check(suite, 'an axis has a letter', text_of(find_block(deck, 'boundary', 4), &
         'plane') == 'z')
      ! A number as written: exact.
      call check_close(suite, 'and a number', real_of(find_block(deck, 'boundary', 4), &
         'plane'), -1.0_wp, &
         0.0_wp, 0.0_wp)
      call parse_with('*BODY f material=alloy file=a.h5|*LOAD set=of_file traction=1 0 0|')
      call check_no_error(suite, 'sets of a particle file are not looked for in the deck', error)
   end subroutine accepts_all_keywords

   subroutine names_unknown_words()
      call check(suite, 'a swap is one edit', edit_distance('gird', 'grid') == 1)
      call check(suite, 'so is a letter more', edit_distance('grids', 'grid') == 1)
      call check(suite, 'nothing is as far as the word is long', edit_distance('', 'grid') == 4)
      call refuse('*GIRD size=1|', "test.inp:6: unknown keyword '*GIRD'; did you mean '*GRID'?")
      call refuse('*SET s bdy=plate|', &
         "unknown key 'bdy' of *SET; did you mean 'body'? Known: body, box")
      call refuse('*DAMPING 3=4|', &
         "'3' stands where a key of *DAMPING must be: viscous, pic, until")
      call parse('*JOB a size=3|*END')
      call check_error(suite, 'a keyword without keys takes none', error, &
         "*JOB takes no keys, but here is 'size'")
      call refuse('*BODY b material=aloy box=0 0 0 1 1 1|', &
         "*BODY b, material: there is no *MATERIAL 'aloy'; did you mean 'alloy'?")
      call refuse('*SET s body=plat box=0 0 0 1 1 1|', "no *BODY 'plat'; did you mean 'plate'?")
      call refuse('*LOAD face=plat:+x traction=1 0 0|', "no *BODY 'plat'; did you mean 'plate'?")
      call refuse('*LOAD set=s traction=1 0 0|', &
         "there is no *SET 's' (none in the deck has a name)")
      call refuse('*LOAD face=plate:+x traction=1 0 0 curve=stp|', &
         "there is no *CURVE 'stp'; did you mean 'step'?")
      call refuse('*BOUNDARY left plane=x 0 type=fixed|*PROBE p reaction=lift|', &
         "there is no *BOUNDARY 'lift'; did you mean 'left'?")
      call refuse('*UNITS mass=pound|', "'mass = pound': is not one of kg, g, t, mg; did you mean")
      call refuse('*BOUNDARY plane=w 0 type=fixed|', &
         "'plane = w': is not one of x, y, z; did you mean")
   end subroutine names_unknown_words

   subroutine wants_complete_decks()
      call parse(base)
      call check_error(suite, 'a deck without *END is cut off', error, &
         'test.inp: the deck does not end with *END: is it truncated?')
      call parse('')
      call check_error(suite, 'so is an empty one', error, 'is it truncated?')
      call check_error(suite, 'it has no job', error, 'there is no *JOB (name of the run')
      call check_error(suite, 'it has no grid', error, 'there is no *GRID (')
      call check_error(suite, 'it has no time', error, 'there is no *TIME (')
      call check_error(suite, 'it has no material', error, 'there is no *MATERIAL (')
      call check_error(suite, 'it has no body', error, 'there is no *BODY (')
      call check(suite, 'all of this is a fault of the deck', error%code == code_usage)
      call refuse('*SET s body=plate|', "test.inp:6: *SET s: the key 'box' is missing (corners")
      call refuse('*PROBE point=1 1 1|', '*PROBE: a name must follow the keyword on its line')
      call refuse('*GRID size=3|', '*GRID: only one is allowed, and the first is at test.inp:2')
      call refuse('*BODY Plate material=alloy box=0 0 0 1 1 1|', &
         '*BODY Plate: the name is already taken at test.inp:5')
   end subroutine wants_complete_decks

   subroutine refuses_wrong_syntax()
      call parse('size = 3|'//base//'*END')
      call check_error(suite, 'a deck starts with a keyword', error, &
         "test.inp:1: 'size' stands before the first keyword")
      call refuse('*INCLUDE a.inp|', '*INCLUDE can stand only in a deck that is read from a file')
      call refuse('*BODY my bar material=alloy box=0 0 0 1 1 1|', &
         "*BODY my: 'bar' follows the name: a name with blanks must be in quotes")
      call refuse('*DAMPING = 3|', "'=' without a key before it")
      call refuse('*DAMPING pic = |', "'pic =' has no value")
      call refuse('*DAMPING pic 3|', "'pic' must be followed by '= value'")
      call refuse('*BODY b material=alloy box=0 0 0,,1 1 1|', &
         "a value of 'box' is missing before a comma")
      call refuse('*BODY b material=alloy box=,0 0 0 1 1 1|', &
         "a value of 'box' is missing before a comma")
      call refuse('*DAMPING pic=1 pic=2|', "'pic' is given twice, first at test.inp:6")
      call refuse('*BODY "b material=alloy|', 'a quote is opened and not closed on this line')
      call refuse('*DAMPING pic=(1|+1)|', 'a parenthesis is opened and not closed on this line')
      call refuse('*DAMPING pic=1'//achar(0)//'|', 'the line holds a control character (code 0)')
      call parse(repeat(achar(3)//'|', 200))
      call check_error(suite, 'a text that is no deck is given up', error, &
         'test.inp:100: too many problems: is this a deck? The rest is not read')
      call refuse('*DAMPING pic=1'//achar(127)//'|', &
         'the line holds a control character (code 127)')
   end subroutine refuses_wrong_syntax

   subroutine refuses_wrong_parameters()
      call refuse('*PARAMETER a = b, b = a|', &
         "'a = b': it depends on itself or on another parameter without a value")
      call refuse('*PARAMETER a = a|', "'a = a': it depends on itself")
      call refuse('*PARAMETER a = bb|', "'a = bb': unknown name 'bb'")
      call refuse('*PARAMETER a = 1/0|', "'a = 1/0': division by zero")
      call refuse('*PARAMETER a = 1, A = 2|', "'a': this parameter is already set at test.inp:6")
      call refuse('*PARAMETER pi = 3|', "'pi': this name is that of a function or a constant")
      call refuse('*PARAMETER nan = 3|', "'nan': this name is that of a function or a constant")
      call refuse('*PARAMETER 2a = 3|', &
         "'2a': the name of a parameter is letters, digits and _, a letter first")
      call refuse('*PARAMETER a = , b = 2|', "'a =' has no value")
      call refuse('*PARAMETER a = "2"|', "'a = 2': a text in quotes stands where a number must be")
      call refuse('*PARAMETER a = 2 3|', "'3' stands where 'name = expression' must be")
      call refuse('*PARAMETER a = 2 + 3|', 'blanks may stand only inside parentheses')
   end subroutine refuses_wrong_parameters

   subroutine refuses_wrong_values()
      call refuse('*DAMPING pic=nan|', "test.inp:6: 'pic = nan': 'nan' is not a number")
      call refuse('*DAMPING pic=+Infinity|', "'infinity' is not a number")
      call refuse('*DAMPING pic=1e400|', "'1e400' is out of the range of double precision")
      call refuse('*DAMPING pic=2x|', "'2x' is not a number")
      call refuse('*DAMPING pic="2"|', 'a text in quotes stands where a number must be')
      call refuse('*DAMPING pic=-1|', "'pic = -1': -1 is outside of [0, inf)")
      call refuse('*DAMPING pic=1 + 2|', "'pic': it needs 1 value and got 3: 1 + 2")
      call refuse('*BODY b material=alloy box=0 0 0 1 - 1|', &
         'an expression has no blanks outside its parentheses')
      call refuse('*BODY b material=alloy box=0 0 0 1 1|', &
         "'box': it needs 6 values and got 5: 0 0 0 1 1")
      call refuse('*CURVE c table=1|', "'table': it needs at least 2 values and got 1: 1")
      call refuse('*BOUNDARY plane=x 0 type=velocity value=1 2 3 4|', &
         "'value': it needs 1 to 3 values and got 4")
      call refuse('*BOUNDARY plane=x type=fixed|', "'plane': it needs 2 values and got 1: x")
      call refuse('*BODY b material=alloy particles=5 box=0 0 0 1 1 1|', &
         "'particles = 5': 5 is outside of [1, 4]")
      call refuse('*BODY b material=alloy particles=1.5 box=0 0 0 1 1 1|', &
         '1.5 is not a whole number that fits')
      call refuse('*BODY b material="" box=0 0 0 1 1 1|', "'material': the text is empty")
      call refuse('*CRACK c disc=maybe|', "'disc = maybe': is neither yes nor no")
      call refuse_material('density=0 young=1 poisson=0', '0 is outside of (0, inf)')
      call refuse_material('density=1 young=-1 poisson=0', '-1 is outside of (0, inf)')
      call refuse_material('density=1 young=1 poisson=0.5', '0.5 is outside of (-1, 0.5)')
      call refuse_material('density=1 young=1 poisson=-1', '-1 is outside of (-1, 0.5)')
      call refuse_material('density=1 young=1 poisson=0 toughness=0', '0 is outside of (0, inf)')
      call refuse_material('density=1 young=1 poisson=0 law=rubber', 'is not one of elastic')
   end subroutine refuses_wrong_values

   subroutine refuses_wrong_bodies()
      call refuse('*BODY b material=alloy|', &
         '*BODY b: the body has no shape: give box, cylinder, tube, sphere or file')
      call refuse_body('without_box=0 0 0 1 1 1 box=0 0 0 1 1 1', &
         'there is nothing yet to cut from')
      call refuse_body('box=0 0 0 1 1 0', 'box: the second corner must lie beyond the first')
      call refuse_body('box=0 0 0 1 1 1 without_box=1 0 0 0 1 1', &
         'without_box: the second corner must lie beyond')
      call refuse_body('cylinder=0 0 0 0 0 0 1', 'the two ends of the axis are the same point')
      call refuse_body('cylinder=0 0 0 0 0 1 0', 'the radius must be greater than 0')
      call refuse_body('tube=0 0 0 0 0 1 2 1', 'the inner radius must be smaller than the outer')
      call refuse_body('tube=0 0 0 0 0 1 -2 1', 'the radius must be greater than 0')
      call refuse_body('sphere=0 0 0 -1', 'the radius must be greater than 0')
      call refuse_body('sphere=0 0 0 1 file=a.h5', &
         'a body is from a file or from primitives, not from both')
      call refuse_body('sphere=0 0 0 1 part=a', 'part: it does not belong here: it needs a file')
      call refuse('*SET s body=plate box=1 0 0 0 1 1|', &
         '*SET s, box: the second corner must not lie before the first')
   end subroutine refuses_wrong_bodies

   subroutine refuses_wrong_cracks()
      character(len=*), parameter :: plane = 'centre=0 0 0 along=1 0 0 across=0 1 0 '

      call refuse_crack('', 'one of these must be given: rectangle, disc, ellipse, polygon, file')
      call refuse_crack('disc rectangle', 'only one of these can be given: rectangle, disc')
      call refuse_crack('disc '//plane, "disc: the key 'radius' is missing")
      call refuse_crack('rectangle '//plane//'width=1', "rectangle: the key 'depth' is missing")
      call refuse_crack('ellipse '//plane, "ellipse: the key 'semi_axes' is missing")
      call refuse_crack('polygon', "polygon: the key 'points' is missing")
      call refuse_crack('disc '//plane//'radius=1 width=2', &
         'width: it does not belong here: it is not a key of disc')
      call refuse_crack('rectangle '//plane//'width=1 depth=1 sector=0 9', &
         'it is not a key of rectangle')
      call refuse_crack('disc centre=0 0 0 along=0 0 0 across=0 1 0 radius=1', &
         'along: the direction has no length')
      call refuse_crack('disc centre=0 0 0 along=1 0 0 across=0 0 0 radius=1', &
         'across: the direction has no length')
      call refuse_crack('disc centre=0 0 0 along=1 0 0 across=-2 0 0 radius=1', &
         'across: it is parallel to along')
      call refuse_crack('disc '//plane//'radius=1 sector=90 0', &
         'it must go from a smaller to a greater angle')
      call refuse_crack('disc '//plane//'radius=1 sector=-200 200', 'at most 360 degrees apart')
      call refuse_crack('polygon points=0 0 0 1 0 0 0 1 0 1', &
         'three numbers a corner are needed; got 10 numbers')
      call refuse_crack('polygon points=0 0 0 1 0 0 2 0 0', 'the corners enclose no area')
      call refuse_crack('polygon points=0 0 0 1 0 0 1 1 0 0 1 1', &
         'lies outside of the plane of the others')
      call refuse_crack('disc '//plane//'radius=1 friction=0.3', &
         'it belongs to contact = friction')
      call refuse_crack('file=a.obj', "'a.obj' is neither a .stl nor a .h5 file")
      call refuse('*BOUNDARY plane=z 0 type=symmetry|*CRACK c disc radius=1 '//plane//'|', &
         '*CRACK c: the crack lies in the symmetry plane z = 0: model both halves without ' &
         //'that plane')
      call refuse('*BOUNDARY plane=y 2 type=symmetry|*CRACK c polygon points=0 2 0 0 2 1 1 2 0|', &
         'the crack lies in the symmetry plane y = 2')
      call parse_with('*BOUNDARY plane=z 1 type=symmetry|*CRACK c disc radius=1 '//plane//'|')
      call check_no_error(suite, 'a crack beside a symmetry plane is fine', error)
   end subroutine refuses_wrong_cracks

   subroutine refuses_wrong_loads()
      call refuse('*LOAD traction=1 0 0|', '*LOAD: one of these must be given: face, set')
      call refuse('*LOAD face=plate:+x|', '*LOAD: one of these must be given: traction, pressure')
      call refuse('*LOAD face=plate:+x traction=1 0 0 pressure=1|', &
         'only one of these can be given: traction, pressure')
      call refuse('*SET s body=plate box=0 0 0 1 1 1|*LOAD set=s pressure=1|', &
         'it needs a face, or a set with areas from a particle file')
      call refuse('*LOAD face=plate traction=1 0 0|', &
         "'plate' is not BODY:FACE with a face out of +x -x")
      call refuse('*LOAD face=plate:top traction=1 0 0|', "'top' is not a face; did you mean")
      call refuse('*LOAD face=plate: traction=1 0 0|', "'' is not a face")
      call refuse('*LOAD face=plate:inside traction=1 0 0|', "only a tube has a face 'inside'")
      call refuse('*LOAD face=plate:side traction=1 0 0|', &
         "only a cylinder, a tube or a sphere has a face 'side'")
      call refuse('*LOAD face=plate:+x traction=1 0 0 curve=ramp|', &
         "the ramp needs 'rise', the time that it grows")
      call refuse('*LOAD face=plate:+x traction=1 0 0 rise=1|', 'it belongs to curve = ramp')
      call refuse('*CURVE step table=0 1|', 'step and ramp are built in: take another name')
      call refuse('*CURVE c table=0 1 2|', 'pairs of time and factor are needed; got 3 numbers')
      call refuse('*CURVE c table=0 1 0 2|', 'each time must be later than the one before')
      call refuse('*GRAVITY acceleration=0 0 1 curve=c|', "there is no *CURVE 'c'")
   end subroutine refuses_wrong_loads

   subroutine refuses_wrong_boundaries()
      real(wp) :: value(3)

      call refuse('*BOUNDARY type=fixed|', 'one of these must be given: plane, box, set')
      call refuse('*BOUNDARY plane=x 0 type=fixed value=1 0 0|', &
         'it belongs to type = velocity and acceleration')
      call refuse('*BOUNDARY plane=x 0 type=fixed curve=ramp rise=1|', &
         'curve: it does not belong here')
      call refuse('*BOUNDARY plane=x 0 type=velocity|', "type: the key 'value' is missing")
      call refuse('*BOUNDARY plane=x 0 type=velocity value=1 components=xy|', &
         'three numbers are needed, or one for each of the components xy; got 1')
      call refuse('*BOUNDARY plane=x 0 type=fixed components=xxy|', &
         "'xxy' is not made of the letters x, y, z, each once")
      call refuse('*BOUNDARY plane=x 0 type=fixed components=w|', "'w' is not made of the letters")
      call refuse('*BOUNDARY box=0 0 0 1 1 1 type=symmetry|', 'symmetry is about a plane')
      call refuse('*BOUNDARY box=0 0 0 1 1 1 type=roller|', &
         'a roller away from a plane needs the components')
      call refuse('*BOUNDARY plane=x 0 type=roller components=x|', &
         'the plane says which component is held')
      call refuse('*BOUNDARY box=1 0 0 0 1 1 type=fixed|', &
         'the second corner must not lie before the first')
      call parse_with('*BOUNDARY plane=x 0 type=velocity components=Z x value=1 2|')
      value = reals_of(find_block(deck, 'boundary', 1), 'value')
      call check(suite, 'values go to components in their written order', &
         all(abs(value - [2.0_wp, 0.0_wp, 1.0_wp]) <= 0.0_wp))
      call check(suite, 'components are sorted', text_of(find_block(deck, 'boundary', 1), &
         'components') == 'xz')
   end subroutine refuses_wrong_boundaries

   subroutine refuses_the_rest()
      call parse('*JOB a/b|*END')
      call check_error(suite, 'the name of a job is no path', error, 'must not hold a /')
      call refuse('*RELAX method=viscous limit=1|', "viscous relaxation needs 'rate'")
      call refuse('*RELAX rate=2 limit=1|', 'it belongs to method = viscous')
      call refuse('*RELAX|', "the key 'limit' is missing")
      call refuse('*OUTPUT particles=stress none|', "'none' stands beside other fields")
      call refuse('*OUTPUT crack=opening opening|', "'opening' is listed twice")
      call refuse('*OUTPUT particles=strs|', "did you mean 'stress'?")
      call refuse('*PROBE p|', 'one of these must be given: point, section, reaction')
      call refuse('*PROBE p section=x 0 quantity=stress|', &
         'quantity: it does not belong here: it belongs to a point')
      call refuse('*PARTITION imbalance=1|', '1 is outside of (1, inf)')
      call refuse('*HEALTH smallest_step=1|', '1 is outside of [0, 1)')
   end subroutine refuses_the_rest

   subroutine lists_all_problems_in_order()
      integer :: first, second, third

      call parse('*JOB a|*GRID size=0|*TIME ende=1|*BODY b material=c box=0 0 0 1 1|*ENDE')
      call check_error(suite, 'the first problem is listed', error, "test.inp:2: 'size = 0'")
      call check_error(suite, 'the second too', error, "test.inp:3: unknown key 'ende'")
      call check_error(suite, 'the third too', error, "test.inp:4: 'box'")
      call check_error(suite, 'the fourth too', error, &
         "test.inp:5: unknown keyword '*ENDE'; did you mean '*END'?")
      first = index(error%message, 'test.inp:2')
      second = index(error%message, 'test.inp:3')
      third = index(error%message, 'test.inp:4')
      call check(suite, 'in the order of the lines', first < second .and. second < third .and. &
         third < index(error%message, 'test.inp:5'))
   end subroutine lists_all_problems_in_order

   subroutine takes_problems_of_later_stages()
      type(block_t) :: block

      call parse_with('*PARTITION|')
      call problems(deck, error)
      call check_no_error(suite, 'a right deck has no problems', error)
      block = find_block(deck, 'body', 1)
      call complain(deck, block, 'box', 'is empty')
      block = find_block(deck, 'health', 1)
      call complain(deck, block, 'energy', 'is too strict')
      call problems(deck, error)
      call check_error(suite, 'a later stage may complain about a key', error, &
         'test.inp:5: *BODY plate, box: is empty')
      call check_error(suite, 'also about one that is filled in', error, &
         'test.inp: *HEALTH, energy: is too strict')
      call warn(deck, find_block(deck, 'grid', 1), 'size', 'is coarse')
      call check(suite, 'or warn', any_warning('test.inp:2: *GRID, size: is coarse'))
   end subroutine takes_problems_of_later_stages

   subroutine warns()
      call parse(base//'*END|more')
      call check(suite, 'text behind *END is odd', &
         any_warning('test.inp:7: text behind *END is not read'))
      call parse(base//'*END|  ! done|')
      call check(suite, 'a comment is not', size(warnings_of(deck)) == 0)
      call parse_with('*UNITS length=mm|')
      call check(suite, 'so is a wave that no solid has', any_warning('a wave runs at 9 m/s'))
      call parse('*JOB a|*GRID size=2|*TIME end=1 cfl=1.5 scheme=usl step=1|' &
         //'*MATERIAL a density=1 young=1e15 poisson=0|*BODY b material=a box=0 0 0 1 1 1|*END')
      call check_no_error(suite, 'an odd deck is still a deck', error)
      call check(suite, 'waves can be too fast', &
         any_warning('*MATERIAL a: under the units of the deck'))
      call check(suite, 'cfl can be too large', any_warning('above the stability limit (cfl = 1)'))
      call check(suite, 'usl is warned of', any_warning('usl is unstable'))
      call check(suite, 'cfl beside a step is not used', any_warning('cfl: it is not used'))
      call parse('*JOB a|*GRID size=2|*TIME end=1 scheme=usl inertia=corrected|' &
         //'*MATERIAL a density=1 young=1 poisson=0|*BODY b material=a box=0 0 0 1 1 1|*END')
      call check_error(suite, 'corrected inertia does not go with usl', error, &
         'corrected inertia goes with musl and usf')
   end subroutine warns

   subroutine knows_units()
      call parse_with('*UNITS length=mm mass=g time=ms|')
      ! Products of powers of ten: a few roundings.
      call expect_factor('stress', 1.0e6_wp)
      call expect_factor('length', 1.0e-3_wp)
      call expect_factor('mass', 1.0e-3_wp)
      call expect_factor('time', 1.0e-3_wp)
      call expect_factor('velocity', 1.0_wp)
      call expect_factor('acceleration', 1.0e3_wp)
      call expect_factor('rate', 1.0e3_wp)
      call expect_factor('density', 1.0e6_wp)
      call expect_factor('force', 1.0_wp)
      call expect_factor('toughness', 1.0e6_wp*sqrt(1.0e-3_wp))
      call expect_factor('', 1.0_wp)
      call check(suite, 'units have names', unit_text(deck, 'stress') == 'g/(mm ms2)' .and. &
         unit_text(deck, 'angle') == 'deg' .and. unit_text(deck, '') == '' .and. &
         unit_text(deck, 'toughness') == 'g/(mm^0.5 ms2)' .and. unit_text(deck, 'rate') == '1/ms')
      call parse_with('*UNITS length=in mass=t time=us|')
      call expect_factor('length', 0.0254_wp)
      call expect_factor('mass', 1000.0_wp)
      call expect_factor('time', 1.0e-6_wp)
      ! One square root: two roundings.
      call check_close(suite, 'the wave of the paper''s plate runs at 9939 m/s', &
         sound_speed(1.0e11_wp, 0.33_wp, 1500.0_wp), 9938.6_wp, 0.5_wp, 0.0_wp)
   end subroutine knows_units

   subroutine includes_files()
      character(len=:), allocatable :: text
      character(len=*), parameter :: folder = 'test_deck_'

      call write_file(folder//'material.inp', &
         '*MATERIAL alloy density=1500 young=1e11|poisson=0.3x|*END|ignored')
      call write_file(folder//'main.inp', '*JOB a|*INCLUDE '//folder &
         //'material.inp ! here|*GRID size=0|' &
         //'*TIME end=1|*BODY b material=alloy box=0 0 0 1 1 1|*END')
      call read_deck(folder//'main.inp', text, error)
      call check_no_error(suite, 'a deck is read from files', error)
      call parse_deck(text, folder//'main.inp', deck, error)
      call check_error(suite, 'a problem names the included file', error, &
         folder//"material.inp:2: 'poisson = 0.3x'")
      call check_error(suite, 'and lines count on behind it', error, folder &
         //"main.inp:3: 'size = 0'")
      call check(suite, 'and there is no other problem', index(error%message, new_line('a')) == &
         index(error%message, new_line('a'), back=.true.))
      call write_file(folder//'loop.inp', '*JOB a|*INCLUDE '//folder &
         //'loop.inp|*INCLUDE nowhere.inp|*INCLUDE|*END')
      call read_deck(folder//'loop.inp', text, error)
      call check_no_error(suite, 'wrong includes are problems of the deck', error)
      call parse_deck(text, folder//'loop.inp', deck, error)
      call check_error(suite, 'a file cannot include itself', error, &
         folder//"loop.inp:2: *INCLUDE '"//folder//"loop.inp': the file includes itself")
      call check_error(suite, 'nor one that is not there', error, &
         folder//"loop.inp:3: *INCLUDE 'nowhere.inp': the file cannot be opened")
      call check_error(suite, 'nor one without a name', error, &
         'the name of a file must follow on the same line')
      call read_deck('no/such/deck.inp', text, error)
      call check_error(suite, 'a deck that is not there is an error', error, &
         'no/such/deck.inp: the file cannot be opened')
      call check(suite, 'of files', error%code == code_files)
      call read_deck('.', text, error)
      call check_error(suite, 'a folder is no deck', error, 'it is a folder, not a file')
      call includes_only_so_deep()
   end subroutine includes_files

   subroutine includes_only_so_deep()
      character(len=:), allocatable :: text
      character(len=2) :: number, next
      integer :: i

      do i = 1, 20
         write (number, '(i2.2)') i
         write (next, '(i2.2)') i + 1
         call write_file('test_deck_deep'//number//'.inp', '*INCLUDE test_deck_deep'//next//'.inp')
      end do
      call read_deck('test_deck_deep01.inp', text, error)
      call parse_deck(text, 'test_deck_deep01.inp', deck, error)
      call check_error(suite, 'includes end somewhere', error, &
         'files are included more than 16 deep')
   end subroutine includes_only_so_deep

   subroutine prints_the_table()
      call check(suite, 'the table is printed', index(keyword_table_text(.false.), &
         '*BODY NAME') > 0)
      call check(suite, 'with ranges', index(keyword_table_text(.false.), 'range: (-1, 0.5)') > 0)
      call check(suite, 'and for the manual', index(keyword_table_text(.true.), &
         '### `*LOAD [NAME]`') > 0)
      call check(suite, 'with all keys', index(keyword_table_text(.true.), &
         '| `cfl` | real |  | (0, inf) | 0.5 | ') > 0)
   end subroutine prints_the_table

   subroutine expect_factor(dimension, factor)
      character(len=*), intent(in) :: dimension
      real(wp), intent(in) :: factor

      call check_close(suite, "the factor of '"//dimension//"' is that of the units", &
         si_factor(deck, dimension), factor, 0.0_wp, 8*epsilon(1.0_wp))
   end subroutine expect_factor

   subroutine refuse_material(keys, part)
      character(len=*), intent(in) :: keys
      character(len=*), intent(in) :: part

      call refuse('*MATERIAL other '//keys//'|', part)
   end subroutine refuse_material

   subroutine refuse_body(keys, part)
      character(len=*), intent(in) :: keys
      character(len=*), intent(in) :: part

      call refuse('*BODY other material=alloy '//keys//'|', part)
   end subroutine refuse_body

   subroutine refuse_crack(keys, part)
      character(len=*), intent(in) :: keys
      character(len=*), intent(in) :: part

      call refuse('*CRACK c|'//keys//'|', part)
   end subroutine refuse_crack

   !> What is added to a right deck must make it wrong.
   subroutine refuse(addition, part)
      character(len=*), intent(in) :: addition
      character(len=*), intent(in) :: part

      call parse_with(addition)
      call check_error(suite, addition, error, part)
   end subroutine refuse

   subroutine parse_with(addition)
      character(len=*), intent(in) :: addition

      call parse(base//addition//'*END')
   end subroutine parse_with

   subroutine parse(text)
      character(len=*), intent(in) :: text

      call parse_deck(lines(text), 'test.inp', deck, error)
   end subroutine parse

   !> Bars to ends of lines.
   function lines(text) result(split)
      character(len=*), intent(in) :: text
      character(len=len(text)) :: split
      integer :: i

      split = text
      do i = 1, len(text)
         if (text(i:i) == '|') split(i:i) = new_line('a')
      end do
   end function lines

   function any_warning(part) result(found)
      character(len=*), intent(in) :: part
      logical :: found
      integer :: i

      found = .false.
      if (.not. allocated(deck%warnings)) return
      do i = 1, size(deck%warnings)
         found = found .or. index(deck%warnings(i)%s, part) > 0
      end do
   end function any_warning

   subroutine write_file(path, text)
      character(len=*), intent(in) :: path
      character(len=*), intent(in) :: text
      integer :: unit

      open (newunit=unit, file=path, status='replace', action='write')
      write (unit, '(a)', advance='no') lines(text)
      close (unit)
   end subroutine write_file
end program test_deck
