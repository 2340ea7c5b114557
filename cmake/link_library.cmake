# SPDX-License-Identifier: BSD-3-Clause

# The library that -lfcl and find_library(fcl) find in this prefix: libfcl.so. It has the names
# of the functions of FCL and of fcl_ccd for the linker, and is a filter (DT_AUXILIARY) for the
# loader: it loads both libraries, and searches them before it. So no function in it is ever
# called, whether a program was linked with it or loads "libfcl.so" at run time.
set(source ${CMAKE_CURRENT_BINARY_DIR}/link_names.cpp)
add_custom_command(
  OUTPUT ${source}
  COMMAND
    ${CMAKE_COMMAND} -DNM=${CMAKE_NM}
    -DLIBRARIES=$<TARGET_FILE:fcl>,$<TARGET_FILE:fcl_ccd> -DOUTPUT=${source} -P
    ${CMAKE_CURRENT_LIST_DIR}/link_names.cmake
  DEPENDS fcl_ccd ${CMAKE_CURRENT_LIST_DIR}/link_names.cmake
  COMMENT "Names for -lfcl"
  VERBATIM)
add_library(fcl_with_ccd SHARED ${source})
# No language, flags of the build or libraries: names, and what the loader loads. NEEDED besides
# AUXILIARY, so that the loader says which library is not there.
target_compile_options(fcl_with_ccd PRIVATE -w -O0 -g0 -fno-lto -fno-sanitize=all
                                            -fvisibility=default)
target_link_options(
  fcl_with_ccd
  PRIVATE
  -nostdlib
  -fno-lto
  -fno-sanitize=all
  LINKER:--no-as-needed
  LINKER:--strip-all
  LINKER:--auxiliary=$<TARGET_SONAME_FILE_NAME:fcl_ccd>
  LINKER:--auxiliary=$<TARGET_SONAME_FILE_NAME:fcl>)
target_link_libraries(fcl_with_ccd PRIVATE $<TARGET_FILE:fcl_ccd> $<TARGET_FILE:fcl>)
set_target_properties(
  fcl_with_ccd
  PROPERTIES VERSION ${PROJECT_VERSION}
             SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
             CXX_CLANG_TIDY ""
             # Its neighbour, and a stock FCL that is not in a system directory.
             INSTALL_RPATH "$ORIGIN"
             INSTALL_RPATH_USE_LINK_PATH ON)
install(TARGETS fcl_with_ccd LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library
                                     NAMELINK_SKIP)
