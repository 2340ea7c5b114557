// SPDX-License-Identifier: BSD-3-Clause
#include "errors.h"

#include <cstddef>

namespace fcl_ccd {
namespace python {
namespace {

struct Words {
  const char *of_library, *of_python;
};

/// They are replaced one after the other, so a longer text stands before its parts.
constexpr Words kWords[] = {
    // Arguments of queries.
    {"request.", ""},
    {"use kFirst or kAll", "use 'first' or 'all'"},
    {"ContinuousQuery::kAny", "query='any'"},
    {"ContinuousQuery::kFirst", "query='first'"},
    {"ContinuousQuery::kAll", "query='all'"},
    {"all threads of the task arena", "all cores"},
    {"ContinuousContactRequest::", ""},
    {"a ContinuousContact", "a contact"},
    // Functions.
    {"continuousSelfCollide", "self_collide()"},
    {"continuousSelfCandidates", "self_candidates()"},
    {"continuousCandidates", "candidates()"},
    {"continuousDistance", "distance()"},
    {"continuousCollide()", "collide()"},
    {"weldVertices", "weld_vertices()"},
    {"octreeCell: b is not", "cells(): a number is not"},
    {"setSelfCollision", "set_self_collision()"},
    {"registerObject()", "register()"},
    {"by updateFrames()", "by update(previous, current)"},
    {"updateFrames()", "update()"},
    {"updateTopology()", "update_topology()"},
    {"Add some by addTriangle() or addSubModel()", "Give some, or free edges or points"},
    {"BoundedMotion::", ""},
    {"accelerationBound()", "acceleration_bound()"},
    {"angularSpeedBound()", "angular_speed_bound()"},
    {"moreRounding()", "its rounding"},
    {"placementAt()", "pose()"},
    {"JointChain::kBase or JointChain::kLast", "-1 for the base"},
    {"JointChain::kBase", "-1, the base"},
    {"CollisionRobot::chain()", "the chain of the robot"},
    {"CompoundGeometry", "Compound"},
    {"setFilter", "set_filter()"},
    {"checkMotion", "check_motion()"},
    {"attach() returned", "attach() gave"},
    {"rateAt()", "rate()"},
    // Classes.
    {"a BVHModel or a DeformableBVHModel with triangles",
     "a RigidMesh or a DeformableMesh"},
    {"DeformableBVHModel: ", ""},
    {"DeformableBVHModel", "DeformableMesh"},
    {"BVHModel", "RigidMesh"},
    {"ContinuousCollisionManager", "CollisionManager"},
    {"of the InterpMotion is not finite or far too large. FCL's constructors of two "
     "poses do not set it. Use the constructor of five arguments, InterpMotion(R1, T1, "
     "R2, T2, O), with O = 0",
     "of the LinearMotion is far too large. Give a point near the object"},
    {"InterpMotion", "LinearMotion"},
    {"a model", "a mesh"},
    {"the model", "the mesh"},
    {"The model", "The mesh"},
};

void replaceAll(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

}  // namespace

std::string inPython(std::string text) {
  for (const Words& words : kWords) replaceAll(text, words.of_library, words.of_python);
  return text;
}

}  // namespace python
}  // namespace fcl_ccd
