!> Particle storage: chunks of 8 lanes, chained bin by bin.
!>
!> A chunk holds particles of one bin and one body. Empty lanes have no mass, no volume and stand at
!> the bin's middle, so that kernels need no special cases. What a quantity costs is one line here.
module xmpm_storage
   use xmpm_kinds, only: wp, i8
   use xmpm_lattice, only: lattice_t, bin_corner, bins_per_block, block_width
   use xmpm_blocks, only: blocks_t, local_block
   implicit none
   private

   public :: particles_t, clear_particles, append_particle, remove_lane, move_lane
   public :: count_particles, bin_of_chunk, read_record, take_records, new_to_bin
   public :: record_t, new_record, renumber_blocks, attach
   public :: lanes, n_hot, c_x, c_v, c_m, c_vol, c_s
   public :: n_near, near_crack, near_side, near_psi, near_phi, near_jump, near_slope, &
      near_ahead, near_place
   public :: n_trace, trace_f, trace_work, is_traced

   integer, parameter :: lanes = 8      !! particles of a chunk
   integer, parameter :: c_x = 1        !! 1:3 position [length]
   integer, parameter :: c_v = 4        !! 4:6 velocity [length/time]
   integer, parameter :: c_m = 7        !! mass
   integer, parameter :: c_vol = 8      !! volume [length^3]
   integer, parameter :: c_s = 9        !! 9:14 Cauchy stress xx yy zz xy yz xz
   integer, parameter :: n_hot = 14     !! components that every step touches

   integer, parameter :: near_crack = 1   !! crack that the slot belongs to, 0 for none
   integer, parameter :: near_jump = 2    !! H, from -1 to 1; read in every step, hence beside it
   integer, parameter :: near_slope = 3   !! 3:5 gradient of H [1/length]
   integer, parameter :: near_side = 6    !! +1 or -1, kept behind the front
   integer, parameter :: near_psi = 7     !! signed distance to the crack [length]
   integer, parameter :: near_phi = 8     !! distance ahead of the front [length]
   integer, parameter :: near_ahead = 9   !! distance ahead of the front as it is in the mesh
                                          !! [length]
   integer, parameter :: near_place = 10  !! front edge plus part of it where the front is nearest,
                                          !! 0 for none
   integer, parameter :: n_near = 10      !! values of a slot

   integer, parameter :: trace_f = 1      !! 1:9 deformation gradient F_ij at 3 (i - 1) + j, all 0
                                          !! where the particle is not traced
   integer, parameter :: trace_work = 10  !! stress work done on the particle so far [energy]
   integer, parameter :: n_trace = 10     !! values of a trace

   !> All particles of a rank.
   type :: particles_t
      integer :: n_chunks = 0                     !! chunks ever used; those behind are fresh
      integer :: free = 0                         !! first chunk of the free chain
      integer :: n_attached = 0                   !! near records ever used
      integer :: free_attached = 0                !! first of the free near records
      integer :: slots = 0                        !! cracks that a particle can be near to
      integer :: trace = -1                       !! place before the trace in a near record, -1
                                                  !! where no fracture parameters are wanted
      real(wp), allocatable :: q(:, :, :)         !! (8,14,chunks) hot components
      real(wp), allocatable :: x0(:, :, :)        !! (8,3,chunks) first position [length]
      integer(i8), allocatable :: id(:, :)        !! (8,chunks) number for life, 0 in empty lanes
      integer(i8), allocatable :: sets(:, :)      !! (8,chunks) bit per named set
      integer(i8), allocatable :: any_set(:)      !! (chunks) at least the bits of its particles
      integer, allocatable :: count(:)            !! (chunks) particles in the chunk
      integer, allocatable :: body(:)             !! (chunks) body of its particles
      integer, allocatable :: bin(:)              !! (chunks) 64 (block - 1) + bin of the block
      integer, allocatable :: next(:)             !! (chunks) next chunk of the bin or free chain
      integer, allocatable :: attached(:)         !! (chunks) near record, 0 far from cracks
      integer, allocatable :: head(:, :)          !! (64,blocks) first chunk of each bin
      real(wp), allocatable :: near(:, :, :)      !! (8,10*slots+10,records) crack slots of the
                                                  !! lanes, and their trace where there is one
      integer, allocatable :: next_attached(:)    !! (records) chain of free near records
      integer, allocatable :: group(:)            !! (bodies) contact group, from 0; unallocated
                                                  !! where all bodies share rows
   end type particles_t

   !> One particle by itself: what is created, moved between ranks and saved.
   type :: record_t
      real(wp) :: hot(n_hot) = 0                !! x v m vol s
      real(wp) :: x0(3) = 0                     !! first position [length]
      integer(i8) :: id = 0                     !! number for life
      integer(i8) :: sets = 0                   !! bit per named set
      integer :: body = 0                       !! body
      real(wp), allocatable :: near(:)          !! crack slots and trace, unallocated far from
                                                !! cracks
   end type record_t

contains

   !> A particle at rest at its first position.
   pure function new_record(id, body, x, mass, volume) result(record)
      integer(i8), intent(in) :: id
      integer, intent(in) :: body
      real(wp), intent(in) :: x(3), mass, volume   !! [length], [mass], [length^3]
      type(record_t) :: record

      record%id = id
      record%body = body
      record%x0 = x
      record%hot(c_x:c_x + 2) = x
      record%hot(c_m) = mass
      record%hot(c_vol) = volume
   end function new_record

   !> Empty storage for a number of blocks and about `expected` particles.
   subroutine clear_particles(p, n_blocks, expected, slots, traced)
      type(particles_t), intent(inout) :: p
      integer, intent(in) :: n_blocks   !! blocks of this rank
      integer, intent(in) :: expected   !! particles
      integer, intent(in) :: slots      !! cracks that a particle can be near to
      logical, intent(in) :: traced     !! whether near records hold a trace
      integer :: capacity

      capacity = expected/5 + 64
      p%n_chunks = 0
      p%free = 0
      p%n_attached = 0
      p%free_attached = 0
      p%slots = slots
      p%trace = merge(n_near*slots, -1, traced)
      if (allocated(p%q)) then
         deallocate (p%q, p%x0, p%id, p%sets, p%count, p%body, p%bin, p%next, p%attached, &
            p%any_set)
         deallocate (p%near, p%next_attached)
      end if
      allocate (p%q(lanes, n_hot, capacity), p%x0(lanes, 3, capacity))
      allocate (p%id(lanes, capacity), p%sets(lanes, capacity))
      allocate (p%count(capacity), p%body(capacity), p%bin(capacity), p%next(capacity))
      allocate (p%attached(capacity), p%any_set(capacity))
      allocate (p%near(lanes, n_near*slots + merge(n_trace, 0, traced), 0), p%next_attached(0))
      if (allocated(p%head)) deallocate (p%head)
      allocate (p%head(bins_per_block, n_blocks), source=0)
   end subroutine clear_particles

   !> Number of particles of this rank.
   pure function count_particles(p) result(n)
      type(particles_t), intent(in) :: p
      integer :: n

      n = sum(p%count(:p%n_chunks))
   end function count_particles

   !> Whether a chunk has room for the traces of its particles.
   pure function is_traced(p, chunk) result(traced)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: chunk
      logical :: traced

      traced = p%trace >= 0 .and. p%attached(chunk) > 0
   end function is_traced

   !> Lattice bin of a chunk.
   pure function bin_of_chunk(p, blocks, chunk) result(bin)
      type(particles_t), intent(in) :: p
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: chunk
      integer :: bin(3), k

      k = mod(p%bin(chunk) - 1, bins_per_block)
      bin = block_width*blocks%place(:, 1 + (p%bin(chunk) - 1)/bins_per_block) &
         + [iand(k, 3), iand(shifta(k, 2), 3), shifta(k, 4)]
   end function bin_of_chunk

   !> Put a particle into a bin of a block of this rank.
   subroutine append_particle(p, lattice, blocks, bin, record)
      type(particles_t), intent(inout) :: p
      type(lattice_t), intent(in) :: lattice
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: bin             !! 64 (block - 1) + bin of the block
      type(record_t), intent(in) :: record
      integer :: c, i

      c = chunk_with_room(p, lattice, blocks, bin, record%body)
      i = p%count(c) + 1
      p%count(c) = i
      p%q(i, :, c) = record%hot
      p%x0(i, :, c) = record%x0
      p%id(i, c) = record%id
      p%sets(i, c) = record%sets
      p%any_set(c) = ior(p%any_set(c), record%sets)
      if (.not. allocated(record%near)) return
      if (p%attached(c) == 0) call attach(p, c)
      p%near(i, :, p%attached(c)) = record%near
   end subroutine append_particle

   !> Whether a bin holds no particle of a body's contact group yet.
   pure function new_to_bin(p, bin, body) result(is_new)
      type(particles_t), intent(in) :: p   !! with contact groups
      integer, intent(in) :: bin           !! 64 (block - 1) + bin of the block
      integer, intent(in) :: body
      logical :: is_new
      integer :: c

      is_new = .false.
      c = p%head(1 + mod(bin - 1, bins_per_block), 1 + (bin - 1)/bins_per_block)
      do while (c > 0)
         if (p%group(p%body(c)) == p%group(body)) return
         c = p%next(c)
      end do
      is_new = .true.
   end function new_to_bin

   !> Copy a particle out of its lane.
   pure subroutine read_record(p, lane, chunk, record)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: lane, chunk
      type(record_t), intent(out) :: record

      record%hot = p%q(lane, :, chunk)
      record%x0 = p%x0(lane, :, chunk)
      record%id = p%id(lane, chunk)
      record%sets = p%sets(lane, chunk)
      record%body = p%body(chunk)
      if (p%attached(chunk) > 0) record%near = p%near(lane, :, p%attached(chunk))
   end subroutine read_record

   !> Take a particle out. The last of the bin's emptiest chunk fills its lane, so that a bin never
   !> holds more chunks than it must; an empty chunk becomes free.
   subroutine remove_lane(p, lattice, blocks, lane, chunk)
      type(particles_t), intent(inout) :: p
      type(lattice_t), intent(in) :: lattice
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: lane, chunk
      integer :: last, giver

      giver = emptiest_chunk(p, chunk)
      last = p%count(giver)
      if (giver /= chunk .or. last /= lane) then
         if (p%attached(giver) > 0 .and. p%attached(chunk) == 0) call attach(p, chunk)
         call copy_lane(p, last, giver, lane, chunk)
      end if
      call blank_lane(p, lattice, blocks, last, giver)
      p%count(giver) = last - 1
      if (last == 1) call release_chunk(p, giver)
   end subroutine remove_lane

   !> Of the chunks of one bin and body the one with the fewest particles, the last of several.
   pure function emptiest_chunk(p, chunk) result(found)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: chunk   !! one of them
      integer :: found, c

      found = chunk
      c = first_of_bin(p, p%bin(chunk))
      do while (c > 0)
         if (p%body(c) == p%body(chunk) .and. p%count(c) <= p%count(found)) found = c
         c = p%next(c)
      end do
   end function emptiest_chunk

   !> First chunk of a bin, 0 where it has none.
   pure function first_of_bin(p, bin) result(c)
      type(particles_t), intent(in) :: p
      integer, intent(in) :: bin   !! 64 (block - 1) + bin of the block
      integer :: c

      c = p%head(1 + mod(bin - 1, bins_per_block), 1 + (bin - 1)/bins_per_block)
   end function first_of_bin

   !> Move a particle to another bin of this rank.
   subroutine move_lane(p, lattice, blocks, lane, chunk, bin)
      type(particles_t), intent(inout) :: p
      type(lattice_t), intent(in) :: lattice
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: lane, chunk
      integer, intent(in) :: bin   !! 64 (block - 1) + bin of the block
      integer :: c, body

      body = p%body(chunk)   ! a copy, since storage may grow
      c = chunk_with_room(p, lattice, blocks, bin, body)
      p%count(c) = p%count(c) + 1
      if (p%attached(chunk) > 0 .and. p%attached(c) == 0) call attach(p, c)
      call copy_lane(p, lane, chunk, p%count(c), c)
      call remove_lane(p, lattice, blocks, lane, chunk)
   end subroutine move_lane

   subroutine copy_lane(p, lane, chunk, to_lane, to_chunk)
      type(particles_t), intent(inout) :: p
      integer, intent(in) :: lane, chunk, to_lane, to_chunk

      p%q(to_lane, :, to_chunk) = p%q(lane, :, chunk)
      p%x0(to_lane, :, to_chunk) = p%x0(lane, :, chunk)
      p%id(to_lane, to_chunk) = p%id(lane, chunk)
      p%sets(to_lane, to_chunk) = p%sets(lane, chunk)
      p%any_set(to_chunk) = ior(p%any_set(to_chunk), p%sets(lane, chunk))
      if (p%attached(to_chunk) == 0) return
      if (p%attached(chunk) > 0) then
         p%near(to_lane, :, p%attached(to_chunk)) = p%near(lane, :, p%attached(chunk))
      else
         p%near(to_lane, :, p%attached(to_chunk)) = 0
      end if
   end subroutine copy_lane

   subroutine blank_lane(p, lattice, blocks, lane, chunk)
      type(particles_t), intent(inout) :: p
      type(lattice_t), intent(in) :: lattice
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: lane, chunk

      p%q(lane, :, chunk) = 0
      p%q(lane, c_x:c_x + 2, chunk) = bin_corner(lattice, bin_of_chunk(p, blocks, chunk)) &
         + 0.5_wp*lattice%size
      p%x0(lane, :, chunk) = 0
      p%id(lane, chunk) = 0
      p%sets(lane, chunk) = 0
      if (p%attached(chunk) > 0) p%near(lane, :, p%attached(chunk)) = 0
   end subroutine blank_lane

   !> All lanes of a chunk empty.
   subroutine blank_chunk(p, lattice, blocks, chunk)
      type(particles_t), intent(inout) :: p
      type(lattice_t), intent(in) :: lattice
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: chunk
      real(wp) :: middle(3)
      integer :: i

      middle = bin_corner(lattice, bin_of_chunk(p, blocks, chunk)) + 0.5_wp*lattice%size
      p%q(:, :, chunk) = 0
      do i = 1, 3
         p%q(:, c_x + i - 1, chunk) = middle(i)
      end do
      p%x0(:, :, chunk) = 0
      p%id(:, chunk) = 0
      p%sets(:, chunk) = 0
   end subroutine blank_chunk

   !> A chunk of the bin with a free lane for the body; made if there is none.
   function chunk_with_room(p, lattice, blocks, bin, body) result(c)
      type(particles_t), intent(inout) :: p
      type(lattice_t), intent(in) :: lattice
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: bin, body
      integer :: c, last, b, k

      b = 1 + (bin - 1)/bins_per_block
      k = 1 + mod(bin - 1, bins_per_block)
      last = 0
      c = p%head(k, b)
      do while (c > 0)
         if (p%body(c) == body .and. p%count(c) < lanes) return
         last = c
         c = p%next(c)
      end do
      c = fresh_chunk(p)
      p%bin(c) = bin
      p%body(c) = body
      p%next(c) = 0
      call blank_chunk(p, lattice, blocks, c)
      if (last == 0) p%head(k, b) = c
      if (last > 0) p%next(last) = c
   end function chunk_with_room

   !> A chunk from the free chain, or a new one.
   function fresh_chunk(p) result(c)
      type(particles_t), intent(inout) :: p
      integer :: c

      c = p%free
      if (c > 0) then
         p%free = p%next(c)
      else
         if (p%n_chunks == size(p%count)) call grow(p)
         p%n_chunks = p%n_chunks + 1
         c = p%n_chunks
      end if
      p%count(c) = 0
      p%attached(c) = 0
      p%any_set(c) = 0
   end function fresh_chunk

   !> Take an empty chunk out of its bin's chain.
   subroutine release_chunk(p, chunk)
      type(particles_t), intent(inout) :: p
      integer, intent(in) :: chunk
      integer :: b, k, c

      b = 1 + (p%bin(chunk) - 1)/bins_per_block
      k = 1 + mod(p%bin(chunk) - 1, bins_per_block)
      if (p%head(k, b) == chunk) then
         p%head(k, b) = p%next(chunk)
      else
         c = p%head(k, b)
         do while (p%next(c) /= chunk)
            c = p%next(c)
         end do
         p%next(c) = p%next(chunk)
      end if
      if (p%attached(chunk) > 0) call detach(p, chunk)
      p%next(chunk) = p%free
      p%free = chunk
   end subroutine release_chunk

   !> Give a chunk a near record, all slots empty.
   subroutine attach(p, chunk)
      type(particles_t), intent(inout) :: p
      integer, intent(in) :: chunk
      real(wp), allocatable :: near(:, :, :)
      integer, allocatable :: chain(:)
      integer :: r, n

      r = p%free_attached
      if (r > 0) then
         p%free_attached = p%next_attached(r)
      else
         n = size(p%near, 3)
         if (p%n_attached == n) then
            allocate (near(lanes, size(p%near, 2), 2*n + 64), chain(2*n + 64))
            near(:, :, :n) = p%near
            chain(:n) = p%next_attached
            call move_alloc(near, p%near)
            call move_alloc(chain, p%next_attached)
         end if
         p%n_attached = p%n_attached + 1
         r = p%n_attached
      end if
      p%near(:, :, r) = 0
      p%attached(chunk) = r
   end subroutine attach

   subroutine detach(p, chunk)
      type(particles_t), intent(inout) :: p
      integer, intent(in) :: chunk

      p%next_attached(p%attached(chunk)) = p%free_attached
      p%free_attached = p%attached(chunk)
      p%attached(chunk) = 0
   end subroutine detach

   !> Make room for a quarter more chunks.
   subroutine grow(p)
      type(particles_t), intent(inout) :: p
      real(wp), allocatable :: q(:, :, :)
      integer(i8), allocatable :: id(:, :), bits(:)
      integer :: n, m

      n = size(p%count)
      m = n + n/4 + 64
      allocate (q(lanes, n_hot, m))
      q(:, :, :n) = p%q
      call move_alloc(q, p%q)
      allocate (q(lanes, 3, m))
      q(:, :, :n) = p%x0
      call move_alloc(q, p%x0)
      allocate (id(lanes, m))
      id(:, :n) = p%id
      call move_alloc(id, p%id)
      allocate (id(lanes, m))
      id(:, :n) = p%sets
      call move_alloc(id, p%sets)
      allocate (bits(m))
      bits(:n) = p%any_set
      call move_alloc(bits, p%any_set)
      call grow_list(p%count, m)
      call grow_list(p%body, m)
      call grow_list(p%bin, m)
      call grow_list(p%next, m)
      call grow_list(p%attached, m)
   end subroutine grow

   pure subroutine grow_list(list, m)
      integer, allocatable, intent(inout) :: list(:)
      integer, intent(in) :: m
      integer, allocatable :: longer(:)

      allocate (longer(m), source=0)
      longer(:size(list)) = list
      call move_alloc(longer, list)
   end subroutine grow_list

   !> Follow a new layout of the blocks; blocks that are gone must be empty.
   subroutine renumber_blocks(p, old_place, blocks)
      type(particles_t), intent(inout) :: p
      integer, intent(in) :: old_place(:, :)   !! (3,old blocks)
      type(blocks_t), intent(in) :: blocks     !! the new layout
      integer, allocatable :: head(:, :)
      integer :: b, k, c, new

      allocate (head(bins_per_block, blocks%n), source=0)
      do b = 1, size(old_place, 2)
         new = local_block(blocks, old_place(:, b))
         if (new == 0) cycle
         do k = 1, bins_per_block
            head(k, new) = p%head(k, b)
            c = p%head(k, b)
            do while (c > 0)
               p%bin(c) = bins_per_block*(new - 1) + k
               c = p%next(c)
            end do
         end do
      end do
      call move_alloc(head, p%head)
   end subroutine renumber_blocks

   !> All particles as records, in storage order; storage is left as it is.
   subroutine take_records(p, records)
      type(particles_t), intent(in) :: p
      type(record_t), allocatable, intent(out) :: records(:)
      integer :: c, i, n

      allocate (records(count_particles(p)))
      n = 0
      do c = 1, p%n_chunks
         do i = 1, p%count(c)
            n = n + 1
            call read_record(p, i, c, records(n))
         end do
      end do
   end subroutine take_records
end module xmpm_storage
