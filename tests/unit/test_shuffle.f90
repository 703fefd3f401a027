!> Transposition by riffles.
program test_shuffle
   use xmpm_kinds, only: wp
   use xmpm_shuffle, only: turn, turn_4
   use testing, only: suite_t, check, finish
   implicit none
   type(suite_t) :: suite
   real(wp) :: a(8, 8), b(8, 8), narrow(8, 4), wide(4, 8)
   integer :: i

   suite%name = 'shuffle'
   a = reshape(real([(i, i=1, 64)], wp), [8, 8])
   b = a
   call turn(b)
   call check(suite, 'an 8 x 8 array is transposed', all(abs(b - transpose(a)) <= 0))
   call turn(b)
   call check(suite, 'twice is as before', all(abs(b - a) <= 0))
   narrow = a(:, :4)
   call turn_4(narrow, wide)
   call check(suite, 'an 8 x 4 array is transposed', all(abs(wide - transpose(narrow)) <= 0))
   call finish(suite)
end program test_shuffle
