# SPDX-License-Identifier: BSD-3-Clause

# Compile options of all targets of this project. None of them reaches a user's target.
function(fcl_ccd_compile_options target)
  # Certified decisions count roundings. So no product may be fused into a sum, and each
  # operation must be an IEEE operation, whatever CMAKE_CXX_FLAGS says.
  target_compile_options(${target} PRIVATE -fno-fast-math -ffp-contract=off -Wall -Wextra -Wpedantic
                                           -Wconversion)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    # FCL's indices are int. clang's -Wconversion warns about signs, gcc's does not.
    target_compile_options(${target} PRIVATE -Wno-sign-conversion)
    # In libstdc++ 12 std::stable_sort() calls a function that is deprecated, of which clang
    # warns from version 17 on.
    if(CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 17)
      target_compile_options(${target} PRIVATE -Wno-deprecated-declarations)
    endif()
  else()
    # gcc 12 gives false alarms in code that it inlines from FCL, Eigen and Boost.
    target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized)
    # gcc 13 and 14 give more of them: of Boost's integers, and of an array of eight elements
    # whose count the compiler does not know.
    if(CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 13)
      target_compile_options(
        ${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow
                          -Wno-aggressive-loop-optimizations)
    endif()
  endif()
  if(FCL_CCD_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# With FCL_CCD_JOIN_SOURCES, the compiler reads several files of a target as one.
function(fcl_ccd_join_sources target)
  if(NOT FCL_CCD_JOIN_SOURCES)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 10)
  # gcc takes each file for a header, whose nameless namespaces would be a fault.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()
