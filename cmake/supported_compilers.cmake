# SPDX-License-Identifier: BSD-3-Clause

# Stops with one sentence if the compiler is not one that compiles this project. Older ones do
# not know a construct that the code uses; what others do nobody has tried.
set(oldest_GNU 11)
set(oldest_Clang 14)
set(oldest ${oldest_${CMAKE_CXX_COMPILER_ID}})
if(NOT oldest OR CMAKE_CXX_COMPILER_VERSION VERSION_LESS oldest)
  message(
    FATAL_ERROR
      "fcl_ccd needs g++ ${oldest_GNU} or clang++ ${oldest_Clang} or later, not "
      "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}: set CMAKE_CXX_COMPILER")
endif()
