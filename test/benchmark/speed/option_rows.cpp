// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "box_sweep.h"
#include "elementary/predicates.h"
#include "mesh_generators.h"
#include "option_query.h"
#include "rows.h"

namespace fcl {
namespace test {
namespace {

using Request = OptionQuery::Request;
using Result = OptionQuery::Result;
using Contact = OptionQuery::Contact;

std::vector<PairName> sorted(std::vector<PairName> names) {
  std::sort(names.begin(), names.end());
  return names;
}

/// The names of the contacts that are accepted.
template <typename Accept>
std::vector<PairName> namesOf(const std::vector<Contact>& contacts, Accept&& accept) {
  std::vector<PairName> names;
  for (const Contact& contact : contacts)
    if (accept(contact)) names.push_back(pairName(contact));
  return sorted(std::move(names));
}

std::vector<PairName> namesOf(const std::vector<Contact>& contacts) {
  return namesOf(contacts, [](const Contact&) { return true; });
}

void setErrors(const std::vector<PairName>& found, const std::vector<PairName>& truth,
               OptionRow& row) {
  const Errors errors = errorsOf(found, truth);
  row.contacts = found.size();
  row.missed = errors.missed;
  row.extra = errors.extra;
}

/// The first contact with a coarse tolerance beside one that is fine.
OptionRow measureCoarse(const OptionQuery& query, const Effort& effort) {
  const Request fine = OptionQuery::request(ContinuousQuery::kFirst, 1e-9);
  const Request coarse = OptionQuery::request(ContinuousQuery::kFirst);
  OptionRow row = query.measure("toc_err 1e-4 for 1e-9", fine, coarse, effort);
  const Result truth = query(OptionQuery::request(ContinuousQuery::kFirst, 0)),
               found = query(coarse);
  row.contacts = found.contacts.size();
  row.missed = truth.is_collide &&
               (!found.is_collide || found.time_of_contact > truth.contacts[0].toc_hi);
  row.extra = found.is_collide && !truth.is_collide;
  return row;
}

/// All contacts in the first tenth of the step.
OptionRow measureTMax(const OptionQuery& query, const Effort& effort) {
  const Request off = OptionQuery::request(ContinuousQuery::kAll);
  Request on = off;
  on.t_max = 0.1;
  OptionRow row = query.measure("t_max 0.1", off, on, effort);
  const Result whole = query(OptionQuery::request(ContinuousQuery::kAll, 0));
  const auto is_in_time = [&](const Contact& c) { return c.toc_hi <= on.t_max; };
  setErrors(namesOf(query(on).contacts), namesOf(whole.contacts, is_in_time), row);
  return row;
}

/// The triangles at each vertex of a mesh, ascending.
std::vector<std::vector<int>> trianglesAtVertices(const FramePairMesh& mesh) {
  std::vector<std::vector<int>> at(mesh.previous.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) at[mesh.triangles[i][k]].push_back(static_cast<int>(i));
  return at;
}

/// Whether a feature, given by its vertices, is held by a triangle of this half.
bool isHeldBy(const std::vector<std::vector<int>>& at, const int* first, const int* last,
              bool lower, int middle) {
  const auto& some = at[static_cast<std::size_t>(*first)];
  return std::any_of(some.begin(), some.end(), [&](int triangle) {
    return (triangle < middle) == lower && std::all_of(first, last, [&](int v) {
             const auto& all = at[static_cast<std::size_t>(v)];
             return std::binary_search(all.begin(), all.end(), triangle);
           });
  });
}

/// Marks of triangles: all may meet, or only those of different halves of the mesh.
void addMarks(const SpeedScene& scene, const OptionQuery& query, const Effort& effort,
              std::vector<OptionRow>& rows) {
  const Request off = OptionQuery::request(ContinuousQuery::kAll);
  const std::vector<Contact> whole = query(off).contacts;
  const std::size_t count = scene.a.triangles.size();

  Request on = off;
  on.filter1.triangle_groups.assign(count, 1);
  on.filter1.triangle_masks.assign(count, 1);
  rows.push_back(query.measure("masks: all meet", off, on, effort));
  setErrors(namesOf(query(on).contacts), namesOf(whole), rows.back());

  const auto middle = static_cast<std::ptrdiff_t>(count / 2);
  std::fill(on.filter1.triangle_groups.begin() + middle, on.filter1.triangle_groups.end(),
            2);
  std::fill(on.filter1.triangle_masks.begin(), on.filter1.triangle_masks.begin() + middle,
            2);
  rows.push_back(query.measure("masks: halves meet", off, on, effort));
  const auto at = trianglesAtVertices(scene.a);
  const auto is_between_halves = [&](const Contact& contact) {
    const int* v = contact.vertices.data();
    const int* second = v + (contact.kind == ContinuousContactKind::kVertexFace ? 1 : 2);
    const auto held = [&](bool lower) {
      return isHeldBy(at, v, second, lower, static_cast<int>(middle)) &&
             isHeldBy(at, second, v + 4, !lower, static_cast<int>(middle));
    };
    return held(true) || held(false);
  };
  setErrors(namesOf(query(on).contacts), namesOf(whole, is_between_halves), rows.back());

  on = off;
  on.accepts_triangles = [](std::intptr_t, std::intptr_t) { return true; };
  rows.push_back(query.measure("callback: all meet", off, on, effort));
  setErrors(namesOf(query(on).contacts), namesOf(whole), rows.back());
}

/// All edges through faces at t = 0, by a sweep and the exact predicate.
std::vector<PairName> crossingsOf(const FramePairMesh& mesh) {
  const auto at = [&](int v) { return mesh.previous[static_cast<std::size_t>(v)]; };
  std::vector<std::array<int, 3>> faces;
  std::vector<Box> face_boxes, edge_boxes;
  for (const Triangle& t : mesh.triangles) {
    faces.push_back(
        {static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
    std::sort(faces.back().begin(), faces.back().end());
    face_boxes.push_back(Box(at(faces.back()[0])));
    for (const int v : faces.back()) face_boxes.back().extend(at(v));
  }
  const auto edges = uniqueEdges(mesh.triangles);
  for (const auto& e : edges) edge_boxes.push_back(Box(at(e[0])).extend(at(e[1])));

  const auto point = [&](int v) -> const double(&)[3] {
    return reinterpret_cast<const double(&)[3]>(
        *mesh.previous[static_cast<std::size_t>(v)].data());
  };
  std::vector<PairName> names;
  forEachMeetingPair(edge_boxes, face_boxes, [&](std::size_t edge, std::size_t face) {
    const auto& e = edges[edge];
    const auto& f = faces[face];
    if (std::count(f.begin(), f.end(), e[0]) || std::count(f.begin(), f.end(), e[1]))
      return;
    if (detail::deformable::isCrossing(point(e[0]), point(e[1]), point(f[0]), point(f[1]),
                                       point(f[2])))
      names.push_back({e[0], e[1], f[0], f[1], f[2]});
  });
  return sorted(std::move(names));
}

/// All crossings at t = 0 beside a first contact, for which one is enough.
OptionRow measureCrossings(const SpeedScene& scene, const OptionQuery& query,
                           const Effort& effort) {
  const Request off = OptionQuery::request(ContinuousQuery::kFirst);
  Request on = off;
  on.enable_crossings = true;
  OptionRow row = query.measure("crossings", off, on, effort);
  std::vector<PairName> found;
  for (const Contact& crossing : query(on).crossings) {
    PairName name = crossing.vertices;
    std::sort(name.begin(), name.begin() + 2);
    std::sort(name.begin() + 2, name.end());
    found.push_back(name);
  }
  setErrors(sorted(std::move(found)), crossingsOf(scene.a), row);
  return row;
}

}  // namespace

std::vector<OptionRow> measureOptions(const SpeedScene& scene, const Effort& effort) {
  const OptionQuery query(scene);
  std::vector<OptionRow> rows{measureCoarse(query, effort)};
  if (!scene.isSelf()) return rows;
  rows.push_back(measureTMax(query, effort));
  addMarks(scene, query, effort, rows);
  rows.push_back(measureCrossings(scene, query, effort));
  addDistances(scene, query, effort, rows);
  return rows;
}

}  // namespace test
}  // namespace fcl
