!> *GROWTH in a deck: what is accepted, and every message about what is wrong.
program test_deck_growth
   use xmpm_error, only: error_t
   use xmpm_deck, only: deck_t, parse_deck
   use testing, only: suite_t, check_error, check_no_error, finish
   implicit none
   type(suite_t) :: suite

   !> A deck to which each test adds a *GROWTH; a bar stands for the end of a line.
   character(len=*), parameter :: plain = '*JOB plate|*GRID size=1|*TIME end=0.5|' &
      //'*MATERIAL alloy density=1500, young=1e11, poisson=0.3|' &
      //'*BODY plate material=alloy box=0 0 0 4 4 4|' &
      //'*CRACK slit disc, centre=2 2 2, along=1 0 0, across=0 1 0, radius=1|'
   character(len=*), parameter :: looked = '*FRACTURE every=0.1|'
   character(len=*), parameter :: told = '*GROWTH criterion=straight, law=speed'
   character(len=*), parameter :: placed = '*GROWTH criterion=straight, law=position'

   suite%name = 'deck_growth'
   call accepts()
   call refuses()
   call finish(suite)

contains

   subroutine accepts()
      call takes('a prescribed speed in the plane, without *FRACTURE', &
         told//', speed=3')
      call takes('a table of the way', &
         '*GROWTH cracks=SLIT, criterion=straight, law=position, table=0 0 1 2 3 2')
      call takes('eq. 60 with a toughness of its own and a region', looked// &
         '*GROWTH toughness=20, region=0 0 0 1 1 1 30, increment=2')
      call takes('a distance of fronts that meet', looked//'*GROWTH toughness=20, meeting=3')
      call takes('a table of K_ID', looked//'*GROWTH law=table, table=0 10 100 20')
   end subroutine accepts

   subroutine refuses()
      call blames('an increment below 0.1', told//', speed=3, increment=0.05', 'increment')
      call blames('an increment above 2', told//', speed=3, increment=2.5', 'increment')
      call blames('fronts that meet at no distance', told//', speed=3, meeting=0', 'meeting')
      call blames('a crack that is not there', told//', speed=3, cracks=slat', "no *CRACK 'slat'")
      call blames('a law without its speed', told, "law = speed needs 'speed'")
      call blames('a law without its table', looked//'*GROWTH law=table', &
         "law = table needs 'table'")
      call blames('a speed for another law', looked//'*GROWTH toughness=20, speed=3', &
         'it goes with law = speed')
      call blames('a table for another law', looked//'*GROWTH toughness=20, table=0 1 2 3', &
         'it goes with law = table or position')
      call blames('half a pair', placed//', table=0 0 1 2 3', 'pairs of numbers')
      call blames('a table that is no function', placed//', table=0 0 1 2 1 3', &
         'it is no function')
      call blames('a way that falls', placed//', table=0 0 1 2 2 1', 'must not fall')
      call blames('K_ID that falls', looked//'*GROWTH law=table, table=0 10 100 9', &
         'K_ID must rise')
      call blames('K_ID that does not begin at rest', &
         looked//'*GROWTH law=table, table=1 10 100 20', 'begin with speed 0')
      call blames('a law that needs a toughness nobody has', looked//'*GROWTH', &
         'no body has a toughness')
      call blames('a toughness that nobody asks for', told//', speed=3, toughness=20', &
         'does not ask for it')
      call blames('K without *FRACTURE', '*GROWTH toughness=20', 'this growth asks for K')
      call growth_without_crack()
   end subroutine refuses

   subroutine growth_without_crack()
      type(error_t), allocatable :: error

      call parse(plain(:index(plain, '*CRACK') - 1)//told//', speed=3', error)
      call check_error(suite, 'refused: growth without a crack', error, 'no *CRACK that could grow')
   end subroutine growth_without_crack

   subroutine takes(what, growth)
      character(len=*), intent(in) :: what, growth
      type(error_t), allocatable :: error

      call parse(plain//growth, error)
      call check_no_error(suite, 'taken: '//what, error)
   end subroutine takes

   subroutine blames(what, growth, part)
      character(len=*), intent(in) :: what, growth, part
      type(error_t), allocatable :: error

      call parse(plain//growth, error)
      call check_error(suite, 'refused: '//what, error, part)
   end subroutine blames

   subroutine parse(text, error)
      character(len=*), intent(in) :: text
      type(error_t), allocatable, intent(out) :: error
      type(deck_t) :: deck
      character(len=:), allocatable :: lines
      integer :: i

      lines = text//'|*END'
      do i = 1, len(lines)
         if (lines(i:i) == '|') lines(i:i) = new_line('a')
      end do
      call parse_deck(lines, 'test.inp', deck, error)
   end subroutine parse
end program test_deck_growth
