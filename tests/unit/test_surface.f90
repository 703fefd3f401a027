program test_surface
end program test_surface
