// SPDX-License-Identifier: BSD-3-Clause
//
// Makes every call that takes or returns a type of FCL whose alignment depends on the
// compiler's flags. It is built with other flags than the library. If such a type crossed
// the border, answers would be wrong or the program would crash.
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include <fcl/common/exception.h>
#include <fcl/geometry/bvh/deformable_bvh_model.h>
#include <fcl/geometry/compound_geometry.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/screw_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/continuous_candidates.h>
#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/continuous_distance.h>
#include <fcl/narrowphase/continuous_feature_test.h>
#include <fcl/narrowphase/detail/traversal/collision/deformable_continuous_collision_traversal_node.h>
#include <fcl/narrowphase/detail/traversal/collision_node.h>
#include <fcl/narrowphase/distance.h>
#include <fcl/narrowphase/safe_displacements.h>

namespace {

int failures = 0;

void expect(bool holds, const char* type, const char* what) {
  if (holds) return;
  std::printf("FAILED  %s, %s\n", type, what);
  ++failures;
}

template <typename S>
fcl::Transform3<S> at(S x, S y, S z) {
  fcl::Transform3<S> tf = fcl::Transform3<S>::Identity();
  tf.translation() = fcl::Vector3<S>(x, y, z);
  return tf;
}

/// A square of side 2 in z = 0.
template <typename Model>
std::shared_ptr<Model> makeSquare() {
  using Vector = fcl::Vector3<typename Model::S>;
  auto model = std::make_shared<Model>();
  model->beginModel();
  model->addSubModel(
      {Vector(-1, -1, 0), Vector(1, -1, 0), Vector(1, 1, 0), Vector(-1, 1, 0)},
      {fcl::Triangle(0, 1, 2), fcl::Triangle(0, 2, 3)});
  model->endModel();
  model->computeLocalAABB();
  return model;
}

template <typename S>
class Checks {
 public:
  explicit Checks(const char* type) : type_(type) {}

  void run() {
    distances();
    pairs<fcl::ContinuousCollisionRequest<S>, fcl::ContinuousCollisionResult<S>>();
    pairs<fcl::ContinuousContactRequest<S>, fcl::ContinuousContactResult<S>>();
    self<fcl::ContinuousCollisionRequest<S>, fcl::ContinuousCollisionResult<S>>();
    self<fcl::ContinuousContactRequest<S>, fcl::ContinuousContactResult<S>>();
    compound();
    ownMotion();
    contacts();
    candidates();
    safeDisplacements();
    leastDistances();
    features();
    node();
    discrete();
    shapes();
    turns();
    exceptions();
  }

 private:
  /// A program may derive from the model.
  struct Model : fcl::DeformableBVHModel<fcl::OBBRSS<S>> {};
  using Vector = fcl::Vector3<S>;
  using Transform = fcl::Transform3<S>;

  void check(bool holds, const char* what) { expect(holds, type_, what); }

  /// The moving square goes from z = 3 to z = -5: it meets the other at t = 0.375, and is
  /// at or just below it at the pose of contact. The field behind it has to be right too.
  template <typename Result>
  void checkFall(S time, const Result& result, const char* what) {
    check(result.is_collide && result.time_of_contact == time, what);
    check(time <= S(0.375) && time > S(0.3748), what);
    check(result.contact_tf1.isApprox(Transform::Identity(), 0), what);
    const Vector p = result.contact_tf2.translation();
    check(result.contact_tf2.linear().isApprox(Transform::Identity().linear(), 0), what);
    check(p[0] == S(0.25) && p[1] == S(0.5) && p[2] <= 0 && p[2] > S(-0.002), what);
  }

  /// The lower one of two squares that fall together meets the other one.
  void compound() {
    const auto rest = makeSquare<fcl::BVHModel<fcl::OBBRSS<S>>>(),
               fall = makeSquare<fcl::BVHModel<fcl::OBBRSS<S>>>();
    fcl::CompoundGeometry<S> both;
    both.addPart(fall, at<double>(0, 0, 4));
    both.addPart(fall);
    const Transform still = at<S>(0, 0, 0);
    fcl::ContinuousContactResult<S> result;
    const S time = fcl::continuousCollide(rest.get(), still, still, &both,
                                          at<S>(.25, .5, 3), at<S>(.25, .5, -5),
                                          fcl::ContinuousContactRequest<S>(), result);
    checkFall(time, result, "continuousCollide(compound)");
    check(result.contacts.at(0).part1 == -1 && result.contacts[0].part2 == 1,
          "part of a compound");
  }

  template <typename Request, typename Result>
  void pairs() {
    const auto rest = makeSquare<fcl::BVHModel<fcl::OBBRSS<S>>>(),
               fall = makeSquare<fcl::BVHModel<fcl::OBBRSS<S>>>();
    const Transform still = at<S>(0, 0, 0), beg = at<S>(.25, .5, 3),
                    end = at<S>(.25, .5, -5);
    const Request request;
    {
      Result result;
      const S time = fcl::continuousCollide(rest.get(), still, still, fall.get(), beg,
                                            end, request, result);
      checkFall(time, result, "continuousCollide(transforms)");
    }
    {
      const fcl::CollisionObject<S> o1(rest, still), o2(fall, beg);
      Result result;
      const S time = fcl::continuousCollide(&o1, still, &o2, end, request, result);
      checkFall(time, result, "continuousCollide(objects)");
    }
    {
      const auto o1 = std::make_shared<fcl::CollisionObject<S>>(rest),
                 o2 = std::make_shared<fcl::CollisionObject<S>>(fall, beg.linear(),
                                                                beg.translation());
      Result result;
      const S time =
          fcl::continuousCollide(o1.get(), still, o2.get(), end, request, result);
      checkFall(time, result, "continuousCollide(objects on the heap)");
    }
    const auto m1 = std::make_shared<fcl::TranslationMotion<S>>(still, still),
               m2 = std::make_shared<fcl::TranslationMotion<S>>(beg, end);
    {
      Result result;
      const S time = fcl::continuousCollide(rest.get(), m1.get(), fall.get(), m2.get(),
                                            request, result);
      checkFall(time, result, "continuousCollide(translations)");
    }
    {
      fcl::ContinuousCollisionObject<S> o1(rest, m1), o2(fall, m2);
      Result result;
      checkFall(fcl::collide(&o1, &o2, request, result), result,
                "collide(continuous objects)");
    }
    doubleMotions<Request, Result>(rest, fall, beg, end, S());
  }

  template <typename Request, typename Result, typename Pointer>
  void doubleMotions(const Pointer&, const Pointer&, const Transform&, const Transform&,
                     float) {}

  /// In float FCL's other motions are abstract.
  template <typename Request, typename Result, typename Pointer>
  void doubleMotions(const Pointer& rest, const Pointer& fall, const Transform& beg,
                     const Transform& end, double) {
    const Transform still = at<S>(0, 0, 0);
    const auto try_motions = [&](const fcl::MotionBase<S>& m1,
                                 const fcl::MotionBase<S>& m2, const char* what) {
      Result result;
      const S time =
          fcl::continuousCollide(rest.get(), &m1, fall.get(), &m2, Request(), result);
      checkFall(time, result, what);
    };
    const auto i1 = std::make_shared<fcl::InterpMotion<S>>(still, still),
               i2 = std::make_shared<fcl::InterpMotion<S>>(beg, end);
    try_motions(*i1, *i2, "continuousCollide(interpolations)");
    const auto s1 = std::make_shared<fcl::ScrewMotion<S>>(still, still),
               s2 = std::make_shared<fcl::ScrewMotion<S>>(beg, end);
    try_motions(*s1, *s2, "continuousCollide(screws)");
  }

  /// A motion class of the program. Only a mesh that deforms follows it in this test.
  class Fall : public fcl::MotionBase<S> {
   public:
    bool integrate(S t) const override {
      tf_ = at<S>(S(.25), S(.5), 3 - 8 * t);
      return true;
    }
    S computeMotionBound(const fcl::BVMotionBoundVisitor<S>&) const override { return 8; }
    S computeMotionBound(const fcl::TriangleMotionBoundVisitor<S>&) const override {
      return 8;
    }
    void getCurrentTransform(Transform& tf) const override { tf = tf_; }
    void getTaylorModel(fcl::TMatrix3<S>&, fcl::TVector3<S>&) const override {}

   private:
    mutable Transform tf_{Transform::Identity()};
  };

  void ownMotion() {
    const auto rest = makeSquare<Model>(), fall = makeSquare<Model>();
    std::vector<Vector> corners(fall->vertices, fall->vertices + 4);
    corners[0][0] = -2;
    fall->beginUpdateModel();
    fall->updateSubModel(corners);
    fall->endUpdateModel();
    const fcl::TranslationMotion<S> still(at<S>(0, 0, 0), at<S>(0, 0, 0));
    const auto falling = std::make_shared<Fall>();
    fcl::ContinuousCollisionResult<S> result;
    const S time = fcl::continuousCollide(rest.get(), &still, fall.get(), falling.get(),
                                          fcl::ContinuousCollisionRequest<S>(), result);
    checkFall(time, result, "continuousCollide(a motion of the program's own)");
  }

  /// Corner 3 folds through the rest of its mesh at half of the step.
  std::shared_ptr<Model> makeFold() {
    auto fold = std::make_shared<Model>();
    std::vector<Vector> points{Vector(0, 0, 0), Vector(4, 0, 0), Vector(0, 4, 0),
                               Vector(1, 1, 1), Vector(9, 1, 1), Vector(9, 2, 1)};
    fold->beginModel();
    fold->addSubModel(points, {fcl::Triangle(0, 1, 2), fcl::Triangle(3, 4, 5)});
    fold->endModel();
    points[3][2] = -1;
    fold->beginUpdateModel();
    fold->updateSubModel(points);
    fold->endUpdateModel();
    return fold;
  }

  template <typename Request, typename Result>
  void self() {
    Result result;
    const S time = fcl::continuousSelfCollide(makeFold().get(), Request(), result);
    check(result.is_collide && time <= S(.5) && time > S(.4998), "continuousSelfCollide");
    check(result.contact_tf1.isApprox(Transform::Identity(), 0), "continuousSelfCollide");
  }

  void contacts() {
    fcl::ContinuousContactResult<S> result;
    const auto fold = makeFold();
    fcl::continuousSelfCollide(fold.get(), fcl::ContinuousContactRequest<S>(), result);
    bool found = false;
    for (const auto& contact : result.contacts)
      found |= contact.kind == fcl::ContinuousContactKind::kVertexFace &&
               contact.vertices[0] == 3 && contact.o1 == fold.get() &&
               (contact.pos - Vector(1, 1, 0)).norm() < S(1e-3) &&
               std::abs(contact.normal[2]) > S(.999);
    check(found && !result.contacts_cut && !result.initially_crossing &&
              result.counts.contacts == result.contacts.size(),
          "contacts");
  }

  void candidates() {
    bool found = false;
    fcl::continuousSelfCandidates(
        makeFold().get(), [&](const fcl::ContinuousCandidate* pairs, std::size_t count) {
          for (std::size_t i = 0; i < count; ++i) found |= pairs[i].vertices[0] == 3;
          return true;
        });
    check(found, "continuousSelfCandidates");
    const auto rest = makeSquare<Model>(), fall = makeSquare<Model>();
    std::size_t total = 0;
    fcl::continuousCandidates(rest.get(), at<S>(0, 0, 0), at<S>(0, 0, 0), fall.get(),
                              at<S>(0, 0, 3), at<S>(0, 0, -5),
                              [&](const fcl::ContinuousCandidate*, std::size_t count) {
                                total += count;
                                return true;
                              });
    check(total > 0, "continuousCandidates");
  }

  void safeDisplacements() {
    const auto rest = makeSquare<Model>(), above = makeSquare<Model>();
    // A corner and the triangle across are a diagonal's half, the root of 2, apart.
    check(std::abs(fcl::safeSelfDisplacements(rest.get(), 9)[0] - std::sqrt(0.5)) < 1e-6,
          "safeSelfDisplacements");
    const fcl::SafeDisplacements bounds = fcl::safeDisplacements(
        rest.get(), at<S>(0, 0, 0), above.get(), at<S>(0, 0, 3), 9, 1);
    check(std::abs(bounds.of_o1[0] - 1) < 1e-6 && std::abs(bounds.of_o2[0] - 1) < 1e-6,
          "safeDisplacements");
  }

  void leastDistances() {
    const auto rest = makeSquare<Model>(), fall = makeSquare<Model>();
    const auto from = at<S>(0, 0, 3), to = at<S>(0, 0, 1), still = at<S>(0, 0, 0);
    const auto checkResult = [&](const fcl::ContinuousDistanceResult<S>& result) {
      check(!result.is_collide && result.distance_lo <= 1 && result.distance_hi >= 1 &&
                result.time == 1,
            "continuousDistance");
    };
    const fcl::ContinuousDistanceRequest<S> request;
    fcl::ContinuousDistanceResult<S> result;
    fcl::continuousDistance(rest.get(), still, still, fall.get(), from, to, request,
                            result);
    checkResult(result);
    const fcl::TranslationMotion<S> no_motion(still, still), falling(from, to);
    result = {};
    fcl::continuousDistance(rest.get(), &no_motion, fall.get(), &falling, request,
                            result);
    checkResult(result);
    const fcl::CollisionObject<S> o1(rest, still), o2(fall, from);
    result = {};
    fcl::continuousDistance(&o1, still, &o2, to, request, result);
    checkResult(result);
  }

  void features() {
    const Vector f0(0, 0, 0), f1(4, 0, 0), f2(0, 4, 0), v(1, 1, 3), v_t1(1, 1, -5);
    const auto vf = fcl::vertexFace<S>(v, f0, f1, f2, v_t1, f0, f1, f2, 1e-6);
    check(vf.is_contact && vf.toc_lo <= S(.375) && vf.toc_hi >= S(.375), "vertexFace");
    const Vector a0(-1, 0, 3), a1(1, 0, 3), b0(0, -1, 0), b1(0, 1, 0);
    const auto ee = fcl::edgeEdge<S>(a0, a1, b0, b1, Vector(-1, 0, -5), Vector(1, 0, -5),
                                     b0, b1, 1e-6);
    check(ee.is_contact && ee.toc_lo <= S(.375) && ee.toc_hi >= S(.375), "edgeEdge");
  }

  void node() {
    const auto rest = makeSquare<Model>(), fall = makeSquare<Model>();
    const auto node =
        std::make_shared<fcl::detail::DeformableContinuousCollisionTraversalNode<S>>();
    fcl::CollisionRequest<S> request;
    request.num_max_contacts = 100;
    request.enable_contact = true;
    fcl::CollisionResult<S> result;
    check(fcl::detail::initialize(*node, *rest, at<S>(0, 0, 0), at<S>(0, 0, 0), *fall,
                                  at<S>(.25, .5, 3), at<S>(.25, .5, -5), request, result),
          "initialize(node)");
    fcl::detail::collide<S>(node.get());
    check(result.isCollision() && node->time_of_contact <= S(.375) &&
              node->time_of_contact > S(.3748) && node->request.num_max_contacts == 100,
          "collide(node)");
    fcl::CollisionResult<S> self_result;
    const auto fold = makeFold();
    check(fcl::detail::initialize(*node, *fold, request, self_result),
          "initialize(node, self)");
    fcl::detail::selfCollide<S>(node.get());
    check(self_result.isCollision() && node->time_of_contact <= S(.5) &&
              node->time_of_contact > S(.4998),
          "selfCollide(node)");
  }

  void discrete() {
    const auto square = makeSquare<Model>();
    const auto ball = std::make_shared<fcl::Sphere<S>>(S(.5));
    const fcl::CollisionRequest<S> request;
    fcl::CollisionResult<S> hit, miss;
    check(fcl::collide(square.get(), at<S>(0, 0, 0), ball.get(), at<S>(0, 0, S(.4)),
                       request, hit) > 0,
          "collide()");
    check(fcl::collide(square.get(), at<S>(0, 0, 0), ball.get(), at<S>(0, 0, S(.6)),
                       request, miss) == 0,
          "collide()");
  }

  void distances() {
    const auto sphere = std::make_shared<fcl::Sphere<S>>(S(1));
    const auto box = std::make_shared<fcl::Box<S>>(S(1), S(1), S(1));
    const fcl::DistanceRequest<S> request;
    {
      fcl::DistanceResult<S> result;
      const S d = fcl::distance(sphere.get(), at<S>(0, 0, S(5.13)), box.get(),
                                at<S>(0, 0, 0), request, result);
      check(std::abs(d - S(3.63)) < S(1e-4), "distance(geometries)");
    }
    {
      const auto o1 =
          std::make_shared<fcl::CollisionObject<S>>(sphere, at<S>(0, 0, S(5.13)));
      const auto o2 = std::make_shared<fcl::CollisionObject<S>>(box);
      fcl::DistanceResult<S> result;
      const S d = fcl::distance(o1.get(), o2.get(), request, result);
      check(std::abs(d - S(3.63)) < S(1e-4), "distance(objects)");
    }
  }

  void shapes() {
    const auto ball = std::make_shared<fcl::Sphere<S>>(S(1));
    fcl::ContinuousCollisionRequest<S> request;
    fcl::ContinuousCollisionResult<S> result;
    const S time =
        fcl::continuousCollide(ball.get(), at<S>(0, 0, 0), at<S>(0, 0, 0), ball.get(),
                               at<S>(0, 0, 6), at<S>(0, 0, -2), request, result);
    check(result.is_collide && std::abs(time - S(.5)) < S(1e-5), "shapes");
    const S z = result.contact_tf2.translation()[2];
    check(std::abs(z - (6 - 8 * time)) < S(1e-3), "pose of shapes");
    check(result.contact_tf1.isApprox(Transform::Identity(), 0), "pose of shapes");
  }

  /// A square turns by a right angle about the x axis and meets an edge that lies below
  /// 45 degrees of it, half way.
  void turns() {
    const auto flap = makeSquare<fcl::BVHModel<fcl::OBBRSS<S>>>(),
               wall = makeSquare<fcl::BVHModel<fcl::OBBRSS<S>>>();
    const Transform still = at<S>(0, 0, 0);
    Transform end = still, upright = at<S>(0, S(.5), S(1.5));
    end.linear() = turn(S(1.5707963267948966));
    upright.linear() = turn(S(1.5707963267948966));
    fcl::ContinuousContactRequest<S> request;
    fcl::ContinuousContactResult<S> result;
    S time = fcl::continuousCollide(flap.get(), still, end, wall.get(), upright, upright,
                                    request, result);
    checkTurn(time, result, "turn between transforms");
    check(!result.contacts.empty(), "contacts of a turn");
    const Vector zero = Vector::Zero(), x = S(1.5707963267948966) * Vector::UnitX();
    const auto spline = std::make_shared<fcl::SplineMotion<S>>(zero, zero, zero, zero, -x,
                                                               zero, x, 2 * x);
    const auto rest = std::make_shared<fcl::TranslationMotion<S>>(upright, upright);
    time = fcl::continuousCollide(flap.get(), spline.get(), wall.get(), rest.get(),
                                  request, result);
    checkTurn(time, result, "spline");
    checkInterpolation(*flap, end, *wall, *rest, S());
  }

  static fcl::Matrix3<S> turn(S angle) {
    return Eigen::AngleAxis<S>(angle, Vector::UnitX()).toRotationMatrix();
  }

  template <typename Result>
  void checkTurn(S time, const Result& result, const char* what) {
    check(result.is_collide && std::abs(time - S(.5)) < S(1e-5), what);
    const S tip = result.contact_tf1.linear()(2, 1);
    check(std::abs(tip - S(.70711)) < S(1e-3), what);
  }

  template <typename Mesh, typename Motion>
  void checkInterpolation(const Mesh&, const Transform&, const Mesh&, const Motion&,
                          float) {}

  template <typename Mesh, typename Motion>
  void checkInterpolation(const Mesh& flap, const Transform& end, const Mesh& wall,
                          const Motion& rest, double) {
    const auto motion = std::make_shared<fcl::InterpMotion<S>>(
        Transform::Identity().linear(), Vector::Zero(), end.linear(), Vector::Zero(),
        Vector::Zero());
    fcl::ContinuousCollisionResult<S> result;
    const S time = fcl::continuousCollide(&flap, motion.get(), &wall, &rest,
                                          fcl::ContinuousCollisionRequest<S>(), result);
    checkTurn(time, result, "interpolation");
  }

  /// The program catches the exceptions of the library.
  void exceptions() {
    fcl::ContinuousCollisionRequest<S> request;
    request.toc_err = -1;
    fcl::ContinuousCollisionResult<S> result;
    bool caught = false;
    try {
      fcl::continuousSelfCollide(makeFold().get(), request, result);
    } catch (const fcl::Exception&) {
      caught = true;
    }
    check(caught, "exceptions");
  }

  const char* type_;
};

}  // namespace

int main() {
#ifndef FCL_CCD_ONLY_FLOAT
  Checks<double>("double").run();
#endif
#ifndef FCL_CCD_ONLY_DOUBLE
  Checks<float>("float").run();
#endif
  std::printf("%s  every overload\n", failures == 0 ? "ok    " : "FAILED");
  return failures == 0 ? 0 : 1;
}
