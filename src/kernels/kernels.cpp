// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/detail/deformable/kernels.h"

#include <algorithm>
#include <cfloat>
#include <cmath>

#if defined(FCL_CCD_USE_HIGHWAY)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/kernels.cpp"
#include "hwy/foreach_target.h"
#endif

#include "error_bounds.h"
#include "kernels/lanes.h"

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

/// The parts of the step that half-axes leave out, see overlapWindow(): for depths s0 and
/// s1 at its ends, how much of it is lost before and after.
template <std::size_t N>
HWY_INLINE void addLoss(const Lanes<float, N>& s0, const Lanes<float, N>& s1,
                        Lanes<float, N>& before, Lanes<float, N>& after) {
  const Lanes<float, N> least = smaller(s0, s1), most = larger(s0, s1);
  const Lanes<float, N> loss = least / (least - most) * broadcast<N>(kLossDown);
  before = larger(before, whereNegative(s0, loss));
  after = larger(after, whereNegative(s1, loss));
}

template <std::size_t kStride>
HWY_INLINE unsigned overlapChildren(const BoxView& box, const MovingKdopNode& node,
                                    bool timed,
                                    float (&earliest)[MovingKdopNode::kWidth]) {
  constexpr std::size_t kRows = 16;
  Floats s0[kRows], s1[kRows];
  Floats apart = broadcast<kEight>(1.f), cut0 = apart, cut1 = apart;
  for (std::size_t r = 0; r < kRows; ++r) {
    // Row r ^ 1 is the opposite half-axis.
    s0[r] = broadcast<kEight>(box.t0[r * kStride]) + load<kEight>(node.rows[r ^ 1].t0);
    s1[r] = broadcast<kEight>(box.t1[r * kStride]) + load<kEight>(node.rows[r ^ 1].t1);
    apart = eitherNegative(apart, bothNegative(s0[r], s1[r]));
    cut0 = eitherNegative(cut0, s0[r]);
    cut1 = eitherNegative(cut1, s1[r]);
  }
  const unsigned left = ~signs(apart) & node.lanes();
  if (left == 0) return 0;
  // A window that is cut at one end only is not empty.
  if ((signs(timed ? cut0 : bothNegative(cut0, cut1)) & left) == 0) {
    store(whereNegative(cut0, broadcast<kEight>(FLT_MIN)), earliest);
    return left;
  }
  Floats before = broadcast<kEight>(0.f), after = before;
  for (std::size_t r = 0; r < kRows; ++r) addLoss(s0[r], s1[r], before, after);
  const Floats hi = broadcast<kEight>(kWindowEnd) - after;
  store(before, earliest);
  return left & bits(before <= hi);
}

unsigned overlapChildrenOf(const BoxView& box, const MovingKdopNode& node, bool timed,
                           float (&earliest)[MovingKdopNode::kWidth]) {
  return box.stride == 1 ? overlapChildren<1>(box, node, timed, earliest)
                         : overlapChildren<BoxView::kInNode>(box, node, timed, earliest);
}

/// Which of the node's triangles have one of `count` vertices (places in the tree).
HWY_INLINE unsigned trianglesAt(const std::uint32_t* places, std::size_t count,
                                const MovingKdopNode& node) {
  const auto first = load<kEight>(node.places[0]), second = load<kEight>(node.places[1]),
             third = load<kEight>(node.places[2]);
  unsigned found = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto place = broadcast<kEight>(places[i]);
    found |= bits((first == place) | (second == place) | (third == place));
  }
  return found;
}

/// The triangles of a node that lie in an embedded fan with a triangle of another.
HWY_INLINE unsigned trianglesInFans(const MovingKdopNode& a, std::size_t lane,
                                    const MovingKdopNode& b,
                                    const std::uint8_t* embedded) {
  std::uint32_t places[3];
  std::size_t count = 0;
  for (const auto& row : a.places) {
    places[count] = row[lane];
    count += embedded[row[lane]];
  }
  return trianglesAt(places, count, b);
}

template <bool kShifted>
HWY_INLINE void overlapTriangles(const LeafPairing& leaves, LanePairs& out) {
  const MovingKdopNode &a = leaves.a, &b = leaves.b;
  const unsigned triangles = b.triangles();
  for (unsigned lanes = leaves.lanes; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::size_t>(__builtin_ctz(lanes));
    float earliest[MovingKdopNode::kWidth];
    unsigned left = triangles;
    if (&a == &b) left &= ~((2U << lane) - 1);
    if (left == 0) continue;
    if constexpr (kShifted) {
      float moved[2][16];
      for (std::size_t r = 0; r < 16; ++r) {
        moved[0][r] = std::max(a.rows[r].t0[lane] + leaves.shift[0][r], kLeastHalf);
        moved[1][r] = std::max(a.rows[r].t1[lane] + leaves.shift[1][r], kLeastHalf);
      }
      left &= overlapChildren<1>({moved[0], moved[1], 1}, b, leaves.timed, earliest);
    } else {
      const BoxView box{&a.rows[0].t0[lane], &a.rows[0].t1[lane], BoxView::kInNode};
      left &= overlapChildren<BoxView::kInNode>(box, b, leaves.timed, earliest);
    }
    if (left != 0 && leaves.embedded) {
      const unsigned fan = left & trianglesInFans(a, lane, b, leaves.embedded);
      out.fan_culled += static_cast<std::size_t>(__builtin_popcount(fan));
      left &= ~fan;
    }
    for (; left != 0; left &= left - 1, ++out.size) {
      const int other = __builtin_ctz(left);
      out.a[out.size] = static_cast<std::uint8_t>(lane);
      out.b[out.size] = static_cast<std::uint8_t>(other);
      out.earliest[out.size] = earliest[other];
    }
  }
}

void overlapTrianglesOf(const LeafPairing& leaves, LanePairs& out) {
  out.size = out.fan_culled = 0;
  leaves.shift ? overlapTriangles<true>(leaves, out)
               : overlapTriangles<false>(leaves, out);
}

std::size_t listFeatures(const std::uint16_t* masks, std::size_t count, unsigned kept,
                         std::uint32_t* codes) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned mask = masks[i] & kept;
    storeCounted(mask, featureCode(static_cast<std::uint32_t>(i), 0), codes + size);
    size += static_cast<std::size_t>(__builtin_popcount(mask));
  }
  return size;
}

/// A moving box at both times.
struct MovingBox {
  HalfAxes t0, t1;
};

HWY_INLINE MovingBox boxOf(const TreeVertex& x) {
  return {load<16>(x.box.t0.half), load<16>(x.box.t1.half)};
}

HWY_INLINE MovingBox merge(const MovingBox& a, const MovingBox& b) {
  return {larger(a.t0, b.t0), larger(a.t1, b.t1)};
}

/// The overlap depths of a pair of features at both times. Which feature comes first does
/// not matter but for the shift.
HWY_INLINE MovingBox depths(FeatureKind kind, const TrianglePair& pair, std::size_t bit,
                            const KdopShift* shift, const KdopShift* turned_shift) {
  MovingBox first, second;
  const KdopShift* add = shift;
  if (kind == FeatureKind::kVertexFace) {
    // The vertex, and where the other triangle begins.
    const bool on_a = bit < 3;
    const TreeVertex* const* face = pair.x + (on_a ? 3 : 0);
    first = boxOf(*pair.x[bit]);
    second = merge(merge(boxOf(*face[0]), boxOf(*face[1])), boxOf(*face[2]));
    add = on_a ? shift : turned_shift;
  } else {
    const unsigned char(&ends)[4] = kFeaturePoints[bit];
    first = merge(boxOf(*pair.x[ends[0]]), boxOf(*pair.x[ends[1]]));
    second = merge(boxOf(*pair.x[ends[2]]), boxOf(*pair.x[ends[3]]));
  }
  if (add) {
    const HalfAxes least = broadcast<16>(kLeastHalf);
    first.t0 = larger(first.t0 + load<16>(add->t0.half), least);
    first.t1 = larger(first.t1 + load<16>(add->t1.half), least);
  }
  return {first.t0 + swapHalves(second.t0), first.t1 + swapHalves(second.t1)};
}

template <FeatureKind kind, bool kShifted>
HWY_INLINE std::size_t cullFeatures(const TrianglePair* pairs, const KdopShift* shift,
                                    const KdopShift* turned_shift, float latest,
                                    std::uint32_t* codes, std::size_t count,
                                    TimeWindow* windows) {
  // Two loops: the first one has no branch that depends on the boxes.
  std::size_t left = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t code = codes[i];
    const MovingBox s =
        depths(kind, pairs[code / 16], code % 16, kShifted ? shift : nullptr,
               kShifted ? turned_shift : nullptr);
    codes[left] = code;
    left += !isAnyNegative(bothNegative(s.t0, s.t1));
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < left; ++i) {
    const std::uint32_t code = codes[i];
    const MovingBox s =
        depths(kind, pairs[code / 16], code % 16, kShifted ? shift : nullptr,
               kShifted ? turned_shift : nullptr);
    HalfAxes before = broadcast<16>(0.f), after = before;
    addLoss(s.t0, s.t1, before, after);
    const float lo = largest(before), hi = kWindowEnd - largest(after);
    codes[kept] = code;
    windows[kept] = {lo, hi < 1.f ? hi : 1.f};
    kept += lo <= (hi < latest ? hi : latest);
  }
  return kept;
}

std::size_t cullFeaturesOf(FeatureKind kind, const TrianglePair* pairs,
                           const KdopShift* shift, const KdopShift* turned_shift,
                           float latest, std::uint32_t* codes, std::size_t count,
                           TimeWindow* windows) {
  constexpr FeatureKind kVf = FeatureKind::kVertexFace, kEe = FeatureKind::kEdgeEdge;
  const auto cull = kind == kVf
                        ? (shift ? &cullFeatures<kVf, true> : &cullFeatures<kVf, false>)
                        : (shift ? &cullFeatures<kEe, true> : &cullFeatures<kEe, false>);
  return cull(pairs, shift, turned_shift, latest, codes, count, windows);
}

std::size_t cullCrossings(const TrianglePair* pairs, const KdopShift* shift,
                          const KdopShift* turned_shift, std::uint32_t* codes,
                          std::size_t count) {
  std::size_t left = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t code = codes[i];
    const std::size_t edge = code % 16, on_b = edge / 3, k = edge % 3;
    const TreeVertex* const* mine = pairs[code / 16].x + 3 * on_b;
    const TreeVertex* const* face = pairs[code / 16].x + 3 * (1 - on_b);
    HalfAxes ends =
        larger(load<16>(mine[k]->box.t0.half), load<16>(mine[(k + 1) % 3]->box.t0.half));
    if (shift)
      ends = larger(ends + load<16>((on_b ? turned_shift : shift)->t0.half),
                    broadcast<16>(kLeastHalf));
    const HalfAxes all =
        larger(larger(load<16>(face[0]->box.t0.half), load<16>(face[1]->box.t0.half)),
               load<16>(face[2]->box.t0.half));
    codes[left] = code;
    left += !isAnyNegative(ends + swapHalves(all));
  }
  return left;
}

/// Three coordinates of eight vectors.
struct Vectors {
  Doubles x, y, z;
};

HWY_INLINE Vectors operator+(const Vectors& a, const Vectors& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
HWY_INLINE Doubles dot(const Vectors& a, const Vectors& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
HWY_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A difference of two points that moves linearly, at the ends of the window, and its
/// norm over the step.
struct Segments {
  Vectors l, h;
  Doubles norm;
};

HWY_INLINE Vectors operator-(const Vectors& a, const Vectors& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

/// The points of eight pairs at both times.
struct Points {
  Vectors t0[4], t1[4];

  HWY_INLINE explicit Points(const EightPairs& pairs) {
    for (std::size_t i = 0; i < 4; ++i) {
      const double *rows0[kEight], *rows1[kEight];
      for (std::size_t lane = 0; lane < kEight; ++lane) {
        rows0[lane] = pairs.x[i][lane]->t0;
        rows1[lane] = pairs.x[i][lane]->t1;
      }
      loadColumns(rows0, t0[i].x, t0[i].y, t0[i].z);
      loadColumns(rows1, t1[i].x, t1[i].y, t1[i].z);
    }
  }
};

/// As Difference::at(); 0 and 1 need no case of their own, but what is not finite in one
/// frame shows at all times.
HWY_INLINE Vectors at(const Vectors& t0, const Vectors& t1, const Doubles& t) {
  const Doubles s = broadcast<kEight>(1.) - t;
  return {s * t0.x + t * t1.x, s * t0.y + t * t1.y, s * t0.z + t * t1.z};
}

HWY_INLINE Doubles maxNorm(const Vectors& a) {
  return max(max(abs(a.x), abs(a.y)), abs(a.z));
}

/// Differences of two points of each pair over the step, and their norms.
struct Differences {
  Vectors t0, t1;
  Doubles norm;
};

HWY_INLINE Differences differences(const Points& x, std::size_t p, std::size_t q) {
  const Vectors t0 = x.t0[p] - x.t0[q], t1 = x.t1[p] - x.t1[q];
  return {t0, t1, max(max(maxNorm(t0), maxNorm(t1)), broadcast<kEight>(kLeastNorm))};
}

HWY_INLINE Segments restrict(const Differences& d, const Doubles& lo, const Doubles& hi) {
  return {at(d.t0, d.t1, lo), at(d.t0, d.t1, hi), d.norm};
}

struct Vector {
  double x, y, z;
};

HWY_INLINE double maxNorm(const Vector& a) {
  return std::max(std::max(std::abs(a.x), std::abs(a.y)), std::abs(a.z));
}

HWY_INLINE Vector difference(const double* p, const double* q) {
  return {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
}

HWY_INLINE Doubles dot(const Vectors& a, const Vector& b) {
  return a.x * broadcast<kEight>(b.x) + a.y * broadcast<kEight>(b.y) +
         a.z * broadcast<kEight>(b.z);
}

HWY_INLINE Vector sumOfLanes(const Vectors& a) {
  return {sumOfLanes(a.x), sumOfLanes(a.y), sumOfLanes(a.z)};
}

/// The spokes of a fan as differences to its center at one time, with room for whole
/// lanes: a closed fan is followed by its first spoke, an open one by its last, so that
/// what follows spans no triangle.
class Spokes {
 public:
  HWY_INLINE void set(std::size_t i, const double* spoke) { rows_[i] = spoke; }

  /// Eight from spoke i on.
  HWY_INLINE Vectors from(std::size_t i, const double* center) const {
    Vectors p;
    loadColumns(rows_ + i, p.x, p.y, p.z);
    return {p.x - broadcast<kEight>(center[0]), p.y - broadcast<kEight>(center[1]),
            p.z - broadcast<kEight>(center[2])};
  }

 private:
  const double* rows_[VertexFans::kMaxSpokes + kEight];
};

bool isFanEmbedded(const TreeVertex* vertices, const TreeVertex& center,
                   const VertexFan& fan) {
  if (fan.count < 2) return false;
  const std::size_t num_blocks = (fan.count + kEight - 1) / kEight;
  Spokes spokes0, spokes1;
  for (std::size_t i = 0; i <= num_blocks * kEight; ++i) {
    const std::size_t k = i < fan.count ? i : fan.is_closed ? 0 : fan.count - 1;
    spokes0.set(i, vertices[fan.spokes[k]].t0);
    spokes1.set(i, vertices[fan.spokes[k]].t1);
  }

  constexpr std::size_t kMaxBlocks = VertexFans::kMaxSpokes / kEight;
  Vectors u0[kMaxBlocks], u1[kMaxBlocks];
  Vectors first[kMaxBlocks], middle[kMaxBlocks], last[kMaxBlocks];
  Vector d = {0, 0, 0};
  Doubles norm = broadcast<kEight>(kLeastNorm);
  for (std::size_t b = 0; b < num_blocks; ++b) {
    const Vectors v0 = u0[b] = spokes0.from(b * kEight, center.t0),
                  v1 = u1[b] = spokes1.from(b * kEight, center.t1),
                  w0 = spokes0.from(b * kEight + 1, center.t0),
                  w1 = spokes1.from(b * kEight + 1, center.t1);
    norm = max(norm, max(maxNorm(v0), maxNorm(v1)));
    first[b] = cross(v0, w0);
    middle[b] = cross(v0, w1) + cross(v1, w0);
    last[b] = cross(v1, w1);
    const Vector sum = sumOfLanes(first[b] + last[b]);
    d = {d.x + sum.x, d.y + sum.y, d.z + sum.z};
  }
  const double u_norm = largest(norm), d_norm = maxNorm(d);
  const double size = u_norm * u_norm * d_norm;
  if (!(u_norm * u_norm >= kTiny && size >= kTiny && size <= kHuge)) return false;

  const std::size_t num_triangles = fan.is_closed ? fan.count : fan.count - 1;
  const auto triangles_bits = (1U << num_triangles) - 1;
  const Doubles turned = broadcast<kEight>(kFanBound * size);
  unsigned keep = 0;
  for (std::size_t b = 0; b < num_blocks; ++b)
    keep |= bits((dot(first[b], d) > turned) & (dot(middle[b], d) > turned) &
                 (dot(last[b], d) > turned))
            << (b * kEight);
  if ((keep & triangles_bits) != triangles_bits) return false;

  // The ray: through the middle of the first sector of a closed fan; away from an open
  // one.
  Vector r = {0, 0, 0};
  if (fan.is_closed) {
    const Vector p = difference(vertices[fan.spokes[0]].t0, center.t0),
                 q = difference(vertices[fan.spokes[1]].t0, center.t0);
    const double a = maxNorm(p), b = maxNorm(q);
    r = {b * p.x + a * q.x, b * p.y + a * q.y, b * p.z + a * q.z};
  } else {
    for (std::size_t i = 0; i < fan.count; ++i) {
      const TreeVertex& spoke = vertices[fan.spokes[i]];
      const Vector p = difference(center.t0, spoke.t0),
                   q = difference(center.t1, spoke.t1);
      r = {r.x + (p.x + q.x), r.y + (p.y + q.y), r.z + (p.z + q.z)};
    }
  }
  const Vector e = {r.y * d.z - r.z * d.y, r.z * d.x - r.x * d.z, r.x * d.y - r.y * d.x};
  const double r_norm = maxNorm(r), ray_size = u_norm * r_norm * d_norm;
  if (!(r_norm * d_norm >= kTiny && ray_size >= kTiny && ray_size <= kHuge)) return false;
  const Doubles bound = broadcast<kEight>(kRayBound * ray_size);
  const Doubles minus_bound = broadcast<kEight>(-kRayBound * ray_size);
  // Spokes that lie before and after the ray beyond doubt, turning the fan's way.
  unsigned before0 = 0, after0 = 0, before1 = 0, after1 = 0;
  for (std::size_t b = 0; b < num_blocks; ++b) {
    const Doubles g0 = dot(u0[b], e), g1 = dot(u1[b], e);
    before0 |= bits(g0 > bound) << (b * kEight);
    after0 |= bits(g0 < minus_bound) << (b * kEight);
    before1 |= bits(g1 > bound) << (b * kEight);
    after1 |= bits(g1 < minus_bound) << (b * kEight);
  }
  if (fan.is_closed) {
    if (((before0 | after0) & triangles_bits) != triangles_bits) return false;
    const unsigned after_next = (after0 & triangles_bits) >> 1 | (after0 & 1U)
                                                                     << (fan.count - 1);
    return __builtin_popcount(before0 & after_next & triangles_bits) == 1;
  }
  // A sector misses the ray while its first spoke is after it or its last one before.
  const unsigned misses = (after0 & after1) | (before0 & before1) >> 1;
  return (misses & triangles_bits) == triangles_bits;
}

/// Volume and normal over a part of the step, as in solveCoplanarity().
struct Quadratics {
  Vectors c0, c1, c2;
  Doubles norm;
};

HWY_INLINE Quadratics cross(const Segments& a, const Segments& b) {
  return {cross(a.l, b.l), cross(a.l, b.h) + cross(a.h, b.l), cross(a.h, b.h),
          a.norm * b.norm};
}

HWY_INLINE DoubleMask isInRange(const Doubles& size) {
  return (size >= broadcast<kEight>(kTiny)) & (size <= broadcast<kEight>(kHuge));
}

struct Cubics {
  Doubles b0, b1, b2, b3, outer, inner;
  DoubleMask has_bounds;

  HWY_INLINE Doubles at(const Doubles& s) const {
    const Doubles r = broadcast<kEight>(1.) - s;
    return r * r * (b0 * r + b1 * s) + s * s * (b2 * r + b3 * s);
  }
  HWY_INLINE DoubleMask hasNoRoot() const {
    const Doubles zero = broadcast<kEight>(0.), outer_n = zero - outer,
                  inner_n = zero - inner;
    return has_bounds &
           (((b0 > outer) & (b1 > inner) & (b2 > inner) & (b3 > outer)) |
            ((b0 < outer_n) & (b1 < inner_n) & (b2 < inner_n) & (b3 < outer_n)));
  }
  HWY_INLINE DoubleMask changesSign() const {
    const Doubles outer_n = broadcast<kEight>(0.) - outer;
    return has_bounds &
           (((b0 > outer) & (b3 < outer_n)) | ((b0 < outer_n) & (b3 > outer)));
  }
};

HWY_INLINE Cubics spannedVolume(const Segments& u, const Quadratics& n) {
  const Doubles size = u.norm * n.norm;
  return {dot(u.l, n.c0),
          dot(u.h, n.c0) + dot(u.l, n.c1),
          dot(u.h, n.c1) + dot(u.l, n.c2),
          dot(u.h, n.c2),
          broadcast<kEight>(kOuterBound) * size,
          broadcast<kEight>(kInnerBound) * size,
          isInRange(size) & isInRange(n.norm)};
}

EightCoplanarities coplanarityOfEight(const EightPairs& pairs) {
  const bool vf = pairs.kind == FeatureKind::kVertexFace;
  const Points x(pairs);
  const Doubles lo = load<kEight>(pairs.lo), hi = load<kEight>(pairs.hi);
  const Segments u = restrict(vf ? differences(x, 0, 1) : differences(x, 2, 0), lo, hi);
  const Segments v = restrict(vf ? differences(x, 2, 1) : differences(x, 1, 0), lo, hi);
  const Segments w = restrict(vf ? differences(x, 3, 1) : differences(x, 3, 2), lo, hi);
  const Cubics f = spannedVolume(u, cross(v, w));
  // min() and max() pick a NaN on the right, as the scalar filter does: there, inner
  // ones.
  const Doubles scale = broadcast<kEight>(kInnerScale);
  const Doubles b1 = scale * f.b1, b2 = scale * f.b2;
  const Doubles least = min(min(f.b0, b1), min(f.b3, b2)),
                most = max(max(f.b0, b1), max(f.b3, b2));
  const Doubles norm = max(max(u.norm, v.norm), w.norm), zero = broadcast<kEight>(0.),
                bound = broadcast<kEight>(kOuterBound) * (norm * norm * norm);
  const unsigned signs_agree = bits(((least > zero) | (most < zero)) &
                                    (norm > broadcast<kEight>(kLeastFilterNorm)) &
                                    (norm < broadcast<kEight>(kMostFilterNorm)));
  const unsigned clear = bits((least > bound) | (most < zero - bound));
  return {0xffU & ~signs_agree, signs_agree & ~clear};
}

/// The differences that the inside conditions use, see Pair in elementary_test.cpp.
struct Pairs {
  bool vf;
  Differences u, v, w, r, q;

  HWY_INLINE explicit Pairs(const EightPairs& pairs)
      : Pairs(Points(pairs), pairs.kind == FeatureKind::kVertexFace) {}

 private:
  HWY_INLINE Pairs(const Points& x, bool is_vf)
      : vf(is_vf),
        u(vf ? differences(x, 0, 1) : differences(x, 2, 0)),
        v(vf ? differences(x, 2, 1) : differences(x, 1, 0)),
        w(vf ? differences(x, 3, 1) : differences(x, 3, 2)),
        r(vf ? differences(x, 2, 0) : differences(x, 1, 2)),
        q(differences(x, 3, 0)) {}
};

/// Where all inside conditions are surely met, and where one is surely not.
struct Sides {
  DoubleMask positive, negative;

  HWY_INLINE void require(const Quadratics& q, const Quadratics& n) {
    const Doubles size = q.norm * n.norm;
    const DoubleMask valid = isInRange(size) & isInRange(q.norm) & isInRange(n.norm);
    const Doubles bound = broadcast<kEight>(kInsideBound) * size,
                  minus = broadcast<kEight>(0.) - bound;
    const Doubles c[5] = {dot(q.c0, n.c0), dot(q.c0, n.c1) + dot(q.c1, n.c0),
                          dot(q.c0, n.c2) + dot(q.c2, n.c0) + dot(q.c1, n.c1),
                          dot(q.c1, n.c2) + dot(q.c2, n.c1), dot(q.c2, n.c2)};
    DoubleMask above = valid, below = valid;
    for (const Doubles& ck : c) {
      above = above & (ck > bound);
      below = below & (ck < minus);
    }
    positive = positive & above;
    negative = negative | below;
  }
};

HWY_INLINE Sides insideness(const Pairs& pairs, const Doubles& lo, const Doubles& hi,
                            const Segments& u, const Segments& v, const Segments& w,
                            const Quadratics& n) {
  const Segments r = restrict(pairs.r, lo, hi), q = restrict(pairs.q, lo, hi);
  const Doubles zero = broadcast<kEight>(0.);
  Sides sides = {zero <= zero, zero < zero};
  sides.require(cross(u, w), n);
  if (pairs.vf) {
    sides.require(cross(v, u), n);
    sides.require(cross(r, q), n);
  } else {
    sides.require(cross(r, w), n);
    sides.require(cross(u, v), n);
    sides.require(cross(v, q), n);
  }
  return sides;
}

/// Where the cubics that change sign are zero, by false position (Illinois), each until
/// it moves by no more than its tolerance: no lane's answer depends on the others.
HWY_INLINE Doubles root(const Cubics& f, const Doubles& tolerance) {
  constexpr int kMaxSteps = 24;
  const Doubles zero = broadcast<kEight>(0.), half = broadcast<kEight>(0.5);
  Doubles a = zero, b = broadcast<kEight>(1.), fa = f.b0, fb = f.b3, x = zero;
  DoubleMask moves = zero <= zero;
  for (int i = 0; i < kMaxSteps; ++i) {
    const Doubles next = a + (b - a) * (fa / (fa - fb));
    const Doubles fx = f.at(next);
    const DoubleMask moved = abs(next - x) > tolerance;
    x = select(moves, next, x);
    moves = moves & moved;
    if (bits(moves) == 0) break;
    // The end that the root is not at: kept, its value halved.
    const DoubleMask beyond = ((fx > zero) & (fb > zero)) | ((fx < zero) & (fb < zero));
    a = select(beyond, a, b);
    fa = select(beyond, half * fa, fb);
    b = next;
    fb = fx;
  }
  return x;
}

EightAnswers solveEight(const EightPairs& x, double toc_err) {
  const Pairs pairs(x);
  const Doubles lo = load<kEight>(x.lo), hi = load<kEight>(x.hi), width = hi - lo;
  const Segments u = restrict(pairs.u, lo, hi), v = restrict(pairs.v, lo, hi),
                 w = restrict(pairs.w, lo, hi);
  const Cubics f = spannedVolume(u, cross(v, w));
  EightAnswers answers;
  answers.yes = 0;
  answers.no = bits(f.hasNoRoot());
  const unsigned open = bits(f.changesSign());
  if (open == 0) return answers;

  // [a, b] around the root: before it and behind it there is none.
  const Doubles half = broadcast<kEight>(0.25 * toc_err);
  const Doubles t = lo + root(f, broadcast<kEight>(0.125) * half / width) * width;
  const Doubles a = max(lo, t - half), b = min(hi, t + half);
  const Segments ua = restrict(pairs.u, a, b), va = restrict(pairs.v, a, b),
                 wa = restrict(pairs.w, a, b);
  const Quadratics na = cross(va, wa);
  const Sides sides = insideness(pairs, a, b, ua, va, wa, na);
  const unsigned crosses = bits(spannedVolume(ua, na).changesSign());
  const auto isFree = [&](const Doubles& from, const Doubles& to) HWY_ATTR {
    const Segments us = restrict(pairs.u, from, to), vs = restrict(pairs.v, from, to),
                   ws = restrict(pairs.w, from, to);
    return bits(spannedVolume(us, cross(vs, ws)).hasNoRoot() | (from >= to));
  };
  const unsigned first = open & isFree(lo, a);
  answers.yes = first & crosses & bits(sides.positive);
  const unsigned outside = first & bits(sides.negative);
  if (outside != 0) answers.no |= outside & isFree(b, hi);
  store(a, answers.toc_lo);
  store(b, answers.toc_hi);
  return answers;
}

/// Where the cubics that have one sign at 0 and at 1 come nearest to zero in between, as
/// far as doubles tell: of b0's sign, the lowest point; 1/2 where there is none.
HWY_INLINE Doubles nearestToZero(const Cubics& f) {
  const Doubles zero = broadcast<kEight>(0.), three = broadcast<kEight>(3.),
                half = broadcast<kEight>(0.5);
  // The slope has Bernstein coefficients e0, e1, e2; it rises through zero at s / (1 - s)
  // = (q - e1) / e2 = -e0 / (q + e1), q^2 = e1^2 - e0 e2.
  const DoubleMask below = f.b0 < zero;
  const auto turned = [&](const Doubles& e)
                          HWY_ATTR { return select(below, zero - e, e); };
  const Doubles e0 = turned(f.b1 - three * f.b0), e1 = turned(f.b2 - f.b1),
                e2 = turned(three * f.b3 - f.b2);
  const Doubles q = squareRoot(e1 * e1 - e0 * e2);
  const DoubleMask is_late = e1 < zero;
  const Doubles part = select(is_late, q - e1, zero - e0),
                rest = select(is_late, e2, q + e1);
  const Doubles s = part / (part + rest);
  return select((s > zero) & (s < broadcast<kEight>(1.)), s, half);
}

EightDivisions divideEight(const EightPairs& x) {
  const Pairs pairs(x);
  const Doubles lo = load<kEight>(x.lo), hi = load<kEight>(x.hi);
  const Segments u = restrict(pairs.u, lo, hi), v = restrict(pairs.v, lo, hi),
                 w = restrict(pairs.w, lo, hi);
  const Quadratics n = cross(v, w);
  EightDivisions out;
  out.never_inside = bits(insideness(pairs, lo, hi, u, v, w, n).negative);
  const Cubics f = spannedVolume(u, n);
  out.divisible = bits(f.has_bounds & (abs(f.b0) > f.outer) & (abs(f.b3) > f.outer));
  const Doubles s = nearestToZero(f);
  store(min(hi, lo + s * (hi - lo)), out.at);
  return out;
}

#if defined(FCL_CCD_USE_HIGHWAY)
inline const char* targetName() { return hwy::TargetName(HWY_TARGET); }
#else
inline const char* targetName() { return "plain"; }
#endif

extern const Kernels kKernels = {targetName(),   &overlapChildrenOf,  &overlapTrianglesOf,
                                 &listFeatures,  &cullFeaturesOf,     &cullCrossings,
                                 &isFanEmbedded, &coplanarityOfEight, &solveEight,
                                 &divideEight};

const Kernels* table() { return &kKernels; }

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();

#if !defined(FCL_CCD_USE_HIGHWAY) || HWY_ONCE
namespace fcl {
namespace detail {
namespace deformable {

#if defined(FCL_CCD_USE_HIGHWAY)
HWY_EXPORT(table);
#endif

const Kernels& kernels() {
#if defined(FCL_CCD_USE_HIGHWAY)
  static const Kernels& best = *HWY_DYNAMIC_DISPATCH(table)();
  return best;
#else
  return HWY_NAMESPACE::kKernels;
#endif
}

std::vector<const Kernels*> allKernels() {
  std::vector<const Kernels*> all;
#if defined(FCL_CCD_USE_HIGHWAY) && (HWY_TARGETS & (HWY_TARGETS - 1)) != 0
  // A choice of our own: Highway's is the whole process's. The best has the lowest bit;
  // no bit at all chooses what needs no vector instructions.
  hwy::ChosenTarget choice;
  for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS; true;
       left &= left - 1) {
    choice.Update(left & -left);
    const Kernels* k = HWY_DISPATCH_TABLE(table)[choice.GetIndex()]();
    if (all.empty() || all.back() != k) all.push_back(k);
    if (left == 0) return all;
  }
#else
  all.push_back(&kernels());
  return all;
#endif
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
#endif
