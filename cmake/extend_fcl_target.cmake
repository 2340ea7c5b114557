# SPDX-License-Identifier: BSD-3-Clause

# Used inside of another project. A target there that links fcl gets both libraries, as with the
# installed package.
get_property(imported_here DIRECTORY PROPERTY IMPORTED_TARGETS)
if(fcl IN_LIST imported_here)
  # This project found FCL. Other folders of the program see the target only if it is global.
  set_target_properties(fcl PROPERTIES IMPORTED_GLOBAL TRUE)
  foreach(library IN LISTS stock_libraries ITEMS Eigen3::Eigen)
    if(library IN_LIST imported_here)
      set_target_properties(${library} PROPERTIES IMPORTED_GLOBAL TRUE)
    endif()
  endforeach()
endif()
set_property(TARGET fcl PROPERTY INTERFACE_INCLUDE_DIRECTORIES ${PROJECT_SOURCE_DIR}/include
                                                               ${stock_include_dirs})
set_property(TARGET fcl APPEND PROPERTY INTERFACE_LINK_LIBRARIES fcl_ccd Eigen3::Eigen)
message(STATUS "FCL ${fcl_VERSION} at ${fcl_DIR}, extended by fcl_ccd ${PROJECT_VERSION}")
