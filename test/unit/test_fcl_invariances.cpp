// SPDX-License-Identifier: BSD-3-Clause
//
// Changes of the input that must not change the answer: names, order, sides, direction of
// time, units, axes, place, and number types that hold the coordinates exactly.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/utility.h"
#include "feature_test_calls.h"
#include "mesh_forms.h"
#include "moving_mesh.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using fcl::ContinuousContactKind;

/// The orders of three axes or vertices.
constexpr std::array<std::array<std::size_t, 3>, 6> kOrders{
    {{{0, 1, 2}}, {{0, 2, 1}}, {{1, 0, 2}}, {{1, 2, 0}}, {{2, 0, 1}}, {{2, 1, 0}}}};

// ---- Elementary tests

using Result = ContinuousFeatureTestResult<double>;
constexpr double kTocErr = 1e-7;

Result test(const MovingPair& pair) { return featureTest<double>(pair, kTocErr); }

/// One axis is flat, or all motion is along one axis, or some points are equal.
/// Coordinates are on a coarse grid, so that many of the pairs touch.
MovingPair degeneratePair(Random& random) {
  MovingPair pair = gridPair(random, 2);
  const std::size_t axis = random.index(3), i = random.index(4), j = random.index(4);
  switch (random.index(5)) {
    case 0:
      for (auto& p : pair.x) p.t0[axis] = p.t1[axis] = 0;
      break;
    case 1:
      for (auto& p : pair.x)
        for (std::size_t k = 0; k < 3; ++k)
          if (k != axis) p.t1[k] = p.t0[k];
      break;
    case 2:
      pair.x[i] = pair.x[j];
      break;
    case 3:  // a feature that is a line at all times
      pair.x[3] = pair.x[2];
      break;
    default:  // no relative motion
      for (auto& p : pair.x)
        for (int k = 0; k < 3; ++k) p.t1[k] = p.t0[k] + 1;
  }
  return pair;
}

/// Calls visit(pair, its answer, random) for thousands of pairs of each family. Expects
/// that many touch and many do not.
void forEachPair(
    std::uint64_t seed,
    const std::function<void(const MovingPair&, const Result&, Random&)>& visit) {
  Random random(seed);
  const std::function<MovingPair()> families[] = {
      [&] { return randomPair(random); },
      [&] { return nearContactPair(random, 0); },
      [&] { return gridPair(random, 3); },
      [&] { return degeneratePair(random); },
  };
  for (std::size_t family = 0; family < 4; ++family) {
    int touching = 0;
    constexpr int kPairs = 2500;
    for (int i = 0; i < kPairs; ++i) {
      const MovingPair pair = families[family]();
      const Result result = test(pair);
      touching += result.is_contact;
      visit(pair, result, random);
      if (testing::Test::HasFailure()) {
        ADD_FAILURE() << "family " << family << ", pair " << i << ", seed " << seed
                      << "\n"
                      << pair;
        return;
      }
    }
    EXPECT_GT(touching, kPairs / 20) << "family " << family;
    EXPECT_LT(touching, kPairs * 19 / 20) << "family " << family;
  }
}

/// Expects the same decision, and brackets of the same time.
void expectSame(const Result& x, const Result& y) {
  EXPECT_EQ(x.is_contact, y.is_contact);
  EXPECT_LE(x.toc_lo, y.toc_hi);
  EXPECT_LE(y.toc_lo, x.toc_hi);
}

TEST(FeatureTestInvariances, OrderOfFeaturesAndVertices) {
  std::vector<std::array<std::size_t, 4>> vf_orders, ee_orders;
  for (const auto& order : kOrders)
    vf_orders.push_back({0, 1 + order[0], 1 + order[1], 1 + order[2]});
  for (std::size_t i = 0; i < 8; ++i) {
    const std::size_t a = i & 1, b = i >> 1 & 1, first = i & 4 ? 2 : 0;
    ee_orders.push_back({first + a, first + 1 - a, 2 - first + b, 3 - first - b});
  }
  forEachPair(51, [&](const MovingPair& pair, const Result& expected, Random& random) {
    const auto& orders =
        pair.kind == ContinuousContactKind::kVertexFace ? vf_orders : ee_orders;
    for (int i = 0; i < 3; ++i)
      expectSame(test(reordered(pair, orders[random.index(orders.size())])), expected);
  });
}

TEST(FeatureTestInvariances, DirectionOfTime) {
  forEachPair(52, [](const MovingPair& pair, const Result& expected, Random&) {
    MovingPair reversed = pair;
    for (auto& p : reversed.x) std::swap(p.t0, p.t1);
    EXPECT_EQ(test(reversed).is_contact, expected.is_contact);
  });
}

TEST(FeatureTestInvariances, PowersOfTwo) {
  forEachPair(53, [](const MovingPair& pair, const Result& expected, Random& random) {
    for (const int exponent : {1, static_cast<int>(random.index(121)) - 60}) {
      const Result scaled =
          test(mapped(pair, [exponent](double c) { return std::ldexp(c, exponent); }));
      EXPECT_EQ(scaled.is_contact, expected.is_contact) << "2^" << exponent;
      EXPECT_EQ(scaled.toc_lo, expected.toc_lo) << "2^" << exponent;
      EXPECT_EQ(scaled.toc_hi, expected.toc_hi) << "2^" << exponent;
    }
  });
}

/// The point with axes in another order and some of them reversed.
template <typename Point>
Point seen(const Point& p, std::size_t order, unsigned negated) {
  Point out = p;
  for (std::size_t k = 0; k < 3; ++k)
    out[k] = (negated >> k & 1U ? -1 : 1) * p[kOrders[order][k]];
  return out;
}

TEST(FeatureTestInvariances, Axes) {
  forEachPair(54, [](const MovingPair& pair, const Result& expected, Random& random) {
    for (int view = 0; view < 3; ++view) {
      const std::size_t order = random.index(6);
      const auto negated = static_cast<unsigned>(random.index(8));
      MovingPair other = pair;
      for (std::size_t i = 0; i < 4; ++i)
        for (const auto frame :
             {&detail::deformable::VertexPath::t0, &detail::deformable::VertexPath::t1}) {
          const double(&p)[3] = pair.x[i].*frame;
          const auto q = seen(std::array<double, 3>{{p[0], p[1], p[2]}}, order, negated);
          std::copy(q.begin(), q.end(), other.x[i].*frame);
        }
      expectSame(test(other), expected);
    }
  });
}

TEST(FeatureTestInvariances, Place) {
  int moved_pairs = 0;
  forEachPair(55, [&](const MovingPair& pair, const Result& expected, Random& random) {
    const double shift[3] = {std::ldexp(1, static_cast<int>(random.index(20))), -17, 0.5};
    // Only if nothing is lost by rounding.
    MovingPair other = pair;
    for (std::size_t i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k)
        for (const auto frame :
             {&detail::deformable::VertexPath::t0, &detail::deformable::VertexPath::t1}) {
          const double from = (pair.x[i].*frame)[k], to = from + shift[k];
          if (to - shift[k] != from) return;
          (other.x[i].*frame)[k] = to;
        }
    ++moved_pairs;
    expectSame(test(other), expected);
  });
  EXPECT_GT(moved_pairs, 4000);
}

TEST(FeatureTestInvariances, TypeOfNumber) {
  forEachPair(56, [](const MovingPair& pair, const Result&, Random&) {
    const MovingPair rounded = floatPair(pair);
    const auto f = featureTest<float>(rounded, kTocErr);
    const Result d = test(rounded);
    EXPECT_EQ(f.is_contact, d.is_contact);
    EXPECT_LE(double{f.toc_lo}, d.toc_lo);
    EXPECT_GE(double{f.toc_hi}, d.toc_hi);
  });
}

// ---- Whole scenes

/// A mesh with itself, or with another one. Coordinates are multiples of 2^-12 (in every
/// third scene of 2^-3: much then touches exactly) below 8: floats hold them, also after
/// the motions below.
struct GridScene {
  MovingMesh a;
  std::optional<MovingMesh> b;
};

MovingMesh onGrid(MovingMesh mesh, double step) {
  for (auto* frame : {&mesh.t0, &mesh.t1})
    for (auto& p : *frame)
      for (int k = 0; k < 3; ++k) p[k] = std::round(p[k] / step) * step;
  return mesh;
}

GridScene makeGridScene(std::uint64_t seed) {
  Random random(seed);
  const double step = seed % 3 ? 0x1p-12 : 0x1p-3;
  const auto sheet = [&] { return onGrid(crumpledSheet(random, 6, 0.3), step); };
  const auto soup = [&] { return onGrid(randomSoup(random, 28, 40, 0.8, 0.3), step); };
  switch (seed % 4) {
    case 0:
      return {sheet(), {}};
    case 1:
      return {soup(), {}};
    case 2:
      return {sheet(), soup()};
    default:
      return {soup(), soup()};
  }
}

using Ids = std::vector<int>;

/// A contact by kind, side and the sets of the vertices of both features.
using Name = std::tuple<ContinuousContactKind, bool, Ids, Ids>;

struct Bracket {
  double lo, hi;
};

struct Answer {
  std::map<Name, Bracket> contacts;
  bool crossing;
};

/// New vertex id -> the id that the vertex has in the scene that is compared with.
struct Naming {
  Ids a, b;
};

Naming sameNames(const GridScene& scene) {
  Naming naming;
  naming.a.resize(scene.a.t0.size());
  naming.b.resize(scene.b ? scene.b->t0.size() : naming.a.size());
  std::iota(naming.a.begin(), naming.a.end(), 0);
  std::iota(naming.b.begin(), naming.b.end(), 0);
  return naming;
}

template <typename S>
Name nameOf(const ContinuousContact<S>& c, const Naming& naming, bool self) {
  const std::size_t split = c.kind == ContinuousContactKind::kVertexFace ? 1 : 2;
  Ids ids[2];
  for (std::size_t i = 0; i < 4; ++i) {
    const bool first = i < split;
    const Ids& old = self || first == c.first_on_o1 ? naming.a : naming.b;
    ids[first ? 0 : 1].push_back(old.at(static_cast<std::size_t>(c.vertices[i])));
  }
  for (Ids& feature : ids) std::sort(feature.begin(), feature.end());
  // The edges of one mesh have no order.
  if (self && split == 2 && ids[1] < ids[0]) std::swap(ids[0], ids[1]);
  return {c.kind, c.first_on_o1, ids[0], ids[1]};
}

template <typename Model>
auto modelOf(const MovingMesh& mesh) {
  return makeModel<Model>({mesh.t0, mesh.triangles}, {mesh.t1, mesh.triangles});
}

/// All contacts, by the names that their vertices have in `naming`.
template <typename ModelA, typename ModelB = ModelA>
Answer answerOf(const GridScene& scene, const Naming& naming) {
  using S = typename std::decay_t<decltype(*ModelA::vertices)>::Scalar;
  const auto a = modelOf<ModelA>(scene.a);
  ContinuousContactRequest<S> request;
  request.toc_err = S(0x1p-20);
  request.enable_contact = false;
  const auto result = scene.b ? pairContacts<S>(*a, *modelOf<ModelB>(*scene.b), request)
                              : selfContacts<S>(*a, request);
  Answer answer;
  answer.crossing = result.initially_crossing;
  for (const auto& c : result.contacts) {
    const Name name = nameOf(c, naming, !scene.b);
    EXPECT_TRUE(answer.contacts.emplace(name, Bracket{c.toc_lo, c.toc_hi}).second)
        << "twice";
  }
  return answer;
}

using Ours = DeformableBVHModel<KDOP<double, 16>>;
using OursOfFloats = DeformableBVHModel<KDOP<float, 16>>;
using Plain = BVHModel<OBBRSS<double>>;

Answer answerOf(const GridScene& scene) {
  return answerOf<Ours>(scene, sameNames(scene));
}

void expectSamePairs(const Answer& x, const Answer& y) {
  EXPECT_EQ(x.contacts.size(), y.contacts.size());
  for (const auto& [name, bracket] : x.contacts) EXPECT_TRUE(y.contacts.count(name));
}

/// Expects the same pairs with brackets of the same time, and the same crossing at t = 0.
void expectSame(const Answer& x, const Answer& y) {
  expectSamePairs(x, y);
  EXPECT_EQ(x.crossing, y.crossing);
  for (const auto& [name, bracket] : x.contacts) {
    const auto other = y.contacts.find(name);
    if (other == y.contacts.end()) continue;
    EXPECT_LE(bracket.lo, other->second.hi);
    EXPECT_LE(other->second.lo, bracket.hi);
  }
}

/// Calls visit(scene, its answer, random) for scenes of each kind.
void forEachScene(
    const std::function<void(const GridScene&, const Answer&, Random&)>& visit) {
  std::size_t contacts = 0;
  for (std::uint64_t seed = 700; seed < 748; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed + 1000);
    const GridScene scene = makeGridScene(seed);
    const Answer answer = answerOf(scene);
    contacts += answer.contacts.size();
    visit(scene, answer, random);
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(contacts, 5000U);
}

TEST(SceneInvariances, VertexIds) {
  forEachScene([](const GridScene& scene, const Answer& expected, Random& random) {
    GridScene other = scene;
    Naming naming;
    naming.a = renumber(other.a, random);
    if (other.b) naming.b = renumber(*other.b, random);
    expectSame(answerOf<Ours>(other, naming), expected);
  });
}

TEST(SceneInvariances, OrderOfTriangles) {
  forEachScene([](const GridScene& scene, const Answer& expected, Random& random) {
    const GridScene other =
        changed(scene, [&random](MovingMesh& mesh) { shuffle(mesh.triangles, random); });
    expectSame(answerOf(other), expected);
  });
}

TEST(SceneInvariances, OrderInsideTriangles) {
  forEachScene([](const GridScene& scene, const Answer& expected, Random& random) {
    const GridScene other = changed(scene, [&random](MovingMesh& mesh) {
      for (Triangle& t : mesh.triangles) {
        const auto& order = kOrders[random.index(6)];
        t = {t[static_cast<int>(order[0])], t[static_cast<int>(order[1])],
             t[static_cast<int>(order[2])]};
      }
    });
    expectSame(answerOf(other), expected);
  });
}

TEST(SceneInvariances, OrderOfModels) {
  forEachScene([](const GridScene& scene, const Answer& expected, Random&) {
    if (!scene.b) return;
    const GridScene other{*scene.b, scene.a};
    const Answer swapped = answerOf(other);
    Answer back{{}, swapped.crossing};
    for (const auto& [name, bracket] : swapped.contacts) {
      const auto& [kind, first_on_o1, first, second] = name;
      const bool vf = kind == ContinuousContactKind::kVertexFace;
      back.contacts[vf ? Name{kind, !first_on_o1, first, second}
                       : Name{kind, first_on_o1, second, first}] = bracket;
    }
    expectSame(back, expected);
  });
}

TEST(SceneInvariances, Axes) {
  forEachScene([](const GridScene& scene, const Answer& expected, Random&) {
    for (unsigned view = 0; view < 8; ++view) {
      const std::size_t order = view % kOrders.size();
      expectSame(
          answerOf(mappedScene(
              scene, [&](const Vector3<double>& p) { return seen(p, order, view); })),
          expected);
    }
  });
}

TEST(SceneInvariances, PowersOfTwo) {
  forEachScene([](const GridScene& scene, const Answer& expected, Random&) {
    for (const int exponent : {-60, -10, 1, 20, 60})
      expectSame(
          answerOf(mappedScene(scene,
                               [exponent](const Vector3<double>& p) {
                                 return Vector3<double>(std::ldexp(1, exponent) * p);
                               })),
          expected);
  });
}

TEST(SceneInvariances, DirectionOfTime) {
  forEachScene([](const GridScene& scene, const Answer& expected, Random&) {
    expectSamePairs(
        answerOf(changed(scene, [](MovingMesh& mesh) { std::swap(mesh.t0, mesh.t1); })),
        expected);
  });
}

TEST(SceneInvariances, Place) {
  forEachScene([](const GridScene& scene, const Answer& expected, Random&) {
    for (const double far : {4., 1000., 0x1p30}) {
      const Vector3<double> shift(far + 0x1p-12, -far, 0.5);
      const GridScene other = mappedScene(scene, [&shift](const Vector3<double>& p) {
        const Vector3<double> q = p + shift;
        EXPECT_TRUE(q - shift == p) << "not exact";
        return q;
      });
      expectSame(answerOf(other), expected);
    }
  });
}

TEST(SceneInvariances, TypeOfModelAndNumber) {
  forEachScene([](const GridScene& scene, const Answer& expected, Random&) {
    const Naming naming = sameNames(scene);
    expectSame(answerOf<OursOfFloats>(scene, naming), expected);
    expectSame(answerOf<Plain>(scene, naming), expected);
    expectSame(answerOf<Ours, Plain>(scene, naming), expected);
  });
}

}  // namespace
}  // namespace test
}  // namespace fcl
