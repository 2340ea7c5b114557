# Not run: see ../README.md.
vcpkg_download_distfile(
  archive
  URLS "ADDRESS/v${VERSION}.tar.gz"
  FILENAME "fcl-ccd-${VERSION}.tar.gz"
  SHA512 CHECKSUM)
vcpkg_extract_source_archive(source ARCHIVE "${archive}")
vcpkg_cmake_configure(
  SOURCE_PATH
  "${source}"
  OPTIONS
  -DFCL_CCD_DOORS=nested
  -DFCL_CCD_BUILD_TOOLS=OFF
  -DFCL_CCD_BUILD_BENCHMARKS=OFF
  -DFCL_CCD_BUILD_PYTHON=OFF
  -DBUILD_TESTING=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(PACKAGE_NAME fcl_ccd CONFIG_PATH lib/cmake/fcl_ccd)
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${source}/LICENSE")
