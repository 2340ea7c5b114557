# SPDX-License-Identifier: BSD-3-Clause

# Installs two things. The package "fcl_ccd" shares no file with stock FCL: it can stand beside it
# in one prefix. The doors have FCL's names, so that a program that asks for FCL gets both; their
# place is chosen in cmake/doors.cmake.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/fcl_ccd)

install(
  TARGETS fcl_ccd
  EXPORT fcl_ccd-targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT dev
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
if(TARGET fcl-ccd)
  install(TARGETS fcl-ccd RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tool)
  install(FILES ${PROJECT_SOURCE_DIR}/doc/fcl-ccd.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1
          COMPONENT tool)
  install(
    FILES ${PROJECT_SOURCE_DIR}/src/tools/fcl_ccd/completion.bash
    DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
    RENAME fcl-ccd
    COMPONENT tool)
  # The program contains three.js, unless it was built without the viewer of its pages.
  install(FILES ${FCL_CCD_VIEWER}.LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME LICENSE.three.js
          COMPONENT tool)
endif()
# From here on everything is for those who compile with the library.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME dev)
install(EXPORT fcl_ccd-targets DESTINATION ${package_dir})
# A header of this package includes the stock header of the same name, so it must not replace it.
install(
  DIRECTORY ${PROJECT_SOURCE_DIR}/include/fcl
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fcl_ccd
  FILES_MATCHING
  PATTERN "*.h")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md
              ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/doc ${PROJECT_SOURCE_DIR}/examples
        DESTINATION ${CMAKE_INSTALL_DOCDIR})

# What a program links in addition to the library and FCL: nothing if the library is shared.
set(FCL_CCD_PRIVATE_LIBS "")
set(FCL_CCD_STATIC_PACKAGES "")
get_target_property(library_type fcl_ccd TYPE)
if(NOT library_type STREQUAL "SHARED_LIBRARY")
  if(FCL_CCD_USE_HIGHWAY)
    string(APPEND FCL_CCD_PRIVATE_LIBS " -lhwy")
    list(APPEND FCL_CCD_STATIC_PACKAGES HWY)
  endif()
  if(FCL_CCD_USE_TBB)
    string(APPEND FCL_CCD_PRIVATE_LIBS " -ltbb")
    list(APPEND FCL_CCD_STATIC_PACKAGES TBB)
  endif()
endif()

configure_package_config_file(
  ${CMAKE_CURRENT_LIST_DIR}/fcl_ccd-config.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/fcl_ccd-config.cmake
  INSTALL_DESTINATION ${package_dir}
  PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR
  NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
# Before 1.0 a minor version may change what programs use.
write_basic_package_version_file(
  ${CMAKE_CURRENT_BINARY_DIR}/fcl_ccd-config-version.cmake
  VERSION ${PROJECT_VERSION}
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fcl_ccd-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/fcl_ccd-config-version.cmake
        DESTINATION ${package_dir})

# pkg-config cannot refer to another package of the same name. So the file repeats the flags of
# stock FCL.
set(FCL_CCD_STOCK_PC_REQUIRES "ccd eigen3")
if(FCL_CCD_HAS_OCTOMAP)
  string(APPEND FCL_CCD_STOCK_PC_REQUIRES " octomap")
endif()
set(FCL_CCD_STOCK_PC_CFLAGS "")
set(FCL_CCD_STOCK_PC_LIBS "")
cmake_path(GET FCL_INCLUDE_DIRS PARENT_PATH stock_prefix)
if(NOT stock_prefix STREQUAL "/usr")
  string(APPEND FCL_CCD_STOCK_PC_CFLAGS " -I${FCL_INCLUDE_DIRS}")
  string(APPEND FCL_CCD_STOCK_PC_LIBS " -L${FCL_LIBRARY_DIRS}")
endif()
# fcl_ccd_pkg_config(NAME LIBDIR OUTPUT): NAME.pc for the folder LIBDIR/pkgconfig. `/` is the prefix.
function(fcl_ccd_pkg_config FCL_CCD_PC_NAME libdir output)
  set(folder ${libdir}/pkgconfig)
  file(RELATIVE_PATH FCL_CCD_PC_TO_PREFIX ${folder} /)
  file(RELATIVE_PATH FCL_CCD_PC_TO_LIBDIR ${folder} /${CMAKE_INSTALL_LIBDIR})
  file(RELATIVE_PATH FCL_CCD_PC_TO_INCLUDE ${folder} /${CMAKE_INSTALL_INCLUDEDIR}/fcl_ccd)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/fcl.pc.in ${output} @ONLY)
endfunction()
fcl_ccd_pkg_config(fcl_ccd /${CMAKE_INSTALL_LIBDIR} ${CMAKE_CURRENT_BINARY_DIR}/fcl_ccd.pc)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fcl_ccd.pc
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

include(${CMAKE_CURRENT_LIST_DIR}/doors.cmake)

add_custom_target(
  uninstall
  COMMAND ${CMAKE_COMMAND} -DMANIFEST=${PROJECT_BINARY_DIR}/install_manifest.txt -P
          ${PROJECT_SOURCE_DIR}/cmake/uninstall.cmake
  VERBATIM)
