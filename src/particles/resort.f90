!> Putting the chunks back into the order of the blocks, so that each pass walks through memory.
module xmpm_resort
   use xmpm_kinds, only: wp, i8
   use xmpm_lattice, only: bins_per_block
   use xmpm_storage, only: particles_t, lanes, n_hot
   implicit none
   private

   public :: resort_chunks

   !> One chunk by itself.
   type :: chunk_t
      real(wp) :: q(lanes, n_hot), x0(lanes, 3)
      integer(i8) :: id(lanes), sets(lanes), any_set
      integer :: count, body, bin, attached
   end type chunk_t

contains

   !> Order the chunks by block, bin and place in the bin; in place, one cycle after the other.
   subroutine resort_chunks(p)
      type(particles_t), intent(inout) :: p
      integer, allocatable :: from(:)
      type(chunk_t) :: held
      integer :: start, to, next

      call list_chunks(p, from)
      do start = 1, size(from)
         if (from(start) <= 0 .or. from(start) == start) cycle
         held = take(p, start)
         to = start
         do while (from(to) /= start)
            next = from(to)
            call put(p, to, take(p, next))
            from(to) = -next
            to = next
         end do
         call put(p, to, held)
         from(to) = -from(to)
      end do
      call link_chunks(p)
   end subroutine resort_chunks

   !> Where the chunk for each place stands now; free chunks go to the end, so that it is a
   !> permutation of all chunks.
   subroutine list_chunks(p, from)
      type(particles_t), intent(in) :: p
      integer, allocatable, intent(out) :: from(:)
      integer :: b, k, c, n

      allocate (from(p%n_chunks))
      n = 0
      do b = 1, size(p%head, 2)
         do k = 1, bins_per_block
            c = p%head(k, b)
            do while (c > 0)
               n = n + 1
               from(n) = c
               c = p%next(c)
            end do
         end do
      end do
      c = p%free
      do while (c > 0)
         n = n + 1
         from(n) = c
         c = p%next(c)
      end do
   end subroutine list_chunks

   pure function take(p, c) result(chunk)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: c
      type(chunk_t) :: chunk

      chunk%q = p%q(:, :, c)
      chunk%x0 = p%x0(:, :, c)
      chunk%id = p%id(:, c)
      chunk%sets = p%sets(:, c)
      chunk%any_set = p%any_set(c)
      chunk%count = p%count(c)
      chunk%body = p%body(c)
      chunk%bin = p%bin(c)
      chunk%attached = p%attached(c)
   end function take

   pure subroutine put(p, c, chunk)
      type(particles_t), intent(inout) :: p
      integer, intent(in) :: c
      type(chunk_t), intent(in) :: chunk

      p%q(:, :, c) = chunk%q
      p%x0(:, :, c) = chunk%x0
      p%id(:, c) = chunk%id
      p%sets(:, c) = chunk%sets
      p%any_set(c) = chunk%any_set
      p%count(c) = chunk%count
      p%body(c) = chunk%body
      p%bin(c) = chunk%bin
      p%attached(c) = chunk%attached
   end subroutine put

   !> Chain the chunks of each bin anew, in storage order; chunks without particles are dropped.
   subroutine link_chunks(p)
      type(particles_t), intent(inout) :: p
      integer :: c, last, b, k, n

      p%head = 0
      n = 0
      last = 0
      do c = 1, p%n_chunks
         if (p%count(c) == 0) cycle
         n = c
         p%next(c) = 0
         b = 1 + (p%bin(c) - 1)/bins_per_block
         k = 1 + mod(p%bin(c) - 1, bins_per_block)
         if (p%head(k, b) == 0) then
            p%head(k, b) = c
         else
            p%next(last) = c
         end if
         last = c
      end do
      p%n_chunks = n
      p%free = 0
   end subroutine link_chunks
end module xmpm_resort
