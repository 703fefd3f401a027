# Parallel HDF5 with its Fortran modules: the target ParallelHDF5::Fortran.
#
# CMake's own FindHDF5 asks compiler wrappers, and on Debian takes the serial library where both
# are installed. Here the place of hdf5.mod decides, and a small program proves that the library
# is parallel. HDF5_ROOT (variable or environment) points to an installation elsewhere.

find_package(PkgConfig QUIET)
if(PkgConfig_FOUND)
   pkg_check_modules(hdf5_hint QUIET hdf5-openmpi)
   if(NOT hdf5_hint_FOUND)
      pkg_check_modules(hdf5_hint QUIET hdf5-mpich)
   endif()
endif()

set(roots ${HDF5_ROOT} $ENV{HDF5_ROOT})
set(flavours openmpi mpich)
list(TRANSFORM flavours PREPEND "hdf5/" OUTPUT_VARIABLE folders)

find_path(ParallelHDF5_INCLUDE_DIR hdf5.mod
   HINTS ${roots} ${hdf5_hint_INCLUDE_DIRS}
   PATHS /usr/include /usr/local/include /usr/lib64/gfortran/modules
   PATH_SUFFIXES ${folders} include include/static include/shared mod)
set(library_hints ${roots} ${hdf5_hint_LIBRARY_DIRS})
set(library_folders ${folders} lib lib64)
find_library(ParallelHDF5_FORTRAN_LIBRARY hdf5_fortran
   HINTS ${library_hints} PATH_SUFFIXES ${library_folders})
find_library(ParallelHDF5_C_LIBRARY hdf5
   HINTS ${library_hints} PATH_SUFFIXES ${library_folders})

if(ParallelHDF5_INCLUDE_DIR AND ParallelHDF5_FORTRAN_LIBRARY AND ParallelHDF5_C_LIBRARY)
   set(probe ${CMAKE_BINARY_DIR}/CMakeFiles/parallel_hdf5.f90)
   file(WRITE ${probe} "program probe\n use hdf5\n use mpi\n integer(hid_t) :: list\n integer :: e\n"
      " call h5pset_fapl_mpio_f(list, MPI_COMM_WORLD, MPI_INFO_NULL, e)\nend program probe\n")
   try_compile(ParallelHDF5_WORKS ${CMAKE_BINARY_DIR}/CMakeFiles/parallel_hdf5 ${probe}
      CMAKE_FLAGS -DINCLUDE_DIRECTORIES=${ParallelHDF5_INCLUDE_DIR}
      LINK_LIBRARIES ${ParallelHDF5_FORTRAN_LIBRARY} ${ParallelHDF5_C_LIBRARY} MPI::MPI_Fortran
      OUTPUT_VARIABLE probe_output)
   if(NOT ParallelHDF5_WORKS)
      message(STATUS "No parallel HDF5 for this compiler and MPI:\n${probe_output}")
   endif()
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(ParallelHDF5
   REQUIRED_VARS ParallelHDF5_FORTRAN_LIBRARY ParallelHDF5_C_LIBRARY
   ParallelHDF5_INCLUDE_DIR ParallelHDF5_WORKS
   REASON_FAILURE_MESSAGE "On Debian: apt-get install libhdf5-openmpi-dev")

if(ParallelHDF5_FOUND AND NOT TARGET ParallelHDF5::Fortran)
   add_library(ParallelHDF5::Fortran INTERFACE IMPORTED)
   set_target_properties(ParallelHDF5::Fortran PROPERTIES
      INTERFACE_INCLUDE_DIRECTORIES ${ParallelHDF5_INCLUDE_DIR}
      INTERFACE_LINK_LIBRARIES "${ParallelHDF5_FORTRAN_LIBRARY};${ParallelHDF5_C_LIBRARY}")
endif()
