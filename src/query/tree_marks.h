// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_TREE_MARKS_H
#define FCL_CCD_QUERY_TREE_MARKS_H

#include "query/pair_filter.h"
#include "tree/moving_kdop_tree.h"
#include "tree/traversal.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief The marks of the triangles that hold a feature of a triangle of the tree, and
/// of those of all triangles below a node. So two triangles or nodes of which the marks
/// do not meet have no pair of features that counts.
TreeMarks treeMarksOf(const MovingKdopTree& tree, const TriangleMarks& marks);

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif
