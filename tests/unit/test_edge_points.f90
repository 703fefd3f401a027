!> Which points of a front the particles near an edge can count for.
program test_edge_points
   use xmpm_kinds, only: wp
   use xmpm_crack, only: crack_t
   use xmpm_front_points, only: front_points_t, list_points
   use xmpm_edge_points, only: edge_points_t, list_edge_points
   use exact_cracks, only: make_penny, make_straight
   use testing, only: suite_t, check, finish
   implicit none
   type(suite_t) :: suite

   suite%name = 'edge_points'
   call open_front()
   call closed_front()
   call finish(suite)

contains

   !> A straight front with a node a unit: those within reach of the ends of each edge.
   subroutine open_front()
      type(crack_t) :: crack
      type(front_points_t) :: points
      type(edge_points_t), allocatable :: near(:)
      integer :: edge, m, wrong

      call make_straight([0.0_wp, 0.0_wp, 0.0_wp], 4.0_wp, 10.0_wp, 1.0_wp, crack)
      call list_points(crack, points)
      call list_edge_points(crack%front, points, 2.5_wp, near)
      wrong = 0
      associate (f => crack%front)
         do edge = 1, f%edge_count
            do m = 1, points%n
               if (any(near(edge)%point == m) .neqv. minval(abs(points%x(2, m) &
                  - f%x(2, f%edge_node(:, edge)))) <= 2.5_wp) wrong = wrong + 1
            end do
         end do
         call check(suite, 'points within reach of an edge are listed, others are not', wrong == 0)
         call check(suite, 'an inner edge has two beyond each of its ends', &
            maxval([(size(near(edge)%point), edge=1, f%edge_count)]) == 6)
      end associate
   end subroutine open_front

   !> A rim: each point once, however far the reach goes, and no more than there are within it.
   subroutine closed_front()
      type(crack_t) :: crack
      type(front_points_t) :: points
      type(edge_points_t), allocatable :: near(:)
      integer :: edge, m, twice, n

      call make_penny([0.0_wp, 0.0_wp, 0.0_wp], 4.0_wp, 1.0_wp, crack)
      call list_points(crack, points)
      call list_edge_points(crack%front, points, 99.0_wp, near)
      twice = 0
      do edge = 1, crack%front%edge_count
         do m = 1, points%n
            if (count(near(edge)%point == m) /= 1) twice = twice + 1
         end do
      end do
      call check(suite, 'a reach over the whole rim lists every point once', twice == 0)
      call list_edge_points(crack%front, points, 3.0_wp, near)
      n = size(near(1)%point)
      call check(suite, 'all edges of a rim have as many', &
         all([(size(near(edge)%point) == n, edge=1, size(near))]))
      call check(suite, 'and not all of them', n > 2 .and. n < points%n)
   end subroutine closed_front
end program test_edge_points
