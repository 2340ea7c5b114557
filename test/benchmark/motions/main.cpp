// SPDX-License-Identifier: BSD-3-Clause
//
// Speed and errors of queries of two rigid meshes that turn: the library's beside FCL's
// methods and beside straight paths of the vertices. doc/numerics.md explains the
// report.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "advance/triangle_advance.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/utility.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/spline_motion.h"
#include "fcl/narrowphase/collision.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "mesh_generators.h"
#include "motions/cloth.h"
#include "motions/deep.h"
#include "motions/row.h"
#include "reference_motion.h"
#include "timing.h"

namespace {

using namespace fcl::test;
using fcl::Transform3;
using fcl::Vector3;
using Model = fcl::BVHModel<fcl::OBBRSS<double>>;
using Motion = fcl::MotionBase<double>;
using Kind = ReferenceMotion::Kind;

struct Body {
  explicit Body(const TestMesh& from) : mesh(from) {
    model.beginModel();
    model.addSubModel(mesh.vertices, mesh.triangles);
    model.endModel();
  }
  TestMesh mesh;
  Model model;
};

std::vector<std::unique_ptr<Body>> makeBodies() {
  TestMesh ellipsoid = makeUvSphere(60, 45, 0.5), bumpy = makeIcosphere(4, 0.4);
  for (auto& p : ellipsoid.vertices) p = Vector3<double>(p[0], 0.6 * p[1], 0.3 * p[2]);
  for (auto& p : bumpy.vertices) p *= 1 + 0.1 * std::sin(9 * p[0]) * std::sin(7 * p[1]);
  std::vector<std::unique_ptr<Body>> bodies;
  bodies.push_back(std::make_unique<Body>(ellipsoid));
  bodies.push_back(std::make_unique<Body>(bumpy));
  bodies.push_back(std::make_unique<Body>(makeBox({0.4, 0.25, 0.15}, 16)));
  bodies.push_back(std::make_unique<Body>(makeCapsule(36, 24, 0.15, 0.6)));
  return bodies;
}

std::unique_ptr<Motion> toFcl(const ReferenceMotion& motion) {
  const Transform3<double>&beg = motion.beginning, &end = motion.end;
  if (motion.kind == Kind::kScrew)
    return std::make_unique<fcl::ScrewMotion<double>>(beg, end);
  if (motion.kind == Kind::kInterpolation)
    return std::make_unique<fcl::InterpMotion<double>>(beg.linear(), beg.translation(),
                                                       end.linear(), end.translation(),
                                                       motion.reference);
  const auto& t = motion.translation_points;
  const auto& r = motion.rotation_points;
  return std::make_unique<fcl::SplineMotion<double>>(t[0], t[1], t[2], t[3], r[0], r[1],
                                                     r[2], r[3]);
}

Transform3<double> poseOf(const ReferenceMotion& motion, double t) {
  const RealPose pose = motion.at(t);
  Transform3<double> tf = Transform3<double>::Identity();
  tf.linear() = pose.rotation.cast<double>();
  tf.translation() = pose.translation.cast<double>();
  return tf;
}

/// A query: two bodies and their motions.
struct Query {
  const Body* body[2];
  ReferenceMotion motion[2];

  /// Whether they collide at a time, by FCL's discrete query.
  bool isHitAt(double t) const {
    fcl::CollisionResult<double> result;
    return fcl::collide(&body[0]->model, poseOf(motion[0], t), &body[1]->model,
                        poseOf(motion[1], t), fcl::CollisionRequest<double>(),
                        result) > 0;
  }

  /// The first sample that collides, halved between it and the one before.
  double sampledTime(int samples) const {
    for (int i = 0; i <= samples; ++i) {
      double hi = static_cast<double>(i) / samples;
      if (!isHitAt(hi)) continue;
      double lo = std::max(0., hi - 1. / samples);
      for (int k = 0; k < 40 && i > 0; ++k) {
        const double middle = 0.5 * (lo + hi);
        (isHitAt(middle) ? hi : lo) = middle;
      }
      return hi;
    }
    return kNever;
  }

  /// Distance of two triangles at a time, by the formulas of the motions.
  double distanceAt(double t, std::intptr_t (&triangle)[2]) const {
    fcl::detail::deformable::Vec p[2][3];
    RealVector origin;
    for (int side = 0; side < 2; ++side) {
      const TestMesh& mesh = body[side]->mesh;
      const auto& ids = mesh.triangles[static_cast<std::size_t>(triangle[side])];
      for (int k = 0; k < 3; ++k) {
        const RealVector x = motion[side].at(t) * mesh.vertices[ids[k]];
        if (side == 0 && k == 0) origin = x;
        const Vector3<double> from = (x - origin).cast<double>();
        p[side][k] = {from[0], from[1], from[2]};
      }
    }
    return std::sqrt(fcl::detail::deformable::nearestFeatures(p[0], p[1]).square);
  }
};

double ours(const Query& q) {
  const auto motion1 = toFcl(q.motion[0]), motion2 = toFcl(q.motion[1]);
  fcl::ContinuousCollisionRequest<double> request;
  request.toc_err = kTocErr;
  fcl::ContinuousCollisionResult<double> result;
  continuousCollide(&q.body[0]->model, motion1.get(), &q.body[1]->model, motion2.get(),
                    request, result);
  return result.is_collide ? result.time_of_contact : kNever;
}

/// FCL's own answer. It samples so often, or advances so often.
double fcls(const Query& q, fcl::CCDSolverType solver, std::size_t iterations) {
  const auto motion1 = toFcl(q.motion[0]), motion2 = toFcl(q.motion[1]);
  fcl::ContinuousCollisionRequest<double> request(iterations, kTocErr);
  request.ccd_solver_type = solver;
  fcl::ContinuousCollisionResult<double> result;
  fcl::continuousCollide<double>(&q.body[0]->model, motion1.get(), &q.body[1]->model,
                                 motion2.get(), request, result);
  return result.is_collide ? result.time_of_contact : kNever;
}

/// The vertices go straight from their first to their last place, exactly.
/// @param ms  gets the time of the query, without that of the models
double chords(const Query& q, double& ms) {
  fcl::DeformableBVHModel<> model[2];
  for (int side = 0; side < 2; ++side) {
    const TestMesh& mesh = q.body[side]->mesh;
    std::vector<Vector3<double>> frame[2];
    for (int end = 0; end < 2; ++end)
      for (const auto& p : mesh.vertices)
        frame[end].push_back((q.motion[side].at(end) * p).cast<double>());
    model[side].beginModel();
    model[side].addSubModel(frame[0], mesh.triangles);
    model[side].endModel(fcl::FclTree::kSkip);
    model[side].updateFrames(frame[0][0].data(), frame[1][0].data(), frame[0].size());
  }
  const Transform3<double> still = Transform3<double>::Identity();
  fcl::ContinuousCollisionRequest<double> request;
  request.toc_err = kTocErr;
  fcl::ContinuousCollisionResult<double> result;
  ms = millisecondsOf([&] {
    continuousCollide(&model[0], still, still, &model[1], still, still, request, result);
  });
  return result.is_collide ? result.time_of_contact : kNever;
}

struct Method {
  const char* name;
  /// Gives the time of contact, and the milliseconds of the query.
  std::function<double(const Query&, double&)> ask;
};

std::vector<Method> methods() {
  const auto timed = [](auto ask) {
    return [ask](const Query& q, double& ms) {
      double time = kNever;
      ms = millisecondsOf([&] { time = ask(q); });
      return time;
    };
  };
  const auto stock = [&](fcl::CCDSolverType solver, std::size_t iterations) {
    return timed([=](const Query& q) { return fcls(q, solver, iterations); });
  };
  return {{"fcl-ccd", timed(ours)},
          {"FCL-naive-10", stock(fcl::CCDC_NAIVE, 10)},
          {"FCL-naive-1000", stock(fcl::CCDC_NAIVE, 1000)},
          {"FCL-advancement", stock(fcl::CCDC_CONSERVATIVE_ADVANCEMENT, 1000)},
          {"exact-chords", chords}};
}

/// The time of the first contact. Dense samples find what overlaps; where they find it
/// late or not at all, a pair of triangles that touches by the formulas of the motions
/// decides.
double trueTime(const Query& q, int samples) {
  constexpr double kTouching = 1e-12;
  const double sampled = q.sampledTime(samples);
  const auto motion1 = toFcl(q.motion[0]), motion2 = toFcl(q.motion[1]);
  fcl::ContinuousContactRequest<double> request;
  request.query = fcl::ContinuousQuery::kFirst;
  request.toc_err = kTocErr;
  fcl::ContinuousContactResult<double> result;
  continuousCollide(&q.body[0]->model, motion1.get(), &q.body[1]->model, motion2.get(),
                    request, result);
  if (result.contacts.empty()) return sampled;
  const auto& contact = result.contacts.front();
  std::intptr_t triangles[2] = {contact.b1, contact.b2};
  const bool touches = q.distanceAt(contact.toc_lo, triangles) <= kTouching;
  return touches && contact.toc_lo < sampled - kTocErr ? contact.toc_lo : sampled;
}

/// Moves the second body along a direction to where it passes the first one at a distance
/// (negative: hits it as deep).
void placeAt(double distance, const Vector3<double>& direction, Query& q) {
  const auto moved = [&](double offset) {
    Query out = q;
    out.motion[1].move(offset * direction);
    return out;
  };
  const auto isHit = [&](double offset) { return ours(moved(offset)) < kNever; };
  double lo = 3;
  while (lo > -3 && !isHit(lo)) lo -= 0.1;
  double hi = lo + 0.1;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (lo + hi);
    (isHit(middle) ? lo : hi) = middle;
  }
  q = moved(distance < 0 ? lo + distance : hi + distance);
}

/// Two of the bodies, on motions of a kind.
Query randomQuery(Random& random, Kind kind,
                  const std::vector<std::unique_ptr<Body>>& bodies) {
  Query q;
  for (int side = 0; side < 2; ++side) {
    q.body[side] = bodies[random.index(bodies.size())].get();
    do q.motion[side] = randomMotion(random, 1);
    while (q.motion[side].kind != kind);
  }
  return q;
}

/// As randomQuery(). They pass each other at a distance, or hit each other as deep, of
/// 1e-2 to 1e-6.
Query grazingQuery(Random& random, Kind kind,
                   const std::vector<std::unique_ptr<Body>>& bodies) {
  constexpr double kDepths[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
  Query q = randomQuery(random, kind, bodies);
  const Vector3<double> direction = randomDirection(random);
  const double depth = kDepths[random.index(5)];
  placeAt(random.index(2) ? -depth : depth, direction, q);
  return q;
}

/// The first body turns by 90 degrees about the origin of its frame, the second one
/// rests.
Query turningQuery(Random& random, const Body& turning, const Body& resting) {
  Query q;
  q.body[0] = &turning;
  q.body[1] = &resting;
  for (ReferenceMotion& motion : q.motion)
    motion.beginning.linear() = motion.end.linear() = randomRotation(random);
  q.motion[0].turn(randomDirection(random), M_PI / 2);
  return q;
}

struct Options {
  std::string out;
  int queries{170};
  int samples{2000};
};

/// @param make  makes a query
void measure(const std::string& scene, const char* motion, int queries, int samples,
             const std::function<Query(Random&)>& make, const std::vector<Method>& all,
             std::ofstream& csv) {
  std::vector<Row> rows(all.size());
  for (int i = 0; i < queries; ++i) {
    Random random(static_cast<std::uint64_t>(i) + 1);
    const Query q = make(random);
    const double truth = trueTime(q, samples);
    for (std::size_t m = 0; m < all.size(); ++m) {
      double ms = 0;
      const double time = all[m].ask(q, ms);
      rows[m].add(time, truth, ms);
    }
  }
  for (std::size_t m = 0; m < all.size(); ++m)
    rows[m].write(scene, motion, all[m].name, csv);
}

/// Two of four bodies, on random motions of each kind.
void measureKinds(const Options& options, std::ofstream& csv) {
  const struct {
    Kind kind;
    const char* name;
  } kinds[] = {{Kind::kInterpolation, "interpolation"},
               {Kind::kScrew, "screw"},
               {Kind::kSpline, "spline"}};
  const auto bodies = makeBodies();
  for (auto [scene, make] :
       {std::pair("random", &randomQuery), std::pair("grazing", &grazingQuery)})
    for (const auto& kind : kinds)
      measure(
          scene, kind.name, options.queries, options.samples,
          [&, make = make](Random& random) { return make(random, kind.kind, bodies); },
          methods(), csv);
}

/// A robot link of 6,240 triangles turns about its end past a box, at 1 to 10 cm.
void measureLink(const Options& options, std::ofstream& csv) {
  const Body link(makeCapsule(40, 38, 0.08, 0.6)), box(makeBox({0.2, 0.15, 0.25}, 16));
  measure(
      "link", "interpolation", options.queries, options.samples,
      [&](Random& random) {
        Query q = turningQuery(random, link, box);
        const double distance = random.uniform(0.01, 0.1);
        placeAt(distance, randomDirection(random), q);
        return q;
      },
      methods(), csv);
}

/// A ball turns in a shell at a gap of 1e-3, 5,120 triangles each. A thousand samples
/// take FCL 15 seconds, its advancement more than a minute: they are left out.
void measureShell(const Options& options, std::ofstream& csv) {
  constexpr int kMostQueries = 3, kMostSamples = 200;
  TestMesh shell = makeIcosphere(4, 1);
  double inner = 1;
  for (const auto& t : shell.triangles) {
    const Vector3<double>&p = shell.vertices[t[0]], &q = shell.vertices[t[1]],
          &r = shell.vertices[t[2]];
    inner = std::min(inner, p.dot((q - p).cross(r - p).normalized()));
  }
  for (Vector3<double>& p : shell.vertices) p *= (1 + 1e-3) / inner;
  const Body ball(makeIcosphere(4, 1)), outer(shell);
  std::vector<Method> quick = methods();
  quick.erase(quick.begin() + 2, quick.begin() + 4);
  measure(
      "shell", "interpolation", std::min(options.queries, kMostQueries),
      std::min(options.samples, kMostSamples),
      [&](Random& random) { return turningQuery(random, ball, outer); }, quick, csv);
}

void run(const Options& options) {
  std::filesystem::create_directories(options.out);
  std::ofstream csv(options.out + "/motions.csv");
  csv << "scene,motion,method,queries,contacts,missed,late,false,early,max_early,"
         "max_late,ms_median,ms_p99,machine\n";
  measureKinds(options, csv);
  measureLink(options, csv);
  measureShell(options, csv);
  measureCloth(csv);
  measureDeep(csv);
  if (!csv.flush()) throw std::runtime_error(options.out + ": cannot be written to");
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Speed and errors of queries of meshes that turn; writes motions.csv."};
  app.add_option("out", options.out, "Folder for the table")->required();
  app.add_option("--queries", options.queries, "For each scene and kind of motion")
      ->check(CLI::PositiveNumber);
  app.add_option("--samples", options.samples, "Poses that are tried to find the truth")
      ->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
  return 0;
}
