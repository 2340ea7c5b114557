// SPDX-License-Identifier: BSD-3-Clause
//
// Transforms whose matrix is no rotation: up to 2^-6 queries take the nearest rotation.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <Eigen/SVD>

#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/bvh/BVH_model.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "prepare/nearest_rotation.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::deviationFromRotation;
using detail::deformable::toNearestRotation;

template <typename S>
Transform3<S> posed(const Matrix3<S>& matrix, const Vector3<S>& translation) {
  Transform3<S> pose = Transform3<S>::Identity();
  pose.linear() = matrix;
  pose.translation() = translation;
  return pose;
}

/// The orthogonal factor by singular values.
Matrix3<double> polarFactor(const Matrix3<double>& matrix) {
  const Eigen::JacobiSVD<Matrix3<double>> svd(matrix,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

Matrix3<double> nearest(const Matrix3<double>& matrix) {
  double rows[9];
  for (int i = 0; i < 9; ++i) rows[i] = matrix(i / 3, i % 3);
  if (!toNearestRotation(rows)) return Matrix3<double>::Zero();
  Matrix3<double> rotation;
  for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = rows[i];
  return rotation;
}

TEST(NearestRotation, IsTheOrthogonalFactor) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> between(-1, 1);
  double worst = 0, most_deviation = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3<double> axis(between(random), between(random), between(random));
    Matrix3<double> matrix =
        AngleAxis<double>(4 * between(random), axis.normalized()).toRotationMatrix();
    const double size = std::pow(2, -8 - 20 * std::abs(between(random)));
    for (int k = 0; k < 9; ++k) matrix(k / 3, k % 3) += size / 2 * between(random);
    const Matrix3<double> rotation = nearest(matrix);
    worst = std::max(worst, (rotation - polarFactor(matrix)).cwiseAbs().maxCoeff());
    const Matrix3<double> product = rotation * rotation.transpose();
    most_deviation = std::max(
        most_deviation, (product - Matrix3<double>::Identity()).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 1e-14);
  EXPECT_LT(most_deviation, 0x1p-49);
}

TEST(NearestRotation, RefusesWhatIsFarFromARotation) {
  const Matrix3<double> one = Matrix3<double>::Identity();
  const double inside = std::sqrt(1 + 0x1.fffp-7), outside = std::sqrt(1 + 0x1.001p-6);
  EXPECT_LT((nearest(inside * one) - one).norm(), 1e-14);
  EXPECT_EQ(nearest(outside * one).norm(), 0);
  EXPECT_EQ(nearest(-one).norm(), 0);
  EXPECT_EQ(nearest(std::nan("") * one).norm(), 0);
  EXPECT_EQ(nearest(INFINITY * one).norm(), 0);
  double rows[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  EXPECT_EQ(deviationFromRotation(rows), 0);
}

/// An eighth of a turn about z: with .71 for .7071, and as it should be.
template <typename S>
Matrix3<S> eighthOfATurn(bool typed) {
  const S c = typed ? S(.71) : std::sqrt(S(.5));
  Matrix3<S> matrix;
  matrix << c, -c, 0, c, c, 0, 0, 0, 1;
  return matrix;
}

template <typename S>
std::shared_ptr<CollisionGeometry<S>> makeMesh() {
  auto mesh = std::make_shared<BVHModel<OBBRSS<S>>>();
  mesh->beginModel();
  mesh->addTriangle({-1, -1, 0}, {1, -1, 0}, {1, 1, 0});
  mesh->addTriangle({-1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
  mesh->endModel();
  mesh->computeLocalAABB();
  return mesh;
}

template <typename S>
class TypedRotation : public ::testing::Test {
 protected:
  using Result = ContinuousContactResult<S>;
  using Geometry = std::shared_ptr<CollisionGeometry<S>>;
  using Vector = Vector3<S>;

  static Result ask(const Geometry& o, const Matrix3<S>& begin, const Matrix3<S>& end,
                    const Geometry& other, CCDMotionType type = CCDM_LINEAR) {
    ContinuousContactRequest<S> request;
    request.ccd_motion_type = type;
    const Transform3<S> still = Transform3<S>::Identity();
    Result result;
    continuousCollide(o.get(), posed<S>(begin, Vector(4, 0, 0)),
                      posed<S>(end, Vector(0, 0, 0)), other.get(), still, still, request,
                      result);
    return result;
  }

  static void expectSame(const Result& typed, const Result& exact) {
    const S rounding = 64 * std::numeric_limits<S>::epsilon();
    ASSERT_EQ(typed.is_collide, exact.is_collide);
    EXPECT_NEAR(typed.time_of_contact, exact.time_of_contact, rounding);
    for (const auto pose : {&ContinuousCollisionResult<S>::contact_tf1,
                            &ContinuousCollisionResult<S>::contact_tf2}) {
      EXPECT_LT(((typed.*pose).matrix() - (exact.*pose).matrix()).norm(), rounding);
      const Matrix3<S> r = (typed.*pose).linear();
      EXPECT_LT((r * r.transpose() - Matrix3<S>::Identity()).norm(), rounding);
    }
  }

  static std::string errorOf(const std::function<void()>& query) {
    try {
      query();
    } catch (const Exception& error) {
      return error.what();
    }
    return "";
  }

  const Geometry box_ = std::make_shared<Box<S>>(S(1), S(2), S(1)),
                 ball_ = std::make_shared<Sphere<S>>(S(1)),
                 wall_ = std::make_shared<Halfspace<S>>(Vector(1, 0, 0), S(-1)),
                 mesh_ = makeMesh<S>();
  const Matrix3<S> one_ = Matrix3<S>::Identity(), typed_ = eighthOfATurn<S>(true),
                   exact_ = eighthOfATurn<S>(false);
};

using Scalars = ::testing::Types<double, float>;
TYPED_TEST_SUITE(TypedRotation, Scalars, );

TYPED_TEST(TypedRotation, ShapesAndTurningMeshes) {
  for (const auto& o : {this->box_, this->ball_, this->mesh_})
    for (const auto& other : {this->ball_, this->wall_, this->mesh_}) {
      // Two shapes that keep their rotation; a mesh may be scaled then.
      if (o != this->mesh_)
        this->expectSame(this->ask(o, this->typed_, this->typed_, other),
                         this->ask(o, this->exact_, this->exact_, other));
      for (const CCDMotionType type : {CCDM_TRANS, CCDM_LINEAR, CCDM_SCREW}) {
        this->expectSame(this->ask(o, this->one_, this->typed_, other, type),
                         this->ask(o, this->one_, this->exact_, other, type));
        this->expectSame(this->ask(o, this->typed_, this->one_, other, type),
                         this->ask(o, this->exact_, this->one_, other, type));
      }
    }
}

TYPED_TEST(TypedRotation, PosesOfAnOverlapAndOfAMiss) {
  // At t = 0 the box overlaps; then nothing is met.
  using S = TypeParam;
  for (const S x : {S(4), S(40)}) {
    const auto ask = [&](const Matrix3<S>& matrix) {
      const Transform3<S> still = posed<S>(this->one_, Vector3<S>(x, 0, 0));
      typename TestFixture::Result result;
      continuousCollide(this->box_.get(), posed<S>(matrix, Vector3<S>(4, 0, 0)),
                        posed<S>(matrix, Vector3<S>(3, 0, 0)), this->ball_.get(), still,
                        still, ContinuousContactRequest<S>(), result);
      return result;
    };
    this->expectSame(ask(this->typed_), ask(this->exact_));
    EXPECT_EQ(ask(this->typed_).is_collide, x == 4);
  }
}

TYPED_TEST(TypedRotation, MeshesOnStraightPathsStayAsGiven) {
  const auto result = this->ask(this->mesh_, this->typed_, this->typed_, this->ball_);
  EXPECT_TRUE(result.contact_tf1.linear() == this->typed_);
}

TYPED_TEST(TypedRotation, RotationsOfFourDigitsStayAsGiven) {
  using S = TypeParam;
  const Matrix3<S> rotation = S(1.0004) * eighthOfATurn<S>(false);
  const auto still = this->ask(this->box_, rotation, rotation, this->ball_);
  EXPECT_TRUE(still.contact_tf1.linear() == rotation);
}

TYPED_TEST(TypedRotation, BeyondTheLimit) {
  using S = TypeParam;
  const Matrix3<S> scaled = S(1.01) * this->one_, mirrored = -this->typed_;
  for (const Matrix3<S>& matrix : {scaled, mirrored})
    for (const auto& o : {this->box_, this->ball_, this->mesh_}) {
      const std::string error =
          this->errorOf([&] { this->ask(o, this->one_, matrix, this->ball_); });
      EXPECT_NE(error.find("o1, "), std::string::npos) << error;
      EXPECT_NE(error.find("normalise"), std::string::npos) << error;
    }
}

TYPED_TEST(TypedRotation, ManagersTakeThemToo) {
  using S = TypeParam;
  const auto pose = posed<S>(this->typed_, Vector3<S>(0, 0, 0));
  const auto motion = std::make_shared<TranslationMotion<S>>(pose, pose);
  ContinuousCollisionObject<S> o1(this->box_, motion), o2(this->ball_, motion);
  ContinuousCollisionManager<S> manager;
  manager.registerObjects({&o1, &o2});
  ContinuousManagerResult<S> result;
  manager.collide(ContinuousContactRequest<S>(), result);
  EXPECT_TRUE(result.is_collide);
}

TYPED_TEST(TypedRotation, Candidates) {
  using S = TypeParam;
  std::size_t total = 0;
  const Transform3<S> still = posed<S>(this->one_, Vector3<S>(0, 0, 0));
  continuousCandidates(this->mesh_.get(), still,
                       posed<S>(this->typed_, Vector3<S>(0, 0, 0)), this->mesh_.get(),
                       still, still, [&](const ContinuousCandidate*, std::size_t count) {
                         total += count;
                         return true;
                       });
  EXPECT_GT(total, 0u);
}

TEST(NearestRotation, MotionObjects) {
  const auto box = std::make_shared<Box<double>>(1., 2., 1.);
  const auto ball = std::make_shared<Sphere<double>>(1.);
  const auto timeOf = [&](const Matrix3<double>& end) {
    const Vector3<double> from(4, 0, 0), zero(0, 0, 0);
    const InterpMotion<double> motion(Matrix3<double>::Identity(), from, end, zero, zero);
    const Transform3<double> still = Transform3<double>::Identity();
    const TranslationMotion<double> rest(still, still);
    ContinuousCollisionResult<double> result;
    return continuousCollide(box.get(), &motion, ball.get(), &rest,
                             ContinuousCollisionRequest<double>(), result);
  };
  EXPECT_NEAR(timeOf(eighthOfATurn<double>(true)), timeOf(eighthOfATurn<double>(false)),
              1e-12);
}

// The vertices of a mesh that deforms go straight between any two matrices.
TEST(NearestRotation, AScaledMeshKeepsItsPoseAtTheBeginning) {
  DeformableBVHModel<> mesh;
  mesh.beginModel();
  mesh.addTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  ASSERT_EQ(mesh.endModel(), BVH_OK);
  mesh.beginUpdateModel();
  for (int i = 0; i < 3; ++i)
    mesh.updateVertex(mesh.vertices[i] + Vector3<double>(0, 0, 0.25));
  ASSERT_EQ(mesh.endUpdateModel(), BVH_OK);
  const Transform3<double> still = Transform3<double>::Identity();
  const Transform3<double> twice =
                               posed<double>(2 * Matrix3<double>::Identity(), {0, 0, 0}),
                           more = posed<double>(2.1 * Matrix3<double>::Identity(),
                                                {0, 0, 0});
  BVHModel<OBBRSS<double>> wall;
  wall.beginModel();
  wall.addTriangle({0.5, 0.5, -1}, {0.5, 0.5, 1}, {1, 1, 0});
  wall.endModel();
  ContinuousCollisionRequest<double> request;
  ContinuousCollisionResult<double> result;
  continuousCollide(&mesh, twice, more, &wall, still, still, request, result);
  EXPECT_TRUE(result.is_collide);
  EXPECT_EQ(result.time_of_contact, 0);
  EXPECT_TRUE(result.contact_tf1.linear() == twice.linear());
}

}  // namespace
}  // namespace test
}  // namespace fcl
