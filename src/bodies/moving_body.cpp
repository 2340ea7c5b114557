// SPDX-License-Identifier: BSD-3-Clause
#include "bodies/moving_body.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "mesh/non_finite_vertex.h"
#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"
#include "tree/open_binary.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The largest size of a box with bounds, so that no product of sizes overflows.
constexpr double kMostExtent = 0x1p300;

/// Bound on the distance of a box from the origin. A flat has a radius of its own.
double radiusOf(const BodyBox& box) {
  // Squares of smaller lengths underflow.
  constexpr double kLeastLength = 0x1p-490;
  const double radius = (norm(box.center) + box.radius) * kUpward;
  if (!(radius < kLeastLength)) return radius;
  double sum = std::max(box.radius, box.pad);
  for (int k = 0; k < 3; ++k) sum += std::abs(box.center[k]) + box.extent[k];
  return sum * kUpward;
}

/// A box without bounds.
BodyBox unboundedBox() {
  BodyBox box{};
  for (int i = 0; i < 3; ++i) {
    box.axis[i][i] = 1;
    box.extent[i] = kMostExtent;
  }
  box.radius = 2 * kMostExtent;
  return box;
}

/// The axis-aligned box of the first six half-axes of a 16-DOP.
/// @param half  half(j): minus the lower bound along axis j, half(j + 8): the upper one
template <typename HalfAxis>
BodyBox boxOfSlabs(const HalfAxis& half, const double (&origin)[3]) {
  BodyBox box{};
  bool is_bounded = true;
  for (int j = 0; j < 3; ++j) {
    const double lower = double{half(j)}, upper = double{half(j + 8)};
    box.center[j] = origin[j] + 0.5 * (upper - lower);
    // The center rounds by a unit of itself.
    box.extent[j] = 0.5 * (upper + lower) * kUpward + 4 * kUnit * std::abs(box.center[j]);
    // Each half-axis is rounded outward.
    assert(!(lower + upper < 0) && !(box.extent[j] < 0));
    is_bounded &= box.extent[j] < kMostExtent;
    box.axis[j][j] = 1;
  }
  if (!is_bounded) return unboundedBox();
  box.radius = norm(box.extent) * kUpward;
  return box;
}

/// As boxOfSlabs() for eight boxes.
template <typename Rows>
void setSlabs(const Rows& rows, const double (&origin)[3], BodyBoxes& boxes) {
  constexpr int kWidth = BodyBoxes::kWidth;
  double square[kWidth] = {};
  for (int j = 0; j < 3; ++j) {
    const auto &lower = rows[MovingKdopNode::rowOf(j)],
               &upper = rows[MovingKdopNode::rowOf(j + 8)];
    for (int lane = 0; lane < kWidth; ++lane) {
      const double low = double{lower[lane]}, high = double{upper[lane]},
                   center = origin[j] + 0.5 * (high - low),
                   extent = 0.5 * (high + low) * kUpward + 4 * kUnit * std::abs(center);
      boxes.center[j][lane] = center;
      boxes.extent[j][lane] = extent;
      square[lane] += extent * extent;
    }
    for (int k = 0; k < 3; ++k) std::fill_n(boxes.axis[j][k], kWidth, j == k ? 1. : 0.);
  }
  for (int lane = 0; lane < kWidth; ++lane)
    boxes.radius[lane] = std::sqrt(square[lane]) * kUpward;
}

/// Whether a box contains a point, up to what both round by. For assertions.
bool contains(const BodyBox& box, const Vec& x) {
  const Vec from_center = x - vecOf(box.center);
  const double rounding = 0x1p-48 * (norm(x) + norm(box.center) + box.radius) + box.pad;
  for (int i = 0; i < 3; ++i)
    if (std::abs(dot(vecOf(box.axis[i]), from_center)) > box.extent[i] + rounding)
      return false;
  return !(norm(from_center) > box.radius + rounding);
}

/// Whether a box contains another one, up to what both round by. Their sides are parallel
/// to the axes. For assertions.
[[maybe_unused]] bool contains(const BodyBox& outer, const BodyBox& inner) {
  for (int k = 0; k < 3; ++k) {
    const double way = std::abs(inner.center[k] - outer.center[k]),
                 size = std::abs(inner.center[k]) + std::abs(outer.center[k]) +
                        inner.extent[k] + outer.extent[k];
    if (way + inner.extent[k] > outer.extent[k] + 0x1p-38 * size) return false;
  }
  return !(inner.displacement > outer.displacement);
}

/// The largest coordinate of a box along a direction, with what it rounds by. For
/// assertions.
[[maybe_unused]] double reachOfBox(const BodyBox& box, const Vec& direction) {
  double reach = dot(direction, vecOf(box.center));
  for (int i = 0; i < 3; ++i)
    reach += box.extent[i] * std::abs(dot(direction, vecOf(box.axis[i])));
  return reach + norm(direction) * (box.pad + 0x1p-44 * (norm(box.center) + box.radius));
}

bool isBounded(const BodyBoxes& boxes, int lane) {
  return boxes.extent[0][lane] < kMostExtent && boxes.extent[1][lane] < kMostExtent &&
         boxes.extent[2][lane] < kMostExtent;
}

/// The children of a node of a mesh that deforms; as MovingBody::movingBox() of each. The
/// loops over lanes are the inner ones, so that compilers make vector code of them.
void openMoving(const MovingKdopTree& tree, std::int32_t index, BodyNode& out) {
  constexpr int kWidth = BodyBoxes::kWidth;
  const MovingKdopNode& node = tree.node(index);
  assert(0 < node.count && node.count <= kWidth);
  out.count = node.count;
  for (int lane = 0; lane < kWidth; ++lane) {
    const int from = std::min(lane, node.count - 1);
    out.part[lane] = {node.child[from], index * kWidth + from};
  }
  for (int frame = 0; frame < 2; ++frame) {
    BodyBoxes& boxes = out.box[frame];
    setSlabs(frame == 0 ? node.t0 : node.t1, tree.origin(frame), boxes);
    for (int lane = 0; lane < node.count; ++lane)
      if (!isBounded(boxes, lane)) boxes.set(lane, unboundedBox());
    for (int lane = 0; lane < kWidth; ++lane) {
      boxes.pad[lane] = 0;
      boxes.displacement[lane] =
          std::sqrt(3.) * double{node.displacement[lane]} * kUpward;
    }
    for (int lane = node.count; lane < kWidth; ++lane)
      boxes.set(lane, boxes.get(node.count - 1));
  }
}

}  // namespace

double accelerationOf(const AccelerationBound& bound, const BodyTriangle& triangle) {
  double most = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec from = triangle.corner[0][k], to = triangle.corner[1][k], way = to - from;
    most = std::max(most, bound.between(from, to, 0) +
                              bound.per_displacement * std::sqrt(dot(way, way)));
  }
  assert(!(most < 0));
  return most * kUpward;
}

FeaturePair featurePair(int pair, const BodyTriangle& a, const BodyTriangle& b) {
  if (pair != kFreePair) return featurePair(pair);
  assert(a.isFreePoint() || b.isFreePoint());
  const bool are_points = a.isFreePoint() && b.isFreePoint();
  return {are_points ? ContinuousContactKind::kVertexVertex
                     : ContinuousContactKind::kVertexEdge,
          a.isFreePoint(), 0, 0};
}

FeatureIds idsOf(int pair, const BodyTriangle& a, const BodyTriangle& b) {
  assert(0 <= pair && pair <= kFreePair);
  const FeaturePair features = featurePair(pair, a, b);
  FeatureIds ids{features.kind, features.first_on_a, {}, {a.index, b.index}};
  const auto num_points = static_cast<int>(numVertices(ids.kind));
  std::fill(ids.vertices, ids.vertices + 4, ~std::uint32_t{0});
  if (pair == kFreePair) {
    const BodyTriangle &first = ids.first_on_a ? a : b, &second = ids.first_on_a ? b : a;
    ids.vertices[0] = static_cast<std::uint32_t>(first.vertex[0]);
    for (int i = 1; i < num_points; ++i)
      ids.vertices[i] = static_cast<std::uint32_t>(second.vertex[i - 1]);
  } else {
    for (int i = 0; i < num_points; ++i) {
      const unsigned corner = kFeaturePoints[pair][i];
      ids.vertices[i] = static_cast<std::uint32_t>(corner < 3 ? a.vertex[corner]
                                                              : b.vertex[corner - 3]);
    }
  }
  const auto order = [&ids](int i) {
    if (ids.vertices[i] > ids.vertices[i + 1])
      std::swap(ids.vertices[i], ids.vertices[i + 1]);
  };
  if (ids.kind == ContinuousContactKind::kVertexEdge) order(1);
  if (ids.kind == ContinuousContactKind::kEdgeEdge) {
    order(0);
    order(2);
  }
  return ids;
}

MovingBody::MovingBody(const RigidTree& tree, const VertexFrames& frames,
                       TriangleArray triangles, const MotionPath& path)
    : rigid_(&tree), frames_(frames), triangles_(triangles), path_(path) {
  radius_ = radiusOf(rigidBox(0));
}

MovingBody::MovingBody(const MovingKdopTree& tree, const VertexFrames& frames,
                       const MotionPath& path)
    : tree_(&tree), frames_(frames), path_(path) {
  for (int frame = 0; frame < 2; ++frame) {
    const BodyBox whole = movingRoot(frame);
    radius_ = std::max(radius_, (norm(whole.center) + whole.radius) * kUpward);
    displacement_ = whole.displacement;
  }
  // Below this the boxes, whose numbers are floats, may be far larger than the mesh.
  constexpr double kLeastBoxedRadius = 0x1p-80;
  if (!(radius_ < kLeastBoxedRadius)) return;
  radius_ = displacement_ = 0;
  const auto larger = [](double most, double x, double y, double z) {
    return std::max(most, (std::abs(x) + std::abs(y) + std::abs(z)) * kUpward);
  };
  for (const TreeVertex& vertex : tree.vertices()) {
    const auto &p = vertex.t0, &q = vertex.t1;
    radius_ = larger(larger(radius_, p[0], p[1], p[2]), q[0], q[1], q[2]);
    displacement_ = larger(displacement_, q[0] - p[0], q[1] - p[1], q[2] - p[2]);
  }
}

MovingBody::MovingBody(const ConvexShape& shape, const MotionPath& path)
    : shape_(&shape), path_(path) {
  radius_ = radiusOf(shape.box());
}

MovingBody::MovingBody(OctreeCells& cells, const MotionPath& path)
    : octree_(&cells), path_(path) {
  assert(!cells.isEmpty());
  radius_ = radiusOf(cells.box(0));
}

BodyPart MovingBody::root() const {
  if (shape_) return {~0, 0};
  if (octree_) return {octree_->isLeaf(0) ? ~0 : 0, 0};
  if (tree_) return {0, BodyPart::kRoot};
  const int link = rigid_->link(0);
  return {link < 0 ? link : 0, 0};
}

// FCL's volume, padded by the slack times its coordinates, since points may stand out of
// it by that much.
BodyBox MovingBody::rigidBox(int node) const {
  OrientedBox from;
  rigid_->orientedBox(node, from);
  BodyBox box;
  double square = 0;
  for (int i = 0; i < 3; ++i) {
    box.center[i] = from.center[i];
    box.extent[i] = std::abs(from.extent[i]);
    for (int k = 0; k < 3; ++k) box.axis[i][k] = from.axis[i][k];
    square += box.extent[i] * box.extent[i];
  }
  if (!(square < kMostExtent)) return unboundedBox();
  const double half = std::sqrt(square);
  box.pad = 2 * rigid_->slack() * (norm(box.center) + half) * kUpward;
  box.radius = half * (1 + rigid_->slack()) + box.pad;
  box.displacement = 0;
  return box;
}

BodyBox MovingBody::movingBox(std::int32_t box, int frame) const {
  const MovingKdopNode& node = tree_->node(box / MovingKdopNode::kWidth);
  const int lane = box % MovingKdopNode::kWidth;
  assert(box >= 0 && lane < node.count);
  const auto half = [&](int j) {
    const int row = MovingKdopNode::rowOf(j);
    return frame == 0 ? node.t0[row][lane] : node.t1[row][lane];
  };
  BodyBox out = boxOfSlabs(half, tree_->origin(frame));
  out.displacement = std::sqrt(3.) * double{node.displacement[lane]} * kUpward;
  return out;
}

BodyBox MovingBody::movingRoot(int frame) const {
  const MovingKdopNode& node = tree_->node(0);
  const auto half = [&](int j) {
    const int row = MovingKdopNode::rowOf(j);
    const auto& rows = frame == 0 ? node.t0[row] : node.t1[row];
    return *std::max_element(rows, rows + node.count);
  };
  BodyBox out = boxOfSlabs(half, tree_->origin(frame));
  out.displacement =
      std::sqrt(3.) *
      double{*std::max_element(node.displacement, node.displacement + node.count)} *
      kUpward;
  assert(containsTop(out, frame));
  return out;
}

/// Whether the box of a mesh that deforms contains those of its first node. For
/// assertions.
bool MovingBody::containsTop(const BodyBox& root, int frame) const {
  for (int lane = 0; lane < tree_->node(0).count; ++lane)
    if (!contains(root, movingBox(lane, frame))) return false;
  return true;
}

BodyBox MovingBody::box(const BodyPart& part, int frame) const {
  if (shape_) return shape_->box();
  if (octree_) return octree_->box(part.box);
  if (!tree_) return rigidBox(part.box);
  return part.box == BodyPart::kRoot ? movingRoot(frame) : movingBox(part.box, frame);
}

double MovingBody::reach(const BodyPart& part, double t, const Vec& direction,
                         std::int64_t& room) const {
  assert(isTimeOfStep(t));
  if (isMesh()) return reachOfMesh(part, t, direction, room);
  --room;
  return shape_ ? shape_->reach(direction) : octree_->reach(part.box, direction);
}

double MovingBody::reachOfMesh(const BodyPart& part, double t, const Vec& direction,
                               std::int64_t& room) const {
  double most = -HUGE_VAL;
  std::vector<BodyPart> left{part};
  while (!left.empty() && room >= 0) {
    const BodyPart at = left.back();
    left.pop_back();
    if (!at.isTriangle()) {
      BodyPart below[BodyBoxes::kWidth];
      const int count = children(at, below);
      left.insert(left.end(), below, below + count);
      continue;
    }
    --room;
    if (!isReadable(~at.child)) return HUGE_VAL;
    const BodyTriangle of = triangle(~at.child);
    for (int k = 0; k < 3; ++k)
      most = std::max(most, dot(direction, lerp(of.corner[0][k], of.corner[1][k], t)));
  }
  // All triangles are in the box of the part.
  assert(!(most > (1 - t) * reachOfBox(box(part, 0), direction) +
                      t * reachOfBox(box(part, 1), direction)));
  return most;
}

void MovingBody::openOctree(std::int32_t node, BodyNode& out) const {
  const OctreeCells::Children children = octree_->open(node);
  assert(children.count <= BodyBoxes::kWidth);
  out.count = children.count;
  for (int lane = 0; lane < BodyBoxes::kWidth && children.count > 0; ++lane) {
    const std::int32_t child = children.first + std::min(lane, children.count - 1);
    out.part[lane] = {octree_->isLeaf(child) ? ~child : child, child};
    out.box[0].set(lane, octree_->box(child));
  }
}

void MovingBody::open(const BodyPart& part, BodyNode& out) const {
  assert(!shape_ && !part.isTriangle());
  if (octree_) return openOctree(part.child, out);
  constexpr int kWidth = BodyBoxes::kWidth;
  if (tree_) {
    openMoving(*tree_, part.child, out);
    assert(containTriangles(out));
    return;
  }
  std::int32_t nodes[kWidth], children[kWidth];
  out.count = openBinary(part.child, nodes, children,
                         [this](std::int32_t i) { return rigid_->link(i); });
  assert(0 < out.count && out.count <= kWidth);
  for (int lane = 0; lane < out.count; ++lane) rigid_->prefetch(nodes[lane]);
  for (int lane = 0; lane < kWidth; ++lane) {
    const int from = std::min(lane, out.count - 1);
    out.part[lane] = {children[from], nodes[from]};
    out.box[0].set(lane, rigidBox(nodes[from]));
  }
  assert(containTriangles(out));
}

/// Whether the boxes of the triangles among the children contain them at t = 0 and t = 1,
/// and the bound on the way between is one. For assertions.
bool MovingBody::containTriangles(const BodyNode& node) const {
  for (int lane = 0; lane < node.count; ++lane) {
    if (!node.part[lane].isTriangle() || !isReadable(~node.part[lane].child)) continue;
    const BodyTriangle of = triangle(~node.part[lane].child);
    const BodyBox begin = node.box[0].get(lane),
                  end = node.box[isRigid() ? 0 : 1].get(lane);
    for (int k = 0; k < 3; ++k) {
      const Vec &x = of.corner[0][k], &y = of.corner[1][k];
      if (!contains(begin, x) || !contains(end, y) ||
          norm(y - x) > begin.displacement * kUpward)
        return false;
    }
  }
  return true;
}

int MovingBody::children(const BodyPart& part, BodyPart (&out)[BodyBoxes::kWidth]) const {
  assert(isMesh() && !part.isTriangle());
  if (tree_) {
    const MovingKdopNode& node = tree_->node(part.child);
    for (int lane = 0; lane < node.count; ++lane)
      out[lane] = {node.child[lane], part.child * MovingKdopNode::kWidth + lane};
    return node.count;
  }
  const int first = rigid_->link(part.child);
  for (int i = 0; i < 2; ++i) {
    const int link = rigid_->link(first + i);
    out[i] = {link < 0 ? link : first + i, first + i};
  }
  return 2;
}

MeshInstance MovingBody::meshInBodyFrame() const {
  assert(isMesh());
  MeshInstance mesh;
  mesh.name = path_.name();
  mesh.frames = frames_;
  mesh.tree = tree_;
  if (rigid_) mesh.rigid = *rigid_;
  mesh.triangles = triangles_;
  return mesh;
}

std::vector<std::int32_t> MovingBody::placesOfTriangles() const {
  assert(isMesh());
  if (!tree_) return {};
  const auto& triangles = tree_->triangles();
  std::vector<std::int32_t> places(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    assert(triangles[i].index < places.size() && places[triangles[i].index] == 0);
    places[triangles[i].index] = static_cast<std::int32_t>(i);
  }
  return places;
}

BodyTriangle MovingBody::triangle(std::int32_t place) const {
  assert(isMesh() && place >= 0);
  BodyTriangle out;
  if (tree_) {
    assert(place < numTriangles());
    const TreeTriangle& from = tree_->triangles()[static_cast<std::size_t>(place)];
    out.index = static_cast<std::int32_t>(from.index);
    out.owned = from.owned;
    for (int k = 0; k < 3; ++k) {
      assert(from.place[k] < tree_->vertices().size());
      const TreeVertex& vertex = tree_->vertices()[from.place[k]];
      out.vertex[k] = static_cast<std::int32_t>(from.id[k]);
      out.corner[0][k] = {vertex.t0[0], vertex.t0[1], vertex.t0[2]};
      out.corner[1][k] = {vertex.t1[0], vertex.t1[1], vertex.t1[2]};
    }
    return out;
  }
  out.index = place;
  out.owned = kOwnsAll;
  for (int k = 0; k < 3; ++k) {
    const std::size_t id = triangles_.id(static_cast<std::size_t>(place), k);
    if (id >= frames_.size())
      throwBadInput(std::string(path_.name()) + ": triangle " + std::to_string(place) +
                    " refers to a vertex that is not there. The model has " +
                    std::to_string(frames_.size()) + ", numbered from 0");
    double p[3];
    frames_.at(0, id, p);
    for (const double x : p)
      if (!std::isfinite(x)) throw NonFiniteVertex(path_.name(), id);
    out.vertex[k] = static_cast<std::int32_t>(id);
    out.corner[0][k] = out.corner[1][k] = {p[0], p[1], p[2]};
  }
  // As in assignFeatures(), an edge with two equal ids is not an edge.
  for (unsigned k = 0; k < 3; ++k)
    if (out.vertex[k] == out.vertex[(k + 1) % 3]) out.owned &= ~(1U << (3 + k));
  return out;
}

/// Its vertices are there and finite. An error is for a pair that is advanced.
bool MovingBody::isReadable(std::int32_t place) const {
  assert(isMesh() && place >= 0);
  if (tree_) return true;
  for (int k = 0; k < 3; ++k) {
    const std::size_t id = triangles_.id(static_cast<std::size_t>(place), k);
    if (id >= frames_.size()) return false;
    double p[3];
    frames_.at(0, id, p);
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
      return false;
  }
  return true;
}

void MovingBody::setTriangles(const BodyNode& node, BodyTriangles& out) const {
  assert(isMesh());
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (int lane = 0; lane < node.count; ++lane) {
    if (!node.part[lane].isTriangle()) continue;
    BodyTriangle from;
    for (auto& corners : from.corner)
      for (Vec& x : corners) x = {kNaN, kNaN, kNaN};
    const std::int32_t place = ~node.part[lane].child;
    if (isReadable(place)) from = triangle(place);
    for (int frame = 0; frame < (isRigid() ? 1 : 2); ++frame)
      for (int i = 0; i < 3; ++i) {
        const Vec& x = from.corner[frame][i];
        out.corner[frame][i][0][lane] = x.x;
        out.corner[frame][i][1][lane] = x.y;
        out.corner[frame][i][2][lane] = x.z;
      }
  }
}

// The interpolation of a vertex of a mesh that deforms rounds by 3 u of its coordinates.
// Its velocity has the additional term R x', where x' is a difference that rounds once.
double MovingBody::positionError() const {
  const double deforming = displacement_ > 0 ? 6 * kUnit * radius_ : 0;
  return path_.positionError(radius_) + path_.stretch() * deforming;
}
double MovingBody::rateError() const {
  return path_.rateError(radius_) + path_.positionError(displacement_);
}
double MovingBody::speed() const {
  return path_.speed(radius_) + path_.stretch() * displacement_;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
