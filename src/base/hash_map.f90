!> A map from 64-bit keys to integers, by open addressing.
module xmpm_hash_map
   use xmpm_kinds, only: i8
   implicit none
   private

   public :: hash_map_t, clear_map, set_value, value_of

   integer(i8), parameter :: empty = -huge(1_i8)

   !> Keys and their values; `count` of the places are taken.
   type :: hash_map_t
      integer :: count = 0                       !! number of keys
      integer(i8), allocatable :: keys(:)        !! (0:capacity-1), `empty` where free
      integer, allocatable :: values(:)          !! (0:capacity-1)
   end type hash_map_t

contains

   !> Forget all keys and make room for `expected` of them.
   subroutine clear_map(map, expected)
      type(hash_map_t), intent(inout) :: map   !! emptied
      integer, intent(in) :: expected          !! number of keys to make room for
      integer :: capacity

      capacity = 16
      do while (capacity < 2*expected)
         capacity = 2*capacity
      end do
      if (allocated(map%keys)) deallocate (map%keys, map%values)
      allocate (map%keys(0:capacity - 1), source=empty)
      allocate (map%values(0:capacity - 1), source=0)
      map%count = 0
   end subroutine clear_map

   !> Give a key its value, new or not.
   subroutine set_value(map, key, value)
      type(hash_map_t), intent(inout) :: map   !! changed
      integer(i8), intent(in) :: key           !! any but -huge
      integer, intent(in) :: value             !! stored with the key
      integer :: place

      if (.not. allocated(map%keys)) call clear_map(map, 8)
      if (2*(map%count + 1) > size(map%keys)) call grow(map)
      place = place_of(map, key)
      if (map%keys(place) == empty) map%count = map%count + 1
      map%keys(place) = key
      map%values(place) = value
   end subroutine set_value

   !> The value of a key, or `missing` where the key is not known.
   pure function value_of(map, key, missing) result(value)
      type(hash_map_t), intent(in) :: map   !! searched
      integer(i8), intent(in) :: key        !! looked up
      integer, intent(in) :: missing        !! answer for an unknown key
      integer :: value, place

      value = missing
      if (map%count == 0) return
      place = place_of(map, key)
      if (map%keys(place) == key) value = map%values(place)
   end function value_of

   subroutine grow(map)
      type(hash_map_t), intent(inout) :: map
      integer(i8), allocatable :: keys(:)
      integer, allocatable :: values(:)
      integer :: i, place

      call move_alloc(map%keys, keys)
      call move_alloc(map%values, values)
      call clear_map(map, size(keys))
      do i = 0, size(keys) - 1
         if (keys(i) == empty) cycle
         place = place_of(map, keys(i))
         map%keys(place) = keys(i)
         map%values(place) = values(i)
         map%count = map%count + 1
      end do
   end subroutine grow

   !> Where a key stands, or the free place where it would stand.
   pure function place_of(map, key) result(place)
      type(hash_map_t), intent(in) :: map
      integer(i8), intent(in) :: key
      integer :: place, mask
      integer(i8) :: h

      mask = size(map%keys) - 1
      h = iand(ieor(key, ishft(key, -21)), 2_i8**40 - 1)   ! so that the product fits
      h = ieor(h*3935559_i8, ishft(key, -38))
      h = iand(ieor(h, ishft(h, -31)), int(mask, i8))
      place = int(h)
      do while (map%keys(place) /= empty .and. map%keys(place) /= key)
         place = iand(place + 1, mask)
      end do
   end function place_of
end module xmpm_hash_map
