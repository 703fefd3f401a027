!> Bodies and particle sets from an HDF5 file; the format is described in doc/particle_file.md.
!>
!> Every rank reads a slab of the particles of a body. Sets, which are surfaces as a rule, are read
!> whole by every rank.
module xmpm_particle_file
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t, raise, add_context, code_files
   use xmpm_text, only: string_t, to_text
   use xmpm_communicator, only: comm_t, agree_on_error
   use xmpm_hdf5_file, only: hdf5_file_t, open_file, close_file, has_item
   use xmpm_hdf5_read, only: extent_of, read_dataset, read_attribute, read_texts
   implicit none
   private

   public :: particle_data_t, particle_set_t, particle_units_t, read_particles, read_particle_set

   character(len=*), parameter :: format_name = 'xmpm3d particles'
   integer(i8), parameter :: format_version = 1

   !> Units of the deck, as words; a file must be written in the same.
   type :: particle_units_t
      character(len=:), allocatable :: length   !! for example 'mm'
      character(len=:), allocatable :: time     !! for example 'ms'
   end type particle_units_t

   !> Particles of a body as this rank read them.
   type :: particle_data_t
      integer(i8) :: total = 0                   !! particles of the whole file, all bodies
      integer(i8), allocatable :: place(:)       !! (n) in the file, from 0
      real(wp), allocatable :: x(:, :)           !! (3,n) positions [length]
      real(wp), allocatable :: volume(:)         !! (n) [length^3]
      real(wp), allocatable :: velocity(:, :)    !! (3,n), of extent 0 where not given [length/time]
   end type particle_data_t

   !> A named set of particles.
   type :: particle_set_t
      integer(i8), allocatable :: place(:)     !! (n) in the file, from 0
      real(wp), allocatable :: area(:, :)      !! (3,n) outward, or extent 0: not given [length^2]
      real(wp), allocatable :: offset(:, :)    !! (3,n) from particles to the face, or 0 [length]
   end type particle_set_t

contains

   !> Read a rank's slab of the particles of a body; all ranks must call and end alike.
   subroutine read_particles(path, part, units, comm, data, error)
      character(len=*), intent(in) :: path               !! of the file
      character(len=*), intent(in) :: part               !! name of the body, '': all particles
      type(particle_units_t), intent(in) :: units        !! of the deck
      type(comm_t), intent(in) :: comm                   !! ranks
      type(particle_data_t), intent(out) :: data         !! particles of this rank
      type(error_t), allocatable, intent(out) :: error   !! wrong file, see doc/particle_file.md
      type(hdf5_file_t) :: file
      type(string_t), allocatable :: names(:)
      integer(i8), allocatable :: bodies(:)
      integer(i8) :: first, count

      call open_particles(path, units, comm, file, data%total, error)
      if (allocated(error)) return
      first = data%total*int(comm%rank, i8)/int(comm%size, i8)
      count = data%total*int(comm%rank + 1, i8)/int(comm%size, i8) - first
      call read_dataset(file, 'positions', data%x, first + 1, count)
      call read_dataset(file, 'volumes', data%volume, first + 1, count)
      call read_velocities(file, first, count, data%velocity)
      call read_bodies(file, first, count, bodies, names)
      call close_file(file, error)
      if (allocated(error)) return
      call check_values(data, first, error)
      if (.not. allocated(error)) call choose_part(data, part, first, bodies, names, error)
      if (allocated(error)) call add_context(error, path)
      call agree_on_error(comm, error)
   end subroutine read_particles

   !> Read a named set of particles; the same on every rank.
   subroutine read_particle_set(path, name, units, comm, set, error)
      character(len=*), intent(in) :: path               !! of the file
      character(len=*), intent(in) :: name               !! of the set
      type(particle_units_t), intent(in) :: units        !! of the deck
      type(comm_t), intent(in) :: comm                   !! ranks
      type(particle_set_t), intent(out) :: set           !! the set
      type(error_t), allocatable, intent(out) :: error   !! wrong file, see doc/particle_file.md
      type(hdf5_file_t) :: file
      integer(i8), allocatable :: areas(:), offsets(:)
      integer(i8) :: total
      logical :: known
      character(len=:), allocatable :: group

      call open_particles(path, units, comm, file, total, error)
      if (allocated(error)) return
      group = 'sets/'//name
      allocate (set%place(0), set%area(3, 0), set%offset(3, 0), areas(0), offsets(0))
      known = has_item(file, group//'/particles')
      if (known) then
         call read_dataset(file, group//'/particles', set%place)
         call read_vectors(file, group//'/areas', set%area, areas)
         call read_vectors(file, group//'/offsets', set%offset, offsets)
      end if
      call close_file(file, error)
      if (allocated(error)) return
      if (.not. known) then
         call raise(error, code_files, "there is no set '"//name//"' (no dataset "//group// &
            '/particles)')
      else
         call check_places(group, total, set%place, error)
      end if
      if (.not. allocated(error)) call check_vectors(group//'/areas', set%place, set%area, areas, &
         error)
      if (.not. allocated(error)) call check_vectors(group//'/offsets', set%place, set%offset, &
         offsets, error)
      if (allocated(error)) call add_context(error, path)
      call agree_on_error(comm, error)
   end subroutine read_particle_set

   !> Open a file and check what it says of itself; it is closed again where that is wrong.
   subroutine open_particles(path, units, comm, file, total, error)
      character(len=*), intent(in) :: path
      type(particle_units_t), intent(in) :: units
      type(comm_t), intent(in) :: comm
      type(hdf5_file_t), intent(out) :: file
      integer(i8), intent(out) :: total
      type(error_t), allocatable, intent(out) :: error
      type(error_t), allocatable :: failure

      total = 0
      call open_file(file, path, error, comm)
      if (allocated(error)) return
      call check_header(file, units, error)
      if (.not. allocated(error)) call check_shapes(file, total, error)
      if (.not. (allocated(error) .or. allocated(file%failure))) return
      call close_file(file, failure)
      if (allocated(failure)) then
         call move_alloc(failure, error)   ! what could not be read comes before what was wrong
      else
         call add_context(error, path)
      end if
   end subroutine open_particles

   subroutine check_header(file, units, error)
      type(hdf5_file_t), intent(inout) :: file
      type(particle_units_t), intent(in) :: units
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: word
      integer(i8) :: version

      call read_attribute(file, '/', 'format', word)
      if (allocated(file%failure)) return
      if (word /= format_name) then
         call raise(error, code_files, "the format is '"//word//"' instead of '"//format_name//"'")
         return
      end if
      call read_attribute(file, '/', 'version', version)
      if (allocated(file%failure)) return
      if (version /= format_version) then
         call raise(error, code_files, 'the format has version '//to_text(version)// &
            '; this program reads version '//to_text(format_version))
         return
      end if
      call check_unit(file, 'length_unit', units%length, error)
      if (allocated(error)) return
      if (has_item(file, 'velocities')) call check_unit(file, 'time_unit', units%time, error)
   end subroutine check_header

   subroutine check_unit(file, name, expected, error)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name, expected
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: word

      call read_attribute(file, '/', name, word)
      if (word == expected .or. allocated(file%failure)) return
      call raise(error, code_files, 'the '//name//" is '"//word//"', that of the deck is '"// &
         expected//"'; nothing is converted")
   end subroutine check_unit

   !> All datasets of particles must have one entry a particle.
   subroutine check_shapes(file, total, error)
      type(hdf5_file_t), intent(inout) :: file
      integer(i8), intent(out) :: total
      type(error_t), allocatable, intent(out) :: error
      integer(i8), allocatable :: extent(:)

      total = 0
      extent = extent_of(file, 'volumes')
      if (allocated(file%failure)) return
      if (size(extent) == 1) then
         total = extent(1)
      else
         call raise(error, code_files, wrong_shape('volumes', extent, '(n)'))
         return
      end if
      if (total == 0) then
         call raise(error, code_files, 'the dataset volumes is empty: there are no particles')
         return
      end if
      call check_shape(file, 'positions', [3_i8, total], error)
      if (allocated(error)) return
      if (has_item(file, 'velocities')) call check_shape(file, 'velocities', [3_i8, total], error)
      if (allocated(error)) return
      if (has_item(file, 'bodies')) call check_shape(file, 'bodies', [total], error)
   end subroutine check_shapes

   subroutine check_shape(file, name, expected, error)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      integer(i8), intent(in) :: expected(:)
      type(error_t), allocatable, intent(out) :: error
      integer(i8), allocatable :: extent(:)
      logical :: right

      allocate (extent, source=extent_of(file, name))
      if (allocated(file%failure)) return
      right = size(extent) == size(expected)
      if (right) right = all(extent == expected)
      if (.not. right) call raise(error, code_files, &
         wrong_shape(name, extent, shape_text(expected))//', n being that of volumes')
   end subroutine check_shape

   pure function wrong_shape(name, extent, expected) result(text)
      character(len=*), intent(in) :: name, expected
      integer(i8), intent(in) :: extent(:)
      character(len=:), allocatable :: text

      text = 'the dataset '//name//' has shape '//shape_text(extent)//' instead of '//expected
   end function wrong_shape

   !> Extents as other languages write them, last one first.
   pure function shape_text(extent) result(text)
      integer(i8), intent(in) :: extent(:)
      character(len=:), allocatable :: text
      integer :: i

      text = '('
      do i = size(extent), 1, -1
         text = text//to_text(extent(i))
         if (i > 1) text = text//','
      end do
      text = text//')'
   end function shape_text

   subroutine read_velocities(file, first, count, velocity)
      type(hdf5_file_t), intent(inout) :: file
      integer(i8), intent(in) :: first, count
      real(wp), allocatable, intent(out) :: velocity(:, :)

      if (has_item(file, 'velocities')) then
         call read_dataset(file, 'velocities', velocity, first + 1, count)
      else
         allocate (velocity(3, 0))
      end if
   end subroutine read_velocities

   subroutine read_bodies(file, first, count, bodies, names)
      type(hdf5_file_t), intent(inout) :: file
      integer(i8), intent(in) :: first, count
      integer(i8), allocatable, intent(out) :: bodies(:)
      type(string_t), allocatable, intent(out) :: names(:)

      if (has_item(file, 'bodies')) then
         call read_dataset(file, 'bodies', bodies, first + 1, count)
         call read_texts(file, 'body_names', names)
      else
         allocate (bodies(0), names(0))
      end if
   end subroutine read_bodies

   subroutine check_values(data, first, error)
      type(particle_data_t), intent(in) :: data
      integer(i8), intent(in) :: first
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(data%volume)
         if (.not. ieee_is_finite(data%volume(i))) then
            call raise(error, code_files, entry_text('volumes', first, i)//' is not finite')
         else if (data%volume(i) <= 0.0_wp) then
            call raise(error, code_files, entry_text('volumes', first, i)//' is '// &
               to_text(data%volume(i))//'; it must be positive')
         else if (.not. all(ieee_is_finite(data%x(:, i)))) then
            call raise(error, code_files, entry_text('positions', first, i)//' is not finite')
         end if
         if (allocated(error)) return
      end do
      do i = 1, size(data%velocity, 2)
         if (all(ieee_is_finite(data%velocity(:, i)))) cycle
         call raise(error, code_files, entry_text('velocities', first, i)//' is not finite')
         return
      end do
   end subroutine check_values

   !> An entry of a dataset, counted from 0 as in the file.
   pure function entry_text(name, first, i) result(text)
      character(len=*), intent(in) :: name
      integer(i8), intent(in) :: first
      integer, intent(in) :: i
      character(len=:), allocatable :: text

      text = name//'['//to_text(first + int(i - 1, i8))//']'
   end function entry_text

   !> Keep the particles of one body, with their places in the file.
   subroutine choose_part(data, part, first, bodies, names, error)
      type(particle_data_t), intent(inout) :: data
      character(len=*), intent(in) :: part
      integer(i8), intent(in) :: first, bodies(:)
      type(string_t), intent(in) :: names(:)
      type(error_t), allocatable, intent(out) :: error
      integer, allocatable :: chosen(:)
      integer(i8) :: body
      integer :: i

      do i = 1, size(bodies)
         if (bodies(i) >= 0 .and. bodies(i) < size(names, kind=i8)) cycle
         call raise(error, code_files, entry_text('bodies', first, i)//' is '// &
            to_text(bodies(i))//', but there are '//to_text(size(names))//' body_names')
         return
      end do
      data%place = [(first + int(i - 1, i8), i=1, size(data%volume))]
      if (part == '') return
      body = find_name(names, part)
      if (body < 0) then
         call raise(error, code_files, "there is no body '"//part//"'; body_names are: "// &
            list_of(names))
         return
      end if
      chosen = pack([(i, i=1, size(bodies))], bodies == body)
      data%place = data%place(chosen)
      data%x = data%x(:, chosen)
      data%volume = data%volume(chosen)
      if (size(data%velocity, 2) > 0) data%velocity = data%velocity(:, chosen)
   end subroutine choose_part

   !> Place of a name in a list, from 0; -1 where it is missing.
   pure function find_name(names, name) result(place)
      type(string_t), intent(in) :: names(:)
      character(len=*), intent(in) :: name
      integer(i8) :: place
      integer :: i

      place = -1
      do i = 1, size(names)
         if (names(i)%s == name) place = int(i - 1, i8)
      end do
   end function find_name

   pure function list_of(names) result(text)
      type(string_t), intent(in) :: names(:)
      character(len=:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(names)
         if (i > 1) text = text//', '
         text = text//names(i)%s
      end do
      if (size(names) == 0) text = 'none'
   end function list_of

   !> Vectors of a set, where the file has them, and the shape that they have there.
   subroutine read_vectors(file, name, vectors, extent)
      type(hdf5_file_t), intent(inout) :: file
      character(len=*), intent(in) :: name
      real(wp), allocatable, intent(inout) :: vectors(:, :)
      integer(i8), allocatable, intent(inout) :: extent(:)

      if (.not. has_item(file, name)) return
      extent = extent_of(file, name)
      call read_dataset(file, name, vectors)
   end subroutine read_vectors

   subroutine check_places(group, total, place, error)
      character(len=*), intent(in) :: group
      integer(i8), intent(in) :: total, place(:)
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(place)
         if (place(i) >= 0 .and. place(i) < total) cycle
         call raise(error, code_files, entry_text(group//'/particles', 0_i8, i)//' is '// &
            to_text(place(i))//', but particles are 0 to '//to_text(total - 1))
         return
      end do
   end subroutine check_places

   !> Vectors of a set must be finite, one a particle, or not there at all.
   subroutine check_vectors(name, place, vectors, extent, error)
      character(len=*), intent(in) :: name
      integer(i8), intent(in) :: place(:), extent(:)
      real(wp), intent(in) :: vectors(:, :)
      type(error_t), allocatable, intent(out) :: error
      integer :: i
      logical :: right

      right = size(extent) == 0
      if (size(extent) == 2) right = all(extent == [3_i8, size(place, kind=i8)])
      if (.not. right) then
         call raise(error, code_files, wrong_shape(name, extent, &
            shape_text([3_i8, size(place, kind=i8)])))
         return
      end if
      do i = 1, size(vectors, 2)
         if (all(ieee_is_finite(vectors(:, i)))) cycle
         call raise(error, code_files, entry_text(name, 0_i8, i)//' is not finite')
         return
      end do
   end subroutine check_vectors
end module xmpm_particle_file
