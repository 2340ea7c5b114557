// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PYTHON_COMPOUNDS_H
#define FCL_CCD_PYTHON_COMPOUNDS_H

#include <pybind11/pybind11.h>

namespace fcl_ccd {
namespace python {

void bindCompounds(pybind11::module_& module);

}  // namespace python
}  // namespace fcl_ccd

#endif
