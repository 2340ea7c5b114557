// SPDX-License-Identifier: BSD-3-Clause
//
// The inner loops, compiled for every instruction set and chosen at run time. All give
// the same bits.
#ifndef FCL_CCD_KERNELS_KERNELS_H
#define FCL_CCD_KERNELS_KERNELS_H

#include <algorithm>
#include <cfloat>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "elementary/axis_window.h"
#include "mesh/feature_pairs.h"
#include "mesh/tree_nodes.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A moving box, row r of MovingKdopNode at t0[r * stride] and t1[r * stride]; the
/// stride is 1, or that of a box in a node.
struct BoxView {
  static constexpr std::size_t kInNode = MovingKdopNode::kWidth;
  const float* t0;
  const float* t1;
  std::size_t stride;
  /// As that of a child.
  float displacement;
};

/// @brief Whether what is apart at t = 0 can be left out of a query to which nothing
/// after `latest` matters. Of a larger part of the step it is not worth a look: motion
/// bridges most of what is between boxes then, and their other frame tells more.
inline bool isEarly(double latest) { return latest < 0x1p-4; }

/// @brief Which overlaps of boxes matter to a query.
struct OverlapRequest {
  /// Whether it matters from when on boxes overlap; false: only whether they do at t = 0
  /// does. `earliest` is 0 for those that do, and for the others a number above 0,
  /// FLT_MIN or the right one.
  bool timed;
  /// Boxes a and b are left out if the gap between them at t = 0, along one of the
  /// directions, is larger than share * (a.displacement + b.displacement) + slack;
  /// infinity: none are.
  float share{std::numeric_limits<float>::infinity()};
  float slack{0};

  /// @brief Leaves out boxes that do not meet until `latest`, if that isEarly(). Two
  /// coordinates enter a direction; 2^-20 is more than what the kernels round: three
  /// operations and the sum of two half-axes, 2^-24 each.
  /// @param pose_displacement  of both meshes together
  void leaveOutAfter(double latest, double pose_displacement) {
    const double twice = 2 * (1 + 0x1p-20) * latest;
    share =
        isEarly(latest) ? roundUp(twice, 0.f) : std::numeric_limits<float>::infinity();
    slack = roundUp(twice * pose_displacement, 0.f);
  }
  bool leavesOut() const { return share <= FLT_MAX; }
};

/// @brief Two nodes whose triangles are compared, or, without a shift, one twice: then
/// each pair of different triangles once.
struct LeafPairing {
  const MovingKdopNode& a;
  const MovingKdopNode& b;
  /// Triangles of a that count.
  unsigned lanes;
  /// Added to the boxes of a: row r in frame k, shift[k][r]; null: none.
  const float (*shift)[16];
  /// For each vertex of the tree, whether its fan is embedded: pairs of triangles in one
  /// are left out; null: unknown.
  const std::uint8_t* embedded;
  OverlapRequest request;
};

/// @brief Pairs of children of two nodes, and from when on they overlap.
struct LanePairs {
  static constexpr std::size_t kWidth = MovingKdopNode::kWidth;
  /// Child i of one and j of the other: bit kWidth * i + j.
  std::uint64_t pairs;
  /// For those that are set.
  float earliest[kWidth][kWidth];
  /// Boxes that were compared, in all calls.
  std::uint64_t compared{0};
  /// Pairs that overlap and lie in an embedded fan, in all calls.
  std::uint64_t fan_culled{0};
};

/// @brief Two triangles: vertices 0-2 are a's, 3-5 b's.
struct TrianglePair {
  const TreeVertex* x[6];
  const TreeTriangle* a;
  const TreeTriangle* b;
};

/// @brief A pair of features of one of many triangle pairs: 16 times the number of the
/// triangle pair and a bit of feature_pairs.h.
inline std::uint32_t featureCode(std::uint32_t pair, int bit) {
  return 16 * pair + static_cast<std::uint32_t>(bit);
}

/// @brief The ends of an edge and the corners of a face of a triangle pair.
/// @param code  as of Kernels::cullCrossings()
inline void crossingPoints(const TrianglePair* pairs, std::uint32_t code,
                           const TreeVertex* (&x)[5]) {
  const std::uint32_t on_b = code % 16 / 3, k = code % 16 % 3;
  const TreeVertex* const* edge = pairs[code / 16].x + 3 * on_b;
  const TreeVertex* const* face = pairs[code / 16].x + 3 * (1 - on_b);
  x[0] = edge[k];
  x[1] = edge[(k + 1) % 3];
  for (int i = 0; i < 3; ++i) x[2 + i] = face[i];
}

/// @brief The windows of pairs of features as the tests take them, with a margin.
inline double windowLo(const TimeWindow& w) { return std::max(w.lo - kWindowMargin, 0.); }
inline double windowHi(const TimeWindow& w) { return std::min(w.hi + kWindowMargin, 1.); }

/// @brief Eight pairs of features, of one kind: their points and windows.
struct EightPairs {
  /// Point i of pair k is x[i][k].
  const TreeVertex* x[4][8];
  double lo[8];
  double hi[8];
  ContinuousContactKind kind;

  void set(std::size_t lane, const TreeVertex* const (&points)[4], double window_lo,
           double window_hi) {
    for (std::size_t i = 0; i < 4; ++i) x[i][lane] = points[i];
    lo[lane] = window_lo;
    hi[lane] = window_hi;
  }
};

/// @brief Eight fans of equally many spokes, all closed or all open.
struct EightFans {
  const TreeVertex* center[8];
  const std::uint32_t* spokes[8];
  /// 2 or more, of closed fans 3 or more.
  std::uint32_t count;
  bool is_closed;
};

/// @brief What coplanarityInDoubles() says of up to eight pairs, a bit each; where
/// neither is set, kNever.
struct EightCoplanarities {
  unsigned possible, unclear;
};

/// @brief Decided lanes, a bit each, and the brackets of the contacts.
struct EightAnswers {
  unsigned no, yes;
  double toc_lo[8];
  double toc_hi[8];
};

/// @brief Lanes whose features touch at no time of the window at which the points are
/// coplanar, and lanes that may be plain cases in two parts, a bit each; where to divide
/// the windows.
struct EightDivisions {
  unsigned never_inside, divisible;
  double at[8];
};

/// @brief Directions in which a surface may face: these (bit k of a set) and their
/// opposites (bit k + kNumAxes).
constexpr std::size_t kNumAxes = 13;
constexpr int kAxes[kNumAxes][3] = {
    {1, 0, 0}, {0, 1, 0},  {0, 0, 1}, {1, 1, 0},  {1, -1, 0}, {1, 0, 1},  {1, 0, -1},
    {0, 1, 1}, {0, 1, -1}, {1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};

struct Kernels {
  /// The instruction set, as Highway calls it; "plain" without Highway.
  const char* name;

  /// Sets the boxes in one frame of up to eight vertices that lie at
  /// offsets[axis][vertex] from the origin: roundUp() with a pad of offsetPad().
  /// @param count  1 to 8; so many vertices are written
  void (*fitPoints)(const double (&offsets)[3][8], int frame, std::size_t count,
                    TreeVertex* vertices);

  /// Sets the boxes and displacements of a node's children, from those of the vertices
  /// and of the nodes below: the smallest that hold for all of them.
  /// @param is_still  the boxes of these are the same in both frames
  /// @param[out] extents  of each, along all directions, in both frames
  void (*fitNode)(const TreeVertex* vertices, const MovingKdopNode* nodes, bool is_still,
                  MovingKdopNode& node, float (&extents)[MovingKdopNode::kWidth]);

  /// Which children of the node overlap the box at some time, a bit each, and from when
  /// on: overlapWindow() of each, unless the request leaves it out.
  unsigned (*overlapChildren)(const BoxView& box, const MovingKdopNode& node,
                              const OverlapRequest& request,
                              float (&earliest)[MovingKdopNode::kWidth]);

  /// Pairs of triangles among the children of two nodes, or of one, that overlap at some
  /// time.
  void (*overlapTriangles)(const LeafPairing& leaves, LanePairs& out);

  /// Lists the pairs of features that bits of masks stand for, a mask for each triangle
  /// pair: codes, in ascending order. Returns how many; writes up to 16 more.
  /// @param kept  bits that count
  std::size_t (*listFeatures)(const std::uint16_t* masks, std::size_t count,
                              unsigned kept, std::uint32_t* codes);

  /// Leaves, of pairs of features of one kind, those whose moving boxes overlap, with
  /// their windows: overlapWindow() of each. Returns how many.
  /// @param shift, turned_shift  added to boxes of a's features, and the same with the
  /// halves exchanged; null: none
  /// @param latest  windows that begin later are left out
  /// @param gaps  for each triangle pair: its features are left out if they are further
  /// apart at t = 0, along one of the directions; null: none are
  /// @param codes  with room for 15 more, which may be written
  std::size_t (*cullFeatures)(ContinuousContactKind kind, const TrianglePair* pairs,
                              const KdopShift* shift, const KdopShift* turned_shift,
                              float latest, const float* gaps, std::uint32_t* codes,
                              std::size_t count, TimeWindow* windows);

  /// Leaves, of pairs of an edge and a face, those whose boxes overlap at t = 0; bits 0-2
  /// of the code for an edge of a, 3-5 of b.
  /// @param codes  with room for 15 more, which may be written
  std::size_t (*cullCrossings)(const TrianglePair* pairs, const KdopShift* shift,
                               const KdopShift* turned_shift, std::uint32_t* codes,
                               std::size_t count);

  /// Which of up to eight pairs of triangles are apart at t = 0, a bit each, and stay so
  /// during the first part of the step: the plane of one of the two provably separates
  /// them by more than their vertices can come closer to each other.
  /// @param count  1 to 8
  /// @param share  how much of the step that is, with room for the rounding of a sum and
  /// a product
  /// @param[out] gaps  of each: what is further apart at t = 0, along one of the
  /// directions, does not meet in that part of the step
  unsigned (*areApart)(const TrianglePair* pairs, std::size_t count, double share,
                       float (&gaps)[8]);

  /// Which of up to eight edges may pass through their faces at t = 0, a bit each:
  /// isCrossing() says no to all others.
  /// @param codes  as of cullCrossings()
  /// @param count  1 to 8
  unsigned (*mayCross)(const TrianglePair* pairs, const std::uint32_t* codes,
                       std::size_t count);

  /// Which of eight fans provably stay embedded, a bit each: their triangles meet nowhere
  /// but in what they share, at every time of the step. Along a direction d they all keep
  /// turning the same way, n(t) . d > 0, so that their shadows along d are sectors that
  /// follow each other and the angle that a closed fan goes through cannot change with t;
  /// at t = 0 it goes round once, a ray lies in one sector. The sectors of an open fan
  /// never cover a fixed ray. Then no two sectors overlap.
  unsigned (*areFansEmbedded)(const TreeVertex* vertices, const EightFans& fans);

  /// The directions d that all of up to eight triangles provably face at every time of
  /// the step, n(t) . d > 0, a bit each.
  /// @param count  1 to 8
  std::uint32_t (*facedDirections)(const TreeVertex* vertices,
                                   const TreeTriangle* triangles, std::size_t count);

  /// coplanarityInDoubles() of up to eight pairs of features that cullFeatures() left, in
  /// [windowLo(), min(windowHi(), latest)].
  /// @param count  1 to 8
  EightCoplanarities (*coplanarity)(ContinuousContactKind kind, const TrianglePair* pairs,
                                    const std::uint32_t* codes, const TimeWindow* windows,
                                    std::size_t count, double latest);

  /// The plain cases of solveCoplanarity(): a pair whose volume has one sign, or changes
  /// it once, well inside or outside. What is proved keeps the properties (1) and (2)
  /// there.
  EightAnswers (*solve)(const EightPairs& pairs, double toc_err);

  /// For what solve() leaves. Most of it has a volume that is clear of zero at both ends
  /// of the window: divided where it comes nearest to zero, each part is a plain case.
  EightDivisions (*divide)(const EightPairs& pairs);
};

/// @brief The kernels for this machine.
const Kernels& kernels();

/// @brief The kernels for each instruction set that this machine has, the best first.
std::vector<const Kernels*> allKernels();

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
