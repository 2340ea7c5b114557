// SPDX-License-Identifier: BSD-3-Clause
#include "tree/sound_tree.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "fcl/geometry/bvh/BVH_model.h"
#include "tree/fcl_volumes.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Axes that FCL computes from the same numbers differ by a few roundings: at most 1e-5
/// in float. Axes that differ by more come from another computation.
constexpr double kOtherAxes = 0x1p-8;

/// The columns of the matrix are the axes of a box.
Matrix3<double> axesOf(const OrientedBox& box) {
  Matrix3<double> axes;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) axes(k, i) = box.axis[i][k];
  return axes;
}

/// Whether FCL's conversion to a quaternion, in float too, gives the quaternion of this
/// rotation.
bool isRotation(const Matrix3<double>& axes) {
  constexpr double kNearlyOne = 0x1p-16;
  const Matrix3<double> error = axes.transpose() * axes - Matrix3<double>::Identity();
  return error.cwiseAbs().maxCoeff() < kNearlyOne && axes.determinant() > 0;
}

/// Whether FCL's OBB<S>::operator+() certainly calls merge_smalldist(): it does if the
/// distance of the centers is below twice the sum of the largest extents. The margin
/// between 1.9 and 2 is far above the rounding of S. No square leaves the range of S.
template <typename S>
bool areMergedAsNear(const OrientedBox& a, const OrientedBox& b) {
  const double extents = *std::max_element(a.extent, a.extent + 3) +
                         *std::max_element(b.extent, b.extent + 3);
  double square = 0;
  for (int k = 0; k < 3; ++k)
    square += (a.center[k] - b.center[k]) * (a.center[k] - b.center[k]);
  return extents < std::sqrt(double{std::numeric_limits<S>::max()}) / 4 &&
         std::sqrt(square) < 1.9 * extents;
}

/// Whether a box is certainly not FCL's sum of two others. The sum of two near boxes has
/// the axes of the mean of their quaternions. FCL negates one of the quaternions if their
/// product is negative. Both signs are tried. With the right sign, the square of the sum
/// is at least 2.
template <typename S>
bool isNoSum(const OrientedBox& box, const OrientedBox& left, const OrientedBox& right) {
  const Matrix3<double> axes = axesOf(box), of_left = axesOf(left),
                        of_right = axesOf(right);
  if (!isRotation(of_left) || !isRotation(of_right) || !areMergedAsNear<S>(left, right))
    return false;
  const Quaternion<double> p(of_left), q(of_right);
  for (const double sign : {1., -1.}) {
    Quaternion<double> mean;
    mean.coeffs() = p.coeffs() + sign * q.coeffs();
    if (mean.squaredNorm() < 1) continue;
    mean.normalize();
    const Matrix3<double> difference = axes - mean.toRotationMatrix();
    if (!(difference.cwiseAbs().maxCoeff() > kOtherAxes)) return false;
  }
  return true;
}

template <typename BV>
bool isNoSum(const BV& bv, const BV& left, const BV& right) {
  return isNoSum<typename BV::S>(orientedBoxOf(bv), orientedBoxOf(left),
                                 orientedBoxOf(right));
}

/// FCL's RSS<S>::operator+() makes the third axis of a sum from the first two axes of its
/// left term.
template <typename S>
bool isNoSum(const RSS<S>& bv, const RSS<S>& left, const RSS<S>&) {
  const Matrix3<double> axes = bv.axis.template cast<double>(),
                        of_left = left.axis.template cast<double>();
  const Vector3<double> normal = of_left.col(0).cross(of_left.col(1));
  return of_left.cwiseAbs().maxCoeff() < 2 &&
         (axes.col(2) - normal).cwiseAbs().maxCoeff() > kOtherAxes;
}

/// Whether a node has volumes that were certainly not fitted from the bottom up.
template <typename BV>
bool isFittedFromTheTop(const BVHModel<BV>& model) {
  constexpr int kMostNodes = 64, kStride = 7919;
  const int count = model.getNumBVs();
  for (int i = 0, at = 0; i < std::min(count, kMostNodes);
       ++i, at = (at + kStride) % count) {
    const BVNode<BV>& node = model.getBV(at);
    if (!node.isLeaf() && isNoSum(node.bv, model.getBV(node.leftChild()).bv,
                                  model.getBV(node.rightChild()).bv))
      return true;
  }
  return false;
}

/// Whether a box, enlarged by a margin, contains the corners of the triangles below a
/// node.
template <typename BV>
bool containsCorners(const BVHModel<BV>& model, const OrientedBox& box, double margin,
                     int node) {
  const BVNode<BV>& below = model.getBV(node);
  if (!below.isLeaf())
    return containsCorners(model, box, margin, below.leftChild()) &&
           containsCorners(model, box, margin, below.rightChild());
  const Triangle& triangle = model.tri_indices[below.primitiveId()];
  for (int i = 0; i < 3; ++i) {
    if (triangle[i] >= static_cast<std::size_t>(model.num_vertices)) return false;
    const Vector3<double> p = model.vertices[triangle[i]].template cast<double>();
    for (int k = 0; k < 3; ++k) {
      double along = 0;
      for (int j = 0; j < 3; ++j) along += box.axis[k][j] * (p[j] - box.center[j]);
      if (!(std::abs(along) <= box.extent[k] + margin)) return false;
    }
  }
  return true;
}

/// Whether the boxes of all nodes contain the corners below them. False if the tree is
/// too large to test.
template <typename BV>
bool containAllCorners(const BVHModel<BV>& model) {
  constexpr int kMostNodes = 15;  // of eight triangles
  if (model.getNumBVs() > kMostNodes) return false;
  constexpr double kSlack = kFitSlack<typename BV::S>;
  for (int node = 0; node < model.getNumBVs(); ++node) {
    const OrientedBox box = orientedBoxOf(model.getBV(node).bv);
    // `size` bounds the coordinates of all points of the box. RigidTree adds eight times
    // as much. The error of the axes takes less than half of that.
    double size = 0;
    for (int k = 0; k < 3; ++k) size += std::abs(box.center[k]) + box.extent[k];
    // RigidTree reads a volume without valid axes as unbounded.
    if (isBox(box, kSlack) && !containsCorners(model, box, kSlack / 8 * size, node))
      return false;
  }
  return true;
}

}  // namespace

template <typename BV>
bool isTreeSound(const BVHModel<BV>& model) {
  if constexpr (kHasSlabs<BV>)
    return true;
  else
    return isBox(orientedBoxOf(model.getBV(0).bv), kFitSlack<typename BV::S>) &&
           (isFittedFromTheTop(model) || containAllCorners(model));
}

#define FCL_CCD_INSTANTIATE(S)                             \
  template bool isTreeSound(const BVHModel<AABB<S>>&);     \
  template bool isTreeSound(const BVHModel<OBB<S>>&);      \
  template bool isTreeSound(const BVHModel<RSS<S>>&);      \
  template bool isTreeSound(const BVHModel<OBBRSS<S>>&);   \
  template bool isTreeSound(const BVHModel<kIOS<S>>&);     \
  template bool isTreeSound(const BVHModel<KDOP<S, 16>>&); \
  template bool isTreeSound(const BVHModel<KDOP<S, 18>>&); \
  template bool isTreeSound(const BVHModel<KDOP<S, 24>>&);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
