// SPDX-License-Identifier: BSD-3-Clause
//
// Speed and errors of continuousDistance(): two large meshes that turn, and random pairs
// of all kinds. doc/closest_approach.md has what it prints.
#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>

#include "approach/large_meshes.h"
#include "approach_cases.h"

namespace {

/// @return how many random pairs have a wrong answer
int checkRandomPairs(std::uint64_t first, std::uint64_t count) {
  constexpr int kSamples = 40;
  fcl::test::ApproachTally tally;
  int wrong = 0;
  for (std::uint64_t number = first; number < first + count; ++number) {
    const std::string what = fcl::test::approachDisagreement(number, kSamples, tally);
    if (what.empty()) continue;
    ++wrong;
    std::printf("case %llu: %s\n", static_cast<unsigned long long>(number), what.c_str());
  }
  std::printf("%zu pairs of %zu kinds, %zu touch, %zu cut off: %d wrong\n", tally.cases,
              tally.kinds.size(), tally.contacts, tally.cut_off, wrong);
  return wrong;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures continuousDistance().");
  std::uint64_t first = 1, pairs = 1000;
  int motions = 21;
  app.add_option("--first", first, "Number of the first random pair");
  app.add_option("--pairs", pairs, "Random pairs to check");
  app.add_option("--motions", motions, "Motions of the large meshes for each gap");
  CLI11_PARSE(app, argc, argv);
  try {
    int wrong = motions > 0 ? fcl::test::measureLargeMeshes(motions) : 0;
    if (pairs > 0) wrong += checkRandomPairs(first, pairs);
    return wrong == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
