# SPDX-License-Identifier: BSD-3-Clause

# Compile options of everything in this project; none of them reaches a user's target.
function(fcl_ccd_compile_options target)
  # Certified decisions count roundings: no product may be fused into a sum, and each
  # operation is IEEE's, whatever a user asks for in CMAKE_CXX_FLAGS.
  target_compile_options(${target} PRIVATE -fno-fast-math -ffp-contract=off -Wall -Wextra -Wpedantic
                                           -Wconversion)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    # FCL's indices are int, and clang's -Wconversion minds signs; gcc's does not.
    target_compile_options(${target} PRIVATE -Wno-sign-conversion)
  else()
    # False alarms of gcc 12 in what it inlines from FCL, Eigen and Boost.
    target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized)
  endif()
  if(FCL_CCD_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()
