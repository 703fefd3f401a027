!> Distribution of blocks over ranks by METIS, through its C interface.
module xmpm_partition
   use, intrinsic :: iso_c_binding, only: c_int, c_ptr, c_null_ptr
   use xmpm_kinds, only: i8
   use xmpm_error, only: error_t, raise, code_parallel
   use xmpm_hash_map, only: hash_map_t, clear_map, set_value, value_of
   use xmpm_text, only: to_text
   implicit none
   private

   public :: partition_blocks

   integer(i8), parameter :: step(3) = [1_i8, 2_i8**21, 2_i8**42]   !! of a packed place

   interface
      function metis_set_default_options(options) bind(c, name='METIS_SetDefaultOptions') result(rc)
         import :: c_int
         integer(c_int), intent(inout) :: options(0:39)
         integer(c_int) :: rc
      end function metis_set_default_options

      function metis_part_graph_kway(nvtxs, ncon, xadj, adjncy, vwgt, vsize, adjwgt, nparts, &
                                     tpwgts, ubvec, options, edgecut, part) &
         bind(c, name='METIS_PartGraphKway') result(rc)
         import :: c_int, c_ptr
         integer(c_int), intent(in) :: nvtxs, ncon, xadj(*), adjncy(*), vwgt(*)
         type(c_ptr), value :: vsize
         integer(c_int), intent(in) :: adjwgt(*), nparts
         type(c_ptr), value :: tpwgts, ubvec
         integer(c_int), intent(in) :: options(0:39)
         integer(c_int), intent(out) :: edgecut, part(*)
         integer(c_int) :: rc
      end function metis_part_graph_kway
   end interface

contains

   !> Part of each block, from 0: weights balanced, few shared nodes, much kept where it was.
   subroutine partition_blocks(keys, weights, n_parts, previous, parts, error)
      integer(i8), intent(in) :: keys(:)     !! packed places of the blocks (21 bits a direction)
      integer, intent(in) :: weights(:)      !! particles of each
      integer, intent(in) :: n_parts         !! number of ranks
      integer, intent(in) :: previous(:)     !! part of each before, -1 for none
      integer, allocatable, intent(out) :: parts(:)
      type(error_t), allocatable, intent(out) :: error
      integer(c_int), allocatable :: first(:), other(:), shared(:), part(:)
      integer(c_int) :: options(0:39), cut, rc
      integer, parameter :: seed_option = 8, imbalance_option = 16
      integer :: i

      allocate (parts(size(keys)))
      parts = [(mod(i - 1, n_parts), i=1, size(keys))]
      if (n_parts == 1 .or. size(keys) <= n_parts) return
      call build_graph(keys, first, other, shared)
      allocate (part(size(keys)))
      rc = metis_set_default_options(options)
      options(seed_option) = 1
      options(imbalance_option) = 10
      rc = metis_part_graph_kway(size(keys), 1, first, other, max(1, weights), c_null_ptr, shared, &
         n_parts, c_null_ptr, c_null_ptr, options, cut, part)
      if (rc /= 1) then
         call raise(error, code_parallel, 'METIS could not divide '//to_text(size(keys))// &
            ' blocks among '//to_text(n_parts)//' ranks (return code '//to_text(int(rc))//')')
         return
      end if
      parts = keep_places(int(part), previous, weights, n_parts)
   end subroutine partition_blocks

   !> Blocks beside each other, with the number of nodes that they share.
   subroutine build_graph(keys, first, other, shared)
      integer(i8), intent(in) :: keys(:)
      integer(c_int), allocatable, intent(out) :: first(:), other(:), shared(:)
      type(hash_map_t) :: find
      integer :: i, a, b, c, n, j

      call clear_map(find, size(keys))
      do i = 1, size(keys)
         call set_value(find, keys(i), i)
      end do
      allocate (first(size(keys) + 1), other(26*size(keys)), shared(26*size(keys)))
      n = 0
      do i = 1, size(keys)
         first(i) = n
         do c = -1, 1
            do b = -1, 1
               do a = -1, 1
                  if (a == 0 .and. b == 0 .and. c == 0) cycle
                  j = value_of(find, keys(i) + sum(step*int([a, b, c], i8)), 0)
                  if (j == 0) cycle
                  n = n + 1
                  other(n) = j - 1
                  shared(n) = 5**(3 - abs(a) - abs(b) - abs(c))
               end do
            end do
         end do
      end do
      first(size(keys) + 1) = n
   end subroutine build_graph

   !> Name the parts so that most weight stays where it was.
   pure function keep_places(part, previous, weights, n_parts) result(named)
      integer, intent(in) :: part(:), previous(:), weights(:), n_parts
      integer :: named(size(part))
      integer :: shared(0:n_parts - 1, 0:n_parts - 1), name(0:n_parts - 1), i, best(2)
      logical :: free(0:n_parts - 1, 0:n_parts - 1)

      shared = 0
      do i = 1, size(part)
         if (previous(i) < 0 .or. previous(i) >= n_parts) cycle
         shared(part(i), previous(i)) = shared(part(i), previous(i)) + weights(i)
      end do
      free = .true.
      do i = 1, n_parts
         best = maxloc(shared, mask=free) - 1
         name(best(1)) = best(2)
         free(best(1), :) = .false.
         free(:, best(2)) = .false.
      end do
      named = name(part)
   end function keep_places
end module xmpm_partition
