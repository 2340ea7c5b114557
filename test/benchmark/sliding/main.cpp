// SPDX-License-Identifier: BSD-3-Clause
//
// Speed and errors of queries of close surfaces that slide or turn in their place: one
// step, beside the same motion cut into equal steps and beside FCL's samples.
// doc/where_the_time_goes.md explains the report.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "effort.h"
#include "fcl/math/motion/screw_motion.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "machine.h"
#include "number.h"
#include "sliding/scenes.h"
#include "timing.h"

namespace {

using namespace fcl::test;
using fcl::ContinuousQuery;
using Motion = std::unique_ptr<fcl::MotionBase<double>>;

constexpr double kTocErr = 1e-4;
/// Two methods round the times of a contact differently.
constexpr double kTimeRounding = 1e-9;
constexpr int kSteps[] = {1, 4, 16, 64};

/// The features of a contact, or the triangle beside a shape.
using Name = std::tuple<int, bool, std::array<int, 5>>;

Name nameOf(const fcl::ContinuousContact<double>& c) {
  using Kind = fcl::ContinuousContactKind;
  if (c.b1 < 0 || c.b2 < 0) return {-1, true, {static_cast<int>(std::max(c.b1, c.b2))}};
  auto ids = c.vertices;
  const bool has_face = c.kind == Kind::kVertexFace;
  if (c.kind == Kind::kEdgeEdge) std::sort(ids.begin(), ids.begin() + 2);
  if (c.kind == Kind::kEdgeEdge || has_face)
    std::sort(ids.begin() + (has_face ? 1 : 2), ids.begin() + 4);
  return {static_cast<int>(c.kind), c.first_on_o1, ids};
}

struct Bracket {
  double lo, hi;
};

/// What a method answers for the whole motion.
struct Answer {
  std::map<Name, Bracket> contacts;
  double first{kNever};
};

/// How an answer differs from another one.
struct Errors {
  std::size_t missed{0}, extra{0}, late{0};
  double time{0};

  void addTimes(const Bracket& found, const Bracket& expected) {
    late += found.lo > expected.hi + kTimeRounding;
    time = std::max(time, std::abs(found.lo - expected.lo));
  }

  void takeWorst(const Errors& other) {
    missed = std::max(missed, other.missed);
    extra = std::max(extra, other.extra);
    late = std::max(late, other.late);
    time = std::max(time, other.time);
  }
};

/// By the first contact alone.
Errors errorsOfFirst(double found, double expected) {
  Errors errors;
  errors.missed = found == kNever && expected != kNever;
  errors.extra = found != kNever && expected == kNever;
  if (found != kNever && expected != kNever)
    errors.addTimes({found, found}, {expected, expected + kTocErr});
  return errors;
}

Errors errorsOf(const Answer& found, const Answer& expected, ContinuousQuery query) {
  if (query == ContinuousQuery::kFirst) return errorsOfFirst(found.first, expected.first);
  Errors errors;
  for (const auto& [name, bracket] : expected.contacts) {
    const auto same = found.contacts.find(name);
    if (same == found.contacts.end())
      ++errors.missed;
    else
      errors.addTimes(same->second, bracket);
  }
  for (const auto& contact : found.contacts)
    errors.extra += expected.contacts.count(contact.first) == 0;
  return errors;
}

Motion motionOf(const Scene& scene, double from, double to) {
  const auto pose = [&](double t) {
    fcl::Transform3<double> out = fcl::Transform3<double>::Identity();
    out.linear() = fcl::AngleAxis<double>(scene.angle * t, fcl::Vector3<double>::UnitZ())
                       .toRotationMatrix();
    out.translation()[2] = scene.way * t;
    return out;
  };
  if (scene.angle == 0)
    return std::make_unique<fcl::TranslationMotion<double>>(pose(from), pose(to));
  return std::make_unique<fcl::ScrewMotion<double>>(pose(from), pose(to));
}

/// One query for each of so many equal steps. The times of each have the same width in
/// the whole motion.
/// @param ms  gets the time of the queries; models that deform are updated before
Answer ask(const Scene& scene, ContinuousQuery query, int steps, double& ms) {
  fcl::ContinuousContactRequest<double> request;
  request.query = query;
  request.toc_err = kTocErr * steps;
  request.min_distance = scene.distance;
  const Motion rest = motionOf(Scene(), 0, 0);
  Answer answer;
  ms = 0;
  for (int i = 0; i < steps; ++i) {
    const double from = double(i) / steps, to = double(i + 1) / steps;
    if (scene.deform) scene.deform(from, to);
    const Motion moving = motionOf(scene, from, to);
    fcl::ContinuousContactResult<double> result;
    ms += cpuMillisecondsOf([&] {
      continuousCollide(scene.moving.get(), moving.get(), scene.still.get(), rest.get(),
                        request, result);
    });
    for (const auto& c : result.contacts) {
      const double hi = c.within_tolerance ? kNever : from + c.toc_hi / steps;
      answer.contacts.emplace(nameOf(c), Bracket{from + c.toc_lo / steps, hi});
    }
    if (result.is_collide && answer.first == kNever)
      answer.first = from + result.time_of_contact / steps;
    if (query == ContinuousQuery::kFirst && result.is_collide) break;
  }
  return answer;
}

/// FCL's ten samples.
double askStock(const Scene& scene) {
  const Motion moving = motionOf(scene, 0, 1), rest = motionOf(Scene(), 0, 0);
  const fcl::ContinuousCollisionRequest<double> request;
  fcl::ContinuousCollisionResult<double> result;
  fcl::continuousCollide<double>(scene.moving.get(), moving.get(), scene.still.get(),
                                 rest.get(), request, result);
  return result.is_collide ? double{result.time_of_contact} : kNever;
}

/// Whether the first time of contact contradicts what is known of the scene.
bool isWrong(const Scene& scene, double first) {
  if (scene.truth == kNever || first == kNever) return scene.truth != first;
  return !std::isnan(scene.truth) && std::abs(first - scene.truth) > 2 * kTocErr;
}

std::string truthOf(const Scene& scene) {
  if (scene.truth == kNever) return "none";
  return std::isnan(scene.truth) ? "some" : number(scene.truth, "%.5f");
}

struct Row {
  std::string method;
  int steps;
  double ms{std::numeric_limits<double>::infinity()};
  std::size_t contacts{0};
  double first{kNever};
  Errors errors{};
};

void write(const Scene& scene, const char* query, double best, const Row& row,
           std::FILE* out) {
  std::fprintf(out, "%s,%s,%s,%d,%.3f,%.2f,%zu,%zu,%zu,%zu,%.2g,%s,%d,%s\n",
               scene.name.c_str(), query, row.method.c_str(), row.steps, row.ms,
               row.ms / best, row.contacts, row.errors.missed, row.errors.extra,
               row.errors.late, row.errors.time, truthOf(scene).c_str(),
               int{isWrong(scene, row.first)}, machineName().c_str());
  std::fflush(out);
}

/// The methods take turns, so that each has its share of quiet moments.
void measure(const Scene& scene, ContinuousQuery query, const Effort& effort,
             std::FILE* out) {
  std::vector<Row> rows;
  for (const int steps : kSteps)
    rows.push_back({steps == 1 ? "fcl-ccd" : "fcl-ccd-cut", steps});
  if (scene.is_for_stock) rows.push_back({"FCL-naive-10", 1});
  std::vector<Answer> answers(rows.size());
  repeat(effort, [&] {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      Answer& answer = answers[i];
      double ms = 0;
      if (i < std::size(kSteps))
        answer = ask(scene, query, rows[i].steps, ms);
      else
        ms = cpuMillisecondsOf([&] { answer.first = askStock(scene); });
      rows[i].ms = std::min(rows[i].ms, ms);
    }
  });
  double best = rows[0].ms;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].contacts = answers[i].contacts.size();
    rows[i].first = answers[i].first;
    if (i >= std::size(kSteps)) {
      rows[i].errors = errorsOfFirst(answers[i].first, answers[0].first);
      continue;
    }
    best = std::min(best, rows[i].ms);
    rows[i].errors = errorsOf(answers[i], answers[0], query);
    rows[0].errors.takeWorst(errorsOf(answers[0], answers[i], query));
  }
  const char* const name = query == ContinuousQuery::kAll ? "all" : "first";
  for (const Row& row : rows) write(scene, name, best, row, out);
}

void run(const std::string& folder, const std::string& only, const Effort& effort) {
  std::filesystem::create_directories(folder);
  std::FILE* out = std::fopen((folder + "/sliding.csv").c_str(), "w");
  if (!out) throw std::runtime_error("cannot write " + folder + "/sliding.csv");
  std::fprintf(out,
               "scene,query,method,steps,ms,ratio,contacts,missed,extra,late,"
               "max_time_error,truth,wrong,machine\n");
  for (const auto& make : slidingScenes()) {
    const Scene scene = make();
    if (!only.empty() && scene.name.find(only) == std::string::npos) continue;
    for (const auto query : {ContinuousQuery::kAll, ContinuousQuery::kFirst})
      measure(scene, query, effort, out);
  }
  std::fclose(out);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Speed and errors of queries of close surfaces that slide");
  std::string folder, only;
  Effort effort;
  app.add_option("folder", folder, "where the table goes")->required();
  app.add_option("--scene", only, "only those with this in their name");
  app.add_option("--repeats", effort.repeats, "the least of so many runs")
      ->capture_default_str();
  app.add_option("--seconds", effort.seconds, "no further run of a scene after this")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    run(folder, only, effort);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fcl_ccd_sliding: %s\n", error.what());
    return 1;
  }
  return 0;
}
