// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_PREPARED_SHAPES_H
#define FCL_CCD_PREPARE_PREPARED_SHAPES_H

#include <optional>

#include "prepare/prepared_motion.h"
#include "query/query_answer.h"

namespace fcl {
namespace detail {

/// @brief Two objects made ready for a query, of which one is a shape or an octree at
/// least. A shape is converted once. Lengths of shapes may be scaled, so that products of
/// them are in the range of doubles.
class PreparedShapes {
 public:
  /// @pre one of them is bounded, no plane or halfspace; the poses are finite; the
  /// floating-point mode is the default one
  /// @throws fcl::Exception  as PreparedMotion and scaleOf()
  template <typename S>
  PreparedShapes(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                 const deformable::QueryOptions& options);

  /// @brief Whether two shapes overlap at t = 0, as far as a look at their first poses
  /// shows. Many programs ask about such pairs, and the rest costs more: there are no
  /// bodies then. Only if the options ask for a time only.
  bool overlapAtStart() const { return overlap_at_start_; }

  /// @brief Whether one is an octree without occupied cells, which has no body.
  bool areEmpty() const { return are_empty_; }

  const deformable::MovingBody& a() const { return motion_[0]->body(); }
  const deformable::MovingBody& b() const { return motion_[1]->body(); }

  /// @brief The options for these bodies.
  const deformable::QueryOptions& options() const { return options_; }

  /// @brief Gives an answer about these bodies its true lengths.
  void unscale(deformable::QueryAnswer& answer) const;

  double updateTime() const;

 private:
  using Shapes = std::optional<deformable::ConvexShape>[2];

  template <typename S>
  static bool areFoundToOverlap(const PlacedGeometry<S>* const (&object)[2], int first,
                                Shapes& shapes);
  template <typename S>
  void prepare(const PlacedGeometry<S>* const (&object)[2], int first, Shapes& shapes);

  deformable::QueryOptions options_;
  std::optional<deformable::PreparedMotion> motion_[2];
  /// A power of two.
  double scale_{1};
  bool overlap_at_start_{false};
  bool are_empty_{false};
};

}  // namespace detail
}  // namespace fcl

#endif
