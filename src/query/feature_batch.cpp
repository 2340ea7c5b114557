// SPDX-License-Identifier: BSD-3-Clause
#include "query/feature_batch.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>

#include "fcl/common/exception.h"
#include "mesh/non_finite_vertex.h"
#include "tree/bent_boxes.h"
#include "tree/box_position.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Edges of two triangles.
constexpr std::size_t kEdges = 6;

bool hasFreePoints(const MeshInstance& mesh) {
  return mesh.tree && mesh.tree->freeLeaves().points > 0;
}

bool isFinite(const TreeVertex& x) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += 0 * x.t0[k] + 0 * x.t1[k];
  return sum == 0;
}

}  // namespace

TriangleReader::TriangleReader(const MeshInstance& mesh) : mesh_(mesh) {
  if (!mesh.isInPlace()) return;
  in_place_ = {mesh.tree->triangles().data(), mesh.tree->vertices().data()};
}

/// Sets the slot of a triangle.
void TriangleReader::find(int i) {
  assert(i >= 0);
  if (!triangles_) {
    // Not initialized, since each is written before it is read.
    triangles_.reset(new TreeTriangle[kSlots]);
    vertices_.reset(new TreeVertex[3 * kSlots]);
    stored_.assign(kSlots, -1);
    slot_of_.assign(kSlots, 0);
    slot_of_vertex_.assign(kSlots, 0);
  }
  std::uint16_t& slot = slot_of_[static_cast<std::size_t>(i) % kSlots];
  const std::size_t reads_left = (slot + kSlots - next_) % kSlots;
  if (stored_[slot] != i || reads_left < kStored) {
    stored_[next_] = -1;
    compute(i, next_);
    stored_[next_] = i;
    slot = static_cast<std::uint16_t>(next_);
    next_ = (next_ + 1) % kSlots;
  }
  index_ = i;
  slot_ = slot;
}

void TriangleReader::compute(int i, std::size_t slot) {
  const auto index = static_cast<std::size_t>(i);
  TreeTriangle& triangle = triangles_[slot];
  if (mesh_.tree) {
    triangle = mesh_.tree->triangles()[index];
  } else {
    triangle.index = static_cast<std::uint32_t>(i);
    triangle.owned = kOwnsAll;
    if (mesh_.owners) {
      std::copy(mesh_.owners[index].v, mesh_.owners[index].v + 3, triangle.id);
      triangle.owned = mesh_.owners[index].owned;
    } else {
      for (int k = 0; k < 3; ++k) {
        const std::size_t id = mesh_.triangles[index][k];
        if (id >= mesh_.frames.size())
          throw Exception(std::string(mesh_.name) + ": triangle " + std::to_string(i) +
                          " refers to a vertex that is not there. The model has " +
                          std::to_string(mesh_.frames.size()) + ", numbered from 0");
        triangle.id[k] = static_cast<std::uint32_t>(id);
      }
      // As in assignFeatures(), an edge with two equal ids is not a feature.
      for (unsigned k = 0; k < 3; ++k)
        if (triangle.id[k] == triangle.id[(k + 1) % 3])
          triangle.owned &= ~(1U << (3 + k));
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t id = triangle.id[k];
    TreeVertex& x = vertices_[3 * slot + k];
    std::uint16_t& slot_of_vertex = slot_of_vertex_[id % kSlots];
    if (!mesh_.tree && isStored(id, slot_of_vertex)) {
      x = vertices_[slot_of_vertex];
    } else {
      pose(id, x);
      if (mesh_.tree) x.box = mesh_.tree->vertices()[triangle.place[k]].box;
      if (!isFinite(x)) throw NonFiniteVertex(mesh_.name, id);
    }
    slot_of_vertex = static_cast<std::uint16_t>(3 * slot + k);
  }
}

/// Whether the vertex in a slot of the store has this id.
bool TriangleReader::isStored(std::uint32_t id, std::size_t slot) const {
  return stored_[slot / 3] >= 0 && triangles_[slot / 3].id[slot % 3] == id;
}

void TriangleReader::pose(std::uint32_t id, TreeVertex& out) const {
  const VertexPath path = mesh_.frames[id];
  out.setPath(path.t0, path.t1);
  assert(!(mesh_.bend && mesh_.tree));
  if (mesh_.tree) return;
  // The boxes of a rigid tree do not contain the translation, so that it is subtracted
  // here. Adding and subtracting it each round by 2^-53 of the numbers, and so do the
  // difference to the origin and a sum. Together this is less than 2^-50 of `size`. The
  // pad is twice that, since roundUp() may lose a part of it to rounding.
  const auto fit = [&](const double* x, int frame, Kdop16& box) {
    const double(&translation)[3] = mesh_.translation[frame];
    const double(&origin)[3] = mesh_.rigid.origin(frame);
    double p[3], size = 0;
    for (int k = 0; k < 3; ++k) {
      p[k] = x[k] - translation[k];
      size =
          std::max(size, std::abs(x[k]) + std::abs(translation[k]) + std::abs(origin[k]));
    }
    fitPoint(p, origin, roundUp(size * 0x1p-49, 0.f), box);
  };
  fit(out.t0, 0, out.box.t0);
  fit(out.t1, 1, out.box.t1);
  if (mesh_.bend) enlarge(*mesh_.bend, out);
}

FeatureBatch::FeatureBatch(const MeshInstance& a, const MeshInstance& b,
                           const KdopShift* shift, const Kernels& kernels, double reach)
    : reader_a_(a),
      reader_b_(b),
      self_(&a == &b),
      bends_{{a.bend, b.bend}},
      tests_points_(reach > 0 && (hasFreePoints(a) || hasFreePoints(b))),
      kernels_(kernels),
      pairs_(new TrianglePair[kMaxPairs]),
      owned_(new std::uint16_t[kMaxPairs]),
      edges_(new std::uint16_t[kMaxPairs]),
      gaps_(new float[kMaxPairs]),
      lists_{List(kNumVertexFacePairs), List(kNumFeaturePairs - kNumVertexFacePairs)},
      crossings_(new std::uint32_t[kMaxPairs * kEdges + 16]) {
  setReach(shift, reach);
}

void FeatureBatch::setReach(const KdopShift* shift, double reach) {
  reach_ = reach;
  shift_ = shift;
  if (!shift) return;
  for (int j = 0; j < 16; ++j) {
    turned_shift_.t0.half[j] = shift->t0.half[j ^ 8];
    turned_shift_.t1.half[j] = shift->t1.half[j ^ 8];
  }
}

// listFeatures() may write up to 16 codes behind the last pair.
FeatureBatch::List::List(std::size_t pairs_each)
    : codes(new std::uint32_t[kMaxPairs * pairs_each + 16]),
      windows(new TimeWindow[kMaxPairs * pairs_each]) {}

void FeatureBatch::clear() {
  num_pairs_ = num_crossings_ = 0;
  has_edges_ = false;
  for (List& list : lists_) list.size = 0;
}

/// Whether one of the triangles has a vertex with this number or a lower one.
static bool hasVertexUpTo(std::uint32_t vertex, const TreeTriangle& a,
                          const TreeTriangle& b) {
  const auto least = [](const TreeTriangle& t) {
    return std::min(std::min(t.id[0], t.id[1]), t.id[2]);
  };
  return std::min(least(a), least(b)) <= vertex;
}

template <typename ReaderA, typename ReaderB>
void FeatureBatch::addFrom(ReaderA& reader_a, ReaderB& reader_b, const LeafPair*& next,
                           const LeafPair* last, const Wanted& wanted,
                           StageCounts& counts) {
  // The triangles of a block are far apart in memory, so that each is prefetched eight
  // pairs before it is read.
  constexpr std::ptrdiff_t kAhead = 8;
  const float last_beginning = lastBeginning(wanted.latest);
  const bool with_crossings = wanted.crossings;
  const std::uint32_t last_vertex = wanted.last_vertex;
  const bool has_last_vertex = last_vertex != ~std::uint32_t{0};
  for (; next != last; ++next) {
    const LeafPair& ahead = next[std::min(kAhead, last - 1 - next)];
    reader_a.prefetch(ahead.a);
    reader_b.prefetch(ahead.b);
    if (next->earliest > last_beginning) continue;
    assert(num_pairs_ < kMaxPairs);
    TrianglePair& pair = pairs_[num_pairs_];
    pair.a = reader_a.read(next->a, pair.x);
    pair.b = reader_b.read(next->b, pair.x + 3);
    const bool with_crossing = with_crossings && next->earliest <= 0.f;
    unsigned owned = ownedPairs(pair.a->owned, pair.b->owned);
    unsigned edges = ownedEdges(pair.a->owned, pair.b->owned) & (0U - with_crossing);
    ++counts.triangle_pairs;
    if (self_ && doShareVertex(idsOf(*pair.a), idsOf(*pair.b))) {
      const unsigned shared = sharedVertices(pair.a->id, pair.b->id);
      owned &= ~pairsAt(shared);
      edges &= ~edgesAtBoth(shared);
      ++counts.adjacent_pairs;
    }
    if (has_last_vertex && !hasVertexUpTo(last_vertex, *pair.a, *pair.b)) owned = 0;
    owned_[num_pairs_] = static_cast<std::uint16_t>(owned);
    edges_[num_pairs_] = static_cast<std::uint16_t>(edges);
    has_edges_ |= edges != 0;
    // Three triangle pairs of ten own no pair of features. There is no branch on this,
    // since it would be unpredictable.
    num_pairs_ += (owned | edges) != 0;
  }
}

void FeatureBatch::add(const LeafPair*& next, const LeafPair* last, const Wanted& wanted,
                       StageCounts& counts) {
  TrianglesInPlace a = reader_a_.inPlace(), b = reader_b_.inPlace();
  if (a.triangles && b.triangles)
    addFrom(a, b, next, last, wanted, counts);
  else
    addFrom(reader_a_, reader_b_, next, last, wanted, counts);
}

void FeatureBatch::cullTriangles(double latest, StageCounts& counts) {
  if (isBeginning(latest))
    leaveOutApart(latest, counts);
  else
    leaveOutFar(counts);
  if (reach_ == 0 && !isBeginning(latest) && has_edges_) leaveOutEdges();
  if (!has_edges_) return;
  const std::size_t size = kernels_.listFeatures(edges_.get(), num_pairs_,
                                                 (1U << kEdges) - 1, crossings_.get());
  // To a mesh with itself a shift adds nothing but a distance, which crossings do not
  // have.
  num_crossings_ = kernels_.cullCrossings(pairs_.get(), self_ ? nullptr : shift_,
                                          &turned_shift_, crossings_.get(), size);
}

/// Moves a triangle pair to the end of those that are kept.
void FeatureBatch::keepPair(std::size_t i, std::size_t& kept) {
  pairs_[kept] = pairs_[i];
  owned_[kept] = owned_[i];
  edges_[kept++] = edges_[i];
}

/// Leaves out the triangle pairs that are apart until `latest`.
void FeatureBatch::leaveOutApart(double latest, StageCounts& counts) {
  // The kernel needs more than the rounding of a sum and a product, 2^-53 each.
  const double share = latest * (1 + 0x1p-50);
  std::size_t kept = 0;
  for (std::size_t first = 0; first < num_pairs_; first += 8) {
    const std::size_t count = std::min<std::size_t>(8, num_pairs_ - first);
    float gaps[8];
    const unsigned apart = kernels_.areApart(&pairs_[first], count, share, reach_, gaps);
    counts.plane_culled += static_cast<unsigned>(__builtin_popcount(apart));
    for (unsigned left = ~apart & ((1U << count) - 1); left != 0; left &= left - 1) {
      const auto lane = static_cast<std::size_t>(__builtin_ctz(left));
      gaps_[kept] = gaps[lane];
      keepPair(first + lane, kept);
    }
  }
  num_pairs_ = kept;
}

void FeatureBatch::beginTask() { pause_ = wait_ = 0; }

/// Leaves out the triangle pairs that stay further apart than the distance during the
/// whole step: six of seven of those of a cloth beside a body, but only one of ten of
/// those of a crumpled cloth. A test costs a quarter of what a pair costs that is left,
/// so the first pairs of a block tell whether it pays. They are pairs that own features:
/// of the others, threads may add more or fewer. Without a distance most scenes have few
/// such pairs (those of close surfaces that slide along each other are such pairs), and
/// the boxes of features do the same work nearly as fast: with a quarter of such pairs
/// the self-collision of two layers takes 7% more time. So more of the first pairs must
/// be apart, and a block without them lets the next ones go untested, up to
/// kLongestPause.
void FeatureBatch::leaveOutFar(StageCounts& counts) {
  constexpr std::size_t kSample = 16;
  const std::size_t least = reach_ > 0 ? kSample / 4 : 3 * kSample / 4;
  constexpr int kLongestPause = 15;
  if (wait_ > 0) {
    --wait_;
    return;
  }
  std::uint8_t apart[kMaxPairs / 8];
  std::size_t tried = 0, left_out = 0, culled = 0;
  for (std::size_t first = 0; first < num_pairs_; first += 8) {
    const std::size_t count = std::min<std::size_t>(8, num_pairs_ - first);
    const unsigned mask = kernels_.stayApart(&pairs_[first], count, reach_, bends_);
    apart[first / 8] = static_cast<std::uint8_t>(mask);
    for (std::size_t i = 0; i < count; ++i)
      culled += owned_[first + i] != 0 ? mask >> i & 1U : 0;
    for (std::size_t i = 0; i < count && tried < kSample; ++i) {
      if (owned_[first + i] == 0) continue;
      left_out += mask >> i & 1U;
      if (++tried < kSample || left_out >= least) continue;
      if (reach_ == 0) wait_ = pause_ = std::min(2 * pause_ + 1, kLongestPause);
      return;
    }
  }
  pause_ = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < num_pairs_; ++i)
    if ((apart[i / 8] >> i % 8 & 1U) == 0) keepPair(i, kept);
  counts.plane_culled += culled;
  num_pairs_ = kept;
}

/// Leaves out the edges of triangle pairs that are apart at t = 0.
void FeatureBatch::leaveOutEdges() {
  for (std::size_t first = 0; first < num_pairs_; first += 8) {
    const std::size_t count = std::min<std::size_t>(8, num_pairs_ - first);
    float gaps[8];
    const unsigned apart = kernels_.areApart(&pairs_[first], count, 0, 0, gaps);
    // There is no branch, since it would be unpredictable.
    for (std::size_t i = 0; i < count; ++i)
      edges_[first + i] &= static_cast<std::uint16_t>((apart >> i & 1U) - 1U);
  }
}

constexpr unsigned kVfPairs = (1U << kNumVertexFacePairs) - 1;

/// The bits of pairs that are listed as edges: those of free points only at a distance.
/// Two free edges are then tested once.
unsigned FeatureBatch::edgePairsToTest() {
  constexpr unsigned kFree = 1U << kFreePair, kEePairs = (kFree - 1) & ~kVfPairs;
  if (!tests_points_) return kEePairs;
  for (std::size_t i = 0; i < num_pairs_; ++i)
    if ((pairs_[i].a->owned & pairs_[i].b->owned & kOwnsFirstEdge) != 0)
      owned_[i] &= static_cast<std::uint16_t>(~kFree);
  return kEePairs | kFree;
}

/// Lists the pairs of features of one kind, and returns their number.
std::size_t FeatureBatch::listPairs(ContinuousContactKind kind, StageCounts& counts) {
  const std::size_t size = kernels_.listFeatures(
      owned_.get(), num_pairs_,
      kind == ContinuousContactKind::kVertexFace ? kVfPairs : edgePairsToTest(),
      lists_[kind == ContinuousContactKind::kEdgeEdge].codes.get());
  counts.feature_pairs += size;
  return size;
}

void FeatureBatch::cullAtStart(ContinuousContactKind kind, StageCounts& counts) {
  List& list = lists_[kind == ContinuousContactKind::kEdgeEdge];
  const std::size_t size = listPairs(kind, counts);
  list.size = kernels_.cullFeatures(kind, pairs_.get(), shift_, &turned_shift_, 0,
                                    gaps_.get(), list.codes.get(), size, nullptr);
  counts.box_culled += size - list.size;
}

void FeatureBatch::cull(ContinuousContactKind kind, double latest, StageCounts& counts) {
  List& list = lists_[kind == ContinuousContactKind::kEdgeEdge];
  const std::size_t size = listPairs(kind, counts);
  list.size = kernels_.cullFeatures(kind, pairs_.get(), shift_, &turned_shift_,
                                    roundUp(latest, 0.f),
                                    isBeginning(latest) ? gaps_.get() : nullptr,
                                    list.codes.get(), size, list.windows.get());
  counts.box_culled += size - list.size;
}

std::uint8_t FeatureBatch::exchangesOf(std::uint32_t code,
                                       const FeatureCandidate& candidate,
                                       std::uint8_t exchanges) const {
  if (candidate.kind != ContinuousContactKind::kEdgeEdge) return exchanges;
  const unsigned char(&corners)[4] = kFeaturePoints[code % 16];
  const TreeVertex* const* x = pairs_[code / 16].x;
  const TreeVertex *first = x[corners[0]], *second = x[corners[2]];
  const bool is_turned = candidate.x[2] == first || candidate.x[3] == first;
  const unsigned all = exchanges;
  // Of the first edge of the code, and of the second one.
  const unsigned of_first =
                     (all & 1U) ^ unsigned { candidate.x[is_turned ? 2 : 0] != first },
                 of_second = (all >> 1 & 1U) ^
                             unsigned { candidate.x[is_turned ? 0 : 2] != second };
  return static_cast<std::uint8_t>(is_turned ? of_second | of_first << 1 | (~all & 4U)
                                             : of_first | of_second << 1 | (all & 4U));
}

std::size_t FeatureBatch::keep(ContinuousContactKind kind, const PairFilter& filter) {
  List& list = lists_[kind == ContinuousContactKind::kEdgeEdge];
  std::size_t kept = 0;
  for (std::size_t i = 0; i < list.size; ++i) {
    FeatureCandidate candidate;
    setCandidate(list.codes[i], list.windows[i], candidate);
    std::int32_t triangles[2];
    if (!filter.find(candidate, triangles)) continue;
    list.codes[kept] = list.codes[i];
    list.windows[kept++] = list.windows[i];
  }
  const std::size_t rejected = list.size - kept;
  list.size = kept;
  return rejected;
}

FeatureBatch::EdgeAndFace FeatureBatch::crossing(std::size_t i) const {
  assert(i < num_crossings_);
  const std::uint32_t code = crossings_[i], bit = code % 16;
  return {&pairs_[code / 16], bit % 3, bit < 3};
}

/// Exchanges a and b without a branch, which would be unpredictable.
template <typename T>
void swapIf(bool condition, T& a, T& b) {
  const T difference = (a ^ b) & static_cast<T>(-static_cast<T>(condition));
  a ^= difference;
  b ^= difference;
}

/// An edge whose vertices are in the order of their ids.
struct OrderedEdge {
  /// Both ids, 32 bits each.
  std::uint64_t ids;
  /// Its vertices as indices of TrianglePair::x, four bits each.
  std::uint32_t corners;

  /// @param k  the corner of the triangle at which the edge begins
  /// @param first  index in TrianglePair::x of the triangle's first vertex
  OrderedEdge(const TreeTriangle& triangle, unsigned k, unsigned first) {
    unsigned l = (k + 1) % 3;
    std::uint32_t p = triangle.id[k], q = triangle.id[l];
    const bool is_turned = q < p;
    swapIf(is_turned, k, l);
    swapIf(is_turned, p, q);
    ids = std::uint64_t{p} << 32 | q;
    corners = (first + k) << 4 | (first + l);
  }
};

/// The ids of an edge are in ascending order, and so are the two edges of an EE pair in a
/// self-collision. The points follow the ids. So a pair of features has one name and one
/// evaluation. In a self-collision the vertex of a VF pair always belongs to mesh a.
void FeatureBatch::setCandidate(std::uint32_t code, const TimeWindow& window,
                                FeatureCandidate& out) const {
  assert(code / 16 < num_pairs_ && !window.isEmpty());
  const TrianglePair& triangles = pairs_[code / 16];
  out.window_lo = windowLo(window);
  out.window_hi = windowHi(window);
  out.triangles[0] = static_cast<std::int32_t>(triangles.a->index);
  out.triangles[1] = static_cast<std::int32_t>(triangles.b->index);
  if (code % 16 == kFreePair) return setFreePair(triangles, out);
  const FeaturePair pair = featurePair(static_cast<int>(code % 16));
  out.kind = pair.kind;
  out.first_on_a = pair.first_on_a;
  const auto set = [&](int i, bool on_a, unsigned k) {
    out.vertices[i] = (on_a ? triangles.a : triangles.b)->id[k];
    out.x[i] = triangles.x[on_a ? k : 3 + k];
  };
  if (pair.kind == ContinuousContactKind::kVertexFace) {
    set(0, pair.first_on_a, pair.first);
    for (unsigned k = 0; k < 3; ++k) set(static_cast<int>(k) + 1, !pair.first_on_a, k);
    if (self_ && !pair.first_on_a) {
      out.first_on_a = true;
      std::swap(out.triangles[0], out.triangles[1]);
    }
    return;
  }
  OrderedEdge edges[2] = {OrderedEdge(*triangles.a, pair.first, 0),
                          OrderedEdge(*triangles.b, pair.second, 3)};
  const bool is_turned = self_ & (edges[1].ids < edges[0].ids);
  swapIf(is_turned, edges[0].ids, edges[1].ids);
  swapIf(is_turned, edges[0].corners, edges[1].corners);
  swapIf(is_turned, out.triangles[0], out.triangles[1]);
  for (std::size_t i = 0; i < 2; ++i) {
    out.vertices[2 * i] = static_cast<std::uint32_t>(edges[i].ids >> 32);
    out.vertices[2 * i + 1] = static_cast<std::uint32_t>(edges[i].ids);
    out.x[2 * i] = triangles.x[edges[i].corners >> 4];
    out.x[2 * i + 1] = triangles.x[edges[i].corners & 15];
  }
}

/// A free point and a free edge, or two free points. In a self-collision the point
/// belongs to mesh a, and of two points the one with the lower id.
void FeatureBatch::setFreePair(const TrianglePair& pair, FeatureCandidate& out) const {
  constexpr std::uint32_t kUnused = ~std::uint32_t{0};
  const bool edge_on_a = (pair.a->owned & kOwnsFirstEdge) != 0,
             edge_on_b = (pair.b->owned & kOwnsFirstEdge) != 0;
  assert(!(edge_on_a && edge_on_b));
  const bool has_edge = edge_on_a || edge_on_b,
             is_turned =
                 edge_on_a || (self_ && !has_edge && pair.b->id[0] < pair.a->id[0]);
  const TreeTriangle &first = is_turned ? *pair.b : *pair.a,
                     &second = is_turned ? *pair.a : *pair.b;
  const unsigned begin = is_turned ? 3 : 0, end = 3 - begin,
                 low = second.id[1] < second.id[0] ? 1 : 0;
  out.kind = has_edge ? ContinuousContactKind::kVertexEdge
                      : ContinuousContactKind::kVertexVertex;
  out.first_on_a = self_ || !is_turned;
  if (self_ && is_turned) std::swap(out.triangles[0], out.triangles[1]);
  out.vertices[0] = first.id[0];
  out.vertices[1] = second.id[low];
  out.vertices[2] = has_edge ? second.id[1 - low] : kUnused;
  out.vertices[3] = kUnused;
  out.x[0] = pair.x[begin];
  out.x[1] = pair.x[end + low];
  out.x[2] = out.x[3] = pair.x[end + 1 - low];
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
