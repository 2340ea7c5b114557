// SPDX-License-Identifier: BSD-3-Clause
//
// ContinuousContactRequest::min_approach_speed: pairs of features against samples of
// their paths, bodies that slide over floors of triangles, and bodies that hit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "elementary/approach_speed.h"
#include "elementary/distance_advance.h"
#include "elementary/elementary.h"
#include "fcl/common/exception.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "feature_distance.h"
#include "moving_mesh.h"
#include "random_direction.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::advanceToApproach;
using detail::deformable::advanceToDistance;
using detail::deformable::Answer;
using detail::deformable::approachesFrom;
using detail::deformable::DistanceContact;
using detail::deformable::DistanceRequest;
using detail::deformable::ElementaryResult;
using detail::deformable::elementaryTest;
using detail::deformable::FeaturePoints;
using detail::deformable::PairStars;
using detail::deformable::VertexPath;
using Vector = Vector3<double>;
using Kind = ContinuousContactKind;
using Model = DeformableBVHModel<OBBRSS<double>>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;

/// The number of random cases; fewer with a sanitizer.
constexpr int manyOf(int count) { return kHasAddressSanitizer ? count / 10 : count; }

// Pairs of features.

struct RandomPair {
  Kind kind;
  VertexPath path[4];

  FeaturePoints points() const { return {{&path[0], &path[1], &path[2], &path[3]}}; }
  Vector at(int i, double t) const {
    Vector p;
    for (int k = 0; k < 3; ++k) p[k] = (1 - t) * path[i].t0[k] + t * path[i].t1[k];
    return p;
  }
  double distanceAt(double t) const {
    const Vector p = at(0, t), q = at(1, t), r = at(2, t), s = at(3, t);
    switch (kind) {
      case Kind::kVertexFace:
        return distanceToFace(p, q, r, s);
      case Kind::kEdgeEdge:
        return distanceOfEdges(p, q, r, s);
      case Kind::kVertexEdge:
        return distanceOfEdges(p, p, q, r);
      default:
        return (q - p).norm();
    }
  }
  /// The common normal, and the height along it.
  Vector normalAt(double t) const {
    const bool is_face = kind == Kind::kVertexFace;
    const Vector v = is_face ? at(2, t) - at(1, t) : at(1, t) - at(0, t),
                 w = is_face ? at(3, t) - at(1, t) : at(3, t) - at(2, t);
    return v.cross(w);
  }
  double heightAt(double t) const {
    const bool is_face = kind == Kind::kVertexFace;
    const Vector u = is_face ? at(0, t) - at(1, t) : at(2, t) - at(0, t);
    return u.dot(normalAt(t).normalized());
  }
  /// Whether they are above each other, by far more than rounding.
  bool areAboveAt(double t) const {
    const Vector n = normalAt(t);
    if (kind == Kind::kVertexFace) {
      for (int i = 0; i < 3; ++i) {
        const Vector from = at(1 + i, t), to = at(1 + (i + 1) % 3, t);
        if (!((to - from).cross(at(0, t) - from).dot(n) > 1e-9)) return false;
      }
      return true;
    }
    const Vector u = at(2, t) - at(0, t), v = at(1, t) - at(0, t),
                 w = at(3, t) - at(2, t);
    const double s = u.cross(w).dot(n), r = u.cross(v).dot(n), all = n.squaredNorm();
    return s > 1e-9 && r > 1e-9 && s < all - 1e-9 && r < all - 1e-9;
  }
};

/// Points in a slab at rest, which move along it by up to 1, and by little across.
RandomPair randomPair(Random& random, Kind kind, double thickness, double across) {
  RandomPair pair;
  pair.kind = kind;
  const Matrix3<double> turn =
      AngleAxis<double>(random.uniform(0, 3), randomDirection(random)).toRotationMatrix();
  const int num_first = kind == Kind::kEdgeEdge ? 2 : 1;
  const Vector way = random.point(0.7);
  for (int i = 0; i < 4; ++i) {
    Vector p = random.point(0.6);
    p.z() = i < num_first ? thickness : 0;
    Vector q = p + random.point(0.1);
    if (i < num_first) q += way;
    q.z() = p.z() + across * random.uniform(-1, 1);
    p = turn * p;
    q = turn * q;
    for (int k = 0; k < 3; ++k) {
      pair.path[i].t0[k] = p[k];
      pair.path[i].t1[k] = q[k];
    }
  }
  return pair;
}

/// No pair comes nearer than the option allows before its contact, and a contact that is
/// reported approaches faster.
TEST(FCL_APPROACH_SPEED, distancesAgainstSamples) {
  constexpr int kSamples = 400;
  constexpr double kDistance = 0.1, kRounding = 1e-8;
  Random random(1);
  int left_out = 0, later = 0, kept = 0;
  for (int i = 0; i < manyOf(40000); ++i) {
    constexpr Kind kKinds[] = {Kind::kVertexFace, Kind::kEdgeEdge, Kind::kVertexEdge,
                               Kind::kVertexVertex};
    const RandomPair pair = randomPair(random, kKinds[i % 4], random.uniform(0.05, 0.15),
                                       i % 8 < 4 ? .02 : .2);
    DistanceRequest request;
    request.distance = kDistance;
    request.toc_err = 1e-6;
    const DistanceContact off = advanceToDistance(pair.kind, pair.points(), request);
    const double speed = std::pow(10, random.uniform(-4, -.5));
    const DistanceContact on =
        advanceToApproach(pair.kind, pair.points(), request, speed);
    SCOPED_TRACE(std::to_string(i));
    ASSERT_FALSE(on.is_given_up);
    if (!off.is_contact) {
      ASSERT_FALSE(on.is_contact);
      continue;
    }
    const double toc = on.is_contact ? on.toc_lo : 1;
    ASSERT_GE(toc, off.toc_lo);
    const double allowed = std::min(kDistance, pair.distanceAt(off.toc_lo));
    for (int j = 0; j <= kSamples; ++j) {
      const double t = toc * j / kSamples;
      if (t < off.toc_lo) continue;
      ASSERT_GE(pair.distanceAt(t), allowed - speed * (t - off.toc_lo) - kRounding) << t;
    }
    if (!on.is_contact) {
      ++left_out;
      continue;
    }
    ++(on.toc_lo > off.toc_hi ? later : kept);
    // From some time before, or just after it.
    double fastest = 0;
    const double there = std::min(kDistance, pair.distanceAt(toc)),
                 soon = std::min(1e-5, 1 - toc);
    if (soon > 0) fastest = (there - pair.distanceAt(toc + soon)) / soon;
    for (int j = 0; j < kSamples; ++j) {
      const double t = off.toc_lo + (toc - off.toc_lo) * j / kSamples;
      if (toc - t > 1e-5)
        fastest = std::max(fastest,
                           (std::min(kDistance, pair.distanceAt(t)) - there) / (toc - t));
    }
    // A lower speed is allowed where the pair would touch within the step.
    const double least = std::min(speed, there / (1 - off.toc_lo));
    EXPECT_GE(fastest, 0.98 * least - 2e-3 * speed - 1e-5) << toc;
  }
  EXPECT_GE(left_out, manyOf(1000));
  EXPECT_GE(later, manyOf(30));
  EXPECT_GE(kept, manyOf(1000));
}

/// The same for features that touch: the height changes slowly until the time from which
/// on they approach.
TEST(FCL_APPROACH_SPEED, touchingAgainstSamples) {
  constexpr int kSamples = 400;
  Random random(2);
  int left_out = 0, later = 0, kept = 0, undecided = 0;
  for (int i = 0; i < manyOf(40000); ++i) {
    const double across = std::pow(10, random.uniform(-4, 0));
    const RandomPair pair =
        randomPair(random, i % 2 ? Kind::kVertexFace : Kind::kEdgeEdge,
                   i % 3 ? across * random.uniform(0, 1) : 0, across);
    const ElementaryResult touch = elementaryTest(pair.kind, pair.points(), 0, 1, 1e-6);
    if (touch.answer != Answer::kYes) continue;
    const double speed = std::pow(10, random.uniform(-4, -0.5));
    const double from =
        approachesFrom(pair.kind, pair.points(), {touch.toc_lo, touch.toc_hi, 1, speed});
    SCOPED_TRACE(std::to_string(i));
    const auto speedAt = [&pair](double t) {
      constexpr double kStep = 1e-6;
      const double lo = std::max(0., t - kStep), hi = std::min(1., t + kStep);
      return (pair.heightAt(hi) - pair.heightAt(lo)) / (hi - lo);
    };
    const double before = touch.toc_lo > 0 ? pair.heightAt(touch.toc_lo) : 0;
    for (int j = 0; j < kSamples && from > touch.toc_hi; ++j) {
      const double t = touch.toc_hi + (std::min(from, 1.) - touch.toc_hi) * j / kSamples;
      if (!pair.areAboveAt(t)) continue;
      // On the side from which they came they may part quickly.
      if (before * pair.heightAt(t) > 0) continue;
      ASSERT_LE(std::abs(speedAt(t)), speed + 1e-7) << t;
    }
    if (from > 1) {
      ++left_out;
    } else {
      ++(from > touch.toc_hi ? later : kept);
      // Within the shortest interval the speed is reached.
      double fastest = 0;
      for (int j = 0; j <= 8; ++j)
        fastest = std::max(fastest, std::abs(speedAt(from + 0x1p-13 * j / 8)));
      if (fastest < 0.98 * speed - 1e-6) ++undecided;
    }
  }
  EXPECT_GE(left_out, manyOf(500));
  EXPECT_GE(later, manyOf(30));
  EXPECT_GE(kept, manyOf(500));
  // Of edges that are nearly parallel.
  EXPECT_LE(undecided, (later + kept) / 20);
}

/// A bracket of the first touch that is so wide that the features also change sides in it
/// where they are not above each other does not hide an approach.
TEST(FCL_APPROACH_SPEED, wideBrackets) {
  Random random(16);
  int later = 0;
  for (int i = 0; i < manyOf(100000); ++i) {
    const Kind kind = i % 2 ? Kind::kVertexFace : Kind::kEdgeEdge;
    const RandomPair pair =
        randomPair(random, kind, random.uniform(0, 0.05), i % 3 ? 0.1 : 0.02);
    const ElementaryResult tight = elementaryTest(kind, pair.points(), 0, 1, 1e-9);
    if (tight.answer != Answer::kYes) continue;
    const double before = random.uniform(0, 0.5), speed = random.uniform(0.01, 0.1),
                 lo = std::max(0., tight.toc_lo - before),
                 from = approachesFrom(kind, pair.points(),
                                       {tight.toc_lo, tight.toc_hi, 1, speed}),
                 of_wide =
                     approachesFrom(kind, pair.points(), {lo, tight.toc_hi, 1, speed});
    later += from > tight.toc_hi && from <= 1;
    SCOPED_TRACE(std::to_string(i));
    EXPECT_LE(of_wide, from + 0x1p-12);
  }
  EXPECT_GE(later, manyOf(100));
}

VertexPath pathOf(const Vector& from, const Vector& to) {
  return {{from.x(), from.y(), from.z()}, {to.x(), to.y(), to.z()}};
}

/// A face and a vertex at rest in (0, 0, 0), with six triangles around it in z = 0.
struct FaceOverVertex {
  VertexPath path[4] = {pathOf(Vector::Zero(), Vector::Zero()), {}, {}, {}};
  std::vector<Vector> ring;
  PairStars stars;

  FaceOverVertex(const Vector (&from)[3], const Vector (&to)[3]) {
    for (int k = 0; k < 3; ++k) path[1 + k] = pathOf(from[k], to[k]);
    for (int k = 0; k < 6; ++k)
      ring.emplace_back(std::cos(k * M_PI / 3), std::sin(k * M_PI / 3), 0);
    setStar({0, 1, 2, 3, 4, 5});
  }
  /// The triangles that begin at these spokes.
  void setStar(const std::vector<std::uint32_t>& spokes) {
    stars.at[0].clear();
    for (const std::uint32_t k : spokes) {
      const std::uint32_t l = (k + 1) % 6;
      stars.at[0].push_back(
          {{k, l}, {pathOf(ring[k], ring[k]), pathOf(ring[l], ring[l])}});
    }
  }
  double from(double speed, double toc_lo, double toc_hi) const {
    return approachesFrom(Kind::kVertexFace, {{&path[0], &path[1], &path[2], &path[3]}},
                          {toc_lo, toc_hi, 1, speed, &stars});
  }
  double from(double speed = 0.01) const { return from(speed, 0.5, 0.5 + 1e-7); }
};

/// A side face whose lower border meets the vertex at t = 0.5 and sinks by `sinks`.
FaceOverVertex sideFace(double sinks = 0) {
  const Vector by(-1, 0.3, -sinks);
  const Vector from[3] = {{.5, -2, 0}, {.5, 2, 0}, {.5, 0, 1}},
               to[3] = {from[0] + by, from[1] + by, from[2] + by};
  return {from, to};
}

/// Which vertices are inside of a flat part, and what passes over it.
TEST(FCL_APPROACH_SPEED, facesOverFlatVertices) {
  EXPECT_GT(sideFace().from(), 1);
  EXPECT_GT(sideFace(-0.5).from(), 1);
  // It sinks more slowly than the speed, or faster.
  EXPECT_GT(sideFace(0.008).from(), 1);
  EXPECT_LE(sideFace(0.012).from(), 0.5 + 1e-7);
  // It reaches far below the plane.
  FaceOverVertex deep = sideFace();
  for (int k = 1; k < 3; ++k) deep.path[k].t0[2] = deep.path[k].t1[2] = -0.5;
  EXPECT_LE(deep.from(), 0.5 + 1e-7);
  // A triangle is not there, or there are three on one side that fold over each other.
  FaceOverVertex open = sideFace();
  open.setStar({0, 1, 2, 3, 4});
  EXPECT_LE(open.from(), 0.5 + 1e-7);
  FaceOverVertex folded = sideFace();
  folded.ring[2] = folded.ring[0];
  folded.setStar({0, 1});
  EXPECT_LE(folded.from(), 0.5 + 1e-7);
  // Triangles with other windings, and twice, are as good.
  FaceOverVertex twice = sideFace();
  twice.setStar({0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 4, 5});
  for (std::size_t k = 0; k < 6; ++k) {
    std::swap(twice.stars.at[0][k].ids[0], twice.stars.at[0][k].ids[1]);
    std::swap(twice.stars.at[0][k].x[0], twice.stars.at[0][k].x[1]);
  }
  EXPECT_GT(twice.from(), 1);
  // A spoke is above the plane.
  for (const double height : {1e-9, 1e-7}) {
    FaceOverVertex bent = sideFace();
    bent.ring[3].z() = height;
    bent.setStar({0, 1, 2, 3, 4, 5});
    EXPECT_EQ(bent.from() > 1, height < 0x1p-20 * 0.01);
  }
}

/// A face that falls flat on the vertex approaches it along the normal, also if the
/// bracket of the touch ends just below, where the two are apart again.
TEST(FCL_APPROACH_SPEED, facesThatFallOnFlatVertices) {
  constexpr double kSlow = 0.01, kLittle = 0x1p-20 * kSlow;
  const Vector down(0, 0, 2);
  const Vector from[3] = {{-2, -2, 1}, {2, -2, 1}, {0, 2, 1}},
               to[3] = {from[0] - down, from[1] - down, from[2] - down};
  const FaceOverVertex face(from, to);
  for (const double below : {0.1, 0.25, 0.5}) {
    const double lo = 0.5 - kLittle, hi = 0.5 + 0.5 * below * kLittle;
    EXPECT_LE(face.from(kSlow, lo, hi), hi);
  }
}

// Bodies.

constexpr double kDistance = 0.01, kSpeed = 1e-3;

/// A floor around the origin in z = 0: `half` is half of its length.
TestMesh makeFloor(int quads, double half) {
  return makeSheet(quads, quads, [half](double u, double v) {
    return Vector(half * (2 * u - 1), half * (2 * v - 1), 0);
  });
}

/// A box whose bottom is at z = 0, turned about z.
TestMesh makeBody(Random& random) {
  const Vector half(random.uniform(0.1, 0.3), random.uniform(0.1, 0.3), 0.1);
  TestMesh body = makeBox(half, 1 + static_cast<int>(random.index(3)));
  const Matrix3<double> turn =
      AngleAxis<double>(random.uniform(0, 3), Vector::UnitZ()).toRotationMatrix();
  for (auto& p : body.vertices) p = turn * p + Vector(0, 0, half.z());
  return body;
}

/// Where a scene is: rotations round its coordinates.
struct Place {
  Matrix3<double> turn;
  Vector offset;

  explicit Place(Random& random)
      : turn(AngleAxis<double>(random.uniform(0, 3), randomDirection(random))
                 .toRotationMatrix()),
        offset(random.point(3)) {}
  std::shared_ptr<Model> model(const TestMesh& t0, const TestMesh& t1) const {
    return makeModel<Model>(placed(t0), placed(t1));
  }

 private:
  TestMesh placed(TestMesh mesh) const {
    for (auto& p : mesh.vertices) p = turn * p + offset;
    return mesh;
  }
};

TestMesh moved(const TestMesh& mesh, const Vector& by) {
  return moved(mesh, by.x(), by.y(), by.z());
}

/// A way along the floor.
Vector slideOf(Random& random, double length) {
  const double angle = random.uniform(0, 7);
  return {length * std::cos(angle), length * std::sin(angle), 0};
}

Request requestOf(ContinuousQuery query, double distance, double speed = kSpeed) {
  Request request;
  request.query = query;
  request.min_distance = distance;
  request.min_approach_speed = speed;
  return request;
}

constexpr ContinuousQuery kQueries[] = {ContinuousQuery::kAll, ContinuousQuery::kFirst,
                                        ContinuousQuery::kAny};

/// A body slides at the distance of contact or 1e-9 above or below it, and may turn about
/// the vertical: the edges inside of the floor do not stop it. Without the option nearly
/// all are stopped.
TEST(FCL_APPROACH_SPEED, slidesAtADistance) {
  Random random(3);
  int stopped_without = 0;
  const int count = manyOf(1000);
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(std::to_string(i));
    const Place place(random);
    const TestMesh floor = makeFloor(4 + i % 5, 1.5), body = makeBody(random);
    const double height = kDistance + (i % 3 - 1) * 1e-9;
    const TestMesh from = moved(body, Vector(0, 0, height) + slideOf(random, 0.3));
    TestMesh to = moved(from, slideOf(random, random.uniform(0.1, 0.9)));
    if (i % 2) {
      const Matrix3<double> turn =
          AngleAxis<double>(0.2, Vector::UnitZ()).toRotationMatrix();
      for (auto& p : to.vertices) p = turn * p;
    }
    const auto o1 = place.model(from, to), o2 = place.model(floor, floor);
    const ContinuousQuery query = kQueries[i / 2 % 3];
    const Result result =
        i % 7 ? pairContacts<double>(*o1, *o2, requestOf(query, kDistance))
              : pairContacts<double>(*o2, *o1, requestOf(query, kDistance));
    EXPECT_FALSE(result.is_collide);
    EXPECT_EQ(result.contacts.size(), 0U);
    stopped_without +=
        pairContacts<double>(*o1, *o2, requestOf(query, kDistance, 0)).is_collide;
  }
  EXPECT_GE(stopped_without, count / 2);
}

/// A plate that slides on the floor, touching it or 1e-9 above it. Rounded coordinates
/// may cross at t = 0, which is reported as ever.
TEST(FCL_APPROACH_SPEED, slidesThatTouch) {
  Random random(4);
  int touch_without = 0;
  const int count = manyOf(1000);
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(std::to_string(i));
    const Place place(random);
    const TestMesh floor = makeFloor(4 + i % 5, 1.5);
    const Matrix3<double> turn =
        AngleAxis<double>(random.uniform(0, 3), Vector::UnitZ()).toRotationMatrix();
    TestMesh plate = makeFloor(1 + i % 3, random.uniform(0.1, 0.3));
    for (auto& p : plate.vertices) p = turn * p;
    const TestMesh from =
        moved(plate, Vector(0, 0, i % 3 ? 0 : 1e-9) + slideOf(random, 0.3));
    const TestMesh to = moved(from, slideOf(random, random.uniform(0.1, 0.9)));
    const bool is_rounded = i % 2;
    const auto o1 = is_rounded ? place.model(from, to) : makeModel<Model>(from, to),
               o2 = is_rounded ? place.model(floor, floor)
                               : makeModel<Model>(floor, floor);
    const ContinuousQuery query = kQueries[i / 2 % 3];
    const Result result = pairContacts<double>(*o1, *o2, requestOf(query, 0));
    EXPECT_EQ(result.contacts.size(), 0U);
    EXPECT_EQ(result.is_collide, result.initially_crossing);
    touch_without +=
        !pairContacts<double>(*o1, *o2, requestOf(query, 0, 0)).contacts.empty();
  }
  EXPECT_GE(touch_without, count / 3);
}

/// A box that stands on a floor, whose bottom is at z = 0 exactly.
TestMesh makeStandingBody(Random& random, bool is_turned) {
  const Vector half(random.uniform(0.1, 0.3), random.uniform(0.1, 0.3), 0.1);
  TestMesh body = makeBox(half, 1 + static_cast<int>(random.index(3)));
  const Matrix3<double> turn =
      AngleAxis<double>(is_turned ? random.uniform(0, 3) : 0, Vector::UnitZ())
          .toRotationMatrix();
  for (auto& p : body.vertices) {
    const double up = p.z() + half.z();
    p = turn * p;
    p.z() = up;
  }
  return body;
}

/// A solid body slides on the floor at the height 0: its side faces meet vertices and
/// edges of the floor with their lower borders. Those inside of the floor are flat and
/// stop nobody. Every third floor is turned, so that its coordinates round: it may then
/// cross the body at t = 0. Others are a mesh that FCL's tree holds.
TEST(FCL_APPROACH_SPEED, solidsSlideAtHeightZero) {
  Random random(12);
  int touch_without = 0;
  const int count = manyOf(1000);
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(std::to_string(i));
    const Place place(random);
    const TestMesh floor = makeFloor(4 + i % 5, 1.5),
                   body = makeStandingBody(random, i % 4 != 0);
    const TestMesh from = moved(body, slideOf(random, 0.3));
    const double way = random.uniform(0.1, 0.8);
    const TestMesh to = moved(from, i % 8 ? slideOf(random, way) : Vector(way, 0, 0));
    const bool is_rounded = i % 3 == 0;
    const auto o1 = is_rounded ? place.model(from, to) : makeModel<Model>(from, to);
    const ContinuousQuery query = kQueries[i / 2 % 3];
    const auto ask = [&](double speed) {
      const Request request = requestOf(query, 0, speed);
      if (is_rounded)
        return pairContacts<double>(*o1, *place.model(floor, floor), request);
      if (i % 3 == 1)
        return pairContacts<double>(*makeModel<Model>(floor, floor), *o1, request);
      Result result;
      const auto rigid = makeModel<BVHModel<OBBRSS<double>>>(floor);
      const Transform3<double> rest = Transform3<double>::Identity();
      continuousCollide(o1.get(), rest, rest, rigid.get(), rest, rest, request, result);
      return result;
    };
    const Result result = ask(kSpeed);
    EXPECT_EQ(result.contacts.size(), 0U);
    EXPECT_EQ(result.is_collide, result.initially_crossing);
    touch_without += !ask(0).contacts.empty();
  }
  EXPECT_GE(touch_without, count / 2);
}

/// A body that stands on the floor slides against a wall, or a plate that lies on it. The
/// wall is a part of the floor, or stands on it. It is hit as without a floor and without
/// the option.
TEST(FCL_APPROACH_SPEED, standingBodiesHitAWall) {
  Random random(13);
  for (int i = 0; i < manyOf(600); ++i) {
    SCOPED_TRACE(std::to_string(i));
    // A vertical wall from x = 0.75 up, of columns of the floor, which goes on above.
    const int quads = 8;
    const double height = random.uniform(0.05, 0.4);
    const TestMesh step = makeSheet(quads + 2, quads, [&](double u, double v) {
      const int column = static_cast<int>(std::lround(u * (quads + 2)));
      const double x = column <= 6 ? -1.5 + 0.375 * column : -1.5 + 0.375 * (column - 1);
      return Vector(x, 3 * v - 1.5, column <= 6 ? 0 : height);
    });
    TestMesh body = i % 3 ? makeStandingBody(random, i % 2) : makeFloor(1 + i % 4, 0.2);
    const TestMesh from = moved(body, -0.2, 0, 0),
                   to = moved(from, 1.5, random.uniform(-0.3, 0.3), 0);
    double front = -1;
    for (const auto& p : from.vertices) front = std::max(front, p.x());
    const auto o1 = makeModel<Model>(from, to), o2 = makeModel<Model>(step, step);
    const double toc = (0.75 - front) / 1.5;
    for (const ContinuousQuery query : kQueries) {
      Request request = requestOf(query, 0);
      const Result result = pairContacts<double>(*o1, *o2, request);
      ASSERT_TRUE(result.is_collide);
      request.num_threads = 3;
      expectIdentical(result, pairContacts<double>(*o1, *o2, request));
      if (query == ContinuousQuery::kAny) continue;
      EXPECT_NEAR(result.time_of_contact, toc, 1e-4);
    }
  }
}

/// A plate hits a wall at the height of an edge inside of the wall, with a corner or with
/// its front edge. Each face of the wall alone is only grazed.
TEST(FCL_APPROACH_SPEED, platesHitEdgesInsideOfWalls) {
  Random random(17);
  for (int i = 0; i < manyOf(500); ++i) {
    SCOPED_TRACE(std::to_string(i));
    // The wall is wider than the plate, or not as wide.
    const double width = i % 2 ? 2 : 0.1;
    const TestMesh wall = makeSheet(1 + i % 3, 2, [&](double u, double v) {
      return Vector(1, width * (2 * u - 1), v - 0.5);
    });
    const TestMesh plate = makeFloor(1 + i % 4, 0.4);
    const Matrix3<double> turn =
        AngleAxis<double>(random.uniform(-0.3, 0.3), Vector::UnitZ()).toRotationMatrix();
    TestMesh from = plate;
    for (auto& p : from.vertices) {
      p = turn * p;
      p.z() = 0;
    }
    const TestMesh to = moved(from, 1.5, random.uniform(-0.1, 0.1), 0);
    const auto o1 = makeModel<Model>(from, to), o2 = makeModel<Model>(wall, wall);
    const Result truth = pairContacts<double>(*o1, *o2, requestOf(kQueries[0], 0, 0));
    ASSERT_TRUE(truth.is_collide);
    for (const ContinuousQuery query : kQueries) {
      const Result result = pairContacts<double>(*o1, *o2, requestOf(query, 0));
      ASSERT_TRUE(result.is_collide);
      if (query == ContinuousQuery::kAny) continue;
      EXPECT_NEAR(result.time_of_contact, truth.time_of_contact, 1e-4);
    }
  }
}

/// A spike, or a roof with its edge, falls on a vertex or an edge inside of a flat floor.
TEST(FCL_APPROACH_SPEED, spikesHitFlatParts) {
  Random random(14);
  for (int i = 0; i < manyOf(600); ++i) {
    SCOPED_TRACE(std::to_string(i));
    const TestMesh floor = makeFloor(6, 1.5);
    TestMesh spike = makeBox(Vector(0.1, 0.1, 0.1));
    // Its lower vertices become one point, or two.
    for (auto& p : spike.vertices) {
      p.z() += 0.1;
      if (p.z() < 0.01) p = Vector(i % 2 ? p.x() : 0, 0, 0);
    }
    // A vertex of the floor, or the middle of an edge.
    const double drop = random.uniform(0.01, 0.3), x = i % 4 < 2 ? 0 : 0.25;
    const TestMesh from = moved(spike, x, 0, drop),
                   to = moved(spike,
                              Vector(x, 0, -drop) + slideOf(random, i % 8 < 4 ? 0 : 0.5));
    const auto o1 = makeModel<Model>(from, to), o2 = makeModel<Model>(floor, floor);
    for (const ContinuousQuery query : kQueries) {
      const Result result = pairContacts<double>(*o1, *o2, requestOf(query, 0));
      ASSERT_TRUE(result.is_collide);
      // Any contact may be the one that is found.
      if (query == ContinuousQuery::kAny) continue;
      EXPECT_NEAR(result.time_of_contact, 0.5, 1e-4);
    }
  }
}

/// Bodies whose vertices move at random over a floor whose vertices do, from the height 0
/// or above. No vertex is deeper below the other surface than the speed allows, before a
/// contact. Bodies that keep above the floor have none as a rule.
TEST(FCL_APPROACH_SPEED, depthsAgainstSamples) {
  constexpr int kSamples = rounds(100);
  Random random(15);
  int hits = 0, deep = 0;
  for (int i = 0; i < manyOf(1000); ++i) {
    SCOPED_TRACE(std::to_string(i));
    const int quads = 4;
    const TestMesh floor = makeFloor(quads, 1.5),
                   from = moved(makeStandingBody(random, i % 2),
                                Vector(0, 0, i % 3 ? 0 : random.uniform(0, 0.01)));
    const double across = std::pow(10, random.uniform(-4, -1)), along = i % 5 ? 0.05 : 0,
                 of_floor = i % 4 ? 0 : across;
    const Vector way = slideOf(random, random.uniform(0, 0.6));
    const auto changed = [&](TestMesh mesh, double vertical, double horizontal) {
      for (auto& p : mesh.vertices) {
        const Vector change = random.point(1);
        p += Vector(horizontal * change.x(), horizontal * change.y(),
                    vertical * change.z());
      }
      return mesh;
    };
    const TestMesh to = moved(changed(from, across, along), way),
                   risen = changed(floor, of_floor, 0);
    const Result result =
        pairContacts<double>(*makeModel<Model>(from, to), *makeModel<Model>(floor, risen),
                             requestOf(kQueries[i % 2], 0));
    const double toc = result.is_collide ? result.time_of_contact : 1;
    hits += result.is_collide;
    for (int j = 0; j <= kSamples; ++j) {
      const double t = toc * j / kSamples;
      for (std::size_t v = 0; v < from.vertices.size(); ++v) {
        const Vector p = (1 - t) * from.vertices[v] + t * to.vertices[v];
        for (const Triangle& f : floor.triangles) {
          Vector c[3];
          for (int k = 0; k < 3; ++k)
            c[k] = (1 - t) * floor.vertices[f[k]] + t * risen.vertices[f[k]];
          const Vector n = (c[1] - c[0]).cross(c[2] - c[0]);
          bool is_over = true;
          for (int k = 0; k < 3; ++k) {
            const Vector side = c[(k + 1) % 3] - c[k], at = p - c[k];
            is_over &= (side.x() * at.y() - side.y() * at.x()) * n.z() >= 0;
          }
          if (!is_over) continue;
          const double height = (p - c[0]).dot(n) / n.z();
          deep += height < 0;
          ASSERT_GE(height, -kSpeed * t * 1.01 - 1e-8) << t;
        }
      }
    }
  }
  EXPECT_GE(hits, manyOf(200));
  EXPECT_GE(deep, manyOf(200));
}

/// A body that falls, also sideways, is in contact when it is as near.
TEST(FCL_APPROACH_SPEED, falls) {
  Random random(5);
  for (int i = 0; i < manyOf(500); ++i) {
    SCOPED_TRACE(std::to_string(i));
    const Place place(random);
    const double distance = i % 2 ? kDistance : 0, drop = random.uniform(0.02, 0.1),
                 fall = drop + random.uniform(0.01, 0.3);
    const TestMesh floor = makeFloor(4 + i % 5, 1.5), body = makeBody(random);
    const TestMesh from = moved(body, Vector(0, 0, distance + drop));
    const TestMesh to =
        moved(from, slideOf(random, random.uniform(0, 0.7)) - Vector(0, 0, fall));
    const auto o1 = place.model(from, to), o2 = place.model(floor, floor);
    const Result result =
        pairContacts<double>(*o1, *o2, requestOf(kQueries[i / 2 % 3], distance));
    ASSERT_TRUE(result.is_collide);
    // Any contact of a body that falls flat may be the one that is found.
    if (i / 2 % 3 == 2) continue;
    EXPECT_LE(result.time_of_contact, drop / fall + 1e-12);
    EXPECT_GE(result.time_of_contact, drop / fall - 1e-4);
  }
}

/// A body slides along the floor and hits a step, when it hits the step alone without the
/// option.
TEST(FCL_APPROACH_SPEED, hitsAStep) {
  Random random(6);
  int hits = 0;
  for (int i = 0; i < manyOf(600); ++i) {
    SCOPED_TRACE(std::to_string(i));
    const Place place(random);
    const double distance = i % 2 ? kDistance : 0;
    TestMesh step = makeBox(Vector(0.2, 0.5, 0.06), 2);
    for (auto& p : step.vertices) p += Vector(0.9, 0, 0.03);
    TestMesh scene = makeFloor(6, 1.5);
    append(scene, step);
    const TestMesh body = makeBody(random);
    const TestMesh from = moved(body, Vector(0, 0, i % 2 ? kDistance : 1e-9));
    const TestMesh to = moved(from, Vector(random.uniform(0.5, 1.2), 0, 0));
    const auto o1 = place.model(from, to), o2 = place.model(scene, scene),
               alone = place.model(step, step);
    const Result truth = pairContacts<double>(
                     *o1, *alone, requestOf(ContinuousQuery::kFirst, distance, 0)),
                 result = pairContacts<double>(
                     *o1, *o2, requestOf(ContinuousQuery::kFirst, distance));
    ASSERT_EQ(result.is_collide, truth.is_collide);
    hits += result.is_collide;
    EXPECT_NEAR(result.time_of_contact, truth.time_of_contact, 1e-4);
  }
  EXPECT_GE(hits, manyOf(300));
}

/// A body, or a plate that touches the floor, slides from a part of the floor that is at
/// rest to one that rises. It is in contact before it is nearer than the option allows.
TEST(FCL_APPROACH_SPEED, isPressed) {
  Random random(7);
  for (int i = 0; i < manyOf(400); ++i) {
    SCOPED_TRACE(std::to_string(i));
    const Place place(random);
    const double distance = i % 2 ? 0 : kDistance, rise = random.uniform(0.02, 0.4);
    const TestMesh floor = makeFloor(6, 1.5),
                   body = i % 2 ? makeFloor(1 + i % 3, 0.2) : makeBody(random);
    TestMesh risen = floor;
    for (auto& p : risen.vertices) p.z() += p.x() > 0.4 ? rise * (p.x() - 0.4) : 0;
    const TestMesh from = moved(body, Vector(-0.5, 0, distance));
    const TestMesh to = moved(from, Vector(random.uniform(1, 1.5), 0, 0));
    // The height above the floor of a vertex of the body at x > 0.5, where the floor is
    // z = rise (x - 0.4) t. Its bottom comes within the distance less the speed.
    double latest = 1;
    for (std::size_t v = 0; v < body.vertices.size(); ++v)
      for (int j = 0; j <= 1000; ++j) {
        const double t = j / 1000.;
        const Vector p = (1 - t) * from.vertices[v] + t * to.vertices[v];
        if (p.x() > 0.51 && p.z() - rise * (p.x() - 0.4) * t < distance - kSpeed)
          latest = std::min(latest, t);
      }
    // Rounded coordinates of a plate would cross the floor at t = 0.
    const auto o1 = i % 2 ? makeModel<Model>(from, to) : place.model(from, to),
               o2 = i % 2 ? makeModel<Model>(floor, risen) : place.model(floor, risen);
    const Result result =
        pairContacts<double>(*o1, *o2, requestOf(kQueries[i / 2 % 3], distance));
    EXPECT_TRUE(result.is_collide || latest == 1);
    EXPECT_GT(result.time_of_contact, 0.05);
    // Any contact may be the one that is found.
    if (i / 2 % 3 != 2) {
      EXPECT_LE(result.time_of_contact, latest);
    }
  }
}

/// The same in one mesh, for points and edges without triangles, and with other objects.
TEST(FCL_APPROACH_SPEED, slidesInOneMesh) {
  Random random(8);
  for (int i = 0; i < manyOf(60); ++i) {
    SCOPED_TRACE(std::to_string(i));
    const Place place(random);
    const Vector up(0, 0, kDistance), way = slideOf(random, 0.6);
    TestMesh from = moved(makeBody(random), up), to = moved(from, way);
    const TestMesh floor = makeFloor(6, 1.5);
    append(from, floor);
    append(to, floor);
    Request request = requestOf(kQueries[i % 3], kDistance);
    // Vertices of a side of the body are within the distance of each other.
    request.ignore_initially_closer = true;
    EXPECT_FALSE(selfContacts<double>(*place.model(from, to), request).is_collide);
    for (std::size_t v = 0; v < to.vertices.size() - floor.vertices.size(); ++v)
      to.vertices[v].z() -= 0.1;
    EXPECT_TRUE(selfContacts<double>(*place.model(from, to), request).is_collide);
  }
}

TEST(FCL_APPROACH_SPEED, solidsSlideInOneMesh) {
  Random random(18);
  int touch_without = 0;
  for (int i = 0; i < manyOf(60); ++i) {
    SCOPED_TRACE(std::to_string(i));
    TestMesh from = makeStandingBody(random, i % 2),
             to = moved(from, slideOf(random, 0.6));
    const TestMesh floor = makeFloor(6, 1.5);
    append(from, floor);
    append(to, floor);
    const auto model = makeModel<Model>(from, to);
    const Request request = requestOf(kQueries[i % 3], 0);
    EXPECT_FALSE(selfContacts<double>(*model, request).is_collide);
    touch_without +=
        selfContacts<double>(*model, requestOf(kQueries[i % 3], 0, 0)).is_collide;
    for (std::size_t v = 0; v < to.vertices.size() - floor.vertices.size(); ++v)
      to.vertices[v].z() -= 0.1;
    EXPECT_TRUE(selfContacts<double>(*makeModel<Model>(from, to), request).is_collide);
  }
  EXPECT_GE(touch_without, manyOf(50));
}

TEST(FCL_APPROACH_SPEED, freeFeatures) {
  Random random(9);
  for (int i = 0; i < manyOf(100); ++i) {
    SCOPED_TRACE(std::to_string(i));
    const double distance = i % 2 ? kDistance : 0;
    const auto floor = makeModel<Model>(makeFloor(6, 1.5));
    const Vector way = slideOf(random, 0.6);
    std::vector<Vector> from, to;
    std::vector<FreeEdge> edges;
    std::vector<std::size_t> points;
    for (std::size_t k = 0; k < 8; ++k) {
      from.push_back(Vector(random.uniform(-.5, .5), random.uniform(-.5, .5), distance));
      to.push_back(from.back() + way);
      if (k % 2) edges.push_back({k - 1, k});
      points.push_back(k);
    }
    const auto wires = [&](double fall) {
      auto model = std::make_shared<Model>();
      model->beginModel();
      model->addSubModel(from, {}, edges, points);
      model->endModel();
      std::vector<Vector> end = to;
      for (Vector& p : end) p.z() -= fall;
      model->beginUpdateModel();
      model->updateSubModel(end);
      model->endUpdateModel();
      return model;
    };
    const Request request = requestOf(kQueries[i / 2 % 3], distance);
    EXPECT_FALSE(pairContacts<double>(*wires(0), *floor, request).is_collide);
    EXPECT_TRUE(pairContacts<double>(*wires(0.05), *floor, request).is_collide);
  }
}

/// What approaches is found as without the option, to the bit, by each query and by any
/// number of threads.
TEST(FCL_APPROACH_SPEED, contactsThatApproach) {
  Random random(10);
  std::size_t contacts = 0;
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(std::to_string(i));
    const MovingMesh mesh = crumpledSheet(random, 5 + i % 4, 0.2);
    const auto model = makeModel<Model>(TestMesh{mesh.t0, mesh.triangles},
                                        TestMesh{mesh.t1, mesh.triangles});
    for (const ContinuousQuery query : kQueries) {
      const Result off = selfContacts<double>(*model, requestOf(query, 0, 0)),
                   on = selfContacts<double>(*model, requestOf(query, 0, 1e-9));
      expectIdentical(off, on);
      contacts += off.contacts.size();
      for (const double distance : {0., 0.03}) {
        Request request = requestOf(query, distance, 0.1);
        const Result one = selfContacts<double>(*model, request);
        request.num_threads = 3;
        expectIdentical(one, selfContacts<double>(*model, request));
      }
    }
  }
  EXPECT_GE(contacts, 1000U);
}

/// All contacts of a query begin with those of the first one, and any is one of them.
TEST(FCL_APPROACH_SPEED, queriesAgree) {
  Random random(11);
  for (int i = 0; i < manyOf(200); ++i) {
    SCOPED_TRACE(std::to_string(i));
    const MovingMesh a = crumpledSheet(random, 4, 0.3), b = crumpledSheet(random, 5, 0.3);
    const auto o1 = makeModel<Model>(TestMesh{a.t0, a.triangles},
                                     moved(TestMesh{a.t1, a.triangles}, 0, 0, -0.3)),
               o2 = makeModel<Model>(moved(TestMesh{b.t0, b.triangles}, 0, 0, -0.2),
                                     moved(TestMesh{b.t1, b.triangles}, 0, 0, -0.2));
    const double distance = i % 2 ? 0.02 : 0, speed = i % 3 ? 0.3 : 0.05;
    const auto ask = [&](ContinuousQuery query) {
      return pairContacts<double>(*o1, *o2, requestOf(query, distance, speed));
    };
    const Result all = ask(ContinuousQuery::kAll), first = ask(ContinuousQuery::kFirst),
                 any = ask(ContinuousQuery::kAny);
    EXPECT_EQ(all.contacts.empty(), first.contacts.empty());
    EXPECT_EQ(all.contacts.empty() && !all.initially_crossing, !any.is_collide);
    if (all.initially_crossing) continue;
    EXPECT_EQ(all.time_of_contact, first.time_of_contact);
    const auto names = namesOf(all.contacts);
    for (const auto& contact : first.contacts)
      EXPECT_TRUE(std::binary_search(names.begin(), names.end(), nameOf(contact)));
    for (const auto& contact : any.contacts)
      EXPECT_TRUE(std::binary_search(names.begin(), names.end(), nameOf(contact)));
  }
}

TEST(FCL_APPROACH_SPEED, errors) {
  const auto floor = makeModel<Model>(makeFloor(2, 1)),
             body = makeModel<Model>(moved(makeFloor(2, 1), 0, 0, 1));
  const Transform3<double> rest = Transform3<double>::Identity();
  Transform3<double> turned = rest;
  turned.rotate(AngleAxis<double>(1, Vector::UnitX()));
  Result result;
  const auto textOf = [&](const CollisionGeometry<double>& o,
                          const Transform3<double>& end, double speed) -> std::string {
    const Request request = requestOf(ContinuousQuery::kAll, 0, speed);
    try {
      continuousCollide(&o, rest, end, floor.get(), rest, rest, request, result);
    } catch (const Exception& error) {
      return error.what();
    }
    return "";
  };
  const Sphere<double> ball(0.1);
  EXPECT_EQ(textOf(*body, rest, kSpeed), "");
  EXPECT_EQ(textOf(*body, turned, 0), "");
  for (const double wrong : {-1., std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_NE(textOf(*body, rest, wrong).find("request.min_approach_speed is negative"),
              std::string::npos);
  EXPECT_NE(textOf(*body, turned, kSpeed).find("One of these two turns"),
            std::string::npos);
  EXPECT_NE(textOf(ball, rest, kSpeed).find("a shape or an octree"), std::string::npos);
}

}  // namespace
}  // namespace test
}  // namespace fcl
