!> VTKHDF files of poly data: one step a file, and a master that shows all steps as a time series.
!>
!> A step is written under a temporary name and renamed when whole, so that a killed run leaves
!> files that open. The master holds virtual datasets over the step files and is replaced likewise.
!> VTK crashes where `Steps/Values` has more entries than `NSteps`.
module xmpm_vtkhdf
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use xmpm_kinds, only: wp, sp, i8
   use xmpm_error, only: error_t
   use xmpm_text, only: string_t
   use xmpm_communicator, only: comm_t, sum_all, offset_of, agree_on_error
   use xmpm_file_system, only: rename_file
   use xmpm_hdf5_file, only: hdf5_file_t, create_file, close_file
   use xmpm_hdf5_write, only: write_dataset, write_attribute, write_virtual, make_group, &
      kind_real64, kind_real32, kind_int64
   use xmpm_provenance, only: provenance_t, write_provenance
   implicit none
   private

   public :: field_t, step_t, surface_t, new_field
   public :: write_particle_step, write_surface_step, write_series_master

   integer, parameter :: vertices = 1, lines = 2, polygons = 3, strips = 4
   character(len=8), parameter :: cell_groups(4) = ['Vertices', 'Lines   ', 'Polygons', 'Strips  ']

   !> One field on points.
   type :: field_t
      character(len=:), allocatable :: name     !! shown by ParaView
      character(len=:), allocatable :: unit     !! kept as an attribute
      real(wp), allocatable :: values(:, :)     !! (components,n); unallocated for integers
      integer(i8), allocatable :: ids(:)        !! (n) integers, written as they are
      logical :: double = .false.               !! written as float64 instead of float32
   end type field_t

   !> One written step, as the master needs to know it.
   type :: step_t
      character(len=:), allocatable :: path   !! of the step's file
      real(wp) :: time = 0                    !! shown by ParaView
      integer(i8) :: points = 0               !! number of points
      integer(i8) :: cells(4) = 0             !! cells of each group of cells
      integer(i8) :: ids(4) = 0               !! point numbers in each group of cells
   end type step_t

   !> A triangle mesh with polylines on it.
   type :: surface_t
      real(wp), allocatable :: points(:, :)     !! (3,n) [length]
      integer, allocatable :: triangles(:, :)   !! (3,m) points of each triangle, from 1
      integer, allocatable :: fronts(:)         !! points of all front lines, from 1
      integer, allocatable :: front_start(:)    !! (lines+1) where each begins in `fronts`, from 1
   end type surface_t

   !> Cells of one group: their points and where each cell begins, both from 0.
   type :: cells_t
      integer(i8), allocatable :: connectivity(:)   !! this rank's part
      integer(i8), allocatable :: offsets(:)        !! (cells+1) on rank 0, empty elsewhere
   end type cells_t

   !> A field from its values: integers, scalars or columns of components.
   interface new_field
      module procedure new_integer_field, new_scalar_field, new_column_field
   end interface new_field

contains

   function new_integer_field(name, unit, ids) result(field)
      character(len=*), intent(in) :: name, unit
      integer(i8), intent(in) :: ids(:)   !! (n)
      type(field_t) :: field

      field%name = name
      field%unit = unit
      allocate (field%ids, source=ids)
   end function new_integer_field

   function new_scalar_field(name, unit, values, double) result(field)
      character(len=*), intent(in) :: name, unit
      real(wp), intent(in) :: values(:)   !! (n)
      logical, intent(in), optional :: double
      type(field_t) :: field

      field = new_column_field(name, unit, reshape(values, [1, size(values)]), double)
   end function new_scalar_field

   function new_column_field(name, unit, values, double) result(field)
      character(len=*), intent(in) :: name, unit
      real(wp), intent(in) :: values(:, :)   !! (components,n)
      logical, intent(in), optional :: double
      type(field_t) :: field

      field%name = name
      field%unit = unit
      allocate (field%values, source=values)
      if (present(double)) field%double = double
   end function new_column_field

   !> Write one step of particles as a single poly-vertex cell; all ranks must call.
   subroutine write_particle_step(comm, step, provenance, points, fields, error)
      type(comm_t), intent(in) :: comm                     !! each rank gives its own particles
      type(step_t), intent(inout) :: step                  !! path and time given, counts set
      type(provenance_t), intent(in) :: provenance         !! of the run
      real(wp), contiguous, intent(in) :: points(:, :)     !! (3,n) positions [length]
      type(field_t), intent(in) :: fields(:)               !! same list on every rank
      type(error_t), allocatable, intent(out) :: error     !! the file cannot be written
      type(hdf5_file_t) :: file
      type(cells_t) :: cells(4)
      integer(i8) :: first

      step%points = size(points, 2, i8)
      first = offset_of(comm, step%points)
      call sum_all(comm, step%points)
      call no_cells(cells, comm%rank == 0)
      cells(vertices)%connectivity = first + counting(size(points, 2))
      if (comm%rank == 0 .and. step%points > 0) cells(vertices)%offsets = [0_i8, step%points]
      step%cells = [merge(1_i8, 0_i8, step%points > 0), 0_i8, 0_i8, 0_i8]
      step%ids = [step%points, 0_i8, 0_i8, 0_i8]

      call create_file(file, step%path//'.part', error, comm)
      if (allocated(error)) return
      call write_poly_data(file, comm%rank == 0, step, points, cells, fields)
      call write_provenance(file, provenance)
      call close_file(file, error)
      if (allocated(error)) return
      if (comm%rank == 0) call rename_file(step%path//'.part', step%path, error)
      call agree_on_error(comm, error)
   end subroutine write_particle_step

   !> Write one step of a surface with its fronts; one rank calls.
   subroutine write_surface_step(step, provenance, surface, fields, error)
      type(step_t), intent(inout) :: step                  !! path and time given, counts set
      type(provenance_t), intent(in) :: provenance         !! of the run
      type(surface_t), intent(in) :: surface               !! triangles and front lines
      type(field_t), intent(in) :: fields(:)               !! on the points
      type(error_t), allocatable, intent(out) :: error     !! the file cannot be written
      type(hdf5_file_t) :: file
      type(cells_t) :: cells(4)
      integer :: i

      call no_cells(cells, .true.)
      cells(lines)%connectivity = int(surface%fronts - 1, i8)
      if (size(surface%front_start) > 0) cells(lines)%offsets = int(surface%front_start - 1, i8)
      i = size(surface%triangles)
      cells(polygons)%connectivity = int(reshape(surface%triangles, [i]) - 1, i8)
      cells(polygons)%offsets = 3*counting(size(surface%triangles, 2) + 1)
      step%points = size(surface%points, 2, i8)
      do i = 1, 4
         step%cells(i) = size(cells(i)%offsets, kind=i8) - 1
         step%ids(i) = size(cells(i)%connectivity, kind=i8)
      end do

      call create_file(file, step%path//'.part', error)
      if (allocated(error)) return
      call write_poly_data(file, .true., step, surface%points, cells, fields)
      call write_provenance(file, provenance)
      call close_file(file, error)
      if (.not. allocated(error)) call rename_file(step%path//'.part', step%path, error)
   end subroutine write_surface_step

   !> Write the master of a series: virtual datasets over the steps; one rank calls.
   !>
   !> The paths of the steps are relative to the folder of the master, which they are put in.
   subroutine write_series_master(path, steps, fields, provenance, error)
      character(len=*), intent(in) :: path                 !! of the master
      type(step_t), intent(in) :: steps(:)                 !! in order of time
      type(field_t), intent(in) :: fields(:)               !! those of a step; values are not used
      type(provenance_t), intent(in) :: provenance         !! of the run
      type(error_t), allocatable, intent(out) :: error     !! the file cannot be written
      type(hdf5_file_t) :: file
      type(string_t) :: sources(size(steps))
      integer :: i, folder

      folder = index(path, '/', back=.true.)
      do i = 1, size(steps)
         sources(i)%s = steps(i)%path(folder + 1:)
      end do
      call create_file(file, path//'.part', error)
      if (allocated(error)) return
      call write_head(file)
      call write_virtual(file, 'VTKHDF/Points', sources, [steps%points], 3, kind_real64)
      call write_dataset(file, 'VTKHDF/NumberOfPoints', [steps%points])
      call write_virtual_cells(file, sources, steps)
      call write_virtual_fields(file, sources, steps, fields)
      call write_steps(file, .true., steps, fields)
      call write_provenance(file, provenance)
      call close_file(file, error)
      if (.not. allocated(error)) call rename_file(path//'.part', path, error)
   end subroutine write_series_master

   subroutine write_virtual_cells(file, sources, steps)
      type(hdf5_file_t), intent(inout) :: file
      type(string_t), intent(in) :: sources(:)
      type(step_t), intent(in) :: steps(:)
      integer(i8), dimension(size(steps)) :: cells, ids
      integer :: i

      do i = 1, 4
         cells = steps%cells(i)
         ids = steps%ids(i)
         call write_dataset(file, in_group(i, 'NumberOfCells'), cells)
         call write_dataset(file, in_group(i, 'NumberOfConnectivityIds'), ids)
         call write_virtual(file, in_group(i, 'Connectivity'), sources, ids, 0, kind_int64)
         call write_virtual(file, in_group(i, 'Offsets'), sources, cells + 1, 0, kind_int64)
      end do
   end subroutine write_virtual_cells

   subroutine write_virtual_fields(file, sources, steps, fields)
      type(hdf5_file_t), intent(inout) :: file
      type(string_t), intent(in) :: sources(:)
      type(step_t), intent(in) :: steps(:)
      type(field_t), intent(in) :: fields(:)
      character(len=:), allocatable :: name
      integer :: i, width, element

      call make_group(file, 'VTKHDF/PointData')
      do i = 1, size(fields)
         name = 'VTKHDF/PointData/'//fields(i)%name
         width = 0
         element = kind_int64
         if (.not. allocated(fields(i)%ids)) then
            width = size(fields(i)%values, 1)
            if (width == 1) width = 0
            element = merge(kind_real64, kind_real32, fields(i)%double)
         end if
         call write_virtual(file, name, sources, [steps%points], width, element)
         call write_attribute(file, name, 'unit', fields(i)%unit)
      end do
   end subroutine write_virtual_fields

   !> Everything of one step but the provenance.
   subroutine write_poly_data(file, first_rank, step, points, cells, fields)
      type(hdf5_file_t), intent(inout) :: file
      logical, intent(in) :: first_rank   !! this rank writes what is there once
      type(step_t), intent(in) :: step
      real(wp), contiguous, intent(in) :: points(:, :)
      type(cells_t), intent(in) :: cells(4)
      type(field_t), intent(in) :: fields(:)
      integer :: i

      call write_head(file)
      call write_dataset(file, 'VTKHDF/Points', points)
      call write_dataset(file, 'VTKHDF/NumberOfPoints', once(first_rank, [step%points]))
      do i = 1, 4
         call write_dataset(file, in_group(i, 'NumberOfCells'), once(first_rank, step%cells(i:i)))
         call write_dataset(file, in_group(i, 'NumberOfConnectivityIds'), &
            once(first_rank, step%ids(i:i)))
         call write_dataset(file, in_group(i, 'Connectivity'), cells(i)%connectivity)
         call write_dataset(file, in_group(i, 'Offsets'), cells(i)%offsets)
      end do
      call make_group(file, 'VTKHDF/PointData')
      do i = 1, size(fields)
         call write_field(file, fields(i))
      end do
      call write_steps(file, first_rank, [step], fields)
   end subroutine write_poly_data

   subroutine write_field(file, field)
      type(hdf5_file_t), intent(inout) :: file
      type(field_t), intent(in) :: field
      character(len=:), allocatable :: name
      integer :: n
      logical :: scalar

      name = 'VTKHDF/PointData/'//field%name
      if (allocated(field%ids)) then
         call write_dataset(file, name, field%ids)
      else
         n = size(field%values)
         scalar = size(field%values, 1) == 1
         if (field%double) then
            if (scalar) call write_dataset(file, name, reshape(field%values, [n]))
            if (.not. scalar) call write_dataset(file, name, field%values)
         else
            if (scalar) call write_dataset(file, name, single(reshape(field%values, [n])))
            if (.not. scalar) call write_dataset(file, name, single(field%values))
         end if
      end if
      call write_attribute(file, name, 'unit', field%unit)
   end subroutine write_field

   !> Name of a dataset of one of the groups of cells.
   pure function in_group(i, name) result(path)
      integer, intent(in) :: i
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: path

      path = 'VTKHDF/'//trim(cell_groups(i))//'/'//name
   end function in_group

   subroutine write_head(file)
      type(hdf5_file_t), intent(inout) :: file

      call make_group(file, 'VTKHDF')
      call write_attribute(file, 'VTKHDF', 'Version', [2_i8, 2_i8])
      call write_attribute(file, 'VTKHDF', 'Type', 'PolyData')
   end subroutine write_head

   !> The group that makes a series of one or more steps, each of one part.
   subroutine write_steps(file, first_rank, steps, fields)
      type(hdf5_file_t), intent(inout) :: file
      logical, intent(in) :: first_rank
      type(step_t), intent(in) :: steps(:)
      type(field_t), intent(in) :: fields(:)
      character(len=*), parameter :: group = 'VTKHDF/Steps/'
      integer(i8), dimension(size(steps)) :: points, parts, ones
      integer(i8), dimension(4, size(steps)) :: cells, ids
      integer :: i

      ones = 1
      parts = counting(size(steps))
      points(1) = 0
      cells(:, 1) = 0
      ids(:, 1) = 0
      do i = 2, size(steps)
         points(i) = points(i - 1) + steps(i - 1)%points
         cells(:, i) = cells(:, i - 1) + steps(i - 1)%cells
         ids(:, i) = ids(:, i - 1) + steps(i - 1)%ids
      end do
      call make_group(file, 'VTKHDF/Steps')
      call write_attribute(file, 'VTKHDF/Steps', 'NSteps', int(size(steps), i8))
      call write_dataset(file, group//'Values', [steps(:merge(size(steps), 0, first_rank))%time])
      call write_dataset(file, group//'PartOffsets', once(first_rank, parts))
      call write_dataset(file, group//'NumberOfParts', once(first_rank, ones))
      call write_dataset(file, group//'PointOffsets', once(first_rank, points))
      call write_dataset(file, group//'CellOffsets', once_columns(first_rank, cells))
      call write_dataset(file, group//'ConnectivityIdOffsets', once_columns(first_rank, ids))
      call make_group(file, group//'PointDataOffsets')
      do i = 1, size(fields)
         call write_dataset(file, group//'PointDataOffsets/'//fields(i)%name, &
            once(first_rank, points))
      end do
   end subroutine write_steps

   !> Groups without cells; each part has one offset more than it has cells.
   subroutine no_cells(cells, first_rank)
      type(cells_t), intent(out) :: cells(4)
      logical, intent(in) :: first_rank
      integer :: i

      do i = 1, 4
         allocate (cells(i)%connectivity(0))
         cells(i)%offsets = once(first_rank, [0_i8])
      end do
   end subroutine no_cells

   !> The values on the rank that writes them, none on the others.
   pure function once(first_rank, values) result(mine)
      logical, intent(in) :: first_rank
      integer(i8), intent(in) :: values(:)
      integer(i8), allocatable :: mine(:)

      mine = values(:merge(size(values), 0, first_rank))
   end function once

   pure function once_columns(first_rank, values) result(mine)
      logical, intent(in) :: first_rank
      integer(i8), intent(in) :: values(:, :)
      integer(i8), allocatable :: mine(:, :)

      mine = values(:, :merge(size(values, 2), 0, first_rank))
   end function once_columns

   !> The numbers 0 to n-1.
   pure function counting(n) result(numbers)
      integer, intent(in) :: n
      integer(i8) :: numbers(n)
      integer :: i

      numbers = [(int(i, i8), i=0, n - 1)]
   end function counting

   !> Single precision; what is too large becomes the largest number instead of a trap.
   elemental function single(value) result(short)
      real(wp), intent(in) :: value
      real(sp) :: short
      real(wp), parameter :: most = real(huge(1.0_sp), wp)

      if (ieee_is_nan(value)) then
         short = real(value, sp)
      else
         short = real(max(-most, min(most, value)), sp)
      end if
   end function single
end module xmpm_vtkhdf
