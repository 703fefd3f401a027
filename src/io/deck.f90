!> The keyword deck: from text to checked blocks with all defaults filled in.
module xmpm_deck
   use, intrinsic :: ieee_arithmetic, only: ieee_get_halting_mode, ieee_set_halting_mode, &
      ieee_set_flag
   use, intrinsic :: ieee_exceptions, only: ieee_usual
   use xmpm_error, only: error_t
   use xmpm_keywords, only: keyword_t
   use xmpm_keywords_table, only: make_keyword_table
   use xmpm_deck_data, only: deck_t, block_t, entry_t, count_blocks, find_block, block_named, &
      has, given, real_of, reals_of, integer_of, text_of, texts_of, flag_of, complain, warn, &
      problems, warnings_of
   use xmpm_deck_lexer, only: tokens_t, cut_into_tokens
   use xmpm_deck_parser, only: build_blocks
   use xmpm_deck_values, only: evaluate_parameters, evaluate_entries, fill_defaults, &
      check_required
   use xmpm_deck_checks, only: check_deck, fill_dependent_defaults
   use xmpm_deck_files, only: read_deck, deck_name
   use xmpm_deck_echo, only: deck_echo
   use xmpm_deck_units, only: si_factor, unit_text, sound_speed
   implicit none
   private

   public :: parse_deck, read_deck, deck_name, deck_echo
   public :: deck_t, block_t, entry_t, count_blocks, find_block, block_named
   public :: has, given, real_of, reals_of, integer_of, text_of, texts_of, flag_of
   public :: complain, warn, problems, warnings_of
   public :: si_factor, unit_text, sound_speed

contains

   !> Read a deck from its text; the error lists all that is wrong with it.
   !>
   !> Traps of floating point are off meanwhile: absurd numbers must end as messages.
   subroutine parse_deck(text, name, deck, error)
      character(len=*), intent(in) :: text   !! lines split by new_line, from read_deck or not
      character(len=*), intent(in) :: name                !! file name, for messages
      type(deck_t), intent(out) :: deck                   !! with all defaults
      type(error_t), allocatable, intent(out) :: error    !! one line for each problem
      logical :: halting(size(ieee_usual))

      call ieee_get_halting_mode(ieee_usual, halting)
      call ieee_set_halting_mode(ieee_usual, .false.)
      allocate (deck%blocks(0), deck%definitions(0))
      deck%name = name
      call build_deck(text, deck, error)
      call ieee_set_flag(ieee_usual, .false.)
      call ieee_set_halting_mode(ieee_usual, halting)
   end subroutine parse_deck

   subroutine build_deck(text, deck, error)
      character(len=*), intent(in) :: text
      type(deck_t), intent(inout) :: deck
      type(error_t), allocatable, intent(out) :: error
      type(keyword_t), allocatable :: table(:)
      type(tokens_t) :: tokens

      call make_keyword_table(table)
      call cut_into_tokens(text, deck, tokens)
      call build_blocks(tokens, table, deck)
      call evaluate_parameters(deck)
      call evaluate_entries(deck, table)
      call check_required(deck, table)
      call fill_defaults(deck, table)
      call check_deck(deck)
      call problems(deck, error)
      if (.not. allocated(error)) call fill_dependent_defaults(deck)
   end subroutine build_deck
end module xmpm_deck
