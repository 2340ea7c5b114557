# SPDX-License-Identifier: BSD-3-Clause

# Writes a C++ file that defines each name that some libraries export, see
# cmake/link_library.cmake.
#   cmake -DNM=nm -DLIBRARIES=lib1.so,lib2.so -DOUTPUT=names.cpp -P link_names.cmake
string(REPLACE "," ";" LIBRARIES "${LIBRARIES}")
set(lines "")
foreach(library IN LISTS LIBRARIES)
  execute_process(
    COMMAND ${NM} -D -P --defined-only --extern-only -t d ${library}
    OUTPUT_VARIABLE symbols
    COMMAND_ERROR_IS_FATAL ANY)
  # NAME[@VERSION] TYPE VALUE [SIZE]
  string(REGEX MATCHALL "_Z[A-Za-z0-9_]+[^\n]* [TtWiVuBDR] [^\n]*" symbols "${symbols}")
  list(APPEND lines ${symbols})
endforeach()

set(text "// The names of ${LIBRARIES}. Nothing here is ever called or read.\nextern \"C\" {\n")
set(names "")
foreach(line IN LISTS lines)
  string(REGEX MATCH "^(_Z[A-Za-z0-9_]+)[^ ]* (.) [0-9]+ ?([0-9]*)" line "${line}")
  set(name "${CMAKE_MATCH_1}")
  set(type "${CMAKE_MATCH_2}")
  set(size "${CMAKE_MATCH_3}")
  if(DEFINED known_${name} OR name STREQUAL "")
    continue()
  endif()
  set(known_${name} TRUE)
  if(type MATCHES "[VuBDR]")
    # The size is needed by programs that are not position-independent: they copy the object.
    string(APPEND text "alignas(64) char ${name}[${size}];\n")
  else()
    string(APPEND text "void ${name}() { __builtin_trap(); }\n")
  endif()
endforeach()
string(APPEND text "}\n")
file(WRITE "${OUTPUT}" "${text}")
