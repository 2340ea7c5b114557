// SPDX-License-Identifier: BSD-3-Clause
#include "distance_truth.h"

#include <algorithm>
#include <set>

#include "box_sweep.h"
#include "feature_distance.h"
#include "mesh_generators.h"

namespace fcl {
namespace test {
namespace {

using Kind = ContinuousContactKind;
using V = Vector3<double>;

/// The largest relative speed of two points of a VF or EE pair. What all four vertices
/// have in common does not count.
double speedOf(const FramePairMesh& mesh, Kind kind, const std::array<int, 4>& vertices) {
  V way[4], mean = V::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    const auto v = static_cast<std::size_t>(vertices[i]);
    way[i] = mesh.current[v] - mesh.previous[v];
    mean += 0.25 * way[i];
  }
  double length[4];
  for (int i = 0; i < 4; ++i) length[i] = (way[i] - mean).norm();
  if (kind == Kind::kVertexFace)
    return length[0] + std::max({length[1], length[2], length[3]});
  return std::max(length[0], length[1]) + std::max(length[2], length[3]);
}

/// A time at which a function of t is not above a limit, above 1 if none is found. It
/// changes by `speed` in a step at most, so that larger values allow longer strides.
template <typename Function>
double timeWithin(Function&& value, double speed, double limit) {
  constexpr double kLeastStride = 1. / 256;
  constexpr int kHalvings = 30;
  double before = 0, t = 0;
  for (;;) {
    const double gap = value(t) - limit;
    if (gap <= 0) break;
    if (t == 1 || gap > speed * (1 - t)) return 2;
    before = t;
    t = std::min(1., t + std::max(gap / speed, kLeastStride));
  }
  for (int i = 0; t > 0 && i < kHalvings; ++i) {
    const double middle = 0.5 * (before + t);
    (value(middle) <= limit ? t : before) = middle;
  }
  return t;
}

/// Boxes around features during the step.
template <typename Features>
std::vector<Box> boxesOf(const FramePairMesh& mesh, const Features& features) {
  std::vector<Box> boxes;
  for (const auto& feature : features) {
    Box box;
    for (const int id : feature) {
      const auto v = static_cast<std::size_t>(id);
      box.extend(mesh.previous[v]).extend(mesh.current[v]);
    }
    boxes.push_back(box);
  }
  return boxes;
}

std::vector<Box> enlarged(std::vector<Box> boxes, double by) {
  for (Box& box : boxes)
    box = Box(box.min() - V::Constant(by), box.max() + V::Constant(by));
  return boxes;
}

class PairFinder {
 public:
  PairFinder(const FramePairMesh& mesh, double d, bool ignores_initially_closer)
      : mesh_(mesh), d_(d), ignores_initially_closer_(ignores_initially_closer) {}

  std::vector<PairWithin> find() {
    std::set<std::array<int, 1>> vertices;
    std::set<std::array<int, 3>> faces;
    for (const Triangle& t : mesh_.triangles) {
      std::array<int, 3> face{};
      for (int k = 0; k < 3; ++k) {
        face[static_cast<std::size_t>(k)] = static_cast<int>(t[k]);
        vertices.insert({static_cast<int>(t[k])});
      }
      std::sort(face.begin(), face.end());
      faces.insert(face);
    }
    const std::vector<std::array<int, 1>> v(vertices.begin(), vertices.end());
    const std::vector<std::array<int, 3>> f(faces.begin(), faces.end());
    forEachMeetingPair(
        enlarged(boxesOf(mesh_, v), d_), boxesOf(mesh_, f),
        [&](std::size_t i, std::size_t j) {
          test({Kind::kVertexFace, {v[i][0], f[j][0], f[j][1], f[j][2]}, 0});
        });
    const auto e = uniqueEdges(mesh_.triangles);
    const auto boxes = boxesOf(mesh_, e);
    forEachMeetingPair(enlarged(boxes, d_), boxes, [&](std::size_t i, std::size_t j) {
      if (i < j) test({Kind::kEdgeEdge, {e[i][0], e[i][1], e[j][0], e[j][1]}, 0});
    });
    return std::move(found_);
  }

 private:
  void test(PairWithin pair) {
    const auto& v = pair.vertices;
    const auto second = v.begin() + (pair.kind == Kind::kVertexFace ? 1 : 2);
    if (std::find_first_of(v.begin(), second, second, v.end()) != second) return;
    const auto distance = [&](double t) { return distanceAt(mesh_, pair.kind, v, t); };
    double own = d_;
    if (ignores_initially_closer_) own = std::min(own, distance(0));
    const double limit = own * (1 - 1e-6) - 1e-9 * d_;
    if (!(limit > 0)) return;
    pair.toc = timeWithin(distance, speedOf(mesh_, pair.kind, v), limit);
    if (pair.toc <= 1) found_.push_back(pair);
  }

  const FramePairMesh& mesh_;
  double d_;
  bool ignores_initially_closer_;
  std::vector<PairWithin> found_;
};

}  // namespace

double distanceAt(const FramePairMesh& mesh, Kind kind,
                  const std::array<int, 4>& vertices, double t) {
  V p[4];
  for (std::size_t i = 0; i < 4; ++i) {
    if (vertices[i] < 0) continue;
    const auto v = static_cast<std::size_t>(vertices[i]);
    p[i] = (1 - t) * mesh.previous[v] + t * mesh.current[v];
  }
  switch (kind) {
    case Kind::kVertexFace:
      return distanceToFace(p[0], p[1], p[2], p[3]);
    case Kind::kEdgeEdge:
      return distanceOfEdges(p[0], p[1], p[2], p[3]);
    case Kind::kVertexEdge:
      return distanceOfEdges(p[0], p[0], p[1], p[2]);
    default:
      return (p[0] - p[1]).norm();
  }
}

std::vector<PairWithin> findPairsWithin(const FramePairMesh& mesh, double d,
                                        bool ignores_initially_closer) {
  return PairFinder(mesh, d, ignores_initially_closer).find();
}

}  // namespace test
}  // namespace fcl
