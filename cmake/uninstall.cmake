# SPDX-License-Identifier: BSD-3-Clause

# Removes what an installation has written: `cmake --build BUILD_FOLDER --target uninstall`.
#   cmake -DMANIFEST=install_manifest.txt -P uninstall.cmake
if(NOT EXISTS "${MANIFEST}")
  message(FATAL_ERROR "${MANIFEST} is not there: nothing was installed from this build folder")
endif()
file(STRINGS "${MANIFEST}" files)
foreach(file IN LISTS files)
  file(REMOVE "$ENV{DESTDIR}${file}")
  # What Python has compiled beside a module that was imported.
  if(file MATCHES "^(.*)/([^/]+)\\.py$")
    file(GLOB compiled "$ENV{DESTDIR}${CMAKE_MATCH_1}/__pycache__/${CMAKE_MATCH_2}.*")
    if(compiled) # a module that is loaded late may not be compiled
      file(REMOVE ${compiled})
    endif()
    file(GLOB rest "$ENV{DESTDIR}${CMAKE_MATCH_1}/__pycache__/*")
    if(NOT rest)
      file(REMOVE_RECURSE "$ENV{DESTDIR}${CMAKE_MATCH_1}/__pycache__")
    endif()
  endif()
  # Folders that are empty now.
  cmake_path(GET file PARENT_PATH folder)
  while(NOT folder STREQUAL "/")
    file(GLOB rest "$ENV{DESTDIR}${folder}/*" "$ENV{DESTDIR}${folder}/.*")
    if(rest OR NOT IS_DIRECTORY "$ENV{DESTDIR}${folder}")
      break()
    endif()
    file(REMOVE_RECURSE "$ENV{DESTDIR}${folder}")
    cmake_path(GET folder PARENT_PATH folder)
  endwhile()
endforeach()
list(LENGTH files number)
message(STATUS "Removed the ${number} files of ${MANIFEST}")
