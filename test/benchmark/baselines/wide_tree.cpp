// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/wide_tree.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "baselines/binary_structure.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::kernels;
using detail::deformable::MovingKdopNode;
using detail::deformable::MovingKdopTree;
using detail::deformable::TreeTriangle;
using detail::deformable::TreeVertex;
using fcl::ContinuousContactKind;

MovingKdopTree build(const FramePairMesh& mesh) {
  const BinaryStructure structure = makeBinaryStructure(mesh);
  std::vector<Triangle> triangles;
  triangles.reserve(structure.triangles.size());
  for (const std::size_t i : structure.triangles) triangles.push_back(mesh.triangles[i]);
  MovingKdopTree tree;
  tree.build(triangles.data(), triangles.size(), mesh.previous.size(), structure.links);
  return tree;
}

MeshConnectivity connect(const MovingKdopTree& tree) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangles.reserve(tree.triangles().size());
  for (const TreeTriangle& t : tree.triangles())
    triangles.push_back({t.place[0], t.place[1], t.place[2]});
  return {std::move(triangles), tree.vertices().size()};
}

}  // namespace

template <Boxes kBoxes>
WideTree<kBoxes>::WideTree(const FramePairMesh& mesh) : WideTree(build(mesh)) {}

template <Boxes kBoxes>
WideTree<kBoxes>::WideTree(MovingKdopTree tree)
    : tree_(std::move(tree)),
      connectivity_(connect(tree_)),
      original_(tree_.vertices().size()),
      swept_(tree_),
      vertices_(tree_.vertices().size()),
      paths_(tree_.vertices().size()) {
  for (const TreeTriangle& t : tree_.triangles())
    for (int k = 0; k < 3; ++k) original_[t.place[k]] = t.id[k];
}

template <Boxes kBoxes>
Regions WideTree<kBoxes>::regions() const {
  Regions regions;
  for (std::size_t i = 0; i < tree_.numNodes(); ++i) {
    const MovingKdopNode& node = tree_.node(static_cast<int>(i));
    regions.children.insert(regions.children.end(), node.child, node.child + node.count);
    regions.close();
  }
  return regions;
}

template <Boxes kBoxes>
void WideTree<kBoxes>::refit(const FramePairMesh& mesh) {
  tree_.refit({mesh.previous[0].data(), mesh.current[0].data(), mesh.previous.size()});
  if (kBoxes == Boxes::kSwept) {
    // Their union needs boxes that are relative to one point.
    for (int k = 0; k < 3; ++k)
      if (tree_.origin(0)[k] != tree_.origin(1)[k])
        throw std::invalid_argument("boxes of a mesh that is spread too far");
    swept_.assign(tree_);
  }
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    TreeVertex& v = vertices_[i] = tree_.vertices()[i];
    for (int j = 0; kBoxes == Boxes::kSwept && j < 16; ++j)
      v.box.t0.half[j] = v.box.t1.half[j] = std::max(v.box.t0.half[j], v.box.t1.half[j]);
    std::copy(v.t0, v.t0 + 3, paths_[i].t0);
    std::copy(v.t1, v.t1 + 3, paths_[i].t1);
  }
}

template <Boxes kBoxes>
void WideTree<kBoxes>::findOverlaps(const std::vector<TrianglePairMask>& pairs,
                                    std::vector<Candidate>& found) {
  triangle_pairs_.resize(pairs.size());
  masks_.resize(pairs.size());
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const auto &a = tree_.triangles()[static_cast<std::size_t>(pairs[p].a)],
               &b = tree_.triangles()[static_cast<std::size_t>(pairs[p].b)];
    for (int k = 0; k < 3; ++k) {
      triangle_pairs_[p].x[k] = &vertices_[a.place[k]];
      triangle_pairs_[p].x[k + 3] = &vertices_[b.place[k]];
    }
    triangle_pairs_[p].a = &a;
    triangle_pairs_[p].b = &b;
    masks_[p] = pairs[p].pairs;
  }
  constexpr unsigned kVertexFace = (1U << detail::deformable::kNumVertexFacePairs) - 1;
  constexpr unsigned kEdgeEdge =
      (1U << detail::deformable::kNumFeaturePairs) - 1 - kVertexFace;
  // listFeatures() writes up to 16 more than it lists.
  codes_.resize(9 * pairs.size() + 16);
  windows_.resize(codes_.size());
  for (const ContinuousContactKind kind :
       {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge}) {
    const std::size_t listed = kernels().listFeatures(
        masks_.data(), pairs.size(),
        kind == ContinuousContactKind::kVertexFace ? kVertexFace : kEdgeEdge,
        codes_.data());
    const std::size_t kept =
        kernels().cullFeatures(kind, triangle_pairs_.data(), nullptr, nullptr, 1, nullptr,
                               codes_.data(), listed, windows_.data());
    for (std::size_t i = 0; i < kept; ++i)
      found.push_back(
          {codes_[i] / 16, static_cast<std::int32_t>(codes_[i] % 16), windows_[i]});
  }
}

template class WideTree<Boxes::kSwept>;
template class WideTree<Boxes::kMoving>;

}  // namespace test
}  // namespace fcl
