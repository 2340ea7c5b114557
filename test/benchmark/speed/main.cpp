// SPDX-License-Identifier: BSD-3-Clause
//
// Speed of whole queries: the library's beside the paper's method, on public and on
// generated scenes. doc/speed.md explains the report.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <initializer_list>
#include <string>
#include <vector>

#include "machine.h"
#include "rows.h"
#include "table.h"

namespace {

using namespace fcl::test;
using Query = fcl::ContinuousQuery;

struct Options {
  std::string out;
  std::string data;
  std::vector<std::string> groups{"data", "smooth",   "size",      "first",
                                  "far",  "sequence", "baselines", "options"};
  Effort effort;
  int max_triangles{10000000};
  bool is_short{false};
  /// Only what the ablation has of the library, without vector instructions.
  bool is_scalar{false};

  /// The number for a report, or the one for a look whether everything runs.
  int pick(int full, int brief) const { return is_short ? brief : full; }
};

SpeedScene smoothCloth(int triangles) {
  char size[16];
  if (triangles < 1000000)
    std::snprintf(size, sizeof size, "%dK", triangles / 1000);
  else
    std::snprintf(size, sizeof size, "%.1fM", triangles / 1e6);
  return {std::string("smooth cloth ") + size, makeSmoothCloth(triangles)};
}

enum class PaperRows { kNone, kPublished, kAblation };

/// One thread, and all where there are more.
std::vector<int> threadNumbers() {
  std::vector<int> numbers{1};
  if (allThreads() > 1) numbers.push_back(allThreads());
  return numbers;
}

/// The rows of a self-collision, all contacts first.
/// @param queries  of the library
/// @return the true contacts, or else what is found
std::vector<PairName> addSelf(Table& table, const SpeedScene& scene,
                              const Options& options,
                              std::initializer_list<Query> queries, PaperRows paper,
                              const std::vector<PairName>* known_truth = nullptr) {
  std::vector<PairName> truth;
  table.add(measureLibrary(scene, Query::kAll, 1, options.effort, known_truth, &truth));
  if (known_truth) truth = *known_truth;
  if (paper == PaperRows::kAblation)
    table.add(measureSwept(scene, options.effort, truth));
  if (options.is_scalar) return truth;
  for (const Query query : queries)
    for (const int threads : threadNumbers())
      if (query != Query::kAll || threads != 1)
        table.add(measureLibrary(scene, query, threads, options.effort, &truth));
  for (const KernelSet kernels : {KernelSet::kScalar, KernelSet::kVector})
    for (const std::string boxes : {"swept", "moving"})
      for (const std::string filter : {"none", "plain", "certified"})
        if (paper == PaperRows::kAblation ||
            (paper == PaperRows::kPublished && kernels == KernelSet::kScalar &&
             boxes == "swept" && filter == "plain"))
          table.add(measurePaper(scene, boxes, filter, kernels, options.effort, truth));
  return truth;
}

/// A scene of the data folder and its true contacts.
struct DataScene {
  SpeedScene scene;
  std::vector<PairName> truth;
};

std::vector<DataScene> readDataScenes(const Options& options) {
  std::vector<DataScene> scenes;
  if (options.data.empty()) {
    std::fprintf(stderr, "no data folder: generated scenes only\n");
    return scenes;
  }
  const struct {
    const char *name, *previous, *current;
  } sources[] = {{"cloth-ball", "92.ply", "93.ply"}, {"n-body", "18.ply", "19.ply"}};
  for (const auto& files : sources) {
    const std::string folder = options.data + "/scenes/" + files.name + "/";
    const auto pairs = readTruePairs(folder + "true_pairs.csv.gz");
    scenes.push_back(
        {{files.name, readFramePair(folder + files.previous, folder + files.current)},
         {pairs.begin(), pairs.end()}});
  }
  return scenes;
}

void runData(Table& table, const Options& options) {
  for (const DataScene& data : readDataScenes(options))
    addSelf(table, data.scene, options, {Query::kAll, Query::kFirst, Query::kAny},
            PaperRows::kAblation, &data.truth);
}

void runSmooth(Table& table, const Options& options) {
  for (const int triangles :
       {options.pick(20000, 1000), options.pick(80000, 2000), options.pick(200000, 4000)})
    addSelf(table, smoothCloth(triangles), options,
            {Query::kAll, Query::kFirst, Query::kAny}, PaperRows::kAblation);
}

void runSize(Table& table, const Options& options) {
  /// Above, the paper's method says nothing new.
  constexpr int kMostForPaper = 1000000;
  for (const int triangles : {10000, 30000, 100000, 300000, 1000000, 3000000, 10000000}) {
    if (triangles > options.pick(options.max_triangles, 10000)) break;
    addSelf(table, {"tiles", makeTiles(triangles)}, options, {Query::kAll, Query::kFirst},
            triangles <= kMostForPaper ? PaperRows::kPublished : PaperRows::kNone);
  }
}

/// Scenes that are free of contact when the step begins.
void runFirst(Table& table, const Options& options) {
  auto bodies = makeMeetingBodies(options.pick(6, 2));
  const SpeedScene pair{"meeting bodies", std::move(bodies.first),
                        std::move(bodies.second)};
  for (const Query query : {Query::kAll, Query::kFirst, Query::kAny})
    for (const int threads : threadNumbers())
      table.add(measureLibrary(pair, query, threads, options.effort, nullptr));
  addSelf(table, smoothCloth(options.pick(1600000, 8000)), options,
          {Query::kAll, Query::kFirst, Query::kAny}, PaperRows::kNone);
}

void runFar(Table& table, const Options& options) {
  SpeedScene scene{"cloth at the origin", makeSmoothCloth(options.pick(80000, 2000))};
  const auto queries = {Query::kAll, Query::kFirst};
  const auto truth = addSelf(table, scene, options, queries, PaperRows::kNone);
  scene.name = "cloth at 1e6";
  move(scene.a, {1e6, 1e6, 1e6});
  addSelf(table, scene, options, queries, PaperRows::kPublished, &truth);
}

/// The rows of a sequence, and two in the main table: the means of its steps.
void addSequence(Table& table, const std::string& name, const FrameSequence& sequence,
                 const Options& options) {
  const auto steps = measureSequence(name, sequence, options.effort);
  const auto n = static_cast<double>(steps.size());
  for (const bool fresh : {false, true}) {
    Row row = libraryRow(name + (fresh ? " (fresh tree)" : " (kept tree)"),
                         sequence.triangles.size(), Query::kAll, 1);
    Hash hash;
    for (const SequenceRow& step : steps) {
      const StepTimes& times = fresh ? step.fresh : step.kept;
      row.build += (fresh ? step.fresh_build : step.kept_build) / n;
      row.times.update += times.update / n;
      row.times.traverse += times.traverse / n;
      row.times.test += times.test / n;
      row.contacts += step.contacts;
      hash.add(step.hash);
    }
    row.hash = hash.value();
    table.add(row);
  }
  for (const SequenceRow& step : steps) table.add(step);
}

void runSequences(Table& table, const Options& options) {
  const int frames = options.pick(61, 4);
  FrameSequence sheet = makeCrumplingSheet(frames);
  addSequence(table, "crumple", sheet, options);
  std::reverse(sheet.frames.begin(), sheet.frames.end());
  addSequence(table, "unfold", sheet, options);
  addSequence(table, "wave", makeWavingCloth(frames), options);
  addSequence(table, "mix", makeMixingBalls(frames), options);
}

void runBaselines(Table& table, const Options& options) {
  const auto add = [&](const SpeedScene& scene, const std::vector<PairName>& truth) {
    for (const BaselineRow& row : measureBaselines(scene, options.effort, truth))
      table.add(row);
  };
  for (const DataScene& data : readDataScenes(options)) add(data.scene, data.truth);
  for (const SpeedScene& scene :
       {smoothCloth(options.pick(80000, 2000)),
        SpeedScene{"tiles", makeTiles(options.pick(100000, 2000))}}) {
    std::vector<PairName> truth;
    measureLibrary(scene, Query::kAll, 1, {1, 0}, nullptr, &truth);
    add(scene, truth);
  }
}

/// Each option of a request, off and on.
void runOptions(Table& table, const Options& options) {
  const auto add = [&](const SpeedScene& scene) {
    for (const OptionRow& row : measureOptions(scene, options.effort)) table.add(row);
  };
  for (const DataScene& data : readDataScenes(options)) add(data.scene);
  add(smoothCloth(options.pick(80000, 2000)));
  auto layers = makeLayers(options.pick(20000, 800));
  add({"layers", std::move(layers.first), std::move(layers.second)});
  auto spheres = makeThrownSpheres(options.pick(4, 1));
  add({"thrown spheres", std::move(spheres.first), std::move(spheres.second)});
}

void run(const Options& options) {
  Table table(options.out, options.is_scalar);
  const struct {
    const char* name;
    void (*run)(Table&, const Options&);
    bool has_ablation;
  } groups[] = {{"data", runData, true},
                {"smooth", runSmooth, true},
                {"size", runSize, false},
                {"first", runFirst, false},
                {"far", runFar, false},
                {"sequence", runSequences, false},
                {"baselines", runBaselines, false},
                {"options", runOptions, false}};
  for (const auto& group : groups)
    for (const std::string& wanted : options.groups)
      if (wanted == group.name && (group.has_ablation || !options.is_scalar))
        group.run(table, options);
  table.finish();
}

/// Goes on as a run for the scalar rows: kernels are chosen once in a process.
/// @return only if that fails
int runAgain(int argc, char** argv) {
  std::vector<char*> arguments(argv, argv + argc);
  char option[] = "--scalar";
  arguments.push_back(option);
  arguments.push_back(nullptr);
  execvp(argv[0], arguments.data());
  std::perror(argv[0]);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Speed of whole queries; writes speed.csv, speed_sequence.csv, "
      "speed_baselines.csv and speed_options.csv."};
  app.add_option("out", options.out, "Folder for the tables")->required();
  app.add_option("--data", options.data,
                 "Folder with scenes/; without it: generated scenes only");
  app.add_option("--groups", options.groups, "Which scenes, comma between; all if absent")
      ->delimiter(',')
      ->check(CLI::IsMember({"data", "smooth", "size", "first", "far", "sequence",
                             "baselines", "options"}));
  auto* repeats = app.add_option("--repeats", options.effort.repeats,
                                 "Each time is the least of so many")
                      ->check(CLI::PositiveNumber);
  app.add_option("--seconds", options.effort.seconds,
                 "No further repeat of a row once so much time is spent on it")
      ->check(CLI::PositiveNumber);
  app.add_option("--max-triangles", options.max_triangles,
                 "The largest scene of the group size; 10,000,000 need 6 GiB")
      ->check(CLI::PositiveNumber);
  app.add_flag("--short", options.is_short,
               "Small scenes and one repeat: errors, no times to speak of")
      ->excludes(repeats);
  app.add_flag("--scalar", options.is_scalar,
               "Adds to the tables what the ablation has of the library, without vector "
               "instructions; the program ends with this by itself");
  CLI11_PARSE(app, argc, argv);
  if (options.is_short) options.effort.repeats = 1;
  if (options.is_scalar) {
    useScalarKernels();
    // Built for a processor with vector instructions it has none.
    if (libraryKernels() != "scalar") return 0;
  }
  try {
    run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
  return libraryKernels() == "scalar" ? 0 : runAgain(argc, argv);
}
