// SPDX-License-Identifier: BSD-3-Clause
#include "prepare/prepared_motion.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "fcl/common/exception.h"
#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"
#include "prepare/octree_nodes.h"
#include "prepare/required_pose.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Longer paths are refused. Up to this no bound overflows; a query needs less
/// (query_range.h).
constexpr double kMostPathSize = 0x1p200;
/// Shapes are scaled before that. Up to this no square of a length overflows.
constexpr double kMostShapeSize = 0x1p500;

constexpr double kOrigin[3] = {0, 0, 0};

bool haveSameRotation(const Pose& x, const Pose& y) {
  return std::equal(x.rotation, x.rotation + 9, y.rotation);
}

/// Whether each vertex goes on a straight line between its poses, while the rotation of
/// the mesh changes.
template <typename S>
bool isPosed(const PlacedGeometry<S>& placed) {
  return placed.goesStraight() && !placed.isRigid() &&
         !haveSameRotation(placed.beginning(), placed.end());
}

/// A vector along the axis that FCL's constructors compute for half a turn between two
/// poses: that of Eigen's quaternion of R2 R1^T. Rounding decides its sign, so the
/// operations are those of libfcl, in the same order: Eigen computes the first two rows
/// of the product as vectors, the last one by itself.
Vec halfTurnAxisOfFcl(const Pose& from, const Pose& to) {
  double m[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double a = to.rotation[3 * i] * from.rotation[3 * j],
                   b = to.rotation[3 * i + 1] * from.rotation[3 * j + 1],
                   c = to.rotation[3 * i + 2] * from.rotation[3 * j + 2];
      m[i][j] = i < 2 ? (a + b) + c : a + (b + c);
    }
  int i = m[1][1] > m[0][0] ? 1 : 0;
  if (m[2][2] > m[i][i]) i = 2;
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  double axis[3];
  axis[i] = 1 + m[i][i] - m[j][j] - m[k][k];
  axis[j] = m[j][i] + m[i][j];
  axis[k] = m[k][i] + m[i][k];
  return (m[k][j] - m[j][k] < 0 ? -1. : 1.) * vecOf(axis);
}

/// About which axis a half turn goes: about that of the motion object, which
/// `integrate()` follows. Between two transforms about that of FCL's constructors.
template <typename S>
Vec halfTurnAxis(const MovingGeometry<S>& moving) {
  const double(&own)[3] = moving.axis;
  if (own[0] != 0 || own[1] != 0 || own[2] != 0) return vecOf(own);
  return halfTurnAxisOfFcl(toPose(moving.pose[0]), toPose(moving.pose[1]));
}

/// The path of the body that carries a part, or of another geometry.
/// @param name  in errors
/// @pre it does not go straight
template <typename S>
MotionPath curvedPathOf(const PlacedGeometry<S>& placed, const char* name) {
  const MovingGeometry<S>& moving = placed.moving();
  const Pose &beginning = placed.bodyBeginning(), &end = placed.bodyEnd();
  switch (moving.path) {
    case PathKind::kBounded:
      return MotionPath::bounded(*moving.motion, name);
    case PathKind::kSpline:
      return MotionPath::spline(moving.control[0], moving.control[1], name);
    case PathKind::kScrew:
      return MotionPath::screw(beginning, end, halfTurnAxis(moving));
    case PathKind::kTurn:
      return MotionPath::interpolation(beginning, end, moving.reference,
                                       halfTurnAxis(moving));
    default:
      return MotionPath::interpolation(beginning, end, kOrigin, halfTurnAxis(moving));
  }
}

/// @param name  in errors
template <typename S>
MotionPath unnamedPathOf(const PlacedGeometry<S>& placed, const char* name) {
  if (isPosed(placed)) return MotionPath::still(Pose());
  if (placed.goesStraight())
    return MotionPath::interpolation(placed.beginning(), placed.end(), kOrigin,
                                     halfTurnAxis(placed.moving()));
  const PartOffset& offset = placed.moving().offset;
  const MotionPath path = curvedPathOf(placed, name);
  return offset.is_set ? path.placed(toPose(offset)) : path;
}

[[noreturn]] void refuseReference(const std::string& name) {
  throw Exception(
      name +
      ": the reference point of the InterpMotion is not finite or far too large. FCL's "
      "constructors of two poses do not set it. Use the constructor of five arguments, "
      "InterpMotion(R1, T1, R2, T2, O), with O = 0");
}

}  // namespace

template <typename S>
void requireRotations(const PlacedGeometry<S>& placed, const char* name) {
  if (!placed.areRotations())
    throw Exception(std::string(name) + ", " + kindOf(placed.geometry()) +
                    ": a transform scales, mirrors or shears, by more than 2^-6. Give a "
                    "rotation and a translation: normalise the rotation, or change the "
                    "geometry instead");
}

template <typename S>
void requireDefinedPath(const PlacedGeometry<S>& placed, const std::string& name) {
  const MovingGeometry<S>& moving = placed.moving();
  if (placed.goesStraight()) return;
  if (moving.path == PathKind::kTurn && !areFinite(moving.reference))
    refuseReference(name);
  if (moving.path != PathKind::kUndefined) return;
  throw Exception(
      name + ", " + kindOf(placed.geometry()) +
      ": request.ccd_motion_type does not define how it turns between two transforms. "
      "Use CCDM_LINEAR or CCDM_SCREW, or give a SplineMotion, which has the control "
      "points of a spline");
}

template <typename S>
MotionPath motionPathOf(const PlacedGeometry<S>& placed, const char* name) {
  requireRotations(placed, name);
  MotionPath path = unnamedPathOf(placed, name);
  path.setName(name);
  return path;
}

template <typename S>
PreparedMotion::PreparedMotion(const PlacedGeometry<S>& placed, const std::string& name,
                               double toc_err, int num_threads, double other_radius,
                               double scale, ConvexShape* shape)
    : name_(name) {
  assert(toc_err >= 0 && other_radius >= 0 && scale > 0);
  assert(placed.isKnown() && (placed.isShape() || (scale == 1 && !shape)));
  if (shape) shape_.emplace(std::move(*shape));
  const MotionPath path = motionPathOf(placed, name_.c_str());
  if (placed.isShape()) {
    // In the body frame. A matrix that is taken as a rotation shrinks by less than 2^-9.
    const double in_body = (1 + 0x1p-8) * (other_radius + path.largestTranslation());
    const bool has_other_radius = shape_ && shape_->flat();
    if (!shape_) shape_.emplace(convexShapeOf(placed.geometry(), name, in_body));
    if (scale != 1 || has_other_radius) *shape_ = shape_->scaled(scale, in_body);
    body_.emplace(*shape_, path);
  } else if (placed.isOctree()) {
    octree_.emplace(octreeCellsOf(placed.geometry(), name));
    if (octree_->isEmpty()) return;
    body_.emplace(*octree_, path);
  } else {
    const bool posed = isPosed(placed);
    mesh_.emplace(placed.geometry(), posed ? placed.beginning() : Pose(),
                  posed ? placed.end() : Pose(), name, num_threads);
    const MeshInstance& mesh = mesh_->instance();
    if (mesh.tree)
      body_.emplace(*mesh.tree, mesh.frames, path);
    else
      body_.emplace(mesh.rigid, mesh.frames, mesh.triangles, path);
  }
  assert(mesh_.has_value() + shape_.has_value() + octree_.has_value() == 1);
  requireDefined(placed, name, toc_err);
  requireInRange(name);
}

// A reference point that was never set has the value that was in memory. It may be NaN.
// It may also be so large that its rounding error changes the time by more than toc_err,
// for a mesh that moves by its own size. Both are refused. 1e-9 replaces a toc_err of 0.
template <typename S>
void PreparedMotion::requireDefined(const PlacedGeometry<S>& placed,
                                    const std::string& name, double toc_err) const {
  const MovingGeometry<S>& moving = placed.moving();
  requireDefinedPath(placed, name);
  if (placed.goesStraight() || moving.path != PathKind::kTurn) return;
  double way[3];
  for (int k = 0; k < 3; ++k)
    way[k] = placed.end().translation[k] - placed.beginning().translation[k];
  constexpr double kRounding = 64 * kUnit, kLeastRelevantTocErr = 1e-9;
  double size = body_->radius() + norm(way);
  if (shape_)
    size += body_->shapeRadius() + norm(placed.beginning().translation) +
            norm(placed.end().translation);
  if (!(kRounding * norm(moving.reference) <=
        std::max(toc_err, kLeastRelevantTocErr) * size))
    refuseReference(name);
}

double PreparedMotion::size() const {
  return body_->size() + body_->speed() +
         body_->path().acceleration(0, 1).of({0, 0, 0}, 0) + body_->shapeRadius();
}

void PreparedMotion::requireInRange(const std::string& name) const {
  if (size() < (shape_ ? kMostShapeSize : kMostPathSize)) return;
  if (mesh_) requireFinite(mesh_->instance().frames, name);
  // Boxes of our tree are in float, and squares of lengths in FCL's have a limit too.
  if (mesh_ && !(body_->radius() < kMostPathSize))
    throw Exception(name + ": the mesh has coordinates beyond " +
                    (mesh_->instance().tree ? "2^127" : "2^150") +
                    ". Use larger units of length");
  throw Exception(name + ": its path has coordinates beyond " +
                  (shape_ ? "2^500" : "2^200") +
                  ". Use larger units of length or a smaller translation");
}

void PreparedMotion::requireFinite(const VertexFrames& frames,
                                   const std::string& name) const {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const VertexPath path = frames[i];
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(path.t0[k]) || !std::isfinite(path.t1[k]))
        throw Exception(name + ": vertex " + std::to_string(i) +
                        " is not finite. Correct it");
  }
}

VertexPath PreparedMotion::tangentAt(std::uint32_t vertex, double t) const {
  assert(mesh_ && vertex < mesh_->instance().frames.size());
  const VertexPath from = mesh_->instance().frames[vertex];
  const Pose pose = body_->path().pose(t);
  const PoseRate rate = body_->path().rate(t);
  const auto [p, v] = posedVertex(pose, rate, vecOf(from.t0), vecOf(from.t1), t);
  const Vec next = p + v;
  return {{p.x, p.y, p.z}, {next.x, next.y, next.z}};
}

MeshInstance PreparedMotion::beginning() const {
  assert(mesh_);
  MeshInstance mesh = mesh_->instance();
  // Where the vertices are posed already, the path of the body is the identity.
  if (mesh.frames.isPosed()) return mesh;
  const Pose pose = body_->path().pose(0);
  mesh.frames.setPoses(pose, pose);
  return mesh;
}

#define FCL_CCD_INSTANTIATE(S)                                                          \
  template void requireRotations(const PlacedGeometry<S>&, const char*);                \
  template void requireDefinedPath(const PlacedGeometry<S>&, const std::string&);       \
  template MotionPath motionPathOf(const PlacedGeometry<S>&, const char*);              \
  template PreparedMotion::PreparedMotion(const PlacedGeometry<S>&, const std::string&, \
                                          double, int, double, double, ConvexShape*);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
