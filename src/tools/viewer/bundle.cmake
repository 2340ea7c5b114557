# SPDX-License-Identifier: BSD-3-Clause
#
# Makes viewer.js and three.js one script, with esbuild, and writes the licence of three.js
# beside it. Without npm, or when it cannot load the packages of package-lock.json, the script
# is empty: pages of runs have a picture in place of the 3D view, and the Python package writes
# no pages. The stamp says that a later build need not try again.
#   cmake -DNPM=... -DSOURCES=... -DOUT=viewer.min.js -DSTAMP=... -DWORK=... -P bundle.cmake
cmake_minimum_required(VERSION 3.22)

# Writes both files. What is as before stays as it is, and nothing is made of it again.
function(write_viewer script licence)
  foreach(name script licence)
    file(WRITE ${WORK}/${name} "${${name}}")
  endforeach()
  file(COPY_FILE ${WORK}/script ${OUT} ONLY_IF_DIFFERENT)
  file(COPY_FILE ${WORK}/licence ${OUT}.LICENSE ONLY_IF_DIFFERENT)
endfunction()

file(REMOVE ${STAMP})
set(no_viewer "This was built without the 3D view of pages.\n")
if(NOT NPM)
  write_viewer("" "${no_viewer}")
  file(TOUCH ${STAMP})
  return()
endif()
foreach(name package.json package-lock.json viewer.js)
  configure_file(${SOURCES}/${name} ${WORK}/${name} COPYONLY)
endforeach()
execute_process(
  COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --fetch-retries=1
          --fetch-timeout=60000
  WORKING_DIRECTORY ${WORK}
  TIMEOUT 240
  RESULT_VARIABLE failed
  OUTPUT_VARIABLE output
  ERROR_VARIABLE output)
if(NOT failed)
  execute_process(
    COMMAND ${WORK}/node_modules/.bin/esbuild viewer.js --bundle --minify --format=iife
            --target=es2020 --legal-comments=inline --log-level=warning --outfile=bundle.js
    WORKING_DIRECTORY ${WORK}
    RESULT_VARIABLE failed
    OUTPUT_VARIABLE output
    ERROR_VARIABLE output)
endif()
if(failed)
  message(WARNING "The 3D view of pages could not be built. Pages of runs have a picture in its "
                  "place, and the Python package writes no pages. The next build tries again; "
                  "-DFCL_CCD_BUILD_VIEWER=OFF does without it:\n${output}")
  write_viewer("" "${no_viewer}")
  return()
endif()
file(READ ${WORK}/node_modules/three/LICENSE licence)
file(READ ${WORK}/bundle.js bundle)
write_viewer("/*! three.js\n\n${licence}*/\n${bundle}"
             "The 3D view of pages contains three.js.\n\n${licence}")
file(TOUCH ${STAMP})
