// SPDX-License-Identifier: BSD-3-Clause
#include "demo_table.h"

#include <cstdint>
#include <iomanip>
#include <sstream>

namespace fcl {
namespace test {
namespace {

// One line of the table a line here.
// clang-format off
const char kTableHead[] =
    "                      contacts                  time (ms)     candidates: pairs of       pairs of features culled by             exact\n"
    "frame triangles CCDs    VF    EE  self  first    CCD  total   nodes  triang. features     box  filter  solver   exact contacts   tests\n";
const char kTableFoot[] =
    "CCDs: continuous queries. Each frame has several steps, and a step repeats its query until the\n"
    "corrected motion has no contact left; times and candidates sum over these queries.\n"
    "VF, EE: distinct vertex-face and edge-edge pairs that touched during the frame; self: those of\n"
    "them between two places of the cloth; first: when, as a fraction of the frame.\n"
    "exact tests: pairs that rounding left open and integers decided, either way.\n";
// clang-format on

/// Four digits at most: 987, 12.3k, 4.56M.
std::string shortened(std::uint64_t count) {
  if (count < 1000) return std::to_string(count);
  const char* units = "kMGT";
  double value = static_cast<double>(count) / 1000;
  while (value >= 999.5 && units[1] != '\0') {
    value /= 1000;
    ++units;
  }
  std::ostringstream text;
  text << std::fixed
       << std::setprecision(value < 9.995   ? 2
                            : value < 99.95 ? 1
                                            : 0)
       << value << *units;
  return text.str();
}

void writeCounts(std::ostream& out, const StageCounts& c) {
  const auto column = [&](int width, std::uint64_t count) {
    out << std::setw(width) << shortened(count);
  };
  column(8, c.node_pairs);
  column(9, c.triangle_pairs);
  column(9, c.feature_pairs);
  column(8, c.box_culled);
  column(8, c.filter_culled);
  column(8, c.solver_culled);
  column(8, c.exact_culled);
  column(9, c.contacts);
  column(8, c.exact_tests);
  out << '\n';
}

FrameReport sumOf(const std::vector<FrameReport>& reports) {
  FrameReport sum;
  for (const FrameReport& r : reports) {
    sum.vertex_face += r.vertex_face;
    sum.edge_edge += r.edge_edge;
    sum.self += r.self;
    sum.queries += r.queries;
    sum.query_seconds += r.query_seconds;
    sum.total_seconds += r.total_seconds;
    sum.held_vertices += r.held_vertices;
    sum.counts += r.counts;
  }
  return sum;
}

}  // namespace

std::string formatTable(const std::vector<FrameReport>& reports, std::size_t triangles) {
  std::ostringstream out;
  out << kTableHead << std::fixed;
  const auto writeRow = [&](const FrameReport& r) {
    out << std::setw(6) << r.queries << std::setw(6) << r.vertex_face << std::setw(6)
        << r.edge_edge << std::setw(6) << r.self;
    if (r.first_contact < 1)
      out << std::setw(7) << std::setprecision(3) << r.first_contact;
    else
      out << std::setw(7) << '-';
    out << std::setprecision(0) << std::setw(7) << 1000 * r.query_seconds << std::setw(7)
        << 1000 * r.total_seconds;
    writeCounts(out, r.counts);
  };
  for (std::size_t i = 0; i < reports.size(); ++i) {
    out << std::setw(5) << i + 1 << std::setw(9) << triangles;
    writeRow(reports[i]);
  }
  out << "  all         ";
  writeRow(sumOf(reports));
  out << kTableFoot;
  return out.str();
}

std::string formatCsv(const std::vector<FrameReport>& reports, std::size_t triangles) {
  std::ostringstream out;
  out << "frame,triangles,queries,vertex_face,edge_edge,self,first_contact,query_ms,"
         "total_ms,held_vertices,node_pairs,triangle_pairs,adjacent_pairs,fan_culled,"
         "plane_culled,feature_pairs,"
         "box_culled,filter_culled,solver_culled,exact_culled,exact_tests,contacts,"
         "crossing_tests\n";
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const FrameReport& r = reports[i];
    const StageCounts& c = r.counts;
    out << i + 1 << ',' << triangles << ',' << r.queries << ',' << r.vertex_face << ','
        << r.edge_edge << ',' << r.self << ',' << r.first_contact << ','
        << 1000 * r.query_seconds << ',' << 1000 * r.total_seconds << ','
        << r.held_vertices << ',' << c.node_pairs << ',' << c.triangle_pairs << ','
        << c.adjacent_pairs << ',' << c.fan_culled << ',' << c.plane_culled << ','
        << c.feature_pairs << ',' << c.box_culled << ',' << c.filter_culled << ','
        << c.solver_culled << ',' << c.exact_culled << ',' << c.exact_tests << ','
        << c.contacts << ',' << c.crossing_tests << '\n';
  }
  return out.str();
}

}  // namespace test
}  // namespace fcl
