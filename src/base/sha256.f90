!> SHA-256 of a text (FIPS 180-4), to name the deck that a result came from.
module xmpm_sha256
   use xmpm_kinds, only: i8
   implicit none
   private

   public :: sha256

   integer(i8), parameter :: mask = int(z'FFFFFFFF', i8)

   !> First 32 bits of the fractions of the cube roots of the first 64 primes.
   integer(i8), parameter :: cube_roots(64) = [ &
      int(z'428a2f98', i8), int(z'71374491', i8), int(z'b5c0fbcf', i8), int(z'e9b5dba5', i8), &
      int(z'3956c25b', i8), int(z'59f111f1', i8), int(z'923f82a4', i8), int(z'ab1c5ed5', i8), &
      int(z'd807aa98', i8), int(z'12835b01', i8), int(z'243185be', i8), int(z'550c7dc3', i8), &
      int(z'72be5d74', i8), int(z'80deb1fe', i8), int(z'9bdc06a7', i8), int(z'c19bf174', i8), &
      int(z'e49b69c1', i8), int(z'efbe4786', i8), int(z'0fc19dc6', i8), int(z'240ca1cc', i8), &
      int(z'2de92c6f', i8), int(z'4a7484aa', i8), int(z'5cb0a9dc', i8), int(z'76f988da', i8), &
      int(z'983e5152', i8), int(z'a831c66d', i8), int(z'b00327c8', i8), int(z'bf597fc7', i8), &
      int(z'c6e00bf3', i8), int(z'd5a79147', i8), int(z'06ca6351', i8), int(z'14292967', i8), &
      int(z'27b70a85', i8), int(z'2e1b2138', i8), int(z'4d2c6dfc', i8), int(z'53380d13', i8), &
      int(z'650a7354', i8), int(z'766a0abb', i8), int(z'81c2c92e', i8), int(z'92722c85', i8), &
      int(z'a2bfe8a1', i8), int(z'a81a664b', i8), int(z'c24b8b70', i8), int(z'c76c51a3', i8), &
      int(z'd192e819', i8), int(z'd6990624', i8), int(z'f40e3585', i8), int(z'106aa070', i8), &
      int(z'19a4c116', i8), int(z'1e376c08', i8), int(z'2748774c', i8), int(z'34b0bcb5', i8), &
      int(z'391c0cb3', i8), int(z'4ed8aa4a', i8), int(z'5b9cca4f', i8), int(z'682e6ff3', i8), &
      int(z'748f82ee', i8), int(z'78a5636f', i8), int(z'84c87814', i8), int(z'8cc70208', i8), &
      int(z'90befffa', i8), int(z'a4506ceb', i8), int(z'bef9a3f7', i8), int(z'c67178f2', i8)]

   !> First 32 bits of the fractions of the square roots of the first 8 primes.
   integer(i8), parameter :: square_roots(8) = [ &
      int(z'6a09e667', i8), int(z'bb67ae85', i8), int(z'3c6ef372', i8), int(z'a54ff53a', i8), &
      int(z'510e527f', i8), int(z'9b05688c', i8), int(z'1f83d9ab', i8), int(z'5be0cd19', i8)]

contains

   !> The digest of a text's bytes as 64 hexadecimal digits.
   pure function sha256(text) result(digest)
      character(len=*), intent(in) :: text   !! any bytes, also none
      character(len=64) :: digest            !! lower case
      integer(i8) :: state(8)
      character(len=64) :: block
      character(len=128) :: tail
      integer :: i, whole, last

      state = square_roots
      whole = len(text)/64
      do i = 1, whole
         block = text(64*i - 63:64*i)
         call absorb(state, block)
      end do
      call pad(text(64*whole + 1:), int(len(text), i8), tail, last)
      do i = 1, last
         block = tail(64*i - 63:64*i)
         call absorb(state, block)
      end do
      do i = 1, 8
         write (digest(8*i - 7:8*i), '(z8.8)') state(i)
      end do
      digest = lower_hexadecimal(digest)
   end function sha256

   !> Close the message: a one bit, zeros, and its length in bits, to a whole number of blocks.
   pure subroutine pad(rest, length, tail, blocks)
      character(len=*), intent(in) :: rest     !! last bytes of the message, fewer than 64
      integer(i8), intent(in) :: length        !! of the whole message [bytes]
      character(len=128), intent(out) :: tail  !! closing blocks
      integer, intent(out) :: blocks           !! 1 or 2 of 64 bytes
      integer :: i

      blocks = merge(1, 2, len(rest) < 56)
      tail = repeat(achar(0), 128)
      tail(1:len(rest)) = rest
      tail(len(rest) + 1:len(rest) + 1) = char(128)
      do i = 0, 7
         tail(64*blocks - i:64*blocks - i) = char(int(iand(ishft(8*length, -8*i), 255_i8)))
      end do
   end subroutine pad

   !> Work one block of 64 bytes into the state.
   pure subroutine absorb(state, block)
      integer(i8), intent(inout) :: state(8)   !! 32 bits each
      character(len=64), intent(in) :: block
      integer(i8) :: w(64), s(8), t1, t2
      integer :: i

      w = schedule(block)
      s = state
      do i = 1, 64
         t1 = s(8) + ieor(ieor(turn(s(5), 6), turn(s(5), 11)), turn(s(5), 25)) &
            + ieor(iand(s(5), s(6)), iand(ieor(s(5), mask), s(7))) + cube_roots(i) + w(i)
         t2 = ieor(ieor(turn(s(1), 2), turn(s(1), 13)), turn(s(1), 22)) &
            + ieor(ieor(iand(s(1), s(2)), iand(s(1), s(3))), iand(s(2), s(3)))
         s(2:8) = s(1:7)
         s(5) = iand(s(5) + t1, mask)
         s(1) = iand(t1 + t2, mask)
      end do
      state = iand(state + s, mask)
   end subroutine absorb

   !> The 64 words that a block of 16 words is stretched to.
   pure function schedule(block) result(w)
      character(len=64), intent(in) :: block
      integer(i8) :: w(64), low, high
      integer :: i, j

      do i = 1, 16
         w(i) = 0
         do j = 4*i - 3, 4*i
            w(i) = ior(ishft(w(i), 8), int(ichar(block(j:j)), i8))
         end do
      end do
      do i = 17, 64
         low = ieor(ieor(turn(w(i - 15), 7), turn(w(i - 15), 18)), ishft(w(i - 15), -3))
         high = ieor(ieor(turn(w(i - 2), 17), turn(w(i - 2), 19)), ishft(w(i - 2), -10))
         w(i) = iand(w(i - 16) + low + w(i - 7) + high, mask)
      end do
   end function schedule

   !> Rotate 32 bits to the right.
   elemental function turn(word, places) result(turned)
      integer(i8), intent(in) :: word
      integer, intent(in) :: places
      integer(i8) :: turned

      turned = iand(ior(ishft(word, -places), ishft(word, 32 - places)), mask)
   end function turn

   pure function lower_hexadecimal(text) result(low)
      character(len=*), intent(in) :: text
      character(len=len(text)) :: low
      integer :: i, place

      low = text
      do i = 1, len(text)
         place = index('ABCDEF', text(i:i))
         if (place > 0) low(i:i) = 'abcdef' (place:place)
      end do
   end function lower_hexadecimal
end module xmpm_sha256
