// SPDX-License-Identifier: BSD-3-Clause
//
// Boxes against boxes: of nodes, triangles and features.
#include <algorithm>
#include <cassert>
#include <cfloat>
#include <limits>

#if defined(FCL_CCD_USE_HIGHWAY)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/box_kernels.cpp"
#include "hwy/foreach_target.h"
#endif

#include "base/bits.h"
#include "kernels/kernel_functions.h"
#include "kernels/lanes.h"
#include "kernels/vectors.h"

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

#ifndef NDEBUG
/// Whether a box contains point i.
bool contains(const float (&half)[16], const double (&offsets)[3][8], std::size_t i) {
  const double point[3] = {offsets[0][i], offsets[1][i], offsets[2][i]};
  double d[8];
  kdopCoordinates(point, d);
  for (int j = 0; j < 8; ++j)
    if (half[j] < -d[j] || half[j + 8] < d[j]) return false;
  return true;
}

/// Whether the box and the displacement of a child contain those of a vertex.
bool contains(const MovingKdopNode& node, int lane, const TreeVertex& x) {
  const MovingKdop box = node.box(lane);
  for (int j = 0; j < 16; ++j)
    if (box.t0.half[j] < x.box.t0.half[j] || box.t1.half[j] < x.box.t1.half[j])
      return false;
  return !(node.displacement[lane] < static_cast<float>(x.displacement()));
}

/// The same for all children of a node below.
bool contains(const MovingKdopNode& node, int lane, const MovingKdopNode& below) {
  const MovingKdop box = node.box(lane);
  for (int i = 0; i < below.count; ++i) {
    const MovingKdop part = below.box(i);
    for (int j = 0; j < 16; ++j)
      if (box.t0.half[j] < part.t0.half[j] || box.t1.half[j] < part.t1.half[j])
        return false;
    if (node.displacement[lane] < below.displacement[i]) return false;
  }
  return true;
}

bool containsChildren(const TreeVertex* vertices, const MovingKdopNode* nodes,
                      const MovingKdopNode& node) {
  for (int lane = 0; lane < node.count; ++lane) {
    if (!node.isTriangle(lane)) {
      if (!contains(node, lane, nodes[node.child[lane]])) return false;
      continue;
    }
    for (const auto& places : node.places)
      if (!contains(node, lane, vertices[places[lane]])) return false;
  }
  return true;
}

/// Whether the numbers in these lanes are times of the step.
bool areTimes(const float (&times)[8], unsigned lanes) {
  for (; lanes != 0; lanes &= lanes - 1) {
    const float time = times[lowestBit(lanes)];
    if (!(0 <= time && time <= 1)) return false;
  }
  return true;
}

bool areWindows(const TimeWindow* windows, std::size_t count) {
  return std::all_of(windows, windows + count, [](const TimeWindow& w) {
    return 0 <= w.lo && w.lo <= w.hi && w.hi <= 1;
  });
}

bool isAscending(const std::uint32_t* codes, std::size_t count) {
  for (std::size_t i = 1; i < count; ++i)
    if (codes[i] <= codes[i - 1]) return false;
  return true;
}
#endif

void fitPoints(const double (&offsets)[3][8], int frame, std::size_t count,
               TreeVertex* vertices) {
  assert((frame == 0 || frame == 1) && 1 <= count && count <= kEight);
  const Doubles x = load<kEight>(offsets[0]), y = load<kEight>(offsets[1]),
                z = load<kEight>(offsets[2]);
  // As kdopCoordinates().
  const Doubles d[8] = {x, y, z, x + y, x + z, y + z, x - y, x - z};
  const Floats narrow =
      narrowed(max(abs(z), max(abs(y), abs(x))) * broadcast<kEight>(kOffsetPad));
  const Floats infinity = broadcast<kEight>(std::numeric_limits<float>::infinity());
  const Floats pad = select(narrow >= broadcast<kEight>(FLT_MAX), infinity, narrow) +
                     broadcast<kEight>(FLT_MIN);
  const Doubles zero = broadcast<kEight>(0.);
  Floats lower[8], upper[8];
  for (std::size_t j = 0; j < 8; ++j) {
    lower[j] = roundedUp(zero - d[j], pad);
    upper[j] = roundedUp(d[j], pad);
  }
  transpose(lower);
  transpose(upper);
  for (std::size_t i = 0; i < count; ++i) {
    MovingKdop& box = vertices[i].box;
    float(&half)[16] = frame == 0 ? box.t0.half : box.t1.half;
    store(lower[i], half);
    store(upper[i], half + 8);
    assert(contains(half, offsets, i));
  }
}

/// The least, the largest or the sum of the numbers in x, which is overwritten. The
/// numbers are combined two by two: in a chain each operation would wait for the one
/// before.
template <std::size_t kCount, typename Operation>
FCL_CCD_INLINE Floats fold(Floats (&x)[kCount], const Operation& operation) {
  for (std::size_t half = kCount / 2; half > 0; half /= 2)
    for (std::size_t i = 0; i < half; ++i) x[i] = operation(x[i], x[i + half]);
  return x[0];
}

FCL_CCD_INLINE float largest(float a, float b, float c) {
  const float ab = a < b ? b : a;
  return ab < c ? c : ab;
}

/// Eight of the sixteen half-axes of boxes, in one frame.
/// @tparam kFirst  0 for the lower bounds, 8 for the upper ones
template <int kFrame, int kFirst>
struct HalfOfBoxes {
  template <typename Node>
  static FCL_CCD_INLINE auto& row(Node& node, int i) {
    return (kFrame == 0 ? node.t0 : node.t1)[MovingKdopNode::rowOf(kFirst + i)];
  }
  static FCL_CCD_INLINE Floats of(const TreeVertex& x) {
    return load<kEight>((kFrame == 0 ? x.box.t0 : x.box.t1).half + kFirst);
  }
  /// The half-axes of the box around three vertices.
  static FCL_CCD_INLINE Floats around(const TreeVertex& a, const TreeVertex& b,
                                      const TreeVertex& c) {
    return larger(larger(of(a), of(b)), of(c));
  }
  /// The half-axes of the box around all children. Lanes that are not in use have the
  /// least numbers, so that they do not matter.
  static FCL_CCD_INLINE Floats around(const MovingKdopNode& node) {
    Floats x[8];
    for (int i = 0; i < 8; ++i) x[i] = load<kEight>(row(node, i));
    transpose(x);
    return fold(x,
                [](const Floats& a, const Floats& b) HWY_ATTR { return larger(a, b); });
  }
  /// Sets the rows of a node from the boxes of its children. Returns for each child the
  /// sum of its half-axes.
  static FCL_CCD_INLINE Floats set(Floats (&x)[8], MovingKdopNode& node) {
    transpose(x);
    for (int i = 0; i < 8; ++i) store(x[i], row(node, i));
    return fold(x, [](const Floats& a, const Floats& b) HWY_ATTR { return a + b; });
  }
};

template <bool kIsStill>
FCL_CCD_INLINE void fitNodeWhere(const TreeVertex* vertices, const MovingKdopNode* nodes,
                                 MovingKdopNode& node,
                                 float (&extents)[MovingKdopNode::kWidth]) {
  using Lower0 = HalfOfBoxes<0, 0>;
  using Upper0 = HalfOfBoxes<0, 8>;
  using Lower1 = HalfOfBoxes<1, 0>;
  using Upper1 = HalfOfBoxes<1, 8>;
  Floats lower0[8], upper0[8], lower1[8], upper1[8];
  for (int lane = 0; lane < node.count; ++lane) {
    if (node.isTriangle(lane)) {
      const TreeVertex &a = vertices[node.places[0][lane]],
                       &b = vertices[node.places[1][lane]],
                       &c = vertices[node.places[2][lane]];
      lower0[lane] = Lower0::around(a, b, c);
      upper0[lane] = Upper0::around(a, b, c);
      if (!kIsStill) {
        lower1[lane] = Lower1::around(a, b, c);
        upper1[lane] = Upper1::around(a, b, c);
      }
      node.displacement[lane] = largest(static_cast<float>(a.displacement()),
                                        static_cast<float>(b.displacement()),
                                        static_cast<float>(c.displacement()));
    } else {
      const MovingKdopNode& child = nodes[node.child[lane]];
      lower0[lane] = Lower0::around(child);
      upper0[lane] = Upper0::around(child);
      if (!kIsStill) {
        lower1[lane] = Lower1::around(child);
        upper1[lane] = Upper1::around(child);
      }
      node.displacement[lane] = largest(load<kEight>(child.displacement));
    }
  }
  for (int lane = node.count; lane < MovingKdopNode::kWidth; ++lane) {
    lower0[lane] = upper0[lane] = lower1[lane] = upper1[lane] =
        broadcast<kEight>(kLeastHalf);
    node.displacement[lane] = 0;
  }
  const Floats before = Lower0::set(lower0, node) + Upper0::set(upper0, node);
  if (kIsStill) {
    for (int r = 0; r < 16; ++r) store(load<kEight>(node.t0[r]), node.t1[r]);
    store(before + before, extents);
  } else {
    store(before + (Lower1::set(lower1, node) + Upper1::set(upper1, node)), extents);
  }
}

void fitNode(const TreeVertex* vertices, const MovingKdopNode* nodes, bool is_still,
             MovingKdopNode& node, float (&extents)[MovingKdopNode::kWidth]) {
  assert(0 < node.count && node.count <= MovingKdopNode::kWidth);
  if (is_still)
    fitNodeWhere<true>(vertices, nodes, node, extents);
  else
    fitNodeWhere<false>(vertices, nodes, node, extents);
  assert(containsChildren(vertices, nodes, node));
}

/// Makes the windows of boxes smaller, see overlapWindow(). s0 and s1 are the depths
/// along one half-axis at both ends of the step: `before` and `after` are the parts of
/// the step that this direction cuts off at the beginning and at the end.
template <std::size_t N>
FCL_CCD_INLINE void addLoss(const Lanes<float, N>& s0, const Lanes<float, N>& s1,
                            Lanes<float, N>& before, Lanes<float, N>& after) {
  const Lanes<float, N> least = smaller(s0, s1), most = larger(s0, s1);
  const Lanes<float, N> loss = least / (least - most) * broadcast<N>(kLossDown);
  before = larger(before, whereNegative(s0, loss));
  after = larger(after, whereNegative(s1, loss));
}

/// Half-axes of boxes that are moved: as shifted().
template <std::size_t N>
FCL_CCD_INLINE Lanes<float, N> movedBy(const Lanes<float, N>& half,
                                       const Lanes<float, N>& shift) {
  const Lanes<float, N> sum = half + shift;
  return larger(sum + abs(sum) * broadcast<N>(kOutward), broadcast<N>(kLeastHalf));
}

/// The overlap depths of a box and the children of a node, along one half-axis in one
/// frame. They are rounded outward: see shifted().
template <std::size_t kStride, bool kShifted, int kFrame>
FCL_CCD_INLINE Floats depthsAlong(const BoxView& box, const MovingKdopNode& node,
                                  std::size_t r) {
  const float half = (kFrame == 0 ? box.t0 : box.t1)[r * kStride];
  // Row r ^ 1 is the opposite half-axis.
  return broadcast<kEight>(kShifted ? shifted(half, box.shift[kFrame][r]) : half) +
         load<kEight>((kFrame == 0 ? node.t0 : node.t1)[r ^ 1]);
}

/// Numbers with the signs of these depths. With a shift they have the signs of the sums
/// without rounding, or are above: the float nearest to the sum of two half-axes is not
/// below minus the shift if the sum is not.
template <std::size_t kStride, bool kShifted, int kFrame>
FCL_CCD_INLINE Floats depthSigns(const BoxView& box, const MovingKdopNode& node,
                                 std::size_t r) {
  const Floats sum = broadcast<kEight>((kFrame == 0 ? box.t0 : box.t1)[r * kStride]) +
                     load<kEight>((kFrame == 0 ? node.t0 : node.t1)[r ^ 1]);
  return kShifted ? sum + broadcast<kEight>(box.shift[kFrame][r]) : sum;
}

/// The children that the request does not leave out: they are near enough to the box at t
/// = 0. Sets `apart` to those of them that do not overlap the box at t = 0.
/// @param start  the box at t = 0 with what is added to it, with the stride of `box`
template <std::size_t kStride>
FCL_CCD_INLINE unsigned nearChildren(const BoxView& box, const float* start,
                                     const MovingKdopNode& node,
                                     const OverlapRequest& request, unsigned& apart) {
  // Row r ^ 1 is the opposite half-axis.
  Floats s[16];
  for (std::size_t r = 0; r < 16; ++r)
    s[r] = broadcast<kEight>(start[r * kStride]) + load<kEight>(node.t0[r ^ 1]);
  const Floats least =
      fold(s, [](const Floats& a, const Floats& b) HWY_ATTR { return smaller(a, b); });
  const Floats displacement =
      load<kEight>(node.displacement) + broadcast<kEight>(box.displacement);
  const Floats bridged =
      displacement * broadcast<kEight>(request.share) + broadcast<kEight>(request.slack);
  const unsigned near = bits(least + bridged >= broadcast<kEight>(0.f)) & node.lanes();
  apart = signs(least) & near;
  return near;
}

/// @param start  as of nearChildren(); only read if kLeavesOut
template <std::size_t kStride, bool kShifted, bool kLeavesOut>
FCL_CCD_INLINE unsigned overlapEight(const BoxView& box, const float* start,
                                     const MovingKdopNode& node,
                                     const OverlapRequest& request,
                                     float (&earliest)[MovingKdopNode::kWidth]) {
  unsigned left = node.lanes();
  if (kLeavesOut) {
    unsigned open = 0;
    left = nearChildren<kStride>(box, start, node, request, open);
    if (open == 0) {
      store(broadcast<kEight>(0.f), earliest);
      return left;
    }
  }
  constexpr std::size_t kRows = 16;
  Floats s0[kRows], s1[kRows];
  Floats apart = broadcast<kEight>(1.f), cut0 = apart, cut1 = apart;
  for (std::size_t r = 0; r < kRows; ++r) {
    s0[r] = depthSigns<kStride, kShifted, 0>(box, node, r);
    s1[r] = depthSigns<kStride, kShifted, 1>(box, node, r);
    apart = eitherNegative(apart, bothNegative(s0[r], s1[r]));
    cut0 = eitherNegative(cut0, s0[r]);
    cut1 = eitherNegative(cut1, s1[r]);
  }
  left &= ~signs(apart);
  if (left == 0) return 0;
  // Only a window that is cut at both ends can be empty.
  if ((signs(request.timed ? cut0 : bothNegative(cut0, cut1)) & left) == 0) {
    store(whereNegative(cut0, broadcast<kEight>(FLT_MIN)), earliest);
    return left;
  }
  Floats before = broadcast<kEight>(0.f), after = before;
  for (std::size_t r = 0; r < kRows; ++r) {
    if (kShifted) {
      s0[r] = depthsAlong<kStride, kShifted, 0>(box, node, r);
      s1[r] = depthsAlong<kStride, kShifted, 1>(box, node, r);
    }
    addLoss(s0[r], s1[r], before, after);
  }
  const Floats hi = broadcast<kEight>(kWindowEnd) - after;
  store(before, earliest);
  return left & bits(before <= hi);
}

template <std::size_t kStride, bool kShifted, bool kLeavesOut>
unsigned overlapBox(const BoxView& box, const MovingKdopNode& node,
                    const OverlapRequest& request,
                    float (&earliest)[MovingKdopNode::kWidth]) {
  float moved[16 * kStride];
  if (kShifted && kLeavesOut)
    for (std::size_t r = 0; r < 16; ++r)
      moved[r * kStride] = shifted(box.t0[r * kStride], box.shift[0][r]);
  return overlapEight<kStride, kShifted, kLeavesOut>(box, kShifted ? moved : box.t0, node,
                                                     request, earliest);
}

unsigned overlapChildren(const BoxView& box, const MovingKdopNode& node,
                         const OverlapRequest& request,
                         float (&earliest)[MovingKdopNode::kWidth]) {
  constexpr std::size_t kInNode = BoxView::kInNode;
  const bool is_single = box.stride == 1;
  assert(is_single || box.stride == kInNode);
  const auto overlap =
      request.leavesOut()
          ? (box.shift ? (is_single ? &overlapBox<1, true, true>
                                    : &overlapBox<kInNode, true, true>)
                       : (is_single ? &overlapBox<1, false, true>
                                    : &overlapBox<kInNode, false, true>))
          : (box.shift ? (is_single ? &overlapBox<1, true, false>
                                    : &overlapBox<kInNode, true, false>)
                       : (is_single ? &overlapBox<1, false, false>
                                    : &overlapBox<kInNode, false, false>));
  const unsigned found = overlap(box, node, request, earliest);
  assert((found & ~node.lanes()) == 0 && areTimes(earliest, found));
  return found;
}

/// The triangles of node b that lie in an embedded fan with a triangle of node a.
FCL_CCD_INLINE unsigned trianglesInFans(const MovingKdopNode& a, std::size_t lane,
                                        const MovingKdopNode& b,
                                        const std::uint8_t* embedded) {
  const auto first = load<kEight>(b.places[0]), second = load<kEight>(b.places[1]),
             third = load<kEight>(b.places[2]);
  const auto at = [&](std::uint32_t vertex) {
    // If the fan is not embedded, a number that is not the place of any vertex.
    const auto place = broadcast<kEight>(vertex | (std::uint32_t{embedded[vertex]} - 1));
    return (first == place) | (second == place) | (third == place);
  };
  return bits(at(a.places[0][lane]) | at(a.places[1][lane]) | at(a.places[2][lane]));
}

template <bool kShifted, bool kLeavesOut>
FCL_CCD_INLINE void overlapLeaves(const LeafPairing& leaves, LanePairs& out) {
  const MovingKdopNode &a = leaves.a, &b = leaves.b;
  assert((leaves.lanes & ~a.triangles) == 0);
  // All boxes of a are moved side by side: one by one they would take as long as the
  // comparisons.
  float moved[16][MovingKdopNode::kWidth];
  if (kShifted && kLeavesOut)
    for (std::size_t r = 0; r < 16; ++r)
      store(movedBy(load<kEight>(a.t0[r]), broadcast<kEight>(leaves.shift[0][r])),
            moved[r]);
  std::uint64_t pairs = 0;
  unsigned fan_culled = 0;
  for (unsigned lanes = leaves.lanes; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::size_t>(lowestBit(lanes));
    unsigned left = b.triangles;
    // If a tree is compared with itself, each pair is compared once. Otherwise the two
    // may be one node of a tree in two poses, and all pairs are compared.
    if ((!kShifted || leaves.is_self) && &a == &b) left &= ~((2U << lane) - 1);
    if (left == 0) continue;
    const BoxView box{&a.t0[0][lane], &a.t1[0][lane], BoxView::kInNode,
                      a.displacement[lane], leaves.shift};
    left &= overlapEight<BoxView::kInNode, kShifted, kLeavesOut>(
        box, kShifted ? &moved[0][lane] : box.t0, b, leaves.request, out.earliest[lane]);
    if (leaves.embedded) {
      const unsigned fan = left & trianglesInFans(a, lane, b, leaves.embedded);
      fan_culled += static_cast<unsigned>(countBits(fan));
      left &= ~fan;
    }
    assert((left & ~b.triangles) == 0 && areTimes(out.earliest[lane], left));
    pairs |= std::uint64_t{left} << (LanePairs::kWidth * lane);
  }
  out.pairs = pairs;
  out.compared += static_cast<unsigned>(b.count * countBits(leaves.lanes));
  out.fan_culled += fan_culled;
}

void overlapTriangles(const LeafPairing& leaves, LanePairs& out) {
  if (leaves.request.leavesOut())
    leaves.shift ? overlapLeaves<true, true>(leaves, out)
                 : overlapLeaves<false, true>(leaves, out);
  else
    leaves.shift ? overlapLeaves<true, false>(leaves, out)
                 : overlapLeaves<false, false>(leaves, out);
}

std::size_t listFeatures(const std::uint16_t* masks, std::size_t count, unsigned kept,
                         std::uint32_t* codes) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned mask = masks[i] & kept;
    storeCounted(mask, featureCode(static_cast<std::uint32_t>(i), 0), codes + size);
    size += static_cast<std::size_t>(countBits(mask));
  }
  assert(isAscending(codes, size));
  return size;
}

/// The box of a vertex in one frame.
template <int kFrame>
FCL_CCD_INLINE HalfAxes boxOf(const TreeVertex& x) {
  return load<16>(kFrame == 0 ? x.box.t0.half : x.box.t1.half);
}

/// The overlap depths of a pair of features in one frame. The order of the two features
/// matters only for the shift.
template <ContinuousContactKind kind, bool kShifted, int kFrame>
FCL_CCD_INLINE HalfAxes depths(const TrianglePair& pair, std::size_t bit,
                               const KdopShift* shift, const KdopShift* exchanged_shift) {
  const auto box = [&pair](std::size_t i) { return boxOf<kFrame>(*pair.x[i]); };
  HalfAxes first, second;
  const KdopShift* add = shift;
  if (kind == ContinuousContactKind::kVertexFace) {
    // The vertex is vertex `bit` of the pair. `face` is the first vertex of the other
    // triangle.
    const bool on_a = bit < 3;
    const std::size_t face = on_a ? 3 : 0;
    first = box(bit);
    second = larger(larger(box(face), box(face + 1)), box(face + 2));
    add = on_a ? shift : exchanged_shift;
  } else {
    const unsigned char(&ends)[4] = kFeaturePoints[bit];
    first = larger(box(ends[0]), box(ends[1]));
    second = larger(box(ends[2]), box(ends[3]));
  }
  if (kShifted) first = movedBy(first, load<16>((kFrame == 0 ? add->t0 : add->t1).half));
  return first + swapHalves(second);
}

/// Keeps the codes for which keeps(code) is true, and returns their number. It does
/// sixteen at a time: the place of a code depends on all codes before it, and later reads
/// would wait for each of them.
template <typename Keeps>
FCL_CCD_INLINE std::size_t keepCodes(std::uint32_t* codes, std::size_t count,
                                     const Keeps& keeps) {
  std::size_t kept = 0;
  for (std::size_t first = 0; first < count; first += kSixteen) {
    const std::size_t size = count - first < kSixteen ? count - first : kSixteen;
    unsigned mask = 0;
    for (std::size_t i = 0; i < size; ++i) mask |= unsigned{keeps(codes[first + i])} << i;
    storeSelected(mask, codes + first, codes + kept);
    kept += static_cast<std::size_t>(countBits(mask));
  }
  return kept;
}

template <ContinuousContactKind kind, bool kShifted>
FCL_CCD_INLINE std::size_t cullFeaturesWhere(const TrianglePair* pairs,
                                             const KdopShift* shift,
                                             const KdopShift* exchanged_shift,
                                             float latest, const float* gaps,
                                             std::uint32_t* codes, std::size_t count,
                                             TimeWindow* windows) {
  const auto at0 = [&](std::uint32_t code) {
    return depths<kind, kShifted, 0>(pairs[codePair(code)], codeBit(code), shift,
                                     exchanged_shift);
  };
  const auto at1 = [&](std::uint32_t code) {
    return depths<kind, kShifted, 1>(pairs[codePair(code)], codeBit(code), shift,
                                     exchanged_shift);
  };
  // One loop for each comparison of the boxes, so that no branch depends on the boxes.
  if (gaps)
    count = keepCodes(codes, count, [&](std::uint32_t code) HWY_ATTR {
      return isAll(at0(code) >= broadcast<16>(-gaps[codePair(code)]));
    });
  if (!windows) return count;
  count = keepCodes(codes, count, [&](std::uint32_t code) HWY_ATTR {
    return !isAnyNegative(bothNegative(at0(code), at1(code)));
  });
  std::size_t kept = 0;
  for (std::size_t first = 0; first < count; first += kSixteen) {
    TimeWindow found[kSixteen];
    const std::size_t size = count - first < kSixteen ? count - first : kSixteen;
    unsigned meets = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::uint32_t code = codes[first + i];
      HalfAxes before = broadcast<16>(0.f), after = before;
      addLoss(at0(code), at1(code), before, after);
      const float lo = largest(before), hi = kWindowEnd - largest(after);
      found[i] = {lo, hi < 1.f ? hi : 1.f};
      meets |= unsigned{lo <= (hi < latest ? hi : latest)} << i;
    }
    storeSelected(meets, codes + first, codes + kept);
    for (std::size_t i = 0; i < size; ++i) {
      windows[kept] = found[i];
      kept += meets >> i & 1U;
    }
  }
  assert(kept <= count && areWindows(windows, kept));
  return kept;
}

std::size_t cullFeatures(ContinuousContactKind kind, const TrianglePair* pairs,
                         const KdopShift* shift, const KdopShift* exchanged_shift,
                         float latest, const float* gaps, std::uint32_t* codes,
                         std::size_t count, TimeWindow* windows) {
  constexpr ContinuousContactKind kVf = ContinuousContactKind::kVertexFace,
                                  kEe = ContinuousContactKind::kEdgeEdge;
  assert((kind == kVf || kind == kEe) && (gaps || windows));
  assert(!shift || exchanged_shift);
  const auto cull =
      kind == kVf
          ? (shift ? &cullFeaturesWhere<kVf, true> : &cullFeaturesWhere<kVf, false>)
          : (shift ? &cullFeaturesWhere<kEe, true> : &cullFeaturesWhere<kEe, false>);
  return cull(pairs, shift, exchanged_shift, latest, gaps, codes, count, windows);
}

std::size_t cullCrossings(const TrianglePair* pairs, const KdopShift* shift,
                          const KdopShift* exchanged_shift, std::uint32_t* codes,
                          std::size_t count) {
  assert(!shift || exchanged_shift);
  return keepCodes(codes, count, [&](std::uint32_t code) HWY_ATTR {
    const TreeVertex* x[5];
    crossingPoints(pairs, code, x);
    const bool on_a = codeBit(code) < 3;
    HalfAxes edge = larger(boxOf<0>(*x[0]), boxOf<0>(*x[1]));
    if (shift) edge = movedBy(edge, load<16>((on_a ? shift : exchanged_shift)->t0.half));
    const HalfAxes face =
        larger(larger(boxOf<0>(*x[2]), boxOf<0>(*x[3])), boxOf<0>(*x[4]));
    return !isAnyNegative(edge + swapHalves(face));
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();
