// SPDX-License-Identifier: BSD-3-Clause
//
// The long comparison of the library with the oracle (test_fcl_oracle is the short one).
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "distance_check.h"
#include "motion_references.h"
#include "query_check.h"
#include "query_csv.h"
#include "scene_check.h"

namespace {

using fcl::ContinuousContactKind;
using fcl::test::CheckTally;

/// Prints every disagreement up to a few, then counts on.
class Complaints {
 public:
  void add(const std::string& name, const std::string& text) {
    if (++count_ <= 10) std::printf("%s\n%s\n", name.c_str(), text.c_str());
  }
  std::size_t count() const { return count_; }

 private:
  std::size_t count_{0};
};

void print(const CheckTally& tally, const Complaints& complaints) {
  std::printf(
      "%zu queries, %zu contacts (%zu at t = 0), decided by box %zu, filter %zu, solver "
      "%zu, integers %zu: %zu disagreements\n",
      tally.queries, tally.contacts, tally.contacts_at_start, tally.decided_by[0],
      tally.decided_by[1], tally.decided_by[2], tally.decided_by[3], complaints.count());
}

void requireSome(const CheckTally& tally) {
  if (tally.queries == 0) throw std::runtime_error("no queries to check");
}

std::size_t checkGenerated(std::uint64_t first, std::uint64_t count) {
  CheckTally tally;
  Complaints complaints;
  for (std::uint64_t number = first; number < first + count; ++number) {
    const std::string text =
        disagreement(fcl::test::generatedQuery(number), number, tally);
    if (!text.empty()) complaints.add("query " + std::to_string(number), text);
  }
  print(tally, complaints);
  requireSome(tally);
  return complaints.count();
}

std::size_t checkDistances(std::uint64_t first, std::uint64_t count) {
  fcl::test::DistanceTally tally;
  Complaints complaints;
  for (std::uint64_t number = first; number < first + count; ++number) {
    const std::string text =
        distanceDisagreement(fcl::test::distanceQuery(number), tally);
    if (!text.empty()) complaints.add("query " + std::to_string(number), text);
  }
  std::printf(
      "%zu queries, %zu contacts (%zu at t = 0, %zu without a proved upper end, %zu "
      "given "
      "up), %zu steps, %zu at most: %zu disagreements\n",
      tally.queries, tally.contacts, tally.contacts_at_start, tally.grazes,
      tally.given_up, tally.steps, tally.most_steps, complaints.count());
  if (tally.queries == 0) throw std::runtime_error("no queries to check");
  return complaints.count();
}

/// Cases of bodies that turn.
template <typename Check>
std::size_t checkMotions(std::uint64_t first, std::uint64_t count, Check&& check) {
  fcl::test::MotionTally tally;
  Complaints complaints;
  for (std::uint64_t number = first; number < first + count; ++number) {
    const std::string text = check(number, tally);
    if (!text.empty()) complaints.add("case " + std::to_string(number), text);
  }
  std::printf("%zu cases (%zu grazes), %zu contacts (%zu cross at t = 0)", tally.cases,
              tally.grazes, tally.contacts, tally.crossings);
  if (tally.sampled + tally.advanced > 0)
    std::printf(", by the reference %zu, by advancement %zu", tally.sampled,
                tally.advanced);
  constexpr const char* kKinds[] = {"interpolation", "screw", "spline"};
  for (int kind = 0; kind < 3; ++kind)
    if (tally.worst_bound[kind][0] > 0)
      std::printf(", %s: %.4f of the bound, deforming %.4f", kKinds[kind],
                  tally.worst_bound[kind][0], tally.worst_bound[kind][1]);
  std::printf(": %zu disagreements\n", complaints.count());
  if (tally.cases == 0) throw std::runtime_error("no cases to check");
  return complaints.count();
}

std::size_t checkMeshes(std::uint64_t first, std::uint64_t count) {
  constexpr int kSamples = 10000;
  const std::vector<fcl::test::Body> bodies = fcl::test::makeBodies();
  return checkMotions(
      first, count, [&](std::uint64_t number, fcl::test::MotionTally& tally) {
        return fcl::test::meshDisagreement(bodies, number, kSamples, tally);
      });
}

std::size_t checkFiles(const std::string& data) {
  CheckTally tally;
  Complaints complaints;
  for (const auto& folder : std::filesystem::directory_iterator(data + "/queries"))
    for (const ContinuousContactKind kind :
         {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge}) {
      const bool vf = kind == ContinuousContactKind::kVertexFace;
      const std::string path =
          folder.path().string() + (vf ? "/vertex-face.csv" : "/edge-edge.csv");
      if (!std::filesystem::exists(path)) continue;
      for (const auto& query : fcl_ccd::readQueries(path).queries) {
        const std::string text = disagreement({kind, query.x}, tally.queries, tally);
        if (!text.empty()) complaints.add(path, text);
      }
    }
  print(tally, complaints);
  requireSome(tally);
  return complaints.count();
}

std::size_t checkScene(const std::string& folder, const std::string& previous,
                       const std::string& current) {
  fcl::test::CullCheckOptions options;
  options.oracle_samples = 25000;
  options.decide_all = true;
  const fcl::test::CullReport report = fcl::test::checkCulledPairs(
      fcl::test::readFramePair(folder + "/" + previous, folder + "/" + current), options);
  for (const auto& stage : report.stages)
    std::printf(
        "%-12s culled %zu, decided exactly %zu, by the oracle %zu: %zu contacts\n",
        stage.name, stage.culled, stage.decided, stage.asked, stage.contacts);
  if (!report.example.empty()) std::printf("%s\n", report.example.c_str());
  return report.contacts();
}

int usage(const char* program) {
  std::fprintf(stderr,
               "usage: %s generated FIRST COUNT\n"
               "       %s distances FIRST COUNT\n"
               "       %s spans|turns|meshes FIRST COUNT\n"
               "       %s queries DATA_FOLDER\n"
               "       %s scene FOLDER PREVIOUS.ply CURRENT.ply\n"
               "Returns 1 if the library and the oracle disagree.\n",
               program, program, program, program, program);
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  try {
    if (what == "generated" && argc == 4)
      return checkGenerated(std::stoull(argv[2]), std::stoull(argv[3])) != 0;
    if (what == "distances" && argc == 4)
      return checkDistances(std::stoull(argv[2]), std::stoull(argv[3])) != 0;
    if (what == "spans" && argc == 4)
      return checkMotions(std::stoull(argv[2]), std::stoull(argv[3]),
                          fcl::test::spanDisagreement) != 0;
    if (what == "turns" && argc == 4)
      return checkMotions(std::stoull(argv[2]), std::stoull(argv[3]),
                          fcl::test::turnDisagreement) != 0;
    if (what == "meshes" && argc == 4)
      return checkMeshes(std::stoull(argv[2]), std::stoull(argv[3])) != 0;
    if (what == "queries" && argc == 3) return checkFiles(argv[2]) != 0;
    if (what == "scene" && argc == 5) return checkScene(argv[2], argv[3], argv[4]) != 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 2;
  }
  return usage(argv[0]);
}
