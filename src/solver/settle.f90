!> The end of a step: particles go to their bins and ranks, the ranks agree on the next step, and
!> what the motion changed (blocks, split nodes, level sets, balance of work) is made right.
module xmpm_settle
   use xmpm_kinds, only: wp, i8
   use xmpm_text, only: to_text
   use xmpm_error, only: error_t, raise, code_numerics
   use xmpm_communicator, only: max_all, sum_all, agree_on_error
   use xmpm_stage_clock, only: start_stage, stop_stage, stage_sort, stage_migration, stage_crack
   use xmpm_storage, only: count_particles, c_v, c_m, c_vol
   use xmpm_resort, only: resort_chunks
   use xmpm_migration, only: rebin, exchange
   use xmpm_lattice, only: gimp_shape
   use xmpm_sharing, only: mark_mine
   use xmpm_boundary, only: find_rows
   use xmpm_crack, only: gather_crack, has_drifted, find_near, rule_graded
   use xmpm_grow_cracks, only: grow_cracks
   use xmpm_split, only: split_nodes, split_t
   use xmpm_contact_pairs, only: list_pairs
   use xmpm_rigid, only: list_rigid_rows
   use xmpm_ledger, only: note_energies
   use xmpm_layout, only: admit_blocks, repartition, count_unknown
   use xmpm_model, only: model_t
   implicit none
   private

   public :: settle, renew_splits, renew_level_sets, choose_step, count_all, find_wave_speed, &
      find_fastest

   integer(i8), parameter :: wave_interval = 20     !! steps between looks at the wave speed
   integer(i8), parameter :: crack_interval = 20    !! steps between looks at the cracks' drift
   integer(i8), parameter :: balance_interval = 50  !! steps between repartitions, at least
   real(wp), parameter :: resort_share = 0.5_wp     !! moved particles after which chunks are sorted

contains

   !> Finish a step. Collective.
   subroutine settle(m, error)
      type(model_t), intent(inout) :: m
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: worst(8)
      logical :: near_moved, shared_anew
      integer :: lost

      call note_energies(m)
      m%time = m%time + m%dt
      m%step = m%step + 1
      m%dt_before = m%dt
      call start_stage(m%clock, stage_sort)
      near_moved = .false.
      m%moved = m%moved + int(m%n_movers, i8)
      call rebin(m%particles, m%grid, m%movers(:m%n_movers), m%outbox, near_moved)
      call stop_stage(m%clock, stage_sort)
      worst = [m%tally%speed2, -m%tally%volume, real(count_particles(m%particles), wp), &
         real(m%outbox%n, wp), real(count_unknown(m), wp), merge(1.0_wp, 0.0_wp, near_moved), &
         merge(0.0_wp, 1.0_wp, m%tally%kinetic < huge(1.0_wp) .and. m%tally%work < huge(1.0_wp)), &
         merge(1.0_wp, 0.0_wp, any(m%cracks%stale))]
      call max_all(m%comm, worst)
      call check_health(m, worst, error)
      if (allocated(error)) return
      m%speed = sqrt(worst(1))
      m%imbalance = worst(3)*real(m%comm%size, wp)/real(max(1_i8, m%n_particles), wp)
      call start_stage(m%clock, stage_migration)
      if (worst(5) > 0) call admit_blocks(m)
      if (worst(4) > 0) then
         call exchange(m%particles, m%grid, m%comm, m%sharing%ranks, m%outbox, lost)
         if (lost > 0) call raise(error, code_numerics, lost_message(m, lost))
         call agree_on_error(m%comm, error)
      end if
      call stop_stage(m%clock, stage_migration)
      if (allocated(error)) return
      call keep_balance(m, shared_anew, error)
      if (allocated(error)) return
      m%split_again = m%split_again .or. worst(6) > 0 .or. (worst(4) > 0 &
         .and. (size(m%cracks) > 0 .or. m%bodies_meet))
      call grow_cracks(m, error)
      if (allocated(error)) return
      call keep_cracks(m, worst(8) > 0 .or. worst(5) > 0 .or. shared_anew, error)
      if (mod(m%step, wave_interval) == 0) call find_wave_speed(m)
   end subroutine settle

   !> Look for what must never be: NaN, a negative volume.
   subroutine check_health(m, worst, error)
      type(model_t), intent(in) :: m
      real(wp), intent(in) :: worst(8)
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: where_is

      if (.not. worst(7) > 0.5_wp .and. worst(2) < 0) return
      where_is = first_unsound(m)
      if (len(where_is) > 0) call raise(error, code_numerics, when_it_is(m)// &
         ': a particle has a volume that is not positive, or a value that is not a number'// &
         where_is)
      call agree_on_error(m%comm, error)
      if (allocated(error)) return
      call raise(error, code_numerics, when_it_is(m)//': the energies are not numbers'//fastest(m))
      call agree_on_error(m%comm, error)
   end subroutine check_health

   !> Name the first particle that is unsound, in the chunks or on its way out; '' where none is.
   pure function first_unsound(m) result(text)
      type(model_t), intent(in) :: m
      character(len=:), allocatable :: text
      integer :: c, i

      text = ''
      do c = 1, m%particles%n_chunks
         do i = 1, m%particles%count(c)
            text = unsound(m%particles%id(i, c), m%particles%q(i, :, c))
            if (len(text) > 0) return
         end do
      end do
      do i = 1, m%outbox%n
         text = unsound(m%outbox%records(i)%id, m%outbox%records(i)%hot)
         if (len(text) > 0) return
      end do
   end function first_unsound

   !> Name the fastest particle of this rank, also of those on their way out; '' where it has none.
   pure function fastest(m) result(text)
      type(model_t), intent(in) :: m
      character(len=:), allocatable :: text
      real(wp) :: speed
      integer :: c, i

      text = ''
      speed = -1
      do c = 1, m%particles%n_chunks
         do i = 1, m%particles%count(c)
            call name_faster(m%particles%id(i, c), m%particles%q(i, :, c), speed, text)
         end do
      end do
      do i = 1, m%outbox%n
         call name_faster(m%outbox%records(i)%id, m%outbox%records(i)%hot, speed, text)
      end do
   end function fastest

   !> Name a particle if it is faster than all before.
   pure subroutine name_faster(id, hot, speed, text)
      integer(i8), intent(in) :: id
      real(wp), intent(in) :: hot(:)
      real(wp), intent(inout) :: speed
      character(len=:), allocatable, intent(inout) :: text

      if (.not. norm2(hot(c_v:c_v + 2)) > speed) return
      speed = norm2(hot(c_v:c_v + 2))
      text = '; particle '//to_text(id)//' at '//to_text(hot(1:3))//' has the speed '// &
         to_text(speed)
   end subroutine name_faster

   pure function when_it_is(m) result(text)
      type(model_t), intent(in) :: m
      character(len=:), allocatable :: text

      text = 'step '//to_text(m%step)//', time '//to_text(m%time)
   end function when_it_is

   pure function unsound(id, hot) result(text)
      integer(i8), intent(in) :: id
      real(wp), intent(in) :: hot(:)
      character(len=:), allocatable :: text

      text = ''
      if (hot(c_vol) > 0 .and. sum(abs(hot)) < huge(1.0_wp)) return
      text = ': particle '//to_text(id)//' at '//to_text(hot(1:3))//' has volume '// &
         to_text(hot(c_vol))
   end function unsound

   pure function lost_message(m, lost) result(text)
      type(model_t), intent(in) :: m
      integer, intent(in) :: lost
      character(len=:), allocatable :: text

      text = 'step '//to_text(m%step)//', time '//to_text(m%time)//': '//to_text(lost)// &
         ' particles moved further than the next block in one step'
   end function lost_message

   !> Sort the chunks when many particles moved; divide the work anew when it is out of balance.
   subroutine keep_balance(m, shared_anew, error)
      type(model_t), intent(inout) :: m
      logical, intent(out) :: shared_anew   !! blocks may have changed their ranks
      type(error_t), allocatable, intent(out) :: error

      shared_anew = m%comm%size > 1 .and. m%imbalance > m%options%imbalance &
         .and. mod(m%step, balance_interval) == 0
      if (shared_anew) then
         call start_stage(m%clock, stage_migration)
         call repartition(m, error)
         call stop_stage(m%clock, stage_migration)
         if (allocated(error)) return
         m%moved = huge(1)
      end if
      if (real(m%moved, wp) < resort_share*real(count_particles(m%particles), wp)) return
      call start_stage(m%clock, stage_sort)
      call resort_chunks(m%particles)
      call stop_stage(m%clock, stage_sort)
      m%moved = 0
   end subroutine keep_balance

   !> Keep surfaces, level sets and split nodes up with the motion. What depends on the number of
   !> ranks (who moves a vertex) must not decide when level sets are renewed.
   subroutine keep_cracks(m, stale, error)
      type(model_t), intent(inout) :: m
      logical, intent(in) :: stale   !! who moves which vertex may have changed
      type(error_t), allocatable, intent(out) :: error
      logical :: due, drifted, again
      integer :: i

      if (size(m%cracks) == 0 .and. .not. m%split_again) return
      call start_stage(m%clock, stage_crack)
      due = mod(m%step, crack_interval) == 0
      drifted = .false.
      if (due .or. stale .or. (m%split_again .and. any(m%cracks%rule /= rule_graded))) then
         do i = 1, size(m%cracks)
            call gather_crack(m%cracks(i), m%comm, m%grid, due)
            if (due) drifted = drifted .or. has_drifted(m%cracks(i), m%grid%lattice%size)
         end do
      end if
      if (drifted) then
         call renew_level_sets(m, error)
         call agree_on_error(m%comm, error)
      end if
      ! GIMP particles come to reach further nodes also within their bins.
      again = drifted .or. m%split_again .or. &
         (due .and. m%grid%lattice%shape == gimp_shape .and. .not. m%bodies_meet)
      if (.not. allocated(error) .and. again) call renew_splits(m, error)
      call stop_stage(m%clock, stage_crack)
   end subroutine keep_cracks

   !> Level sets of all particles near cracks.
   subroutine renew_level_sets(m, error)
      type(model_t), intent(inout) :: m
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(m%cracks)
         call find_near(m%cracks(i), i, m%grid, m%particles, error)
         if (allocated(error)) return
      end do
   end subroutine renew_level_sets

   !> Split nodes and all that follows the rows. Collective.
   subroutine renew_splits(m, error)
      type(model_t), intent(inout) :: m
      type(error_t), allocatable, intent(out) :: error
      type(split_t) :: split
      integer :: i

      call split_nodes(m%cracks, m%comm, m%particles, m%bodies%half, m%grid, m%sharing, m%halo, &
         m%sided, split, error)
      call agree_on_error(m%comm, error)
      if (allocated(error)) return
      call mark_mine(m%grid, m%sharing, m%comm%rank)
      do i = 1, size(m%boundaries)
         call find_rows(m%boundaries(i), m%grid)
      end do
      m%split_again = .false.
      if (.not. m%bodies_meet) return
      call list_pairs(m%contact, m%cracks, split, m%grid, m%sharing, m%comm%rank)
      call list_rigid_rows(m%rigid, split)
   end subroutine renew_splits

   !> Time step from the wave speed and the fastest particle, cut at the end of the run.
   subroutine choose_step(m, until, error)
      type(model_t), intent(inout) :: m
      real(wp), intent(in) :: until   !! [time]
      type(error_t), allocatable, intent(out) :: error

      m%dt = m%options%cfl*m%grid%lattice%size/(m%wave_speed + m%speed)
      if (m%options%fixed_step > 0) m%dt = m%options%fixed_step
      if (.not. m%first_dt > 0) m%first_dt = m%dt
      if (.not. m%dt >= m%options%smallest_step*m%first_dt) then
         call raise(error, code_numerics, 'step '//to_text(m%step)//', time '//to_text(m%time)// &
            ': the time step fell to '//to_text(m%dt)//', less than '// &
            to_text(m%options%smallest_step)//' of the first one ('//to_text(m%first_dt)// &
            '); the fastest particle has the speed '//to_text(m%speed))
         return
      end if
      m%dt = min(m%dt, until - m%time)
   end subroutine choose_step

   !> Fastest wave in the bodies as they are now, over all ranks. Collective.
   subroutine find_wave_speed(m)
      type(model_t), intent(inout) :: m
      real(wp) :: speed, swell
      integer :: c, k

      speed = 0
      do c = 1, m%particles%n_chunks
         if (m%particles%count(c) == 0) cycle
         k = m%bodies%law_of(m%particles%body(c))
         swell = maxval(m%particles%q(:m%particles%count(c), c_vol, c) &
            /m%particles%q(:m%particles%count(c), c_m, c))
         associate (law => m%bodies%laws(k)%law)
            speed = max(speed, law%wave_speed()*sqrt(swell*law%density))
         end associate
      end do
      call max_all(m%comm, speed)
      m%wave_speed = speed
   end subroutine find_wave_speed

   !> Speed of the fastest particle. Collective.
   subroutine find_fastest(m)
      type(model_t), intent(inout) :: m
      real(wp) :: speed
      integer :: c, i

      speed = 0
      do c = 1, m%particles%n_chunks
         do i = 1, m%particles%count(c)
            speed = max(speed, norm2(m%particles%q(i, 4:6, c)))
         end do
      end do
      call max_all(m%comm, speed)
      m%speed = speed
   end subroutine find_fastest

   !> Particles of all ranks. Collective.
   subroutine count_all(m)
      type(model_t), intent(inout) :: m

      m%n_particles = int(count_particles(m%particles), i8)
      call sum_all(m%comm, m%n_particles)
   end subroutine count_all
end module xmpm_settle
