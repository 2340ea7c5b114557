// SPDX-License-Identifier: BSD-3-Clause
//
// Takes compounds apart: the pairs of parts that come near, each as a pair of moving
// geometries, and one answer from theirs.
#ifndef FCL_CCD_API_COMPOUND_QUERY_H
#define FCL_CCD_API_COMPOUND_QUERY_H

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "broadphase/broad_phase.h"
#include "fcl/common/exception.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "paths/offset_path.h"
#include "prepare/checked_request.h"
#include "prepare/object_bounds.h"
#include "prepare/query_arguments.h"

namespace fcl {
namespace detail {

/// @brief An object of a query, as its parts. Another geometry than a compound is one
/// part with the number -1.
template <typename S>
class CompoundSide {
 public:
  /// @param placed, name  what they refer to lives as long as this
  /// @throws fcl::Exception  it has no parts; its path is not defined
  CompoundSide(const PlacedGeometry<S>& placed, const char* name);

  int count() const { return parts_ ? static_cast<int>(parts_->parts.size()) : 1; }
  int number(int i) const { return parts_ ? i : -1; }
  bool isCompound() const { return parts_ != nullptr; }

  /// @brief Adds the bounds of all parts.
  void appendBounds(deformable::BoundsList& list) const;
  /// @brief Adds the bounds of the parts that meet another object.
  /// @param poses  of path()
  /// @return their numbers
  /// @pre it is a compound
  std::vector<int> appendNear(const deformable::MovingBounds& other, double distance,
                              PathPoses& poses, deformable::BoundsList& list) const;
  /// @brief Adds the bounds of the object as one.
  /// @param poses  of path(); null: it is no compound
  void appendWhole(PathPoses* poses, deformable::BoundsList& list) const;
  /// @brief Of a compound; null: it is none.
  const deformable::MotionPath* path() const { return path_ ? &*path_ : nullptr; }

  /// @brief A part and its motion.
  class MovingPart;

 private:
  using Part = typename CompoundParts<S>::Part;
  const Part& part(int i) const { return parts_->parts[static_cast<std::size_t>(i)]; }
  void appendPart(int i, PathPoses& poses, int most_spans,
                  deformable::BoundsList& list) const;

  const char* name_;
  /// Null: no compound.
  const CompoundParts<S>* parts_;
  MovingGeometry<S> body_;
  std::optional<deformable::MotionPath> path_;
};

template <typename S>
class CompoundSide<S>::MovingPart {
 public:
  /// @param side  lives as long as this
  MovingPart(const CompoundSide& side, int i);
  MovingPart(const MovingPart&) = delete;
  MovingPart& operator=(const MovingPart&) = delete;

  const MovingGeometry<S>& moving() const { return moving_; }

 private:
  std::optional<deformable::OffsetPath> path_;
  MovingGeometry<S> moving_;
};

/// @brief Two parts whose boxes meet at t_lo or up to toc_err later.
struct PartPair {
  double t_lo;
  int part1, part2;
};

/// @brief Two objects, of which one or both are compounds.
template <typename S>
class CompoundPair {
 public:
  /// @param o1, o2  live as long as this
  /// @throws fcl::Exception  as CompoundSide
  CompoundPair(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2);

  /// @brief Refuses groups of triangles for a compound.
  void requireNoTriangleGroups(const CheckedRequest& request) const;

  /// @brief The pairs that can be in contact, sorted by time, then by number.
  std::vector<PartPair> near(const deformable::QueryOptions& options) const;

  /// @brief Calls visit(pair) with pairs that may come within a limit, near ones first.
  /// @param visit  returns the limit from then on
  /// @return whether a pair was left out
  bool visitNearest(double limit,
                    const std::function<double(const PartPair&)>& visit) const;

  /// @brief Calls query(o1, o2) with two parts. Its exceptions get the numbers of these.
  template <typename Query>
  void ask(const PartPair& pair, const Query& query) const {
    try {
      const typename CompoundSide<S>::MovingPart part1(side1_, pair.part1),
          part2(side2_, pair.part2);
      query(PlacedGeometry<S>(part1.moving()), PlacedGeometry<S>(part2.moving()));
    } catch (const Exception& error) {
      throw Exception(nameOf(pair) + ": " + error.what());
    }
  }

  int number1(const PartPair& pair) const { return side1_.number(pair.part1); }
  int number2(const PartPair& pair) const { return side2_.number(pair.part2); }

 private:
  std::string nameOf(const PartPair& pair) const;

  CompoundSide<S> side1_, side2_;
};

/// @brief What a query said of two parts.
template <typename S>
struct PartAnswer {
  struct Result : ContinuousContacts<S> {
    QueryOutcome<S> outcome;
  };
  int part1, part2;
  Result result;
};

/// @brief The first contact of all.
template <typename S>
QueryOutcome<S> earliestOf(const std::vector<PartAnswer<S>>& answers);

/// @brief The contacts of all, as those of one pair.
template <typename S>
ContinuousContacts<S> joinedContacts(std::vector<PartAnswer<S>> answers,
                                     const deformable::QueryOptions& options);

}  // namespace detail
}  // namespace fcl

#endif
