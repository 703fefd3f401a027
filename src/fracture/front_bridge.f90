!> Surface between fronts that have met, and over the last rest inside a closed one.
module xmpm_front_bridge
   use xmpm_kinds, only: wp
   use xmpm_front, only: front_t
   use xmpm_front_line, only: front_limits_t
   use xmpm_material_test, only: material_test_t
   use xmpm_front_strip, only: strip_between
   use xmpm_surface_draft, only: draft_t, add_vertex, add_triangles
   implicit none
   private

   public :: join_chains, close_chain

   integer, parameter :: farthest_out = 12   !! quarters of a cell that an end of a row is led out

contains

   !> Rows of triangles between two fronts that have met, no longer than segments may be.
   !>
   !> If that did not hold, without what hangs out at the ends, and then in one row.
   subroutine join_chains(front, chain, other, limits, material, attempt, draft)
      type(front_t), intent(in) :: front               !! fronts of one crack
      integer, intent(in) :: chain, other              !! the two of them
      type(front_limits_t), intent(in) :: limits
      class(material_test_t), intent(in) :: material   !! where material is
      integer, intent(in) :: attempt                   !! 1, 2 without the ends, 3 in one row
      type(draft_t), intent(inout) :: draft            !! gets the triangles
      integer, allocatable :: tri(:, :), row(:), next(:), far(:)
      integer :: i, k, first, last, rows

      call ends_of_line(front, other, material, attempt > 1, first, last)
      far = [(front%vertex(i), i=last, first, -1)]
      call ends_of_line(front, chain, material, attempt > 1, first, last)
      row = front%vertex(first:last)
      rows = 1
      if (.not. front%closed(chain) .and. attempt < 3) rows = max(1, &
         nint(mean_gap(row, far, draft)/limits%longest))
      do k = 1, rows
         next = far
         if (k < rows) call add_row(row, far, rows - k + 1, first)
         call strip_between(row, next, front%closed(chain), draft%x, front%e2(:, first:last), tri)
         call add_triangles(tri, draft)
         row = next
      end do

   contains

      !> The next of the rows that are left, its ends outside.
      subroutine add_row(row, far, left, first)
         integer, intent(in) :: row(:), far(:)   !! vertices that it follows and those it ends at
         integer, intent(in) :: left             !! rows to the far line
         integer, intent(in) :: first            !! node of the front behind the first vertex
         real(wp) :: x(3, size(row))
         integer :: i, n

         n = size(row)
         do i = 1, n
            associate (here => draft%x(:, row(i)))
               x(:, i) = here + (opposite(row, i, far, draft) - here)/real(left, wp)
            end associate
         end do
         call lead_out(material, limits, x(:, 2), x(:, 1))
         call lead_out(material, limits, x(:, n - 1), x(:, n))
         next = row
         do i = 1, n
            if (any(far == row(i))) cycle
            call add_vertex(front, x(:, i), spread(first + i - 1, 1, 2), 0.0_wp, draft)
            next(i) = size(draft%x, 2)
         end do
      end subroutine add_row
   end subroutine join_chains

   !> First and last node of a chain, or of what is left of it with one node outside at each end.
   pure subroutine ends_of_line(front, chain, material, trimmed, first, last)
      type(front_t), intent(in) :: front
      integer, intent(in) :: chain
      class(material_test_t), intent(in) :: material
      logical, intent(in) :: trimmed
      integer, intent(out) :: first, last

      first = front%chain_offset(chain)
      last = front%chain_offset(chain + 1) - 1
      if (.not. trimmed .or. front%closed(chain)) return
      do while (first < last - 1)
         if (material%inside(front%x(:, first + 1))) exit
         first = first + 1
      end do
      do while (last > first + 1)
         if (material%inside(front%x(:, last - 1))) exit
         last = last - 1
      end do
   end subroutine ends_of_line

   !> Move an end of a row along the row until it is outside: over a curved wall the straight way
   !> between two fronts sinks into the material.
   pure subroutine lead_out(material, limits, beside, x)
      class(material_test_t), intent(in) :: material
      type(front_limits_t), intent(in) :: limits
      real(wp), intent(in) :: beside(3)    !! the vertex beside it [length]
      real(wp), intent(inout) :: x(3)      !! the end [length]
      real(wp) :: step(3)
      integer :: i

      if (.not. norm2(x - beside) > 0.0_wp) return
      step = 0.25_wp*limits%cell*(x - beside)/norm2(x - beside)
      do i = 1, farthest_out
         if (.not. material%inside(x)) return
         x = x + step
      end do
   end subroutine lead_out

   !> Mean distance between the vertices of a line and the places opposite to them.
   pure function mean_gap(row, far, draft) result(gap)
      integer, intent(in) :: row(:), far(:)
      type(draft_t), intent(in) :: draft
      real(wp) :: gap
      integer :: i

      gap = 0
      do i = 1, size(row)
         gap = gap + norm2(opposite(row, i, far, draft) - draft%x(:, row(i))) &
            /real(size(row), wp)
      end do
   end function mean_gap

   !> The place of a line at the same part of its length as a vertex of another has.
   pure function opposite(row, i, far, draft) result(x)
      integer, intent(in) :: row(:), i, far(:)
      type(draft_t), intent(in) :: draft
      real(wp) :: x(3), way, step
      integer :: k

      way = length_of(draft%x(:, row(:i)))/max(length_of(draft%x(:, row)), tiny(1.0_wp)) &
         *length_of(draft%x(:, far))
      do k = 2, size(far)
         step = norm2(draft%x(:, far(k)) - draft%x(:, far(k - 1)))
         if (way <= step) exit
         way = way - step
      end do
      k = min(k, size(far))
      way = min(1.0_wp, way/max(step, tiny(1.0_wp)))
      x = (1 - way)*draft%x(:, far(k - 1)) + way*draft%x(:, far(k))
      if (i == size(row)) x = draft%x(:, far(size(far)))
   end function opposite

   pure function length_of(x) result(length)
      real(wp), intent(in) :: x(:, :)
      real(wp) :: length
      integer :: i

      length = 0
      do i = 2, size(x, 2)
         length = length + norm2(x(:, i) - x(:, i - 1))
      end do
   end function length_of

   !> Triangles from a small closed front to its centre.
   subroutine close_chain(front, chain, draft)
      type(front_t), intent(in) :: front       !! fronts of one crack
      integer, intent(in) :: chain             !! a closed one
      type(draft_t), intent(inout) :: draft    !! gets the triangles
      integer :: i, first, last, n, centre

      first = front%chain_offset(chain)
      last = front%chain_offset(chain + 1) - 1
      n = last - first + 1
      call add_vertex(front, sum(front%x(:, first:last), 2)/real(n, wp), [first, first + n/2], &
         0.5_wp, draft)
      centre = size(draft%x, 2)
      do i = first, last
         call add_triangles(reshape([front%vertex(i), front%vertex(merge(first, i + 1, &
            i == last)), centre], [3, 1]), draft)
      end do
   end subroutine close_chain
end module xmpm_front_bridge
