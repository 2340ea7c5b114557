// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies of triangles, free edges and free points, and all their pairs of features tested
// one by one.
#ifndef FCL_TEST_SUPPORT_FREE_FEATURES_H
#define FCL_TEST_SUPPORT_FREE_FEATURES_H

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "elementary/distance_advance.h"
#include "elementary/elementary.h"
#include "moving_mesh.h"
#include "test_models.h"

namespace fcl {
namespace test {

/// @brief Vertices that move, and what lies between them.
struct FreeBody : MovingMesh {
  std::vector<FreeEdge> edges;
  std::vector<std::size_t> points;
};

/// @brief What a random body has.
struct BodySize {
  int sheet, cables, points;
};

enum class OnGrid { kNever, kHalf };

/// @brief A sheet, cables of several edges, and points. Some edges are those of triangles
/// or other edges, some points are their vertices.
/// @param on_grid  whether half of the bodies are on a coarse grid, where features touch
/// exactly
inline FreeBody randomBody(Random& random, const BodySize& size, double step,
                           OnGrid on_grid = OnGrid::kHalf) {
  FreeBody body;
  if (size.sheet > 0)
    static_cast<MovingMesh&>(body) = crumpledSheet(random, size.sheet, step);
  const std::size_t num_sheet = body.t0.size();
  const auto add = [&](const Vector3<double>& from) {
    body.t0.push_back(from);
    body.t1.push_back(from + random.point(step));
    return body.t0.size() - 1;
  };
  const auto anywhere = [&]() -> Vector3<double> {
    return random.point(0.5) + Vector3<double>(0.5, 0.5, 0);
  };
  for (int i = 0; i < size.cables; ++i) {
    // Some hang on the sheet.
    std::size_t at =
        num_sheet > 0 && i % 3 == 0 ? random.index(num_sheet) : add(anywhere());
    for (int k = 0; k < 4; ++k) {
      const std::size_t next = add(body.t0[at] + random.point(0.3));
      body.edges.push_back({at, next});
      at = next;
    }
  }
  if (!body.edges.empty()) body.edges.push_back({body.edges[0][1], body.edges[0][0]});
  if (num_sheet > 0) body.edges.push_back({body.id(0, 2), body.id(0, 1)});
  for (int i = 0; i < size.points; ++i) body.points.push_back(add(anywhere()));
  if (size.points > 0) body.points.push_back(random.index(body.t0.size()));
  if (on_grid == OnGrid::kHalf && random.index(2) == 0)
    for (auto* frame : {&body.t0, &body.t1})
      for (Vector3<double>& p : *frame) p = (p * 8).array().round().matrix() / 8;
  return body;
}

/// @brief Distances and bodies of many tests.
inline constexpr double kDistances[] = {0, 0.01, 0.08, 0.3};
inline constexpr BodySize kBodySizes[] = {{3, 4, 6}, {0, 6, 0}, {0, 0, 20}, {2, 0, 12},
                                          {0, 5, 9}, {2, 5, 0}, {4, 8, 16}};

template <typename Model>
std::shared_ptr<Model> freeModelOf(const FreeBody& body) {
  using S = typename std::decay_t<decltype(*Model::vertices)>::Scalar;
  auto model = std::make_shared<Model>();
  EXPECT_EQ(model->beginModel(), BVH_OK);
  EXPECT_EQ(
      model->addSubModel(pointsAs<S>(body.t0), body.triangles, body.edges, body.points),
      BVH_OK);
  EXPECT_EQ(model->endModel(), BVH_OK) << model->lastError();
  const auto t0 = pointsAs<S>(body.t0), t1 = pointsAs<S>(body.t1);
  EXPECT_EQ(model->updateFrames(t0[0].data(), t1[0].data(), t0.size()), BVH_OK);
  return model;
}

/// @brief A kind, and for both features whether it is of o1, and its vertices in order.
using PairFeature = std::pair<bool, std::vector<int>>;
using FeaturePairName = std::tuple<int, PairFeature, PairFeature>;
/// @brief The bracket of each contact.
using NamedContacts = std::map<FeaturePairName, std::pair<double, double>>;

inline FeaturePairName pairName(ContinuousContactKind kind, PairFeature first,
                                PairFeature second) {
  std::sort(first.second.begin(), first.second.end());
  std::sort(second.second.begin(), second.second.end());
  // Features of one kind are in the order of their names.
  if (first.second.size() == second.second.size() && second < first)
    std::swap(first, second);
  return {static_cast<int>(kind), std::move(first), std::move(second)};
}

/// @brief The name of a contact or a candidate.
template <typename Contact>
FeaturePairName pairName(const Contact& c, bool is_self) {
  using Kind = ContinuousContactKind;
  const int first = c.kind == Kind::kEdgeEdge ? 2 : 1;
  const int all = c.kind == Kind::kVertexVertex ? 2 : c.kind == Kind::kVertexEdge ? 3 : 4;
  const auto ids = c.vertices.begin();
  for (auto id = ids + all; id != c.vertices.end(); ++id) EXPECT_EQ(*id, -1);
  return pairName(c.kind, {is_self || c.first_on_o1, {ids, ids + first}},
                  {is_self || !c.first_on_o1, {ids + first, ids + all}});
}

template <typename S>
NamedContacts namedContacts(const ContinuousContactResult<S>& result, bool is_self) {
  NamedContacts found;
  for (const auto& c : result.contacts) {
    const bool is_new =
        found.emplace(pairName(c, is_self), std::make_pair(c.toc_lo, c.toc_hi)).second;
    EXPECT_TRUE(is_new);
  }
  return found;
}

/// @brief The features of a body, each once.
struct BodyFeatures {
  std::set<std::vector<int>> vertices, edges, faces;
  /// Those that no triangle has; points that no edge has either.
  std::set<std::vector<int>> free_edges, free_points;

  explicit BodyFeatures(const FreeBody& body) {
    for (const Triangle& t : body.triangles) {
      const int v[3] = {static_cast<int>(t[0]), static_cast<int>(t[1]),
                        static_cast<int>(t[2])};
      faces.insert({v[0], v[1], v[2]});
      for (int k = 0; k < 3; ++k) {
        vertices.insert({v[k]});
        insert(edges, v[k], v[(k + 1) % 3]);
      }
    }
    for (const FreeEdge& e : body.edges) {
      const int v = static_cast<int>(e[0]), w = static_cast<int>(e[1]);
      if (insert(edges, v, w)) insert(free_edges, v, w);
      vertices.insert({v});
      vertices.insert({w});
    }
    for (const std::size_t p : body.points)
      if (vertices.insert({static_cast<int>(p)}).second)
        free_points.insert({static_cast<int>(p)});
  }

 private:
  static bool insert(std::set<std::vector<int>>& edges, int v, int w) {
    return edges.insert({std::min(v, w), std::max(v, w)}).second;
  }
};

/// @brief Tests all pairs of features of two bodies, or of one twice.
/// @param request  with a distance of 0: features that touch, up to t_max
class AllPairs {
 public:
  AllPairs(const FreeBody& a, const FreeBody& b,
           const detail::deformable::DistanceRequest& request)
      : body_{&a, &b}, is_self_(&a == &b), request_(request) {}

  /// @brief All pairs, with the kind that a candidate has.
  template <typename Visit>
  void forEach(Visit&& visit) const {
    using Kind = ContinuousContactKind;
    const BodyFeatures of[2] = {BodyFeatures(*body_[0]), BodyFeatures(*body_[1])};
    const auto product = [&](Kind kind, int side, const auto& first, const auto& second) {
      for (const auto& x : first)
        for (const auto& y : second)
          if (!(is_self_ && haveCommon(x, y))) visit(kind, side, x, y);
    };
    const auto upper = [&](Kind kind, const auto& all) {
      for (auto x = all.begin(); x != all.end(); ++x)
        for (auto y = std::next(x); y != all.end(); ++y)
          if (!haveCommon(*x, *y)) visit(kind, 0, *x, *y);
    };
    for (int side = 0; side < (is_self_ ? 1 : 2); ++side) {
      const BodyFeatures &mine = of[side], &other = of[1 - side];
      product(Kind::kVertexFace, side, mine.vertices, other.faces);
      if (request_.distance > 0)
        product(Kind::kVertexEdge, side, mine.free_points, other.free_edges);
    }
    if (is_self_) {
      upper(Kind::kEdgeEdge, of[0].edges);
      if (request_.distance > 0) upper(Kind::kVertexVertex, of[0].free_points);
      return;
    }
    product(Kind::kEdgeEdge, 0, of[0].edges, of[1].edges);
    if (request_.distance > 0)
      product(Kind::kVertexVertex, 0, of[0].free_points, of[1].free_points);
  }

  /// @brief Whether a pair touches, or comes within the distance.
  bool isContact(ContinuousContactKind kind, int side, const std::vector<int>& first,
                 const std::vector<int>& second) const {
    NamedContacts found;
    test(kind, side, first, second, found);
    return !found.empty();
  }

  NamedContacts find() const {
    NamedContacts found;
    forEach(
        [&](ContinuousContactKind kind, int side, const std::vector<int>& first,
            const std::vector<int>& second) { test(kind, side, first, second, found); });
    return found;
  }

 private:
  static bool haveCommon(const std::vector<int>& x, const std::vector<int>& y) {
    return std::any_of(x.begin(), x.end(), [&](int id) {
      return std::find(y.begin(), y.end(), id) != y.end();
    });
  }

  void test(ContinuousContactKind kind, int side, const std::vector<int>& first,
            const std::vector<int>& second, NamedContacts& found) const {
    using namespace detail::deformable;
    VertexPath x[4]{};
    std::vector<int> ids = first;
    ids.insert(ids.end(), second.begin(), second.end());
    const auto sideOf = [&](std::size_t i) { return i < first.size() ? side : 1 - side; };
    for (std::size_t i = 0; i < ids.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const FreeBody& body = *body_[sideOf(i)];
        x[i].t0[k] = body.t0[static_cast<std::size_t>(ids[i])][k];
        x[i].t1[k] = body.t1[static_cast<std::size_t>(ids[i])][k];
      }
    if (request_.distance == 0) {
      const ElementaryResult exact = elementaryTest(kind, x, 0, 1, request_.toc_err);
      if (exact.answer == Answer::kYes)
        found[pairName(kind, {is_self_ || side == 0, first},
                       {is_self_ || side != 0, second})] = {exact.toc_lo, exact.toc_hi};
      return;
    }
    PointIds names;
    for (std::size_t i = 0; i < ids.size(); ++i)
      names.id[i] = static_cast<std::uint32_t>(ids[i]);
    const DistanceContact c =
        advanceToDistance(kind, {{&x[0], &x[1], &x[2], &x[3]}}, request_, names);
    if (!c.is_contact) return;
    PairFeature parts[2];
    for (std::size_t i = 0; i < 4 && c.points[i] >= 0; ++i) {
      const auto point = static_cast<std::size_t>(c.points[i]);
      // The vertex of a vertex and an edge comes first.
      const std::size_t place = c.kind == ContinuousContactKind::kVertexEdge
                                    ? std::min<std::size_t>(i, 1)
                                    : point >= first.size();
      parts[place].first = is_self_ || sideOf(point) == 0;
      parts[place].second.push_back(ids[point]);
    }
    const std::pair<double, double> bracket{c.toc_lo, c.toc_hi};
    const auto [at, is_new] =
        found.emplace(pairName(c.kind, parts[0], parts[1]), bracket);
    if (!is_new) at->second = std::min(at->second, bracket);
  }

  const FreeBody* body_[2];
  bool is_self_;
  detail::deformable::DistanceRequest request_;
};

}  // namespace test
}  // namespace fcl

#endif
