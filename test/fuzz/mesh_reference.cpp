// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_reference.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "elementary/distance_advance.h"
#include "elementary/elementary.h"
#include "elementary/exact.h"
#include "elementary/predicates.h"

namespace fcl {
namespace test {
namespace {

using namespace detail::deformable;
using Kind = fcl::ContinuousContactKind;

/// A vertex, an edge or a face: its ids, and the box of its whole way.
template <std::size_t kSize>
struct Feature {
  std::array<int, kSize> id;
  double lo[3], hi[3];
};

class Features {
 public:
  explicit Features(const MovingMesh& mesh) {
    for (std::size_t i = 0; i < mesh.t0.size(); ++i) {
      const auto &p = mesh.t0[i], &q = mesh.t1[i];
      paths_.push_back({{p[0], p[1], p[2]}, {q[0], q[1], q[2]}});
    }
    std::set<int> used;
    std::set<std::array<int, 3>> seen;
    for (const Triangle& t : mesh.triangles) {
      const std::array<int, 3> id{static_cast<int>(t[0]), static_cast<int>(t[1]),
                                  static_cast<int>(t[2])};
      used.insert(id.begin(), id.end());
      std::array<int, 3> sorted = id;
      std::sort(sorted.begin(), sorted.end());
      // Faces with the same vertices are one feature.
      if (seen.insert(sorted).second) faces.push_back(feature(id));
    }
    for (const int v : used) vertices.push_back(feature<1>({v}));
    // Of a collapsed triangle: an edge between a vertex and itself is none.
    for (const auto& e : uniqueEdges(mesh.triangles))
      if (e[0] != e[1]) edges.push_back(feature(e));
  }

  const VertexPath& path(int id) const { return paths_[static_cast<std::size_t>(id)]; }

  std::vector<Feature<1>> vertices;
  std::vector<Feature<2>> edges;
  std::vector<Feature<3>> faces;

 private:
  template <std::size_t kSize>
  Feature<kSize> feature(const std::array<int, kSize>& id) const {
    Feature<kSize> out{id, {}, {}};
    for (int k = 0; k < 3; ++k) {
      const VertexPath& first = path(id[0]);
      out.lo[k] = std::min(first.t0[k], first.t1[k]);
      out.hi[k] = std::max(first.t0[k], first.t1[k]);
      for (const int i : id) {
        const VertexPath& p = path(i);
        out.lo[k] = std::min({out.lo[k], p.t0[k], p.t1[k]});
        out.hi[k] = std::max({out.hi[k], p.t0[k], p.t1[k]});
      }
    }
    return out;
  }

  std::vector<VertexPath> paths_;
};

template <typename X, typename Y>
bool haveCommon(const X& x, const Y& y) {
  for (const int i : x.id)
    for (const int j : y.id)
      if (i == j) return true;
  return false;
}

class AllPairs {
 public:
  explicit AllPairs(const MeshCase& what)
      : what_(what), is_self_(!what.b), a_(what.a), b_(what.other()) {
    request_.distance = what.min_distance;
    request_.t_max = what.t_max;
    request_.toc_err = what.toc_err;
    request_.ignores_initially_closer = what.ignores_initially_closer;
    // More than any tolerance of a contact at this distance.
    margin_ = what.min_distance > 0 ? 1.01 * what.min_distance + 1e-9 : 0;
  }

  MeshTruth find() {
    product(Kind::kVertexFace, true, a_.vertices, a_, b_.faces, b_);
    if (!is_self_) product(Kind::kVertexFace, false, b_.vertices, b_, a_.faces, a_);
    product(Kind::kEdgeEdge, true, a_.edges, a_, b_.edges, b_);
    bool is_crossing = crosses(a_.edges, a_, b_.faces, b_);
    if (!is_self_) is_crossing = is_crossing || crosses(b_.edges, b_, a_.faces, a_);
    MeshTruth truth{{}, is_crossing};
    for (const auto& [id, bracket] : found_)
      truth.contacts.push_back({id, bracket.first, bracket.second});
    return truth;
  }

 private:
  template <typename X, typename Y>
  bool boxesMeet(const X& x, const Y& y) const {
    for (int k = 0; k < 3; ++k)
      if (x.lo[k] > y.hi[k] + margin_ || y.lo[k] > x.hi[k] + margin_) return false;
    return true;
  }

  template <typename X, typename Y>
  void product(Kind kind, bool first_on_o1, const std::vector<X>& first,
               const Features& of_first, const std::vector<Y>& second,
               const Features& of_second) {
    const bool is_upper = is_self_ && kind == Kind::kEdgeEdge;
    for (std::size_t i = 0; i < first.size(); ++i)
      for (std::size_t j = is_upper ? i + 1 : 0; j < second.size(); ++j) {
        if (!boxesMeet(first[i], second[j])) continue;
        if (is_self_ && haveCommon(first[i], second[j])) continue;
        Tested pair{kind, first_on_o1, {}, {}};
        std::size_t n = 0;
        for (const int id : first[i].id) pair.add(n++, id, of_first);
        for (const int id : second[j].id) pair.add(n++, id, of_second);
        test(pair);
      }
  }

  struct Tested {
    Kind kind;
    bool first_on_o1;
    FeaturePoints x;
    PointIds ids;
    void add(std::size_t n, int id, const Features& of) {
      x.point[n] = &of.path(id);
      ids.id[n] = static_cast<std::uint32_t>(id);
    }
    int id(int n) const { return static_cast<int>(ids.id[n]); }
    int numFirst() const { return kind == Kind::kVertexFace ? 1 : 2; }
  };

  void test(const Tested& pair) {
    if (what_.min_distance > 0)
      testDistance(pair);
    else
      testTouch(pair);
  }

  void testTouch(const Tested& pair) {
    ElementaryResult r = elementaryTest(pair.kind, pair.x, 0, 1, 1e-12);
    if (r.answer != Answer::kYes || r.toc_lo > what_.t_max) return;
    if (r.toc_hi > what_.t_max) {
      r = decideExactly(pair.kind, pair.x, 1e-12, 1, what_.t_max);
      if (r.answer != Answer::kYes) return;
    }
    const bool vf = pair.kind == Kind::kVertexFace;
    add(contactId(static_cast<int>(pair.kind), pair.first_on_o1, is_self_,
                  {pair.id(0), vf ? -1 : pair.id(1)},
                  {pair.id(vf ? 1 : 2), pair.id(vf ? 2 : 3), vf ? pair.id(3) : -1}),
        r.toc_lo, r.toc_hi);
  }

  void testDistance(const Tested& pair) {
    const DistanceContact c = advanceToDistance(pair.kind, pair.x, request_, pair.ids);
    if (!c.is_contact) return;
    std::array<int, 2> first{-1, -1};
    std::array<int, 3> second{-1, -1, -1};
    std::size_t num_first = 0, num_second = 0;
    bool first_on_o1 = pair.first_on_o1;
    for (int i = 0; i < 4 && c.points[i] >= 0; ++i) {
      // The vertex of a vertex and an edge comes first, whichever feature has it.
      const bool is_of_first = c.points[i] < pair.numFirst();
      const bool goes_first = c.kind == Kind::kVertexEdge ? i == 0 : is_of_first;
      if (i == 0) first_on_o1 = is_of_first == pair.first_on_o1;
      const int id = pair.id(c.points[i]);
      if (goes_first)
        first[num_first++] = id;
      else
        second[num_second++] = id;
    }
    // Two vertices: that of o1 comes first.
    if (c.kind == Kind::kVertexVertex && !pair.first_on_o1)
      std::swap(first[0], second[0]);
    if (c.kind == Kind::kVertexVertex || c.kind == Kind::kEdgeEdge) first_on_o1 = true;
    add(contactId(static_cast<int>(c.kind), first_on_o1, is_self_, first, second),
        c.toc_lo, c.toc_hi);
  }

  void add(const ContactId& id, double lo, double hi) {
    const auto [at, is_new] = found_.emplace(id, std::make_pair(lo, hi));
    if (!is_new) at->second = std::min(at->second, std::make_pair(lo, hi));
  }

  bool crosses(const std::vector<Feature<2>>& edges, const Features& of_edges,
               const std::vector<Feature<3>>& faces, const Features& of_faces) const {
    for (const auto& e : edges)
      for (const auto& f : faces) {
        if (!boxesMeet(e, f) || (is_self_ && haveCommon(e, f))) continue;
        if (isCrossing(of_edges.path(e.id[0]).t0, of_edges.path(e.id[1]).t0,
                       of_faces.path(f.id[0]).t0, of_faces.path(f.id[1]).t0,
                       of_faces.path(f.id[2]).t0))
          return true;
      }
    return false;
  }

  const MeshCase& what_;
  bool is_self_;
  Features a_, b_;
  DistanceRequest request_{};
  double margin_;
  std::map<ContactId, std::pair<double, double>> found_;
};

}  // namespace

MeshTruth bruteForce(const MeshCase& mesh_case) { return AllPairs(mesh_case).find(); }

}  // namespace test
}  // namespace fcl
