// SPDX-License-Identifier: BSD-3-Clause
#include "tables.h"

#include <filesystem>
#include <stdexcept>

#include "machine.h"
#include "number.h"

namespace fcl {
namespace test {
namespace {

/// A quotient; "-" where there is none.
std::string ratio(double a, double b, const char* format = "%.2f") {
  return b > 0 ? number(a / b, format) : "-";
}

std::string fields(const Errors& errors) {
  return std::to_string(errors.missed) + ',' + std::to_string(errors.extra);
}

std::string nameFields(const MethodFigures& method) {
  return method.name + ',' + method.filter + ',' + method.kernels + ',';
}

}  // namespace

PaperTables::PaperTables(const std::string& folder) : folder_(folder) {
  std::filesystem::create_directories(folder);
  table1_ = open("table1",
                 "scene,triangles,frames,method,filter,kernels,query_ms,"
                 "speedup_over_iccd,speedup_over_rtriangles,elementary_tests,"
                 "missed,extra");
  scenes_ = open("paper_scenes",
                 "scene,paper_triangles,triangles,vertices,frames,every,"
                 "contacts_a_frame,contacts_a_triangle,machine");
  topologies_ =
      open("paper_topologies", "scene,method,filter,kernels,topologies,take_ms");
  figure6_ = open("figure6", "scene,frame,culling,edge_pairs,edges,share_of_pairs");
  figure8_ = open("figure8",
                  "scene,frames,boxes,filter,elementary_tests,reduction,"
                  "reduction_from_rtriangles,missed,extra");
  figure9_ = open("figure9", "scene,frame,method,filter,kernels,query_ms,missed,extra");
  figure10_ = open("figure10",
                   "scene,frame,boxes,filter,feature_pairs,"
                   "without_penetration,ratio,missed,extra");
  filter_ = open("filter",
                 "scene,pairs,filter_ns,newton_ns,newton_to_filter,left,"
                 "newton_left_ns,newton_left_to_filter,filter_additions,"
                 "filter_multiplications,newton_additions,"
                 "newton_multiplications,newton_divisions,filter_missed,"
                 "newton_missed,newton_extra");
}

std::ofstream PaperTables::open(const std::string& name, const char* columns) const {
  const std::string path = folder_ + "/" + name + ".csv";
  std::ofstream file(path);
  file << columns << '\n';
  if (!file) throw std::runtime_error(path + ": cannot be written to");
  return file;
}

void PaperTables::addScene(const SceneFigures& scene) {
  const double iccd = scene.method("iccd", "none").meanMs();
  const double rtriangles = scene.method("r-triangles", "none").meanMs();
  for (const MethodFigures& method : scene.methods) {
    const double ms = method.meanMs();
    table1_ << scene.scene << ',' << scene.triangles << ',' << method.frames.size() << ','
            << nameFields(method) << number(ms) << ',' << ratio(iccd, ms) << ','
            << ratio(rtriangles, ms) << ','
            << number(method.meanElementaryTests(), "%.0f") << ','
            << fields(method.errors()) << '\n';
    topologies_ << scene.scene << ',' << nameFields(method) << method.takes << ','
                << number(method.take_ms / method.takes) << '\n';
  }
  const double contacts = static_cast<double>(scene.contacts) /
                          static_cast<double>(scene.ours().frames.size());
  scenes_ << scene.scene << ',' << scene.paper_triangles << ',' << scene.triangles << ','
          << scene.vertices << ',' << scene.ours().frames.size() << ',' << scene.every
          << ',' << number(contacts, "%.0f") << ','
          << number(contacts / static_cast<double>(scene.triangles)) << ','
          << machineName() << std::endl;
  table1_.flush();
  topologies_.flush();
}

void PaperTables::addCulling(const SceneFigures& scene, const CandidateCounts& moving) {
  const auto frames = static_cast<double>(scene.ours().frames.size());
  const double rtriangles = scene.method("r-triangles", "none").meanElementaryTests();
  const auto add = [&](const char* boxes, const char* filter, double tests,
                       double unfiltered, const std::string& errors) {
    figure8_ << scene.scene << ',' << frames << ',' << boxes << ',' << filter << ','
             << number(tests, "%.0f") << ',' << ratio(unfiltered, tests) << ','
             << ratio(rtriangles, tests) << ',' << errors << '\n';
  };
  for (const char* technique : {"r-triangles", "iccd"})
    for (const char* filter : {"none", "plain"}) {
      const MethodFigures& method = scene.method(technique, filter);
      add(technique, filter, method.meanElementaryTests(),
          scene.method(technique, "none").meanElementaryTests(), fields(method.errors()));
    }
  const double pairs = static_cast<double>(moving.pairs) / frames;
  const auto missed = [&](std::size_t met) {
    return std::to_string(scene.contacts - met) + ",-";
  };
  add("ours", "none", pairs, pairs, missed(moving.contacts));
  add("ours", "plain", static_cast<double>(moving.left_by_plain) / frames, pairs,
      missed(moving.contacts_left_by_plain));
  add("ours", "certified", scene.ours().meanElementaryTests(), pairs,
      fields(scene.ours().errors()));
  figure8_.flush();
}

void PaperTables::addTimes(const SceneFigures& scene) {
  for (const MethodFigures* method :
       {&scene.method("r-triangles", "none"), &scene.method("iccd", "none"),
        &scene.method("iccd", "plain"), &scene.methods[0], &scene.methods[1]})
    for (const FrameRow& row : method->frames)
      figure9_ << scene.scene << ',' << row.frame << ',' << nameFields(*method)
               << number(row.ms) << ',' << fields(row.errors) << '\n';
  figure9_.flush();
}

void PaperTables::addRatios(const SceneFigures& scene) {
  for (const MethodFigures* method : {&scene.method("iccd", "plain"), &scene.methods[0]})
    for (const FrameRow& row : method->frames) {
      const std::size_t culled = row.feature_pairs - row.elementary_tests;
      figure10_ << scene.scene << ',' << row.frame << ',' << method->name << ','
                << method->filter << ',' << row.feature_pairs << ',' << culled << ','
                << ratio(static_cast<double>(culled),
                         static_cast<double>(row.feature_pairs), "%.4f")
                << ',' << fields(row.errors) << '\n';
    }
  figure10_.flush();
}

void PaperTables::addEdges(const std::string& scene, int frame,
                           const TestedEdgeSets& sets) {
  const struct {
    const char* culling;
    const TestedEdges& edges;
  } rows[] = {
      {"boxes", sets.boxes}, {"boxes and filter", sets.plain}, {"ours", sets.moving}};
  for (const auto& row : rows)
    figure6_ << scene << ',' << frame << ',' << row.culling << ',' << row.edges.pairs
             << ',' << row.edges.edges.size() << ','
             << ratio(static_cast<double>(row.edges.pairs),
                      static_cast<double>(sets.boxes.pairs), "%.4f")
             << '\n';
  figure6_.flush();
}

void PaperTables::addFilter(const std::string& scene, const FilterFigures& f) {
  const auto& plain = f.filter_operations;
  const auto& newton = f.newton_operations;
  filter_ << scene << ',' << f.pairs << ',' << number(f.filter_ns, "%.1f") << ','
          << number(f.newton_ns, "%.1f") << ',' << ratio(f.newton_ns, f.filter_ns) << ','
          << f.left << ',' << number(f.newton_left_ns, "%.1f") << ','
          << ratio(f.newton_left_ns, f.filter_ns) << ','
          << number(plain.additions, "%.1f") << ','
          << number(plain.multiplications, "%.1f") << ','
          << number(newton.additions, "%.1f") << ','
          << number(newton.multiplications, "%.1f") << ','
          << number(newton.divisions, "%.1f") << ',' << f.filter_errors.missed << ','
          << fields(f.newton_errors) << std::endl;
}

void PaperTables::finish() {
  for (std::ofstream* file : {&table1_, &scenes_, &topologies_, &figure6_, &figure8_,
                              &figure9_, &figure10_, &filter_})
    if (!file->flush()) throw std::runtime_error("the tables cannot be written");
}

}  // namespace test
}  // namespace fcl
