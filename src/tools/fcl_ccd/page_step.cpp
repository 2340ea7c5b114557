// SPDX-License-Identifier: BSD-3-Clause
#include "page_step.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "contact_text.h"
#include "moment.h"
#include "process_memory.h"

namespace fcl_ccd {
namespace {

std::string element(const std::string& id, const Json& json, const std::string& bytes) {
  return "<script type=\"application/json\" class=\"" + id + "\">" + scriptText(json) +
         "</script>\n<script type=\"text/plain\" class=\"" + id + "-block\">" +
         packed(bytes) + "</script>\n";
}

/// For each triangle 0, or from 1 to 255 the first time of its contacts.
std::string timesOfTriangles(const StepResult& result, const SceneTriangles& triangles) {
  constexpr double kLatest = 254;
  std::string times(
      triangles.a->size() + (triangles.b != nullptr ? triangles.b->size() : 0), '\0');
  // The earliest last: its time stays.
  for (auto c = result.contacts.rbegin(); c != result.contacts.rend(); ++c)
    for (const std::size_t feature : {0u, 1u})
      if (const auto f = triangleInScene(*c, feature, triangles)) {
        assert(*f < times.size() && 0 <= c->toc_lo && c->toc_lo <= 1);
        times[*f] = static_cast<char>(
            static_cast<unsigned char>(1 + std::floor(kLatest * c->toc_lo)));
      }
  return times;
}

std::string contactsText(const StepResult& result) {
  Json contacts = Json::array();
  const std::size_t count = std::min(result.contacts.size(), kMostContactsOnPage);
  for (std::size_t i = 0; i < count; ++i) contacts.push_back(toJson(result.contacts[i]));
  return contacts.dump();
}

}  // namespace

ViewGrid viewGrid(const SceneFrame& first, std::size_t num_steps) {
  const Vertices vertices = verticesAt(first, first, 0);
  // 500 steps of 10,000 vertices take 20 MB with the second grid if each vertex moves on
  // its own by 100 nodes; vertices that move as their neighbours do take a third.
  constexpr double kShort = 3e6;  // positions
  const bool is_short =
      static_cast<double>(vertices.size()) * static_cast<double>(num_steps) < kShort;
  return ViewGrid::of(vertices, is_short ? 1 << 16 : 1 << 14);
}

std::string pageMesh(const SceneTriangles& triangles, const SceneFrame& first,
                     const ViewGrid& grid) {
  const Mesh whole = meshAt(triangles, first, first, 0);
  std::string bytes;
  appendIds(whole.triangles, bytes);
  appendIds(whole.edges, bytes);
  appendMotion(grid, nullptr, whole.vertices, bytes);
  return element("mesh",
                 {{"vertices", whole.vertices.size()},
                  {"vertices_of_a", first.a->size()},
                  {"triangles", whole.triangles.size()},
                  {"triangles_of_a", triangles.a->size()},
                  {"edges", whole.edges.size()},
                  {"origin", grid.origin},
                  {"spacing", grid.spacing}},
                 bytes);
}

std::string pageStep(const StepReport& report, const SceneTriangles& triangles,
                     const SceneFrame& from, const SceneFrame& to, const ViewGrid& grid,
                     bool is_key) {
  const std::string contacts = contactsText(report.result);
  const std::string times = timesOfTriangles(report.result, triangles);
  const Vertices before = verticesAt(from, from, 0);
  std::string key;
  if (is_key) appendMotion(grid, nullptr, before, key);
  std::string bytes = contacts + times + key;
  appendMotion(grid, &before, verticesAt(to, to, 0), bytes);
  Json json = toJson(report);
  json.erase("stages");
  json["memory_mb"] = processMemory();
  json["sizes"] = {contacts.size(), times.size(), key.size()};
  return element("step", json, bytes);
}

std::string scriptText(const Json& json) {
  // "<" could end the element.
  std::string text;
  constexpr int kOneLine = -1;
  for (const char c : json.dump(kOneLine, ' ', false, Json::error_handler_t::replace))
    c == '<' ? text += "\\u003c" : text += c;
  return text;
}

}  // namespace fcl_ccd
