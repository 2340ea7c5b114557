// SPDX-License-Identifier: BSD-3-Clause
//
// Eight pairs of features of two bodies that turn, at once.
#ifndef FCL_CCD_ADVANCE_TURNING_PAIRS_H
#define FCL_CCD_ADVANCE_TURNING_PAIRS_H

#include <algorithm>
#include <cassert>
#include <vector>

#include "advance/triangle_advance.h"
#include "bodies/moving_body.h"
#include "fcl/narrowphase/stage_counts.h"
#include "paths/motion_path.h"
#include "query/contact_sink.h"
#include "query/query_options.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief What the advancement of these pairs needs to know of a body.
struct TurningBody {
  const Turn* turn;
  /// Whether vertices move in the frame of the body.
  bool deforms;
  /// Bound on the acceleration of its points during the whole step.
  AccelerationBound acceleration;
};

/// @brief Eight pairs of triangles, one of each body, and a feature of each triangle: VF
/// the first vertex of the first body's and the other's face, EE the first edges.
struct alignas(64) TurningPairs {
  static constexpr int kWidth = 8;

  ContinuousContactKind kind;
  /// Positions by body, frame, corner and coordinate. Where the body does not deform the
  /// second frame has no meaning.
  double corner[2][2][3][3][kWidth]{};
  /// Before the first time the features are apart, and after the second.
  double first[kWidth], last[kWidth];

  /// @param first_corner  the corner of the triangle that comes first
  void setTriangle(int lane, int body, bool deforms, const BodyTriangle& triangle,
                   unsigned first_corner) {
    assert(0 <= lane && lane < kWidth && (body == 0 || body == 1) && first_corner < 3);
    for (int frame = 0; frame < (deforms ? 2 : 1); ++frame)
      for (unsigned i = 0; i < 3; ++i) {
        const Vec& x = triangle.corner[frame][(first_corner + i) % 3];
        corner[body][frame][i][0][lane] = x.x;
        corner[body][frame][i][1][lane] = x.y;
        corner[body][frame][i][2][lane] = x.z;
      }
  }
  /// @brief Repeats a pair in all later lanes.
  void fillUp(int lane) {
    assert(0 <= lane && lane < kWidth);
    for (auto& of_body : corner)
      for (auto& of_frame : of_body)
        for (auto& point : of_frame)
          for (auto& column : point)
            std::fill(column + lane + 1, column + kWidth, column[lane]);
    std::fill(first + lane + 1, first + kWidth, first[lane]);
    std::fill(last + lane + 1, last + kWidth, last[lane]);
  }
};

/// @brief What is asked of them: see BodyTolerance and CurvedOptions.
struct TurningRequest {
  double position_error, rate_error, touching, toc_err, t_max;
};

struct TurningAnswers {
  /// A bit for each pair that has no answer: it needs more than plain steps.
  unsigned open;
  /// Those that come within `touching` of each other; the others are apart.
  unsigned yes;
  /// The bracket of each contact: the features are apart before toc_lo. If toc_hi is
  /// larger, the triangles provably cross at toc_hi.
  double toc_lo[TurningPairs::kWidth];
  double toc_hi[TurningPairs::kWidth];

  /// @brief Whether the bracket of each contact is ordered, and begins while the features
  /// were looked at. For assertions.
  bool areBrackets(const TurningPairs& pairs) const {
    for (int lane = 0; lane < TurningPairs::kWidth; ++lane) {
      if ((yes >> lane & 1U) == 0) continue;
      const double lo = toc_lo[lane], hi = toc_hi[lane], first = pairs.first[lane];
      if (!(first <= lo && lo <= std::max(first, pairs.last[lane]))) return false;
      if (!(lo <= hi && hi <= 1)) return false;
    }
    return true;
  }
};

/// @brief Advances the pairs, as TriangleAdvance::advance() and proveContact() do one.
///
/// Properties: (1) a pair is apart only with a proof; (2) a contact only if the features
/// come within TurningRequest::touching; (3) the answer of a pair does not depend on the
/// other pairs, and has the same bits on all machines.
TurningAnswers advanceTurning(const TurningPairs& pairs, const TurningBody (&body)[2],
                              const TurningRequest& request);

/// @brief That function for each instruction set that this machine has, the best first.
std::vector<decltype(&advanceTurning)> allTurningKernels();

/// @brief What advanceTurning() says of one pair.
struct TurningAnswer {
  bool is_open, is_contact;
  double toc_lo, toc_hi;
};

/// @brief Collects pairs of features until there are eight of a kind, and advances these.
class TurningBatch {
 public:
  /// @pre both bodies are meshes and turn; no distance is requested
  TurningBatch(const MovingBody& a, const MovingBody& b, const QueryOptions& options)
      : body_{bodyOf(a), bodyOf(b)} {
    assert(a.isMesh() && b.isMesh() && body_[0].turn && body_[1].turn);
    assert(!(options.min_distance > 0));
    const BodyTolerance tolerance(a, b, 0);
    request_ = {tolerance.position, tolerance.rate, tolerance.touching, options.toc_err,
                options.t_max};
  }

  struct Pair {
    /// Kept by reference until its answer is there. The triangles are copied.
    const FeatureContact& name;
    const BodyTriangle &a, &b;
    FeaturePair features;
    /// Before the first time the features are apart, and after the second.
    double first, last;
  };

  /// @brief Adds a pair. Calls take(name, answer) for each of eight pairs, if there are
  /// as many.
  template <typename Take>
  void add(const Pair& pair, Take&& take) {
    const bool is_edges = pair.features.kind == ContinuousContactKind::kEdgeEdge;
    const int side = pair.features.first_on_a ? 0 : 1;
    Group& group = groups_[is_edges ? 2 : side];
    assert(group.count < TurningPairs::kWidth);
    assert(0 <= pair.first && pair.first <= 1 && 0 <= pair.last && pair.last <= 1);
    const int lane = group.count++;
    group.side = side;
    group.name[lane] = &pair.name;
    group.pairs.kind = pair.features.kind;
    group.pairs.first[lane] = pair.first;
    group.pairs.last[lane] = pair.last;
    const BodyTriangle* const triangle[2] = {&pair.a, &pair.b};
    const unsigned corner[2] = {pair.features.first, pair.features.second};
    for (int k = 0; k < 2; ++k) {
      const int body = k == 0 ? side : 1 - side;
      group.pairs.setTriangle(lane, k, body_[body].deforms, *triangle[body], corner[k]);
    }
    if (group.count == TurningPairs::kWidth) advance(group, take);
  }

  /// @brief The same for the pairs that are left.
  template <typename Take>
  void finish(Take&& take) {
    for (Group& group : groups_)
      if (group.count > 0) advance(group, take);
  }

 private:
  struct Group {
    TurningPairs pairs;
    const FeatureContact* name[TurningPairs::kWidth];
    /// The body of the first features.
    int side{0};
    int count{0};
  };

  static TurningBody bodyOf(const MovingBody& body) {
    return {body.path().turn(), !body.isRigid(), body.path().acceleration(0, 1)};
  }

  template <typename Take>
  void advance(Group& group, Take&& take) {
    assert(group.count > 0);
    group.pairs.fillUp(group.count - 1);
    const TurningBody body[2] = {body_[group.side], body_[1 - group.side]};
    const TurningAnswers found = advanceTurning(group.pairs, body, request_);
    for (int lane = 0; lane < group.count; ++lane)
      take(*group.name[lane],
           TurningAnswer{(found.open >> lane & 1U) != 0, (found.yes >> lane & 1U) != 0,
                         found.toc_lo[lane], found.toc_hi[lane]});
    group.count = 0;
  }

  TurningBody body_[2];
  TurningRequest request_;
  /// Vertices of a, vertices of b, edges.
  Group groups_[3];
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
