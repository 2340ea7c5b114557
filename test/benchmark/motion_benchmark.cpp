// SPDX-License-Identifier: BSD-3-Clause
#include "motion_benchmark.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "curved/curved_query.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/utility.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "mesh_generators.h"
#include "model/fcl_tree.h"
#include "reference_motion.h"
#include "timing.h"

namespace fcl {
namespace test {
namespace {

using namespace detail::deformable;

struct Body {
  explicit Body(const TestMesh& mesh) {
    model.beginModel();
    model.addSubModel(mesh.vertices, mesh.triangles);
    model.endModel();
  }
  BVHModel<OBBRSS<double>> model;
};

/// Body a turns by 90 degrees in place, body b rests at an offset.
struct TurningPair {
  ReferenceMotion turn;
  Transform3<double> place{Transform3<double>::Identity()};
  Vector3<double> direction;

  void setOffset(double offset) { place.translation() = offset * direction; }
};

CurvedAnswer firstContact(const Body& a, const Body& b, const TurningPair& pair) {
  const auto framesOf = [](const Body& body) {
    const double* points = body.model.vertices->data();
    return VertexFrames(points, points,
                        static_cast<std::size_t>(body.model.num_vertices));
  };
  const RigidTree tree_a(fclTree(a.model), Pose()), tree_b(fclTree(b.model), Pose());
  return queryCurved(
      MovingBody(tree_a, framesOf(a), a.model.tri_indices, pair.turn.path()),
      MovingBody(tree_b, framesOf(b), b.model.tri_indices,
                 MotionPath::still(toPose(pair.place))),
      {});
}

/// FCL's samples; 2 without a contact.
double sample(const Body& a, const Body& b, const TurningPair& pair,
              std::size_t samples) {
  const InterpMotion<double> motion(
      pair.turn.beginning.linear(), pair.turn.beginning.translation(),
      pair.turn.end.linear(), pair.turn.end.translation(), Vector3<double>::Zero());
  const InterpMotion<double> rest(pair.place.linear(), pair.place.translation(),
                                  pair.place.linear(), pair.place.translation(),
                                  Vector3<double>::Zero());
  ContinuousCollisionRequest<double> request(samples);
  request.ccd_solver_type = CCDC_NAIVE;
  ContinuousCollisionResult<double> result;
  continuousCollide<double>(&a.model, &motion, &b.model, &rest, request, result);
  return result.is_collide ? result.time_of_contact : 2;
}

TurningPair makeTurningPair(std::uint64_t seed, const Body& a, const Body& b,
                            double gap) {
  Random random(seed);
  TurningPair pair;
  pair.turn.beginning.linear() = randomRotation(random);
  pair.turn.turn(randomDirection(random), M_PI / 2);
  pair.place.linear() = randomRotation(random);
  pair.direction = randomDirection(random);
  double lo = 0, hi = 3;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (lo + hi);
    pair.setOffset(middle);
    (firstContact(a, b, pair).contacts.empty() ? hi : lo) = middle;
  }
  pair.setOffset((gap < 0 ? lo : hi) + gap);
  return pair;
}

double medianOf(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  return 0.5 * (x[(x.size() - 1) / 2] + x[x.size() / 2]);
}

}  // namespace

void benchmarkMotions(int repeats) {
  TestMesh bumpy = makeUvSphere(224, 225, 1), other = makeGeodesicSphere(64, 1);
  for (Vector3<double>& p : bumpy.vertices) {
    p *= 1 + 0.02 * std::sin(9 * p[0]) * std::sin(7 * p[1]);
    p = Vector3<double>(p[0], 0.7 * p[1], 0.5 * p[2]);
  }
  for (Vector3<double>& p : other.vertices) {
    p *= 1 + 0.02 * std::sin(8 * p[0]) * std::sin(6 * p[2]);
    p = Vector3<double>(0.6 * p[0], p[1], 0.8 * p[2]);
  }
  const Body a(bumpy), b(other);
  std::printf(
      "gap (negative: depth),motions,contacts,given up,ms,FCL naive 1000 ms,"
      "FCL missed,FCL late by\n");
  for (const double gap : {0.3, 0.1, 1e-2, 1e-4, -1e-3, -3e-2}) {
    constexpr int kMotions = 12;
    std::vector<double> ours, fcl;
    int contacts = 0, given_up = 0, missed = 0;
    double late = 0;
    for (int i = 0; i < kMotions; ++i) {
      const TurningPair pair =
          makeTurningPair(100 + static_cast<std::uint64_t>(i), a, b, gap);
      CurvedAnswer answer;
      ours.push_back(
          leastMilliseconds(repeats, [&] { answer = firstContact(a, b, pair); }));
      double sampled = 2;
      fcl.push_back(leastMilliseconds(1, [&] { sampled = sample(a, b, pair, 1000); }));
      if (answer.contacts.empty()) continue;
      ++contacts;
      given_up += answer.contacts[0].certainty == ContactCertainty::kGivenUp;
      missed += sampled > 1;
      if (sampled <= 1) late = std::max(late, sampled - answer.contacts[0].toc_lo);
    }
    std::printf("%g,%d,%d,%d,%.4f,%.4f,%d,%.2g\n", gap, kMotions, contacts, given_up,
                medianOf(ours), medianOf(fcl), missed, late);
  }
}

}  // namespace test
}  // namespace fcl
