// SPDX-License-Identifier: BSD-3-Clause
//
// Speed against error of elementary tests at a distance. The truth is the oracle's
// (oracle/exact_oracle.h). doc/thickness.md explains the table.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "distance_methods.h"
#include "machine.h"
#include "oracle/distance_check.h"
#include "oracle/exact_oracle.h"

namespace {

using namespace fcl::test;
using fcl::ContinuousContactKind;

struct Truth {
  /// Comes within d.
  bool contact;
  /// Comes within d (1 + 1e-6).
  bool is_near;
  double toc_lo, toc_hi;
};

struct QuerySet {
  std::string name;
  std::vector<DistanceQuery> queries;
  std::vector<Truth> truth;
};

/// Whether squares stay in the range of double, so that no method is beyond its means.
bool isOfOrdinarySize(const DistanceQuery& query) {
  double size = query.distance;
  for (const auto& p : query.pair.x)
    for (const auto* at : {p.t0, p.t1})
      for (int k = 0; k < 3; ++k) size = std::max(size, std::abs(at[k]));
  return size < 1e6 && query.distance > 1e-12;
}

Truth truthOf(const DistanceQuery& query) {
  const auto x = query.pair.points();
  OracleAnswer answer = askDistanceOracle(query.pair.kind, x, query.distance);
  if (!answer.touch())
    return {false,
            askDistanceOracle(query.pair.kind, x, query.distance * (1 + 1e-6)).touch(), 1,
            1};
  answer.refine(OracleAnswer::Rational(1, 1LL << 55));
  return {true, true, static_cast<double>(answer.lower()),
          static_cast<double>(answer.upper())};
}

/// Queries of VF and EE; the odd numbers are general, the even ones degenerate.
QuerySet generate(const std::string& name, std::uint64_t first, std::size_t count) {
  QuerySet set{name, {}, {}};
  for (std::uint64_t number = first; set.queries.size() < count; number += 2) {
    const DistanceQuery query = distanceQuery(number);
    const bool is_pair = query.pair.kind == ContinuousContactKind::kVertexFace ||
                         query.pair.kind == ContinuousContactKind::kEdgeEdge;
    if (!is_pair || !isOfOrdinarySize(query)) continue;
    set.queries.push_back(query);
    set.truth.push_back(truthOf(query));
  }
  return set;
}

/// The mean time of a query in ns: loops over 50 queries, the least of `repeats` of each.
double measure(const DistanceMethod& method, const QuerySet& set, int repeats,
               std::vector<DistanceAnswer>& answers) {
  using Clock = std::chrono::steady_clock;
  constexpr std::size_t kChunk = 50;
  double sum = 0;
  answers.resize(set.queries.size());
  for (std::size_t first = 0; first < answers.size(); first += kChunk) {
    double least = std::numeric_limits<double>::infinity();
    for (int repeat = 0; repeat < repeats; ++repeat) {
      const auto start = Clock::now();
      for (std::size_t i = first; i < std::min(answers.size(), first + kChunk); ++i)
        answers[i] =
            method.answer(set.queries[i].pair, set.queries[i].distance, method.number);
      const double ns =
          std::chrono::duration<double, std::nano>(Clock::now() - start).count();
      least = std::min(least, ns);
      // What takes long is steady.
      if (ns > 2e8) break;
    }
    sum += least;
  }
  return sum / static_cast<double>(answers.size());
}

void writeRow(std::FILE* out, const DistanceMethod& method, const QuerySet& set,
              int repeats) {
  std::vector<DistanceAnswer> answers;
  const double ns = measure(method, set, repeats, answers);
  std::size_t contacts = 0, missed = 0, invented = 0, far = 0;
  double late = 0, early = 0;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const Truth& truth = set.truth[i];
    contacts += truth.contact;
    missed += truth.contact && !answers[i].contact;
    invented += !truth.contact && answers[i].contact;
    far += !truth.is_near && answers[i].contact;
    if (!truth.contact || !answers[i].contact) continue;
    late = std::max(late, answers[i].toc - truth.toc_hi);
    early = std::max(early, truth.toc_lo - answers[i].toc);
  }
  std::fprintf(out, "%s,%s,%s,%zu,%zu,%zu,%zu,%zu,%.3g,%.3g,%.1f,%s\n", set.name.c_str(),
               method.name.c_str(), method.setting.c_str(), answers.size(), contacts,
               missed, invented, far, late, early, ns, machineName().c_str());
  std::fflush(out);
}

void run(const std::string& folder, std::size_t count, int repeats) {
  std::filesystem::create_directories(folder);
  std::FILE* out = std::fopen((folder + "/distances.csv").c_str(), "w");
  if (!out) throw std::runtime_error(folder + ": cannot be written to");
  std::fputs(
      "set,method,setting,queries,contacts,false_negatives,false_positives,"
      "false_positives_far,max_late,max_early,ns_mean,machine\n",
      out);
  for (const QuerySet& set :
       {generate("general", 1, count), generate("degenerate", 0, count)})
    for (const DistanceMethod& method : distanceMethods())
      writeRow(out, method, set, repeats);
  if (std::fclose(out) != 0) throw std::runtime_error("the table cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Speed against error of elementary tests at a distance; writes distances.csv."};
  std::string folder;
  std::size_t count = 1000;
  int repeats = 5;
  app.add_option("out", folder, "Folder for the table")->required();
  app.add_option("--queries", count, "Of each set")->check(CLI::PositiveNumber);
  app.add_option("--repeats", repeats, "Each time is the least of so many")
      ->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    run(folder, count, repeats);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
  return 0;
}
