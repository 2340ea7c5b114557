// SPDX-License-Identifier: BSD-3-Clause
//
// The motion classes of this library: checks of what a program gives.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "base/default_floating_point.h"
#include "fcl/common/exception.h"
#include "fcl/math/motion/joint_chain.h"
#include "fcl/math/motion/twist_motion.h"
#include "fcl/math/motion/waypoint_motion.h"
#include "paths/chain_path.h"
#include "paths/posed_vector.h"
#include "paths/sine.h"
#include "paths/twist_path.h"
#include "paths/waypoint_path.h"
#include "prepare/required_pose.h"

namespace fcl {
namespace detail {
namespace {

using deformable::ChainPath;
using deformable::DefaultFloatingPoint;
using deformable::JointTree;
using deformable::Pose;
using deformable::Vec;
using deformable::vecOf;

/// The vector divided by its length, which neither overflows nor loses digits.
Vec requireDirection(const double (&v)[3], const std::string& name) {
  requireFinite(v, name);
  const double size = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
  if (size == 0)
    throw Exception(name + " is zero. Give the direction about which it turns or slides");
  int exponent;
  std::frexp(size, &exponent);
  const Vec scaled = {std::ldexp(v[0], -exponent), std::ldexp(v[1], -exponent),
                      std::ldexp(v[2], -exponent)};
  const Vec direction = (1 / deformable::norm(scaled)) * scaled;
  assert(std::abs(deformable::norm(direction) - 1) < 0x1p-49);
  return direction;
}

JointTree::Type typeOf(JointKind kind) {
  switch (kind) {
    case JointKind::kRevolute:
      return JointTree::Type::kRevolute;
    case JointKind::kPrismatic:
      return JointTree::Type::kPrismatic;
    default:
      return JointTree::Type::kFixed;
  }
}

const JointTree& requireTree(const JointTreePtr& tree) {
  if (!tree) throw Exception("ChainMotion: the chain has no joints. Add some");
  return *tree;
}

void requireCount(std::size_t count, const JointTree& tree, const std::string& name) {
  if (count != tree.joints().size())
    throw Exception("ChainMotion: " + name + " has " + std::to_string(count) +
                    " values, but the chain has " + std::to_string(tree.joints().size()) +
                    " joints that move. Give a value for each, none for fixed joints");
}

std::string digitsOf(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

void requireTimes(const std::vector<double>& times, std::size_t num_poses) {
  const std::string name = "WaypointMotion: ";
  const auto text = [](std::size_t i) { return std::to_string(i); };
  if (num_poses < 2)
    throw Exception(name + "it has " + text(num_poses) +
                    (num_poses == 1 ? " pose." : " poses.") + " Give two or more");
  if (times.size() != num_poses)
    throw Exception(name + text(num_poses) + " poses have " + text(times.size()) +
                    " times. Give a time for each pose");
  requireFinite(times, name + "the list of times");
  for (std::size_t i = 1; i < times.size(); ++i)
    if (!(times[i] - times[i - 1] >= deformable::kLeastPieceTime))
      throw Exception(name + "the times of the poses " + text(i - 1) + " and " + text(i) +
                      " are " + digitsOf(times[i - 1]) + " and " + digitsOf(times[i]) +
                      ". Give times that ascend, by at least 2^-16");
  if (times.front() != 0 || times.back() != 1)
    throw Exception(name + "the times go from " + digitsOf(times.front()) + " to " +
                    digitsOf(times.back()) +
                    ". Let them go from 0 to 1: repeat a pose where the body rests");
}

}  // namespace

JointTreePtr withJoint(const JointTreePtr& tree, JointKind kind,
                       const BoundedMotion::Placement& origin, const double (&axis)[3],
                       int parent) {
  const DefaultFloatingPoint mode;
  const std::string name =
      "link " + std::to_string(tree ? tree->links().size() : 0) + " of a JointChain: ";
  const Pose pose = requirePose(origin, name + "its origin");
  const Vec direction = requireDirection(axis, name + "its axis");
  const int num_links = tree ? static_cast<int>(tree->links().size()) : 0;
  if (parent < -1 || parent >= num_links)
    throw Exception(name + "there is no link " + std::to_string(parent) +
                    " before it. Give the number of a link, JointChain::kBase or "
                    "JointChain::kLast");
  auto out = tree ? std::make_shared<JointTree>(*tree) : std::make_shared<JointTree>();
  out->add(typeOf(kind), pose, direction, parent);
  assert(out->links().size() == static_cast<std::size_t>(num_links) + 1);
  return out;
}

JointCounts jointCounts(const JointTreePtr& tree) {
  if (!tree) return {0, 0};
  return {static_cast<int>(tree->links().size()),
          static_cast<int>(tree->joints().size())};
}

ChainPathPtr makeChainPath(const JointTreePtr& tree, const BoundedMotion::Placement& base,
                           const std::vector<std::vector<double>>& values) {
  const DefaultFloatingPoint mode;
  constexpr std::size_t kMostCoefficients = 16;
  requireCount(values.size(), requireTree(tree), "the motion");
  for (std::size_t i = 0; i < values.size(); ++i)
    if (values[i].empty() || values[i].size() > kMostCoefficients)
      throw Exception("ChainMotion: the polynomial of joint value " + std::to_string(i) +
                      " has " + std::to_string(values[i].size()) +
                      " coefficients. Give 1 to 16: divide the motion into steps");
  return std::make_shared<ChainPath>(tree, requirePose(base, "ChainMotion: the base"),
                                     values);
}

ChainPathPtr makeChainPath(const JointTreePtr& tree, const BoundedMotion::Placement& base,
                           const std::vector<double>& begin,
                           const std::vector<double>& end) {
  const DefaultFloatingPoint mode;
  requireCount(begin.size(), requireTree(tree), "begin");
  requireCount(end.size(), *tree, "end");
  std::vector<deformable::Coefficients> values;
  for (std::size_t i = 0; i < begin.size(); ++i)
    values.push_back(begin[i] == end[i]
                         ? deformable::Coefficients{begin[i]}
                         : deformable::Coefficients{begin[i], end[i] - begin[i]});
  return std::make_shared<ChainPath>(tree, requirePose(base, "ChainMotion: the base"),
                                     std::move(values));
}

std::shared_ptr<const BoundedMotion> makeLinkPath(const ChainPathPtr& chain, int link) {
  const auto& links = chain->tree().links();
  if (link < 0 || static_cast<std::size_t>(link) >= links.size())
    throw Exception("ChainMotion: there is no link " + std::to_string(link) +
                    ". The chain has the links 0 to " + std::to_string(links.size() - 1));
  return std::make_shared<deformable::LinkPath>(chain,
                                                links[static_cast<std::size_t>(link)]);
}

std::shared_ptr<const BoundedMotion> makeTwistPath(const BoundedMotion::Placement& pose,
                                                   const double (&linear)[3],
                                                   const double (&angular)[3],
                                                   const double (&reference)[3],
                                                   ReferencePath path) {
  const DefaultFloatingPoint mode;
  const Pose begin = requirePose(pose, "TwistMotion: the pose");
  requireLengths(linear, "TwistMotion: the linear velocity");
  requireFinite(angular, "TwistMotion: the angular velocity");
  requireLengths(reference, "TwistMotion: the reference point");
  if (!(deformable::norm(angular) <= deformable::kMostAngle))
    throw Exception(
        "TwistMotion: the angular velocity is more than 2^20 radians a step. Give "
        "shorter steps");
  return std::make_shared<deformable::TwistPath>(begin, vecOf(linear), vecOf(angular),
                                                 vecOf(reference),
                                                 path == ReferencePath::kScrew);
}

std::shared_ptr<const BoundedMotion> makeWaypointPath(
    const std::vector<BoundedMotion::Placement>& poses,
    const std::vector<double>& times) {
  const DefaultFloatingPoint mode;
  requireTimes(times, poses.size());
  std::vector<Pose> waypoints;
  waypoints.reserve(poses.size());
  for (const auto& pose : poses)
    waypoints.push_back(
        requirePose(pose, "WaypointMotion: pose " + std::to_string(waypoints.size())));
  return std::make_shared<deformable::WaypointPath>(waypoints, times);
}

BoundedMotion::Placement placementOfUrdf(const double (&xyz)[3], const double (&rpy)[3]) {
  const DefaultFloatingPoint mode;
  requireFinite(xyz, "xyz of a URDF's origin");
  requireFinite(rpy, "rpy of a URDF's origin");
  deformable::SineCosine at[3];
  for (int k = 0; k < 3; ++k) {
    if (std::abs(rpy[k]) > deformable::kMostAngle)
      throw Exception("rpy of a URDF's origin has an angle beyond 2^20 radians");
    at[k] = deformable::sineCosine(rpy[k]);
  }
  const double sr = at[0].sine, cr = at[0].cosine, sp = at[1].sine, cp = at[1].cosine,
               sy = at[2].sine, cy = at[2].cosine;
  return {{cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
           sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,  //
           -sp, cp * sr, cp * cr},
          {xyz[0], xyz[1], xyz[2]}};
}

}  // namespace detail
}  // namespace fcl
