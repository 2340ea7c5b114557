// SPDX-License-Identifier: BSD-3-Clause
//
// Rows of min_distance: contact at a distance beside contact.
#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "distance_truth.h"
#include "mesh_generators.h"
#include "option_query.h"

namespace fcl {
namespace test {
namespace {

using Kind = ContinuousContactKind;
using Request = OptionQuery::Request;
using Result = OptionQuery::Result;
using Contact = OptionQuery::Contact;

/// A tenth of the mean edge at t = 0.
double shareOfEdge(const FramePairMesh& mesh) {
  constexpr double kShare = 0.1;
  const auto edges = uniqueEdges(mesh.triangles);
  double sum = 0;
  for (const auto& e : edges)
    sum += (mesh.previous[static_cast<std::size_t>(e[0])] -
            mesh.previous[static_cast<std::size_t>(e[1])])
               .norm();
  return kShare * sum / static_cast<double>(edges.size());
}

std::array<int, 4> verticesOf(const Contact& c) {
  return {c.vertices[0], c.vertices[1], c.vertices[2], c.vertices[3]};
}

/// The contacts of a self-collision at a distance, by the features that they are of.
class ContactTimes {
 public:
  explicit ContactTimes(const std::vector<Contact>& contacts) {
    for (const Contact& c : contacts) {
      const int first = c.kind == Kind::kEdgeEdge ? 2 : 1, all = c.numVertices();
      const int* v = c.vertices.data();
      times_.emplace_back(nameOf(part(v, first, ~0U), part(v + first, all - first, ~0U)),
                          c.toc_lo);
    }
    std::sort(times_.begin(), times_.end());
  }

  /// The earliest contact of parts of both features of a VF or EE pair. A contact at a
  /// distance is one of the parts that have the nearest points.
  double earliestOf(Kind kind, const std::array<int, 4>& v) const {
    const int first = kind == Kind::kVertexFace ? 1 : 2, second = 4 - first;
    double earliest = std::numeric_limits<double>::infinity();
    for (unsigned a = 1; a < 1U << first; ++a)
      for (unsigned b = 1; b < 1U << second; ++b) {
        const Name name =
            nameOf(part(v.data(), first, a), part(v.data() + first, second, b));
        const auto at = std::lower_bound(
            times_.begin(), times_.end(), name,
            [](const std::pair<Name, double>& x, const Name& y) { return x.first < y; });
        if (at != times_.end() && at->first == name)
          earliest = std::min(earliest, at->second);
      }
    return earliest;
  }

 private:
  /// The vertices of a feature, ascending, and the largest number in place of others.
  using Feature = std::array<int, 3>;
  /// Two features, ascending.
  using Name = std::pair<Feature, Feature>;

  static Feature part(const int* ids, int count, unsigned selected) {
    Feature feature;
    feature.fill(std::numeric_limits<int>::max());
    for (int i = 0; i < count; ++i)
      if (selected >> i & 1U) feature[static_cast<std::size_t>(i)] = ids[i];
    std::sort(feature.begin(), feature.end());
    return feature;
  }

  static Name nameOf(const Feature& a, const Feature& b) { return std::minmax(a, b); }

  std::vector<std::pair<Name, double>> times_;
};

/// Whether the features of a contact are within d at the end of its bracket; of features
/// that are nearer at t = 0, whether they have come nearer since then.
bool isWithin(const FramePairMesh& mesh, const Contact& c, const Request& request) {
  const double d = request.min_distance, touching = 1e-9 * d,
               reached = distanceAt(mesh, c.kind, verticesOf(c), c.toc_hi),
               initial = distanceAt(mesh, c.kind, verticesOf(c), 0);
  if (reached > d * (1 + 1e-6)) return false;
  return !request.ignore_initially_closer || initial > d || initial <= touching ||
         reached < initial;
}

/// Errors of an answer. Missed: pairs that are near before a first contact, or of which
/// the list has no contact that is not later. Extra: contacts that are not within d.
void setErrors(const FramePairMesh& mesh, const Request& request, const Result& result,
               const std::vector<PairWithin>& truth, OptionRow& row) {
  const ContactTimes times(result.contacts);
  const double first = result.is_collide ? result.time_of_contact
                                         : std::numeric_limits<double>::infinity();
  std::set<PairName> missed;
  for (const PairWithin& pair : truth)
    if (pair.toc < (request.query == ContinuousQuery::kAll
                        ? times.earliestOf(pair.kind, pair.vertices)
                        : first))
      missed.insert(pairName(pair.kind, pair.vertices));
  row.contacts = result.contacts.size();
  row.missed = missed.size();
  for (const Contact& c : result.contacts) row.extra += !isWithin(mesh, c, request);
}

/// The time of the bounds of all vertices beside that of a first contact at the distance
/// up to which pairs are looked at. Missed: bounds above half of the way to the nearest
/// feature at t = 1. Extra: bounds below it by more than what the formulas leave open.
OptionRow measureSafeDisplacements(const SpeedScene& scene, const OptionQuery& query,
                                   double d, const Effort& effort) {
  const double most = d;
  Request off = OptionQuery::request(ContinuousQuery::kFirst);
  off.min_distance = d + 2 * most;
  OptionRow row =
      query.measureSafeDisplacements("safe displacements", off, most, d, effort);

  FramePairMesh at_end = scene.a;
  at_end.previous = at_end.current;
  std::vector<double> expected(at_end.current.size(), most);
  for (const PairWithin& pair : findPairsWithin(at_end, d + 2 * most, false)) {
    const double way = distanceAt(at_end, pair.kind, pair.vertices, 1) - d;
    for (const int v : pair.vertices) {
      double& bound = expected[static_cast<std::size_t>(v)];
      bound = std::min(bound, std::max(0., 0.5 * way));
    }
  }
  const std::vector<double> bounds = query.safeDisplacements(most, d);
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const double open = 1e-5 * most;
    row.contacts += bounds[i] < most;
    row.missed += bounds[i] > expected[i] + 1e-9 * most;
    row.extra += bounds[i] < expected[i] - open;
  }
  return row;
}

}  // namespace

void addDistances(const SpeedScene& scene, const OptionQuery& query, const Effort& effort,
                  std::vector<OptionRow>& rows) {
  const double d = shareOfEdge(scene.a);
  const std::vector<Contact> touching =
      query(OptionQuery::request(ContinuousQuery::kAll)).contacts;
  for (const bool ignores : {false, true}) {
    std::vector<PairWithin> truth = findPairsWithin(scene.a, d, ignores);
    for (const Contact& c : touching) truth.push_back({c.kind, verticesOf(c), c.toc_hi});
    for (const ContinuousQuery kind : {ContinuousQuery::kAll, ContinuousQuery::kFirst}) {
      const Request off = OptionQuery::request(kind);
      Request on = off;
      on.min_distance = d;
      on.ignore_initially_closer = ignores;
      rows.push_back(query.measure(
          ignores ? "min_distance and ignore_initially_closer" : "min_distance", off, on,
          effort));
      setErrors(scene.a, on, query(on), truth, rows.back());
      if (kind == ContinuousQuery::kAll || ignores) continue;
      // Many pairs may be within d at t = 0, all of which the row above lists.
      on.num_max_contacts = 1;
      rows.push_back(
          query.measure("min_distance and num_max_contacts 1", off, on, effort));
      setErrors(scene.a, on, query(on), truth, rows.back());
    }
  }
  rows.push_back(measureSafeDisplacements(scene, query, d, effort));
}

}  // namespace test
}  // namespace fcl
