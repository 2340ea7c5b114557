# SPDX-License-Identifier: BSD-3-Clause

# Debian packages by CPack: `cpack -G DEB` in a build folder that is built. They are installed
# into a prefix of their own, since stock FCL has /usr. What the system searches elsewhere (the
# program, its manual, the loader, Python) is a link or a line outside of this prefix.
set(CPACK_PACKAGE_NAME fcl-ccd)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_CONTACT "the fcl_ccd contributors <fcl-ccd@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr/lib/fcl-ccd)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION math)
set(CPACK_COMPONENTS_ALL library dev)

set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libfcl-ccd${soversion})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libfcl-ccd-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
    "libfcl-ccd${soversion} (= ${PROJECT_VERSION}), libfcl-dev, libeigen3-dev")

# The loader. Rules with EXCLUDE_FROM_ALL are for these packages, not for `cmake --install`.
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/fcl-ccd.conf
     "${CPACK_PACKAGING_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}\n")
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fcl-ccd.conf DESTINATION /etc/ld.so.conf.d
        COMPONENT library EXCLUDE_FROM_ALL)
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_BINARY_DIR}/triggers)

# fcl_ccd_system_link(COMPONENT FOLDER FILE): a link in a folder of the system to a file of the
# prefix.
function(fcl_ccd_system_link component folder file)
  get_filename_component(name ${file} NAME)
  set(link ${CMAKE_CURRENT_BINARY_DIR}/links/${name}_in${folder}/${name})
  get_filename_component(link_dir ${link} DIRECTORY)
  file(MAKE_DIRECTORY ${link_dir})
  file(CREATE_LINK ${CPACK_PACKAGING_INSTALL_PREFIX}/${file} ${link} SYMBOLIC)
  install(FILES ${link} DESTINATION ${folder} COMPONENT ${component} EXCLUDE_FROM_ALL)
endfunction()

if(TARGET fcl-ccd)
  list(APPEND CPACK_COMPONENTS_ALL tool)
  set(CPACK_DEBIAN_TOOL_PACKAGE_NAME fcl-ccd)
  fcl_ccd_system_link(tool /usr/bin ${CMAKE_INSTALL_BINDIR}/fcl-ccd)
  fcl_ccd_system_link(tool /usr/share/man/man1 ${CMAKE_INSTALL_MANDIR}/man1/fcl-ccd.1)
  fcl_ccd_system_link(tool /usr/share/bash-completion/completions
                      ${CMAKE_INSTALL_DATADIR}/bash-completion/completions/fcl-ccd)
endif()
if(TARGET fcl_ccd_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-fcl-ccd)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(minor ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR})
  math(EXPR next "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= ${minor}), python3 (<< ${Python_VERSION_MAJOR}.${next}), python3-numpy")
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/fcl-ccd.pth
       "${CPACK_PACKAGING_INSTALL_PREFIX}/${FCL_CCD_PYTHON_DIR}\n")
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fcl-ccd.pth
          DESTINATION /usr/lib/python3/dist-packages COMPONENT python EXCLUDE_FROM_ALL)
  # Who imports the package as root would write compiled files beside its modules, of which dpkg
  # does not know. So the package compiles them, and cleans up before it goes, as Debian's do.
  # DPKG_ROOT: a system in a folder (dpkg --root with --force-script-chrootless).
  set(package_dir ${CPACK_PACKAGING_INSTALL_PREFIX}/${FCL_CCD_PYTHON_DIR}/fcl_ccd)
  set(scripts ${CMAKE_CURRENT_BINARY_DIR}/python_package)
  file(WRITE ${scripts}/postinst "#!/bin/sh
set -e
if [ \"$1\" = configure ] && command -v py3compile >/dev/null; then
  py3compile -V ${minor} \"$DPKG_ROOT${package_dir}\"
fi
")
  file(WRITE ${scripts}/prerm "#!/bin/sh
set -e
if command -v py3clean >/dev/null; then
  py3clean \"$DPKG_ROOT${package_dir}\"
else
  rm -rf \"$DPKG_ROOT${package_dir}/__pycache__\"
fi
")
  file(CHMOD ${scripts}/postinst ${scripts}/prerm
       PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
                   WORLD_EXECUTE)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${scripts}/postinst ${scripts}/prerm)
endif()
include(CPack)
