// SPDX-License-Identifier: BSD-3-Clause
//
// Simulates the scenes of the paper's evaluation and writes what they are like, their
// frames as meshes, and pictures. doc/scenes.md explains the files.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "output_file.h"
#include "scene_measure.h"
#include "scene_pictures.h"

namespace {

using namespace fcl::test;

struct Options {
  std::string out;
  std::vector<std::string> scenes;
  SceneOptions scene;
  bool meshes{false};
  std::vector<int> pictures;
};

void writeFile(const std::string& path, const std::string& bytes) {
  fcl_ccd::OutputFile file(path);
  file.write(bytes);
  file.finish();
  file.publish();
}

std::string numbered(int index, const char* ending) {
  char name[32];
  std::snprintf(name, sizeof name, "%04d%s", index, ending);
  return name;
}

/// The ends of two motions: of the frame if nothing is in the way, and of the simulator's
/// last step in it, which ends where the frame ended after all.
void writeMeshes(const std::string& folder, const SceneFrame& frame) {
  const auto write = [&](const char* ending, const auto& positions) {
    writeFile(folder + "/" + numbered(frame.index + 1, ending),
              encodeFrame(frame, positions));
  };
  write("_begin.ply", frame.previous);
  write("_end.ply", frame.current);
  write("_step.ply", frame.step_begin);
  write("_accepted.ply", frame.accepted);
}

void run(const SceneInfo& info, const Options& options) {
  const std::string folder = options.out + "/" + info.name;
  std::filesystem::create_directories(folder);
  fcl_ccd::OutputFile table(folder + "/frames.csv");
  table.write(
      "frame,time,triangles,vertices,changed_triangles,new_vertices,vertex_face,"
      "edge_edge,contacts_per_triangle,started,ended,crossing,query_ms,"
      "simulator_queries,simulator_query_s,simulator_s,held,stopped_steps\n");
  SceneMeasure measure(options.scene.num_threads);
  const auto begin = std::chrono::steady_clock::now();
  generateScene(info.kind, options.scene, [&](const SceneFrame& frame) {
    const FrameFigures figures = measure.measure(frame);
    const auto triangles = static_cast<double>(frame.triangles.size());
    const double density = static_cast<double>(figures.contacts()) / triangles;
    char row[512];
    std::snprintf(
        row, sizeof row,
        "%d,%.4f,%zu,%zu,%zu,%zu,%zu,%zu,%.4f,%zu,%zu,%d,%.3f,%d,%.3f,%.3f,%zu,%d\n",
        frame.index + 1, frame.time, frame.triangles.size(), frame.current.size(),
        frame.change.changed_triangles.size(), frame.change.split_from.size(),
        figures.vertex_face, figures.edge_edge, density, figures.started, figures.ended,
        figures.crossing || frame.report.crossing, 1e3 * figures.query_seconds,
        frame.report.queries, frame.report.query_seconds, frame.report.total_seconds,
        frame.report.held_vertices, frame.report.stopped_steps);
    table.write(row);
    if (options.meshes) writeMeshes(folder, frame);
    if (std::count(options.pictures.begin(), options.pictures.end(), frame.index + 1) > 0)
      writeFile(folder + "/" + numbered(frame.index + 1, ".png"),
                encodePng(drawFrame(info.kind, frame, 640, 480)));
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const bool crossing = figures.crossing || frame.report.crossing;
    std::fprintf(stderr,
                 "%s frame %d: %zu triangles, %zu contacts (%.2f a triangle), %.1f s%s\n",
                 info.name.c_str(), frame.index + 1, frame.triangles.size(),
                 figures.contacts(), density, seconds, crossing ? ", CROSSING" : "");
    return true;
  });
  table.finish();
  table.publish();
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Simulates the scenes of the paper's evaluation."};
  app.add_option("OUT", options.out, "folder for the results, one below it a scene")
      ->required();
  std::vector<std::string> names;
  for (const SceneInfo& info : sceneInfos()) names.push_back(info.name);
  options.scenes = names;
  app.add_option("--scenes", options.scenes, "which ones")->check(CLI::IsMember(names));
  app.add_option("--seed", options.scene.seed, "of everything random");
  app.add_option("--scale", options.scene.scale, "times the paper's number of triangles")
      ->check(CLI::Range(1e-4, 4.0));
  app.add_option("--frames", options.scene.frames, "instead of the scene's own number")
      ->check(CLI::Range(1, 100000));
  app.add_option("--threads", options.scene.num_threads, "of a query")
      ->check(CLI::Range(1, 256));
  app.add_flag("--meshes", options.meshes, "write each frame as PLY");
  app.add_option("--pictures", options.pictures, "frames to draw, counted from 1");
  CLI11_PARSE(app, argc, argv);
  try {
    fcl_ccd::removeTemporariesOnSignal();
    for (const SceneInfo& info : sceneInfos())
      if (std::count(options.scenes.begin(), options.scenes.end(), info.name) > 0)
        run(info, options);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fcl_ccd_scenes: %s\n", error.what());
    return 1;
  }
}
