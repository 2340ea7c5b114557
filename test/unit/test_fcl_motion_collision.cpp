// SPDX-License-Identifier: BSD-3-Clause
//
// Public queries of meshes that turn: every way to give the motion, and times against
// closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <set>
#include <thread>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/spline_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

template <typename S>
using Rigid = BVHModel<OBBRSS<S>>;
using Model = DeformableBVHModel<OBBRSS<double>>;
using Request = ContinuousCollisionRequest<double>;
using Result = ContinuousCollisionResult<double>;
using ContactRequest = ContinuousContactRequest<double>;
using ContactResult = ContinuousContactResult<double>;
using Pose = Transform3<double>;

constexpr double kPi = 3.14159265358979323846;
constexpr double kTurn = kPi / 2;
constexpr double kHalfWidth = 0.0625;
constexpr double kTocErr = 1e-6;

/// A bar along x from the axis to 2. It is divided, so that its tree has levels.
TestMesh makeBar() { return moved(makeBox({1, kHalfWidth, kHalfWidth}, 4), 1, 0, 0); }

/// A square in a plane through the z axis, at an angle, beyond a distance of kNear.
constexpr double kNear = 1.05;
TestMesh makeSquare(double angle) {
  const Vector3<double> out(std::cos(angle), std::sin(angle), 0), up(0, 0, 1);
  const Vector3<double> near = kNear * out, far = 1.45 * out;
  TestMesh mesh;
  mesh.vertices = {near - up, far - up, far + up, near + up};
  mesh.triangles = {Triangle(0, 1, 2), Triangle(0, 2, 3)};
  return mesh;
}

/// The time at which the bar's side, turning about z by kTurn, meets a point (x, y)
/// inside its reach.
double meets(double x, double y) {
  return (std::atan2(y, x) - std::asin(kHalfWidth / std::hypot(x, y))) / kTurn;
}

template <typename S = double>
Transform3<S> turned(double angle) {
  Transform3<S> tf = Transform3<S>::Identity();
  tf.linear() = AngleAxis<double>(angle, Vector3<double>::UnitZ())
                    .toRotationMatrix()
                    .template cast<S>();
  return tf;
}

double angleOf(const Pose& tf) {
  return std::atan2(tf.linear()(1, 0), tf.linear()(0, 0));
}

template <typename R>
R requestOf(CCDMotionType type = CCDM_TRANS) {
  R request;
  request.toc_err = kTocErr;
  request.ccd_motion_type = type;
  return request;
}

const Pose kStill = Pose::Identity();
constexpr double kAngle = 0.9;
const double kTime = meets(kNear * std::cos(kAngle), kNear* std::sin(kAngle));

void expectTheContact(const Result& result) {
  EXPECT_TRUE(result.is_collide);
  EXPECT_NEAR(result.time_of_contact, kTime, 1e-12);
  EXPECT_LE(result.time_of_contact, kTime + 1e-16);
  // The poses are at the upper end.
  const double later = angleOf(result.contact_tf1) - kTurn * kTime;
  EXPECT_GT(later, 0);
  EXPECT_LT(later, 2 * kTocErr);
  EXPECT_EQ(result.contact_tf2.matrix(), kStill.matrix());
}

class MotionCollision : public ::testing::Test {
 protected:
  std::shared_ptr<Rigid<double>> bar_ = makeModel<Rigid<double>>(makeBar());
  std::shared_ptr<Rigid<double>> square_ = makeModel<Rigid<double>>(makeSquare(kAngle));
};

TEST_F(MotionCollision, EndTransformsOfEveryType) {
  for (const auto type : {CCDM_TRANS, CCDM_LINEAR, CCDM_SCREW}) {
    SCOPED_TRACE(type);
    Result result;
    const Pose end = turned(kTurn);
    EXPECT_EQ(continuousCollide(bar_.get(), kStill, end, square_.get(), kStill, kStill,
                                requestOf<Request>(type), result),
              result.time_of_contact);
    expectTheContact(result);
    Result swapped;
    continuousCollide(square_.get(), kStill, kStill, bar_.get(), kStill, end,
                      requestOf<Request>(type), swapped);
    EXPECT_NEAR(swapped.time_of_contact, kTime, 1e-12);
    std::swap(swapped.contact_tf1, swapped.contact_tf2);
    expectTheContact(swapped);
    const CollisionObject<double> o1(bar_), o2(square_);
    Result by_objects;
    continuousCollide(&o1, end, &o2, kStill, requestOf<Request>(type), by_objects);
    EXPECT_EQ(by_objects.time_of_contact, result.time_of_contact);
    expectTheContact(by_objects);
  }
}

TEST_F(MotionCollision, MotionObjects) {
  const Vector3<double> zero = Vector3<double>::Zero(), z = Vector3<double>::UnitZ();
  const auto still = std::make_shared<TranslationMotion<double>>(kStill, kStill);
  const Pose end = turned(kTurn);
  const auto interpolation = std::make_shared<InterpMotion<double>>(
      kStill.linear(), zero, end.linear(), zero, zero);
  const auto screw = std::make_shared<ScrewMotion<double>>(kStill, end);
  // Control points at equal distances give constant speed.
  const auto spline = std::make_shared<SplineMotion<double>>(
      zero, zero, zero, zero, -kTurn * z, zero, kTurn * z, 2 * kTurn * z);
  for (const std::shared_ptr<MotionBase<double>>& motion :
       {std::shared_ptr<MotionBase<double>>(interpolation),
        std::shared_ptr<MotionBase<double>>(screw),
        std::shared_ptr<MotionBase<double>>(spline)}) {
    // The current pose of the motion does not matter, and it does not change.
    motion->integrate(0.7);
    Pose before, after;
    motion->getCurrentTransform(before);
    Result result;
    continuousCollide(bar_.get(), motion.get(), square_.get(), still.get(),
                      requestOf<Request>(), result);
    expectTheContact(result);
    motion->getCurrentTransform(after);
    EXPECT_EQ(before.matrix(), after.matrix());
    const ContinuousCollisionObject<double> o1(bar_, motion), o2(square_, still);
    Result by_objects;
    collide(&o1, &o2, requestOf<Request>(), by_objects);
    EXPECT_EQ(by_objects.time_of_contact, result.time_of_contact);
  }
}

// One turn on top of the motions of both objects does not change the time.
TEST_F(MotionCollision, OneTurnOnTopOfBoth) {
  for (const double top : {-2.5, -1e-10, 0.7, 1.3})
    for (const auto type : {CCDM_LINEAR, CCDM_SCREW}) {
      Result result;
      continuousCollide(bar_.get(), kStill, turned(kTurn + top), square_.get(), kStill,
                        turned(top), requestOf<Request>(type), result);
      EXPECT_NEAR(result.time_of_contact, kTime, 1e-12) << top;
      EXPECT_LE(result.time_of_contact, kTime + 1e-15) << top;
    }
}

// FCL's conservative advancement starts where the last call left the motion.
TEST_F(MotionCollision, AdvancementThatMovedTheMotionDoesNotCount) {
  const Vector3<double> zero = Vector3<double>::Zero();
  const InterpMotion<double> motion(kStill.linear(), zero, turned(kTurn).linear(), zero,
                                    zero);
  const TranslationMotion<double> still(kStill, kStill);
  Request request = requestOf<Request>();
  Result result;
  continuousCollide(bar_.get(), &motion, square_.get(), &still, request, result);
  expectTheContact(result);
  motion.integrate(1);
  Request stock = request;
  stock.ccd_solver_type = CCDC_CONSERVATIVE_ADVANCEMENT;
  Result of_fcl;
  continuousCollide<double>(bar_.get(), &motion, square_.get(), &still, stock, of_fcl);
  EXPECT_FALSE(of_fcl.is_collide && std::abs(of_fcl.time_of_contact - kTime) < 1e-3)
      << "FCL has become right";
  Result again;
  continuousCollide(bar_.get(), &motion, square_.get(), &still, request, again);
  EXPECT_EQ(again.time_of_contact, result.time_of_contact);
}

// An interpolation about another point, and a screw, are other paths between the same
// poses. Both move the bar's origin along x, the one on a line and the other on an arc.
TEST_F(MotionCollision, ReferencePointAndAxisCount) {
  const Vector3<double> reference(2, 0, 0), zero = Vector3<double>::Zero();
  Pose end = turned(kTurn);
  // The tip does not move.
  end.translation() = reference - end.linear() * reference;
  const InterpMotion<double> about_tip(kStill.linear(), zero, end.linear(),
                                       end.translation(), reference);
  const TranslationMotion<double> still(kStill, kStill);
  // First beyond the tip, where the bar does not come, then where it has to come.
  TestMesh wall = makeSquare(0);
  const auto behind = makeModel<Rigid<double>>(moved(wall, 1.25, 0, 0));
  Result result;
  continuousCollide(bar_.get(), &about_tip, behind.get(), &still, requestOf<Request>(),
                    result);
  EXPECT_FALSE(result.is_collide);
  EXPECT_EQ(result.time_of_contact, 1);
  EXPECT_EQ(result.contact_tf1.matrix(), end.matrix());
  const auto ahead = makeModel<Rigid<double>>(moved(makeSquare(-kAngle), 2, 0, 0));
  ContactResult by_contacts;
  // The bar points to -x from its tip and turns towards -y.
  const auto mirrored =
      makeModel<Rigid<double>>(moved(makeSquare(kPi + kAngle), 2, 0, 0));
  continuousCollide(bar_.get(), &about_tip, mirrored.get(), &still,
                    requestOf<ContactRequest>(), by_contacts);
  EXPECT_NEAR(by_contacts.time_of_contact, kTime, 1e-12);
  continuousCollide(bar_.get(), &about_tip, ahead.get(), &still, requestOf<Request>(),
                    result);
  EXPECT_FALSE(result.is_collide);
  Result screwed;
  continuousCollide(bar_.get(), kStill, end, mirrored.get(), kStill, kStill,
                    requestOf<Request>(CCDM_SCREW), screwed);
  EXPECT_NEAR(screwed.time_of_contact, kTime, 1e-12);
}

TEST_F(MotionCollision, NoContactEndsAtTheEnd) {
  const Pose end = turned(0.5);
  for (const auto type : {CCDM_TRANS, CCDM_SCREW}) {
    ContactResult result;
    continuousCollide(bar_.get(), kStill, end, square_.get(), kStill, kStill,
                      requestOf<ContactRequest>(type), result);
    EXPECT_FALSE(result.is_collide);
    EXPECT_EQ(result.time_of_contact, 1);
    EXPECT_EQ(result.contact_tf1.matrix(), end.matrix());
    EXPECT_TRUE(result.contacts.empty());
    EXPECT_FALSE(result.initially_crossing);
  }
}

TEST(MotionCollisionFloat, EndTransformsAndSplines) {
  const auto bar = makeModel<Rigid<float>>(makeBar());
  const auto square = makeModel<Rigid<float>>(makeSquare(kAngle));
  const Transform3<float> still = Transform3<float>::Identity();
  for (const auto type : {CCDM_TRANS, CCDM_LINEAR, CCDM_SCREW}) {
    ContinuousCollisionRequest<float> request;
    request.ccd_motion_type = type;
    ContinuousCollisionResult<float> result;
    continuousCollide(bar.get(), still, turned<float>(kTurn), square.get(), still, still,
                      request, result);
    EXPECT_NEAR(result.time_of_contact, kTime, 1e-6) << type;
  }
  const Vector3<float> zero = Vector3<float>::Zero(),
                       z = static_cast<float>(kTurn) * Vector3<float>::UnitZ();
  const SplineMotion<float> spline(zero, zero, zero, zero, -z, zero, z, 2 * z);
  const TranslationMotion<float> rest(still, still);
  ContinuousContactRequest<float> request;
  ContinuousContactResult<float> result;
  continuousCollide(bar.get(), &spline, square.get(), &rest, request, result);
  EXPECT_NEAR(result.time_of_contact, kTime, 1e-6);
  EXPECT_FALSE(result.contacts.empty());
}

/// The position of a vertex by the formula of the motion: a turn about z by kTurn.
Vector3<double> at(const TestMesh& mesh, int vertex, double t, bool turns) {
  const Vector3<double>& p = mesh.vertices[static_cast<std::size_t>(vertex)];
  return turns ? Vector3<double>(turned(kTurn * t) * p) : p;
}

/// Distance of a point from a segment, and from a triangle below it.
double distanceOfEdges(const Vector3<double>& p, const Vector3<double>& q,
                       const Vector3<double>& r, const Vector3<double>& s) {
  const Vector3<double> n = (q - p).cross(s - r);
  return n.norm() > 1e-9 ? std::abs(n.normalized().dot(r - p))
                         : (q - p).normalized().cross(r - p).norm();
}

TEST_F(MotionCollision, ContactsNameFeaturesThatTouch) {
  const TestMesh bar = makeBar(), square = makeSquare(kAngle);
  ContactResult result;
  continuousCollide(bar_.get(), kStill, turned(kTurn), square_.get(), kStill, kStill,
                    requestOf<ContactRequest>(), result);
  ASSERT_FALSE(result.contacts.empty());
  EXPECT_EQ(result.contacts.front().toc_lo, result.time_of_contact);
  std::set<std::vector<int>> seen;
  double before = 0;
  for (const auto& contact : result.contacts) {
    EXPECT_LE(before, contact.toc_lo);
    before = contact.toc_lo;
    EXPECT_LE(contact.toc_hi - contact.toc_lo, kTocErr * 1.001);
    std::vector<int> name(contact.vertices.begin(), contact.vertices.end());
    name.push_back(contact.first_on_o1);
    EXPECT_TRUE(seen.insert(name).second);
    EXPECT_EQ(contact.o1, bar_.get());
    const bool vf = contact.kind == ContinuousContactKind::kVertexFace;
    Vector3<double> x[4];
    for (int i = 0; i < 4; ++i) {
      const bool on_bar = (i < (vf ? 1 : 2)) == contact.first_on_o1;
      x[i] = at(on_bar ? bar : square, contact.vertices[static_cast<std::size_t>(i)],
                contact.toc_lo, on_bar);
    }
    const double distance =
        vf ? std::abs((x[2] - x[1]).cross(x[3] - x[1]).normalized().dot(x[0] - x[1]))
           : distanceOfEdges(x[0], x[1], x[2], x[3]);
    EXPECT_LT(distance, 1e-12);
    if (contact.toc_lo > kTime + 1e-9) continue;
    // The side of the bar meets the inner edge of the square.
    const double angle = kTurn * contact.toc_lo;
    EXPECT_NEAR(contact.pos[0], kNear * std::cos(kAngle), 1e-9);
    EXPECT_NEAR(contact.pos[1], kNear * std::sin(kAngle), 1e-9);
    if (contact.normal.norm() == 0) continue;
    EXPECT_NEAR(contact.normal[0], -std::sin(angle), 1e-6);
    EXPECT_NEAR(contact.normal[1], std::cos(angle), 1e-6);
  }
}

/// A wall that the corner of the bar reaches, passes by far, or does not reach.
TEST_F(MotionCollision, SaysWhetherACrossingIsProved) {
  const double reach = std::hypot(2, kHalfWidth);
  const auto ask = [&](double distance) {
    const auto wall = makeModel<Rigid<double>>(TestMesh{
        {{-9, distance, -9}, {9, distance, -9}, {0, distance, 9}}, {Triangle(0, 1, 2)}});
    ContactResult result;
    continuousCollide(bar_.get(), kStill, turned(0.75 * kPi), wall.get(), kStill, kStill,
                      requestOf<ContactRequest>(), result);
    return result;
  };
  EXPECT_FALSE(ask(reach + 1e-12).is_collide);
  const ContactResult graze = ask(reach), crossing = ask(0.9 * reach);
  ASSERT_TRUE(graze.is_collide);
  for (const auto& contact : graze.contacts) {
    EXPECT_TRUE(contact.within_tolerance);
    EXPECT_EQ(contact.toc_hi, contact.toc_lo);
  }
  ASSERT_TRUE(crossing.is_collide);
  EXPECT_FALSE(crossing.contacts.front().within_tolerance);
  EXPECT_GT(crossing.contacts.front().toc_hi, crossing.contacts.front().toc_lo);
}

TEST_F(MotionCollision, GoalsAndLimitsOfContacts) {
  const auto ask = [&](ContinuousQuery query, std::size_t limit) {
    ContactRequest request = requestOf<ContactRequest>();
    request.query = query;
    request.num_max_contacts = limit;
    ContactResult result;
    continuousCollide(bar_.get(), kStill, turned(kTurn), square_.get(), kStill, kStill,
                      request, result);
    return result;
  };
  constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
  const ContactResult all = ask(ContinuousQuery::kAll, kNoLimit),
                      first = ask(ContinuousQuery::kFirst, kNoLimit),
                      any = ask(ContinuousQuery::kAny, kNoLimit),
                      two = ask(ContinuousQuery::kAll, 2);
  EXPECT_FALSE(all.contacts_cut);
  EXPECT_GT(all.contacts.size(), first.contacts.size());
  ASSERT_FALSE(first.contacts.empty());
  double first_hi = 1;
  for (const auto& contact : first.contacts)
    first_hi = std::min(first_hi, contact.toc_hi);
  for (const auto& contact : first.contacts) EXPECT_LE(contact.toc_lo, first_hi);
  EXPECT_NEAR(first.time_of_contact, kTime, 1e-12);
  EXPECT_EQ(any.contacts.size(), 1u);
  EXPECT_NEAR(any.time_of_contact, kTime, 1e-12);
  ASSERT_EQ(two.contacts.size(), 2u);
  EXPECT_TRUE(two.contacts_cut);
  EXPECT_EQ(two.contacts[1].vertices, all.contacts[1].vertices);
}

// The bar's side and the floor stay parallel, so that brackets may have no width.
TEST_F(MotionCollision, FirstAndAnyContactOfFacesThatStayParallel) {
  const auto floor =
      makeModel<Rigid<double>>(moved(makeBox({4, 4, 0.25}, 1), 0, 0, -0.25));
  for (int i = 1; i <= 60; ++i) {
    const double h = 0.1 + 0.01 * (i % 37), d = -0.1 - 0.013 * (i % 23);
    Pose beg = turned(0.17 * i), end = turned(0.17 * i + 0.4);
    beg.translation() = Vector3<double>(0.1 * (i % 7), 0.07 * (i % 5), h);
    end.translation() = Vector3<double>(0.05 * (i % 3), 0.03 * (i % 11), d);
    const double time = (h - kHalfWidth) / (h - d);
    for (auto query : {ContinuousQuery::kFirst, ContinuousQuery::kAny}) {
      ContactRequest request = requestOf<ContactRequest>();
      request.query = query;
      ContactResult result;
      continuousCollide(bar_.get(), beg, end, floor.get(), kStill, kStill, request,
                        result);
      EXPECT_FALSE(result.contacts.empty()) << i;
      EXPECT_GE(result.time_of_contact, time - 1e-11) << i;
      if (query == ContinuousQuery::kAny) continue;
      EXPECT_LE(result.time_of_contact, time + 1e-15) << i;
    }
  }
}

// A deforming mesh that turns: each of its features belongs to one of its triangles,
// which need not be one of those that were found.
TEST_F(MotionCollision, AnyContactOfAMeshThatDeforms) {
  const TestMesh ball = makeIcosphere(3, 0.4);
  TestMesh wide = ball;
  for (auto& p : wide.vertices) p = Vector3<double>(1.2 * p[0], 0.8 * p[1], p[2]);
  const auto cloth = makeModel<DeformableBVHModel<OBBRSS<double>>>(ball, wide);
  const auto rod = makeModel<Rigid<double>>(makeBox({0.9, 0.02, 0.02}, 4));
  for (int i = 0; i < 24; ++i) {
    Pose begin = turned(0.3 * i), end = turned(0.3 * i + 1);
    begin.translation() = Vector3<double>(0.1 * (i % 5), 0.05 * (i % 3), 0.6);
    end.translation() = Vector3<double>(0.04 * (i % 7), 0.1 * (i % 2), -0.6);
    const auto ask = [&](ContinuousQuery query) {
      ContactRequest request = requestOf<ContactRequest>();
      request.query = query;
      ContactResult result;
      continuousCollide(cloth.get(), kStill, turned(0.5), rod.get(), begin, end, request,
                        result);
      return result;
    };
    const ContactResult all = ask(ContinuousQuery::kAll),
                        any = ask(ContinuousQuery::kAny);
    ASSERT_TRUE(any.is_collide) << i;
    ASSERT_EQ(any.contacts.size(), 1U);
    const auto& contact = any.contacts[0];
    const auto same =
        std::find_if(all.contacts.begin(), all.contacts.end(), [&](const auto& other) {
          return other.kind == contact.kind && other.vertices == contact.vertices &&
                 other.first_on_o1 == contact.first_on_o1;
        });
    ASSERT_NE(same, all.contacts.end()) << i;
    EXPECT_NEAR(same->toc_lo, contact.toc_lo, 2e-4) << i;
  }
}

TEST_F(MotionCollision, CrossingAndTouchingAtTheBeginning) {
  ContactResult result;
  const auto crossing = makeModel<Rigid<double>>(makeSquare(0.02));
  continuousCollide(bar_.get(), kStill, turned(kTurn), crossing.get(), kStill, kStill,
                    requestOf<ContactRequest>(), result);
  EXPECT_TRUE(result.is_collide);
  EXPECT_EQ(result.time_of_contact, 0);
  EXPECT_TRUE(result.initially_crossing);
  EXPECT_EQ(result.crossing.o1, bar_.get());
  EXPECT_NEAR(result.crossing.pos[1], 0.02 * result.crossing.pos[0], 1e-4);
  EXPECT_EQ(result.contact_tf1.matrix(), kStill.matrix());
  // A sheet on top of the bar, which turns below it.
  TestMesh sheet = moved(makeSheet(1, 1), 0.5, -0.5, kHalfWidth);
  const auto lid = makeModel<Rigid<double>>(sheet);
  continuousCollide(bar_.get(), kStill, turned(kTurn), lid.get(), kStill, kStill,
                    requestOf<ContactRequest>(), result);
  EXPECT_TRUE(result.is_collide);
  EXPECT_EQ(result.time_of_contact, 0);
  EXPECT_FALSE(result.initially_crossing);
  EXPECT_FALSE(result.contacts.empty());
}

/// A small sheet that sinks, and has the height of the bar only when the bar comes by.
class SinkingSheet {
 public:
  SinkingSheet() {
    const TestMesh sheet = moved(makeSheet(2, 2), -0.5, 1, 0);
    time = meets(0.5, 1);
    from = moved(sheet, 0, 0, time);
    to = moved(sheet, 0, 0, time - 1);
    model = makeModel<Model>(from, to);
  }
  TestMesh from, to;
  double time;
  std::shared_ptr<Model> model;
};

TEST_F(MotionCollision, ClothBesideATurningBody) {
  const SinkingSheet sheet;
  Result result;
  continuousCollide(bar_.get(), kStill, turned(kTurn), sheet.model.get(), kStill, kStill,
                    requestOf<Request>(), result);
  EXPECT_NEAR(result.time_of_contact, sheet.time, 1e-12);
  ContactResult contacts;
  continuousCollide(sheet.model.get(), kStill, kStill, bar_.get(), kStill, turned(kTurn),
                    requestOf<ContactRequest>(), contacts);
  EXPECT_NEAR(contacts.time_of_contact, sheet.time, 1e-12);
  EXPECT_FALSE(contacts.contacts.empty());
  // FCL takes the sheet in its current frame, where it is below.
  Result stock;
  continuousCollide<double>(bar_.get(), kStill, turned(kTurn), sheet.model.get(), kStill,
                            kStill, requestOf<Request>(CCDM_SCREW), stock);
  EXPECT_FALSE(stock.is_collide) << "FCL has become right";
}

// The same seen from the bar: the sheet sinks in a frame that turns.
TEST_F(MotionCollision, ClothInATurningFrame) {
  const SinkingSheet sheet;
  const Pose end = turned(-kTurn);
  for (const auto type : {CCDM_LINEAR, CCDM_SCREW}) {
    Result result;
    continuousCollide(bar_.get(), kStill, kStill, sheet.model.get(), kStill, end,
                      requestOf<Request>(type), result);
    EXPECT_NEAR(result.time_of_contact, sheet.time, 1e-12);
  }
  // With FCL's default its vertices go straight, like those of a model in both poses.
  TestMesh last = sheet.to;
  for (auto& p : last.vertices) p = (end * p).eval();
  const auto straight = makeModel<Model>(sheet.from, last);
  Result posed, expected;
  continuousCollide(bar_.get(), kStill, kStill, sheet.model.get(), kStill, end,
                    requestOf<Request>(), posed);
  continuousCollide(bar_.get(), kStill, kStill, straight.get(), kStill, kStill,
                    requestOf<Request>(), expected);
  EXPECT_EQ(posed.is_collide, expected.is_collide);
  EXPECT_NEAR(posed.time_of_contact, expected.time_of_contact, 1e-9);
  // The same if the other body turns.
  Result beside, beside_expected;
  continuousCollide(bar_.get(), kStill, turned(kTurn), sheet.model.get(), kStill, end,
                    requestOf<Request>(), beside);
  continuousCollide(bar_.get(), kStill, turned(kTurn), straight.get(), kStill, kStill,
                    requestOf<Request>(), beside_expected);
  EXPECT_EQ(beside.is_collide, beside_expected.is_collide);
  EXPECT_NEAR(beside.time_of_contact, beside_expected.time_of_contact, 1e-12);
}

/// A motion in memory that is not cleared.
class InterpolationInUsedMemory {
 public:
  explicit InterpolationInUsedMemory(const Pose& end, double leftover) {
    auto* numbers = reinterpret_cast<double*>(memory_);
    std::fill(numbers, numbers + sizeof(memory_) / sizeof(double), leftover);
    motion_ = new (memory_) InterpMotion<double>(kStill, end);
  }
  ~InterpolationInUsedMemory() { motion_->~InterpMotion<double>(); }
  InterpolationInUsedMemory(const InterpolationInUsedMemory&) = delete;
  InterpolationInUsedMemory& operator=(const InterpolationInUsedMemory&) = delete;
  const InterpMotion<double>& operator*() const { return *motion_; }

 private:
  alignas(64) unsigned char memory_[sizeof(InterpMotion<double>)];
  InterpMotion<double>* motion_;
};

TEST_F(MotionCollision, ReferencePointThatWasNeverSet) {
  const TranslationMotion<double> still(kStill, kStill);
  const auto ask = [&](double leftover) {
    const InterpolationInUsedMemory motion(turned(kTurn), leftover);
    Result result;
    continuousCollide(bar_.get(), &*motion, square_.get(), &still, requestOf<Request>(),
                      result);
    return result;
  };
  expectTheContact(ask(0));
  expectTheContact(ask(5e-324));
  for (const double leftover : {1e17, -3e200, std::nan(""), HUGE_VAL}) {
    try {
      ask(leftover);
      ADD_FAILURE() << leftover;
    } catch (const Exception& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find("o1: the reference point"), std::string::npos) << text;
      EXPECT_NE(text.find("five arguments"), std::string::npos) << text;
    }
  }
}

template <typename Call>
void expectRefused(const Call& call, const std::string& what) {
  try {
    call();
    ADD_FAILURE() << what;
  } catch (const Exception& error) {
    EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
  }
}

TEST_F(MotionCollision, WhatIsRefused) {
  Result result;
  const Pose end = turned(kTurn);
  const auto ask = [&](const CollisionGeometry<double>& o, const Pose& to,
                       CCDMotionType type) {
    continuousCollide(&o, kStill, to, square_.get(), kStill, kStill,
                      requestOf<Request>(type), result);
  };
  expectRefused(
      [&] { ask(*bar_, end, CCDM_SPLINE); },
      "o1, a triangle mesh: request.ccd_motion_type does not define how it turns");
  // Without a turn there is only one path.
  Pose translated = kStill;
  translated.translation()[0] = 1;
  EXPECT_NO_THROW(ask(*bar_, translated, CCDM_SPLINE));
  const double nan = std::nan("");
  TestMesh broken = makeBar();
  const auto bad = makeModel<Rigid<double>>(broken);
  for (int i = 0; i < bad->num_vertices; ++i) bad->vertices[i][1] = nan;
  expectRefused([&] { ask(*bad, end, CCDM_LINEAR); }, "o1: vertex ");
  expectRefused([&] { ask(Rigid<double>(), end, CCDM_LINEAR); }, "o1: the model");
  Pose nowhere = end;
  nowhere.translation()[1] = nan;
  expectRefused([&] { ask(*bar_, nowhere, CCDM_LINEAR); }, "o1: the transform");
  nowhere.translation()[1] = 1e300;
  expectRefused([&] { ask(*bar_, nowhere, CCDM_LINEAR); }, "2^200");
}

// Vertices that go straight may go anywhere: twice the size at both ends, or at the end
// of a mesh that deforms. A turn needs rotations.
TEST_F(MotionCollision, TransformsThatAreNoRotations) {
  const TestMesh box = makeBox(Vector3<double>(1, 1, 1));
  const auto cube = makeModel<Rigid<double>>(box);
  DeformableBVHModel<OBBRSS<double>> sinking;
  sinking.beginModel();
  sinking.addSubModel(box.vertices, box.triangles);
  sinking.endModel();
  std::vector<Vector3<double>> below = box.vertices;
  for (Vector3<double>& v : below) v[2] -= 1;
  sinking.beginUpdateModel();
  sinking.updateSubModel(below);
  sinking.endUpdateModel();
  const auto posed = [](double scale, double z) {
    Pose pose = kStill;
    pose.linear() *= scale;
    pose.translation()[2] = z;
    return pose;
  };
  const auto floor = makeModel<Rigid<double>>(makeBox(Vector3<double>(99, 99, 1)));
  const auto ask = [&](const CollisionGeometry<double>& o, double begin, double end,
                       CCDMotionType type) {
    Result result;
    continuousCollide(&o, posed(begin, 4), posed(end, 0), floor.get(), kStill, kStill,
                      requestOf<Request>(type), result);
    return result.time_of_contact;
  };
  const std::string wanted = "o1, a triangle mesh: a transform scales, mirrors or shears";
  for (const CCDMotionType type : {CCDM_TRANS, CCDM_LINEAR, CCDM_SCREW}) {
    EXPECT_NEAR(ask(*cube, 2, 2, type), 0.25, 1e-3);
    EXPECT_NEAR(ask(*cube, -2, -2, type), 0.25, 1e-3);
    for (const double end : {2., -1., 0.})
      expectRefused([&] { ask(*cube, 1, end, type); }, wanted);
  }
  EXPECT_NEAR(ask(sinking, 1, 2, CCDM_TRANS), 2. / 7, 1e-3);  // from 3 to -4
  expectRefused([&] { ask(sinking, 1, 2, CCDM_LINEAR); }, wanted);
}

TEST_F(MotionCollision, TwoThreadsOnSharedModelsAndMotions) {
  const SinkingSheet sheet;
  const Vector3<double> zero = Vector3<double>::Zero();
  const Vector3<double> z = Vector3<double>::UnitZ();
  const InterpMotion<double> interpolation(kStill.linear(), zero, turned(kTurn).linear(),
                                           zero, zero);
  const ScrewMotion<double> screw(kStill, turned(kTurn));
  const SplineMotion<double> spline(zero, zero, zero, zero, -kTurn * z, zero, kTurn * z,
                                    2 * kTurn * z);
  const TranslationMotion<double> still(kStill, kStill);
  double worst[2] = {0, 0};
  const auto work = [&](double& error) {
    for (int i = 0; i < 15; ++i)
      for (const MotionBase<double>* motion :
           {static_cast<const MotionBase<double>*>(&interpolation),
            static_cast<const MotionBase<double>*>(&screw),
            static_cast<const MotionBase<double>*>(&spline)})
        for (const CollisionGeometry<double>* other :
             {static_cast<const CollisionGeometry<double>*>(square_.get()),
              static_cast<const CollisionGeometry<double>*>(sheet.model.get())}) {
          Result result;
          const double time = continuousCollide(bar_.get(), motion, other, &still,
                                                requestOf<Request>(), result);
          const double expected = other == square_.get() ? kTime : sheet.time;
          error = std::max(error, std::abs(time - expected));
        }
  };
  std::thread first(work, std::ref(worst[0])), second(work, std::ref(worst[1]));
  first.join();
  second.join();
  EXPECT_LT(worst[0], 1e-12);
  EXPECT_EQ(worst[0], worst[1]);
}

// The boxes of trees of ours are floats, and the products of three edges leave the range
// of double.
TEST_F(MotionCollision, TinyMeshes) {
  double expected = -1;
  for (const double size : {1e-30, 1e-40, 1e-55, 1e-70, 1e-80, 1e-90}) {
    SCOPED_TRACE(size);
    TestMesh cube = makeBox({1, 1, 1}, 2);
    for (auto& p : cube.vertices) p *= size;
    const auto rigid = makeModel<Rigid<double>>(cube);
    const auto deformable = makeModel<Model>(cube);
    for (const double offset : {3., 0.5}) {
      Pose from = Pose::Identity(), to = turned(0.5);
      from.translation() = size * Vector3<double>(-5, offset, 0);
      to.translation() = size * Vector3<double>(5, offset, 0);
      const Pose still = Pose::Identity();
      for (const CollisionGeometry<double>* cube_of_tree :
           {static_cast<CollisionGeometry<double>*>(rigid.get()),
            static_cast<CollisionGeometry<double>*>(deformable.get())}) {
        ContactResult result;
        continuousCollide(cube_of_tree, still, still, cube_of_tree, from, to,
                          requestOf<ContactRequest>(CCDM_LINEAR), result);
        EXPECT_EQ(result.is_collide, offset < 1);
        if (offset > 1) continue;
        if (expected < 0) expected = result.time_of_contact;
        EXPECT_GT(result.time_of_contact, 0.2);
        EXPECT_NEAR(result.time_of_contact, expected, 1e-5);
      }
    }
  }
}

// The answer of any number of threads is the same to the bit.
TEST_F(MotionCollision, NumberOfThreads) {
  const SinkingSheet sheet;
  for (const CollisionGeometry<double>* other :
       {static_cast<const CollisionGeometry<double>*>(square_.get()),
        static_cast<const CollisionGeometry<double>*>(sheet.model.get())}) {
    std::vector<ContactResult> results;
    for (const int threads : {1, 2, 7, 0}) {
      ContactRequest request = requestOf<ContactRequest>();
      request.num_threads = threads;
      ContactResult result;
      continuousCollide(bar_.get(), kStill, turned(kTurn), other, kStill, kStill, request,
                        result);
      results.push_back(result);
    }
    ASSERT_FALSE(results[0].contacts.empty());
    for (const ContactResult& result : results) {
      EXPECT_EQ(result.time_of_contact, results[0].time_of_contact);
      ASSERT_EQ(result.contacts.size(), results[0].contacts.size());
      for (std::size_t i = 0; i < result.contacts.size(); ++i) {
        const auto &x = result.contacts[i], &y = results[0].contacts[i];
        EXPECT_EQ(x.toc_lo, y.toc_lo);
        EXPECT_EQ(x.toc_hi, y.toc_hi);
        EXPECT_EQ(x.vertices, y.vertices);
        EXPECT_EQ(x.pos, y.pos);
        EXPECT_EQ(x.normal, y.normal);
      }
    }
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl
