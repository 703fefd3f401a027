!> METIS divides blocks evenly, and the parts keep their names where they can.
program test_partition
   use xmpm_kinds, only: i8
   use xmpm_error, only: error_t
   use xmpm_text, only: to_text
   use xmpm_lattice, only: block_key
   use xmpm_partition, only: partition_blocks
   use testing, only: suite_t, check, check_no_error, finish
   implicit none
   integer, parameter :: width(3) = [10, 8, 6]
   integer(i8) :: keys(product(width))
   type(suite_t) :: suite
   integer :: a, b, c, n

   suite%name = 'partition'
   n = 0
   do c = -3, 2
      do b = -4, 3
         do a = -5, 4
            n = n + 1
            keys(n) = block_key([a, b, c])
         end do
      end do
   end do
   call test_balance(suite)
   call test_names(suite)
   call test_few(suite)
   call finish(suite)

contains

   !> Heaviest part over the mean.
   pure function imbalance(parts, weights, n_parts) result(ratio)
      integer, intent(in) :: parts(:), weights(:), n_parts
      real :: ratio
      integer :: i, load(0:n_parts - 1)

      load = 0
      do i = 1, size(parts)
         load(parts(i)) = load(parts(i)) + weights(i)
      end do
      ratio = real(maxval(load)*n_parts)/real(sum(load))
   end function imbalance

   !> The share that METIS is given is 1 %; a block more or less of 480 among 7 is 1.5 %.
   subroutine test_balance(suite)
      type(suite_t), intent(inout) :: suite
      type(error_t), allocatable :: error
      integer, allocatable :: parts(:), again(:)
      integer :: weights(size(keys)), previous(size(keys)), k, i
      integer, parameter :: counts(4) = [1, 2, 3, 7]

      previous = -1
      weights = [(400 + 100*mod(7*i, 3), i=1, size(keys))]
      do k = 1, size(counts)
         call partition_blocks(keys, weights, counts(k), previous, parts, error)
         call check_no_error(suite, 'blocks are divided', error)
         call check(suite, 'parts are numbered from 0', minval(parts) == 0 &
            .and. maxval(parts) == counts(k) - 1)
         call check(suite, to_text(counts(k))//' parts weigh the same within 5 %: ' &
            //to_text(nint(1000*(imbalance(parts, weights, counts(k)) - 1)))//' per mille', &
            imbalance(parts, weights, counts(k)) < 1.05)
         call check(suite, to_text(counts(k))//' parts have short cuts', &
            cuts(parts) <= 3*80*(counts(k) - 1))
         call partition_blocks(keys, weights, counts(k), previous, again, error)
         call check(suite, 'the same blocks are divided the same way again', all(again == parts))
      end do
   end subroutine test_balance

   !> Faces between blocks of different parts.
   pure function cuts(parts) result(total)
      integer, intent(in) :: parts(:)
      integer :: total, i, j, d
      integer :: step(3)

      step = [1, width(1), width(1)*width(2)]
      total = 0
      do i = 1, size(parts)
         do d = 1, 3
            j = mod((i - 1)/step(d), width(d))
            if (j == width(d) - 1) cycle
            if (parts(i) /= parts(i + step(d))) total = total + 1
         end do
      end do
   end function cuts

   !> Divided again with other names before, and after a small shift of the weights, nearly all
   !> blocks stay.
   subroutine test_names(suite)
      type(suite_t), intent(inout) :: suite
      type(error_t), allocatable :: error
      integer, allocatable :: parts(:), again(:)
      integer :: weights(size(keys)), previous(size(keys))

      weights = 500
      previous = -1
      call partition_blocks(keys, weights, 4, previous, parts, error)
      previous = mod(parts + 3, 4)
      call partition_blocks(keys, weights, 4, previous, again, error)
      call check(suite, 'parts keep the names that they had', all(again == previous))
   end subroutine test_names

   !> No more blocks than ranks: one each.
   subroutine test_few(suite)
      type(suite_t), intent(inout) :: suite
      type(error_t), allocatable :: error
      integer, allocatable :: parts(:)

      call partition_blocks(keys(:3), [5, 6, 7], 5, [-1, -1, -1], parts, error)
      call check_no_error(suite, 'three blocks are divided among five ranks', error)
      call check(suite, 'three blocks go to three ranks', all(parts == [0, 1, 2]))
      call partition_blocks(keys(:0), [integer ::], 3, [integer ::], parts, error)
      call check(suite, 'no blocks can be divided', size(parts) == 0 .and. .not. allocated(error))
      call partition_blocks(keys(:40), spread(0, 1, 40), 3, spread(-1, 1, 40), parts, error)
      call check_no_error(suite, 'blocks without particles are divided', error)
   end subroutine test_few
end program test_partition
