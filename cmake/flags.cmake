# Compiler flags, each with its reason. The target xmpm_flags carries them to the library, the
# program and the tests; CMAKE_Fortran_FLAGS stays free for the user's own.

# CMake's own ideas of a release and a debug build are not used.
set(CMAKE_Fortran_FLAGS_RELEASE "")
set(CMAKE_Fortran_FLAGS_DEBUG "")

# The language is Fortran 2008, and every warning that gfortran 12 gives without noise is on.
set(warnings
   # `implicit none` also where a module's own does not reach: in interface bodies.
   -fimplicit-none
   -std=f2008 -pedantic -Wall -Wextra -Wimplicit-interface -Wimplicit-procedure -Wconversion-extra)
if(XMPM_STRICT)
   list(APPEND warnings -Werror)
endif()

# Release. No -Ofast and no -ffast-math: checks for NaN and the agreement of ranks rely on IEEE rules.
set(release
   -O3
   # At -O3 gfortran 12 takes the bounds of arrays that are allocated by assignment for variables
   # that were never set. The debug build keeps these two warnings, and tests/run.sh makes both.
   -Wno-uninitialized
   -Wno-maybe-uninitialized
   # sqrt and friends need not set errno, which Fortran cannot read: they become instructions.
   -fno-math-errno
   # No code here unmasks floating point traps, so comparisons in lane loops may be made
   # branch-free. The gradient pass is twice as fast.
   -fno-trapping-math
   # a*b + c in one rounding where the processor can: faster and closer to the exact value.
   -ffp-contract=fast
   # Unroll-and-jam at -O3 interleaves two particles, runs out of registers and spills (8 %).
   -fno-loop-unroll-and-jam
   # Honour the `!$omp simd` of the kernels; no OpenMP library and no threads (15 %).
   -fopenmp-simd)

# Native, never the packaged default: the program then runs on this kind of processor only.
set(native
   -march=native
   # Use 512-bit registers where there are any: gcc prefers 256 by default on some processors.
   -mprefer-vector-width=512)

# Debug: optimise without harm to the debugger, check everything, trap the first bad number.
set(debug
   -Og
   -g
   -fbacktrace
   # Bounds, allocation, recursion, do loops, pointers.
   -fcheck=all
   # Reals start as signalling NaN, so that reading one before it is set stops the program.
   -finit-real=snan
   -ffpe-trap=invalid,zero,overflow
   -fopenmp-simd)

# Sanitizers: see freed, aliased and overrun memory that -fcheck=all does not.
set(sanitize -fsanitize=address,undefined -fno-omit-frame-pointer)

# Coverage: counters for gcovr, no inlining that would blur lines.
set(coverage --coverage -O0)

set(chosen)
if(CMAKE_BUILD_TYPE STREQUAL "Debug")
   list(APPEND chosen ${debug})
else()
   list(APPEND chosen ${release})
endif()
if(XMPM_NATIVE)
   list(APPEND chosen ${native})
endif()
if(XMPM_SANITIZE)
   # METIS, MPI and HDF5 raise harmless floating point flags of their own under the sanitizers.
   list(REMOVE_ITEM chosen -ffpe-trap=invalid,zero,overflow)
   list(APPEND chosen ${sanitize})
endif()
if(XMPM_COVERAGE)
   list(APPEND chosen ${coverage})
endif()

add_library(xmpm_flags INTERFACE)
foreach(flag IN LISTS warnings chosen)
   target_compile_options(xmpm_flags INTERFACE $<$<COMPILE_LANGUAGE:Fortran>:${flag}>)
endforeach()
if(XMPM_SANITIZE)
   target_link_options(xmpm_flags INTERFACE ${sanitize})
endif()
if(XMPM_COVERAGE)
   target_link_options(xmpm_flags INTERFACE --coverage)
endif()

# The text that the program shows with --version.
list(JOIN chosen " " xmpm_flags_text)
string(STRIP "${CMAKE_Fortran_FLAGS} ${xmpm_flags_text}" xmpm_flags_text)
