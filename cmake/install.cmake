# SPDX-License-Identifier: BSD-3-Clause

# Installs the library as a package named "fcl" that uses stock FCL. If this prefix comes first
# on the search path, a program that asks for FCL gets both.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/fcl)

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
endif()
# From here on everything is for those who compile with the library.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME dev)
install(EXPORT fcl_ccd-targets DESTINATION ${package_dir})
# refuse_stock_prefix.cmake sets the variable when it installs.
install(
  DIRECTORY ${PROJECT_SOURCE_DIR}/include/fcl
  DESTINATION "\${fcl_ccd_header_dir}"
  FILES_MATCHING
  PATTERN "*.h")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md
              ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/doc ${PROJECT_SOURCE_DIR}/examples
        DESTINATION ${CMAKE_INSTALL_DOCDIR})

# What a program links in addition to the library and FCL: nothing if the library is shared.
set(FCL_CCD_PRIVATE_LIBS "")
set(FCL_CCD_STATIC_PACKAGES "")
set(FCL_CCD_LINKED_FILE $<TARGET_FILE_NAME:fcl_ccd>)
get_target_property(library_type fcl_ccd TYPE)
if(library_type STREQUAL "SHARED_LIBRARY")
  # The linker leaves the library out if the program calls nothing of it.
  set(FCL_CCD_LINKED_FILE "AS_NEEDED ( $<TARGET_LINKER_FILE_NAME:fcl_ccd> )")
else()
  if(FCL_CCD_USE_HIGHWAY)
    string(APPEND FCL_CCD_PRIVATE_LIBS " -lhwy")
    list(APPEND FCL_CCD_STATIC_PACKAGES HWY)
  endif()
  if(FCL_CCD_USE_TBB)
    string(APPEND FCL_CCD_PRIVATE_LIBS " -ltbb")
    list(APPEND FCL_CCD_STATIC_PACKAGES TBB)
  endif()
endif()

# The version of the package is that of the FCL that it extends, with FCL's own rule.
write_basic_package_version_file(
  ${CMAKE_CURRENT_BINARY_DIR}/basic-version.cmake
  VERSION ${fcl_VERSION}
  COMPATIBILITY AnyNewerVersion)
file(READ ${CMAKE_CURRENT_BINARY_DIR}/basic-version.cmake FCL_CCD_BASIC_VERSION)
configure_file(${CMAKE_CURRENT_LIST_DIR}/fcl-config-version.cmake.in
               ${CMAKE_CURRENT_BINARY_DIR}/fcl-config-version.cmake @ONLY)
configure_package_config_file(
  ${CMAKE_CURRENT_LIST_DIR}/fcl-config.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/fcl-config.cmake
  INSTALL_DESTINATION ${package_dir}
  PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR
  NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fcl-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/fcl-config-version.cmake
        DESTINATION ${package_dir})

# The flag -lfcl and CMake's find_library(fcl) must mean both libraries. With a static library a
# linker script in the place of an archive, libfcl.a, names them. With a shared one the script is
# for who names this file. All others find libfcl.so: a linker script would do for -lfcl, but a
# program that loads "libfcl.so" at run time would fail, and CMake gives a program the folder of
# the library at run time only if it ends in ".so". The linker searches the folder of the script
# for the library first.
file(
  GENERATE
  OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/$<CONFIG>/libfcl.a
  CONTENT "/* GNU ld script: FCL as extended by fcl_ccd */
GROUP ( ${FCL_CCD_LINKED_FILE} $<TARGET_FILE_DIR:fcl>/$<TARGET_SONAME_FILE_NAME:fcl>${FCL_CCD_PRIVATE_LIBS} )
")
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/$<CONFIG>/libfcl.a
        DESTINATION ${CMAKE_INSTALL_LIBDIR})

if(library_type STREQUAL "SHARED_LIBRARY" AND UNIX AND NOT APPLE)
  include(${CMAKE_CURRENT_LIST_DIR}/link_library.cmake)
endif()

# pkg-config cannot refer to another package of the same name. So fcl.pc repeats the flags of
# stock FCL.
file(RELATIVE_PATH FCL_CCD_PC_TO_PREFIX ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig
     ${CMAKE_INSTALL_PREFIX})
file(RELATIVE_PATH FCL_CCD_PC_TO_INCLUDE ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig
     ${CMAKE_INSTALL_FULL_INCLUDEDIR})
set(FCL_CCD_STOCK_PC_CFLAGS "")
set(FCL_CCD_STOCK_PC_LIBS "")
cmake_path(GET FCL_INCLUDE_DIRS PARENT_PATH stock_prefix)
if(NOT stock_prefix STREQUAL "/usr")
  string(APPEND FCL_CCD_STOCK_PC_CFLAGS " -I${FCL_INCLUDE_DIRS}")
  string(APPEND FCL_CCD_STOCK_PC_LIBS " -L${FCL_LIBRARY_DIRS}")
endif()
# One with the headers in their usual place, and one with the folder of their own.
foreach(FCL_CCD_PC_HEADERS IN ITEMS "" "/fcl-ccd")
  configure_file(${CMAKE_CURRENT_LIST_DIR}/fcl.pc.in
                 ${CMAKE_CURRENT_BINARY_DIR}/headers${FCL_CCD_PC_HEADERS}/pkgconfig/fcl.pc @ONLY)
endforeach()
install(DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/headers\${fcl_ccd_header_subdir}/pkgconfig"
        DESTINATION ${CMAKE_INSTALL_LIBDIR})

add_custom_target(
  uninstall
  COMMAND ${CMAKE_COMMAND} -DMANIFEST=${PROJECT_BINARY_DIR}/install_manifest.txt -P
          ${PROJECT_SOURCE_DIR}/cmake/uninstall.cmake
  VERBATIM)
if(UNIX AND NOT APPLE)
  include(cmake/packages.cmake)
endif()
