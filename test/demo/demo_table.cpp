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
    "           contacts                  ask  answer:          frame  candidates: pairs of       pairs of features culled by             exact\n"
    "frame     VF     EE   self  first   (ms)  queries   (ms)   (ms)   nodes  triang. features     box  filter  solver   exact contacts   tests\n";
const char kTableFoot[] =
    "A frame has eight steps. Each one asks for the contacts of the motion that it proposes, and then answers\n"
    "them: it corrects the motion and asks again until none is left.\n"
    "VF, EE: distinct vertex-face and edge-edge pairs that would touch during the frame; self: those of\n"
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

DemoFrame sumOf(const std::vector<DemoFrame>& frames) {
  DemoFrame sum;
  for (const DemoFrame& r : frames) {
    sum.vertex_face += r.vertex_face;
    sum.edge_edge += r.edge_edge;
    sum.self += r.self;
    sum.queries += r.queries;
    sum.query_seconds += r.query_seconds;
    sum.response_seconds += r.response_seconds;
    sum.total_seconds += r.total_seconds;
    sum.counts += r.counts;
  }
  return sum;
}

}  // namespace

std::string formatTable(const std::vector<DemoFrame>& frames) {
  std::ostringstream out;
  out << kTableHead << std::fixed;
  const auto writeRow = [&](const DemoFrame& r) {
    out << std::setw(7) << r.vertex_face << std::setw(7) << r.edge_edge << std::setw(7)
        << r.self;
    if (r.first_contact < 1)
      out << std::setw(7) << std::setprecision(3) << r.first_contact;
    else
      out << std::setw(7) << '-';
    out << std::setprecision(0) << std::setw(7) << 1000 * r.query_seconds << std::setw(9)
        << r.queries << std::setw(7) << 1000 * r.response_seconds << std::setw(7)
        << 1000 * r.total_seconds;
    writeCounts(out, r.counts);
  };
  for (const DemoFrame& frame : frames) {
    out << std::setw(5) << frame.number;
    writeRow(frame);
  }
  out << "  all";
  writeRow(sumOf(frames));
  out << kTableFoot;
  return out.str();
}

std::string formatCsv(const std::vector<DemoFrame>& frames) {
  std::ostringstream out;
  out << "frame,vertex_face,edge_edge,self,first_contact,query_ms,response_queries,"
         "response_ms,total_ms,in_zones,stopped,node_pairs,triangle_pairs,"
         "adjacent_pairs,fan_culled,plane_culled,feature_pairs,box_culled,filter_culled,"
         "solver_culled,exact_culled,exact_tests,contacts,crossing_tests\n";
  for (const DemoFrame& r : frames) {
    const StageCounts& c = r.counts;
    out << r.number << ',' << r.vertex_face << ',' << r.edge_edge << ',' << r.self << ','
        << r.first_contact << ',' << 1000 * r.query_seconds << ',' << r.queries << ','
        << 1000 * r.response_seconds << ',' << 1000 * r.total_seconds << ',' << r.in_zones
        << ',' << r.stopped << ',' << c.node_pairs << ',' << c.triangle_pairs << ','
        << c.adjacent_pairs << ',' << c.fan_culled << ',' << c.plane_culled << ','
        << c.feature_pairs << ',' << c.box_culled << ',' << c.filter_culled << ','
        << c.solver_culled << ',' << c.exact_culled << ',' << c.exact_tests << ','
        << c.contacts << ',' << c.crossing_tests << '\n';
  }
  return out.str();
}

}  // namespace test
}  // namespace fcl
