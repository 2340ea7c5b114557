// SPDX-License-Identifier: BSD-3-Clause
//
// Speed against error of elementary tests: ours, FCL's, plain solvers, and any other that
// is given as a program. doc/speed_error.md explains the report.
#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "report.h"

namespace {

constexpr std::uint64_t kSeed = 20100801;

struct Options {
  std::string out;
  std::string data;
  std::vector<std::string> solvers;
  std::size_t generated{1000000};
  std::size_t sample{200000};
  int repeats{5};
  bool is_short{false};
};

void run(const Options& options) {
  using namespace fcl::test;
  std::vector<OutsideSolver> solvers;
  for (const std::string& text : options.solvers)
    solvers.push_back(parseOutsideSolver(text));

  Report report(options.out, options.repeats);
  const auto add = [&](const QuerySet& set) { report.add(set, solvers); };
  if (options.data.empty()) {
    std::fprintf(stderr, "no data folder: the generated queries only\n");
  } else {
    add(readHardQueries(options.data + "/queries"));
    const std::string scenes = options.data + "/scenes/";
    add(collectScene({"cloth-ball", scenes + "cloth-ball", "92.ply", "93.ply"},
                     options.sample));
    add(collectScene({"n-body", scenes + "n-body", "18.ply", "19.ply"}, options.sample));
  }
  std::fprintf(stderr, "generated: %zu queries, seed %llu\n", options.generated,
               static_cast<unsigned long long>(kSeed));
  add(generateQueries(options.generated, kSeed));
  report.finish();
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Speed against error of elementary tests; writes speed_error.csv and "
      "filter_ratio.csv."};
  app.add_option("out", options.out, "Folder for the tables")->required();
  app.add_option("--data", options.data,
                 "Folder with queries/ and scenes/; without it: generated queries only");
  app.add_option("--solver", options.solvers,
                 "NAME=COMMAND, another solver; see outside_solver.h for what it reads "
                 "and prints. May be repeated.")
      ->allow_extra_args(false);
  auto* generated =
      app.add_option("--generated", options.generated, "Number of generated queries")
          ->check(CLI::PositiveNumber);
  app.add_option("--sample", options.sample, "Number of queries of each scene")
      ->check(CLI::PositiveNumber);
  auto* repeats =
      app.add_option("--repeats", options.repeats, "Each time is the least of so many")
          ->check(CLI::PositiveNumber);
  app.add_flag("--short", options.is_short,
               "2,000 generated queries and one repeat: errors, no times to speak of")
      ->excludes(generated)
      ->excludes(repeats);
  CLI11_PARSE(app, argc, argv);
  if (options.is_short) {
    options.generated = 2000;
    options.repeats = 1;
  }
  try {
    run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
  return 0;
}
