# SPDX-License-Identifier: BSD-3-Clause

# A prefix with stock FCL is refused, before anything is installed. A header of this package
# includes the stock header of the same name, so it must not replace it. An installation that is
# staged with DESTDIR is checked in both places, since it ends in the prefix.
install(CODE "set(include_dir \"${CMAKE_INSTALL_INCLUDEDIR}\")" ALL_COMPONENTS)
install(
  CODE [[
  cmake_path(ABSOLUTE_PATH include_dir BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}")
  foreach(place IN ITEMS "$ENV{DESTDIR}${include_dir}" "${include_dir}")
    if(EXISTS "${place}/fcl/config.h")
      message(FATAL_ERROR
              "Stock FCL is installed in ${place}, and some of its files would be overwritten. This "
              "package needs a prefix without stock FCL, for example\n"
              "  cmake --install BUILD_FOLDER --prefix $ENV{HOME}/.local/fcl-ccd")
    endif()
  endforeach()
]] ALL_COMPONENTS)
