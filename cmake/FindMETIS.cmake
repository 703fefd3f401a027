# METIS through its C interface: the target METIS::METIS and METIS_VERSION.
# METIS_ROOT points to an installation elsewhere.

find_path(METIS_INCLUDE_DIR metis.h)
find_library(METIS_LIBRARY metis)

if(METIS_INCLUDE_DIR)
   file(STRINGS ${METIS_INCLUDE_DIR}/metis.h lines REGEX "^ *#define +(METIS_VER_|IDXTYPEWIDTH)")
   foreach(part MAJOR MINOR SUBMINOR)
      string(REGEX MATCH "METIS_VER_${part}[ \t]+([0-9]+)" found "${lines}")
      list(APPEND numbers ${CMAKE_MATCH_1})
   endforeach()
   list(JOIN numbers "." METIS_VERSION)
   # The interface passes 32-bit integers, as Debian's METIS wants them.
   if(lines MATCHES "IDXTYPEWIDTH[ \t]+64")
      message(FATAL_ERROR "METIS in ${METIS_INCLUDE_DIR} has 64-bit indices; 32-bit is needed.")
   endif()
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(METIS
   REQUIRED_VARS METIS_LIBRARY METIS_INCLUDE_DIR VERSION_VAR METIS_VERSION)

if(METIS_FOUND AND NOT TARGET METIS::METIS)
   add_library(METIS::METIS UNKNOWN IMPORTED)
   set_target_properties(METIS::METIS PROPERTIES IMPORTED_LOCATION ${METIS_LIBRARY})
endif()
