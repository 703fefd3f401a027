!> A growing crack: law and criterion, and the clock of its front nodes.
module xmpm_growth
   use xmpm_kinds, only: wp, pi
   use xmpm_text, only: string_t, to_text
   use xmpm_front, only: front_t
   use xmpm_crack, only: crack_t
   use xmpm_criterion, only: criterion_t
   use xmpm_speed_law, only: speed_law_t, tip_t
   use xmpm_front_line, only: front_limits_t
   use xmpm_grow_surface, only: grown_t
   use xmpm_twist_rows, only: rise_of_rows
   implicit none
   private

   public :: growth_t, region_t
   public :: start_growth, advance_fronts, is_due, growth_vectors, renew_growth, take_intensities
   public :: toughness_at

   real(wp), parameter :: sharp_turn = 10.0_wp*pi/180.0_wp   !! kink from which the surface is made
                                                             !! anew in shorter increments [rad]
   real(wp), parameter :: shortest_part = 0.25_wp            !! of an increment, at a sharp turn

   !> A box of its own toughness.
   type :: region_t
      real(wp) :: box(6) = 0.0_wp        !! lowest and highest corner [length]
      real(wp) :: toughness = 0.0_wp     !! K_IC [stress sqrt(length)]
   end type region_t

   !> How one crack grows, and how far its front nodes are.
   type :: growth_t
      integer :: crack = 0                            !! number of the crack
      class(criterion_t), allocatable :: criterion    !! direction and K*
      class(speed_law_t), allocatable :: law          !! speed
      logical :: needs_intensity = .true.             !! K must be found during the run
      real(wp) :: increment = 0.0_wp                  !! way between two re-meshings [length]
      real(wp) :: filter = 0.0_wp                     !! time over which K is averaged [time]
      real(wp) :: every = 0.0_wp                      !! between two evaluations of K [time]
      real(wp) :: start = 0.0_wp                      !! no growth before [time]
      type(front_limits_t) :: limits                  !! lengths of front segments
      real(wp), allocatable :: toughness_of(:)        !! (bodies) K_IC, 0 where not known
      type(region_t), allocatable :: regions(:)       !! boxes with their own; the last one wins
      real(wp) :: evaluated = -huge(1.0_wp)           !! when K was found last [time]
      real(wp), allocatable :: k(:, :)                !! (3,nn) modes I II III, averaged once
      real(wp), allocatable :: k_twice(:, :)          !! (3,nn) and that averaged again
      real(wp), allocatable :: rate(:)                !! (nn) energy release rate, as found last
      real(wp), allocatable :: width(:)               !! (nn) length of the front in the material
                                                      !! that goes with a node [length]
      real(wp), allocatable :: kink(:)                !! (nn) of the criterion [rad]
      real(wp), allocatable :: twist(:)               !! (nn) of the criterion [rad]
      real(wp), allocatable :: intensity(:)           !! (nn) K* of the criterion
      real(wp), allocatable :: toughness(:)           !! (nn) K_IC at the nodes
      real(wp), allocatable :: rayleigh(:)            !! (nn) wave speeds there [length/time]
      real(wp), allocatable :: dilatational(:)        !! (nn) [length/time]
      real(wp), allocatable :: speed(:)               !! (nn) in the last step [length/time]
      logical, allocatable :: outside(:)              !! (nn) node without material around
      logical, allocatable :: waits(:)                !! (nn) node that a crack holds
      real(wp), allocatable :: tried(:)               !! (nn) way at which triangles ahead of a node
                                                      !! would have been folded [length]
      real(wp) :: energy = 0.0_wp                     !! integral of G dA so far [energy]
      real(wp) :: area = 0.0_wp                       !! area gone so far [length**2]
      integer :: increments = 0                       !! re-meshings so far
      logical :: ended = .false.                      !! no front is left
      type(string_t), allocatable :: news(:)          !! what the log should hear
   end type growth_t

contains

   !> Nodes at rest, nothing known of them yet.
   subroutine start_growth(growth, crack)
      type(growth_t), intent(inout) :: growth
      type(crack_t), intent(inout) :: crack   !! gets its offsets
      integer :: n

      n = crack%front%node_count
      crack%offset = spread(0.0_wp, 1, n)
      allocate (growth%k(3, n), growth%k_twice(3, n), growth%rate(n), growth%kink(n), &
         growth%twist(n), growth%intensity(n), &
         growth%toughness(n), growth%rayleigh(n), growth%dilatational(n), growth%speed(n), &
         growth%tried(n), source=0.0_wp)
      allocate (growth%outside(n), growth%waits(n), source=.false.)
      growth%ended = crack%front%edge_count == 0
      if (.not. allocated(growth%news)) allocate (growth%news(0))
   end subroutine start_growth

   !> K_IC at a point of a body: of the last region that holds the point, else of the body.
   pure function toughness_at(growth, body, x) result(toughness)
      type(growth_t), intent(in) :: growth
      integer, intent(in) :: body      !! 0 for none
      real(wp), intent(in) :: x(3)     !! [length]
      real(wp) :: toughness            !! 0 where it is not known
      integer :: i

      toughness = 0.0_wp
      if (body > 0) toughness = growth%toughness_of(body)
      do i = 1, size(growth%regions)
         associate (box => growth%regions(i)%box)
            if (any(x < box(1:3)) .or. any(x > box(4:6))) cycle
            toughness = growth%regions(i)%toughness
         end associate
      end do
   end function toughness_at

   !> Take the intensities that were found at the nodes, averaged over the filter's time, and give
   !> them to the criterion.
   !>
   !> Twice the first-order average less the average of it: K that rises steadily does not lag. A
   !> node at rest takes K as it is, so that growth begins when K* reaches the toughness.
   subroutine take_intensities(growth, k, rate, time)
      type(growth_t), intent(inout) :: growth
      real(wp), intent(in) :: k(:, :)   !! (3,nn) modes I II III
      real(wp), intent(in) :: rate(:)   !! (nn) energy release rate
      real(wp), intent(in) :: time      !! [time]
      real(wp) :: part
      integer :: i

      part = 1.0_wp
      if (growth%filter > 0.0_wp .and. growth%evaluated > -huge(1.0_wp)) then
         part = 1.0_wp - exp(-(time - growth%evaluated)/growth%filter)
      end if
      growth%rate = rate
      growth%evaluated = time
      do i = 1, size(growth%kink)
         if (growth%speed(i) > 0.0_wp) then
            growth%k(:, i) = growth%k(:, i) + part*(k(:, i) - growth%k(:, i))
            growth%k_twice(:, i) = growth%k_twice(:, i) &
               + part*(growth%k(:, i) - growth%k_twice(:, i))
         else
            growth%k(:, i) = k(:, i)
            growth%k_twice(:, i) = k(:, i)
         end if
         call growth%criterion%judge(2*growth%k(:, i) - growth%k_twice(:, i), growth%kink(i), &
            growth%twist(i), growth%intensity(i))
      end do
   end subroutine take_intensities

   !> Let every front node go the way of one step; nodes outside go with their neighbours.
   subroutine advance_fronts(growth, crack, time, dt)
      type(growth_t), intent(inout) :: growth
      type(crack_t), intent(inout) :: crack   !! offsets grow
      real(wp), intent(in) :: time            !! at the start of the step [time]
      real(wp), intent(in) :: dt              !! [time]
      real(wp) :: way(size(growth%speed))
      integer :: i

      way = 0.0_wp
      do i = 1, size(way)
         if (growth%outside(i) .or. growth%waits(i)) cycle
         if (growth%law%needs_toughness .and. .not. growth%toughness(i) > 0.0_wp) cycle
         way(i) = growth%law%advance(tip_t(growth%intensity(i), growth%toughness(i), &
            growth%rayleigh(i), growth%dilatational(i), growth%speed(i), time, dt))
      end do
      if (time + dt <= growth%start) way = 0.0_wp
      call follow_inside(growth, crack%front, way)
      growth%speed = way/dt
      crack%offset = crack%offset + way
      call note_energy(growth, crack%front, way)
   end subroutine advance_fronts

   !> Nodes outside take way, kink and twist of the nearest node of their chain that is inside.
   subroutine follow_inside(growth, front, way)
      type(growth_t), intent(inout) :: growth
      type(front_t), intent(in) :: front
      real(wp), intent(inout) :: way(:)
      integer :: c, i, k, first, last, n, other

      do c = 1, front%chain_count
         first = front%chain_offset(c)
         last = front%chain_offset(c + 1) - 1
         n = last - first + 1
         do i = first, last
            if (.not. growth%outside(i)) cycle
            other = 0
            do k = 1, n - 1
               other = i + k
               if (front%closed(c) .and. other > last) other = other - n
               if (other <= last) then
                  if (.not. growth%outside(other)) exit
               end if
               other = i - k
               if (front%closed(c) .and. other < first) other = other + n
               if (other >= first) then
                  if (.not. growth%outside(other)) exit
               end if
               other = 0
            end do
            if (other == 0) cycle
            way(i) = way(other)
            growth%kink(i) = growth%kink(other)
            growth%twist(i) = growth%twist(other)
         end do
      end do
   end subroutine follow_inside

   !> Add G dA of a step: the way of each node over half of both its segments, of what lies in the
   !> material where that is known.
   subroutine note_energy(growth, front, way)
      type(growth_t), intent(inout) :: growth
      type(front_t), intent(in) :: front
      real(wp), intent(in) :: way(:)
      real(wp) :: half
      integer :: e, i

      if (allocated(growth%width)) then
         growth%area = growth%area + sum(growth%width*way)
         growth%energy = growth%energy + sum(growth%rate*growth%width*way)
         return
      end if
      do e = 1, front%edge_count
         associate (node => front%edge_node(:, e))
            half = 0.5_wp*norm2(front%x(:, node(2)) - front%x(:, node(1)))
            do i = 1, 2
               if (growth%outside(node(i))) cycle
               growth%area = growth%area + half*way(node(i))
               growth%energy = growth%energy + growth%rate(node(i))*half*way(node(i))
            end do
         end associate
      end do
   end subroutine note_energy

   !> Whether a node has gone an increment, or at a sharp turn a part of one, also since its
   !> triangles were tried in vain.
   pure function is_due(growth, crack) result(due)
      type(growth_t), intent(in) :: growth
      type(crack_t), intent(in) :: crack
      logical :: due
      real(wp) :: part
      integer :: i

      due = .false.
      do i = 1, size(crack%offset)
         if (growth%outside(i) .or. growth%waits(i)) cycle
         part = max(shortest_part, min(1.0_wp, sharp_turn/max(abs(growth%kink(i)), sharp_turn)))
         ! A step may end short of the increment by rounding.
         due = due .or. crack%offset(i) - growth%tried(i) >= part*growth%increment &
            *(1.0_wp - 1.0e-9_wp)
      end do
   end function is_due

   !> Way of each node since the last re-meshing, in its direction, with the rise of the row by the
   !> criterion's twist.
   pure function growth_vectors(growth, crack) result(advance)
      type(growth_t), intent(in) :: growth
      type(crack_t), intent(in) :: crack
      real(wp) :: advance(3, size(crack%offset)), rise(size(crack%offset)), c, s
      integer :: i

      rise = rise_of_rows(crack%front, crack%offset, growth%twist, growth%outside)
      do i = 1, size(crack%offset)
         c = cos(growth%kink(i))
         s = sin(growth%kink(i))
         advance(:, i) = (crack%offset(i)*c - rise(i)*s)*crack%front%e1(:, i) &
            + (crack%offset(i)*s + rise(i)*c)*crack%front%e2(:, i)
      end do
   end function growth_vectors

   !> Carry the state over to the nodes of the grown front. A node that went starts at the new
   !> mesh front, one that stayed keeps its offset; kinks are used up.
   subroutine renew_growth(growth, grown, old, offset)
      type(growth_t), intent(inout) :: growth
      type(grown_t), intent(in) :: grown                   !! new surface and front
      real(wp), intent(in) :: old(:)                       !! (old nn) offsets before
      real(wp), allocatable, intent(out) :: offset(:)      !! (nn) offsets now [length]
      type(growth_t) :: before
      real(wp) :: f
      integer :: i, n, a, b, v
      logical :: stayed

      before = growth
      n = grown%front%node_count
      if (allocated(growth%width)) deallocate (growth%width)
      deallocate (growth%k, growth%k_twice, growth%rate, growth%kink, growth%twist, &
         growth%intensity, &
         growth%toughness, &
         growth%rayleigh, growth%dilatational, growth%speed, growth%tried, growth%outside, &
         growth%waits)
      allocate (growth%k(3, n), growth%k_twice(3, n), growth%rate(n), growth%kink(n), &
         growth%twist(n), growth%intensity(n), &
         growth%toughness(n), growth%rayleigh(n), growth%dilatational(n), growth%speed(n), &
         growth%tried(n), offset(n), source=0.0_wp)
      allocate (growth%outside(n), growth%waits(n), source=.false.)
      do i = 1, n
         v = grown%front%vertex(i)
         a = grown%parent(1, v)
         b = grown%parent(2, v)
         if (a == 0) cycle
         f = grown%share(v)
         stayed = v <= grown%old_vertices
         growth%k(:, i) = (1 - f)*before%k(:, a) + f*before%k(:, b)
         growth%k_twice(:, i) = (1 - f)*before%k_twice(:, a) + f*before%k_twice(:, b)
         growth%rate(i) = (1 - f)*before%rate(a) + f*before%rate(b)
         growth%intensity(i) = (1 - f)*before%intensity(a) + f*before%intensity(b)
         growth%speed(i) = (1 - f)*before%speed(a) + f*before%speed(b)
         growth%rayleigh(i) = (1 - f)*before%rayleigh(a) + f*before%rayleigh(b)
         growth%dilatational(i) = (1 - f)*before%dilatational(a) + f*before%dilatational(b)
         if (.not. stayed) cycle
         offset(i) = old(a)
         growth%kink(i) = before%kink(a)
         growth%twist(i) = before%twist(a)
         growth%tried(i) = merge(old(a), before%tried(a), grown%held(a))
         growth%waits(i) = before%waits(a) .or. grown%met(a)
      end do
      growth%increments = growth%increments + 1
      growth%ended = grown%front%edge_count == 0
   end subroutine renew_growth
end module xmpm_growth
