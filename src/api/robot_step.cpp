// SPDX-License-Identifier: BSD-3-Clause
//
// The boxes of a robot's parts during a step, and the pairs that meet.
#include <algorithm>
#include <cassert>
#include <cstdint>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "api/meeting_query.h"
#include "base/default_floating_point.h"
#include "broadphase/broad_phase.h"
#include "fcl/broadphase/detail/robot_step.h"
#include "fcl/common/exception.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "paths/chain_path.h"
#include "prepare/object_bounds.h"
#include "prepare/query_arguments.h"
#include "prepare/required_pose.h"

namespace fcl {
namespace detail {

using deformable::BoundsList;
using deformable::DefaultFloatingPoint;
using deformable::JointTree;
using deformable::LinkPath;
using deformable::MeetingQuery;
using deformable::MeetingWindow;
using deformable::MotionPath;

template <typename S>
class RobotPart {
 public:
  const CollisionGeometry<S>* geometry;
  JointTree::Link frame;
  std::string name;
  /// Its boxes in its own frame. Planes and halfspaces have none.
  bool has_boxes;
  deformable::BodyBox box[2];
  /// Its DeformableBVHModels, and their revisions when they were read.
  std::vector<std::pair<const DeformableMesh*, std::uint64_t>> models;

  bool isUpToDate() const {
    return std::all_of(models.begin(), models.end(), [](const auto& model) {
      return *model.first->revision() == model.second;
    });
  }
};

namespace {

JointTree::Link linkOf(const JointTree& tree, int link) {
  assert(link < static_cast<int>(tree.links().size()));
  return link < 0 ? JointTree::Link{-1, {}} : tree.links()[std::size_t(link)];
}

struct FoundPair {
  RobotPair pair;
  /// Of the obstacle.
  std::uint64_t serial;

  bool isOwn() const { return pair.part2 >= 0; }

  /// The numbers of two pairs differ.
  bool operator<(const FoundPair& other) const { return key() < other.key(); }

 private:
  std::tuple<double, int, int, std::uint64_t> key() const {
    return {pair.t_lo, pair.part1, pair.part2, serial};
  }
};

}  // namespace

template <typename S>
RobotPartPtr<S> makeRobotPart(const JointTreePtr& tree, int link,
                              const BoundedMotion::Placement& origin,
                              const CollisionGeometry<S>* geometry,
                              const std::string& name) {
  const DefaultFloatingPoint mode;
  require(geometry, (name + ": the geometry").c_str());
  const MovingGeometry<S> moving = unmoved(geometry);
  const PlacedGeometry<S> placed(moving);
  if (!placed.isKnown())
    throw Exception(name + " is " + kindOf(*geometry) +
                    ", not a triangle mesh, a shape or an octree. Give one of these");
  auto part = std::make_shared<RobotPart<S>>();
  part->geometry = geometry;
  part->name = name;
  const deformable::RoundedPose own{requirePose(origin, name + ": its origin"), 0, 0};
  const JointTree::Link carrier = linkOf(*tree, link);
  part->frame = {carrier.joint, link < 0 ? own : carrier.pose * own};
  part->has_boxes = isBounded(placed);
  if (part->has_boxes) {
    const BoundedBody body = boundedBodyOf(placed, part->name.c_str());
    std::copy(body.box, body.box + 2, part->box);
  }
  visitModels(placed, [&part](const DeformableMesh& model) {
    part->models.emplace_back(&model, model.revision()->load());
  });
  return part;
}

LinkRelation linkRelation(const JointTreePtr& tree, int link1, int link2) {
  const deformable::JointTree::Link &first = linkOf(*tree, link1),
                                    &second = linkOf(*tree, link2);
  if (first.joint == second.joint) return LinkRelation::kFixed;
  const bool are_neighbours = (first.is_moved && first.parent == link2) ||
                              (second.is_moved && second.parent == link1);
  return are_neighbours ? LinkRelation::kNeighbours : LinkRelation::kApart;
}

std::vector<double> jointValuesAt(const ChainPathPtr& chain, double t) {
  const DefaultFloatingPoint mode;
  return chain->valuesAt(t);
}

JointTreePtr jointTreeOf(const ChainPathPtr& chain) { return chain->sharedTree(); }

template <typename S>
class RobotStep<S>::Parts {
 public:
  Parts(const RobotBodies<S>& bodies, const ChainPathPtr& chain) : bodies_(bodies) {
    const DefaultFloatingPoint mode;
    paths_.reserve(bodies.parts.size());
    for (const auto& part : bodies.parts) {
      if (!part->isUpToDate())
        throw Exception(part->name +
                        " has a mesh that was changed after the robot had read it. Call "
                        "update() after a change");
      paths_.emplace_back(chain, part->frame);
      paths_.back().keepPath();
    }
    assert(bodies.filters.size() == count());
    assert(std::all_of(bodies.own_pairs.begin(), bodies.own_pairs.end(),
                       [this](const auto& pair) {
                         return 0 <= pair.first && pair.first < pair.second &&
                                static_cast<std::size_t>(pair.second) < count();
                       }));
  }

  std::size_t count() const { return paths_.size(); }

  MovingGeometry<S> moving(std::size_t i) const {
    MovingGeometry<S> moving{
        bodies_.parts[i]->geometry, {}, PathKind::kBounded, {}, {}, &paths_[i], {}, {}};
    for (int end = 0; end < 2; ++end) {
      const BoundedMotion::Placement at = paths_[i].placementAt(end);
      PoseNumbers<S>& pose = moving.pose[end];
      for (int k = 0; k < 9; ++k) pose.rotation[k] = static_cast<S>(at.rotation[k]);
      for (int k = 0; k < 3; ++k) pose.translation[k] = static_cast<S>(at.translation[k]);
    }
    return moving;
  }

  void appendBounds(BoundsList& list) const {
    for (std::size_t i = 0; i < count(); ++i) {
      const RobotPart<S>& part = *bodies_.parts[i];
      if (part.has_boxes)
        appendBody({{part.box[0], part.box[1]},
                    MotionPath::bounded(paths_[i], part.name.c_str())},
                   list);
      else
        detail::appendBounds(moving(i), list);
    }
    assert(list.items.size() == count());
  }

  void addMet(const BoundsList& bounds, const deformable::BroadPhase& obstacles,
              const MeetingQuery& query, std::vector<FoundPair>& found) const {
    std::vector<deformable::MetObject> met;
    for (std::size_t i = 0; i < count(); ++i) {
      const auto& filter = bodies_.filters[i];
      obstacles.addMet(bounds.at(i), {filter.first, filter.second}, query, met);
      for (const deformable::MetObject& one : met)
        found.push_back(
            {{one.window.lo, one.window.hi, static_cast<int>(i), -1, one.object},
             one.serial});
      met.clear();
    }
  }

  void addOwn(const BoundsList& bounds, const MeetingQuery& query,
              std::vector<FoundPair>& found) const {
    for (const auto& pair : bodies_.own_pairs) {
      const MeetingWindow window =
          deformable::meetingWindow(bounds.at(std::size_t(pair.first)),
                                    bounds.at(std::size_t(pair.second)), query.distance);
      if (!window.isEmpty() && window.lo <= query.latest)
        found.push_back({{window.lo, window.hi, pair.first, pair.second, nullptr}, 0});
    }
  }

 private:
  const RobotBodies<S> bodies_;
  std::vector<LinkPath> paths_;
};

template <typename S>
RobotStep<S>::RobotStep(const RobotBodies<S>& bodies, const ChainPathPtr& chain)
    : parts_(new Parts(bodies, chain)) {}

template <typename S>
RobotStep<S>::~RobotStep() = default;

template <typename S>
std::vector<RobotPair> RobotStep<S>::pairs(const ContinuousBroadPhase<S>* obstacles,
                                           const BroadPhaseSettings& settings,
                                           Order order) const {
  const DefaultFloatingPoint mode;
  const MeetingQuery query = meetingQueryOf(settings);
  BoundsList bounds;
  parts_->appendBounds(bounds);
  std::vector<FoundPair> found;
  if (obstacles) {
    obstacles->requireUpToDate();
    parts_->addMet(bounds, obstacles->boxes(), query, found);
  }
  parts_->addOwn(bounds, query, found);
  std::sort(found.begin(), found.end(), [order](const FoundPair& x, const FoundPair& y) {
    if (order == Order::kObstaclesFirst && x.isOwn() != y.isOwn()) return y.isOwn();
    return x < y;
  });
  std::vector<RobotPair> pairs;
  pairs.reserve(found.size());
  for (const FoundPair& one : found) pairs.push_back(one.pair);
  return pairs;
}

template <typename S>
MovingGeometry<S> RobotStep<S>::part(int number) const {
  assert(number >= 0 && std::size_t(number) < parts_->count());
  const DefaultFloatingPoint mode;
  return parts_->moving(std::size_t(number));
}

#define FCL_CCD_INSTANTIATE(S)                                   \
  template RobotPartPtr<S> makeRobotPart(                        \
      const JointTreePtr&, int, const BoundedMotion::Placement&, \
      const CollisionGeometry<S>*, const std::string&);          \
  template class RobotStep<S>;
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace detail
}  // namespace fcl
