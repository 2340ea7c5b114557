# SPDX-License-Identifier: BSD-3-Clause
#
# Writes the parts of report pages as a C++ file.
#   cmake -DSOURCES=... -DVIEWER=viewer.min.js -DOUT=page_parts.cpp -P embed.cmake
cmake_minimum_required(VERSION 3.22)

# A literal of C++ is that long at most, for some compilers; literals side by side are one.
set(longest 16000)
function(embed name file)
  file(READ ${file} text)
  # A script ends at this text wherever it stands.
  string(FIND "${text}" "</script" found)
  if(NOT found EQUAL -1 AND NOT file MATCHES "html$")
    message(FATAL_ERROR "${file}: contains </script, which would end it in the page")
  endif()
  string(LENGTH "${text}" length)
  set(literals "")
  foreach(begin RANGE 0 ${length} ${longest})
    string(SUBSTRING "${text}" ${begin} ${longest} part)
    string(APPEND literals "\nR\"part(${part})part\"")
  endforeach()
  file(APPEND ${OUT} "const char* const ${name} =${literals};\n")
endfunction()

file(WRITE ${OUT} "#include \"page_parts.h\"\n\nnamespace fcl_ccd {\n\n")
embed(kPageStyle ${SOURCES}/page.css)
embed(kPageBody ${SOURCES}/body.html)
embed(kPageBlocks ${SOURCES}/blocks.js)
embed(kPageScript ${SOURCES}/page.js)
embed(kPageViewer ${VIEWER})
file(APPEND ${OUT} "\n}  // namespace fcl_ccd\n")
