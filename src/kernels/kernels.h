// SPDX-License-Identifier: BSD-3-Clause
//
// The inner loops. They are compiled for every instruction set, and one is chosen at run
// time. All give the same bits.
#ifndef FCL_CCD_KERNELS_KERNELS_H
#define FCL_CCD_KERNELS_KERNELS_H

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "elementary/axis_window.h"
#include "elementary/distance_advance.h"
#include "mesh/bend.h"
#include "mesh/feature_pairs.h"
#include "mesh/tree_nodes.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief A moving box. Row r of MovingKdopNode is at t0[r * stride] and t1[r * stride].
/// The stride is 1 for a single box and kInNode for a box in a node.
struct BoxView {
  static constexpr std::size_t kInNode = MovingKdopNode::kWidth;
  const float* t0;
  const float* t1;
  std::size_t stride;
  /// As MovingKdopNode::displacement.
  float displacement;
  /// What is added to row r of frame k is shift[k][r]; null: nothing.
  const float (*shift)[16]{nullptr};
};

/// @brief Whether a query to which nothing after `latest` matters should first compare
/// boxes at t = 0. For a larger part of the step this does not pay: motion bridges most
/// gaps between boxes, and the box at t = 1 tells more.
inline bool isEarly(double latest) { return latest < 0x1p-4; }

/// @brief Which overlaps of boxes matter to a query.
struct OverlapRequest {
  /// Whether the query needs the time from which on boxes overlap. If false, it only
  /// needs to know whether they overlap at t = 0: `earliest` is 0 for boxes that do, and
  /// a number above 0 for others.
  bool timed;
  /// Boxes a and b are left out if their gap at t = 0 along one of the directions is
  /// larger than share * (a.displacement + b.displacement) + slack. Infinity: none are
  /// left out.
  float share{std::numeric_limits<float>::infinity()};
  float slack{0};

  /// @brief Leaves out boxes that do not overlap until `latest`, if that isEarly(). The
  /// factor 2 is there because a direction has at most two coordinates. 2^-20 is more
  /// than the rounding of the kernels: three operations and the sum of two half-axes,
  /// 2^-24 each. The share is at least 2^-64, which is nothing beside the size of any
  /// motion. So its products with displacements above 2^-62 are normal numbers: with
  /// subnormal ones a comparison takes three times as long.
  /// @param pose_displacement  sum of the displacements of both poses
  void leaveOutAfter(double latest, double pose_displacement) {
    assert(latest >= 0 && pose_displacement >= 0);
    const double twice = 2 * (1 + 0x1p-20) * latest;
    share = isEarly(latest) ? roundUp(std::max(twice, 0x1p-64), 0.f)
                            : std::numeric_limits<float>::infinity();
    slack = roundUp(twice * pose_displacement, 0.f);
    assert(!(share < 2 * latest) && slack >= 0);
  }
  bool leavesOut() const { return share <= FLT_MAX; }
};

/// @brief Two nodes whose triangles are compared. If both are the same node and there is
/// no shift, or is_self, each pair of different triangles is compared once.
struct LeafPairing {
  const MovingKdopNode& a;
  const MovingKdopNode& b;
  /// The triangles of a that are compared, a bit each.
  unsigned lanes;
  /// Added to the boxes of a: row r in frame k, shift[k][r]; null: none.
  const float (*shift)[16];
  /// For each vertex of the tree, whether its fan is embedded. Pairs of triangles in the
  /// same embedded fan are left out. Null: no fan is known to be embedded.
  const std::uint8_t* embedded;
  OverlapRequest request;
  /// Whether the nodes are of one tree in one pose, to which a shift adds a distance.
  bool is_self{false};
};

/// @brief Pairs of children of two nodes, and the times from which on they overlap.
struct LanePairs {
  static constexpr std::size_t kWidth = MovingKdopNode::kWidth;
  /// Child i of one and j of the other: bit kWidth * i + j.
  std::uint64_t pairs;
  /// Set for the pairs whose bit is set.
  float earliest[kWidth][kWidth];
  /// The number of boxes that were compared, in all calls.
  std::uint64_t compared{0};
  /// The number of pairs that overlap and lie in an embedded fan, in all calls.
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
  assert(bit >= 0 && bit < 16);
  assert(pair <= std::numeric_limits<std::uint32_t>::max() / 16);
  return 16 * pair + static_cast<std::uint32_t>(bit);
}
constexpr std::uint32_t codePair(std::uint32_t code) { return code / 16; }
constexpr std::uint32_t codeBit(std::uint32_t code) { return code % 16; }

/// @brief The ends of an edge and the corners of a face of a triangle pair.
/// @param code  as of Kernels::cullCrossings()
inline void crossingPoints(const TrianglePair* pairs, std::uint32_t code,
                           const TreeVertex* (&x)[5]) {
  assert(codeBit(code) < 6);
  const std::uint32_t on_b = codeBit(code) / 3, k = codeBit(code) % 3;
  const TreeVertex* const* edge = pairs[codePair(code)].x + 3 * on_b;
  const TreeVertex* const* face = pairs[codePair(code)].x + 3 * (1 - on_b);
  x[0] = edge[k];
  x[1] = edge[(k + 1) % 3];
  for (int i = 0; i < 3; ++i) x[2 + i] = face[i];
}

/// @brief The windows of pairs of features, with a margin for the tests.
inline double windowLo(const TimeWindow& w) { return std::max(w.lo - kWindowMargin, 0.); }
inline double windowHi(const TimeWindow& w) { return std::min(w.hi + kWindowMargin, 1.); }

/// @brief The points of eight pairs of features, of one kind.
struct EightPoints {
  /// Point i of pair k is x[i][k].
  const TreeVertex* x[4][8];
  ContinuousContactKind kind;

  void set(std::size_t lane, const TreeVertex* const (&points)[4]) {
    assert(lane < 8);
    for (std::size_t i = 0; i < 4; ++i) x[i][lane] = points[i];
  }
};

/// @brief The same, with their windows.
struct EightPairs : EightPoints {
  double lo[8];
  double hi[8];

  void set(std::size_t lane, const TreeVertex* const (&points)[4], double window_lo,
           double window_hi) {
    assert(0 <= window_lo && window_lo <= window_hi && window_hi <= 1);
    EightPoints::set(lane, points);
    lo[lane] = window_lo;
    hi[lane] = window_hi;
  }
};

/// @brief Eight fans with the same number of spokes, all closed or all open.
struct EightFans {
  const TreeVertex* center[8];
  const std::uint32_t* spokes[8];
  /// 2 or more, of closed fans 3 or more.
  std::uint32_t count;
  bool is_closed;
};

/// @brief The answers of coplanarityInDoubles() for up to eight pairs, a bit each. If
/// neither bit of a pair is set, the answer is kNever.
struct EightCoplanarities {
  unsigned possible, unclear;
};

/// @brief Decided lanes, a bit each, and the brackets of the contacts.
struct EightAnswers {
  unsigned no, yes;
  double toc_lo[8];
  double toc_hi[8];
};

/// @brief The points of a pair of features.
struct FourPoints {
  const TreeVertex* x[4];
};

/// @brief The answer of advanceToDistance() for a pair.
struct Approach {
  enum class Answer : std::uint8_t {
    kNo,
    kYes,
    /// It needs more than plain steps, or the ids of its points decide.
    kOpen
  };
  Answer answer;
  /// How its points were put in order: exchangedNumbers().
  std::uint8_t exchanges;
  /// Of a contact, what of its polygon is nearest then; and its bracket.
  std::uint8_t part;
  double toc_lo, toc_hi;

  /// Parts: side k is k, corner k is kCorner + k.
  static constexpr std::uint8_t kCorner = 4, kInside = 8;
};

/// @brief So many pairs Kernels::approach() takes at a time: sixteen eights, so that
/// those that are left fill eights again, and few enough for their state to stay in a
/// near cache.
constexpr std::size_t kMostApproaching = 128;

/// @brief Lanes whose features touch at no time of the window at which the points are
/// coplanar; lanes that may be plain cases in two parts; and the times at which to divide
/// their windows.
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

/// @brief What a moving point sees of up to eight triangles, a bit each.
struct EightViews {
  /// The triangles that provably wind to the left, or to the right, as seen from the
  /// point at every time of the step: the volume of the point, as the origin, and the
  /// triangle is positive, or negative.
  unsigned left, right;
  /// Those of them that a ray from the point provably misses at t = 0.
  unsigned missed;
};

/// @brief The least of lower bounds for triangles during a step, seen from a moving
/// point, for every eighth triangle; 0 where there is none.
struct LeastSight {
  static constexpr double kMost = std::numeric_limits<double>::infinity();

  /// The square of the distance of the point from the plane of a triangle.
  double distance_square[8]{kMost, kMost, kMost, kMost, kMost, kMost, kMost, kMost};
  /// The square of the sine of the angle between a corner and the plane through the point
  /// and the opposite edge.
  double sine_square[8]{kMost, kMost, kMost, kMost, kMost, kMost, kMost, kMost};
};

struct Kernels {
  /// The instruction set, as Highway calls it; "plain" without Highway.
  const char* name;

  /// Sets the boxes in one frame of up to eight vertices that lie at
  /// offsets[axis][vertex] from the origin: roundUp() with kOffsetPad times the farthest
  /// coordinate as pad.
  /// @param count  1 to 8, the number of vertices that are written
  void (*fitPoints)(const double (&offsets)[3][8], int frame, std::size_t count,
                    TreeVertex* vertices);

  /// Sets the boxes and displacements of a node's children: the smallest that contain the
  /// vertices and the nodes below.
  /// @param is_still  the boxes of these are the same in both frames
  /// @param[out] extents  of each, along all directions, in both frames
  void (*fitNode)(const TreeVertex* vertices, const MovingKdopNode* nodes, bool is_still,
                  MovingKdopNode& node, float (&extents)[MovingKdopNode::kWidth]);

  /// Finds the children of the node that overlap the box at some time, a bit each, and
  /// the times from which on they do: overlapWindow() of each, unless the request leaves
  /// it out. With a shift a child is also left out if the exact sums show no overlap,
  /// where overlapWindow() rounds to one.
  unsigned (*overlapChildren)(const BoxView& box, const MovingKdopNode& node,
                              const OverlapRequest& request,
                              float (&earliest)[MovingKdopNode::kWidth]);

  /// Finds the pairs of triangles among the children of two nodes, or of one node, that
  /// overlap at some time.
  void (*overlapTriangles)(const LeafPairing& leaves, LanePairs& out);

  /// Lists the pairs of features whose bits are set in the masks of triangle pairs, as
  /// codes in ascending order. Returns their number. It may write up to 16 codes more.
  /// @param kept  the bits that are listed
  std::size_t (*listFeatures)(const std::uint16_t* masks, std::size_t count,
                              unsigned kept, std::uint32_t* codes);

  /// Keeps, of pairs of features of one kind, those whose moving boxes overlap, with
  /// their windows: overlapWindow() of each. Returns their number.
  /// @param shift, exchanged_shift  added to boxes of a's features, and the same with the
  /// halves exchanged; null: none
  /// @param latest  windows that begin later are left out
  /// @param gaps  a gap for each triangle pair. Its features are left out if they are
  /// further apart than this at t = 0 along one of the directions. Null: none are left
  /// out
  /// @param codes  with room for 15 more, which may be written
  /// @param windows  null: only boxes at t = 0 are compared, with gaps
  std::size_t (*cullFeatures)(ContinuousContactKind kind, const TrianglePair* pairs,
                              const KdopShift* shift, const KdopShift* exchanged_shift,
                              float latest, const float* gaps, std::uint32_t* codes,
                              std::size_t count, TimeWindow* windows);

  /// Keeps, of pairs of an edge and a face, those whose boxes overlap at t = 0. Bits 0-2
  /// of the code are the edges of a, bits 3-5 those of b.
  /// @param codes  with room for 15 more, which may be written
  std::size_t (*cullCrossings)(const TrianglePair* pairs, const KdopShift* shift,
                               const KdopShift* exchanged_shift, std::uint32_t* codes,
                               std::size_t count);

  /// Finds which of up to eight pairs of triangles are apart at t = 0 and stay apart
  /// during the first part of the step, a bit each. The plane of one of the two provably
  /// separates them by more than their vertices can approach each other. With a distance
  /// they stay further apart than this.
  /// @param count  1 to 8
  /// @param share  the length of that part of the step, rounded up by more than the
  /// rounding of a sum and a product
  /// @param distance  0: only apart
  /// @param[out] gaps  a gap for each pair. Features that are further apart than this at
  /// t = 0 along one of the directions do not touch in that part of the step
  unsigned (*areApart)(const TrianglePair* pairs, std::size_t count, double share,
                       double distance, float (&gaps)[8]);

  /// Finds which of up to eight pairs of triangles stay further apart than a distance
  /// during the whole step, a bit each. A direction proves it at both ends of the step:
  /// the normal of one of the two triangles in its middle.
  /// @param count  1 to 8
  /// @param distance  0: only apart. Then paths are not bent
  unsigned (*stayApart)(const TrianglePair* pairs, std::size_t count, double distance,
                        const PairBends& bends);

  /// Finds which of up to eight edges may pass through their faces at t = 0, a bit each.
  /// isCrossing() is false for all others.
  /// @param codes  as of cullCrossings()
  /// @param count  1 to 8
  unsigned (*mayCross)(const TrianglePair* pairs, const std::uint32_t* codes,
                       std::size_t count);

  /// Finds which of eight fans provably stay embedded, a bit each: at every time of the
  /// step their triangles touch only in what they share. All triangles face a direction
  /// d, n(t) . d > 0. So their projections along d are sectors that follow each other.
  /// The total angle of a closed fan cannot change with t, and at t = 0 it is one circle,
  /// since a ray lies in one sector only. The sectors of an open fan never cover a fixed
  /// ray. So no two sectors overlap.
  ///
  /// With a distance: features of two triangles of the fan that have no common vertex
  /// also stay further apart than this. No open fan is proved then. Seen along d, two
  /// such features do not meet, so a vertex of one of them is nearest to a point q of the
  /// other. From an outer vertex a, with the spokes next to it, q is behind the rays of
  /// the two spokes beside that of a, and these are as far from a as the heights of the
  /// triangles over them. If the vertex is the middle of the fan, q is on an edge
  /// opposite to it or behind it. So the distance is at least the least height of the
  /// triangles.
  /// @param distance  0: only embedded
  unsigned (*areFansEmbedded)(const TreeVertex* vertices, const EightFans& fans,
                              double distance);

  /// Finds the directions d that all of up to eight triangles provably face at every time
  /// of the step, n(t) . d > 0, a bit each.
  /// @param count  1 to 8
  std::uint32_t (*facedDirections)(const TreeVertex* vertices,
                                   const TreeTriangle* triangles, std::size_t count);

  /// Finds how up to eight triangles look from a moving point.
  /// @param point  its path; the rest is not read
  /// @param ray  a direction, for EightViews::missed
  /// @param count  1 to 8
  /// @param[in,out] least  takes their bounds; null: not wanted
  EightViews (*viewFrom)(const TreeVertex& point, const double (&ray)[3],
                         const TreeVertex* vertices, const TreeTriangle* triangles,
                         std::size_t count, LeastSight* least);

  /// Finds the corners of a node's triangles over which the height of the triangle, seen
  /// along a direction that it faces, is not proved to stay above a distance: bit 8 k + i
  /// for corner k of child i.
  /// @param direction  its entries are 1, 0 and -1
  /// @pre the node has a triangle
  std::uint32_t (*lowCorners)(const TreeVertex* vertices, const MovingKdopNode& node,
                              const int (&direction)[3], double distance);

  /// coplanarityInDoubles() of up to eight pairs of features that cullFeatures() kept, in
  /// [windowLo(), min(windowHi(), latest)].
  /// @param count  1 to 8
  EightCoplanarities (*coplanarity)(ContinuousContactKind kind, const TrianglePair* pairs,
                                    const std::uint32_t* codes, const TimeWindow* windows,
                                    std::size_t count, double latest);

  /// Finds which of up to eight pairs of features that cullFeatures() kept may be in
  /// contact in [windowLo(), min(windowHi(), t_stop)], a bit each. All others stay
  /// further apart than advanceToDistance() calls a contact: a direction that proves it
  /// at both ends of the window proves it in between.
  /// @param count  1 to 8
  unsigned (*mayComeWithin)(ContinuousContactKind kind, const TrianglePair* pairs,
                            const std::uint32_t* codes, const TimeWindow* windows,
                            std::size_t count, const DistanceRequest& request,
                            const PairBends& bends);

  /// advanceToDistance() of VF or EE pairs of one kind, in any order of their points. The
  /// answer of a pair does not depend on the others, except for whether it is kOpen.
  /// @param count  1 to kMostApproaching
  /// @param[out] answers  as many
  void (*approach)(ContinuousContactKind kind, const FourPoints* pairs, std::size_t count,
                   const DistanceRequest& request, Approach* answers);

  /// approach() of up to eight pairs of features of which only a contact at t = 0
  /// matters. Returns those that may have one, a bit each; all others are further apart
  /// than `cull_distance`.
  /// @param codes  of pairs of the kind; the points are in the order of featureCode()
  /// @param count  1 to 8
  /// @param distance  above 2^-150
  /// @param cull_distance  of cullDistanceOf(), below 2^150
  /// @param[out] answers  of those whose bit is set: kYes or kOpen
  unsigned (*approachAtStart)(ContinuousContactKind kind, const TrianglePair* pairs,
                              const std::uint32_t* codes, std::size_t count,
                              double distance, double cull_distance,
                              Approach (&answers)[8]);

  /// leastDistance() of eight VF or EE pairs at t = 1. Returns the pairs whose answer is
  /// known, a bit each. The others need more than a plain direction.
  unsigned (*leastDistances)(const EightPoints& pairs, double (&least)[8]);

  /// Solves the plain cases of solveCoplanarity(): a pair whose volume has one sign or
  /// changes it once, clearly inside or outside. Proved lanes have the properties (1) and
  /// (2) of that function.
  EightAnswers (*solve)(const EightPairs& pairs, double toc_err);

  /// Divides the windows of pairs that solve() leaves open. Most of them have a volume
  /// that is clearly not zero at both ends of the window. If the window is divided where
  /// the volume comes nearest to zero, each part is a plain case.
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
