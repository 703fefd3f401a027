!> A model from the text of a deck, for tests of what needs particles and ranks.
module small_model
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t
   use xmpm_deck, only: deck_t, parse_deck
   use xmpm_model, only: model_t
   use xmpm_setup, only: set_up
   implicit none
   private

   public :: make_model

contains

   !> Parse a deck, where | stands for the end of a line, and set its model up. Collective.
   subroutine make_model(comm, text, deck, m, error)
      type(comm_t), intent(in) :: comm                    !! ranks
      character(len=*), intent(in) :: text                !! of the deck, without *END
      type(deck_t), intent(out) :: deck                   !! parsed
      type(model_t), intent(out) :: m                     !! ready for its first step
      type(error_t), allocatable, intent(out) :: error    !! of the deck or of set-up
      character(len=:), allocatable :: lines
      integer :: i

      lines = text//'|*END'
      do i = 1, len(lines)
         if (lines(i:i) == '|') lines(i:i) = new_line('a')
      end do
      call parse_deck(lines, 'test.inp', deck, error)
      if (allocated(error)) return
      m%comm = comm
      call set_up(m, deck, error)
   end subroutine make_model
end module small_model
