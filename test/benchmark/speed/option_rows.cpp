// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "elementary/predicates.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "rows.h"
#include "timing.h"

namespace fcl {
namespace test {
namespace {

using Model = DeformableBVHModel<>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Contact = ContinuousContact<double>;

/// The objects of a query, and how it is asked.
class Query {
 public:
  explicit Query(const SpeedScene& scene) : a_(modelOf(scene.a)) {
    if (!scene.isSelf()) b_ = modelOf(scene.b);
  }

  Result operator()(const Request& request) const {
    Result result;
    const Transform3<double> origin = Transform3<double>::Identity();
    if (b_)
      continuousCollide(a_.get(), origin, origin, b_.get(), origin, origin, request,
                        result);
    else
      continuousSelfCollide(a_.get(), request, result);
    return result;
  }

 private:
  static std::unique_ptr<Model> modelOf(const FramePairMesh& mesh) {
    auto model = std::make_unique<Model>();
    const auto expect = [&](int code) {
      if (code != BVH_OK) throw std::runtime_error(model->lastError());
    };
    expect(model->beginModel());
    expect(model->addSubModel(mesh.previous, mesh.triangles));
    expect(model->endModel(FclTree::kSkip));
    expect(model->updateFrames(mesh.previous[0].data(), mesh.current[0].data(),
                               mesh.previous.size(), FclTree::kSkip));
    return model;
  }

  std::unique_ptr<Model> a_;
  std::unique_ptr<Model> b_{};
};

Request requestFor(ContinuousQuery query, double toc_err = 1e-4) {
  Request request;
  request.query = query;
  request.enable_contact = false;
  request.toc_err = toc_err;
  return request;
}

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

/// Times of a query without and with an option, one after the other in each repeat.
OptionRow measure(const SpeedScene& scene, const std::string& option, const Query& query,
                  const Request& off, const Request& on, const Effort& effort) {
  OptionRow row;
  row.scene = scene.name;
  row.triangles = scene.a.triangles.size() + scene.b.triangles.size();
  row.option = option;
  row.query = on.query == ContinuousQuery::kAll ? "all" : "first";
  row.off = row.on = std::numeric_limits<double>::infinity();
  repeat(effort, [&] {
    row.off = std::min(row.off, millisecondsOf([&] { query(off); }));
    row.on = std::min(row.on, millisecondsOf([&] { query(on); }));
  });
  return row;
}

void setErrors(const std::vector<PairName>& found, const std::vector<PairName>& truth,
               OptionRow& row) {
  const Errors errors = errorsOf(found, truth);
  row.contacts = found.size();
  row.missed = errors.missed;
  row.extra = errors.extra;
}

/// The first contact with a coarse tolerance beside one that is fine.
OptionRow measureCoarse(const SpeedScene& scene, const Query& query,
                        const Effort& effort) {
  const Request fine = requestFor(ContinuousQuery::kFirst, 1e-9);
  const Request coarse = requestFor(ContinuousQuery::kFirst);
  OptionRow row = measure(scene, "toc_err 1e-4 for 1e-9", query, fine, coarse, effort);
  const Result truth = query(requestFor(ContinuousQuery::kFirst, 0)),
               found = query(coarse);
  row.contacts = found.contacts.size();
  row.missed = truth.is_collide &&
               (!found.is_collide || found.time_of_contact > truth.contacts[0].toc_hi);
  row.extra = found.is_collide && !truth.is_collide;
  return row;
}

/// All contacts in the first tenth of the step.
OptionRow measureTMax(const SpeedScene& scene, const Query& query, const Effort& effort) {
  const Request off = requestFor(ContinuousQuery::kAll);
  Request on = off;
  on.t_max = 0.1;
  OptionRow row = measure(scene, "t_max 0.1", query, off, on, effort);
  const Result whole = query(requestFor(ContinuousQuery::kAll, 0));
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
void addMarks(const SpeedScene& scene, const Query& query, const Effort& effort,
              std::vector<OptionRow>& rows) {
  const Request off = requestFor(ContinuousQuery::kAll);
  const std::vector<Contact> whole = query(off).contacts;
  const std::size_t count = scene.a.triangles.size();

  Request on = off;
  on.filter1.triangle_groups.assign(count, 1);
  on.filter1.triangle_masks.assign(count, 1);
  rows.push_back(measure(scene, "masks: all meet", query, off, on, effort));
  setErrors(namesOf(query(on).contacts), namesOf(whole), rows.back());

  const auto middle = static_cast<std::ptrdiff_t>(count / 2);
  std::fill(on.filter1.triangle_groups.begin() + middle, on.filter1.triangle_groups.end(),
            2);
  std::fill(on.filter1.triangle_masks.begin(), on.filter1.triangle_masks.begin() + middle,
            2);
  rows.push_back(measure(scene, "masks: halves meet", query, off, on, effort));
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
  rows.push_back(measure(scene, "callback: all meet", query, off, on, effort));
  setErrors(namesOf(query(on).contacts), namesOf(whole), rows.back());
}

/// Faces by the least x of their boxes, for a sweep.
struct SweptFace {
  double low[3];
  double high[3];
  const Triangle* face;
};

/// All edges through faces at t = 0, by a sweep along x and the exact predicate.
std::vector<PairName> crossingsOf(const FramePairMesh& mesh) {
  const auto& p = mesh.previous;
  const auto point = [&](std::size_t v) -> const double(&)[3] {
    return reinterpret_cast<const double(&)[3]>(*p[v].data());
  };
  std::vector<SweptFace> faces;
  double widest = 0;
  std::vector<std::pair<std::size_t, std::size_t>> edges;
  for (const Triangle& t : mesh.triangles) {
    SweptFace face{{}, {}, &t};
    for (int k = 0; k < 3; ++k) {
      face.low[k] = std::min({p[t[0]][k], p[t[1]][k], p[t[2]][k]});
      face.high[k] = std::max({p[t[0]][k], p[t[1]][k], p[t[2]][k]});
      edges.emplace_back(std::minmax(t[k], t[(k + 1) % 3]));
    }
    widest = std::max(widest, face.high[0] - face.low[0]);
    faces.push_back(face);
  }
  std::sort(faces.begin(), faces.end(),
            [](const auto& x, const auto& y) { return x.low[0] < y.low[0]; });
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

  std::vector<PairName> names;
  for (const auto& [e0, e1] : edges) {
    const Vector3<double> low = p[e0].cwiseMin(p[e1]), high = p[e0].cwiseMax(p[e1]);
    auto face =
        std::lower_bound(faces.begin(), faces.end(), low[0] - widest,
                         [](const SweptFace& f, double x) { return f.low[0] < x; });
    for (; face != faces.end() && face->low[0] <= high[0]; ++face) {
      const Triangle& t = *face->face;
      const auto has = [&](std::size_t v) { return v == t[0] || v == t[1] || v == t[2]; };
      const auto is_apart = [&](int k) {
        return face->high[k] < low[k] || high[k] < face->low[k];
      };
      if (is_apart(0) || is_apart(1) || is_apart(2) || has(e0) || has(e1)) continue;
      if (!detail::deformable::isCrossing(point(e0), point(e1), point(t[0]), point(t[1]),
                                          point(t[2])))
        continue;
      std::array<int, 3> f{static_cast<int>(t[0]), static_cast<int>(t[1]),
                           static_cast<int>(t[2])};
      std::sort(f.begin(), f.end());
      names.push_back({static_cast<int>(e0), static_cast<int>(e1), f[0], f[1], f[2]});
    }
  }
  return sorted(std::move(names));
}

/// All crossings at t = 0 beside a first contact, for which one is enough.
OptionRow measureCrossings(const SpeedScene& scene, const Query& query,
                           const Effort& effort) {
  const Request off = requestFor(ContinuousQuery::kFirst);
  Request on = off;
  on.enable_crossings = true;
  OptionRow row = measure(scene, "crossings", query, off, on, effort);
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
  const Query query(scene);
  std::vector<OptionRow> rows{measureCoarse(scene, query, effort)};
  if (!scene.isSelf()) return rows;
  rows.push_back(measureTMax(scene, query, effort));
  addMarks(scene, query, effort, rows);
  rows.push_back(measureCrossings(scene, query, effort));
  return rows;
}

}  // namespace test
}  // namespace fcl
