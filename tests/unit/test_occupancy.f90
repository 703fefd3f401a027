!> Where material is: points between two bins are decided by the bins, never by rounding.
program test_occupancy
   use xmpm_kinds, only: wp
   use xmpm_lattice, only: make_lattice, linear_shape, gimp_shape, bin_corner, block_key
   use xmpm_hash_map, only: clear_map, set_value
   use xmpm_occupancy, only: occupancy_t, body_at
   use testing, only: suite_t, check, finish
   implicit none
   type(suite_t) :: suite

   suite%name = 'occupancy'
   call faces_belong_to_their_body(linear_shape)
   call faces_belong_to_their_body(gimp_shape)
   call finish(suite)

contains

   !> One bin of material; all points of its six faces are in it, whichever way they are rounded.
   subroutine faces_belong_to_their_body(shape)
      integer, intent(in) :: shape
      real(wp), parameter :: h = 0.3_wp
      type(occupancy_t) :: occupancy
      integer, parameter :: bin(3) = [3, -2, 7]
      real(wp) :: middle(3), way(3)
      integer :: side, d

      occupancy%lattice = make_lattice(h, [0.1_wp, -0.7_wp, 0.2_wp], shape)
      call clear_map(occupancy%body, 1)
      call set_value(occupancy%body, block_key(bin), 5)
      middle = bin_corner(occupancy%lattice, bin) + 0.5_wp*h
      call check(suite, 'The middle of a bin is in its body', body_at(occupancy, middle) == 5)
      do d = 1, 3
         do side = -1, 1, 2
            way = 0
            way(d) = 0.5_wp*real(side, wp)*h
            ! 1e-9 of a cell is far above rounding (1e-15) and far below the tie of 1e-6.
            call check(suite, 'A point just inside a face is in the body', &
               body_at(occupancy, middle + (1 - 1e-9_wp)*way) == 5)
            call check(suite, 'A point just outside a face is in the body', &
               body_at(occupancy, middle + (1 + 1e-9_wp)*way) == 5)
            call check(suite, 'A point clearly outside is not', &
               body_at(occupancy, middle + (1 + 1e-4_wp)*way) == 0)
         end do
      end do
   end subroutine faces_belong_to_their_body
end program test_occupancy
