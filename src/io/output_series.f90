!> A time series of output: numbered step files in a folder, and the master beside it.
module xmpm_output_series
   use xmpm_kinds, only: wp
   use xmpm_error, only: error_t
   use xmpm_communicator, only: comm_t, agree_on_error
   use xmpm_file_system, only: make_folder, remove_file, file_exists
   use xmpm_provenance, only: provenance_t
   use xmpm_vtkhdf, only: field_t, step_t, surface_t, write_particle_step, write_surface_step, &
      write_series_master
   implicit none
   private

   public :: series_t, open_series, write_particles, write_surface

   !> The steps of one series that are on disk.
   type :: series_t
      character(len=:), allocatable :: folder   !! of the master; '' is the working folder
      character(len=:), allocatable :: name     !! for example 'plate_particles'
      type(step_t), allocatable :: steps(:)     !! in order of time
   end type series_t

contains

   !> Begin a series: make its folder and remove the files of an older run; all ranks must call.
   subroutine open_series(series, comm, folder, name, error)
      type(series_t), intent(out) :: series                !! without steps
      type(comm_t), intent(in) :: comm                     !! ranks
      character(len=*), intent(in) :: folder               !! of the master; '' where we are
      character(len=*), intent(in) :: name                 !! for example 'plate_particles'
      type(error_t), allocatable, intent(out) :: error     !! the folder cannot be made
      integer :: number

      series%folder = folder
      if (len(folder) > 0) then
         if (folder(len(folder):) /= '/') series%folder = folder//'/'
      end if
      series%name = name
      allocate (series%steps(0))
      if (comm%rank == 0) then
         call make_folder(series%folder//name, error)
         call remove_file(master_path(series))
         number = 0
         do while (file_exists(step_path(series, number)))
            call remove_file(step_path(series, number))
            number = number + 1
         end do
      end if
      call agree_on_error(comm, error)
   end subroutine open_series

   !> Add a step of particles; all ranks must call.
   subroutine write_particles(series, comm, time, provenance, points, fields, error)
      type(series_t), intent(inout) :: series              !! gets one more step
      type(comm_t), intent(in) :: comm                     !! each rank gives its own particles
      real(wp), intent(in) :: time                         !! of the step
      type(provenance_t), intent(in) :: provenance         !! of the run
      real(wp), contiguous, intent(in) :: points(:, :)     !! (3,n) positions [length]
      type(field_t), intent(in) :: fields(:)               !! the same list in every step
      type(error_t), allocatable, intent(out) :: error     !! a file cannot be written
      type(step_t) :: step

      step%path = step_path(series, size(series%steps))
      step%time = time
      call write_particle_step(comm, step, provenance, points, fields, error)
      if (allocated(error)) return
      series%steps = [series%steps, step]
      if (comm%rank == 0) then
         call write_series_master(master_path(series), series%steps, fields, provenance, error)
      end if
      call agree_on_error(comm, error)
   end subroutine write_particles

   !> Add a step of a surface, which rank 0 writes; all ranks must call.
   subroutine write_surface(series, comm, time, provenance, surface, fields, error)
      type(series_t), intent(inout) :: series              !! gets one more step
      type(comm_t), intent(in) :: comm                     !! ranks
      real(wp), intent(in) :: time                         !! of the step
      type(provenance_t), intent(in) :: provenance         !! of the run
      type(surface_t), intent(in) :: surface               !! used on rank 0 only
      type(field_t), intent(in) :: fields(:)               !! the same list in every step
      type(error_t), allocatable, intent(out) :: error     !! a file cannot be written
      type(step_t) :: step

      step%path = step_path(series, size(series%steps))
      step%time = time
      if (comm%rank == 0) call write_surface_step(step, provenance, surface, fields, error)
      call agree_on_error(comm, error)
      if (allocated(error)) return
      series%steps = [series%steps, step]
      if (comm%rank == 0) then
         call write_series_master(master_path(series), series%steps, fields, provenance, error)
      end if
      call agree_on_error(comm, error)
   end subroutine write_surface

   function master_path(series) result(path)
      type(series_t), intent(in) :: series
      character(len=:), allocatable :: path

      path = series%folder//series%name//'.vtkhdf'
   end function master_path

   !> Path of a step's file, for example plate_particles/plate_particles_000012.vtkhdf.
   function step_path(series, number) result(path)
      type(series_t), intent(in) :: series
      integer, intent(in) :: number
      character(len=:), allocatable :: path
      character(len=8) :: digits

      write (digits, '(i6.6)') number
      path = series%folder//series%name//'/'//series%name//'_'//trim(digits)//'.vtkhdf'
   end function step_path
end module xmpm_output_series
