!> Checks of *GROWTH: keys that go with the law, tables that are functions, what K needs.
module xmpm_deck_growth
   use xmpm_kinds, only: wp
   use xmpm_text, only: string_t, to_text, lower
   use xmpm_deck_data, only: deck_t, block_t, has, given, valid, real_of, reals_of, text_of, &
      texts_of, complain, warn, find_block, count_blocks
   use xmpm_deck_choices, only: refuse
   use xmpm_deck_references, only: resolve_list
   implicit none
   private

   public :: check_growth

contains

   !> Check one *GROWTH block.
   subroutine check_growth(deck, block)
      type(deck_t), intent(inout) :: deck   !! gets problems
      type(block_t), intent(in) :: block

      call resolve_list(deck, block, 'cracks', 'crack')
      if (count_blocks(deck, 'crack') == 0) then
         call complain(deck, block, '', 'there is no *CRACK that could grow')
      end if
      call check_rules(deck, block)
      call check_law(deck, block)
      call check_table(deck, block)
      if (law_of(block) == 'running' .or. law_of(block) == 'constant') then
         call check_toughness(deck, block)
      else
         call refuse(deck, block, 'toughness', 'law = '//law_of(block)//' does not ask for it')
         call refuse(deck, block, 'region', 'law = '//law_of(block)//' does not ask for it')
      end if
      if (needs_k(block) .and. count_blocks(deck, 'fracture') == 0) then
         call complain(deck, block, '', 'this growth asks for K at the fronts: a *FRACTURE '// &
            'block '// &
            'must say how (or take law = speed or position with criterion = straight)')
      end if
   end subroutine check_growth

   pure function law_of(block) result(law)
      type(block_t), intent(in) :: block
      character(len=:), allocatable :: law

      law = lower(text_of(block, 'law'))
   end function law_of

   !> Whether the law or the direction asks for stress intensity factors.
   pure function needs_k(block) result(needs)
      type(block_t), intent(in) :: block
      logical :: needs

      needs = index('speed position', law_of(block)) == 0 &
         .or. lower(text_of(block, 'criterion')) /= 'straight'
   end function needs_k

   !> Only the graded front can go between nodes.
   subroutine check_rules(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(block_t) :: crack
      integer :: i

      do i = 1, count_blocks(deck, 'crack')
         crack = find_block(deck, 'crack', i)
         if (.not. is_listed(block, crack%name)) cycle
         if (lower(text_of(crack, 'front')) == 'graded') cycle
         call warn(deck, block, '', "the crack '"//crack%name//"' has front = "// &
            text_of(crack, 'front')//': it will jump from node to node, and K with it; '// &
            'front = graded is meant for growth')
      end do
   end subroutine check_rules

   pure function is_listed(block, name) result(is)
      type(block_t), intent(in) :: block
      character(len=*), intent(in) :: name
      logical :: is
      type(string_t), allocatable :: names(:)
      integer :: i

      is = .not. has(block, 'cracks')
      if (is) return
      names = texts_of(block, 'cracks')
      do i = 1, size(names)
         is = is .or. lower(names(i)%s) == lower(name)
      end do
   end function is_listed

   !> Each law has its own numbers.
   subroutine check_law(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block

      select case (law_of(block))
      case ('speed')
         if (.not. has(block, 'speed')) call complain(deck, block, 'law', &
            "law = speed needs 'speed'")
         call refuse(deck, block, 'table', 'it goes with law = table or position')
      case ('table', 'position')
         if (.not. has(block, 'table')) call complain(deck, block, 'law', 'law = '// &
            law_of(block)// &
            " needs 'table'")
         call refuse(deck, block, 'speed', 'it goes with law = speed')
      case default
         call refuse(deck, block, 'speed', 'it goes with law = speed')
         call refuse(deck, block, 'table', 'it goes with law = table or position')
      end select
   end subroutine check_law

   !> Pairs; the first numbers rise, the second ones rise (K_ID) or do not fall (the way).
   subroutine check_table(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      real(wp), allocatable :: n(:)
      integer :: last

      if (.not. valid(block, 'table')) return
      n = reals_of(block, 'table')
      last = size(n)
      if (mod(last, 2) /= 0) then
         call complain(deck, block, 'table', 'pairs of numbers are needed; got '//to_text(last)// &
            ' numbers')
      else if (any(n(3:last:2) <= n(1:last - 2:2))) then
         call complain(deck, block, 'table', 'it is no function: the first number of each pair '// &
            'must be larger than that of the pair before')
      else if (law_of(block) == 'table' .and. any(n(4:last:2) <= n(2:last - 2:2))) then
         call complain(deck, block, 'table', 'K_ID must rise from pair to pair, else a K* has '// &
            'more than one speed')
      else if (law_of(block) == 'table' .and. (abs(n(1)) > 0 .or. n(2) <= 0)) then
         call complain(deck, block, 'table', 'it must begin with speed 0 and a K_ID above 0')
      else if (law_of(block) == 'position' .and. any(n(4:last:2) < n(2:last - 2:2))) then
         call complain(deck, block, 'table', 'the way must not fall: a crack does not close up')
      end if
   end subroutine check_table

   !> Every body a front may enter needs a toughness, or the block has one for all.
   subroutine check_toughness(deck, block)
      type(deck_t), intent(inout) :: deck
      type(block_t), intent(in) :: block
      type(block_t) :: body, material
      integer :: i, k

      if (has(block, 'toughness')) return
      do i = 1, count_blocks(deck, 'body')
         body = find_block(deck, 'body', i)
         do k = 1, count_blocks(deck, 'material')
            material = find_block(deck, 'material', k)
            if (lower(material%name) /= lower(text_of(body, 'material'))) cycle
            if (has(material, 'toughness')) return
         end do
      end do
      call complain(deck, block, '', 'no body has a toughness: give it in *MATERIAL or here')
   end subroutine check_toughness
end module xmpm_deck_growth
