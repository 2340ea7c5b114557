// SPDX-License-Identifier: BSD-3-Clause
//
// Queries with min_distance of meshes that turn: against dense samples of all pairs of
// features by formulas of the motions, and against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/spline_motion.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "feature_distance.h"
#include "moving_mesh.h"
#include "reference_motion.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using V = Vector3<double>;
using Rigid = BVHModel<OBBRSS<double>>;
using Model = DeformableBVHModel<OBBRSS<double>>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Contact = ContinuousContact<double>;
using Kind = ContinuousContactKind;

/// A feature of one of two objects.
struct Feature {
  int object;
  std::vector<int> ids;
};

/// An object with its motion, as the library sees it and by formulas.
struct Object {
  Object(MovingMesh from, bool deforms_in_frame, const ReferenceMotion& reference_motion)
      : mesh(std::move(from)), reference(reference_motion) {
    if (!deforms_in_frame) mesh.t1 = mesh.t0;
    const TestMesh start{mesh.t0, mesh.triangles};
    if (deforms_in_frame) {
      auto model = makeModel<Model>(start);
      EXPECT_EQ(model->updateFrames(mesh.previous(), mesh.current(), mesh.t0.size()),
                BVH_OK);
      geometry = model;
    } else {
      geometry = makeModel<Rigid>(start);
    }
    const auto &begin = reference.beginning, &end = reference.end;
    switch (reference.kind) {
      case ReferenceMotion::Kind::kInterpolation:
        motion = std::make_shared<InterpMotion<double>>(
            begin.linear(), begin.translation(), end.linear(), end.translation(),
            reference.reference);
        return;
      case ReferenceMotion::Kind::kScrew:
        motion = std::make_shared<ScrewMotion<double>>(begin, end);
        return;
      default: {
        const auto& t = reference.translation_points;
        const auto& r = reference.rotation_points;
        motion = std::make_shared<SplineMotion<double>>(t[0], t[1], t[2], t[3], r[0],
                                                        r[1], r[2], r[3]);
      }
    }
  }

  std::vector<V> at(double t) const {
    const RealPose pose = reference.at(t);
    std::vector<V> out;
    for (std::size_t i = 0; i < mesh.t0.size(); ++i)
      out.push_back((pose * V((1 - t) * mesh.t0[i] + t * mesh.t1[i])).cast<double>());
    return out;
  }

  MovingMesh mesh;
  ReferenceMotion reference;
  std::shared_ptr<CollisionGeometry<double>> geometry;
  std::shared_ptr<MotionBase<double>> motion;
};

Result ask(const Object& o1, const Object& o2, const Request& request) {
  Result result;
  EXPECT_EQ(continuousCollide(o1.geometry.get(), o1.motion.get(), o2.geometry.get(),
                              o2.motion.get(), request, result),
            result.time_of_contact);
  return result;
}

/// Positions of the vertices of two objects at a time.
struct Moment {
  std::vector<V> of[2];
  Moment(const Object& o1, const Object& o2, double t) : of{o1.at(t), o2.at(t)} {}

  double distance(const Feature& first, const Feature& second) const {
    std::vector<V> x;
    for (const Feature* f : {&first, &second})
      for (const int id : f->ids)
        x.push_back(of[f->object][static_cast<std::size_t>(id)]);
    if (first.ids.size() == 2) return distanceOfEdges(x[0], x[1], x[2], x[3]);
    if (second.ids.size() == 1) return (x[0] - x[1]).norm();
    if (second.ids.size() == 2) return distanceOfEdges(x[0], x[0], x[1], x[2]);
    return distanceToFace(x[0], x[1], x[2], x[3]);
  }
};

Feature featureOf(int object, const int* first, const int* last) {
  return {object, std::vector<int>(first, last)};
}

std::pair<Feature, Feature> featuresOf(const Contact& c) {
  const int num_first = c.kind == Kind::kEdgeEdge ? 2 : 1;
  const int* ids = c.vertices.data();
  return {featureOf(c.first_on_o1 ? 0 : 1, ids, ids + num_first),
          featureOf(c.first_on_o1 ? 1 : 0, ids + num_first, ids + c.numVertices())};
}

bool isPartOf(const Feature& part, const Feature& whole) {
  return part.object == whole.object &&
         std::all_of(part.ids.begin(), part.ids.end(), [&](int id) {
           return std::count(whole.ids.begin(), whole.ids.end(), id) > 0;
         });
}

/// The pairs of features of two meshes.
std::vector<std::pair<Feature, Feature>> allPairs(const Object& o1, const Object& o2) {
  std::vector<std::pair<Feature, Feature>> pairs;
  const Object* o[] = {&o1, &o2};
  for (int side = 0; side < 2; ++side)
    for (int v = 0; v < static_cast<int>(o[side]->mesh.t0.size()); ++v)
      for (const Triangle& t : o[1 - side]->mesh.triangles)
        pairs.push_back(
            {{side, {v}},
             {1 - side,
              {static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])}}});
  for (const auto& e : uniqueEdges(o1.mesh.triangles))
    for (const auto& f : uniqueEdges(o2.mesh.triangles))
      pairs.push_back({{0, {e[0], e[1]}}, {1, {f[0], f[1]}}});
  return pairs;
}

/// The contact of the pair, or of parts of it, is not after the time.
bool hasContact(const Result& result, const std::pair<Feature, Feature>& pair, double t) {
  return std::any_of(
      result.contacts.begin(), result.contacts.end(), [&](const Contact& c) {
        if (c.toc_lo > t) return false;
        const auto [first, second] = featuresOf(c);
        return (isPartOf(first, pair.first) && isPartOf(second, pair.second)) ||
               (isPartOf(first, pair.second) && isPartOf(second, pair.first));
      });
}

/// Pairs that a sample sees within d have a contact that is not later.
/// @return the number of such pairs
int expectNoneMissed(const Object& o1, const Object& o2, double d, const Result& result) {
  constexpr int kSamples = 60;
  const auto pairs = allPairs(o1, o2);
  std::vector<double> first(pairs.size(), 2);
  for (int i = kSamples; i >= 0; --i) {
    const double t = static_cast<double>(i) / kSamples;
    const Moment now(o1, o2, t);
    for (std::size_t k = 0; k < pairs.size(); ++k)
      if (now.distance(pairs[k].first, pairs[k].second) < d * (1 - 1e-12)) first[k] = t;
  }
  int near = 0, missed = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (first[k] <= 1) {
      ++near;
      missed += !hasContact(result, pairs[k], first[k]);
    }
  EXPECT_EQ(missed, 0);
  return near;
}

/// The distance at the begin of the bracket is d, and within d at its end. Position and
/// normal fit.
void expectAtDistance(const Object& o1, const Object& o2, double d, const Contact& c) {
  constexpr double kTau = 1e-12;
  const auto [first, second] = featuresOf(c);
  const Moment now(o1, o2, c.toc_lo);
  const double distance = now.distance(first, second);
  EXPECT_LE(distance, d * (1 + 1e-9) + kTau);
  if (c.toc_lo > 0) {
    EXPECT_GE(distance, d - kTau);
  }
  EXPECT_EQ(c.within_tolerance, c.toc_lo > 0 && c.toc_hi == c.toc_lo);
  EXPECT_LE(c.toc_hi - c.toc_lo, 1e-4);
  if (c.toc_hi > c.toc_lo) {
    EXPECT_LE(Moment(o1, o2, c.toc_hi).distance(first, second), d + 1e-15);
  }
  // The normal leads from the feature of o1 over the position to that of o2.
  EXPECT_NEAR(c.normal.norm(), 1, 1e-12);
  const auto toFeature = [&](const V& p, const Feature& f) {
    Moment with_point = now;
    with_point.of[1 - f.object] = {p};
    return with_point.distance({1 - f.object, {0}}, f);
  };
  const Feature &of1 = first.object == 0 ? first : second,
                &of2 = first.object == 0 ? second : first;
  EXPECT_NEAR(toFeature(c.pos - 0.5 * distance * c.normal, of1), 0, 1e-9);
  EXPECT_NEAR(toFeature(c.pos + 0.5 * distance * c.normal, of2), 0, 1e-9);
}

/// Contacts by features, each once.
std::map<std::vector<int>, double> timesOf(const Result& result, bool swapped) {
  std::map<std::vector<int>, double> times;
  for (const Contact& c : result.contacts) {
    auto [first, second] = featuresOf(c);
    const bool of_second = (first.object == 1) != swapped;
    std::sort(first.ids.begin(), first.ids.end());
    std::sort(second.ids.begin(), second.ids.end());
    // EE and VV name the feature of o1 first.
    if (swapped && first.ids.size() == second.ids.size()) std::swap(first, second);
    std::vector<int> name{first.ids.size() == second.ids.size() ? 0 : of_second,
                          static_cast<int>(first.ids.size())};
    name.insert(name.end(), first.ids.begin(), first.ids.end());
    name.push_back(-1);
    name.insert(name.end(), second.ids.begin(), second.ids.end());
    EXPECT_TRUE(times.emplace(name, c.toc_lo).second);
  }
  return times;
}

Object randomObject(Random& random, bool deforms) {
  ReferenceMotion motion = randomMotion(random, 0.5);
  if (motion.kind == ReferenceMotion::Kind::kScrew && motion.angle < 0.1) {
    // FCL's screw is a little off its end at small angles.
    motion.turn(randomDirection(random), 1);
  }
  return Object(crumpledSheet(random, 3, 0.1), deforms, motion);
}

TEST(FCL_MOTION_DISTANCE, againstDenseSamples) {
  int near = 0;
  std::set<Kind> kinds;
  for (std::uint64_t seed = 0; seed < rounds(48U); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Object o1 = randomObject(random, seed & 1), o2 = randomObject(random, seed & 2);
    Request request;
    request.min_distance = std::pow(10, random.uniform(-3, -0.5));
    const Result result = ask(o1, o2, request);
    near += expectNoneMissed(o1, o2, request.min_distance, result);
    for (const Contact& c : result.contacts) {
      expectAtDistance(o1, o2, request.min_distance, c);
      kinds.insert(c.kind);
    }
    // The order of the objects.
    const auto times = timesOf(result, false),
               swapped = timesOf(ask(o2, o1, request), true);
    EXPECT_EQ(times.size(), swapped.size());
    for (const auto& [name, t] : times) {
      const auto at = swapped.find(name);
      ASSERT_NE(at, swapped.end());
      EXPECT_NEAR(at->second, t, 1e-6);
    }
    // Other kinds of query, and threads.
    request.num_threads = 2;
    EXPECT_EQ(timesOf(ask(o1, o2, request), false), times);
    for (const auto query : {ContinuousQuery::kFirst, ContinuousQuery::kAny}) {
      request.query = query;
      const Result first = ask(o1, o2, request);
      EXPECT_EQ(first.is_collide, result.is_collide);
      if (query == ContinuousQuery::kFirst) {
        EXPECT_NEAR(first.time_of_contact, result.time_of_contact, 1e-9);
      }
    }
  }
  EXPECT_GE(near, rounds(800));
  if (!kHasAddressSanitizer) {
    EXPECT_EQ(kinds.size(), 4U);
  }
}

constexpr double kPi = 3.14159265358979323846, kTurn = kPi / 2, kHalfWidth = 0.0625;

Transform3<double> turned(double angle) {
  Transform3<double> tf = Transform3<double>::Identity();
  tf.linear() = AngleAxis<double>(angle, V::UnitZ()).toRotationMatrix();
  return tf;
}

/// A bar along x that turns about z by kTurn, and a wall through the axis at an angle,
/// beyond kNear.
struct BarAndWall {
  static constexpr double kNear = 1.05;
  std::shared_ptr<Rigid> bar, wall;

  explicit BarAndWall(double angle) {
    bar = makeModel<Rigid>(moved(makeBox({1, kHalfWidth, kHalfWidth}, 4), 1, 0, 0));
    const V out(std::cos(angle), std::sin(angle), 0), up(0, 0, 1);
    TestMesh mesh;
    mesh.vertices = {kNear * out - up, 1.45 * out - up, 1.45 * out + up,
                     kNear * out + up};
    mesh.triangles = {Triangle(0, 1, 2), Triangle(0, 2, 3)};
    wall = makeModel<Rigid>(mesh);
  }

  /// The bar's side is at a distance from the near end of the wall.
  static double time(double angle, double distance) {
    return (angle - std::asin((kHalfWidth + distance) / kNear)) / kTurn;
  }

  Result ask(const Request& request, double turn = kTurn) const {
    const Transform3<double> still = Transform3<double>::Identity();
    Result result;
    continuousCollide(bar.get(), still, turned(turn), wall.get(), still, still, request,
                      result);
    return result;
  }
};

TEST(FCL_MOTION_DISTANCE, closedForms) {
  constexpr double kAngle = 0.9;
  const BarAndWall scene(kAngle);
  for (const double d : {1e-6, 1e-3, 0.05, 0.3}) {
    SCOPED_TRACE(d);
    for (const auto query :
         {ContinuousQuery::kAll, ContinuousQuery::kFirst, ContinuousQuery::kAny}) {
      Request request;
      request.query = query;
      request.min_distance = d;
      const Result result = scene.ask(request);
      const double time = BarAndWall::time(kAngle, d);
      ASSERT_TRUE(result.is_collide);
      EXPECT_LE(result.time_of_contact, time + 1e-15);
      EXPECT_GE(result.time_of_contact, time - 1e-12);
      EXPECT_GT(result.contacts.front().toc_hi, result.contacts.front().toc_lo);
      // Until just before.
      request.t_max = time - 1e-9;
      EXPECT_FALSE(scene.ask(request).is_collide);
    }
  }
}

// Two vertices on a circle.
TEST(FCL_MOTION_DISTANCE, verticesOnACircle) {
  constexpr double kAngle = 1, kDistance = 0.25;
  const auto triangleAt = [](double angle, double z) {
    const V out(std::cos(angle), std::sin(angle), 0);
    TestMesh mesh;
    mesh.vertices = {out, out + V(0, 0, z), 1.5 * out + V(0, 0, z)};
    mesh.triangles = {Triangle(0, 1, 2)};
    return makeModel<Rigid>(mesh);
  };
  const auto low = triangleAt(0, -1), high = triangleAt(kAngle, 1);
  const Transform3<double> still = Transform3<double>::Identity();
  Request request;
  request.min_distance = kDistance;
  Result result;
  continuousCollide(low.get(), still, turned(kTurn), high.get(), still, still, request,
                    result);
  ASSERT_EQ(result.contacts.size(), 1U);
  const Contact& c = result.contacts.front();
  EXPECT_EQ(c.kind, Kind::kVertexVertex);
  EXPECT_EQ(c.vertices, (std::array<int, 5>{{0, 0, -1, -1, -1}}));
  const double time = (kAngle - 2 * std::asin(kDistance / 2)) / kTurn;
  EXPECT_LE(c.toc_lo, time + 1e-15);
  EXPECT_GE(c.toc_lo, time - 1e-12);
  EXPECT_FALSE(c.within_tolerance);
  // A graze: the circle of the vertex passes at the distance, or at a little more.
  const V out(1 - kDistance, 0, 0);
  TestMesh beside;
  beside.vertices = {out, out + V(-0.5, 0, 1), out + V(-0.5, 0, 2)};
  beside.triangles = {Triangle(0, 1, 2)};
  const auto passed = makeModel<Rigid>(beside);
  for (const double share : {-1e-8, 1e-8}) {
    request.min_distance = kDistance * (1 + share);
    continuousCollide(low.get(), turned(-0.5), turned(0.5), passed.get(), still, still,
                      request, result);
    EXPECT_EQ(result.is_collide, share > 0);
    if (share > 0) {
      EXPECT_LE(result.time_of_contact, 0.5);
    }
  }
}

TEST(FCL_MOTION_DISTANCE, alreadyCloserAtTheBeginning) {
  // The near end of the wall is above the side of the bar by kGap.
  constexpr double kGap = 0.01, kDistance = 0.1;
  const double angle = std::asin((kHalfWidth + kGap) / BarAndWall::kNear);
  const BarAndWall scene(angle);
  for (const auto query :
       {ContinuousQuery::kAll, ContinuousQuery::kFirst, ContinuousQuery::kAny}) {
    Request request;
    request.query = query;
    request.min_distance = kDistance;
    EXPECT_EQ(scene.ask(request, -1).time_of_contact, 0);
    request.ignore_initially_closer = true;
    // Away from it, then towards it.
    EXPECT_FALSE(scene.ask(request, -1).is_collide);
    const Result towards = scene.ask(request, 1);
    EXPECT_TRUE(towards.is_collide);
    EXPECT_LE(towards.time_of_contact, 1e-8);
    // At rest.
    EXPECT_FALSE(scene.ask(request, 1e-13).is_collide);
  }
}

// Coaxial cylinders that turn against each other keep their distance. Meshes of them come
// as near as the corners of one are to the sides of the other one.
TEST(FCL_MOTION_DISTANCE, slidesAtTheDistance) {
  constexpr int kSides = 16;
  const auto ring = [](double radius) {
    return makeModel<Rigid>(makeTube(kSides, 1, [radius](double x, double y) {
      return V(radius * std::cos(2 * kPi * x), radius * std::sin(2 * kPi * x), y);
    }));
  };
  const double inner = 1, outer = 1.2 / std::cos(kPi / kSides), gap = 1.2 - inner;
  const auto o1 = ring(inner), o2 = ring(outer);
  const Transform3<double> still = Transform3<double>::Identity();
  for (const double share : {-1e-7, 1e-7}) {
    Request request;
    request.min_distance = gap * (1 + share);
    Result result;
    continuousCollide(o1.get(), turned(0.05), turned(0.6), o2.get(), still, still,
                      request, result);
    EXPECT_EQ(result.is_collide, share > 0);
  }
}

// Sheets that turn against each other in parallel planes.
TEST(FCL_MOTION_DISTANCE, slidesInAPlane) {
  constexpr double kGap = 0.2;
  const auto o1 = makeModel<Rigid>(makeSheet(3, 3)),
             o2 = makeModel<Rigid>(moved(makeSheet(2, 2), 0.1, 0.2, kGap));
  const Transform3<double> still = Transform3<double>::Identity();
  for (const double share : {-1e-7, 0., 1e-7}) {
    Request request;
    request.min_distance = kGap * (1 + share);
    Result result;
    continuousCollide(o1.get(), turned(0), turned(1), o2.get(), still, still, request,
                      result);
    EXPECT_EQ(result.is_collide, share >= 0);
    if (share >= 0) {
      EXPECT_EQ(result.time_of_contact, 0);
    }
  }
}

// Candidates within the distance hold all contacts of two features.
TEST(FCL_MOTION_DISTANCE, candidatesHoldTheContacts) {
  std::size_t contacts = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Random random(seed);
    const Object o1 = randomObject(random, seed & 1), o2 = randomObject(random, seed & 2);
    Request request;
    request.min_distance = 0.05;
    std::vector<ContinuousCandidate> all;
    EXPECT_TRUE(continuousCandidates(
        o1.geometry.get(), o1.motion.get(), o2.geometry.get(), o2.motion.get(),
        [&all](const ContinuousCandidate* some, std::size_t count) {
          all.insert(all.end(), some, some + count);
          return true;
        },
        request.min_distance));
    for (const Contact& c : ask(o1, o2, request).contacts) {
      const auto [first, second] = featuresOf(c);
      const auto holds = [&, &part1 = first, &part2 = second](const auto& candidate) {
        if (c.toc_lo < candidate.window_lo || c.toc_lo > candidate.window_hi)
          return false;
        const int num_first = candidate.kind == Kind::kEdgeEdge ? 2 : 1;
        const int* ids = candidate.vertices.data();
        const Feature x = featureOf(candidate.first_on_o1 ? 0 : 1, ids, ids + num_first),
                      y = featureOf(candidate.first_on_o1 ? 1 : 0, ids + num_first,
                                    ids + 4);
        return (isPartOf(part1, x) && isPartOf(part2, y)) ||
               (isPartOf(part1, y) && isPartOf(part2, x));
      };
      EXPECT_TRUE(std::any_of(all.begin(), all.end(), holds));
      ++contacts;
    }
  }
  EXPECT_GE(contacts, 150U);
}

// What crosses at t = 0 is told, also where no features are near.
TEST(FCL_MOTION_DISTANCE, crossingAtTheBeginning) {
  TestMesh floor, needle;
  floor.vertices = {V(-9, -9, 0), V(9, -9, 0), V(0, 9, 0)};
  floor.triangles = {Triangle(0, 1, 2)};
  needle.vertices = {V(0, 0, -5), V(1, 0, 5), V(-1, 0, 5)};
  needle.triangles = {Triangle(0, 1, 2)};
  const auto o1 = makeModel<Rigid>(floor), o2 = makeModel<Rigid>(needle);
  const Transform3<double> still = Transform3<double>::Identity();
  Request request;
  request.min_distance = 0.01;
  for (const bool ignores : {false, true}) {
    request.ignore_initially_closer = ignores;
    Result result;
    continuousCollide(o1.get(), still, still, o2.get(), still, turned(1), request,
                      result);
    EXPECT_TRUE(result.is_collide);
    EXPECT_EQ(result.time_of_contact, 0);
    EXPECT_TRUE(result.initially_crossing);
    EXPECT_TRUE(result.contacts.empty());
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl
