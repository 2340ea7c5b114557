// SPDX-License-Identifier: BSD-3-Clause
//
// Close surfaces that slide along each other: what a plane, oriented boxes or a turn
// without effect leave out never changes an answer.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/capsule.h"
#include "fcl/geometry/shape/cone.h"
#include "fcl/geometry/shape/cylinder.h"
#include "fcl/geometry/shape/ellipsoid.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/bounded_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/continuous_features.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Vector = Vector3<double>;
using Pose3 = Transform3<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;

/// The mesh turned so that no direction of a box lies along it.
TestMesh tilted(TestMesh mesh) {
  const Matrix3<double> turn =
      AngleAxis<double>(0.7, Vector(1, 2, -1).normalized()).toRotationMatrix();
  for (auto& p : mesh.vertices) p = turn * p;
  return mesh;
}

/// The way along the tubes of tilted().
Vector alongTube(double length) {
  return tilted({{Vector(0, 0, length)}, {}}).vertices[0];
}

/// Every pair of features of a mesh that moves by a way and of one at rest, decided
/// alone.
std::map<ContactName, ContinuousFeatureTestResult<double>> allPairs(const TestMesh& a,
                                                                    const Vector& way,
                                                                    const TestMesh& b) {
  std::map<ContactName, ContinuousFeatureTestResult<double>> found;
  const auto at = [&](bool on_a, int frame, int v) -> Vector {
    const Vector& x = (on_a ? a : b).vertices[static_cast<std::size_t>(v)];
    return on_a && frame == 1 ? Vector(x + way) : x;
  };
  const auto areFar = [&](const std::array<int, 4>& v, const std::array<bool, 4>& on_a) {
    Eigen::AlignedBox3d box[2];
    for (std::size_t i = 0; i < 4; ++i)
      for (int frame : {0, 1}) box[on_a[i]].extend(at(on_a[i], frame, v[i]));
    return box[0].intersection(box[1]).isEmpty();
  };
  const auto test = [&](ContinuousContactKind kind, const std::array<int, 4>& v,
                        const std::array<bool, 4>& on_a) {
    if (areFar(v, on_a)) return;
    Vector p[2][4];
    for (int frame : {0, 1})
      for (std::size_t i = 0; i < 4; ++i) p[frame][i] = at(on_a[i], frame, v[i]);
    const auto& x = p[0];
    const auto& y = p[1];
    const auto result =
        kind == ContinuousContactKind::kVertexFace
            ? vertexFace<double>(x[0], x[1], x[2], x[3], y[0], y[1], y[2], y[3], 1e-6)
            : edgeEdge<double>(x[0], x[1], x[2], x[3], y[0], y[1], y[2], y[3], 1e-6);
    if (result.is_contact)
      found[{static_cast<int>(kind), on_a[0], {v[0], v[1], v[2], v[3], -1}}] = result;
  };
  for (const bool on_a : {true, false}) {
    const TestMesh &mine = on_a ? a : b, &other = on_a ? b : a;
    for (int v = 0; v < static_cast<int>(mine.vertices.size()); ++v)
      for (const Triangle& t : other.triangles)
        test(ContinuousContactKind::kVertexFace,
             {v, static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])},
             {on_a, !on_a, !on_a, !on_a});
  }
  for (const auto& x : uniqueEdges(a.triangles))
    for (const auto& y : uniqueEdges(b.triangles))
      test(ContinuousContactKind::kEdgeEdge, {x[0], x[1], y[0], y[1]},
           {true, true, false, false});
  return found;
}

/// The tubes of the tests that compare with all pairs, and of those that compare with a
/// motion class that tells little.
constexpr int kSlices = 24, kRings = 8, kSocketRings = kHasAddressSanitizer ? 4 : 8;

Request requestOf(ContinuousQuery query, double distance = 0) {
  Request request;
  request.query = query;
  request.toc_err = 1e-6;
  request.min_distance = distance;
  return request;
}

Result slide(const CollisionGeometry<double>& moving, const Vector& way,
             const CollisionGeometry<double>& still, const Request& request) {
  Pose3 end = Pose3::Identity();
  end.translation() = way;
  const Pose3 rest = Pose3::Identity();
  Result result;
  continuousCollide(&moving, rest, end, &still, rest, rest, request, result);
  return result;
}

/// The contacts of a mesh that slides, found by each kind of tree and of query, are those
/// of all pairs.
void expectAllPairs(const TestMesh& a, const Vector& way, const TestMesh& b,
                    std::size_t least_contacts) {
  const auto truth = allPairs(a, way, b);
  ASSERT_GE(truth.size(), least_contacts);
  if (least_contacts == 0) {
    ASSERT_TRUE(truth.empty());
  }
  double first = 1;
  for (const auto& [name, found] : truth) first = std::min(first, found.toc_hi);
  const auto boxes = makeModel<BVHModel<OBBRSS<double>>>(a);
  const auto still = makeModel<BVHModel<OBBRSS<double>>>(b);
  const auto slabs = makeModel<BVHModel<AABB<double>>>(a);
  const auto kept = makeModel<DeformableBVHModel<OBBRSS<double>>>(a, a);
  const auto kept_still = makeModel<DeformableBVHModel<OBBRSS<double>>>(b, b);
  for (const CollisionGeometry<double>* moving :
       {static_cast<const CollisionGeometry<double>*>(boxes.get()),
        static_cast<const CollisionGeometry<double>*>(slabs.get()),
        static_cast<const CollisionGeometry<double>*>(kept.get())})
    for (const CollisionGeometry<double>* other :
         {static_cast<const CollisionGeometry<double>*>(still.get()),
          static_cast<const CollisionGeometry<double>*>(kept_still.get())}) {
      const Result all = slide(*moving, way, *other, requestOf(ContinuousQuery::kAll));
      EXPECT_EQ(all.contacts.size(), truth.size());
      for (const auto& contact : all.contacts) {
        const auto same = truth.find(nameOf(contact));
        // The corners of a face may be in another order.
        if (same == truth.end()) continue;
        EXPECT_LE(contact.toc_lo, same->second.toc_hi);
        EXPECT_GE(contact.toc_hi, same->second.toc_lo);
      }
      for (const auto query : {ContinuousQuery::kFirst, ContinuousQuery::kAny}) {
        const Result result = slide(*moving, way, *other, requestOf(query));
        EXPECT_EQ(result.is_collide, !truth.empty());
        if (query == ContinuousQuery::kFirst) {
          EXPECT_LE(result.time_of_contact, first);
          EXPECT_GE(result.time_of_contact, first - 3e-6);
        }
      }
    }
}

TEST(FCL_SLIDING, tubesThatJustFit) {
  std::vector<double> gaps = {1e-6, 1e-2, 1e-9};
  if (kHasAddressSanitizer) gaps.resize(1);
  for (const double gap : gaps) {
    SCOPED_TRACE(gap);
    const TestMesh hole = tilted(makeRoundTube(
        kSlices, kRings, [&](double, double) { return holeRadius(kSlices); }));
    const TestMesh inner =
        tilted(makeRoundTube(kSlices, kRings, [&](double, double) { return 1 - gap; }));
    expectAllPairs(inner, alongTube(0.5), hole, 0);
  }
}

TEST(FCL_SLIDING, tubesThatTouchSomewhere) {
  const TestMesh hole = tilted(makeRoundTube(
      kSlices, kRings, [&](double, double) { return holeRadius(kSlices); }));
  // A ring that stands out by more than the gap, on one side.
  const TestMesh inner =
      tilted(makeRoundTube(kSlices, kRings, [&](double angle, double z) {
        return 0.998 + (std::abs(z) < 0.1 && std::abs(angle - 2) < 0.5 ? 0.03 : 0);
      }));
  expectAllPairs(inner, alongTube(0.5), hole, 10);
  // A hole that becomes narrow further on, a tube that does not reach it, and one that
  // does.
  const TestMesh funnel = tilted(makeRoundTube(kSlices, kRings, [&](double, double z) {
    return holeRadius(kSlices) - (z > 0.9 ? 0.02 : 0);
  }));
  const TestMesh plug = tilted(moved(
      makeRoundTube(kSlices, kRings, [&](double, double) { return 0.999; }), 0, 0, -1));
  expectAllPairs(plug, alongTube(0.74), funnel, 0);
  expectAllPairs(plug, alongTube(1), funnel, 10);
}

/// The triangle pairs that remain are few, whichever stage leaves the others out.
TEST(FCL_SLIDING, fewPairsRemain) {
  const int slices = 120, rings = 40;
  const TestMesh hole = tilted(
      makeRoundTube(slices, rings, [&](double, double) { return holeRadius(slices); }));
  const TestMesh inner =
      tilted(makeRoundTube(slices, rings, [&](double, double) { return 0.99; }));
  const auto boxes = makeModel<BVHModel<OBBRSS<double>>>(inner);
  const auto still = makeModel<BVHModel<OBBRSS<double>>>(hole);
  for (const double distance : {0., 1e-6}) {
    const Result result =
        slide(*boxes, alongTube(0.5), *still, requestOf(ContinuousQuery::kAll, distance));
    EXPECT_FALSE(result.is_collide);
    EXPECT_LT(result.counts.triangle_pairs, 4 * inner.triangles.size());
    EXPECT_LT(result.counts.feature_pairs, inner.triangles.size());
  }
  const auto kept = makeModel<DeformableBVHModel<OBBRSS<double>>>(inner, inner);
  const Result result =
      slide(*kept, alongTube(0.5), *still, requestOf(ContinuousQuery::kAll));
  EXPECT_FALSE(result.is_collide);
  EXPECT_GT(result.counts.plane_culled, result.counts.triangle_pairs / 2);
}

/// Candidates and the query see the same pairs, and threads change nothing.
TEST(FCL_SLIDING, sameCountsWithThreads) {
  const TestMesh hole =
      tilted(makeRoundTube(60, 30, [&](double, double) { return holeRadius(60); }));
  const TestMesh inner = tilted(makeRoundTube(60, 30, [&](double angle, double z) {
    return 0.998 + (std::abs(z) < 0.1 && std::abs(angle - 2) < 0.2 ? 0.01 : 0);
  }));
  const auto boxes = makeModel<BVHModel<OBBRSS<double>>>(inner);
  const auto still = makeModel<BVHModel<OBBRSS<double>>>(hole);
  Request request = requestOf(ContinuousQuery::kAll);
  const Result one = slide(*boxes, alongTube(0.5), *still, request);
  EXPECT_GT(one.contacts.size(), 10U);
  for (const int threads : {2, 4}) {
    request.num_threads = threads;
    const Result several = slide(*boxes, alongTube(0.5), *still, request);
    expectIdentical(several, one);
    EXPECT_EQ(several.counts.node_pairs, one.counts.node_pairs);
    EXPECT_EQ(several.counts.feature_pairs, one.counts.feature_pairs);
  }
}

/// Turns about an axis through a point at constant speed and slides along it: the same
/// path as a ScrewMotion, of a class that tells only its bounds.
class Screw : public MotionBase<double>, public BoundedMotion {
 public:
  Screw(const Pose3& start, const Vector& axis, const Vector& point, double angle,
        double way)
      : start_(start), axis_(axis), point_(point), angle_(angle), way_(way) {}

  Pose3 at(double t) const {
    Pose3 out = start_;
    const Matrix3<double> turn = AngleAxis<double>(t * angle_, axis_).toRotationMatrix();
    out.linear() = turn * start_.linear();
    out.translation() =
        turn * (start_.translation() - point_) + point_ + t * way_ * axis_;
    return out;
  }
  Placement placementAt(double t) const override {
    return placementOf(at(t).linear(), at(t).translation());
  }
  Placement rateAt(double t) const override {
    Matrix3<double> cross;
    cross << 0, -axis_[2], axis_[1], axis_[2], 0, -axis_[0], -axis_[1], axis_[0], 0;
    return placementOf(angle_ * cross * at(t).linear(),
                       angle_ * cross * (at(t).translation() - point_) + way_ * axis_);
  }
  double accelerationBound(const double (&center)[3], double radius, double,
                           double) const override {
    return angle_ * angle_ *
           (Vector(center).norm() + radius + (start_.translation() - point_).norm()) *
           (1 + 1e-12);
  }
  double angularSpeedBound(double, double) const override { return std::abs(angle_); }
  bool integrate(double t) const override {
    t_ = t;
    return true;
  }
  double computeMotionBound(const BVMotionBoundVisitor<double>&) const override {
    return 1e3;
  }
  double computeMotionBound(const TriangleMotionBoundVisitor<double>&) const override {
    return 1e3;
  }
  void getCurrentTransform(Pose3& tf) const override { tf = at(t_); }
  void getTaylorModel(TMatrix3<double>&, TVector3<double>&) const override {}

 private:
  static Placement placementOf(const Matrix3<double>& r, const Vector& x) {
    Placement out;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) out.rotation[3 * i + k] = r(i, k);
      out.translation[i] = x[i];
    }
    return out;
  }
  Pose3 start_;
  Vector axis_, point_;
  double angle_, way_;
  mutable double t_{0};
};

/// A round shape and a mesh around it. The turn of either of them about the axis of the
/// shape changes nothing; a turn about another axis does.
struct Socket {
  std::string name;
  std::shared_ptr<CollisionGeometry<double>> shape;
  std::function<double(double, double)> radius;
};

std::vector<Socket> sockets(double clearance) {
  const double hole = holeRadius(kSlices) + clearance;
  std::vector<Socket> out;
  out.push_back({"cylinder", std::make_shared<Cylinder<double>>(1, 1.8),
                 [hole](double, double) { return hole; }});
  out.push_back({"capsule", std::make_shared<Capsule<double>>(1, 0.6),
                 [hole](double, double) { return hole; }});
  out.push_back({"cone", std::make_shared<Cone<double>>(1, 2),
                 [hole](double, double z) { return hole * (0.5 - 0.5 * z) + 1e-3; }});
  out.push_back({"ellipsoid", std::make_shared<Ellipsoid<double>>(1, 1, 1.4),
                 [hole](double, double) { return hole; }});
  out.push_back({"sphere", std::make_shared<Sphere<double>>(1),
                 [hole](double, double) { return hole; }});
  return out;
}

/// With FCL's motion, whose turn is seen to change nothing, and with the motion class
/// that tells only its bounds.
void expectSameAnswers(const Socket& socket, bool shape_turns, const Vector& axis,
                       const Vector& point, double angle, double way) {
  const auto mesh = makeModel<BVHModel<OBBRSS<double>>>(
      makeRoundTube(kSlices, kSocketRings, socket.radius));
  const Screw bounded(Pose3::Identity(), axis, point, angle, way);
  const ScrewMotion<double> screw(bounded.at(0), bounded.at(1));
  const TranslationMotion<double> rest(Pose3::Identity(), Pose3::Identity());
  for (const auto query : {ContinuousQuery::kAll, ContinuousQuery::kFirst}) {
    Result results[2];
    for (const bool is_bounded : {false, true}) {
      const MotionBase<double>* const moving =
          is_bounded ? static_cast<const MotionBase<double>*>(&bounded) : &screw;
      const Request request = requestOf(query);
      if (shape_turns)
        continuousCollide(socket.shape.get(), moving, mesh.get(), &rest, request,
                          results[is_bounded]);
      else
        continuousCollide(mesh.get(), moving, socket.shape.get(), &rest, request,
                          results[is_bounded]);
    }
    const Result &fast = results[0], &slow = results[1];
    ASSERT_EQ(fast.is_collide, slow.is_collide);
    EXPECT_NEAR(fast.time_of_contact, slow.time_of_contact, 1e-5);
    if (query == ContinuousQuery::kAll) {
      ASSERT_EQ(fast.contacts.size(), slow.contacts.size());
      std::map<std::intptr_t, double> times;
      for (const auto& c : slow.contacts) times[shape_turns ? c.b2 : c.b1] = c.toc_lo;
      for (const auto& c : fast.contacts) {
        const auto same = times.find(shape_turns ? c.b2 : c.b1);
        ASSERT_NE(same, times.end());
        EXPECT_NEAR(c.toc_lo, same->second, 1e-5);
      }
    }
  }
}

TEST(FCL_SLIDING, turnOfARoundShape) {
  const Vector z = Vector::UnitZ(), other = Vector(0.02, -0.01, 1).normalized(),
               at = Vector::Zero(), aside(0.05, 0, 0);
  for (const double clearance : {1e-2, -1e-4})
    for (const Socket& socket : sockets(clearance))
      for (const bool shape_turns : {true, false}) {
        if (kHasAddressSanitizer && shape_turns != (clearance > 0)) continue;
        SCOPED_TRACE(socket.name + (shape_turns ? " turns, " : " rests, ") +
                     std::to_string(clearance));
        expectSameAnswers(socket, shape_turns, z, at, 1, 0);
        expectSameAnswers(socket, shape_turns, -z, at, 1, -0.3);
        expectSameAnswers(socket, shape_turns, other, at, 1, 0.1);
        expectSameAnswers(socket, shape_turns, z, aside, 1, 0.1);
        ASSERT_FALSE(HasFailure());
      }
}

TEST(FCL_SLIDING, turnOfARoundShapeTakesNoWork) {
  for (const Socket& socket : sockets(1e-3)) {
    SCOPED_TRACE(socket.name);
    const auto mesh = makeModel<BVHModel<OBBRSS<double>>>(
        makeRoundTube(kSlices, kSocketRings, socket.radius));
    const Screw path(Pose3::Identity(), Vector::UnitZ(), Vector::Zero(), 1.5, 0);
    const ScrewMotion<double> turning(path.at(0), path.at(1));
    const TranslationMotion<double> rest(Pose3::Identity(), Pose3::Identity());
    const Request request = requestOf(ContinuousQuery::kAll);
    const auto workOf = [&](const MotionBase<double>& of_shape,
                            const MotionBase<double>& of_mesh) {
      Result result;
      continuousCollide(socket.shape.get(), &of_shape, mesh.get(), &of_mesh, request,
                        result);
      EXPECT_FALSE(result.is_collide);
      return result.counts.node_pairs;
    };
    const auto at_rest = workOf(rest, rest);
    EXPECT_LE(workOf(turning, rest), at_rest + at_rest / 4);
    EXPECT_LE(workOf(rest, turning), at_rest + at_rest / 4);
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl
