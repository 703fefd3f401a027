!> What a result was made by and from: program, libraries, ranks, date, deck.
module xmpm_provenance
   use mpi_f08, only: MPI_Get_library_version, MPI_MAX_LIBRARY_VERSION_STRING
   use xmpm_text, only: string_t, to_text
   use xmpm_communicator, only: comm_t, broadcast
   use xmpm_hdf5_file, only: hdf5_file_t, hdf5_version
   use xmpm_hdf5_write, only: make_group, write_attribute
   implicit none
   private

   public :: mpi_version, provenance_t, start_provenance, provenance_names, provenance_values, &
      write_provenance

   !> Facts that every file of a run carries, the same on every rank.
   type :: provenance_t
      character(len=:), allocatable :: version       !! of XMPM3D
      character(len=:), allocatable :: git_hash      !! of its source
      character(len=:), allocatable :: compiler      !! name and version
      character(len=:), allocatable :: flags         !! of the compiler
      character(len=:), allocatable :: mpi           !! library and version
      character(len=:), allocatable :: hdf5          !! version
      character(len=:), allocatable :: metis         !! version
      character(len=:), allocatable :: date          !! start of the run, ISO 8601
      character(len=:), allocatable :: deck_sha256   !! of the deck with its includes
      character(len=:), allocatable :: job           !! name of the job
      character(len=:), allocatable :: units         !! of length, mass and time
      integer :: ranks = 1                           !! number of MPI ranks
   end type provenance_t

contains

   !> Fill in what is known at run time; the caller sets build, METIS, deck, job and units.
   subroutine start_provenance(provenance, comm)
      type(provenance_t), intent(out) :: provenance   !! empty texts where not known here
      type(comm_t), intent(in) :: comm                !! all ranks must call

      provenance%version = ''
      provenance%git_hash = ''
      provenance%compiler = ''
      provenance%flags = ''
      provenance%metis = ''
      provenance%deck_sha256 = ''
      provenance%job = ''
      provenance%units = ''
      provenance%mpi = mpi_version()
      provenance%hdf5 = hdf5_version()
      provenance%date = date_now()
      provenance%ranks = comm%size
      call broadcast(comm, provenance%date)
   end subroutine start_provenance

   !> Names of the facts, in the order of `provenance_values`.
   function provenance_names() result(names)
      character(len=11) :: names(12)

      names = [character(len=11) :: 'program', 'git_hash', 'compiler', 'flags', 'mpi', 'hdf5', &
         'metis', 'ranks', 'date', 'deck_sha256', 'job', 'unit_system']
   end function provenance_names

   !> The facts as texts, in the order of `provenance_names`.
   function provenance_values(provenance) result(values)
      type(provenance_t), intent(in) :: provenance   !! shown
      type(string_t) :: values(12)                   !! one line each

      values(1)%s = 'XMPM3D '//provenance%version
      values(2)%s = provenance%git_hash
      values(3)%s = provenance%compiler
      values(4)%s = provenance%flags
      values(5)%s = provenance%mpi
      values(6)%s = provenance%hdf5
      values(7)%s = provenance%metis
      values(8)%s = to_text(provenance%ranks)
      values(9)%s = provenance%date
      values(10)%s = provenance%deck_sha256
      values(11)%s = provenance%job
      values(12)%s = provenance%units
   end function provenance_values

   !> Write the facts as attributes of the group `provenance` of a file.
   subroutine write_provenance(file, provenance)
      type(hdf5_file_t), intent(inout) :: file       !! open for writing
      type(provenance_t), intent(in) :: provenance   !! the same on every rank
      character(len=11) :: names(12)
      type(string_t) :: values(12)
      integer :: i

      names = provenance_names()
      values = provenance_values(provenance)
      call make_group(file, 'provenance')
      do i = 1, size(names)
         call write_attribute(file, 'provenance', trim(names(i)), values(i)%s)
      end do
   end subroutine write_provenance

   !> Name and version of the MPI library, up to its first comma.
   function mpi_version() result(version)
      character(len=:), allocatable :: version
      character(len=MPI_MAX_LIBRARY_VERSION_STRING) :: buffer
      integer :: length, last

      call MPI_Get_library_version(buffer, length)
      last = scan(buffer(:length), ','//new_line('a')//achar(0)) - 1
      if (last < 0) last = length
      version = trim(buffer(:last))
   end function mpi_version

   !> Date and time of day with the offset from UTC, for example 2024-05-01T12:34:56+02:00.
   function date_now() result(text)
      character(len=:), allocatable :: text
      character(len=8) :: day
      character(len=10) :: time
      character(len=5) :: zone

      call date_and_time(day, time, zone)
      text = day(:4)//'-'//day(5:6)//'-'//day(7:8)//'T'//time(:2)//':'//time(3:4)//':'//time(5:6)
      text = text//zone(:3)//':'//zone(4:5)
   end function date_now
end module xmpm_provenance
