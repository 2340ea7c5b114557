# SPDX-License-Identifier: BSD-3-Clause

# Where headers go, decided when they are installed, since `cmake --install --prefix` may change
# the prefix.
#
# A prefix with stock FCL is refused, before anything is installed. A header of this package
# includes the stock header of the same name, so it must not replace it. An installation that is
# staged with DESTDIR is checked in both places, since it ends in the prefix.
#
# The compiler searches some folders for headers without a flag, /usr/local/include among them.
# Its linker searches the folder of stock FCL's library before /usr/local/lib. So `g++ -lfcl`
# would compile with the headers of this package and link stock FCL only. In such a prefix the
# headers have a folder of their own: `g++ -lfcl` is stock FCL, and the doors that name the
# prefix lead to this package.
install(
  CODE "set(include_dir \"${CMAKE_INSTALL_INCLUDEDIR}\")
  set(header_dir \"${CMAKE_INSTALL_INCLUDEDIR}\")
  set(searched_dirs \"${CMAKE_CXX_IMPLICIT_INCLUDE_DIRECTORIES}\")"
  ALL_COMPONENTS)
install(
  CODE [[
  cmake_path(ABSOLUTE_PATH include_dir BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}" NORMALIZE)
  foreach(place IN ITEMS "$ENV{DESTDIR}${include_dir}" "${include_dir}")
    if(EXISTS "${place}/fcl/config.h")
      message(FATAL_ERROR
              "Stock FCL is installed in ${place}, and some of its files would be overwritten. This "
              "package needs a prefix without stock FCL, for example\n"
              "  cmake --install BUILD_FOLDER --prefix $ENV{HOME}/.local/fcl-ccd")
    endif()
  endforeach()
  set(fcl_ccd_header_subdir "")
  list(FIND searched_dirs "${include_dir}" place)
  if(NOT place EQUAL -1)
    set(fcl_ccd_header_subdir "/fcl-ccd")
    message(STATUS "The compiler searches ${include_dir} by itself, so headers go to "
                   "${include_dir}/fcl-ccd. Compile by find_package(fcl) or pkg-config, or with "
                   "-I ${include_dir}/fcl-ccd")
  endif()
  set(fcl_ccd_header_dir "${header_dir}${fcl_ccd_header_subdir}")
]] ALL_COMPONENTS)
