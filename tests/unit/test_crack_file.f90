!> Cracks from STL and HDF5 files: what comes back, and the messages about broken files.
program test_crack_file
   use, intrinsic :: iso_fortran_env, only: int8, int16, int32, real32
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t
   use xmpm_surface, only: surface_t, build_surface, surface_area
   use xmpm_crack_shapes, only: crack_plane_t, set_plane, make_disc
   use xmpm_crack_file, only: read_crack_file
   use xmpm_hdf5_file, only: hdf5_file_t, create_file, close_file
   use xmpm_hdf5_write, only: write_dataset, write_attribute
   use xmpm_stl_file, only: merge_corners
   use testing, only: suite_t, check, check_close, check_error, check_no_error, finish
   implicit none
   type(suite_t) :: suite
   type(error_t), allocatable :: error
   type(crack_plane_t) :: plane
   real(wp), allocatable :: disc(:, :), x(:, :)
   integer, allocatable :: disc_tri(:, :), tri(:, :)

   suite%name = 'crack_file'
   call set_plane([3.0_wp, -1.0_wp, 2.0_wp], [1.0_wp, 1.0_wp, 0.0_wp], [0.0_wp, 0.0_wp, 2.0_wp], &
      plane, error)
   call make_disc(plane, 0.7_wp, 0.1_wp, disc, disc_tri, error)
   call hdf5_round_trip()
   call binary_round_trip()
   call ascii_round_trip()
   call spellings()
   call merging()
   call broken_stl()
   call broken_hdf5()
   call finish(suite)

contains

   !> What was read is the disc: the same triangles, corner by corner, and a sound surface.
   subroutine compare(name, slack)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: slack
      type(surface_t) :: surface
      real(wp) :: worst
      integer :: t, k

      call check_no_error(suite, name//' is read', error)
      if (allocated(error)) return
      call check(suite, name//' has the disc''s vertices and triangles', &
         size(x, 2) == size(disc, 2) .and. size(tri, 2) == size(disc_tri, 2))
      worst = 0.0_wp
      do t = 1, size(tri, 2)
         do k = 1, 3
            worst = max(worst, norm2(x(:, tri(k, t)) - disc(:, disc_tri(k, t))))
         end do
      end do
      call check_close(suite, name//' has every corner in its place', worst, 0.0_wp, slack, 0.0_wp)
      call build_surface(x, tri, surface, error)
      call check_no_error(suite, name//' is a sound surface', error)
   end subroutine compare

   subroutine write_hdf5(format, version, unit, vertices, triangles)
      character(len=*), intent(in) :: format, unit
      integer(i8), intent(in) :: version
      real(wp), intent(in) :: vertices(:, :)
      integer(i8), intent(in) :: triangles(:, :)
      type(hdf5_file_t) :: file

      call create_file(file, 'crack.h5', error)
      call write_attribute(file, '/', 'format', format)
      call write_attribute(file, '/', 'version', version)
      call write_attribute(file, '/', 'length_unit', unit)
      call write_dataset(file, 'vertices', vertices)
      call write_dataset(file, 'triangles', triangles)
      call close_file(file, error)
      call read_crack_file('crack.h5', 'mm', x, tri, error)
   end subroutine write_hdf5

   subroutine hdf5_round_trip()
      call write_hdf5('xmpm3d crack', 1_i8, 'mm', disc, int(disc_tri - 1, i8))
      ! float64 in, float64 out
      call compare('an HDF5 file', 0.0_wp)
   end subroutine hdf5_round_trip

   subroutine write_binary(corners, count, drop)
      real(wp), intent(in) :: corners(:, :)
      integer, intent(in) :: count, drop
      integer :: unit, t
      character(len=80) :: title

      title = 'solid as some programs write it into binary files too'
      open (newunit=unit, file='crack.stl', access='stream', form='unformatted', status='replace')
      write (unit) title, int(count, int32)
      do t = 1, size(corners, 2)/3 - drop
         write (unit) real([0, 0, 0], real32), real(corners(:, 3*t - 2:3*t), real32), 0_int16
      end do
      close (unit)
      call read_crack_file('crack.stl', 'mm', x, tri, error)
   end subroutine write_binary

   pure function corners_of_disc() result(corners)
      real(wp) :: corners(3, 3*size(disc_tri, 2))

      corners = disc(:, reshape(disc_tri, [3*size(disc_tri, 2)]))
   end function corners_of_disc

   subroutine binary_round_trip()
      call write_binary(corners_of_disc(), size(disc_tri, 2), 0)
      ! float32 keeps coordinates up to 4 to 4*2**-24 each
      call compare('a binary STL file', 5.0e-7_wp)
   end subroutine binary_round_trip

   subroutine ascii_round_trip()
      integer :: unit, t, k

      open (newunit=unit, file='crack.stl', status='replace')
      write (unit, '(a)') 'solid disc'
      do t = 1, size(disc_tri, 2)
         write (unit, '(a)') '  facet normal 0 0 0', '    outer loop'
         do k = 1, 3
            write (unit, '(a,3es25.16)') '      vertex ', disc(:, disc_tri(k, t))
         end do
         write (unit, '(a)') '    endloop', '  endfacet'
      end do
      write (unit, '(a)') 'endsolid disc'
      close (unit)
      call read_crack_file('crack.stl', 'mm', x, tri, error)
      ! 17 digits give a float64 back
      call compare('an ASCII STL file', 0.0_wp)
   end subroutine ascii_round_trip

   subroutine try_text(lines)
      character(len=*), intent(in) :: lines   !! with | between the lines
      integer :: unit, i

      open (newunit=unit, file='crack.stl', access='stream', form='unformatted', status='replace')
      do i = 1, len(lines)
         if (lines(i:i) == '|') then
            write (unit) new_line('a')
         else
            write (unit) lines(i:i)
         end if
      end do
      close (unit)
      call read_crack_file('crack.stl', 'mm', x, tri, error)
   end subroutine try_text

   !> Capitals, tabs, carriage returns and two solids in one file.
   subroutine spellings()
      character, parameter :: tab = achar(9), cr = achar(13)

      call try_text('SOLID a'//cr//'|FACET NORMAL 0 0 1'//cr//'|OUTER LOOP'//cr//'|'//tab// &
         'VERTEX'//tab// &
         '0 0 0'//cr//'|VERTEX 1.0E+00 0 0|VERTEX 0 1 0|ENDLOOP|ENDFACET|ENDSOLID||'// &
         'solid b|facet normal 0 0 1|'// &
         'outer loop|vertex 0 0 0|vertex 0 1 0|vertex -1 0 0|endloop|endfacet|endsolid b')
      call check_no_error(suite, 'capitals, tabs, carriage returns and two solids are read', error)
      call check(suite, 'the two solids share their common vertices', size(x, 2) == 4 .and. &
         size(tri, 2) == 2)
   end subroutine spellings

   !> Corners within the distance are one vertex, wherever they stand; others are not.
   subroutine merging()
      real(wp) :: corner(3, 6)
      real(wp), parameter :: distance = 1.0e-3_wp
      logical :: one, two
      integer :: i

      one = .true.
      two = .true.
      do i = 1, 300
         corner(:, 1:3) = reshape([0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
            1.0_wp, 1.0_wp], [3, 3])
         corner(:, 4:6) = corner(:, 1:3)
         corner(:, 3) = 0.5_wp + 0.4_wp*sin([1.3_wp, 2.9_wp, 4.1_wp]*real(i, wp))
         corner(:, 6) = corner(:, 3) + 0.57_wp*distance*sin([3.3_wp, 5.9_wp, 7.1_wp]*real(i, wp))
         call merge_corners(corner, distance, x, tri)
         one = one .and. size(x, 2) == 3 .and. all(tri(:, 1) == tri(:, 2))
         corner(1, 6) = corner(1, 3) + 1.001_wp*distance
         call merge_corners(corner, distance, x, tri)
         two = two .and. size(x, 2) == 4
      end do
      call check(suite, 'corners within the distance become one vertex', one)
      call check(suite, 'corners beyond the distance stay two', two)
      call merge_corners(spread([1.0_wp, 2.0_wp, 3.0_wp], 2, 3), 0.0_wp, x, tri)
      call check(suite, 'corners at one place are one vertex', size(x, 2) == 1)
   end subroutine merging

   subroutine broken_stl()
      real(wp) :: corners(3, 3)

      call read_crack_file('nowhere.stl', 'mm', x, tri, error)
      call check_error(suite, 'a missing STL file is named', error, 'nowhere.stl: no such file')
      call write_binary(corners_of_disc(), size(disc_tri, 2), 1)
      call check_error(suite, 'a binary STL file cut short is refused', error, 'crack.stl')
      call write_binary(corners_of_disc(), size(disc_tri, 2) + 1, 0)
      call check_error(suite, 'a wrong number of facets is refused', error, 'no whole binary STL')
      call write_binary(corners_of_disc(), 0, size(disc_tri, 2))
      call check_error(suite, 'a file without facets is refused', error, 'there are no facets')
      corners = reshape([0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], &
         [3, 3])
      call write_infinite(corners)
      call check_error(suite, 'an infinite coordinate is refused', error, &
         'facet 1 has a corner that is not finite')
      call try_text('')
      call check_error(suite, 'an empty file is refused', error, 'there are no facets')
      call try_text('solid a|facet normal 0 0 1|outer loop|vertex 0 0 0|vertex 1 0 0|vertex 0 1 0')
      call check_error(suite, 'an ASCII STL file cut short is refused', error, &
         "'endsolid' is missing")
      call try_text('solid a|facet normal 0 0 1|outer loop|vertex 0 0 0|vertex 1 0 0|endloop')
      call check_error(suite, 'a facet of two vertices is refused', error, &
         'crack.stl:6: a facet needs three')
      call try_text('solid a|facet normal 0 0 1|outer loop|vertex 0 zero 0')
      call check_error(suite, 'a coordinate that is no number is refused', error, &
         "crack.stl:4: 'zero' is not a number")
      call try_text('solid a|vertex 0 1')
      call check_error(suite, 'a vertex of two numbers is refused', error, 'a vertex needs three')
      call try_text('solid a|vertices 0 1')
      call check_error(suite, 'an unknown word is refused', error, "'vertices' is no word")
      call try_text('facet normal 0 0 1')
      call check_error(suite, 'a file without solid is refused', error, "starts with 'solid'")
   end subroutine broken_stl

   subroutine write_infinite(corners)
      real(wp), intent(in) :: corners(3, 3)
      integer :: unit
      integer(int8) :: title(80)

      title = 32
      open (newunit=unit, file='crack.stl', access='stream', form='unformatted', status='replace')
      write (unit) title, 1_int32, real(corners, real32), 0.0_real32, 0.0_real32, &
         2139095040_int32, 0_int16
      close (unit)
      call read_crack_file('crack.stl', 'mm', x, tri, error)
   end subroutine write_infinite

   subroutine broken_hdf5()
      integer(i8) :: wrong(3, 1)
      real(wp) :: vertices(3, 3)

      vertices = reshape([0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, &
         0.0_wp], [3, 3])
      wrong(:, 1) = [0_i8, 1_i8, 3_i8]
      call read_crack_file('nowhere.h5', 'mm', x, tri, error)
      call check_error(suite, 'a missing HDF5 file is named', error, 'nowhere.h5')
      call write_hdf5('xmpm3d particles', 1_i8, 'mm', vertices, wrong)
      call check_error(suite, 'another format is refused', error, "instead of 'xmpm3d crack'")
      call write_hdf5('xmpm3d crack', 2_i8, 'mm', vertices, wrong)
      call check_error(suite, 'another version is refused', error, 'reads version 1')
      call write_hdf5('xmpm3d crack', 1_i8, 'm', vertices, wrong)
      call check_error(suite, 'another unit is refused', error, 'nothing is converted')
      call write_hdf5('xmpm3d crack', 1_i8, 'mm', vertices, wrong)
      call check_error(suite, 'an unknown vertex is refused', error, 'triangles[0] names a vertex')
      call write_hdf5('xmpm3d crack', 1_i8, 'mm', vertices(:2, :), wrong)
      call check_error(suite, 'vertices of two coordinates are refused', error, &
         'vertices must have rows of three')
      vertices(2, 2) = ieee_value(1.0_wp, ieee_quiet_nan)
      call write_hdf5('xmpm3d crack', 1_i8, 'mm', vertices, wrong)
      call check_error(suite, 'a vertex that is no number is refused', error, &
         'vertices[1] is not finite')
      vertices(2, 2) = 0
      wrong(3, 1) = -1
      call write_hdf5('xmpm3d crack', 1_i8, 'mm', vertices, wrong)
      call check_error(suite, 'a negative vertex is refused', error, 'vertices are 0 to 2')
   end subroutine broken_hdf5
end program test_crack_file
