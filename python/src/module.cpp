// SPDX-License-Identifier: BSD-3-Clause
//
// The compiled part of the Python package fcl_ccd. It checks what keeps memory safe. The
// files *.py convert and check the arguments of users.
#include <pybind11/pybind11.h>

#include <string>

#include "compounds.h"
#include "errors.h"
#include "fcl/ccd_version.h"
#include "fcl/common/exception.h"
#include "meshes.h"
#include "motions.h"
#include "octrees.h"
#include "queries.h"
#include "shapes.h"

PYBIND11_MODULE(_core, module) {
  namespace python = fcl_ccd::python;
  // The library's exceptions are about its arguments.
  pybind11::register_local_exception_translator([](std::exception_ptr error) {
    try {
      if (error) std::rethrow_exception(error);
    } catch (const fcl::Exception& exception) {
      const std::string text = python::inPython(exception.what());
      PyErr_SetString(PyExc_ValueError, text.c_str());
    }
  });
  module.attr("version") = FCL_CCD_VERSION;
  module.def("_in_python", &python::inPython);
  python::bindMeshes(module);
  python::bindShapes(module);
  python::bindOctrees(module);
  python::bindCompounds(module);
  python::bindMotions(module);
  python::bindCollisions(module);
  python::bindDistances(module);
  python::bindManager(module);
  python::bindRobots(module);
  python::bindFeatures(module);
}
