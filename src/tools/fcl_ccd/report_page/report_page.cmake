# SPDX-License-Identifier: BSD-3-Clause

# The pages of runs: their parts become texts in the program.
set(page_sources ${CMAKE_CURRENT_SOURCE_DIR}/report_page)
set(page_dir ${CMAKE_CURRENT_BINARY_DIR}/report_page)
set(parts ${page_dir}/page_parts.cpp)
add_custom_command(
  OUTPUT ${parts}
  COMMAND ${CMAKE_COMMAND} -DSOURCES=${page_sources} -DVIEWER=${FCL_CCD_VIEWER} -DOUT=${parts} -P
          ${page_sources}/embed.cmake
  DEPENDS ${page_sources}/blocks.js ${page_sources}/body.html ${page_sources}/embed.cmake
          ${page_sources}/page.css ${page_sources}/page.js fcl_ccd_viewer ${FCL_CCD_VIEWER}
  VERBATIM)
# The viewer is one text of half a megabyte, which gcc and clang take.
set_source_files_properties(${parts} PROPERTIES COMPILE_OPTIONS -Wno-overlength-strings)
target_sources(fcl-ccd PRIVATE ${parts})
