// SPDX-License-Identifier: BSD-3-Clause
//
// Speed and errors of queries of shapes, beside FCL's methods, for every pair of kinds.
// doc/numerics.md explains the report.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "machine.h"
#include "posed_shape.h"
#include "timing.h"

namespace {

using namespace fcl::test;
using fcl::Transform3;
using fcl::Vector3;
using Pose = Transform3<double>;
using Motion = fcl::InterpMotion<double>;

constexpr double kNever = 2;
constexpr double kTocErr = 1e-4;
/// The reference is wrong by about 1e-6 in the distance of overlap.
constexpr double kTimeError = 1e-4;
const char* const kMesh = "mesh";

struct Body {
  std::shared_ptr<fcl::CollisionGeometry<double>> geometry;
  std::vector<PosedShape> parts;
  std::shared_ptr<Motion> motion;

  void place(double t) {
    const Motion copy(*motion);
    copy.integrate(t);
    Pose pose;
    copy.getCurrentTransform(pose);
    for (PosedShape& part : parts) part.pose = pose;
  }
};

Pose randomPose(Random& random) {
  Pose pose = Pose::Identity();
  pose.linear() = fcl::AngleAxis<double>(random.uniform(0, 3), randomDirection(random))
                      .toRotationMatrix();
  pose.translation() = random.uniform(0, 2) * randomDirection(random);
  return pose;
}

/// 5,000 triangles.
Body meshBody() {
  static const TestMesh mesh = [] {
    TestMesh out = makeUvSphere(50, 51, 0.5);
    for (auto& p : out.vertices) p *= 1 + 0.1 * std::sin(9 * p[0]) * std::sin(7 * p[1]);
    return out;
  }();
  static const auto model = [] {
    auto out = std::make_shared<fcl::BVHModel<fcl::OBBRSS<double>>>();
    out->beginModel();
    out->addSubModel(mesh.vertices, mesh.triangles);
    out->endModel();
    return out;
  }();
  Body body;
  body.geometry = model;
  for (const fcl::Triangle& t : mesh.triangles)
    body.parts.push_back(
        posedTriangle(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
  return body;
}

Body randomBody(const std::string& kind, Random& random) {
  Body body;
  if (kind == kMesh) {
    body = meshBody();
  } else {
    body.parts.push_back(randomShape(kind, random));
    body.geometry = body.parts.front().geometry;
  }
  const Pose begin = randomPose(random);
  const fcl::Matrix3<double> turn =
      fcl::AngleAxis<double>(random.uniform(0, 3), randomDirection(random))
          .toRotationMatrix();
  const Vector3<double> end =
      begin.translation() + random.uniform(0, 2) * randomDirection(random);
  body.motion =
      std::make_shared<Motion>(begin.linear(), begin.translation(), turn * begin.linear(),
                               end, Vector3<double>::Zero());
  return body;
}

bool overlapAt(double t, Body& a, Body& b) {
  a.place(t);
  b.place(t);
  for (const PosedShape& x : a.parts)
    for (const PosedShape& y : b.parts)
      if (!areFar(x, y) && overlap(x, y)) return true;
  return false;
}

/// The first of 100 samples at which the bodies overlap, made finer.
double firstOverlap(Body& a, Body& b) {
  constexpr int kSamples = 100;
  for (int i = 0; i <= kSamples; ++i) {
    double hi = static_cast<double>(i) / kSamples, lo = hi - 1. / kSamples;
    if (!overlapAt(hi, a, b)) continue;
    for (int round = 0; i > 0 && round < 12; ++round) {
      const double middle = 0.5 * (lo + hi);
      (overlapAt(middle, a, b) ? hi : lo) = middle;
    }
    return hi;
  }
  return kNever;
}

struct Query {
  Body a, b;
  /// kNever: no contact.
  double first;
};

double ask(const Query& query, const fcl::ContinuousCollisionRequest<double>& request,
           bool of_stock) {
  fcl::ContinuousCollisionResult<double> result;
  const Motion motion1(*query.a.motion), motion2(*query.b.motion);
  if (of_stock)
    fcl::continuousCollide<double>(query.a.geometry.get(), &motion1,
                                   query.b.geometry.get(), &motion2, request, result);
  else
    continuousCollide(query.a.geometry.get(), &motion1, query.b.geometry.get(), &motion2,
                      request, result);
  return result.is_collide ? double{result.time_of_contact} : kNever;
}

struct Method {
  std::string name;
  fcl::ContinuousCollisionRequest<double> request;
  bool is_stock;
};

std::vector<Method> methods() {
  std::vector<Method> out(4);
  out[0].name = "fcl-ccd";
  out[1].name = "FCL-naive-10";
  out[2].name = "FCL-naive-1000";
  out[3].name = "FCL-advancement";
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].is_stock = i > 0;
    out[i].request.toc_err = kTocErr;
  }
  out[2].request.num_max_iterations = 1000;
  out[2].request.toc_err = 1e-6;
  out[3].request.ccd_solver_type = fcl::CCDC_CONSERVATIVE_ADVANCEMENT;
  return out;
}

/// FCL crashes, or has no function and prints.
bool isUsable(const Method& method, const std::string& a, const std::string& b) {
  const auto has = [&](const char* kind) { return a == kind || b == kind; };
  const bool flat = has("plane") || has("halfspace");
  if (!method.is_stock) return true;
  if ((flat && has("convex")) || has("triangle")) return false;
  if (method.name != "FCL-advancement") return true;
  return !flat && !has("ellipsoid") && !(has(kMesh) && has("sphere"));
}

struct Errors {
  int missed{0}, late{0}, invented{0}, early{0};
  double max_early{0}, max_late{0};

  void add(double truth, double time) {
    if (truth == kNever) {
      invented += time != kNever;
    } else if (time == kNever) {
      ++missed;
    } else {
      late += time > truth + kTimeError;
      early += time < truth - 2 * kTocErr;
      max_late = std::max(max_late, time - truth);
      max_early = std::max(max_early, truth - time);
    }
  }
};

/// The least of three runs; of one, if it takes long.
double millisecondsToAsk(const Query& query, const Method& method, double& time) {
  constexpr double kLong = 100;
  const auto run = [&] { time = ask(query, method.request, method.is_stock); };
  const double first = millisecondsOf(run);
  return first > kLong ? first : std::min(first, leastMilliseconds(2, run));
}

double quantile(std::vector<double>& times, std::size_t percent) {
  std::sort(times.begin(), times.end());
  return times.empty() ? 0 : times[times.size() * percent / 100];
}

void measure(const Method& method, const std::string& pair,
             const std::vector<Query>& queries, std::FILE* out) {
  Errors errors;
  std::vector<double> times, reached;
  int contacts = 0;
  for (const Query& query : queries) {
    double time = kNever;
    times.push_back(millisecondsToAsk(query, method, time));
    errors.add(query.first, time);
    contacts += query.first != kNever;
    if (query.first > 0 && query.first != kNever) reached.push_back(times.back());
  }
  std::fprintf(out, "%s,%s,%zu,%d,%d,%d,%d,%d,%.2g,%.2g,%.4f,%.4f,%.4f,%s\n",
               pair.c_str(), method.name.c_str(), queries.size(), contacts, errors.missed,
               errors.late, errors.invented, errors.early, errors.max_early,
               errors.max_late, quantile(times, 50), quantile(times, 99),
               quantile(reached, 50), machineName().c_str());
  std::fflush(out);
}

/// The truth of a query: what dense sampling shows; or a contact that the library proves
/// to be there, which samples may pass over.
double truthOf(Query& query) {
  const double sampled = firstOverlap(query.a, query.b);
  fcl::ContinuousContactRequest<double> request;
  request.query = fcl::ContinuousQuery::kFirst;
  request.toc_err = 1e-9;
  fcl::ContinuousContactResult<double> result;
  const Motion motion1(*query.a.motion), motion2(*query.b.motion);
  continuousCollide(query.a.geometry.get(), &motion1, query.b.geometry.get(), &motion2,
                    request, result);
  if (!result.is_collide || result.contacts.empty()) return sampled;
  const auto& first = result.contacts.front();
  return first.within_tolerance ? sampled : std::min(sampled, first.toc_hi);
}

void run(int num_queries, const std::string& only, const std::string& only_method,
         const std::string& folder) {
  const std::vector<std::string> kinds = {"sphere", "capsule",   "box",    "ellipsoid",
                                          "cone",   "cylinder",  "convex", "triangle",
                                          "plane",  "halfspace", kMesh};
  std::filesystem::create_directories(folder);
  std::FILE* out = std::fopen((folder + "/shapes.csv").c_str(), "w");
  if (!out) throw std::runtime_error("cannot write " + folder + "/shapes.csv");
  std::fprintf(out,
               "pair,method,queries,contacts,missed,late,false,early,max_early,"
               "max_late,ms_median,ms_p99,ms_median_reached,machine\n");
  std::uint64_t seed = 0;
  for (std::size_t i = 0; i < kinds.size(); ++i)
    for (std::size_t j = i; j < kinds.size(); ++j) {
      const bool flat = kinds[i] == "plane" || kinds[i] == "halfspace";
      if (kinds[i] == kMesh || (flat && kinds[j] != kMesh)) continue;
      Random random(++seed);
      const std::string pair = kinds[i] + "-" + kinds[j];
      if (!only.empty() && only != pair) continue;
      std::vector<Query> queries;
      for (int k = 0; k < num_queries; ++k) {
        Query query{randomBody(kinds[j], random), randomBody(kinds[i], random), 0};
        query.first = truthOf(query);
        queries.push_back(std::move(query));
      }
      for (const Method& method : methods())
        if (isUsable(method, kinds[i], kinds[j]) &&
            (only_method.empty() || only_method == method.name))
          measure(method, pair, queries, out);
    }
  std::fclose(out);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Speed and errors of queries of shapes");
  std::string folder, only, only_method;
  int queries = 200;
  app.add_option("folder", folder, "where the table goes")->required();
  app.add_option("--queries", queries, "for each pair of kinds")->capture_default_str();
  app.add_option("--pair", only, "only this one, for example sphere-mesh");
  app.add_option("--method", only_method, "only this one, for example fcl-ccd");
  CLI11_PARSE(app, argc, argv);
  try {
    run(queries, only, only_method, folder);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fcl_ccd_shapes: %s\n", error.what());
    return 1;
  }
  return 0;
}
