// SPDX-License-Identifier: BSD-3-Clause
//
// A program that is compiled with -fno-rtti: each class of motion, and geometries whose
// classes the program compiles, without typeinfo.
#include <cmath>
#include <cstdio>
#include <memory>
#include <type_traits>

#include <fcl/fcl.h>
#if __cplusplus >= 201703L
#include <fcl/broadphase/continuous_collision_manager.h>
#include <fcl/geometry/bvh/deformable_bvh_model.h>
#include <fcl/narrowphase/continuous_candidates.h>
#include <fcl/narrowphase/safe_displacements.h>
#endif

namespace {

int failures = 0;

void expect(bool holds, const char* what) {
  if (holds) return;
  std::printf("FAILED  %s\n", what);
  ++failures;
}

template <typename S>
fcl::Transform3<S> at(S x, S y, S z) {
  fcl::Transform3<S> tf = fcl::Transform3<S>::Identity();
  tf.translation() = fcl::Vector3<S>(x, y, z);
  return tf;
}

template <typename S>
fcl::Transform3<S> turned(S angle) {
  fcl::Transform3<S> tf = fcl::Transform3<S>::Identity();
  tf.linear() = Eigen::AngleAxis<S>(angle, fcl::Vector3<S>::UnitX()).toRotationMatrix();
  return tf;
}

/// A square of side 2 in z = 0.
template <typename Model>
std::shared_ptr<Model> makeSquare() {
  using Vector = fcl::Vector3<typename Model::S>;
  auto model = std::make_shared<Model>();
  model->beginModel();
  model->addTriangle(Vector(-1, -1, 0), Vector(1, -1, 0), Vector(1, 1, 0));
  model->addTriangle(Vector(-1, -1, 0), Vector(1, 1, 0), Vector(-1, 1, 0));
  model->endModel();
  model->computeLocalAABB();
  return model;
}

/// A motion class of the program, which FCL answers.
template <typename S>
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
  void getCurrentTransform(fcl::Transform3<S>& tf) const override { tf = tf_; }
  void getTaylorModel(fcl::TMatrix3<S>&, fcl::TVector3<S>&) const override {}

 private:
  mutable fcl::Transform3<S> tf_{fcl::Transform3<S>::Identity()};
};

/// Derived from one of FCL's, it moves differently.
template <typename S>
class Still : public fcl::TranslationMotion<S> {
 public:
  Still() : fcl::TranslationMotion<S>(at<S>(0, 0, 9), at<S>(0, 0, 9)) {}
  void getCurrentTransform(fcl::Transform3<S>& tf) const override { tf = at<S>(0, 0, 9); }
};

template <typename S>
class Checks {
 public:
  using Model = fcl::BVHModel<fcl::OBBRSS<S>>;
  using Vector = fcl::Vector3<S>;

  /// The square falls from z = 3 to z = -5 through the other: at .375, which FCL's
  /// samples miss.
  void translations() const {
    const fcl::TranslationMotion<S> still(at<S>(0, 0, 0), at<S>(0, 0, 0)),
        fall(at<S>(0, 0, 3), at<S>(0, 0, -5));
    expectTime(still, fall, S(.375), "translation");
    const auto rest = makeSquare<Model>();
    fcl::ContinuousCollisionResult<S> result;
    const S time = fcl::continuousCollide(rest.get(), at<S>(0, 0, 0), at<S>(0, 0, 0),
                                          rest.get(), at<S>(0, 0, 3), at<S>(0, 0, -5),
                                          fcl::ContinuousCollisionRequest<S>(), result);
    expect(std::abs(time - S(.375)) < S(1e-3), "transforms");
  }

  /// A square turns by a right angle about x and meets an edge at half of the step.
  void spline() const {
    const Vector zero = Vector::Zero(), x = S(1.5707963267948966) * Vector::UnitX();
    const fcl::SplineMotion<S> turn(zero, zero, zero, zero, -x, zero, x, 2 * x);
    expectTime(turn, upright(), S(.5), "spline");
  }

  fcl::TranslationMotion<S> upright() const {
    fcl::Transform3<S> tf = turned(S(1.5707963267948966));
    tf.translation() = Vector(0, S(.5), S(1.5));
    return fcl::TranslationMotion<S>(tf, tf);
  }

  void ownMotions() const {
    const fcl::TranslationMotion<S> still(at<S>(0, 0, 0), at<S>(0, 0, 0));
    fcl::ContinuousCollisionResult<S> result;
    const auto square = makeSquare<Model>();
    fcl::continuousCollide(square.get(), &still, square.get(), &derived_,
                           fcl::ContinuousCollisionRequest<S>(), result);
    expect(!result.is_collide, "a class derived from FCL's");
    const fcl::Box<S> box(2, 2, 2);
    fcl::continuousCollide(&box, &still, square.get(), &fall_,
                           fcl::ContinuousCollisionRequest<S>(), result);
    expect(result.is_collide, "a motion class of the program");
  }

  void expectTime(const fcl::MotionBase<S>& m1, const fcl::MotionBase<S>& m2, S wanted,
                  const char* what) const {
    const auto o1 = makeSquare<Model>(), o2 = makeSquare<Model>();
    fcl::ContinuousCollisionResult<S> result;
    const S time = fcl::continuousCollide(o1.get(), &m1, o2.get(), &m2,
                                          fcl::ContinuousCollisionRequest<S>(), result);
    expect(result.is_collide && std::abs(time - wanted) < S(1e-3), what);
  }

#if __cplusplus >= 201703L
  void models() const {
    using Deformable = fcl::DeformableBVHModel<fcl::OBBRSS<S>>;
    const auto sheet = makeSquare<Deformable>();
    const S from[] = {-1, -1, 3, 1, -1, 3, 1, 1, 3, -1, -1, 3, 1, 1, 3, -1, 1, 3};
    S to[18];
    for (int i = 0; i < 18; ++i) to[i] = i % 3 == 2 ? from[i] - 8 : from[i];
    sheet->updateFrames(from, to, 6);
    const auto rest = makeSquare<Model>();
    const auto still =
        std::make_shared<fcl::TranslationMotion<S>>(at<S>(0, 0, 0), at<S>(0, 0, 0));
    expectContacts(*sheet, *rest, *still);

    fcl::ContinuousCollisionObject<S> o1(sheet, still), o2(rest, still);
    fcl::ContinuousCollisionManager<S> manager, others;
    manager.registerObject(&o1);
    others.registerObject(&o2);
    int calls = 0;
    const fcl::BroadPhaseContinuousCollisionManager<S>& base = manager;
    base.collide(&others, &calls,
                 [](fcl::CollisionObject<S>*, fcl::CollisionObject<S>*, void* data) {
                   ++*static_cast<int*>(data);
                   return false;
                 });
    expect(calls == 1, "two managers");
    fcl::ContinuousManagerResult<S> found;
    manager.collide(others, fcl::ContinuousContactRequest<S>(), found);
    expect(std::abs(found.time_of_contact - S(.375)) < S(1e-3), "manager");
  }

  template <typename Sheet, typename Motion>
  void expectContacts(const Sheet& sheet, const Model& rest, const Motion& still) const {
    fcl::ContinuousContactResult<S> result;
    fcl::continuousCollide(&sheet, &still, &rest, &still,
                           fcl::ContinuousContactRequest<S>(), result);
    expect(
        std::abs(result.time_of_contact - S(.375)) < S(1e-3) && !result.contacts.empty(),
        "contacts of a mesh that deforms");
    std::size_t total = 0;
    fcl::continuousCandidates(&sheet, &still, &rest, &still,
                              [&](const fcl::ContinuousCandidate*, std::size_t count) {
                                total += count;
                                return true;
                              });
    expect(total > 0, "candidates");
    expect(fcl::safeSelfDisplacements(&rest, 9).size() == 6, "safe displacements");
  }
#endif

 private:
  Still<S> derived_;
  Fall<S> fall_;
};

void inDouble() {
  const Checks<double> checks;
  const fcl::Transform3d still = fcl::Transform3d::Identity(),
                         end = turned(1.5707963267948966);
  const fcl::Vector3d zero = fcl::Vector3d::Zero();
  checks.expectTime(
      fcl::InterpMotion<double>(still.linear(), zero, end.linear(), zero, zero),
      checks.upright(), .5, "interpolation");
  checks.expectTime(fcl::ScrewMotion<double>(still, end), checks.upright(), .5, "screw");
}

template <typename S>
void run() {
  const Checks<S> checks;
  checks.translations();
  checks.spline();
  checks.ownMotions();
#if __cplusplus >= 201703L
  checks.models();
#endif
}

}  // namespace

int main() {
  run<double>();
  inDouble();
#ifndef ONLY_DOUBLE
  run<float>();
#endif
#if __cplusplus >= 201703L && !defined(__GXX_RTTI)
  // Queries would not know a class that derives from it.
  static_assert(std::is_final<fcl::DeformableBVHModel<fcl::OBBRSSd>>::value, "");
#endif
  std::printf("%s  without RTTI\n", failures == 0 ? "ok    " : "FAILED");
  return failures == 0 ? 0 : 1;
}
