// SPDX-License-Identifier: BSD-3-Clause
//
// Two bumpy balls of 5,120 triangles, deep in each other. The first turns about its own
// axis, by up to nearly half a turn. How long a query for all contacts takes grows with
// the angle.
#include "motions/deep.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "advance/triangle_advance.h"
#include "fcl/geometry/bvh/BVH_model.h"
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

using RigidModel = BVHModel<OBBRSS<double>>;
using Contacts = ContinuousContactResult<double>;
using Pairs = std::set<std::pair<std::intptr_t, std::intptr_t>>;

struct BumpyBall {
  explicit BumpyBall(double phase) : mesh(makeGeodesicSphere(16, 1)) {
    for (Vector3<double>& p : mesh.vertices)
      p *=
          1 + 0.05 * std::sin(7 * p[0] + phase) * std::sin(5 * p[1]) * std::sin(6 * p[2]);
    model.beginModel();
    model.addSubModel(mesh.vertices, mesh.triangles);
    model.endModel();
  }
  TestMesh mesh;
  RigidModel model;
};

class DeepScene {
 public:
  explicit DeepScene(double angle) : angle_(angle), a_(1), b_(2) {}

  double ask(Contacts& contacts) const {
    const Matrix3<double> unit = Matrix3<double>::Identity();
    const Vector3<double> origin = Vector3<double>::Zero();
    const InterpMotion<double> turning(unit, origin, poseAt(1).linear(), origin, origin),
        still(unit, place_, unit, place_, origin);
    ContinuousContactRequest<double> request;
    request.query = ContinuousQuery::kAll;
    request.toc_err = kTocErr;
    request.num_max_contacts = static_cast<std::size_t>(-1);
    request.num_threads = 1;
    continuousCollide(&a_.model, &turning, &b_.model, &still, request, contacts);
    return contacts.is_collide ? contacts.time_of_contact : kNever;
  }

  /// The number of pairs that overlap at a time and not at the beginning, although none
  /// of their features has a contact until then.
  int numMissed(const Contacts& contacts) const {
    constexpr int kSamples = 16;
    const ContactFeatures found(contacts);
    const Pairs at_start = overlapsAt(0);
    int missed = 0;
    for (int i = 1; i <= kSamples; ++i) {
      const double t = static_cast<double>(i) / kSamples;
      for (const auto& pair : overlapsAt(t))
        missed += !at_start.count(pair) &&
                  !found.haveBy(t, triangle(a_, pair.first), triangle(b_, pair.second));
    }
    return missed;
  }

  /// The number of contacts whose triangles do not touch at their time.
  int numFalse(const Contacts& contacts) const {
    constexpr double kTouching = 1e-12;
    return static_cast<int>(std::count_if(
        contacts.contacts.begin(), contacts.contacts.end(), [&](const auto& contact) {
          const Transform3<double> pose = poseAt(contact.toc_lo);
          detail::deformable::Vec p[2][3];
          for (unsigned k = 0; k < 3; ++k) {
            const Vector3<double> x =
                pose * a_.mesh.vertices[triangle(a_, contact.b1)[k]];
            const Vector3<double> y =
                b_.mesh.vertices[triangle(b_, contact.b2)[k]] + place_;
            p[0][k] = {x[0], x[1], x[2]};
            p[1][k] = {y[0], y[1], y[2]};
          }
          return detail::deformable::nearestFeatures(p[0], p[1]).square >
                 kTouching * kTouching;
        }));
  }

 private:
  static const Triangle& triangle(const BumpyBall& ball, std::intptr_t id) {
    return ball.mesh.triangles[static_cast<std::size_t>(id)];
  }

  Transform3<double> poseAt(double t) const {
    const Vector3<double> axis = Vector3<double>(0.3, 0.5, 1).normalized();
    Transform3<double> pose = Transform3<double>::Identity();
    pose.linear() = AngleAxis<double>(t * angle_, axis).toRotationMatrix();
    return pose;
  }

  Pairs overlapsAt(double t) const {
    Transform3<double> still = Transform3<double>::Identity();
    still.translation() = place_;
    CollisionResult<double> result;
    collide(&a_.model, poseAt(t), &b_.model, still,
            CollisionRequest<double>(static_cast<std::size_t>(-1), true), result);
    std::vector<Contact<double>> contacts;
    result.getContacts(contacts);
    Pairs pairs;
    for (const auto& contact : contacts) pairs.emplace(contact.b1, contact.b2);
    return pairs;
  }

  double angle_;
  Vector3<double> place_{0.5, 0.1, 0.2};
  BumpyBall a_, b_;
};

}  // namespace

void measureDeep(std::ostream& csv) {
  constexpr int kRepeats = 5;
  for (const int degrees : {45, 90, 135, 143, 144, 160, 179}) {
    const DeepScene scene(degrees * M_PI / 180);
    Row row;
    Contacts contacts;
    for (int i = 0; i < kRepeats; ++i) {
      double time = kNever;
      const double ms = millisecondsOf([&] { time = scene.ask(contacts); });
      // They cross at the beginning.
      row.add(time, 0, ms);
    }
    row.missed += scene.numMissed(contacts);
    row.wrong += scene.numFalse(contacts);
    row.write("deep", "turn-" + std::to_string(degrees), "fcl-ccd", csv);
    std::fprintf(stderr, "%zu contacts\n", contacts.contacts.size());
  }
}

}  // namespace test
}  // namespace fcl
