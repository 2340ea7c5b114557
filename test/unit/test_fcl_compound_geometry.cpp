// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies of several geometries, against queries of each part by itself, whose motions are
// composed here. FCL_CCD_TEST_COMPOUNDS sets the number of random pairs:
//   FCL_CCD_TEST_COMPOUNDS=3000 build/release/test/unit/test_fcl_compound_geometry
#include "fcl/geometry/compound_geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "fcl/broadphase/collision_robot.h"
#include "fcl/common/exception.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/octree/octree.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/capsule.h"
#include "fcl/geometry/shape/cylinder.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/narrowphase/collision.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "fcl/narrowphase/continuous_distance.h"
#include "fcl/narrowphase/distance.h"
#include "moving_objects.h"
#include "paths/offset_path.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Vector = Vector3<double>;
using Tf = Transform3<double>;
using Geometry = std::shared_ptr<CollisionGeometry<double>>;
using Motion = std::shared_ptr<MotionBase<double>>;
using Compound = CompoundGeometry<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Rigid = BVHModel<OBBRSS<double>>;
using Deformable = DeformableBVHModel<KDOP<double, 16>>;

int numPairs() {
  const char* wanted = std::getenv("FCL_CCD_TEST_COMPOUNDS");
  return wanted ? std::atoi(wanted) : 200;
}

Tf at(double x, double y, double z) { return Tf(Translation3<double>(x, y, z)); }

Geometry makeOctree() {
  const auto map = std::make_shared<octomap::OcTree>(.1);
  for (int i = 0; i < 4; ++i)
    map->updateNode(octomap::point3d(.1f * float(i), .05f, -.05f), true);
  return std::make_shared<OcTree<double>>(map);
}

std::vector<Geometry> makeParts() {
  const TestMesh ball = makeIcosphere(1, .2), brick = makeBox({.3, .1, .05}, 2);
  return {makeModel<Rigid>(ball),
          makeModel<Deformable>(brick),
          std::make_shared<Box<double>>(.3, .2, .4),
          std::make_shared<Sphere<double>>(.2),
          std::make_shared<Capsule<double>>(.1, .4),
          std::make_shared<Cylinder<double>>(.2, .3),
          makeOctree()};
}

Tf randomPose(Random& random, double size) {
  Tf tf = Tf::Identity();
  tf.linear() = randomRotation(random);
  tf.translation() = random.point(size);
  return tf;
}

/// The motion of a frame on a body, by the product of the poses.
class Carried : public MotionBase<double>, public BoundedMotion {
 public:
  Carried(const BoundedMotion& body, const Tf& offset) : body_(body), offset_(offset) {}
  Placement placementAt(double t) const override { return times(body_.placementAt(t)); }
  Placement rateAt(double t) const override { return times(body_.rateAt(t)); }
  double accelerationBound(const double (&center)[3], double radius, double t0,
                           double t1) const override {
    const Vector x = offset_ * Vector(center[0], center[1], center[2]);
    return body_.accelerationBound({x[0], x[1], x[2]}, radius + 1e-12, t0, t1);
  }
  double angularSpeedBound(double t0, double t1) const override {
    return body_.angularSpeedBound(t0, t1);
  }
  Rounding moreRounding() const override { return {1e-14, 1e-14, 1e-14, 1e-14}; }

  bool integrate(double) const override { return true; }
  void getCurrentTransform(Tf& tf) const override { tf = Tf::Identity(); }
  double computeMotionBound(const BVMotionBoundVisitor<double>&) const override {
    return 0;
  }
  double computeMotionBound(const TriangleMotionBoundVisitor<double>&) const override {
    return 0;
  }
  void getTaylorModel(TMatrix3<double>&, TVector3<double>&) const override {}

 private:
  Placement times(const Placement& body) const {
    Placement out;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        out.rotation[3 * i + k] = 0;
        for (int j = 0; j < 3; ++j)
          out.rotation[3 * i + k] += body.rotation[3 * i + j] * offset_.linear()(j, k);
      }
      out.translation[i] = body.translation[i];
      for (int j = 0; j < 3; ++j)
        out.translation[i] += body.rotation[3 * i + j] * offset_.translation()[j];
    }
    return out;
  }

  const BoundedMotion& body_;
  Tf offset_;
};

/// A motion of a body, and those of frames on it.
struct BodyMotion {
  enum class Kind { kTranslation, kTurn, kScrew, kBounded, kKinds };
  Kind kind;
  Tf beg, end;
  Vector reference;
  Motion motion;

  Motion of(const Tf& offset) const {
    const Tf from = beg * offset, to = end * offset;
    switch (kind) {
      case Kind::kTranslation:
        return std::make_shared<TranslationMotion<double>>(from, to);
      case Kind::kTurn:
        return std::make_shared<InterpMotion<double>>(from.linear(), from.translation(),
                                                      to.linear(), to.translation(),
                                                      offset.inverse() * reference);
      case Kind::kScrew:
        return std::make_shared<ScrewMotion<double>>(from, to);
      default:
        return std::make_shared<Carried>(dynamic_cast<const BoundedMotion&>(*motion),
                                         offset);
    }
  }
};

BodyMotion randomMotion(Random& random, BodyMotion::Kind kind) {
  BodyMotion out{kind, randomPose(random, .9), {}, random.point(.5), nullptr};
  out.end = out.beg;
  out.end.pretranslate(random.point(1));
  if (kind == BodyMotion::Kind::kBounded) {
    out.motion = std::make_shared<BoundedThrow>(random.point(.9), random.point(1),
                                                random.point(2));
    return out;
  }
  if (kind != BodyMotion::Kind::kTranslation)
    out.end.linear() = AngleAxis<double>(random.uniform(.1, 2.5), randomDirection(random))
                           .toRotationMatrix() *
                       out.beg.linear();
  out.motion = out.of(Tf::Identity());
  return out;
}

struct Body {
  std::vector<Geometry> parts;
  std::vector<Tf> offsets;
  std::shared_ptr<Compound> compound;
  BodyMotion motion;

  void add(const Geometry& geometry, const Tf& offset) {
    parts.push_back(geometry);
    offsets.push_back(offset);
    compound->addPart(geometry, offset);
  }
};

Body randomBody(Random& random, BodyMotion::Kind kind) {
  static const std::vector<Geometry> all = makeParts();
  Body body{{}, {}, std::make_shared<Compound>(), randomMotion(random, kind)};
  for (std::size_t n = 1 + random.index(4); n > 0; --n)
    body.add(all[random.index(all.size())], randomPose(random, .5));
  return body;
}

struct PartContacts {
  double first{1};
  /// Of pairs of parts: their times.
  std::map<std::pair<int, int>, double> pairs;
  std::vector<ContinuousContact<double>> contacts;
};

/// Each part by itself.
PartContacts separateQueries(const Body& a, const Body& b, const Request& request) {
  PartContacts out;
  for (std::size_t i = 0; i < a.parts.size(); ++i)
    for (std::size_t k = 0; k < b.parts.size(); ++k) {
      Result result;
      continuousCollide(a.parts[i].get(), a.motion.of(a.offsets[i]).get(),
                        b.parts[k].get(), b.motion.of(b.offsets[k]).get(), request,
                        result);
      if (!result.is_collide) continue;
      out.first = std::min(out.first, result.time_of_contact);
      out.pairs[{int(i), int(k)}] = result.time_of_contact;
      out.contacts.insert(out.contacts.end(), result.contacts.begin(),
                          result.contacts.end());
    }
  return out;
}

double collide(const Body& a, const Body& b, const Request& request, Result& result) {
  return continuousCollide(a.compound.get(), a.motion.motion.get(), b.compound.get(),
                           b.motion.motion.get(), request, result);
}

/// Pairs that only graze may be in contact for one query, and not for the other.
constexpr double kGraze = 1e-9;

TEST(CompoundGeometry, AnswersAsItsPartsDo) {
  Random random(3);
  int num_contacts = 0, num_free = 0;
  for (int n = 0; n < numPairs(); ++n) {
    const auto kind = [&] {
      return BodyMotion::Kind(random.index(std::size_t(BodyMotion::Kind::kKinds)));
    };
    const Body a = randomBody(random, kind()), b = randomBody(random, kind());
    Request request;
    const PartContacts parts = separateQueries(a, b, request);
    Result all, first, any;
    collide(a, b, request, all);
    request.query = ContinuousQuery::kFirst;
    collide(a, b, request, first);
    request.query = ContinuousQuery::kAny;
    collide(a, b, request, any);
    ContinuousCollisionResult<double> plain;
    continuousCollide(a.compound.get(), a.motion.motion.get(), b.compound.get(),
                      b.motion.motion.get(), ContinuousCollisionRequest<double>(), plain);
    SCOPED_TRACE("pair " + std::to_string(n));
    const bool touches = !parts.pairs.empty();
    ++(touches ? num_contacts : num_free);
    ASSERT_EQ(all.is_collide, touches);
    ASSERT_EQ(first.is_collide, touches);
    ASSERT_EQ(any.is_collide, touches);
    ASSERT_EQ(plain.is_collide, touches);
    const double toc_err = request.toc_err + kGraze;
    ASSERT_NEAR(all.time_of_contact, parts.first, toc_err);
    ASSERT_NEAR(first.time_of_contact, parts.first, toc_err);
    ASSERT_NEAR(plain.time_of_contact, parts.first, toc_err);
    ASSERT_GE(any.time_of_contact, parts.first - toc_err);
    std::map<std::pair<int, int>, double> pairs;
    for (const auto& contact : all.contacts)
      pairs.insert({{contact.part1, contact.part2}, contact.toc_lo});
    for (const auto& pair : parts.pairs) {
      const auto found = pairs.find(pair.first);
      // A crossing at t = 0 has no contact in the list.
      if (found == pairs.end())
        ASSERT_TRUE(all.initially_crossing);
      else
        ASSERT_NEAR(found->second, pair.second, pair.second == 0 ? 1 : toc_err);
    }
    for (const auto& pair : pairs) ASSERT_EQ(parts.pairs.count(pair.first), 1u);
    for (const auto& contact : all.contacts) {
      ASSERT_EQ(contact.o1, a.parts[std::size_t(contact.part1)].get());
      ASSERT_EQ(contact.o2, b.parts[std::size_t(contact.part2)].get());
    }
    ASSERT_TRUE(
        std::is_sorted(all.contacts.begin(), all.contacts.end(),
                       [](const auto& x, const auto& y) { return x.toc_lo < y.toc_lo; }));
  }
  EXPECT_GT(num_contacts, numPairs() / 20);
  EXPECT_GT(num_free, numPairs() / 8);
}

Vector dyadic(Random& random, double size) {
  Vector p = random.point(size);
  for (int k = 0; k < 3; ++k) p[k] = std::ldexp(std::round(std::ldexp(p[k], 10)), -10);
  return p;
}

/// Products of pure translations by few digits are exact, so the answer is to the bit
/// that of meshes and shapes by themselves.
TEST(CompoundGeometry, ExactPosesGiveTheSameBits) {
  Random random(5);
  const std::vector<Geometry> all = makeParts();
  std::size_t num_contacts = 0;
  for (int n = 0; n < numPairs(); ++n) {
    Body bodies[2];
    for (Body& body : bodies) {
      body.compound = std::make_shared<Compound>();
      body.motion = {BodyMotion::Kind::kTranslation, Tf::Identity(), Tf::Identity(),
                     Vector::Zero(), nullptr};
      body.motion.beg.translation() = dyadic(random, .8);
      body.motion.end.translation() = dyadic(random, .8);
      body.motion.motion = body.motion.of(Tf::Identity());
      for (std::size_t k = 1 + random.index(3); k > 0; --k) {
        Tf offset = Tf::Identity();
        offset.translation() = dyadic(random, .5);
        body.add(all[random.index(all.size())], offset);
      }
    }
    const Request request;
    const PartContacts parts = separateQueries(bodies[0], bodies[1], request);
    Result result;
    collide(bodies[0], bodies[1], request, result);
    ASSERT_EQ(result.is_collide, !parts.pairs.empty());
    ASSERT_EQ(result.time_of_contact, parts.first);
    ASSERT_EQ(result.contacts.size(), parts.contacts.size());
    const auto values = [](const std::vector<ContinuousContact<double>>& contacts) {
      std::vector<std::tuple<double, double, std::intptr_t, std::intptr_t,
                             std::array<int, 5>, double, double>>
          out;
      for (const auto& c : contacts)
        out.emplace_back(c.toc_lo, c.toc_hi, c.b1, c.b2, c.vertices, c.pos[0],
                         c.normal[2]);
      std::sort(out.begin(), out.end());
      return out;
    };
    ASSERT_EQ(values(result.contacts), values(parts.contacts));
    num_contacts += result.contacts.size();
  }
  EXPECT_GT(num_contacts, 100u);
}

TEST(CompoundGeometry, DistanceIsTheLeastOfItsParts) {
  Random random(17);
  int num_touching = 0, num_apart = 0;
  for (int n = 0; n < numPairs() / 4; ++n) {
    const auto kind = [&] {
      return BodyMotion::Kind(random.index(std::size_t(BodyMotion::Kind::kKinds)));
    };
    const Body a = randomBody(random, kind()), b = randomBody(random, kind());
    const ContinuousDistanceRequest<double> request;
    ContinuousDistanceResult<double> result, one;
    double lo = std::numeric_limits<double>::infinity(), hi = lo;
    bool touches = false;
    for (std::size_t i = 0; i < a.parts.size(); ++i)
      for (std::size_t k = 0; k < b.parts.size(); ++k) {
        continuousDistance(a.parts[i].get(), a.motion.of(a.offsets[i]).get(),
                           b.parts[k].get(), b.motion.of(b.offsets[k]).get(), request,
                           one);
        lo = std::min(lo, one.distance_lo);
        hi = std::min(hi, one.distance_hi);
        touches |= one.is_collide;
      }
    continuousDistance(a.compound.get(), a.motion.motion.get(), b.compound.get(),
                       b.motion.motion.get(), request, result);
    ++(touches ? num_touching : num_apart);
    ASSERT_EQ(result.is_collide, touches);
    ASSERT_FALSE(result.is_cut_off);
    // Both brackets have the least distance.
    ASSERT_LE(result.distance_lo, hi + kGraze);
    ASSERT_GE(result.distance_hi, lo - kGraze);
    ASSERT_LE(result.distance_hi - result.distance_lo,
              request.rel_err * result.distance_hi + kGraze);
    ASSERT_LT(result.part1, int(a.parts.size()));
    ASSERT_GE(result.part2, 0);
    if (touches) continue;
    ContinuousDistanceRequest<double> near = request;
    near.max_distance = .5 * result.distance_lo;
    continuousDistance(a.compound.get(), a.motion.motion.get(), b.compound.get(),
                       b.motion.motion.get(), near, one);
    ASSERT_TRUE(one.is_cut_off);
    ASSERT_EQ(one.distance_lo, near.max_distance);
  }
  EXPECT_GT(num_touching, 0);
  EXPECT_GT(num_apart, 0);
}

/// The path of a frame that is fixed to a body, and its bounds.
TEST(CompoundGeometry, PathsOfPartsAreThoseOfTheBody) {
  using namespace detail::deformable;
  Random random(21);
  for (int n = 0; n < 90; ++n) {
    ReferenceMotion motion;
    motion.kind = ReferenceMotion::Kind(n % 3);
    motion.beginning = motion.end = randomPose(random, 2);
    motion.end.pretranslate(random.point(1));
    motion.turn(randomDirection(random), random.uniform(.01, 3));
    motion.reference = random.point(1);
    for (int i = 0; i < 4; ++i) {
      motion.translation_points[i] = random.point(2);
      motion.rotation_points[i] = random.point(2);
    }
    const MotionPath body = motion.path();
    const Tf offset = randomPose(random, 3);
    const OffsetPath fixed(body, toPose(offset));
    const MotionPath path =
        body.turn() ? body.placed(toPose(offset)) : MotionPath::bounded(fixed);
    const Vector x = random.point(1);
    const auto ofBody = [&](double t) -> RealVector {
      return motion.at(Real(t)) * (offset * x);
    };
    for (int i = 0; i < 20; ++i) {
      const double t0 = random.uniform(0, .9), dt = random.uniform(.01, .1),
                   t = t0 + .5 * dt;
      const Vec at = posed(path.pose(t), {x[0], x[1], x[2]});
      const RealVector expected = ofBody(t);
      ASSERT_LE((RealVector(at.x, at.y, at.z) - expected).norm(),
                path.positionError(x.norm()) + body.positionError(4) + 1e-15);
      // The deviation from the straight line between both ends.
      const Real bend = (expected - (ofBody(t0) + ofBody(t0 + dt)) / 2).norm();
      ASSERT_LE(
          bend,
          path.acceleration(t0, t0 + dt).of({x[0], x[1], x[2]}, 0) * dt * dt / 8 + 1e-14);
      ASSERT_LE((ofBody(t0 + dt) - ofBody(t0)).norm(), path.speed(x.norm()) * dt + 1e-14);
    }
  }
}

/// A long row of balls that turns: the end hits at an angle that is known.
TEST(CompoundGeometry, TurnsAboutItsOrigin) {
  Compound rod;
  for (int i = 0; i < 20; ++i)
    rod.addPart(std::make_shared<Sphere<double>>(.05), at(.1 * i, 0, 0));
  const Sphere<double> ball(.05);
  Tf quarter = Tf::Identity();
  quarter.linear() = AngleAxis<double>(M_PI / 2, Vector::UnitZ()).toRotationMatrix();
  const Tf rest = at(1.9 * std::cos(M_PI / 4), 1.9 * std::sin(M_PI / 4), 0);
  for (const CCDMotionType type : {CCDM_LINEAR, CCDM_SCREW}) {
    Request request;
    request.query = ContinuousQuery::kFirst;
    request.ccd_motion_type = type;
    Result result;
    continuousCollide(&rod, Tf::Identity(), quarter, &ball, rest, rest, request, result);
    ASSERT_TRUE(result.is_collide);
    // The last sphere is nearer than 0.1 when the angle between both is less than this.
    const double angle = 2 * std::asin(.05 / 1.9),
                 expected = (M_PI / 4 - angle) / (M_PI / 2);
    EXPECT_LE(result.time_of_contact, expected);
    EXPECT_GE(result.time_of_contact, expected - request.toc_err - kGraze);
    EXPECT_EQ(result.contacts.at(0).part1, 19);
    EXPECT_EQ(result.contacts.at(0).part2, -1);
  }
}

TEST(CompoundGeometry, FloatAnswersAsDouble) {
  CompoundGeometry<float> pair;
  pair.addPart(std::make_shared<Box<float>>(1.f, 1.f, 1.f), at(-1, 0, 0));
  pair.addPart(std::make_shared<Sphere<float>>(.5f), at(1, 0, 0));
  const Sphere<float> ball(.5f);
  const Transform3<float> rest = Transform3<float>::Identity();
  Transform3<float> from = rest, to = rest;
  from.translation() = Vector3<float>(1, 0, 5);
  to.translation() = Vector3<float>(1, 0, 0);
  ContinuousContactRequest<float> request;
  ContinuousContactResult<float> result;
  continuousCollide(&pair, rest, rest, &ball, from, to, request, result);
  ASSERT_TRUE(result.is_collide);
  EXPECT_NEAR(result.time_of_contact, .8, 2e-4);
  EXPECT_EQ(result.contacts.at(0).part1, 1);
}

/// Limits and filters act on the object.
TEST(CompoundGeometry, LimitsAreThoseOfAPair) {
  Compound pair;
  pair.addPart(makeModel<Rigid>(makeIcosphere(1, .2)), at(0, 0, 0));
  pair.addPart(makeModel<Rigid>(makeIcosphere(1, .2)), at(1, 0, 0));
  const auto sheet = makeModel<Rigid>(makeBox({2, 2, .1}, 4));
  const Tf rest = Tf::Identity(), from = at(0, .1, 1), to = at(0, .1, 0);
  Request request;
  Result all, some, none;
  continuousCollide(&pair, from, to, sheet.get(), rest, rest, request, all);
  ASSERT_GT(all.contacts.size(), 4u);
  EXPECT_FALSE(all.contacts_cut);
  request.num_max_contacts = 3;
  continuousCollide(&pair, from, to, sheet.get(), rest, rest, request, some);
  ASSERT_EQ(some.contacts.size(), 3u);
  EXPECT_TRUE(some.contacts_cut);
  EXPECT_NEAR(some.contacts[2].toc_lo, all.contacts[2].toc_lo, request.toc_err);
  request.filter1.group = 2;
  request.filter2.mask = 1;
  continuousCollide(&pair, from, to, sheet.get(), rest, rest, request, none);
  EXPECT_FALSE(none.is_collide);
  request = Request();
  request.t_max = .5;
  continuousCollide(&pair, from, to, sheet.get(), rest, rest, request, none);
  EXPECT_FALSE(none.is_collide);
}

TEST(CompoundGeometry, RefusesWhatIsNoPart) {
  Compound compound;
  const auto ball = std::make_shared<Sphere<double>>(1);
  const auto add = [&](const Geometry& geometry, const Tf& offset) {
    return errorOf([&] { compound.addPart(geometry, offset); });
  };
  const Tf here = Tf::Identity();
  expectMessage(add(nullptr, here), "part 0 of a CompoundGeometry: the geometry is null");
  Tf bad = here;
  bad.translation()[1] = std::numeric_limits<double>::quiet_NaN();
  expectMessage(add(ball, bad), "part 0 of a CompoundGeometry: its offset");
  bad = here;
  bad.linear() *= 2;
  expectMessage(add(ball, bad), "its offset scales");
  expectMessage(add(std::make_shared<Compound>(), here), "is a compound too");
  const TestMesh mesh = makeIcosphere(1, .2);
  expectMessage(add(makeModel<Deformable>(mesh, moved(mesh, 1, 0, 0)), here),
                "is a mesh that deforms");
  expectMessage(add(std::make_shared<Rigid>(), here), "part 0 of a CompoundGeometry");
  EXPECT_EQ(compound.numParts(), 0);
  EXPECT_EQ(compound.addPart(ball), 0);
  EXPECT_EQ(compound.addPart(ball, at(1, 2, 3)), 1);
  EXPECT_EQ(compound.part(1), ball);
  EXPECT_EQ(compound.offset(1).translation[2], 3);
  expectMessage(errorOf([&] { compound.part(2); }), "there is no part 2");
  EXPECT_EQ(Compound(compound).numParts(), 2);
}

TEST(CompoundGeometry, QueriesNameTheObjectAndThePart) {
  const Tf here = Tf::Identity();
  const auto ball = std::make_shared<Sphere<double>>(1);
  const Sphere<double> other(1);
  const auto ask = [&](const Compound& compound, const Request& request) {
    return errorOf([&] {
      Result result;
      continuousCollide(&compound, here, here, &other, here, here, request, result);
    });
  };
  expectMessage(ask(Compound(), Request()), "o1 is a compound without parts");
  Compound pair;
  pair.addPart(ball);
  const TestMesh mesh = makeIcosphere(1, .2);
  const auto model = makeModel<Deformable>(mesh);
  pair.addPart(model);
  Request request;
  request.filter1.triangle_groups = {1, 2};
  expectMessage(ask(pair, request), "request.filter1 has groups of triangles");
  request = Request();
  request.min_approach_speed = 1e-3;
  expectMessage(ask(pair, request), "One of these two is a compound: give a mesh");
  ball->radius = -1;
  expectMessage(ask(pair, Request()), "o1 is part 0 of a compound: ");
  ball->radius = 1;
  update(*model, moved(mesh, 1, 0, 0));
  expectMessage(ask(pair, Request()), "part 1 of a CompoundGeometry, o1, is a mesh that");
  expectMessage(errorOf([&] { pair.update(); }), "part 1 of a CompoundGeometry");
  expectMessage(errorOf([&] {
                  continuousCandidates(
                      &pair, here, here, ball.get(), here, here,
                      [](const ContinuousCandidate*, std::size_t) { return true; });
                }),
                "o1 is not a triangle mesh but a compound");
  expectMessage(errorOf([&] {
                  Result result;
                  continuousSelfCollide(&pair, Request(), result);
                }),
                "o is not a triangle mesh but a compound");
  const Throw thrown(Vector::Zero(), Vector::UnitX(), Vector::Zero());
  expectMessage(errorOf([&] {
                  Result result;
                  continuousCollide(&pair, &thrown, ball.get(), &thrown, Request(),
                                    result);
                }),
                "FCL has no compounds");
  Compound single;
  single.addPart(ball);
  Tf bad = here;
  bad.linear() *= 2;
  expectMessage(errorOf([&] {
                  Result result;
                  continuousCollide(&single, bad, bad, ball.get(), here, here, Request(),
                                    result);
                }),
                "o1, a compound: a transform scales");
}

/// FCL's own functions know no compound, but its managers see its box.
TEST(CompoundGeometry, FclSeesABoxOnly) {
  const auto pair = std::make_shared<Compound>();
  pair->addPart(std::make_shared<Sphere<double>>(1), at(-2, 0, 0));
  pair->addPart(std::make_shared<Box<double>>(2, 2, 4), at(2, 0, 1));
  CollisionObject<double> object(pair, at(10, 0, 0)),
      ball(std::make_shared<Sphere<double>>(1), at(8, 0, 0));
  const Vector lower(7, -1, -1), upper(13, 1, 3);
  // Boxes of shapes are wider by some hundred units in the last place.
  EXPECT_LT((object.getAABB().min_ - lower).norm(), 1e-10);
  EXPECT_LT((object.getAABB().max_ - upper).norm(), 1e-10);
  EXPECT_TRUE((object.getAABB().min_.array() <= lower.array()).all());
  testing::internal::CaptureStderr();
  CollisionResult<double> result;
  EXPECT_EQ(fcl::collide(&object, &ball, CollisionRequest<double>(), result), 0u);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("not supported"),
            std::string::npos);
  testing::internal::CaptureStderr();
  DistanceResult<double> distance;
  fcl::distance(&ball, &object, DistanceRequest<double>(), distance);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("not supported"),
            std::string::npos);
  const auto swung = makeObject(pair, translation({0, 0, 0}, {0, 10, 0}));
  const SweptCollisionObject<double> swept(swung.get());
  EXPECT_TRUE(swept.getAABB().contain(Vector(-3, -1, -1)));
  EXPECT_TRUE(swept.getAABB().contain(Vector(3, 11, 3)));
  EXPECT_LT(swept.getAABB().height(), 12.1);
  // A plane has no end.
  pair->addPart(std::make_shared<Plane<double>>(Vector::UnitZ(), 0));
  object.computeAABB();
  EXPECT_GT(object.getAABB().max_[0], 1e300);
}

TEST(CompoundGeometry, ManagerHasOneBoxForIt) {
  Random random(9);
  for (int n = 0; n < 20; ++n) {
    std::vector<Body> bodies;
    std::vector<std::unique_ptr<ContinuousCollisionObject<double>>> objects;
    ContinuousCollisionManager<double> manager;
    for (int i = 0; i < 6; ++i) {
      bodies.push_back(randomBody(random, BodyMotion::Kind(i % 4)));
      objects.push_back(makeObject(bodies[i].compound, bodies[i].motion.motion));
      manager.registerObject(objects[i].get());
    }
    ContinuousManagerResult<double> result;
    manager.collide(Request(), result);
    std::size_t num_pairs = 0;
    for (int i = 0; i < 6; ++i)
      for (int k = i + 1; k < 6; ++k) {
        Result own;
        if (collide(bodies[i], bodies[k], Request(), own); own.is_collide) ++num_pairs;
      }
    EXPECT_EQ(result.pairs.size(), num_pairs);
    EXPECT_LE(result.num_box_pairs, 15u);
  }
}

TEST(CompoundGeometry, ManagerTellsTheLeastDistance) {
  Random random(71);
  int num_apart = 0;
  for (int n = 0; n < 20; ++n) {
    std::vector<Body> bodies;
    std::vector<std::unique_ptr<ContinuousCollisionObject<double>>> objects;
    ContinuousCollisionManager<double> manager;
    for (int i = 0; i < 4; ++i) {
      Body body = randomBody(random, BodyMotion::Kind::kTranslation);
      body.motion.beg.pretranslate(Vector(4. * i, 0, 0));
      body.motion.end.pretranslate(Vector(4. * i, 0, 0));
      body.motion.motion = body.motion.of(Tf::Identity());
      bodies.push_back(body);
      objects.push_back(makeObject(body.compound, body.motion.motion));
      manager.registerObject(objects.back().get());
    }
    double lo = std::numeric_limits<double>::infinity(), hi = lo;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = i + 1; k < 4; ++k) {
        ContinuousDistanceResult<double> one;
        continuousDistance(bodies[i].compound.get(), bodies[i].motion.motion.get(),
                           bodies[k].compound.get(), bodies[k].motion.motion.get(),
                           ContinuousDistanceRequest<double>(), one);
        lo = std::min(lo, one.distance_lo);
        hi = std::min(hi, one.distance_hi);
      }
    ContinuousManagerDistance<double> result;
    manager.distance(ContinuousDistanceRequest<double>(), result);
    // Both brackets have the least distance.
    EXPECT_LE(result.result.distance_lo, hi);
    EXPECT_GE(result.result.distance_hi, lo);
    num_apart += lo > 0 ? 1 : 0;
  }
  EXPECT_GT(num_apart, 10);
}

/// One geometry in several parts, and one compound on both sides.
TEST(CompoundGeometry, SharesGeometries) {
  const auto mesh = makeModel<Rigid>(makeIcosphere(1, .5));
  Compound pair;
  for (const double x : {-2., 2.}) pair.addPart(mesh, at(x, 0, 0));
  const Tf rest = Tf::Identity();
  Request request;
  request.query = ContinuousQuery::kFirst;
  Result result;
  // The right ball of o2 comes to the left one of o1, whose balls rest.
  continuousCollide(&pair, rest, rest, &pair, at(-8, .01, 0), at(-4, .01, 0), request,
                    result);
  ASSERT_TRUE(result.is_collide);
  EXPECT_EQ(result.contacts.at(0).part1, 0);
  EXPECT_EQ(result.contacts.at(0).part2, 1);
  EXPECT_EQ(result.contacts.at(0).o1, result.contacts.at(0).o2);
}

TEST(CompoundGeometry, RobotCarriesIt) {
  JointChain chain;
  chain.addRevolute(Tf::Identity(), Vector::UnitZ());
  CollisionRobot<double> whole(chain), parts(chain);
  const auto link = std::make_shared<Compound>();
  Random random(4);
  for (int i = 0; i < 5; ++i) {
    const auto ball = std::make_shared<Sphere<double>>(.1);
    const Tf offset = at(.2 * i, .01 * i, 0);
    link->addPart(ball, offset);
    parts.attach(0, ball, at(0, 0, .5) * offset);
  }
  whole.attach(0, link, at(0, 0, .5));
  int num_free = 0;
  for (int n = 0; n < 50; ++n) {
    ContinuousCollisionManager<double> manager;
    const Vector p = random.point(1);
    const auto ball = makeObject(std::make_shared<Sphere<double>>(.1),
                                 translation({p[0], p[1], .5}, {p[1], p[0], .5}));
    manager.registerObject(ball.get());
    Request request;
    request.query = ContinuousQuery::kFirst;
    RobotEdgeResult<double> of_whole, of_parts;
    whole.checkEdge({0}, {1}, &manager, request, of_whole);
    parts.checkEdge({0}, {1}, &manager, request, of_parts);
    ASSERT_EQ(of_whole.is_free, of_parts.is_free);
    ASSERT_NEAR(of_whole.time_of_contact, of_parts.time_of_contact,
                request.toc_err + kGraze);
    num_free += of_whole.is_free ? 1 : 0;
  }
  EXPECT_GT(num_free, 0);
  EXPECT_LT(num_free, 50);
}

/// Threads share a compound, and a query may take several.
TEST(CompoundGeometry, ThreadsGetTheSameAnswer) {
  Random random(12);
  const Body a = randomBody(random, BodyMotion::Kind::kTurn),
             b = randomBody(random, BodyMotion::Kind::kScrew);
  Result alone;
  collide(a, b, Request(), alone);
  std::vector<Result> results(4);
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&, i] {
      Request request;
      request.num_threads = i;
      collide(a, b, request, results[std::size_t(i)]);
    });
  for (std::thread& thread : threads) thread.join();
  for (const Result& result : results) {
    EXPECT_EQ(result.time_of_contact, alone.time_of_contact);
    EXPECT_EQ(result.contacts.size(), alone.contacts.size());
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl
