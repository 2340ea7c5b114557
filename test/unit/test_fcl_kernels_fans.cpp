// SPDX-License-Identifier: BSD-3-Clause
//
// The kernel of fans: an embedded fan touches itself nowhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "elementary/distance_advance.h"
#include "elementary/elementary.h"
#include "kernel_checks.h"
#include "kernels/kernels.h"
#include "mesh/feature_pairs.h"
#include "mesh/mesh_topology.h"
#include "mesh/vertex_fans.h"
#include "mesh_generators.h"
#include "owned_features.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::allSets;
using test::forEachFeaturePair;
using test::Random;

/// A vertex and its spokes.
struct RandomFan {
  std::vector<TreeVertex> vertices;  // the spokes, then the center
  std::vector<std::uint32_t> spokes;
  bool is_closed;

  /// Spokes around a center that go `turns` times around it, more or less in a plane.
  RandomFan(Random& random, std::size_t count, bool closed, double turns, double noise)
      : is_closed(closed) {
    const Vector3<double> tilt = random.point(1), at = random.point(5);
    const double motion = random.uniform(0, 1);
    const auto add = [&](const Vector3<double>& p) {
      const Vector3<double> a = p + random.point(noise),
                            b = a + motion * random.point(noise);
      TreeVertex x{};
      for (int k = 0; k < 3; ++k) {
        // A shear, so that the plane is not a coordinate plane.
        x.t0[k] = a[k] + tilt[k] * a[(k + 1) % 3] + at[k];
        x.t1[k] = b[k] + tilt[k] * b[(k + 1) % 3] + at[k];
      }
      vertices.push_back(x);
    };
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = 2 * 3.14159265358979 * turns * static_cast<double>(i) /
                           static_cast<double>(closed ? count : count - 1);
      const double length = random.uniform(0.5, 1.5);
      add({length * std::cos(angle), length * std::sin(angle), 0});
      spokes.push_back(static_cast<std::uint32_t>(i));
    }
    add({0, 0, 0});
  }

  /// Whether features of the triangles that share no vertex touch at some time.
  bool doTouch() const {
    return isAny([](ContinuousContactKind kind, const VertexPath(&x)[4]) {
      return elementaryTest(kind, x, 0, 1, 1e-6).answer != Answer::kNo;
    });
  }

  /// Whether some of them come within a distance.
  bool doComeWithin(double distance) const {
    DistanceRequest request;
    request.distance = distance;
    return isAny([&](ContinuousContactKind kind, const VertexPath(&x)[4]) {
      return advanceToDistance(kind, {{&x[0], &x[1], &x[2], &x[3]}}, request).is_contact;
    });
  }

 private:
  /// Whether test(kind, points) is true of a pair of features that share no vertex.
  template <typename Test>
  bool isAny(const Test& test) const {
    std::vector<Triangle> triangles;
    const std::size_t n = spokes.size();
    for (std::size_t i = 0; i + (is_closed ? 0 : 1) < n; ++i)
      triangles.emplace_back(n, i, (i + 1) % n);
    const auto mesh = assignFeatures(triangles.data(), triangles.size(), n + 1);
    bool is_any = false;
    for (std::size_t i = 0; i < mesh.size(); ++i)
      for (std::size_t j = i + 1; j < mesh.size(); ++j)
        forEachFeaturePair<true>(mesh[i], mesh[j], [&](const FeaturePair& f) {
          const MeshTriangle &a = f.first_on_a ? mesh[i] : mesh[j],
                             &b = f.first_on_a ? mesh[j] : mesh[i];
          if (is_any) return;
          const bool vf = f.kind == ContinuousContactKind::kVertexFace;
          const VertexPath x[4] = {path(a.v[f.first]),
                                   path(vf ? b.v[0] : a.v[(f.first + 1) % 3]),
                                   path(vf ? b.v[1] : b.v[f.second]),
                                   path(vf ? b.v[2] : b.v[(f.second + 1) % 3])};
          is_any = test(f.kind, x);
        });
    return is_any;
  }

  VertexPath path(std::uint32_t i) const {
    const TreeVertex& x = vertices[i];
    return {{x.t0[0], x.t0[1], x.t0[2]}, {x.t1[0], x.t1[1], x.t1[2]}};
  }
};

/// The answers for up to eight fans of the same form, a bit each, equal on every
/// instruction set.
unsigned areEmbedded(const std::vector<RandomFan>& fans, double distance = 0) {
  // The vertices of all fans follow each other, those of the first fan last.
  std::vector<TreeVertex> vertices;
  std::vector<std::uint32_t> spokes[8];
  std::size_t centers[8];
  for (std::size_t i = 8; i-- > 0;) {
    const RandomFan& fan = fans[std::min(i, fans.size() - 1)];
    for (const std::uint32_t spoke : fan.spokes)
      spokes[i].push_back(spoke + static_cast<std::uint32_t>(vertices.size()));
    vertices.insert(vertices.end(), fan.vertices.begin(), fan.vertices.end());
    centers[i] = vertices.size() - 1;
  }
  EightFans eight;
  eight.count = static_cast<std::uint32_t>(fans.front().spokes.size());
  eight.is_closed = fans.front().is_closed;
  for (std::size_t i = 0; i < 8; ++i) {
    eight.center[i] = &vertices[centers[i]];
    eight.spokes[i] = spokes[i].data();
  }
  const unsigned found =
      allSets().front()->areFansEmbedded(vertices.data(), eight, distance);
  for (const Kernels* k : allSets())
    EXPECT_EQ(k->areFansEmbedded(vertices.data(), eight, distance), found) << k->name;
  const bool last = found >> (fans.size() - 1) & 1U;
  for (std::size_t i = fans.size(); i < 8; ++i) EXPECT_EQ(found >> i & 1U, last) << i;
  return found;
}

bool isEmbedded(const RandomFan& fan, double distance = 0) {
  return areEmbedded({fan}, distance) & 1U;
}

TEST(FCL_KERNELS, embeddedFansDoNotTouch) {
  constexpr std::uint64_t kSeed = 78;
  Random random(kSeed);
  int embedded[2] = {}, not_proved[2] = {}, touching = 0;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const bool closed = random.index(2);
    const std::size_t count = i % 8 ? 3 + random.index(6) : 9 + random.index(16);
    std::vector<RandomFan> fans;
    for (int n = 0; n < 8; ++n) {
      const double turns = closed ? (random.index(4) ? 1 : 2) : random.uniform(0.2, 1.4);
      fans.emplace_back(random, count, closed, turns, std::pow(random.uniform(0, 1), 2));
    }
    const unsigned found = areEmbedded(fans);
    for (std::size_t n = 0; n < 8; ++n) {
      const bool proved = found >> n & 1U;
      ++(proved ? embedded : not_proved)[closed];
      const bool touch = fans[n].doTouch();
      touching += touch;
      EXPECT_FALSE(proved && touch) << n << ", " << count << (closed ? ", closed" : "");
      // The answer of a fan does not depend on the other lanes.
      EXPECT_EQ(isEmbedded(fans[n]), proved) << n;
    }
  }
  for (const int c : {0, 1}) {
    EXPECT_GT(embedded[c], 100) << c;
    EXPECT_GT(not_proved[c], 100) << c;
  }
  EXPECT_GT(touching, 200);
}

// Fans of triangles that are low over one of their vertices, and of which a spoke is much
// shorter than its neighbours, so that these come near each other outside of the fan.
TEST(FCL_KERNELS, featuresOfFansThatAreHighStayApart) {
  constexpr std::uint64_t kSeed = 80;
  Random random(kSeed);
  int proved = 0, not_proved = 0, near = 0;
  for (int i = 0; i < 4000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const std::size_t count = i % 8 ? 3 + random.index(6) : 9 + random.index(16);
    RandomFan fan(random, count, true, 1, 0.3 * std::pow(random.uniform(0, 1), 2));
    if (random.index(2)) {
      TreeVertex& spoke = fan.vertices[random.index(count)];
      const double shorter = random.uniform(0.02, 1);
      for (int k = 0; k < 3; ++k) {
        spoke.t0[k] += (1 - shorter) * (fan.vertices.back().t0[k] - spoke.t0[k]);
        spoke.t1[k] += (1 - shorter) * (fan.vertices.back().t1[k] - spoke.t1[k]);
      }
    }
    const double distance = std::pow(10, random.uniform(-3, 0.3));
    const bool is_proved = isEmbedded(fan, distance),
               is_near = fan.doComeWithin(distance);
    EXPECT_FALSE(is_proved && is_near) << distance;
    EXPECT_FALSE(is_proved && !isEmbedded(fan));
    proved += is_proved;
    not_proved += isEmbedded(fan) && !is_proved;
    near += is_near;
  }
  EXPECT_GT(proved, 500);
  EXPECT_GT(not_proved, 500);
  EXPECT_GT(near, 500);
}

// A flat fan is embedded. A fan that goes around twice is not. For every number of
// spokes.
TEST(FCL_KERNELS, flatFans) {
  Random random(79);
  for (std::size_t count = 2; count <= 3 * VertexFans::kShort; ++count) {
    EXPECT_TRUE(isEmbedded(RandomFan(random, count, false, 0.4, 0))) << count;
    if (count < 3) continue;
    EXPECT_TRUE(isEmbedded(RandomFan(random, count, true, 1, 0)) || count == 3) << count;
    if (count >= 5) {
      EXPECT_FALSE(isEmbedded(RandomFan(random, count, true, 2, 0))) << count;
      EXPECT_FALSE(isEmbedded(RandomFan(random, count, false, 1.2, 0))) << count;
    }
  }
}

/// A fan in the plane z = 0 that does not move.
RandomFan flatFan(const std::vector<std::array<double, 2>>& spokes, bool closed) {
  Random random(81);
  RandomFan fan(random, spokes.size(), closed, 1, 0);
  for (std::size_t i = 0; i <= spokes.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      fan.vertices[i].t0[k] = fan.vertices[i].t1[k] =
          i < spokes.size() && k < 2 ? spokes[i][k] : 0;
  return fan;
}

// Six equal triangles with sides of 1 and a height of 0.866. The ends of an open fan may
// come near each other.
TEST(FCL_KERNELS, heightsOfARegularFan) {
  std::vector<std::array<double, 2>> spokes;
  for (int i = 0; i < 6; ++i)
    spokes.push_back({std::cos(i * M_PI / 3), std::sin(i * M_PI / 3)});
  const RandomFan closed = flatFan(spokes, true), open = flatFan(spokes, false);
  for (const double distance : {1e-300, 0.1, 0.5, 0.866}) {
    EXPECT_TRUE(isEmbedded(closed, distance)) << distance;
    EXPECT_FALSE(isEmbedded(open, distance)) << distance;
  }
  for (const double distance : {0.8661, 1., 1e300, HUGE_VAL})
    EXPECT_FALSE(isEmbedded(closed, distance)) << distance;
}

// The ray goes through the middle of the first sector. If a spoke lies on the ray, the
// test must not miss that the fan goes around twice.
TEST(FCL_KERNELS, spokeOnTheRay) {
  const RandomFan twice = flatFan(
      {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}, true);
  EXPECT_TRUE(twice.doTouch());
  EXPECT_FALSE(isEmbedded(twice));
  EXPECT_TRUE(isEmbedded(flatFan({{1, 0}, {0, 1}, {-1, 0}, {0, -1}}, true)));
}

// All triangles face the same way at both ends of the step, and all vertices meet in
// between.
TEST(FCL_KERNELS, fansThatTurnInsideOut) {
  for (const bool closed : {false, true}) {
    std::vector<std::array<double, 2>> spokes{{1, 0}, {0, 1}, {-1, 0}};
    if (closed) spokes.push_back({0, -1});
    RandomFan fan = flatFan(spokes, closed);
    EXPECT_TRUE(isEmbedded(fan)) << closed;
    for (TreeVertex& x : fan.vertices)
      for (int k = 0; k < 3; ++k) x.t1[k] = -x.t0[k];
    EXPECT_TRUE(fan.doTouch()) << closed;
    EXPECT_FALSE(isEmbedded(fan)) << closed;
  }
}

// Coordinates that are not finite, and fans without size, prove nothing.
TEST(FCL_KERNELS, fansOfAllSizes) {
  constexpr std::uint64_t kSeed = 80;
  Random random(kSeed);
  const double kBad[] = {std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::infinity(), 1e300};
  for (int i = 0; i < 2000; ++i) {
    const std::size_t count = 3 + random.index(14);
    RandomFan fan(random, count, random.index(2), 1, 0.05);
    const int exponent = static_cast<int>(random.index(2098)) - 1074;
    for (TreeVertex& x : fan.vertices)
      for (int k = 0; k < 3; ++k) {
        x.t0[k] = std::ldexp(x.t0[k], exponent);
        x.t1[k] = std::ldexp(x.t1[k], exponent);
      }
    const bool proved = isEmbedded(fan);
    if (count < 7 && proved) {
      EXPECT_FALSE(fan.doTouch()) << "seed " << kSeed << ", " << i;
    }
    TreeVertex& x = fan.vertices[random.index(count + 1)];
    (random.index(2) ? x.t0 : x.t1)[random.index(3)] = kBad[random.index(2)];
    EXPECT_FALSE(isEmbedded(fan)) << "seed " << kSeed << ", " << i;
  }
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
