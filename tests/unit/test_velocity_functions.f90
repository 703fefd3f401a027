!> The velocity functions A_M(C), the Rayleigh speed, and the way from K to G and back.
program test_velocity_functions
   use xmpm_kinds, only: wp
   use xmpm_velocity_functions, only: elastic_constants_t, elastic_constants, velocity_functions, &
      release_rate, split_rate, fastest_front
   use exact_errors, only: plain, worst_velocity_function
   use testing, only: suite_t, check, check_close, finish
   implicit none
   integer, parameter :: quad = selected_real_kind(30)
   real(wp), parameter :: mu = 3.0_wp, density = 1.7_wp
   real(wp), parameter :: poissons(4) = [0.0_wp, 0.2_wp, 0.298_wp, 0.45_wp]
   type(suite_t) :: suite

   suite%name = 'velocity_functions'
   call agrees_with_many_digits()
   call rests()
   call is_limited()
   call rayleigh()
   call goes_round()
   call finish(suite)

contains

   !> Equation 51 as it stands, with twice the digits, from almost at rest to the fastest front.
   subroutine agrees_with_many_digits()
      ! the aim; the cubic loses one digit near the Rayleigh speed
      call check_close(suite, 'A_M at all speeds', worst_velocity_function(), 0.0_wp, 1e-12_wp, &
         0.0_wp)
   end subroutine agrees_with_many_digits

   pure function lambda_of(poisson) result(lambda)
      real(wp), intent(in) :: poisson
      real(wp) :: lambda

      lambda = 2*mu*poisson/(1 - 2*poisson)
   end function lambda_of

   !> 1 - nu, 1 - nu and 1, at rest and where equation 51 in double precision has no digit left.
   subroutine rests()
      type(elastic_constants_t) :: e
      real(wp) :: limits(3)
      integer :: i

      do i = 1, size(poissons)
         e = elastic_constants(lambda_of(poissons(i)), mu, density)
         limits = [1 - poissons(i), 1 - poissons(i), 1.0_wp]
         ! rounding
         call check_three('A_M at rest', velocity_functions(e, 0.0_wp), limits)
         call check_three('A_M almost at rest', velocity_functions(e, 1e-8_wp*e%shear), limits)
      end do
   end subroutine rests

   !> Past the fastest front nothing changes, so that G stays finite.
   subroutine is_limited()
      type(elastic_constants_t) :: e
      real(wp) :: most(3)

      e = elastic_constants(lambda_of(0.3_wp), mu, density)
      most = velocity_functions(e, fastest_front*e%rayleigh)
      call check(suite, 'A_I grows towards the Rayleigh speed', &
         most(1) > 1.5_wp*maxval(velocity_functions(e, 0.9_wp*e%rayleigh)))
      call check_three('A_M above the fastest front', velocity_functions(e, 2*e%shear), most)
   end subroutine is_limited

   !> D of equation 51 is 0 there; at nu = 1/4 the cubic has the root 2 - 2/sqrt(3).
   subroutine rayleigh()
      type(elastic_constants_t) :: e
      real(wp) :: lambda
      real(quad) :: below(3), above(3)
      integer :: i

      do i = 1, size(poissons)
         lambda = lambda_of(poissons(i))
         e = elastic_constants(lambda, mu, density)
         ! a hundred times the rounding of a speed
         below = plain(lambda, mu, density, e%rayleigh*(1 - 1e-14_wp))
         above = plain(lambda, mu, density, e%rayleigh*(1 + 1e-14_wp))
         call check(suite, 'A_I has its pole at the Rayleigh speed', &
            below(1) > 0 .and. above(1) < 0)
      end do
      e = elastic_constants(mu, mu, density)
      call check_close(suite, 'Rayleigh speed at nu = 1/4', e%rayleigh/e%shear, &
         sqrt(2 - 2/sqrt(3.0_wp)), 1e-14_wp, 0.0_wp)
      call check_close(suite, 'dilatational speed at nu = 1/4', e%dilatation/e%shear, &
         sqrt(3.0_wp), 1e-14_wp, 0.0_wp)
   end subroutine rayleigh

   !> K to G to K with the openings that belong to K, whatever their common factor.
   subroutine goes_round()
      type(elastic_constants_t) :: e
      real(wp), parameter :: k(3) = [30.0_wp, -12.0_wp, 7.0_wp]
      real(wp) :: a(3), g
      integer :: i

      e = elastic_constants(lambda_of(0.3_wp), mu, density)
      do i = 0, 3
         a = velocity_functions(e, 0.3_wp*real(i, wp)*e%rayleigh)
         g = release_rate(e, a, k)
         ! rounding
         call check_three('K from G and openings', split_rate(e, a, g, 1e-3_wp*a*k), k)
      end do
      a = velocity_functions(e, 0.0_wp)
      ! (1 - nu**2)/E with E = 2 (1 + nu) mu
      call check_close(suite, 'G at rest', release_rate(e, a, [2.0_wp, 1.0_wp, 0.0_wp]), &
         (1 - 0.3_wp)/(2*mu)*5, 1e-14_wp, 0.0_wp)
      call check_three('no G, no K', split_rate(e, a, -1.0_wp, k), 0*k)
      call check_three('no opening, no K', split_rate(e, a, 1.0_wp, 0*k), 0*k)
   end subroutine goes_round

   !> Three values, each to rounding.
   subroutine check_three(sentence, value, expected)
      character(len=*), intent(in) :: sentence
      real(wp), intent(in) :: value(3), expected(3)
      integer :: i

      do i = 1, 3
         call check_close(suite, sentence, value(i), expected(i), 0.0_wp, 1e-14_wp)
      end do
   end subroutine check_three
end program test_velocity_functions
