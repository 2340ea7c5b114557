# SPDX-License-Identifier: BSD-3-Clause
#
# Makes viewer.js and three.js one script, with esbuild, and writes the licence of three.js
# beside it. Without npm, or when it cannot load the packages of package-lock.json, the script
# is empty, and the pages of runs have a picture in place of the 3D view.
#   cmake -DNPM=... -DSOURCES=... -DOUT=viewer.min.js -DWORK=... -P bundle.cmake
cmake_minimum_required(VERSION 3.22)

file(WRITE ${OUT} "")
file(WRITE ${OUT}.LICENSE "This program was built without the viewer of report pages.\n")
if(NOT NPM)
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
  message(WARNING "The viewer of report pages could not be built, so that they have a picture "
                  "in place of the 3D view:\n${output}")
  return()
endif()
file(READ ${WORK}/node_modules/three/LICENSE licence)
file(READ ${WORK}/bundle.js bundle)
file(WRITE ${OUT}.LICENSE "The viewer of report pages contains three.js.\n\n${licence}")
file(WRITE ${OUT} "/*! three.js\n\n${licence}*/\n${bundle}")
