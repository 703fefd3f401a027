# The module xmpm_build_info: what --version and the header of every log say about the program.
# Included by CMakeLists.txt it sets up a target that runs this same file as a script at each
# build, because a commit changes without a new configuration; the module is written only when its
# text changes.

if(NOT CMAKE_SCRIPT_MODE_FILE)
   set(build_info_source ${CMAKE_BINARY_DIR}/build_info.f90)
   set(XMPM_COMPILER "${CMAKE_Fortran_COMPILER_ID} ${CMAKE_Fortran_COMPILER_VERSION}")
   # A Fortran line ends at 132 columns.
   string(REGEX REPLACE "(.................................................................)"
      "\\1&\n      \&" XMPM_FLAGS "${xmpm_flags_text}")
   configure_file(${CMAKE_SOURCE_DIR}/cmake/build_info.f90.in
      ${CMAKE_BINARY_DIR}/build_info.f90.in @ONLY)
   add_custom_target(build_info
      COMMAND ${CMAKE_COMMAND} -D SOURCE=${CMAKE_SOURCE_DIR} -D BINARY=${CMAKE_BINARY_DIR}
         -P ${CMAKE_CURRENT_LIST_FILE}
      BYPRODUCTS ${build_info_source}
      COMMENT "Asking git for the commit" VERBATIM)
   return()
endif()

find_program(git git)
set(hash)
if(git)
   execute_process(COMMAND ${git} describe --always --dirty --abbrev=12 --exclude=*
      WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE hash ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
if(NOT hash)
   set(hash unknown)
endif()
set(XMPM_GIT_HASH ${hash})
file(READ ${BINARY}/build_info.f90.in text)
string(REPLACE "%GIT_HASH%" "${XMPM_GIT_HASH}" text "${text}")
set(old)
if(EXISTS ${BINARY}/build_info.f90)
   file(READ ${BINARY}/build_info.f90 old)
endif()
if(NOT text STREQUAL old)
   file(WRITE ${BINARY}/build_info.f90 "${text}")
endif()
