// SPDX-License-Identifier: BSD-3-Clause
//
// The queries of the Python module.
#ifndef FCL_CCD_PYTHON_QUERIES_H
#define FCL_CCD_PYTHON_QUERIES_H

#include <pybind11/pybind11.h>

namespace fcl_ccd {
namespace python {

/// Queries for contacts.
void bindCollisions(pybind11::module_& module);

/// Queries for the least distance.
void bindDistances(pybind11::module_& module);

/// Queries of many objects.
void bindManager(pybind11::module_& module);

/// Edges of a planner.
void bindRobots(pybind11::module_& module);

/// Candidates and elementary tests.
void bindFeatures(pybind11::module_& module);

}  // namespace python
}  // namespace fcl_ccd

#endif
