// SPDX-License-Identifier: BSD-3-Clause
#include "prepare/octree_nodes.h"

#include <cmath>
#include <cstdint>
#include <memory>

#include "fcl/common/exception.h"
#include "fcl/config.h"

#if FCL_HAVE_OCTOMAP
#include "fcl/geometry/octree/octree.h"
#include "fcl/narrowphase/octree_cell.h"
#endif

namespace fcl {
namespace detail {
namespace deformable {

#if FCL_HAVE_OCTOMAP

namespace {

/// octomap's own nodes.
template <typename S>
class OctomapNodes : public OctreeNodes {
 public:
  explicit OctomapNodes(const OcTree<S>& octree) : octree_(octree) {}

  const void* root() const override { return ifOccupied(octree_.getRoot()); }
  bool isLeaf(const void* node) const override {
    return !octree_.nodeHasChildren(static_cast<const Node*>(node));
  }
  void readChildren(const void* node, const void* (&children)[8]) const override {
    const auto* parent = static_cast<const Node*>(node);
    for (unsigned i = 0; i < 8; ++i)
      children[i] = octree_.nodeChildExists(parent, i)
                        ? ifOccupied(octree_.getNodeChild(parent, i))
                        : nullptr;
  }

 private:
  using Node = typename OcTree<S>::OcTreeNode;

  const Node* ifOccupied(const Node* node) const {
    return node && octree_.isNodeOccupied(node) ? node : nullptr;
  }

  const OcTree<S>& octree_;
};

}  // namespace

template <typename S>
bool isOctree(const CollisionGeometry<S>& geometry) {
  return geometry.getObjectType() == OT_OCTREE;
}

template <typename S>
OctreeCells octreeCellsOf(const CollisionGeometry<S>& geometry, const std::string& name) {
  const auto& octree = static_cast<const OcTree<S>&>(geometry);
  const double root_size = 2 * static_cast<double>(octree.getRootBV().max_[0]);
  if (!(root_size > 0) || !std::isfinite(root_size))
    throw Exception(name +
                    ": the resolution of the octree is not positive or not finite. Make "
                    "the map with a positive resolution");
  return OctreeCells(std::make_unique<OctomapNodes<S>>(octree), root_size, name);
}

#else

template <typename S>
bool isOctree(const CollisionGeometry<S>&) {
  return false;
}

template <typename S>
OctreeCells octreeCellsOf(const CollisionGeometry<S>&, const std::string& name) {
  throw Exception(name + ": FCL was built without octomap");
}

#endif

#define FCL_CCD_INSTANTIATE(S)                         \
  template bool isOctree(const CollisionGeometry<S>&); \
  template OctreeCells octreeCellsOf(const CollisionGeometry<S>&, const std::string&);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace deformable

#if FCL_HAVE_OCTOMAP
bool readOctreeCell(std::intptr_t number, double root_size, OctreeCellNumbers& cell) {
  using deformable::OctreeCellNumber;
  if (!OctreeCellNumber::isNumber(number)) return false;
  const OctreeCellNumber name = OctreeCellNumber::of(number);
  cell.size = name.size(root_size);
  for (int k = 0; k < 3; ++k) {
    cell.center[k] = (name.index(k) + 0.5) * cell.size;
    cell.key[k] = name.key[k];
  }
  cell.depth = name.depth;
  return true;
}
#endif

}  // namespace detail
}  // namespace fcl
