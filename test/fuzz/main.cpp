// SPDX-License-Identifier: BSD-3-Clause
//
// Generated cases of each family against its reference; doc/fuzz.md explains the table.
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "fuzz_run.h"
#include "instruction_sets.h"

namespace {

using fcl::test::Family;
using fcl::test::FamilyRow;
using fcl::test::PlantedFault;
using fcl::test::RunOptions;

/// A fault that ends the program still has a name: the case of the thread.
void nameTheCase(int signal) {
  std::fprintf(stderr, "signal %d in family %s, seed 0x%llx\n", signal,
               fcl::test::currentCase().family,
               static_cast<unsigned long long>(fcl::test::currentCase().seed));
  std::_Exit(1);
}

/// The names between commas; all families if there are none.
std::vector<Family> chosen(const std::vector<std::string>& names) {
  const std::vector<Family> all = fcl::test::families();
  if (names.empty()) return all;
  std::vector<Family> out;
  for (const std::string& name : names) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const Family& family) {
      return family.name == name;
    });
    if (found == all.end()) throw std::invalid_argument("no family " + name);
    out.push_back(*found);
  }
  return out;
}

const char* const kColumns =
    "family,cases,contacts,missed,late,false,early,slowest_us,seconds\n";

void print(std::FILE* out, const FamilyRow& row) {
  const auto number = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  std::fprintf(out, "%s,%llu,%llu,%llu,%llu,%llu,%llu,%.0f,%.1f\n", row.name,
               number(row.sum.cases), number(row.sum.contacts), number(row.sum.missed),
               number(row.sum.late), number(row.sum.invented), number(row.sum.early),
               row.sum.slowest_us, row.seconds);
}

struct Files {
  std::string csv, digests;
};

std::FILE* opened(const std::string& path) {
  if (path.empty()) return nullptr;
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (!file) throw std::runtime_error("cannot write " + path);
  return file;
}

/// @return the number of families with a fault
std::size_t runAll(const std::vector<Family>& families, const RunOptions& options,
                   const Files& files, bool prints_complaints) {
  std::FILE* csv = opened(files.csv);
  std::FILE* digests = opened(files.digests);
  std::size_t wrong = 0;
  for (std::FILE* out : {stdout, csv})
    if (out) std::fputs(kColumns, out);
  for (const Family& family : families) {
    const FamilyRow row = runFamily(family, options, digests);
    for (std::FILE* out : {stdout, csv})
      if (out) print(out, row);
    std::fflush(stdout);
    // An exception is no report of a planted fault.
    wrong += !row.complaints.empty() && (prints_complaints || row.sum.exceptions == 0);
    for (const auto& [seed, text] : row.complaints)
      if (prints_complaints)
        std::printf("family %s, --case 0x%llx\n%s\n", family.name,
                    static_cast<unsigned long long>(seed), text.c_str());
  }
  for (std::FILE* out : {csv, digests})
    if (out) std::fclose(out);
  return wrong;
}

int run(int argc, char** argv) {
  CLI::App app("Random cases of all families against their references");
  RunOptions options;
  Files files;
  std::vector<std::string> names;
  std::string planted;
  double minutes = 0;
  std::uint64_t one_case = 0;
  int set = 0;
  app.add_option("--families", names, "only these")->delimiter(',');
  app.add_option("--seed", options.seed, "chooses the cases")->capture_default_str();
  app.add_option("--cases", options.cases, "of each family; of cheap ones more")
      ->capture_default_str();
  app.add_option("--minutes", minutes, "of all families together, in place of --cases");
  app.add_option("--threads", options.threads, "0: as many as there are cores");
  app.add_option("--csv", files.csv, "the table as a file");
  app.add_option("--digests", files.digests,
                 "a line a case, with a hash of the library's answers");
  app.add_option("--instruction-set", set,
                 "0: the best one of this processor, 1: the next");
  auto* one = app.add_option("--case", one_case, "only this seed of a case");
  app.add_option("--plant", planted, "a fault that each family has to report")
      ->check(CLI::IsMember({"dropped", "late"}));
  CLI11_PARSE(app, argc, argv);

  if (!fcl::test::chooseInstructionSet(set)) {
    std::printf("no further instruction set\n");
    return 2;
  }
  if (one->count() > 0) options.only = &one_case;
  const std::vector<Family> families = chosen(names);
  options.seconds = 60 * minutes / static_cast<double>(families.size());
  if (planted.empty()) {
    const std::size_t wrong = runAll(families, options, files, true);
    // What the tests' support expects of itself.
    return wrong > 0 || testing::UnitTest::GetInstance()->ad_hoc_test_result().Failed();
  }
  plantFault(planted == "late" ? PlantedFault::kLate : PlantedFault::kDropped);
  const std::size_t reported = runAll(families, options, files, false);
  std::printf("%zu of %zu families report the planted fault\n", reported,
              families.size());
  return reported < families.size();
}

}  // namespace

int main(int argc, char** argv) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE}) std::signal(signal, nameTheCase);
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fcl_ccd_fuzz: %s\n", error.what());
    return 1;
  }
}
