// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SHAPES_CORES_H
#define FCL_CCD_SHAPES_CORES_H

#include <variant>

#include "shapes/box_core.h"
#include "shapes/cone_core.h"
#include "shapes/cylinder_core.h"
#include "shapes/edge_core.h"
#include "shapes/ellipsoid_core.h"
#include "shapes/hull_core.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief All cores. A new one is a file like theirs and a line here.
using AnyCore = std::variant<BoxCore,  //
                             ConeCore,
                             CylinderCore,   //
                             EdgeCore,       //
                             EllipsoidCore,  //
                             HullCore>;

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
