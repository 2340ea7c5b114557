# SPDX-License-Identifier: BSD-3-Clause

# The pages of runs: their parts become texts in the program. npm loads three.js and esbuild,
# which makes one script of it and viewer.js.
find_program(FCL_CCD_NPM npm)
option(FCL_CCD_BUILD_VIEWER "Build the 3D view of report pages, with npm" ON)
set(npm ${FCL_CCD_NPM})
if(NOT FCL_CCD_BUILD_VIEWER OR NOT FCL_CCD_NPM)
  set(npm "")
endif()
set(page_sources ${CMAKE_CURRENT_SOURCE_DIR}/report_page)
set(page_dir ${CMAKE_CURRENT_BINARY_DIR}/report_page)
set(viewer ${page_dir}/viewer.min.js)
set(fcl_ccd_viewer_license ${viewer}.LICENSE PARENT_SCOPE)
add_custom_command(
  OUTPUT ${viewer} ${viewer}.LICENSE
  COMMAND ${CMAKE_COMMAND} -DNPM=${npm} -DSOURCES=${page_sources} -DOUT=${viewer}
          -DWORK=${page_dir}/work -P ${page_sources}/bundle.cmake
  DEPENDS ${page_sources}/bundle.cmake ${page_sources}/package-lock.json
          ${page_sources}/package.json ${page_sources}/viewer.js
  COMMENT "Bundling the viewer of report pages"
  VERBATIM)
set(parts ${page_dir}/page_parts.cpp)
add_custom_command(
  OUTPUT ${parts}
  COMMAND ${CMAKE_COMMAND} -DSOURCES=${page_sources} -DVIEWER=${viewer} -DOUT=${parts} -P
          ${page_sources}/embed.cmake
  DEPENDS ${page_sources}/blocks.js ${page_sources}/body.html ${page_sources}/embed.cmake
          ${page_sources}/page.css ${page_sources}/page.js ${viewer}
  VERBATIM)
# The viewer is one text of half a megabyte, which gcc and clang take.
set_source_files_properties(${parts} PROPERTIES COMPILE_OPTIONS -Wno-overlength-strings)
target_sources(fcl-ccd PRIVATE ${parts})
