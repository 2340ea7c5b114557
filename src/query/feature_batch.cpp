// SPDX-License-Identifier: BSD-3-Clause
#include "query/feature_batch.h"
#include "base/bits.h"

#include <algorithm>
#include <cassert>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Edges of two triangles.
constexpr std::size_t kEdges = 6;

bool hasFreePoints(const MeshInstance& mesh) {
  return mesh.tree && mesh.tree->freeLeaves().points > 0;
}

}  // namespace

FeatureBatch::FeatureBatch(const MeshInstance& a, const MeshInstance& b,
                           const KdopShift* shift, const Kernels& kernels,
                           double cull_distance)
    : reader_a_(a),
      reader_b_(b),
      self_(&a == &b),
      bends_{{a.bend, b.bend}},
      tests_points_(cull_distance > 0 && (hasFreePoints(a) || hasFreePoints(b))),
      kernels_(kernels),
      pairs_(new TrianglePair[kMaxPairs]),
      owned_(new std::uint16_t[kMaxPairs]),
      edges_(new std::uint16_t[kMaxPairs]),
      gaps_(new float[kMaxPairs]),
      lists_{List(kNumVertexFacePairs), List(kNumFeaturePairs - kNumVertexFacePairs)},
      crossings_(new std::uint32_t[kMaxPairs * kEdges + 16]) {
  setCullDistance(shift, cull_distance);
}

void FeatureBatch::setCullDistance(const KdopShift* shift, double cull_distance) {
  // A distance is in the shift. Without one paths are not bent.
  assert(cull_distance == 0 || (cull_distance > 0 && shift));
  assert(cull_distance > 0 || !bends_.isAny());
  cull_distance_ = cull_distance;
  shift_ = shift;
  if (!shift) return;
  for (int j = 0; j < 16; ++j) {
    exchanged_shift_.t0.half[j] = shift->t0.half[j ^ 8];
    exchanged_shift_.t1.half[j] = shift->t1.half[j ^ 8];
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
  assert(next <= last);
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
  if (cull_distance_ == 0 && !isBeginning(latest) && has_edges_) leaveOutEdges();
  if (!has_edges_) return;
  const std::size_t size = kernels_.listFeatures(edges_.get(), num_pairs_,
                                                 (1U << kEdges) - 1, crossings_.get());
  // To a mesh with itself a shift adds nothing but a distance, which crossings do not
  // have.
  num_crossings_ = kernels_.cullCrossings(pairs_.get(), self_ ? nullptr : shift_,
                                          &exchanged_shift_, crossings_.get(), size);
  assert(num_crossings_ <= size && size <= kEdges * num_pairs_);
}

/// Moves a triangle pair to the end of those that are kept.
void FeatureBatch::keepPair(std::size_t i, std::size_t& kept) {
  assert(kept <= i && i < num_pairs_);
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
    const unsigned apart =
        kernels_.areApart(&pairs_[first], count, share, cull_distance_, gaps);
    assert(apart >> count == 0);
    counts.plane_culled += static_cast<unsigned>(countBits(apart));
    for (unsigned left = ~apart & ((1U << count) - 1); left != 0; left &= left - 1) {
      const auto lane = static_cast<std::size_t>(lowestBit(left));
      gaps_[kept] = gaps[lane];
      keepPair(first + lane, kept);
    }
  }
  num_pairs_ = kept;
}

void FeatureBatch::beginTask() { pause_ = wait_ = 0; }

/// Leaves out the triangle pairs that stay further apart than the distance during the
/// whole step. These may be most pairs, or few: that depends on the scene. A test costs a
/// quarter of what a pair costs that is left, so the first pairs of a block tell whether
/// it pays. Only pairs that own features count: of the others, threads may add more or
/// fewer. Without a distance most scenes have few such pairs, except where close surfaces
/// slide along each other, and the boxes of features leave them out nearly as fast. So
/// three of four of the first pairs must be apart then, and a block where they are not
/// lets the next ones go untested, up to kLongestPause.
void FeatureBatch::leaveOutFar(StageCounts& counts) {
  constexpr std::size_t kSample = 16;
  const std::size_t least = cull_distance_ > 0 ? kSample / 4 : 3 * kSample / 4;
  constexpr int kLongestPause = 15;
  if (wait_ > 0) {
    --wait_;
    return;
  }
  std::uint8_t apart[kMaxPairs / 8];
  std::size_t tried = 0, left_out = 0, culled = 0;
  for (std::size_t first = 0; first < num_pairs_; first += 8) {
    const std::size_t count = std::min<std::size_t>(8, num_pairs_ - first);
    const unsigned mask =
        kernels_.stayApart(&pairs_[first], count, cull_distance_, bends_);
    assert(mask >> count == 0);
    apart[first / 8] = static_cast<std::uint8_t>(mask);
    for (std::size_t i = 0; i < count; ++i)
      culled += owned_[first + i] != 0 ? mask >> i & 1U : 0;
    for (std::size_t i = 0; i < count && tried < kSample; ++i) {
      if (owned_[first + i] == 0) continue;
      left_out += mask >> i & 1U;
      if (++tried < kSample || left_out >= least) continue;
      if (cull_distance_ == 0) wait_ = pause_ = std::min(2 * pause_ + 1, kLongestPause);
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
      list(kind).codes.get());
  // The list has no room for more.
  assert(size <= num_pairs_ * (kind == ContinuousContactKind::kVertexFace
                                   ? kNumVertexFacePairs
                                   : kNumFeaturePairs - kNumVertexFacePairs));
  counts.feature_pairs += size;
  return size;
}

void FeatureBatch::cullAtStart(ContinuousContactKind kind, StageCounts& counts) {
  List& list = this->list(kind);
  assert(!bends_.isAny());
  const std::size_t size = listPairs(kind, counts);
  list.size = kernels_.cullFeatures(kind, pairs_.get(), shift_, &exchanged_shift_, 0,
                                    gaps_.get(), list.codes.get(), size, nullptr);
  assert(list.size <= size);
  counts.box_culled += size - list.size;
}

/// Keeps the pairs that the filter accepts, and returns the number of the others.
std::size_t FeatureBatch::keep(List& list, const PairFilter& filter) {
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

void FeatureBatch::cull(ContinuousContactKind kind, double latest, StageCounts& counts,
                        const PairFilter* filter) {
  List& list = this->list(kind);
  const std::size_t size = listPairs(kind, counts);
  list.size = kernels_.cullFeatures(kind, pairs_.get(), shift_, &exchanged_shift_,
                                    roundUp(latest, 0.f),
                                    isBeginning(latest) ? gaps_.get() : nullptr,
                                    list.codes.get(), size, list.windows.get());
  assert(list.size <= size);
  counts.box_culled += size - list.size;
  if (filter) counts.mask_culled += keep(list, *filter);
}

FeatureBatch::EdgeAndFace FeatureBatch::crossing(std::size_t i) const {
  assert(i < num_crossings_);
  const std::uint32_t code = crossings_[i], bit = codeBit(code);
  assert(codePair(code) < num_pairs_ && bit < kEdges);
  return {&pairs_[codePair(code)], bit % 3, bit < 3};
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
