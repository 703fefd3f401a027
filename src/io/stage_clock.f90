!> Wall time by stage of the step. A stage inside a stage stops the outer one's clock meanwhile,
!> so that the times add up. No time decides anything.
module xmpm_stage_clock
   use xmpm_kinds, only: wp, i8
   use xmpm_text, only: to_text
   use xmpm_communicator, only: comm_t, sum_all, max_all
   implicit none
   private

   public :: stage_clock_t, start_clock, start_stage, stop_stage, stage_seconds, stage_table
   public :: stage_sort, stage_p2g, stage_grid, stage_g2p, stage_stress, stage_crack, &
      stage_fracture, stage_halo, stage_migration, stage_output, stage_count

   integer, parameter :: stage_sort = 1        !! bins, level sets kept with the particles
   integer, parameter :: stage_p2g = 2         !! particles to grid
   integer, parameter :: stage_grid = 3        !! momentum, boundary conditions
   integer, parameter :: stage_g2p = 4         !! grid to particles
   integer, parameter :: stage_stress = 5      !! material laws
   integer, parameter :: stage_crack = 6       !! surface motion, level sets, split nodes, contact
   integer, parameter :: stage_fracture = 7    !! J and stress intensity factors, growth
   integer, parameter :: stage_halo = 8        !! exchange of shared rows
   integer, parameter :: stage_migration = 9   !! particles that change rank
   integer, parameter :: stage_output = 10     !! files
   integer, parameter :: stage_count = 10      !! number of stages

   character(len=9), parameter :: names(stage_count) = [character(len=9) :: 'sort', 'P2G', &
      'grid', 'G2P', 'stress', 'crack', 'J and K', 'halo', 'migration', 'output']
   integer, parameter :: deepest = 8

   !> Times of this rank.
   type :: stage_clock_t
      integer(i8) :: ticks(stage_count) = 0   !! clock ticks spent in each stage
      integer(i8) :: mark = 0                 !! clock when the running stage went on
      integer(i8) :: begun = 0                !! clock at the start
      integer :: running(deepest) = 0         !! stages that are running, the innermost last
      integer :: depth = 0                    !! how many of them
      real(wp) :: cpu_begun = 0               !! processor time at the start [s]
   end type stage_clock_t

contains

   !> Set all times to zero.
   subroutine start_clock(clock)
      type(stage_clock_t), intent(out) :: clock   !! of this rank

      call system_clock(clock%begun)
      clock%mark = clock%begun
      call cpu_time(clock%cpu_begun)
   end subroutine start_clock

   !> Enter a stage.
   subroutine start_stage(clock, id)
      type(stage_clock_t), intent(inout) :: clock   !! of this rank
      integer, intent(in) :: id                     !! one of the stages of this module

      call charge(clock)
      clock%depth = clock%depth + 1
      clock%running(clock%depth) = id
   end subroutine start_stage

   !> Leave the stage that was entered last; `id` says which for the reader.
   subroutine stop_stage(clock, id)
      type(stage_clock_t), intent(inout) :: clock   !! of this rank
      integer, intent(in) :: id                     !! the stage that ends

      call charge(clock)
      if (clock%depth == 0) return
      if (clock%running(clock%depth) == id) clock%depth = clock%depth - 1
   end subroutine stop_stage

   !> Give the time since the last mark to the stage that is running.
   subroutine charge(clock)
      type(stage_clock_t), intent(inout) :: clock
      integer(i8) :: now
      integer :: id

      call system_clock(now)
      if (clock%depth > 0) then
         id = clock%running(clock%depth)
         clock%ticks(id) = clock%ticks(id) + now - clock%mark
      end if
      clock%mark = now
   end subroutine charge

   !> Time spent in a stage on this rank.
   function stage_seconds(clock, id) result(seconds)
      type(stage_clock_t), intent(in) :: clock   !! of this rank
      integer, intent(in) :: id                  !! one of the stages of this module
      real(wp) :: seconds                        !! [s]

      seconds = to_seconds(clock%ticks(id))
   end function stage_seconds

   !> Table of the stages over all ranks, lines split by new_line; all ranks must call.
   function stage_table(clock, comm, work, bytes) result(text)
      type(stage_clock_t), intent(in) :: clock   !! of this rank
      type(comm_t), intent(in) :: comm           !! ranks
      real(wp), intent(in) :: work               !! particle-steps of all ranks
      real(wp), intent(in) :: bytes              !! memory a particle; 0 where it is not known
      character(len=:), allocatable :: text
      real(wp) :: mean(stage_count + 2), most(stage_count + 2), share(stage_count + 2)
      character(len=*), parameter :: line = new_line('a')
      integer :: i

      mean = all_seconds(clock)
      most = mean
      call sum_all(comm, mean)
      call max_all(comm, most)
      mean = mean/real(comm%size, wp)
      share = 100*mean/max(mean(stage_count + 1), 1.0e-9_wp)
      text = 'stage       mean [s]   most [s]  share  ns a particle-step'
      do i = 1, stage_count
         text = text//line//row(names(i), mean(i), most(i), share(i), work)
      end do
      text = text//line//row('total', mean(stage_count + 1), most(stage_count + 1), 100.0_wp, work)
      text = text//line//row('processor', mean(stage_count + 2), most(stage_count + 2), &
         share(stage_count + 2), work)
      text = text//line//'share of the crack stages: '// &
         percent(share(stage_crack) + share(stage_fracture))
      if (bytes > 0) text = text//line//'bytes a particle: '//to_text(nint(bytes))
   end function stage_table

   !> Seconds of this rank: stages, whole run, processor.
   function all_seconds(clock) result(seconds)
      type(stage_clock_t), intent(in) :: clock
      real(wp) :: seconds(stage_count + 2), cpu
      integer(i8) :: now
      integer :: i

      call system_clock(now)
      call cpu_time(cpu)
      do i = 1, stage_count
         seconds(i) = to_seconds(clock%ticks(i))
      end do
      seconds(stage_count + 1) = to_seconds(now - clock%begun)
      seconds(stage_count + 2) = cpu - clock%cpu_begun
   end function all_seconds

   function row(name, mean, most, share, work) result(line)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: mean, most, share, work
      character(len=:), allocatable :: line
      character(len=80) :: buffer

      write (buffer, '(a9,2f11.3,a7,f12.2)') name, mean, most, percent(share), &
         1.0e9_wp*mean/max(work, 1.0_wp)
      line = trim(buffer)
   end function row

   function percent(share) result(text)
      real(wp), intent(in) :: share
      character(len=6) :: text

      write (text, '(f5.1,a)') min(share, 999.9_wp), '%'
   end function percent

   function to_seconds(ticks) result(seconds)
      integer(i8), intent(in) :: ticks
      real(wp) :: seconds
      integer(i8) :: rate

      call system_clock(count_rate=rate)
      seconds = real(ticks, wp)/real(rate, wp)
   end function to_seconds
end module xmpm_stage_clock
