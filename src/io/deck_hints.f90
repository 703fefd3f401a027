!> The nearest valid name to one that is not valid.
module xmpm_deck_hints
   use xmpm_text, only: string_t, lower
   implicit none
   private

   public :: edit_distance, nearest_name, did_you_mean

contains

   !> Fewest insertions, deletions, changes and swaps of neighbours from one word to the other.
   pure function edit_distance(a, b) result(distance)
      character(len=*), intent(in) :: a   !! one word
      character(len=*), intent(in) :: b   !! the other
      integer :: distance
      integer :: d(0:len(a), 0:len(b)), i, j, cost

      d(:, 0) = [(i, i=0, len(a))]
      d(0, :) = [(j, j=0, len(b))]
      do j = 1, len(b)
         do i = 1, len(a)
            cost = merge(0, 1, a(i:i) == b(j:j))
            d(i, j) = min(d(i - 1, j) + 1, d(i, j - 1) + 1, d(i - 1, j - 1) + cost)
            if (i > 1 .and. j > 1) then
               if (a(i:i) == b(j - 1:j - 1) .and. a(i - 1:i - 1) == b(j:j)) then
                  d(i, j) = min(d(i, j), d(max(i - 2, 0), max(j - 2, 0)) + 1)
               end if
            end if
         end do
      end do
      distance = d(len(a), len(b))
   end function edit_distance

   !> Place of the name nearest to a word, whatever the case of its letters; 0 without names.
   pure function nearest_name(word, names) result(place)
      character(len=*), intent(in) :: word     !! what was written
      type(string_t), intent(in) :: names(:)   !! what is valid
      integer :: place
      integer :: i, distance, least

      place = 0
      least = huge(least)
      do i = 1, size(names)
         distance = distance_of_starts(word, names(i)%s)
         if (distance < least) then
            least = distance
            place = i
         end if
      end do
   end function nearest_name

   !> Edit distance of the first letters of two words, without regard to their case.
   pure function distance_of_starts(a, b) result(distance)
      character(len=*), intent(in) :: a
      character(len=*), intent(in) :: b
      integer :: distance
      integer, parameter :: longest = 80

      distance = edit_distance(lower(a(:min(len(a), longest))), lower(b(:min(len(b), longest))))
   end function distance_of_starts

   !> '; did you mean ...?' with the nearest name, or nothing where there are no names.
   pure function did_you_mean(word, names) result(hint)
      character(len=*), intent(in) :: word     !! what was written
      type(string_t), intent(in) :: names(:)   !! what is valid
      character(len=:), allocatable :: hint
      integer :: place

      hint = ''
      place = nearest_name(word, names)
      if (place > 0) hint = "; did you mean '"//names(place)%s//"'?"
   end function did_you_mean
end module xmpm_deck_hints
