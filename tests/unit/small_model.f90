!> A model from the text of a deck, for tests of what needs particles and ranks.
module small_model
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t
   use xmpm_deck, only: deck_t, parse_deck
   use xmpm_storage, only: c_x
   use xmpm_model, only: model_t
   use xmpm_setup, only: set_up
   implicit none
   private

   public :: make_model, disturb, seed

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

   !> Move all particles at random by a part of a cell in each direction, on each rank by its own.
   subroutine disturb(m, most)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: most   !! [length]
      real(wp) :: u(3)
      integer :: c, k

      call seed(5 + m%comm%rank)
      do c = 1, m%particles%n_chunks
         do k = 1, m%particles%count(c)
            call random_number(u)
            m%particles%q(k, c_x:c_x + 2, c) = m%particles%q(k, c_x:c_x + 2, c) + most*(2*u - 1)
         end do
      end do
   end subroutine disturb

   !> Begin the random numbers anew.
   subroutine seed(number)
      integer, intent(in) :: number
      integer :: k, n

      call random_seed(size=n)
      call random_seed(put=[(number + k, k=1, n)])
   end subroutine seed
end module small_model
