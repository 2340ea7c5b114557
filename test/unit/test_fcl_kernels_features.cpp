// SPDX-License-Identifier: BSD-3-Clause
//
// The kernels of features: the list of the features in masks, and the feature pairs whose
// boxes overlap.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "kernel_checks.h"
#include "kernels/kernels.h"
#include "mesh/feature_pairs.h"
#include "mesh_generators.h"
#include "random_boxes.h"
#include "sanitizer.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::allSets;
using test::depthAtStart;
using test::doOverlapAtStart;
using test::Halves;
using test::makeBounds;
using test::OverlapTally;
using test::Random;
using test::randomBox;
using test::randomGap;
using test::randomHalves;
using test::randomScale;
using test::shifted;

void expectSameWindow(const detail::deformable::TimeWindow& window,
                      const detail::deformable::TimeWindow& expected) {
  EXPECT_EQ(window.lo, expected.lo);
  EXPECT_EQ(window.hi, expected.hi);
}

detail::deformable::MovingKdop merged(const detail::deformable::MovingKdop& a,
                                      const detail::deformable::MovingKdop& b) {
  detail::deformable::MovingKdop out;
  for (int j = 0; j < 16; ++j) {
    out.t0.half[j] = std::max(a.t0.half[j], b.t0.half[j]);
    out.t1.half[j] = std::max(a.t1.half[j], b.t1.half[j]);
  }
  return out;
}

/// Boxes of a triangle's vertices, edges and face.
struct ScalarBoxes {
  detail::deformable::MovingKdop vertex[3], edge[3], face;

  ScalarBoxes(const TreeVertex (&x)[3], const KdopShift* shift) {
    for (int k = 0; k < 3; ++k) vertex[k] = x[k].box;
    for (int k = 0; k < 3; ++k) edge[k] = merged(vertex[k], vertex[(k + 1) % 3]);
    face = merged(edge[0], vertex[2]);
    for (int k = 0; k < 3; ++k) {
      vertex[k] = shifted(vertex[k], shift);
      edge[k] = shifted(edge[k], shift);
    }
    face = shifted(face, shift);
  }
};

/// The boxes of the feature pair of a bit, a's first.
std::pair<detail::deformable::MovingKdop, detail::deformable::MovingKdop> boxesOf(
    int bit, const ScalarBoxes& a, const ScalarBoxes& b) {
  const FeaturePair pair = featurePair(bit);
  if (pair.kind == ContinuousContactKind::kEdgeEdge)
    return {a.edge[pair.first], b.edge[pair.second]};
  return pair.first_on_a ? std::make_pair(a.vertex[pair.first], b.face)
                         : std::make_pair(a.face, b.vertex[pair.first]);
}

struct TrianglePairBoxes {
  TreeVertex a[3], b[3];
  KdopShift shift;
  bool has_shift;

  explicit TrianglePairBoxes(Random& random) : has_shift(random.index(2)) {
    const float scale = randomScale(random);
    const bool one_kind = random.index(4);
    const Halves halves = randomHalves(random);
    for (int k = 0; k < 3; ++k) {
      a[k].box = randomBox(random, one_kind ? halves : randomHalves(random), scale);
      b[k].box = randomBox(random, one_kind ? halves : randomHalves(random), scale);
    }
    // Many boxes are moved apart along an axis, at the start, at the end or for the whole
    // step.
    if (random.index(3)) {
      const std::size_t j = random.index(16);
      const double start = random.uniform(-2, 6), end = random.uniform(-2, 6);
      for (TreeVertex& x : a) {
        x.box.t0.half[j] -= scale * static_cast<float>(start);
        x.box.t1.half[j] -= scale * static_cast<float>(end);
      }
    }
    for (int k = 0; k < 3; ++k) {
      makeBounds(a[k].box);
      makeBounds(b[k].box);
    }
    detail::deformable::MovingKdop box = randomBox(
        random, random.index(3) ? Halves::kSmooth : randomHalves(random), scale);
    makeBounds(box);
    shift = {box.t0, box.t1};
  }
  const KdopShift* shiftOrNull() const { return has_shift ? &shift : nullptr; }

  /// The same, for boxes of b's features.
  KdopShift exchangedShift() const {
    KdopShift exchanged;
    for (int j = 0; j < 16; ++j) {
      exchanged.t0.half[j] = shift.t0.half[j ^ 8];
      exchanged.t1.half[j] = shift.t1.half[j ^ 8];
    }
    return exchanged;
  }

  TrianglePair pair() const {
    return {{&a[0], &a[1], &a[2], &b[0], &b[1], &b[2]}, nullptr, nullptr};
  }
};

TEST(FCL_KERNELS, featuresOfMasks) {
  constexpr std::uint64_t kSeed = 84;
  Random random(kSeed);
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::uint16_t> masks(random.index(20));
    for (std::uint16_t& mask : masks) {
      mask = static_cast<std::uint16_t>(random.next() & 0xffffU);
      if (random.index(2)) mask &= static_cast<std::uint16_t>(random.next() & 0xffffU);
      if (random.index(8) == 0) mask = random.index(2) ? 0 : 0xffff;
    }
    const auto kept = static_cast<unsigned>(random.index(2) ? random.next() : ~0U);
    std::vector<std::uint32_t> expected;
    for (std::size_t k = 0; k < masks.size(); ++k)
      for (int bit = 0; bit < 16; ++bit)
        if (masks[k] & kept & 1U << bit)
          expected.push_back(featureCode(static_cast<std::uint32_t>(k), bit));
    for (const Kernels* k : allSets()) {
      // Exactly the room that the kernel asks for.
      std::vector<std::uint32_t> codes(expected.size() + 16);
      codes.resize(k->listFeatures(masks.data(), masks.size(), kept, codes.data()));
      ASSERT_EQ(codes, expected) << k->name << ", seed " << kSeed << ", " << i;
    }
  }
}

std::vector<TrianglePairBoxes> boxesWithOneShift(Random& random, std::size_t count) {
  std::vector<TrianglePairBoxes> boxes;
  for (std::size_t k = 0; k < count; ++k) {
    boxes.emplace_back(random);
    boxes[k].has_shift = boxes[0].has_shift;
    boxes[k].shift = boxes[0].shift;
  }
  return boxes;
}

// Several triangle pairs at a time. Codes and windows of the pairs that are left, in
// order.
TEST(FCL_KERNELS, featuresAsOverlapWindow) {
  constexpr std::uint64_t kSeed = 72;
  constexpr std::uint32_t kPairs = 9;
  Random random(kSeed);
  OverlapTally tally[kNumFeaturePairs];
  int late = 0, far = 0;
  for (int i = 0; i < test::rounds(12000); ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const std::vector<TrianglePairBoxes> boxes = boxesWithOneShift(random, kPairs);
    std::vector<TrianglePair> pairs;
    for (const TrianglePairBoxes& b : boxes) pairs.push_back(b.pair());
    const KdopShift exchanged_shift = boxes[0].exchangedShift();
    const KdopShift* shift = boxes[0].shiftOrNull();
    const float latest =
        random.index(2) ? 1.f : static_cast<float>(random.uniform(-0.1, 1));
    std::vector<float> gaps;
    for (const TrianglePairBoxes& b : boxes)
      gaps.push_back(
          randomGap(random, depthAtStart(b.a[random.index(3)].box, b.b[0].box)));
    const bool has_gaps = random.index(3) > 0;
    for (const ContinuousContactKind kind :
         {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge}) {
      std::vector<std::uint32_t> codes, left;
      std::vector<detail::deformable::TimeWindow> left_windows;
      for (std::uint32_t k = 0; k < kPairs; ++k)
        for (int bit = kind == ContinuousContactKind::kEdgeEdge ? 6 : 0;
             bit < (kind == ContinuousContactKind::kEdgeEdge ? kNumFeaturePairs : 6);
             ++bit) {
          if (random.index(3) == 0) continue;
          codes.push_back(featureCode(k, bit));
          // The shift is added to the vertex, or to edge a.
          const bool vertex_on_b = bit >= 3 && bit < 6;
          const ScalarBoxes a(boxes[k].a, vertex_on_b ? nullptr : shift),
              b(boxes[k].b, vertex_on_b && shift ? &exchanged_shift : nullptr);
          const auto [box_a, box_b] = boxesOf(bit, a, b);
          const detail::deformable::TimeWindow expected =
              overlapWindow<false>(box_a, box_b, nullptr);
          const bool is_far = has_gaps && depthAtStart(box_a, box_b) < -gaps[k];
          far += is_far && !expected.isEmpty();
          if (!expected.isEmpty() && expected.lo <= latest && !is_far) {
            left.push_back(codes.back());
            left_windows.push_back(expected);
          }
          late += !expected.isEmpty() && expected.lo > latest;
          tally[bit].add(!expected.isEmpty(), expected);
        }
      std::vector<detail::deformable::TimeWindow> first;
      for (const Kernels* kernels : allSets()) {
        std::vector<std::uint32_t> mine = codes;
        mine.resize(codes.size() + 15);
        std::vector<detail::deformable::TimeWindow> windows(codes.size());
        const std::size_t count = kernels->cullFeatures(
            kind, pairs.data(), shift, &exchanged_shift, latest,
            has_gaps ? gaps.data() : nullptr, mine.data(), codes.size(), windows.data());
        mine.resize(count);
        windows.resize(count);
        ASSERT_EQ(mine, left) << kernels->name;
        for (std::size_t k = 0; k < count; ++k)
          expectSameWindow(windows[k], left_windows[k]);
        if (first.empty()) first = windows;
        for (std::size_t k = 0; k < count; ++k)
          ASSERT_EQ(
              std::memcmp(&windows[k], &first[k], sizeof(detail::deformable::TimeWindow)),
              0)
              << kernels->name;
      }
    }
    ASSERT_FALSE(HasFailure());
  }
  for (int bit = 0; bit < kNumFeaturePairs; ++bit) {
    EXPECT_GT(tally[bit].overlaps, test::rounds(1000)) << bit;
    EXPECT_GT(tally[bit].apart, test::rounds(1000)) << bit;
    EXPECT_GT(tally[bit].cut, test::rounds(300)) << bit;
  }
  EXPECT_GT(late, test::rounds(1000));
  EXPECT_GT(far, test::rounds(1000));
}

TEST(FCL_KERNELS, edgesAndFacesAtStart) {
  constexpr std::uint64_t kSeed = 73;
  constexpr std::uint32_t kPairs = 12;
  Random random(kSeed);
  int overlaps[6] = {}, apart[6] = {};
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const std::vector<TrianglePairBoxes> boxes = boxesWithOneShift(random, kPairs);
    std::vector<TrianglePair> pairs;
    for (const TrianglePairBoxes& b : boxes) pairs.push_back(b.pair());
    const KdopShift exchanged_shift = boxes[0].exchangedShift();
    const KdopShift* shift = boxes[0].shiftOrNull();
    std::vector<std::uint32_t> codes, left;
    for (std::uint32_t k = 0; k < kPairs; ++k) {
      const ScalarBoxes a(boxes[k].a, nullptr), b(boxes[k].b, nullptr);
      const ScalarBoxes moved_a(boxes[k].a, shift),
          moved_b(boxes[k].b, shift ? &exchanged_shift : nullptr);
      for (int bit = 0; bit < 6; ++bit) {
        if (random.index(2)) continue;
        codes.push_back(featureCode(k, bit));
        const bool overlap = bit < 3 ? doOverlapAtStart(moved_a.edge[bit], b.face)
                                     : doOverlapAtStart(a.face, moved_b.edge[bit - 3]);
        if (overlap) left.push_back(codes.back());
        ++(overlap ? overlaps : apart)[bit];
      }
    }
    for (const Kernels* k : allSets()) {
      std::vector<std::uint32_t> mine = codes;
      mine.resize(codes.size() + 15);
      mine.resize(k->cullCrossings(pairs.data(), shift, &exchanged_shift, mine.data(),
                                   codes.size()));
      ASSERT_EQ(mine, left) << k->name;
    }
  }
  for (int bit = 0; bit < 6; ++bit) {
    EXPECT_GT(overlaps[bit], 500) << bit;
    EXPECT_GT(apart[bit], 500) << bit;
  }
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
