# SPDX-License-Identifier: BSD-3-Clause

# The files with FCL's names: the CMake package "fcl", fcl.pc, libfcl.so and libfcl.a. A prefix
# without stock FCL has them where a program looks below that prefix. In a prefix with stock FCL
# they would replace its files, so there is a prefix inside of it: lib/fcl-ccd. Both kinds are
# prepared; which one is installed is decided then, since `cmake --install --prefix` may change
# the prefix. An installation that is staged with DESTDIR is checked in both places, since it
# ends in the prefix. FCL_CCD_DOORS decides where a package is made that ends in another prefix.
set(nested lib/fcl-ccd)
set(FCL_CCD_DOORS auto CACHE STRING "Files with FCL's names: auto, own or nested")
set_property(CACHE FCL_CCD_DOORS PROPERTY STRINGS auto own nested)
if(NOT FCL_CCD_DOORS MATCHES "^(auto|own|nested)$")
  message(FATAL_ERROR "FCL_CCD_DOORS is ${FCL_CCD_DOORS}. It can be auto, own or nested")
endif()
foreach(folder CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR)
  if(IS_ABSOLUTE ${${folder}})
    message(FATAL_ERROR "${folder} is ${${folder}}. Give a folder relative to the prefix")
  endif()
endforeach()

install(
  CODE "set(include_dir \"${CMAKE_INSTALL_INCLUDEDIR}\")
  set(doors \"${FCL_CCD_DOORS}\")
  set(searched_dirs \"${CMAKE_CXX_IMPLICIT_INCLUDE_DIRECTORIES}\")
  set(nested_doors \"${nested}\")"
  ALL_COMPONENTS)
install(
  CODE [[
  set(own_doors TRUE)
  foreach(place IN ITEMS "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}" "${CMAKE_INSTALL_PREFIX}")
    if(EXISTS "${place}/${include_dir}/fcl/config.h")
      set(own_doors FALSE)
    endif()
  endforeach()
  if(NOT doors STREQUAL "auto")
    string(COMPARE EQUAL "${doors}" "own" own_doors)
  endif()
  set(own_include FALSE)
  list(FIND searched_dirs "${CMAKE_INSTALL_PREFIX}/${include_dir}" place)
  if(own_doors AND place EQUAL -1)
    set(own_include TRUE)
  endif()
  if(NOT own_doors)
    message(STATUS "The prefix is for stock FCL too. find_package(fcl_ccd) and "
                   "fcl_ccd.pc extend it; the doors with FCL's names are in "
                   "${CMAKE_INSTALL_PREFIX}/${nested_doors}")
  endif()
]] ALL_COMPONENTS)

# fcl_ccd_door(KIND FILE FOLDER): installs a file into a folder below the prefix of the doors if
# that is KIND, own or nested.
function(fcl_ccd_door kind file folder)
  set(condition "own_doors")
  if(kind STREQUAL "nested")
    set(condition "NOT own_doors")
    set(folder ${nested}/${folder})
  endif()
  install(CODE "if(${condition})
    file(INSTALL \"${file}\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${folder}\")
  endif()")
endfunction()

# fcl_ccd_link(PATH TARGET): a symbolic link in the build folder, to be installed.
function(fcl_ccd_link path target)
  cmake_path(GET path PARENT_PATH folder)
  file(MAKE_DIRECTORY ${folder})
  file(CREATE_LINK ${target} ${path} SYMBOLIC)
endfunction()

# The version of the package is that of the FCL that it extends, with FCL's own rule.
write_basic_package_version_file(
  ${CMAKE_CURRENT_BINARY_DIR}/basic-version.cmake
  VERSION ${fcl_VERSION}
  COMPATIBILITY AnyNewerVersion)
file(READ ${CMAKE_CURRENT_BINARY_DIR}/basic-version.cmake FCL_CCD_BASIC_VERSION)
configure_file(${CMAKE_CURRENT_LIST_DIR}/fcl-config-version.cmake.in
               ${CMAKE_CURRENT_BINARY_DIR}/fcl-config-version.cmake @ONLY)

# The flag -lfcl and CMake's find_library(fcl) must mean both libraries. With a static library a
# linker script in the place of an archive, libfcl.a, names them. With a shared one the script is
# for who names this file. All others find libfcl.so: a linker script would do for -lfcl, but a
# program that loads "libfcl.so" at run time would fail, and CMake gives a program the folder of
# the library at run time only if it ends in ".so". The linker searches the folder of the script
# for the library first.
set(linked_file $<TARGET_FILE_NAME:fcl_ccd>)
if(library_type STREQUAL "SHARED_LIBRARY")
  # The linker leaves the library out if the program calls nothing of it.
  set(linked_file "AS_NEEDED ( $<TARGET_LINKER_FILE_NAME:fcl_ccd> )")
endif()
set(script ${CMAKE_CURRENT_BINARY_DIR}/$<CONFIG>/libfcl.a)
file(
  GENERATE
  OUTPUT ${script}
  CONTENT "/* GNU ld script: FCL as extended by fcl_ccd */
GROUP ( ${linked_file} $<TARGET_FILE_DIR:fcl>/$<TARGET_SONAME_FILE_NAME:fcl>${FCL_CCD_PRIVATE_LIBS} )
")

set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(linked_libraries libfcl_ccd.a)
if(library_type STREQUAL "SHARED_LIBRARY")
  set(linked_libraries libfcl_ccd.so libfcl_ccd.so.${soversion})
endif()
set(has_link_library FALSE)
if(library_type STREQUAL "SHARED_LIBRARY" AND UNIX AND NOT APPLE)
  set(has_link_library TRUE)
  include(${CMAKE_CURRENT_LIST_DIR}/link_library.cmake)
  list(APPEND linked_libraries libfcl_with_ccd.so.${soversion})
endif()

foreach(kind IN ITEMS own nested)
  set(built ${CMAKE_CURRENT_BINARY_DIR}/doors/${kind})
  set(libdir ${CMAKE_INSTALL_LIBDIR})
  set(place /${libdir})
  if(kind STREQUAL "nested")
    set(libdir lib)
    set(place /${nested}/lib)
  endif()

  file(RELATIVE_PATH FCL_CCD_DOOR_TO_PACKAGE ${place}/cmake/fcl /${package_dir})
  configure_file(${CMAKE_CURRENT_LIST_DIR}/fcl-config.cmake.in ${built}/fcl-config.cmake @ONLY)
  fcl_ccd_door(${kind} ${built}/fcl-config.cmake ${libdir}/cmake/fcl)
  fcl_ccd_door(${kind} ${CMAKE_CURRENT_BINARY_DIR}/fcl-config-version.cmake ${libdir}/cmake/fcl)

  fcl_ccd_pkg_config(fcl ${place} ${built}/fcl.pc)
  fcl_ccd_door(${kind} ${built}/fcl.pc ${libdir}/pkgconfig)

  fcl_ccd_door(${kind} ${script} ${libdir})
  file(RELATIVE_PATH to_libraries ${place} /${CMAKE_INSTALL_LIBDIR})
  if(to_libraries MATCHES "[^/]$")
    string(APPEND to_libraries "/")
  endif()
  if(has_link_library)
    fcl_ccd_link(${built}/libfcl.so "${to_libraries}libfcl_with_ccd.so.${soversion}")
    fcl_ccd_door(${kind} ${built}/libfcl.so ${libdir})
  endif()
  if(kind STREQUAL "nested")
    foreach(library IN LISTS linked_libraries)
      fcl_ccd_link(${built}/${library} ${to_libraries}${library})
      fcl_ccd_door(${kind} ${built}/${library} ${libdir})
    endforeach()
    file(RELATIVE_PATH to_headers /${nested} /${CMAKE_INSTALL_INCLUDEDIR}/fcl_ccd)
    fcl_ccd_link(${built}/include ${to_headers})
    fcl_ccd_door(${kind} ${built}/include ".")
  endif()
endforeach()

# A program that names PREFIX/include finds the headers there, too. Not where the compiler searches
# for headers without a flag, as in /usr/local/include: its linker searches the folder of stock
# FCL's library before /usr/local/lib, so `g++ -lfcl` would compile with the headers of this
# package and link stock FCL only. There `g++ -lfcl` is stock FCL.
fcl_ccd_link(${CMAKE_CURRENT_BINARY_DIR}/doors/headers/fcl fcl_ccd/fcl)
install(
  CODE "set(header_link \"${CMAKE_CURRENT_BINARY_DIR}/doors/headers/fcl\")"
  CODE [[
  if(own_include)
    set(headers "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/${include_dir}/fcl")
    if(EXISTS "${headers}" AND NOT IS_SYMLINK "${headers}")
      message(WARNING "${headers} is a folder already, so it does not become a link to the headers. "
                      "If it is of an earlier version of this package, delete it and install again")
    else()
      file(INSTALL "${header_link}" DESTINATION "${CMAKE_INSTALL_PREFIX}/${include_dir}")
    endif()
  endif()
]])
