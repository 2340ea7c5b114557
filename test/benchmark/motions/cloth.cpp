// SPDX-License-Identifier: BSD-3-Clause
//
// A cloth of 92,020 triangles sinks onto a body of 80,000 triangles, which moves up into
// it. The body translates, or also turns about its center: so little that no point goes
// further than by the translation, or five times as far. Both have about as many
// contacts.
#include "motions/cloth.h"

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/utility.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/narrowphase/collision.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "mesh_generators.h"
#include "motions/contact_features.h"
#include "motions/row.h"
#include "timing.h"

namespace fcl {
namespace test {
namespace {

constexpr double kLift = 0.02;

/// The sheet at a height above the unit sphere: it lies on the upper part of the sphere
/// and hangs down beyond that, in small waves.
TestMesh clothAt(double height) {
  constexpr double kWidth = 2.4, kRim = 0.95, kSlope = 1.5;
  return makeSheet(215, 214, [height](double u, double v) {
    const double x = kWidth * (u - 0.5), y = kWidth * (v - 0.5), r = std::hypot(x, y);
    const double z = r < kRim ? std::sqrt(1 - r * r)
                              : std::sqrt(1 - kRim * kRim) - kSlope * (r - kRim);
    return Vector3<double>(
        x, y, z + height + 0.004 * std::sin(23 * x + 2 * height) * std::sin(19 * y));
  });
}

TestMesh bumpyBall() {
  TestMesh body = makeUvSphere(200, 201, 1);
  for (Vector3<double>& p : body.vertices)
    p *= 1 + 0.004 * std::sin(31 * p[0]) * std::sin(29 * p[1]) * std::sin(27 * p[2]);
  return body;
}

using RigidModel = BVHModel<OBBRSS<double>>;
using Contacts = ContinuousContactResult<double>;

void build(const TestMesh& mesh, RigidModel& model) {
  model.beginModel();
  model.addSubModel(mesh.vertices, mesh.triangles);
  model.endModel();
}

class ClothScene {
 public:
  ClothScene() : frame_{clothAt(0.03), clothAt(0.024)}, body_(bumpyBall()) {
    build(body_, body_model_);
    cloth_.beginModel();
    cloth_.addSubModel(frame_[0].vertices, frame_[0].triangles);
    cloth_.endModel(FclTree::kSkip);
    cloth_.updateFrames(frame_[0].vertices[0].data(), frame_[1].vertices[0].data(),
                        frame_[0].vertices.size());
  }

  /// @param turn  the rotation of the body as a vector
  double ask(const Vector3<double>& turn, Contacts& contacts) const {
    const Matrix3<double> unit = Matrix3<double>::Identity();
    const Vector3<double> origin = Vector3<double>::Zero();
    const InterpMotion<double> still(unit, origin, unit, origin, origin),
        moving(unit, origin, rotation(turn, 1), Vector3<double>(0, 0, kLift), origin);
    ContinuousContactRequest<double> request;
    request.query = ContinuousQuery::kAll;
    request.toc_err = kTocErr;
    request.num_max_contacts = static_cast<std::size_t>(-1);
    request.num_threads = 1;
    continuousCollide(&cloth_, &still, &body_model_, &moving, request, contacts);
    return contacts.is_collide ? contacts.time_of_contact : kNever;
  }

  /// The pairs of triangles that FCL finds to overlap at a time.
  std::vector<Contact<double>> overlapsAt(const Vector3<double>& turn, double t,
                                          std::size_t most) const {
    TestMesh posed = frame_[0];
    for (std::size_t i = 0; i < posed.vertices.size(); ++i)
      posed.vertices[i] = (1 - t) * frame_[0].vertices[i] + t * frame_[1].vertices[i];
    RigidModel cloth;
    build(posed, cloth);
    Transform3<double> pose = Transform3<double>::Identity();
    pose.linear() = rotation(turn, t);
    pose.translation() = Vector3<double>(0, 0, t * kLift);
    CollisionResult<double> result;
    collide(&cloth, Transform3<double>::Identity(), &body_model_, pose,
            CollisionRequest<double>(most, true), result);
    std::vector<Contact<double>> contacts;
    result.getContacts(contacts);
    return contacts;
  }

  /// The number of pairs that overlap at the end although none of their features are
  /// among the contacts.
  int numMissedAtEnd(const Vector3<double>& turn, const Contacts& contacts) const {
    const ContactFeatures found(contacts);
    int missed = 0;
    for (const auto& overlap : overlapsAt(turn, 1, static_cast<std::size_t>(-1)))
      missed +=
          !found.haveBy(1, frame_[0].triangles[static_cast<std::size_t>(overlap.b1)],
                        body_.triangles[static_cast<std::size_t>(overlap.b2)]);
    return missed;
  }

 private:
  static Matrix3<double> rotation(const Vector3<double>& turn, double t) {
    const double angle = turn.norm();
    if (angle == 0) return Matrix3<double>::Identity();
    return AngleAxis<double>(t * angle, turn / angle).toRotationMatrix();
  }

  TestMesh frame_[2], body_;
  RigidModel body_model_;
  DeformableBVHModel<> cloth_;
};

/// The first time at which a sample overlaps, halved between it and the one before.
double sampledTime(const ClothScene& scene, const Vector3<double>& turn) {
  constexpr int kSamples = 32, kHalvings = 16;
  const auto isHit = [&](double t) { return !scene.overlapsAt(turn, t, 1).empty(); };
  for (int i = 0; i <= kSamples; ++i) {
    double hi = static_cast<double>(i) / kSamples, lo = hi - 1. / kSamples;
    if (!isHit(hi)) continue;
    for (int k = 0; k < kHalvings && i > 0; ++k) {
      const double middle = 0.5 * (lo + hi);
      (isHit(middle) ? hi : lo) = middle;
    }
    return hi;
  }
  return kNever;
}

}  // namespace

void measureCloth(std::ostream& csv) {
  constexpr int kRepeats = 5;
  const ClothScene scene;
  const Vector3<double> axis = Vector3<double>(0.3, 0.2, 1).normalized();
  for (const double angle : {0., kLift, 5 * kLift}) {
    const Vector3<double> turn = angle * axis;
    const double truth = sampledTime(scene, turn);
    Row row;
    Contacts contacts;
    for (int i = 0; i < kRepeats; ++i) {
      double time = kNever;
      const double ms = millisecondsOf([&] { time = scene.ask(turn, contacts); });
      row.add(time, truth, ms);
    }
    row.missed += scene.numMissedAtEnd(turn, contacts);
    const std::string name = angle == 0 ? "translation" : "turn-" + number(angle, "%.2g");
    row.write("cloth", name, "fcl-ccd", csv);
    std::fprintf(stderr, "%zu contacts\n", contacts.contacts.size());
  }
}

}  // namespace test
}  // namespace fcl
