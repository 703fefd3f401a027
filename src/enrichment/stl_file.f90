!> Triangles from STL files, ASCII or binary, with equal corners made one vertex.
module xmpm_stl_file
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: int8, int32, real32, iostat_end
   use xmpm_kinds, only: wp, i8
   use xmpm_error, only: error_t, raise, code_files
   use xmpm_text, only: to_text, lower
   use xmpm_numbers, only: parse_real, number_good
   use xmpm_hash_map, only: hash_map_t, clear_map, set_value, value_of
   implicit none
   private

   public :: read_stl, merge_corners

   integer, parameter :: head = 84   !! bytes before the first facet of a binary file
   integer, parameter :: facet = 50   !! bytes of a facet: normal, three corners, two bytes of
                                      !! attribute
   integer, parameter :: line_length = 400   !! characters of a line in an ASCII file that are read
   real(wp), parameter :: equal = 1.0e-6_wp   !! distance of equal corners over the extent of the
                                              !! file

contains

   !> Read the triangles of an STL file; corners nearer than 1e-6 of its extent are one vertex.
   subroutine read_stl(path, x, tri, error)
      character(len=*), intent(in) :: path               !! of the file
      real(wp), allocatable, intent(out) :: x(:, :)      !! (3,nv) vertices [length]
      integer, allocatable, intent(out) :: tri(:, :)   !! (3,nt) triangles in the order of the file
      type(error_t), allocatable, intent(out) :: error   !! missing, broken, or not STL
      real(wp), allocatable :: corner(:, :)
      real(wp) :: extent
      integer(i8) :: bytes
      integer :: n, i

      inquire (file=path, size=bytes)
      if (bytes < 0) then
         call raise(error, code_files, path//': no such file')
         return
      end if
      call facets_of_binary(path, bytes, n)
      if (n >= 0) then
         call read_binary(path, n, corner, error)
      else
         call read_ascii(path, corner, error)
      end if
      if (allocated(error)) return
      if (size(corner, 2) == 0) then
         call raise(error, code_files, path//': there are no facets')
         return
      end if
      do i = 1, size(corner, 2)
         if (all(ieee_is_finite(corner(:, i)))) cycle
         call raise(error, code_files, path//': facet '//to_text((i + 2)/3)// &
            ' has a corner that is not finite')
         return
      end do
      extent = maxval(maxval(corner, 2) - minval(corner, 2))
      call merge_corners(corner, equal*extent, x, tri)
   end subroutine read_stl

   !> Number of facets of a binary file, which its size confirms; -1 where it is none.
   subroutine facets_of_binary(path, bytes, n)
      character(len=*), intent(in) :: path
      integer(i8), intent(in) :: bytes
      integer, intent(out) :: n
      integer :: unit, status
      integer(int8) :: title(80)
      integer(int32) :: count

      n = -1
      if (bytes < head) return
      open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
         action='read', iostat=status)
      if (status /= 0) return
      read (unit, iostat=status) title, count
      close (unit)
      if (status == 0 .and. count >= 0 .and. bytes == head + facet*int(count, i8)) n = count
   end subroutine facets_of_binary

   !> Corners of a binary file, three a facet.
   subroutine read_binary(path, n, corner, error)
      character(len=*), intent(in) :: path
      integer, intent(in) :: n
      real(wp), allocatable, intent(out) :: corner(:, :)
      type(error_t), allocatable, intent(out) :: error
      integer(int8) :: start(head), rest(2)
      real(real32) :: numbers(3, 4)
      integer :: unit, status, t

      allocate (corner(3, 3*n))
      open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
         action='read', iostat=status)
      if (status == 0) read (unit, iostat=status) start
      do t = 1, n
         if (status == 0) read (unit, iostat=status) numbers, rest
         if (status == 0) corner(:, 3*t - 2:3*t) = real(numbers(:, 2:4), wp)
      end do
      if (status /= 0) call raise(error, code_files, path//': cannot be read')
      close (unit)
   end subroutine read_binary

   !> Corners of an ASCII file: its lines `vertex x y z`, three between `outer loop` and `endloop`.
   subroutine read_ascii(path, corner, error)
      character(len=*), intent(in) :: path
      real(wp), allocatable, intent(out) :: corner(:, :)
      type(error_t), allocatable, intent(out) :: error
      character(len=line_length) :: line
      character(len=:), allocatable :: word
      integer :: unit, status, number, n
      logical :: open_solid

      allocate (corner(3, 30), source=0.0_wp)
      open (newunit=unit, file=path, status='old', action='read', iostat=status)
      if (status /= 0) call raise(error, code_files, path//': cannot be read')
      n = 0
      number = 0
      open_solid = .false.
      do while (status == 0 .and. .not. allocated(error))
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         number = number + 1
         call take_word(line, word)
         select case (word)
         case ('solid')
            open_solid = .true.
         case ('endsolid')
            open_solid = .false.
         case ('vertex')
            call take_corner(line, n, corner, error)
         case ('endloop')
            if (modulo(n, 3) /= 0) call raise(error, code_files, 'a facet needs three vertices')
         case ('', 'facet', 'outer', 'endfacet')
         case default
            call raise(error, code_files, "'"//word//"' is no word of an ASCII STL file")
         end select
         if (.not. open_solid .and. n == 0 .and. word /= '' .and. .not. allocated(error)) then
            call raise(error, code_files, "an ASCII STL file starts with 'solid'")
         end if
      end do
      if (allocated(error)) then
         error%message = path//':'//to_text(number)//': '//error%message// &
            '; the file is no whole binary STL either'
      else if (status /= iostat_end .or. open_solid .or. modulo(n, 3) /= 0) then
         call raise(error, code_files, path//": the file is cut short: 'endsolid' is missing")
      end if
      close (unit)
      corner = corner(:, :n)
   end subroutine read_ascii

   !> Take the first word off a line, in lower case.
   pure subroutine take_word(line, word)
      character(len=line_length), intent(inout) :: line
      character(len=:), allocatable, intent(out) :: word
      integer :: i, last

      do i = 1, len(line)
         if (iachar(line(i:i)) < 32) line(i:i) = ' '
      end do
      line = adjustl(line)
      last = index(line//' ', ' ') - 1
      word = lower(line(:last))
      line = line(last + 1:)
   end subroutine take_word

   !> Append the corner that a line holds behind its keyword.
   subroutine take_corner(line, n, corner, error)
      character(len=line_length), intent(inout) :: line
      integer, intent(inout) :: n
      real(wp), allocatable, intent(inout) :: corner(:, :)
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: word
      real(wp), allocatable :: longer(:, :)
      integer :: k, status

      if (n == size(corner, 2)) then
         allocate (longer(3, 2*n), source=0.0_wp)
         longer(:, :n) = corner
         call move_alloc(longer, corner)
      end if
      n = n + 1
      do k = 1, 3
         call take_word(line, word)
         call parse_real(word, corner(k, n), status)
         if (status == number_good) cycle
         call raise(error, code_files, "'"//word//"' is not a number; a vertex needs three")
         return
      end do
   end subroutine take_corner

   !> Number the corners of triangles, those within a distance of each other as one vertex.
   subroutine merge_corners(corner, distance, x, tri)
      real(wp), intent(in) :: corner(:, :)   !! (3,3 nt) corners, three a triangle [length]
      real(wp), intent(in) :: distance                 !! up to which corners are equal [length]
      real(wp), allocatable, intent(out) :: x(:, :)   !! (3,nv) vertices, each the first of its
                                                      !! corners [length]
      integer, allocatable, intent(out) :: tri(:, :)   !! (3,nt) vertices of the triangles
      type(hash_map_t) :: map
      integer :: next(size(corner, 2)), n, i, v
      integer(i8) :: place(3)
      real(wp) :: low(3), cell

      allocate (x(3, size(corner, 2)), tri(3, size(corner, 2)/3))
      low = minval(corner, 2)
      cell = max(2.0_wp*distance, tiny(1.0_wp))
      call clear_map(map, size(corner, 2))
      n = 0
      do i = 1, size(corner, 2)
         place = int((corner(:, i) - low)/cell, i8)
         v = same_vertex(map, next, x, corner(:, i), place, distance)
         if (v == 0) then
            n = n + 1
            v = n
            x(:, n) = corner(:, i)
            next(n) = value_of(map, key_of(place), 0)
            call set_value(map, key_of(place), n)
         end if
         tri(modulo(i - 1, 3) + 1, (i + 2)/3) = v
      end do
      x = x(:, :n)
   end subroutine merge_corners

   !> The vertex within a distance of a point, in its cell and those around; 0 where there is none.
   pure function same_vertex(map, next, x, p, place, distance) result(v)
      type(hash_map_t), intent(in) :: map
      integer, intent(in) :: next(:)
      real(wp), intent(in) :: x(:, :), p(3), distance
      integer(i8), intent(in) :: place(3)
      integer :: v, i, j, k

      do k = -1, 1
         do j = -1, 1
            do i = -1, 1
               v = value_of(map, key_of(place + int([i, j, k], i8)), 0)
               do while (v > 0)
                  if (norm2(x(:, v) - p) <= distance) return
                  v = next(v)
               end do
            end do
         end do
      end do
   end function same_vertex

   !> Key of a cell; 2**21 of them along each direction at most.
   pure function key_of(place) result(key)
      integer(i8), intent(in) :: place(3)
      integer(i8) :: key

      key = place(1) + 1 + 2_i8**21*(place(2) + 1 + 2_i8**21*(place(3) + 1))
   end function key_of
end module xmpm_stl_file
