!> What a user wants to know of a model before it runs.
module xmpm_check_report
   use xmpm_kinds, only: wp, i8
   use xmpm_text, only: to_text
   use xmpm_communicator, only: sum_all
   use xmpm_deck, only: deck_t, unit_text
   use xmpm_log, only: log_t, log_message
   use xmpm_model, only: model_t
   implicit none
   private

   public :: report_check

contains

   !> Time step, particles, cells, split nodes, fronts and memory. Collective.
   subroutine report_check(m, deck, log)
      type(model_t), intent(inout) :: m
      type(deck_t), intent(in) :: deck
      type(log_t), intent(inout) :: log
      integer(i8) :: counts(4)
      real(wp) :: dt
      integer :: i

      counts(1) = int(count(m%particles%head > 0), i8)
      counts(2) = int(count(m%grid%mine(m%grid%n_plain + 1:m%grid%n_rows)), i8)
      counts(3) = int(m%grid%blocks%n, i8)
      counts(4) = near_particles(m)
      call sum_all(m%comm, counts)
      dt = m%options%cfl*m%grid%lattice%size/(m%wave_speed + m%speed)
      if (m%options%fixed_step > 0) dt = m%options%fixed_step
      call log_message(log, 'particles       '//to_text(m%n_particles))
      call log_message(log, 'filled bins     '//to_text(counts(1))//' in '//to_text(counts(3))// &
         ' blocks')
      call log_message(log, 'particles a bin '//to_text(anint(100*real(m%n_particles, wp) &
         /real(max(1_i8, counts(1)), wp))/100))
      call log_message(log, 'wave speed      '//to_text(m%wave_speed)//' '// &
         unit_text(deck, 'velocity'))
      call log_message(log, 'time step       '//to_text(dt)//' '//unit_text(deck, 'time')// &
         ', about '// &
         to_text(ceiling(m%options%end_time/dt, i8))//' steps')
      if (size(m%cracks) == 0) return
      call log_message(log, 'rows of split nodes '//to_text(counts(2))// &
         ', particles near cracks '// &
         to_text(counts(4)))
      do i = 1, size(m%cracks)
         call log_message(log, 'crack '//m%cracks(i)%name//': '// &
            to_text(m%cracks(i)%surface%triangle_count)//' triangles, '// &
            to_text(m%cracks(i)%front%node_count)//' front points in '// &
            to_text(m%cracks(i)%front%chain_count)//' fronts')
      end do
   end subroutine report_check

   !> Particles of this rank that carry level sets.
   pure function near_particles(m) result(n)
      type(model_t), intent(in) :: m
      integer(i8) :: n
      integer :: c

      n = 0
      do c = 1, m%particles%n_chunks
         if (m%particles%attached(c) > 0) n = n + int(m%particles%count(c), i8)
      end do
   end function near_particles
end module xmpm_check_report
