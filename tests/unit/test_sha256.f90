!> Tests of SHA-256 against the vectors of FIPS 180-4.
program test_sha256
   use xmpm_sha256, only: sha256
   use testing, only: suite_t, check, finish
   implicit none
   type(suite_t) :: suite
   character(len=:), allocatable :: text
   integer :: i

   suite%name = 'sha256'
   call check(suite, 'no text has the published digest', sha256('') == &
      'e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855')
   call check(suite, 'abc has the published digest', sha256('abc') == &
      'ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad')
   call check(suite, 'a text of 56 bytes, whose length needs a block of its own, has its digest', &
      sha256('abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq') == &
      '248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1')
   call check(suite, 'a text of 112 bytes has the published digest', &
      sha256('abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmn'// &
      'hijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmnopqrstnopqrstu') == &
      'cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1')
   text = repeat('a', 1000000)
   call check(suite, 'a million letters a have the published digest', sha256(text) == &
      'cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0')
   text = ''
   do i = 0, 255
      text = text//char(i)
   end do
   call check(suite, 'all byte values count', sha256(text) == &
      '40aff2e9d2d8922e47afd4648e6967497158785fbd1da870e7110266bf944880')
   call finish(suite)
end program test_sha256
