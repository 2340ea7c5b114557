// SPDX-License-Identifier: BSD-3-Clause
//
// An edge of a planner: whether a robot can go from one joint state to another.
#ifndef FCL_BROADPHASE_COLLISION_ROBOT_H
#define FCL_BROADPHASE_COLLISION_ROBOT_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/broadphase/detail/robot_step.h"

namespace fcl {

/// @brief Two bodies in contact: a part of the robot and an obstacle, or two parts.
template <typename S>
struct RobotPairResult {
  /// @brief The first body: its number by CollisionRobot::attach(), and its link.
  int part1{-1}, link1{JointChain::kBase};

  /// @brief The obstacle; null: the second body is a part of the robot too.
  ContinuousCollisionObject<S>* object{nullptr};
  int part2{-1}, link2{JointChain::kBase};

  /// @brief The answer of continuousCollide() for the two, the first body first.
  ContinuousContactResult<S> result;
};

/// @brief The answer for an edge.
template <typename S>
struct RobotEdgeResult {
  /// @brief True is proved: nothing touches at any time of the step, up to the request's
  /// t_max. (A mesh is a surface: one inside of another one does not touch it.) False:
  /// see `pairs`. Some contacts are only proved up to the tolerance of a query
  /// (ContinuousContact::within_tolerance). False too before an edge was checked, and
  /// after an exception.
  bool is_free{false};

  /// @brief The time of the first contact among `pairs`, in fractions of the step; never
  /// later than the true one. With ContinuousQuery::kAny that of the contact that was
  /// found. 1 if the edge is free.
  S time_of_contact{1};

  /// @brief The joint values at this time.
  std::vector<double> joint_values;

  /// @brief ContinuousQuery::kFirst: the pair that is first in contact. kAny: one pair in
  /// contact. kAll: all pairs in contact, sorted by their time of contact.
  std::vector<RobotPairResult<S>> pairs;

  /// @brief The number of pairs whose boxes meet, and the number of tests of pairs. With
  /// ContinuousQuery::kFirst a pair may be tested twice.
  std::size_t num_box_pairs{0};
  std::size_t num_tested{0};
};

using RobotEdgeResultf = RobotEdgeResult<float>;
using RobotEdgeResultd = RobotEdgeResult<double>;

/// @brief A robot with the geometries of its links and what it holds. It checks edges of
/// a planner: all of it from one joint state to the next, against obstacles and against
/// itself. The links follow their exact paths (ChainMotion).
///
/// A geometry is a mesh, a shape or an octree. A link may have any number. The robot
/// reads one when it is attached; after a change of it call update().
///
/// Which pairs are tested: all parts with all obstacles, except those that setFilter()
/// and the filters of the manager reject; and all parts with each other, except those
/// - whose links do not move relative to each other,
/// - whose links may touch: allow(), allowNeighbours(), or `touch_links` of a part.
///
/// Copies are independent and share the geometries.
///
/// Thread-safety: const functions may run at the same time.
///
/// @tparam S  double or float, as of the geometries. Joint values are doubles.
template <typename S>
class CollisionRobot {
 public:
  using Geometry = std::shared_ptr<const CollisionGeometry<S>>;
  using Manager = ContinuousCollisionManager<S>;

  /// @param link_names  for messages; none, or one for each link
  /// @throws fcl::Exception  the chain has no joints; a wrong number of names
  explicit CollisionRobot(const JointChain& chain,
                          std::vector<std::string> link_names = {});

  /// @brief Attaches a geometry to a link: a part of the robot, or an object that it
  /// holds.
  /// @param link  a link of the chain, or JointChain::kBase
  /// @param origin  the frame of the geometry in that of the link
  /// @param touch_links  links which the part may touch
  /// @return the number of the part: 0, 1, ... Numbers are not used again.
  /// @throws fcl::Exception  there is no such link; the geometry is null, a point cloud
  /// or of a class of the program; a mesh is not built; a number is not finite; the
  /// origin is no rotation (up to 2^-6) and translation. Then nothing has changed.
  int attach(int link, const Geometry& geometry,
             const Transform3<double>& origin = Transform3<double>::Identity(),
             const std::vector<int>& touch_links = {});
  /// @brief Removes a part. @throws fcl::Exception  it is not attached
  void detach(int part);
  /// @brief Reads all geometries again. @throws fcl::Exception  as attach()
  void update();

  /// @brief Parts of these two links are not tested with each other from now on. That
  /// holds for all that is attached to them, now and later. Attach what the robot holds
  /// to a fixed link of its own (JointChain::addFixed()) if it may not touch them.
  /// @throws fcl::Exception  there is no such link
  void allow(int link1, int link2);
  /// @brief allow() for all pairs of links that one joint connects: the link that carries
  /// a joint, and the link that it moves. What is fixed to one of them is another link,
  /// and is tested with the other one.
  void allowNeighbours();

  /// @brief Sets which obstacles the parts of a link can be in contact with, as
  /// ContinuousFilter::group and mask. The robot's own pairs do not depend on it.
  void setFilter(int link, std::uint32_t group, std::uint32_t mask);

  /// @brief Where the base of the robot is.
  /// @throws fcl::Exception  no rotation and translation
  void setBase(const Transform3<double>& base);

  const JointChain& chain() const { return chain_; }
  /// @brief "link 2", with its name if it has one; "the base".
  std::string nameOf(int link) const;

  /// @brief Checks the edge from one joint state to another: all values change at
  /// constant speed.
  /// @param begin, end  the value of each joint that moves
  /// @param obstacles  the objects of a manager, with their thickness; null: the robot
  /// alone. They may move during the step.
  /// @param request  as ContinuousCollisionManager::collide() takes it, num_threads too.
  /// `query` should be kAny (is it free?) or kFirst (how far is it free?): the default is
  /// kAll. filter1 and filter2 do not act.
  /// @return result.is_free
  /// @throws fcl::Exception  as ChainMotion, and what continuousCollide() throws, with
  /// the names of both bodies
  bool checkEdge(const std::vector<double>& begin, const std::vector<double>& end,
                 const Manager* obstacles, const ContinuousContactRequest<S>& request,
                 RobotEdgeResult<S>& result) const;

  /// @brief The same for any motion of the chain, with its own base.
  /// @throws fcl::Exception  also: it is a motion of another chain
  bool checkMotion(const ChainMotion& motion, const Manager* obstacles,
                   const ContinuousContactRequest<S>& request,
                   RobotEdgeResult<S>& result) const;

 private:
  using Request = ContinuousContactRequest<S>;
  using PairResult = RobotPairResult<S>;
  using Step = detail::RobotStep<S>;

  struct Part {
    int number, link;
    Geometry geometry;
    BoundedMotion::Placement origin;
    std::vector<int> touch_links;
  };

  void requireLink(int link, const char* function) const;
  std::string nameOfPart(int number, int link) const;
  detail::RobotPartPtr<S> read(const Part& part) const;
  bool mayTouch(const Part& x, const Part& y) const;
  void setOwnPairs();
  std::string nameOfObject(const detail::RobotPair& pair, const Manager* obstacles) const;
  bool test(const Step& step, const detail::RobotPair& pair, const Manager* obstacles,
            Request& request, PairResult& tested) const;
  bool checkPath(const detail::ChainPathPtr& path, const Manager* obstacles,
                 const Request& request, RobotEdgeResult<S>& out) const;

  JointChain chain_;
  std::vector<std::string> link_names_;
  BoundedMotion::Placement base_;
  int next_part_{0};
  std::set<std::pair<int, int>> allowed_;
  /// Of each link, that of the base first.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> link_filters_;
  std::vector<Part> parts_;
  // What the library takes: an entry for each part, and the pairs of these.
  std::vector<detail::RobotPartPtr<S>> read_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> filters_;
  std::vector<std::pair<int, int>> own_pairs_;
};

using CollisionRobotf = CollisionRobot<float>;
using CollisionRobotd = CollisionRobot<double>;

template <typename S>
CollisionRobot<S>::CollisionRobot(const JointChain& chain,
                                  std::vector<std::string> link_names)
    : chain_(chain),
      link_names_(std::move(link_names)),
      base_(detail::placementOf(Transform3<double>(Transform3<double>::Identity()))),
      link_filters_(static_cast<std::size_t>(chain.numLinks()) + 1,
                    {1, std::numeric_limits<std::uint32_t>::max()}) {
  if (chain.numLinks() == 0)
    throw Exception("CollisionRobot: the chain has no joints. Add them first");
  if (!link_names_.empty() &&
      link_names_.size() != static_cast<std::size_t>(chain.numLinks()))
    throw Exception("CollisionRobot: there are " + std::to_string(link_names_.size()) +
                    " names of " + std::to_string(chain.numLinks()) +
                    " links. Give one for each link, fixed ones too, or none");
}

template <typename S>
std::string CollisionRobot<S>::nameOf(int link) const {
  if (link == JointChain::kBase) return "the base";
  const std::string name = "link " + std::to_string(link);
  if (link_names_.empty()) return name;
  return name + " (" + link_names_[static_cast<std::size_t>(link)] + ")";
}

template <typename S>
std::string CollisionRobot<S>::nameOfPart(int number, int link) const {
  return "part " + std::to_string(number) + " of " + nameOf(link);
}

template <typename S>
void CollisionRobot<S>::requireLink(int link, const char* function) const {
  if (link < JointChain::kBase || link >= chain_.numLinks())
    throw Exception(std::string(function) + ": the robot has no link " +
                    std::to_string(link) + ", but 0 to " +
                    std::to_string(chain_.numLinks() - 1) + " and JointChain::kBase");
}

template <typename S>
detail::RobotPartPtr<S> CollisionRobot<S>::read(const Part& part) const {
  return detail::makeRobotPart<S>(chain_.tree(), part.link, part.origin,
                                  part.geometry.get(),
                                  nameOfPart(part.number, part.link));
}

template <typename S>
int CollisionRobot<S>::attach(int link, const Geometry& geometry,
                              const Transform3<double>& origin,
                              const std::vector<int>& touch_links) {
  requireLink(link, "attach");
  for (const int touched : touch_links) requireLink(touched, "attach: touch_links");
  Part part{next_part_, link, geometry, detail::placementOf(origin), touch_links};
  auto of_library = read(part);
  // What comes now does not throw, but for setOwnPairs().
  parts_.reserve(parts_.size() + 1);
  read_.reserve(read_.size() + 1);
  filters_.reserve(filters_.size() + 1);
  parts_.push_back(std::move(part));
  read_.push_back(std::move(of_library));
  filters_.push_back(link_filters_[static_cast<std::size_t>(link + 1)]);
  try {
    setOwnPairs();
  } catch (...) {
    parts_.pop_back();
    read_.pop_back();
    filters_.pop_back();
    throw;
  }
  assert(parts_.size() == read_.size() && parts_.size() == filters_.size());
  return next_part_++;
}

template <typename S>
void CollisionRobot<S>::detach(int part) {
  const auto place = std::find_if(parts_.begin(), parts_.end(),
                                  [&](const Part& one) { return one.number == part; });
  if (place == parts_.end())
    throw Exception("detach: the robot has no part " + std::to_string(part) +
                    ". Give a number that attach() returned, once");
  const auto i = place - parts_.begin();
  parts_.erase(place);
  read_.erase(read_.begin() + i);
  filters_.erase(filters_.begin() + i);
  assert(parts_.size() == read_.size() && parts_.size() == filters_.size());
  const int removed = static_cast<int>(i);
  own_pairs_.erase(std::remove_if(own_pairs_.begin(), own_pairs_.end(),
                                  [removed](const std::pair<int, int>& pair) {
                                    return pair.first == removed ||
                                           pair.second == removed;
                                  }),
                   own_pairs_.end());
  for (auto& pair : own_pairs_) {
    pair.first -= pair.first > removed ? 1 : 0;
    pair.second -= pair.second > removed ? 1 : 0;
  }
}

template <typename S>
void CollisionRobot<S>::update() {
  std::vector<detail::RobotPartPtr<S>> again;
  for (const Part& part : parts_) again.push_back(read(part));
  read_.swap(again);
}

template <typename S>
void CollisionRobot<S>::allow(int link1, int link2) {
  requireLink(link1, "allow");
  requireLink(link2, "allow");
  allowed_.insert(std::minmax({link1, link2}));
  setOwnPairs();
}

template <typename S>
void CollisionRobot<S>::allowNeighbours() {
  for (int i = JointChain::kBase; i < chain_.numLinks(); ++i)
    for (int k = i + 1; k < chain_.numLinks(); ++k)
      if (detail::linkRelation(chain_.tree(), i, k) == detail::LinkRelation::kNeighbours)
        allowed_.insert({i, k});
  setOwnPairs();
}

template <typename S>
bool CollisionRobot<S>::mayTouch(const Part& x, const Part& y) const {
  const auto touches = [](const Part& part, int link) {
    return std::find(part.touch_links.begin(), part.touch_links.end(), link) !=
           part.touch_links.end();
  };
  return allowed_.count(std::minmax({x.link, y.link})) != 0 || touches(x, y.link) ||
         touches(y, x.link) ||
         detail::linkRelation(chain_.tree(), x.link, y.link) ==
             detail::LinkRelation::kFixed;
}

template <typename S>
void CollisionRobot<S>::setOwnPairs() {
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < parts_.size(); ++i)
    for (std::size_t k = i + 1; k < parts_.size(); ++k)
      if (!mayTouch(parts_[i], parts_[k]))
        pairs.emplace_back(static_cast<int>(i), static_cast<int>(k));
  own_pairs_.swap(pairs);
}

template <typename S>
void CollisionRobot<S>::setFilter(int link, std::uint32_t group, std::uint32_t mask) {
  requireLink(link, "setFilter");
  link_filters_[static_cast<std::size_t>(link + 1)] = {group, mask};
  for (std::size_t i = 0; i < parts_.size(); ++i)
    if (parts_[i].link == link) filters_[i] = {group, mask};
}

template <typename S>
void CollisionRobot<S>::setBase(const Transform3<double>& base) {
  const BoundedMotion::Placement placement = detail::placementOf(base);
  // Refuses what is no pose.
  const std::vector<double> still(static_cast<std::size_t>(chain_.numValues()), 0);
  detail::makeChainPath(chain_.tree(), placement, still, still);
  base_ = placement;
}

template <typename S>
bool CollisionRobot<S>::checkEdge(const std::vector<double>& begin,
                                  const std::vector<double>& end,
                                  const Manager* obstacles, const Request& request,
                                  RobotEdgeResult<S>& result) const {
  return checkPath(detail::makeChainPath(chain_.tree(), base_, begin, end), obstacles,
                   request, result);
}

template <typename S>
bool CollisionRobot<S>::checkMotion(const ChainMotion& motion, const Manager* obstacles,
                                    const Request& request,
                                    RobotEdgeResult<S>& result) const {
  if (detail::jointTreeOf(motion.path()) != chain_.tree())
    throw Exception(
        "checkMotion: the motion is not one of this robot's chain. Make it from "
        "CollisionRobot::chain()");
  return checkPath(motion.path(), obstacles, request, result);
}

template <typename S>
bool CollisionRobot<S>::checkPath(const detail::ChainPathPtr& path,
                                  const Manager* obstacles, const Request& request,
                                  RobotEdgeResult<S>& out) const {
  out = RobotEdgeResult<S>();
  RobotEdgeResult<S> result;
  const Step step({read_, filters_, own_pairs_}, path);
  const bool is_any = request.query == ContinuousQuery::kAny;
  const std::vector<detail::RobotPair> pairs =
      step.pairs(obstacles ? &obstacles->boxes_ : nullptr, Manager::settingsOf(request),
                 is_any ? Step::Order::kObstaclesFirst : Step::Order::kTime);
  result.num_box_pairs = pairs.size();
  const bool has_distances = obstacles && !obstacles->distances_.empty();
  Request common = request;
  if (has_distances) detail::addDistance(request, S(0), common);
  auto answers = detail::answersOf<PairResult>(
      pairs, common,
      [&](const detail::RobotPair& pair, Request& asked, PairResult& tested) {
        if (has_distances)
          detail::addDistance(
              request,
              pair.object ? obstacles->distances_.thicknessOf(pair.object) : S(0), asked);
        return test(step, pair, obstacles, asked, tested);
      });
  result.num_tested = answers.num_tested;
  result.pairs = std::move(answers.pairs);
  result.is_free = result.pairs.empty();
  if (!result.is_free)
    result.time_of_contact = result.pairs.front().result.time_of_contact;
  result.joint_values =
      detail::jointValuesAt(path, static_cast<double>(result.time_of_contact));
  out = std::move(result);
  return out.is_free;
}

template <typename S>
std::string CollisionRobot<S>::nameOfObject(const detail::RobotPair& pair,
                                            const Manager* obstacles) const {
  if (pair.object) return obstacles->nameOf(Manager::objectOf(pair.object));
  const Part& part = parts_[static_cast<std::size_t>(pair.part2)];
  return nameOfPart(part.number, part.link);
}

/// Tests a pair. The groups of the objects were tested with their boxes; what is left are
/// groups of triangles. Returns whether the two are in contact.
template <typename S>
bool CollisionRobot<S>::test(const Step& step, const detail::RobotPair& pair,
                             const Manager* obstacles, Request& request,
                             PairResult& tested) const {
  assert(pair.part1 >= 0 && static_cast<std::size_t>(pair.part1) < parts_.size());
  const Part& part1 = parts_[static_cast<std::size_t>(pair.part1)];
  tested.part1 = part1.number;
  tested.link1 = part1.link;
  detail::MovingGeometry<S> body1 = step.part(pair.part1), body2;
  request.filter1 = request.filter2 = ContinuousFilter();
  if (pair.object) {
    tested.object = Manager::objectOf(pair.object);
    const ContinuousFilter& filter = obstacles->filterOf(tested.object);
    if (Manager::hasTriangles(filter)) {
      const auto& own = filters_[static_cast<std::size_t>(pair.part1)];
      request.filter1.group = own.first;
      request.filter1.mask = own.second;
      request.filter2 = filter;
    }
    body2 = detail::movingGeometry<S>(tested.object->collisionGeometry().get(),
                                      tested.object->getMotion(), part1.geometry.get());
  } else {
    assert(pair.part2 >= 0 && static_cast<std::size_t>(pair.part2) < parts_.size());
    const Part& part2 = parts_[static_cast<std::size_t>(pair.part2)];
    tested.part2 = part2.number;
    tested.link2 = part2.link;
    body2 = step.part(pair.part2);
  }
  try {
    if (!detail::collideHere(body1, body2, request, tested.result))
      detail::refuseContacts(body1, body2);
  } catch (const Exception& error) {
    throw Exception("o1 is " + nameOfPart(part1.number, part1.link) + ", o2 is " +
                    nameOfObject(pair, obstacles) + ": " + error.what());
  }
  return tested.result.is_collide;
}

}  // namespace fcl

#endif
