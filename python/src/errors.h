// SPDX-License-Identifier: BSD-3-Clause
//
// What the library says about wrong arguments, for users of the Python package.
#ifndef FCL_CCD_PYTHON_ERRORS_H
#define FCL_CCD_PYTHON_ERRORS_H

#include <string>

namespace fcl_ccd {
namespace python {

/// A text of the library with the names that this package has for its classes, functions
/// and values.
std::string inPython(std::string text);

}  // namespace python
}  // namespace fcl_ccd

#endif
