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
      real(wp), allocatable :: most(:), moment(:)
      real(wp) :: t(3), end(3), n(3)
      integer :: c, way, k

      if (all(front%closed)) return
      allocate (most(2*front%chain_count), source=-huge(1.0_wp))
      allocate (moment(6*front%chain_count), source=0.0_wp)
      do k = 0, 2*front%chain_count - 1
         if (front%closed(k/2 + 1)) cycle
         call end_of_chain(front, k/2 + 1, modulo(k, 2) + 1, end, t)
         moment(3*k + 1:3*k + 3) = moment_about(samples, end, ball*h)
      end do
      call sum_all(comm, moment)
      do c = 1, front%chain_count
         if (front%closed(c)) cycle
         do way = 1, 2
            call end_of_chain(front, c, way, end, t)
            k = 2*c - 2 + way
            n = wall_normal(moment(3*k - 2:3*k), t)
            points%wall(:, way, c) = n
            most(k) = furthest(samples, end, n, h)/dot_product(n, t)
         end do
      end do
      call max_all(comm, most)
      where (most < -3*h) most = 0
      points%beyond = reshape(min(most, h), [2, front%chain_count])
      call end_points(front, points)
   end subroutine find_ends

   !> First moment of the material around a point, without that of small balls within it.
   pure function moment_about(samples, x, radius) result(moment)
      type(sample_t), intent(in) :: samples(:)
      real(wp), intent(in) :: x(3), radius     !! [length]
      real(wp) :: moment(3), d(3), f
      integer :: i

      moment = 0
      do i = 1, size(samples)
         d = samples(i)%x - x
         f = 1 - sum(d*d)/radius**2
         if (f > 0) moment = moment + samples(i)%volume*f*f*d
      end do
   end function moment_about

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

   !> How far the material near a front goes on in a direction from its end.
   pure function furthest(samples, end, n, h) result(most)
      type(sample_t), intent(in) :: samples(:)
      real(wp), intent(in) :: end(3), n(3), h
      real(wp) :: most
      integer :: i

      most = -huge(1.0_wp)
      do i = 1, size(samples)
         if (samples(i)%r > 1.5_wp*h) cycle
         if (norm2(samples(i)%foot - end) > 3*h) cycle
         most = max(most, dot_product(samples(i)%x - end, n) &
            + 0.5_wp*samples(i)%volume**(1/3.0_wp))
      end do
   end function furthest

   !> First or last node of a chain and the direction out of it.
   pure subroutine end_of_chain(front, c, way, end, t)
      type(front_t), intent(in) :: front
      integer, intent(in) :: c, way
      real(wp), intent(out) :: end(3), t(3)
      integer :: node, inner

      node = front%chain_offset(c)
      inner = node + 1
      if (way == 2) then
         node = front%chain_offset(c + 1) - 1
         inner = node - 1
      end if
      end = front%x(:, node)
      t = unit_vector(end - front%x(:, inner))
   end subroutine end_of_chain
end module xmpm_front_ends
