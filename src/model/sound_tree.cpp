// SPDX-License-Identifier: BSD-3-Clause
#include "model/sound_tree.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>

#include "fcl/geometry/bvh/BVH_model.h"
#include "model/fcl_volumes.h"

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

/// Calls visit(node) for up to 64 inner nodes, the root first, until it returns true.
/// Returns whether it did.
template <typename Model, typename Visit>
bool visitSample(Model& model, Visit&& visit) {
  constexpr int kMostNodes = 64, kStride = 7919;
  const int count = model.getNumBVs();
  for (int i = 0, at = 0; i < std::min(count, kMostNodes);
       ++i, at = (at + kStride) % count)
    if (!model.getBV(at).isLeaf() && visit(model.getBV(at))) return true;
  return false;
}

/// Whether a node has volumes that were certainly not fitted from the bottom up.
template <typename BV>
bool isFittedFromTheTop(const BVHModel<BV>& model) {
  return visitSample(model, [&model](const BVNode<BV>& node) {
    return isNoSum(node.bv, model.getBV(node.leftChild()).bv,
                   model.getBV(node.rightChild()).bv);
  });
}

/// The axes, two of them turned by 45 degrees about the other one.
template <typename S>
Matrix3<S> turnedAxes(const Matrix3<S>& axes, int about) {
  assert(about >= 0 && about < 3);
  const int i = (about + 1) % 3, j = (about + 2) % 3;
  const S cosine = std::sqrt(S{0.5});
  Matrix3<S> out = axes;
  out.col(i) = cosine * (axes.col(i) + axes.col(j));
  out.col(j) = cosine * (axes.col(j) - axes.col(i));
  return out;
}

/// How far a box reaches from its center along other axes, and more: FCL's fit, the
/// numbers of the new volume, and the products here round by less than 20 units in the
/// last place of the coordinates.
template <typename S>
Vector3<double> extentsAlong(const OrientedBox& box, const Matrix3<S>& axes) {
  constexpr double kRounding = 64 * double{std::numeric_limits<S>::epsilon()};
  double rounding = 0;
  for (int k = 0; k < 3; ++k)
    rounding += kRounding * (std::abs(box.center[k]) + box.extent[k]);
  const Matrix3<double> products = axesOf(box).transpose() * axes.template cast<double>();
  Vector3<double> out;
  for (int j = 0; j < 3; ++j) {
    out[j] = rounding;
    for (int i = 0; i < 3; ++i) out[j] += box.extent[i] * std::abs(products(i, j));
  }
  return out;
}

/// A volume around a volume, with axes turned by 45 degrees about one of them.
template <typename S>
OBB<S> turned(const OBB<S>& obb, int about) {
  OBB<S> out = obb;
  out.axis = turnedAxes(obb.axis, about);
  out.extent = extentsAlong(orientedBoxOf(obb), out.axis).template cast<S>();
  return out;
}
/// The rectangle with its radius contains the box without its rounded corners.
template <typename S>
RSS<S> turned(const RSS<S>& rss, int about) {
  const OrientedBox box = orientedBoxOf(rss);
  RSS<S> out = rss;
  out.axis = turnedAxes(rss.axis, about);
  const Vector3<double> extents = extentsAlong(box, out.axis);
  Vector3<double> corner(box.center[0], box.center[1], box.center[2]);
  for (int k = 0; k < 2; ++k) {
    corner -= extents[k] * out.axis.col(k).template cast<double>();
    out.l[k] = static_cast<S>(2 * extents[k]);
  }
  out.To = corner.template cast<S>();
  out.r = static_cast<S>(extents[2]);
  return out;
}
/// Of these only the OBB is turned. It shows where they come from.
template <typename S>
OBBRSS<S> turned(const OBBRSS<S>& bv, int about) {
  OBBRSS<S> out = bv;
  out.obb = turned(bv.obb, about);
  return out;
}
template <typename S>
kIOS<S> turned(const kIOS<S>& bv, int about) {
  kIOS<S> out = bv;
  out.obb = turned(bv.obb, about);
  return out;
}

#ifndef NDEBUG
/// Whether a box contains the corners of another one.
bool containsBox(const OrientedBox& box, const OrientedBox& other) {
  for (unsigned corner = 0; corner < 8; ++corner) {
    double p[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = other.center[k] - box.center[k];
      for (int i = 0; i < 3; ++i)
        p[k] += (corner >> i & 1U ? 1 : -1) * other.axis[i][k] * other.extent[i];
    }
    for (int i = 0; i < 3; ++i) {
      const double along =
          box.axis[i][0] * p[0] + box.axis[i][1] * p[1] + box.axis[i][2] * p[2];
      if (std::abs(along) > box.extent[i]) return false;
    }
  }
  return true;
}
#endif

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
  assert(model.getNumBVs() > 0);
  if constexpr (kHasSlabs<BV>)
    return true;
  else
    return isBox(orientedBoxOf(model.getBV(0).bv), kFitSlack<typename BV::S>) &&
           (isFittedFromTheTop(model) || containAllCorners(model));
}

// isNoSum() compares with one or two sets of axes. Turns about three axes give volumes of
// which each set excludes at most one.
template <typename BV>
void markFittedFromTheTop(BVHModel<BV>& model) {
  if constexpr (!kHasSlabs<BV>) {
    if (isFittedFromTheTop(model)) return;
    visitSample(model, [&model](BVNode<BV>& node) {
      for (int about = 0; about < 3; ++about) {
        const BV bv = turned(node.bv, about);
        if (!isBox(orientedBoxOf(bv), kFitSlack<typename BV::S>) ||
            !isNoSum(bv, model.getBV(node.leftChild()).bv,
                     model.getBV(node.rightChild()).bv))
          continue;
        assert(containsBox(orientedBoxOf(bv), orientedBoxOf(node.bv)));
        node.bv = bv;
        return true;
      }
      return false;
    });
  }
}

#define FCL_CCD_INSTANTIATE(...)                           \
  template bool isTreeSound(const BVHModel<__VA_ARGS__>&); \
  template void markFittedFromTheTop(BVHModel<__VA_ARGS__>&);
#define FCL_CCD_INSTANTIATE_ALL(S) \
  FCL_CCD_INSTANTIATE(AABB<S>)     \
  FCL_CCD_INSTANTIATE(OBB<S>)      \
  FCL_CCD_INSTANTIATE(RSS<S>)      \
  FCL_CCD_INSTANTIATE(OBBRSS<S>)   \
  FCL_CCD_INSTANTIATE(kIOS<S>)     \
  FCL_CCD_INSTANTIATE(KDOP<S, 16>) \
  FCL_CCD_INSTANTIATE(KDOP<S, 18>) \
  FCL_CCD_INSTANTIATE(KDOP<S, 24>)
FCL_CCD_INSTANTIATE_ALL(double)
FCL_CCD_INSTANTIATE_ALL(float)
#undef FCL_CCD_INSTANTIATE_ALL
#undef FCL_CCD_INSTANTIATE

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
