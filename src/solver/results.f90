!> The files of a run: particles, cracks, energy history, probe history.
module xmpm_results
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_text, only: string_t
   use xmpm_communicator, only: agree_on_error
   use xmpm_deck, only: deck_t, block_t, find_block, real_of, texts_of, unit_text, problems
   use xmpm_file_system, only: make_folder, remove_file
   use xmpm_provenance, only: provenance_t
   use xmpm_vtkhdf, only: field_t, drawn_t => surface_t
   use xmpm_output_series, only: series_t, open_series, write_particles, write_surface
   use xmpm_history, only: history_t, open_history, write_row_text, close_history, cell
   use xmpm_balance, only: balance_t, balance_names, balance_units, balance_cells
   use xmpm_probes, only: probe_t, read_probes, probe_names, probe_units, probe_values
   use xmpm_particle_fields, only: collect_particles, particle_unit
   use xmpm_crack_fields, only: collect_cracks, crack_fields, add_front_fields
   use xmpm_front_table, only: front_names, front_units, write_fronts
   use xmpm_model, only: model_t
   implicit none
   private

   public :: results_t, open_results, write_fields, write_energy, write_probes, &
      write_front_values, close_results

   !> What a run writes.
   type :: results_t
      real(wp) :: every = 0                           !! interval of the fields [time]
      real(wp) :: history_every = 0                   !! interval of the rows [time]
      logical :: has_particles = .true.               !! particles are written
      logical :: has_cracks = .false.                 !! cracks are written
      type(string_t), allocatable :: fields(:)        !! of the particles
      type(string_t), allocatable :: units(:)         !! of these
      type(string_t), allocatable :: crack_fields(:)  !! of the cracks
      type(string_t), allocatable :: crack_units(:)   !! of these
      type(probe_t), allocatable :: probes(:)
      type(series_t) :: particles, cracks
      type(history_t) :: energy, probe, front
      type(provenance_t) :: provenance
   end type results_t

contains

   !> Read *OUTPUT and *PROBE, and open all files. Collective; all ranks get the same error.
   subroutine open_results(results, m, deck, provenance, folder, job, error)
      type(results_t), intent(out) :: results
      type(model_t), intent(in) :: m                       !! set up
      type(deck_t), intent(inout) :: deck                  !! probes add to its problems
      type(provenance_t), intent(in) :: provenance         !! of the run
      character(len=*), intent(in) :: folder               !! of the files; '' where we are
      character(len=*), intent(in) :: job                  !! the files' names begin with it
      type(error_t), allocatable, intent(out) :: error     !! a probe outside, or a file
      character(len=:), allocatable :: path

      results%provenance = provenance
      call read_output(deck, size(m%cracks), size(m%fracture%cracks) > 0, results)
      call read_probes(deck, m, results%probes)
      call problems(deck, error)
      call agree_on_error(m%comm, error)
      if (allocated(error)) return
      path = job
      if (len(folder) > 0) then
         if (m%comm%rank == 0) call make_folder(folder, error)
         call agree_on_error(m%comm, error)
         if (allocated(error)) return
         path = folder//'/'//job
      end if
      call open_or_remove(results%particles, m, folder, job//'_particles', results%has_particles, &
         error)
      if (allocated(error)) return
      call open_or_remove(results%cracks, m, folder, job//'_crack', results%has_cracks, error)
      if (allocated(error)) return
      if (m%comm%rank == 0) call open_histories(results, m, deck, path, error)
      call agree_on_error(m%comm, error)
   end subroutine open_results

   !> Intervals and fields.
   subroutine read_output(deck, n_cracks, has_fronts, results)
      type(deck_t), intent(in) :: deck
      integer, intent(in) :: n_cracks
      logical, intent(in) :: has_fronts      !! values at fronts are wanted
      type(results_t), intent(inout) :: results
      type(string_t), allocatable :: words(:)
      type(block_t) :: block
      integer :: i

      block = find_block(deck, 'output', 1)
      results%every = real_of(block, 'every')
      results%history_every = real_of(block, 'history')
      results%fields = texts_of(block, 'particles')
      results%has_particles = .not. is_none(results%fields)
      allocate (results%units(size(results%fields)))
      do i = 1, size(results%fields)
         results%units(i)%s = particle_unit(deck, results%fields(i)%s)
      end do
      words = texts_of(block, 'crack')
      results%has_cracks = n_cracks > 0 .and. .not. is_none(words)
      call crack_fields(words, unit_text(deck, 'length'), results%crack_fields, results%crack_units)
      if (has_fronts) call add_front_fields(unit_text(deck, 'release rate'), &
         unit_text(deck, 'toughness'), results%crack_fields, results%crack_units)
   end subroutine read_output

   pure function is_none(words) result(none)
      type(string_t), intent(in) :: words(:)
      logical :: none

      none = .false.
      if (size(words) == 1) none = words(1)%s == 'none'
   end function is_none

   !> Begin a series, or remove the master of an older run where none is wanted. Collective.
   subroutine open_or_remove(series, m, folder, name, wanted, error)
      type(series_t), intent(out) :: series
      type(model_t), intent(in) :: m
      character(len=*), intent(in) :: folder, name
      logical, intent(in) :: wanted
      type(error_t), allocatable, intent(out) :: error

      if (wanted) then
         call open_series(series, m%comm, folder, name, error)
      else if (m%comm%rank == 0 .and. len(folder) > 0) then
         call remove_file(folder//'/'//name//'.vtkhdf')
      else if (m%comm%rank == 0) then
         call remove_file(name//'.vtkhdf')
      end if
   end subroutine open_or_remove

   !> Open the tables; rank 0 calls.
   subroutine open_histories(results, m, deck, path, error)
      type(results_t), intent(inout) :: results
      type(model_t), intent(in) :: m
      type(deck_t), intent(in) :: deck
      character(len=*), intent(in) :: path   !! folder and job
      type(error_t), allocatable, intent(out) :: error
      type(string_t), allocatable :: names(:), units(:)

      call open_history(results%energy, path//'_energy.csv', balance_names(), balance_units(deck), &
         results%provenance, error)
      if (allocated(error)) return
      if (size(m%fracture%cracks) > 0) then
         call open_history(results%front, path//'_front.csv', front_names(), front_units(deck), &
            results%provenance, error)
         if (allocated(error)) return
      else
         call remove_file(path//'_front.csv')
      end if
      if (size(results%probes) == 0) then
         call remove_file(path//'_probe.csv')
         return
      end if
      names = [string_t('time'), string_t('step'), probe_names(results%probes)]
      units = [string_t(unit_text(deck, 'time')), string_t('1'), probe_units(deck, results%probes)]
      call open_history(results%probe, path//'_probe.csv', padded(names), padded(units), &
         results%provenance, error)
   end subroutine open_histories

   !> Texts of equal length.
   pure function padded(texts) result(words)
      type(string_t), intent(in) :: texts(:)
      character(len=:), allocatable :: words(:)
      integer :: i, length

      length = 1
      do i = 1, size(texts)
         length = max(length, len(texts(i)%s))
      end do
      allocate (character(len=length) :: words(size(texts)))
      do i = 1, size(texts)
         words(i) = texts(i)%s
      end do
   end function padded

   !> Write particles and cracks as they are now. Collective.
   subroutine write_fields(results, m, error)
      type(results_t), intent(inout) :: results
      type(model_t), intent(in) :: m
      type(error_t), allocatable, intent(out) :: error     !! a file cannot be written
      type(field_t), allocatable :: fields(:)
      type(drawn_t) :: drawn
      real(wp), allocatable :: points(:, :)

      if (results%has_particles) then
         call collect_particles(m, results%fields, results%units, points, fields)
         call write_particles(results%particles, m%comm, m%time, results%provenance, points, &
            fields, error)
         if (allocated(error)) return
      end if
      if (results%has_cracks) then
         call collect_cracks(m, results%crack_fields, results%crack_units, drawn, fields)
         call write_surface(results%cracks, m%comm, m%time, results%provenance, drawn, fields, &
            error)
      end if
   end subroutine write_fields

   !> Write a row of the energy history; rank 0 writes, others return.
   subroutine write_energy(results, m, balance)
      type(results_t), intent(inout) :: results
      type(model_t), intent(in) :: m
      type(balance_t), intent(in) :: balance   !! of all ranks

      if (m%comm%rank == 0) call write_row_text(results%energy, balance_cells(balance))
   end subroutine write_energy

   !> Write a row of the probe history, if there are probes. Collective.
   subroutine write_probes(results, m)
      type(results_t), intent(inout) :: results
      type(model_t), intent(in) :: m
      real(wp), allocatable :: values(:)
      type(string_t), allocatable :: cells(:)
      integer :: i

      if (size(results%probes) == 0) return
      call probe_values(results%probes, m, values)
      if (m%comm%rank /= 0) return
      allocate (cells(2 + size(values)))
      cells(1) = cell(m%time)
      cells(2) = cell(m%step)
      do i = 1, size(values)
         cells(2 + i) = cell(values(i))
      end do
      call write_row_text(results%probe, cells)
   end subroutine write_probes

   !> Write the rows of the fronts as they were measured last; rank 0 writes, others return.
   subroutine write_front_values(results, m)
      type(results_t), intent(inout) :: results
      type(model_t), intent(in) :: m

      call write_fronts(results%front, m)
   end subroutine write_front_values

   !> Close the tables; the first row that could not be written is reported. Collective.
   subroutine close_results(results, m, error)
      type(results_t), intent(inout) :: results
      type(model_t), intent(in) :: m
      type(error_t), allocatable, intent(out) :: error
      type(error_t), allocatable :: second

      call close_history(results%energy, error)
      call close_history(results%probe, second)
      if (allocated(second) .and. .not. allocated(error)) call move_alloc(second, error)
      call close_history(results%front, second)
      if (allocated(second) .and. .not. allocated(error)) call move_alloc(second, error)
      call agree_on_error(m%comm, error)
   end subroutine close_results
end module xmpm_results
