!> Where the material ends along open fronts, and the direction in which its surface faces there.
module xmpm_front_ends
   use xmpm_kinds, only: wp
   use xmpm_communicator, only: comm_t, sum_all, max_all
   use xmpm_vectors, only: unit_vector
   use xmpm_front, only: front_t
   use xmpm_samples, only: sample_t
   use xmpm_front_points, only: front_points_t, end_points
   implicit none
   private

   public :: find_ends, wall_normal

   real(wp), parameter :: ball = 2.5_wp        !! radius of the ball whose material is looked at
                                               !! [cells]
   real(wp), parameter :: core = 1.5_wp        !! distance from the front of the material whose end
                                               !! is looked for [cells]
   real(wp), parameter :: along = 3.0_wp       !! the same along the front from its end [cells]
   real(wp), parameter :: around = 3.4_wp      !! holds the ball and the core [cells]
   real(wp), parameter :: straight = 0.9994_wp !! cosine (2 degrees) from which on a front counts
                                               !! as normal to the surface: what the particles
                                               !! tell is good to a fraction of that
   real(wp), parameter :: flattest = 0.3_wp    !! the same (73 degrees) below which the surface
                                               !! found is not believed

contains

   !> Find the ends of all open fronts and put their last points there. Collective.
   subroutine find_ends(front, comm, h, samples, points)
      type(front_t), intent(in) :: front
      type(comm_t), intent(in) :: comm
      real(wp), intent(in) :: h                           !! cell size [length]
      type(sample_t), intent(in) :: samples(:)
      type(front_points_t), intent(inout) :: points       !! ends are moved
      real(wp), allocatable :: end(:, :), t(:, :), n(:, :), moment(:, :), most(:)
      integer, allocatable :: chain(:), near(:)
      integer :: k

      chain = pack([(k, k=1, front%chain_count)], .not. front%closed)
      if (size(chain) == 0) return
      call list_ends(front, chain, end, t)
      near = samples_near(samples, end, around*h)
      moment = moments_about(samples, near, end, ball*h)
      call sum_all(comm, moment)
      allocate (n(3, size(end, 2)))
      do k = 1, size(end, 2)
         n(:, k) = wall_normal(moment(:, k), t(:, k))
      end do
      most = furthest(samples, near, end, n, h)/sum(n*t, dim=1)
      call max_all(comm, most)
      where (most < -3*h) most = 0
      points%wall(:, :, chain) = reshape(n, [3, 2, size(chain)])
      points%beyond(:, chain) = reshape(min(most, h), [2, size(chain)])
      call end_points(front, points)
   end subroutine find_ends

   !> First and last nodes of some chains and the directions out of them.
   pure subroutine list_ends(front, chain, end, t)
      type(front_t), intent(in) :: front
      integer, intent(in) :: chain(:)
      real(wp), allocatable, intent(out) :: end(:, :)   !! (3,2 chains) [length]
      real(wp), allocatable, intent(out) :: t(:, :)     !! (3,2 chains)
      integer :: k, first, last

      allocate (end(3, 2*size(chain)), t(3, 2*size(chain)))
      do k = 1, size(chain)
         first = front%chain_offset(chain(k))
         last = front%chain_offset(chain(k) + 1) - 1
         end(:, 2*k - 1) = front%x(:, first)
         t(:, 2*k - 1) = unit_vector(front%x(:, first) - front%x(:, first + 1))
         end(:, 2*k) = front%x(:, last)
         t(:, 2*k) = unit_vector(front%x(:, last) - front%x(:, last - 1))
      end do
   end subroutine list_ends

   !> Numbers of the samples within reach of any of some points of the front.
   pure function samples_near(samples, x, reach) result(near)
      type(sample_t), intent(in) :: samples(:)
      real(wp), intent(in) :: x(:, :), reach      !! (3,n) [length]
      integer, allocatable :: near(:)
      integer :: chosen(size(samples)), i, k, n

      n = 0
      do i = 1, size(samples)
         if (samples(i)%r > reach) cycle
         do k = 1, size(x, 2)
            if ((samples(i)%x(1) - x(1, k))**2 + (samples(i)%x(2) - x(2, k))**2 &
                + (samples(i)%x(3) - x(3, k))**2 > reach*reach) cycle
            n = n + 1
            chosen(n) = i
            exit
         end do
      end do
      near = chosen(:n)
   end function samples_near

   !> First moments of the material around some points, without that of small balls within it.
   pure function moments_about(samples, near, x, radius) result(moment)
      type(sample_t), intent(in) :: samples(:)
      integer, intent(in) :: near(:)              !! those to look at
      real(wp), intent(in) :: x(:, :), radius     !! (3,n), of the balls [length]
      real(wp) :: moment(3, size(x, 2)), d(3), f
      integer :: i, k

      moment = 0
      do i = 1, size(near)
         do k = 1, size(x, 2)
            d = samples(near(i))%x - x(:, k)
            f = 1 - (d(1)*d(1) + d(2)*d(2) + d(3)*d(3))/radius**2
            if (f > 0) moment(:, k) = moment(:, k) + samples(near(i))%volume*f*f*d
         end do
      end do
   end function moments_about

   !> Outward normal of the material's surface where a front ends: against the moment of the
   !> material there, or the direction of the front where they are nearly the same.
   pure function wall_normal(moment, t) result(n)
      real(wp), intent(in) :: moment(3)   !! [length^4]
      real(wp), intent(in) :: t(3)        !! unit vector, out of the front at its end
      real(wp) :: n(3), c

      n = t
      c = -dot_product(unit_vector(moment), t)
      if (c > flattest .and. c < straight) n = -unit_vector(moment)
   end function wall_normal

   !> How far the material near a front goes on in a direction from each of its ends.
   pure function furthest(samples, near, end, n, h) result(most)
      type(sample_t), intent(in) :: samples(:)
      integer, intent(in) :: near(:)                  !! those to look at
      real(wp), intent(in) :: end(:, :), n(:, :), h   !! (3,ends)
      real(wp) :: most(size(end, 2)), d(3)
      integer :: i, k

      most = -huge(1.0_wp)
      do i = 1, size(near)
         associate (s => samples(near(i)))
            if (s%r > core*h) cycle
            do k = 1, size(end, 2)
               d = s%foot - end(:, k)
               if (d(1)*d(1) + d(2)*d(2) + d(3)*d(3) > (along*h)**2) cycle
               most(k) = max(most(k), dot_product(s%x - end(:, k), n(:, k)) &
                  + 0.5_wp*s%volume**(1/3.0_wp))
            end do
         end associate
      end do
   end function furthest
end module xmpm_front_ends
