// SPDX-License-Identifier: BSD-3-Clause
//
// The paper's experiments, run again: its scenes frame by frame, by the methods that it
// compares and by the library. doc/reproduction.md explains the report.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "edge_picture.h"
#include "filter_figures.h"
#include "frame_folder.h"
#include "output_file.h"
#include "pair_census.h"
#include "paper_scenes.h"
#include "scene_figures.h"
#include "tables.h"

namespace {

using namespace fcl::test;

struct Options {
  std::string out;
  std::string frames;
  FrameKind kind{FrameKind::kProposed};
  std::vector<std::string> scenes;
  int every{0};
  Effort effort{3, 0.25};
  std::size_t sample{20000};

  /// Each third of the lion: a frame takes minutes.
  int everyOf(SceneKind kind) const {
    return every > 0 ? every : kind == SceneKind::kLion ? 3 : 1;
  }
};

/// What is found of a scene before any time is measured.
struct Census {
  std::vector<std::vector<PairName>> contacts;  // of each frame
  CandidateCounts moving;
  PairSample sample;
  TestedEdgeSets edges;  // of one frame

  std::size_t numContacts() const {
    std::size_t sum = 0;
    for (const auto& names : contacts) sum += names.size();
    return sum;
  }
};

/// The frame of Figure 6: late enough for folds.
std::size_t pictureFrame(const FrameFolder& folder) { return 2 * folder.size() / 3; }

Census takeCensus(const SceneInfo& info, const FrameFolder& folder, std::size_t sample) {
  Census census{{}, {}, PairSample(sample), {}};
  SweptPairs swept;
  MovingPairs moving;
  for (std::size_t i = 0; i < folder.size(); ++i) {
    const FramePairMesh frame = folder.read(i);
    const bool keeps_edges = info.kind == SceneKind::kCloth && i == pictureFrame(folder);
    census.contacts.push_back(swept.visit(frame, [&](const MetPair& pair) {
      census.sample.add(pair);
      if (!keeps_edges || pair.kind != fcl::ContinuousContactKind::kEdgeEdge) return;
      census.edges.boxes.add(pair.points);
      if (!pair.is_culled) census.edges.plain.add(pair.points);
    }));
    census.moving += moving.count(frame, census.contacts.back(),
                                  keeps_edges ? &census.edges.moving : nullptr);
    std::fprintf(stderr, "%s frame %d: %zu contacts\n", info.name.c_str(),
                 folder.number(i), census.contacts.back().size());
  }
  return census;
}

/// All methods through all frames, against the census' contacts.
void measureMethods(const FrameFolder& folder, const Census& census, const Effort& effort,
                    SceneFigures& figures) {
  std::vector<double> first_times;
  for (const ListedMethod& listed : listMethods(figures.triangles)) {
    const auto score = [&](std::size_t i, const FrameAnswer& answer) {
      Errors errors = errorsOf(answer.contacts, census.contacts[i]);
      if (listed.name == kOurs) first_times.push_back(answer.time_of_contact);
      // It need not list the others; a wrong time is what it can miss.
      if (listed.name == kOursFirst)
        errors.missed = answer.time_of_contact != first_times[i];
      return errors;
    };
    figures.methods.push_back(measureMethod(listed, folder, effort, score));
    const MethodFigures& method = figures.methods.back();
    std::fprintf(stderr, "%s: %s, %s filter, %s: %.2f ms\n", figures.scene.c_str(),
                 method.name.c_str(), method.filter.c_str(), method.kernels.c_str(),
                 method.meanMs());
  }
}

void writePicture(const std::string& path, const Image& image) {
  fcl_ccd::OutputFile file(path);
  file.write(encodePng(image));
  file.finish();
  file.publish();
}

void runScene(const SceneInfo& info, const Options& options, PaperTables& tables) {
  const int every = options.everyOf(info.kind);
  const FrameFolder folder(options.frames + "/" + info.name, options.kind, every);
  const FramePairMesh last = folder.read(folder.size() - 1);
  const Census census = takeCensus(info, folder, options.sample);
  SceneFigures figures{info.name,
                       info.paper_triangles,
                       every,
                       last.triangles.size(),
                       last.previous.size(),
                       census.numContacts(),
                       {}};
  measureMethods(folder, census, options.effort, figures);
  tables.addScene(figures);
  tables.addCulling(figures, census.moving);
  if (info.kind == SceneKind::kFlamenco) tables.addTimes(figures);
  if (info.kind == SceneKind::kBalls || info.kind == SceneKind::kCloth ||
      info.kind == SceneKind::kFlamenco)
    tables.addRatios(figures);
  tables.addFilter(info.name,
                   measureFilter(census.sample.pairs(), options.effort.repeats));
  if (info.kind != SceneKind::kCloth) return;
  const std::size_t i = pictureFrame(folder);
  tables.addEdges(info.name, folder.number(i), census.edges);
  writePicture(options.out + "/figure6.png",
               drawTestedEdges(info.kind, folder.read(i), census.edges));
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "The paper's experiments on simulated scenes; writes table1.csv and a table for "
      "each figure."};
  app.add_option("out", options.out, "Folder for the tables")->required();
  app.add_option("--frames", options.frames,
                 "Folder with the frames, where fcl_ccd_scenes --meshes left them")
      ->required();
  const std::map<std::string, FrameKind> kinds{{"proposed", FrameKind::kProposed},
                                               {"answered", FrameKind::kAnswered}};
  app.add_option("--kind", options.kind,
                 "Motions to where nothing is in the way, or steps whose contacts were "
                 "answered")
      ->transform(CLI::CheckedTransformer(kinds));
  std::vector<std::string> names;
  for (const SceneInfo& info : sceneInfos()) names.push_back(info.name);
  options.scenes = names;
  app.add_option("--scenes", options.scenes, "Which ones")->check(CLI::IsMember(names));
  app.add_option("--every", options.every,
                 "Measure each so many-th frame; by default all, of the lion each third")
      ->check(CLI::PositiveNumber);
  app.add_option("--repeats", options.effort.repeats,
                 "The time of a frame is the least of so many")
      ->check(CLI::PositiveNumber);
  app.add_option("--seconds", options.effort.seconds,
                 "No further repeat of a frame once so much time is spent on it")
      ->check(CLI::PositiveNumber);
  app.add_option("--sample", options.sample,
                 "Pairs of each scene on which filter and solver are timed")
      ->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    PaperTables tables(options.out);
    for (const SceneInfo& info : sceneInfos())
      if (std::count(options.scenes.begin(), options.scenes.end(), info.name) > 0)
        runScene(info, options, tables);
    tables.finish();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
}
