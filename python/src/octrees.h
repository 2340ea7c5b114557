// SPDX-License-Identifier: BSD-3-Clause
//
// The octrees of the Python module.
#ifndef FCL_CCD_PYTHON_OCTREES_H
#define FCL_CCD_PYTHON_OCTREES_H

#include <pybind11/pybind11.h>

namespace fcl_ccd {
namespace python {

void bindOctrees(pybind11::module_& module);

}  // namespace python
}  // namespace fcl_ccd

#endif
