// SPDX-License-Identifier: BSD-3-Clause
//
// The shapes of the Python module.
#ifndef FCL_CCD_PYTHON_SHAPES_H
#define FCL_CCD_PYTHON_SHAPES_H

#include <utility>

#include "arrays.h"
#include "geometry.h"

namespace fcl_ccd {
namespace python {

/// One of FCL's shapes. It never changes.
template <typename FclShape>
class Shape : public Geometry {
 public:
  template <typename... Arguments>
  explicit Shape(Arguments&&... arguments)
      : shape_(std::forward<Arguments>(arguments)...) {}

  const fcl::CollisionGeometry<double>& geometry() const override { return shape_; }
  const FclShape& shape() const { return shape_; }

 private:
  FclShape shape_;
};

void bindShapes(py::module_& module);

}  // namespace python
}  // namespace fcl_ccd

#endif
