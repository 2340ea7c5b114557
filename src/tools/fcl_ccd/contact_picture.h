// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_CONTACT_PICTURE_H
#define FCL_CCD_CONTACT_PICTURE_H

#include <cstddef>
#include <string>

#include "scene.h"

namespace fcl_ccd {

/// @brief A moment of a step.
struct StepMoment {
  std::size_t step{0};  ///< its number
  double time{0};       ///< in fractions of the step
};

/// @brief A PNG of the scene at a moment: the surroundings of the step's first contact
/// with its triangles, place and normal, and the whole scene in a corner. What is between
/// the viewer and the surroundings is left out. Without a contact, the whole scene.
std::string drawContact(const SceneTriangles& triangles, const SceneFrame& from,
                        const SceneFrame& to, const StepMoment& moment,
                        const StepResult& result);

}  // namespace fcl_ccd

#endif
