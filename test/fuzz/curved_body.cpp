// SPDX-License-Identifier: BSD-3-Clause
#include "curved_body.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/octree/octree.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/motion/twist_motion.h"
#include "fcl/narrowphase/octree_cell.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

constexpr double kResolution = 0.125;

std::string code(const Vector3<double>& v) {
  std::ostringstream out;
  out << std::hexfloat << "Vector(" << v[0] << ", " << v[1] << ", " << v[2] << ")";
  return out.str();
}

std::string code(const Transform3<double>& tf) {
  std::ostringstream out;
  out << std::hexfloat << "poseOf({";
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) out << tf.linear()(i, k) << ", ";
  out << "}, " << code(Vector3<double>(tf.translation())) << ")";
  return out.str();
}

CurvedPath pathOf(const ReferenceMotion& motion) {
  using Kind = ReferenceMotion::Kind;
  CurvedPath path{
      toFcl(motion), [motion](Real t) { return motion.at(t); }, 550, 0, {}, false, false};
  std::ostringstream code;
  if (motion.kind == Kind::kSpline) {
    double most = 0;
    code << "SplineMotion<double>(";
    for (const auto& p : motion.translation_points) {
      code << test::code(p) << ", ";
      path.more_size = std::max(path.more_size, p.norm());
    }
    for (const auto& p : motion.rotation_points) {
      code << test::code(p) << ", ";
      most = std::max(most, p.norm());
    }
    path.tolerance = 400 + 320 * most;
    path.is_straight = most == 0;
  } else {
    const bool is_screw = motion.kind == Kind::kScrew;
    code << (is_screw ? "ScrewMotion" : "InterpMotion") << "<double>("
         << test::code(motion.beginning) << ", " << test::code(motion.end) << ", "
         << (is_screw ? "" : test::code(motion.reference)) << ")";
    path.more_size = is_screw ? 0 : motion.reference.norm();
    path.is_straight = motion.angle == 0;
    const Vector3<double> way = motion.end.translation() - motion.beginning.translation();
    // The axis of a screw may be far away.
    if (is_screw && motion.angle > 0)
      path.more_size = way.norm() / (2 * std::sin(motion.angle / 2));
  }
  path.code = code.str();
  return path;
}

/// A velocity and an angular velocity that are constant.
struct Twist {
  Transform3<double> pose;
  Vector3<double> linear, angular, reference;
  ReferencePath kind;

  RealPose at(Real t) const {
    const RealVector w = angular.cast<Real>(), v = linear.cast<Real>(),
                     o = reference.cast<Real>();
    const RealMatrix r0 = pose.linear().cast<Real>();
    const RealVector from = r0 * o + pose.translation().cast<Real>();
    const Real speed = w.norm();
    RealPose out{r0, RealVector::Zero()};
    RealVector to = from + t * v;
    if (speed > 0) {
      const RealVector axis = w / speed, along = axis * axis.dot(v), across = v - along;
      out.rotation = rotationAbout(axis, speed * t) * r0;
      if (kind == ReferencePath::kScrew)
        to = from + t * along + sin(speed * t) / speed * across +
             (1 - cos(speed * t)) / speed * axis.cross(across);
    }
    out.translation = to - out.rotation * o;
    return out;
  }
};

CurvedPath pathOf(const Twist& twist) {
  std::ostringstream text;
  text << "TwistMotion<double>(" << code(twist.pose) << ", " << code(twist.linear) << ", "
       << code(twist.angular) << ", ReferencePath::"
       << (twist.kind == ReferencePath::kScrew ? "kScrew" : "kStraight") << ", "
       << code(twist.reference) << ")";
  return {std::make_shared<TwistMotion<double>>(twist.pose, twist.linear, twist.angular,
                                                twist.kind, twist.reference),
          [twist](Real t) { return twist.at(t); },
          1410 + 40 * twist.angular.norm(),
          twist.reference.norm() + twist.linear.norm(),
          text.str(),
          false,
          true};
}

std::vector<RealVector> asReal(const std::vector<Vector3<double>>& points) {
  std::vector<RealVector> out;
  for (const auto& p : points) out.push_back(p.cast<Real>());
  return out;
}

ConvexPiece pieceOfShape(const PosedShape& shape) {
  using Kind = ConvexPiece::Kind;
  ConvexPiece piece;
  piece.t0 = piece.t1 = asReal(shape.points);
  piece.radius = shape.radius;
  piece.size = shape.size.cast<Real>();
  if (shape.kind == "ellipsoid") piece.kind = Kind::kEllipsoid;
  if (shape.kind == "cone") piece.kind = Kind::kCone;
  if (shape.kind == "cylinder") piece.kind = Kind::kCylinder;
  if (!shape.isFlat()) return piece;
  piece.kind = shape.kind == "plane" ? Kind::kPlane : Kind::kHalfspace;
  piece.normal = shape.normal.cast<Real>();
  piece.offset = shape.offset;
  return piece;
}

std::pair<RealVector, Real> ballOf(const ConvexPiece& piece) {
  if (piece.isFlat()) return {RealVector::Zero(), Real{1e9}};
  RealVector middle = RealVector::Zero();
  for (const auto* points : {&piece.t0, &piece.t1})
    for (const RealVector& p : *points)
      middle += p / static_cast<Real>(2 * points->size());
  Real radius = piece.kind == ConvexPiece::Kind::kPoints ? Real{0} : piece.size.norm();
  for (const auto* points : {&piece.t0, &piece.t1})
    for (const RealVector& p : *points)
      radius = std::max<Real>(radius, (p - middle).norm());
  return {middle, radius + piece.radius};
}

float middleOf(int key) { return static_cast<float>((key + 0.5) * kResolution); }

std::shared_ptr<octomap::OcTree> mapOf(const std::vector<std::array<int, 3>>& cells) {
  auto map = std::make_shared<octomap::OcTree>(kResolution);
  for (const auto& c : cells)
    map->updateNode(octomap::point3d(middleOf(c[0]), middleOf(c[1]), middleOf(c[2])),
                    true);
  map->prune();
  return map;
}

/// The cells as octomap lists them: eight that are pruned are a large one.
std::vector<ConvexPiece> piecesOf(const octomap::OcTree& map) {
  std::vector<ConvexPiece> pieces;
  for (auto leaf = map.begin_leafs(); leaf != map.end_leafs(); ++leaf) {
    const octomap::point3d middle = leaf.getCoordinate();
    const RealVector center(Real{middle.x()}, Real{middle.y()}, Real{middle.z()});
    ConvexPiece piece;
    for (int i = 0; i < 8; ++i)
      piece.t0.push_back(center +
                         Real{leaf.getSize()} / 2 *
                             RealVector(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    piece.t1 = piece.t0;
    pieces.push_back(piece);
  }
  return pieces;
}

std::shared_ptr<CollisionGeometry<double>> modelOf(const MovingMesh& mesh) {
  const TestMesh from{mesh.t0, mesh.triangles};
  if (mesh.t0 == mesh.t1 && mesh.triangles.size() % 2 == 0)
    return makeModel<BVHModel<OBBRSS<double>>>(from);
  auto model = makeModel<DeformableBVHModel<KDOP<double, 16>>>(from);
  if (model->updateFrames(mesh.previous(), mesh.current(), mesh.t0.size()) != BVH_OK)
    throw std::runtime_error(model->lastError());
  return model;
}

}  // namespace

CurvedPath randomPath(Random& random) {
  if (random.index(4) != 0) return pathOf(randomMotion(random, 1));
  constexpr double kAngles[] = {1e-6, 0.3, 1, 2.5, 3.5, 7};
  Twist twist{Transform3<double>::Identity(), random.point(1),
              kAngles[random.index(6)] * randomDirection(random), random.point(0.5),
              random.index(2) ? ReferencePath::kScrew : ReferencePath::kStraight};
  twist.pose.linear() = randomRotation(random);
  twist.pose.translation() = random.point(1);
  return pathOf(twist);
}

void CurvedBody::build() {
  pieces.clear();
  balls.clear();
  if (kind == Kind::kShape) {
    geometry = shape.geometry;
    pieces.push_back(pieceOfShape(shape));
  } else if (kind == Kind::kMesh) {
    geometry = modelOf(mesh);
    for (const Triangle& t : mesh.triangles) {
      ConvexPiece piece;
      for (int k = 0; k < 3; ++k) {
        piece.t0.push_back(mesh.t0[t[k]].cast<Real>());
        piece.t1.push_back(mesh.t1[t[k]].cast<Real>());
      }
      pieces.push_back(piece);
    }
  } else {
    const auto map = mapOf(cells);
    geometry = std::make_shared<OcTree<double>>(map);
    pieces = piecesOf(*map);
  }
  for (const ConvexPiece& piece : pieces) balls.push_back(ballOf(piece));
}

std::size_t CurvedBody::pieceOf(std::intptr_t b) const {
  if (kind == Kind::kShape) return 0;
  if (kind == Kind::kMesh) return static_cast<std::size_t>(b);
  const OctreeCell<double> cell =
      octreeCell(static_cast<const OcTree<double>&>(*geometry), b);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Vector3<double> lowest = pieces[i].t0.front().cast<double>();
    if (lowest == cell.center - Vector3<double>::Constant(cell.size / 2)) return i;
  }
  throw std::runtime_error("a contact names a cell that is not occupied");
}

std::string CurvedBody::code(const std::string& name) const {
  std::ostringstream out;
  out << std::hexfloat << "  // " << name << "\n";
  if (kind == Kind::kShape) {
    out << "  // " << shape.kind << ", radius " << shape.radius << ", sizes "
        << test::code(shape.size) << ", normal " << test::code(shape.normal)
        << ", offset " << shape.offset << ", points of the hull:\n  //";
    for (const auto& p : shape.points) out << " " << test::code(p);
    out << "\n";
  } else if (kind == Kind::kOctree) {
    out << "  // cells of " << kResolution << ":";
    for (const auto& c : cells)
      out << " {" << c[0] << ", " << c[1] << ", " << c[2] << "}";
    out << "\n";
  } else {
    out << "  const MovingMesh mesh_" << name << "{\n      {";
    for (const auto& p : mesh.t0) out << test::code(p) << ", ";
    out << "},\n      {";
    for (const auto& p : mesh.t1) out << test::code(p) << ", ";
    out << "},\n      {";
    for (const Triangle& t : mesh.triangles)
      out << "Triangle(" << t[0] << ", " << t[1] << ", " << t[2] << "), ";
    out << "}};\n";
  }
  out << "  const auto motion_" << name << " = " << path.code << ";\n";
  return out.str();
}

CurvedBody randomMeshBody(Random& random) {
  CurvedBody body{};
  body.kind = CurvedBody::Kind::kMesh;
  body.path = randomPath(random);
  const std::size_t which = random.index(16);
  if (which == 0)
    body.mesh = still(makeIcosphere(0, 0.4));
  else if (which < 4)
    body.mesh = still(makeBox(Vector3<double>::Constant(0.3)));
  else
    body.mesh = randomSoup(random, 1 + random.index(7), 3 + random.index(8), 0.5, 0);
  if (random.index(3) == 0)
    for (auto& p : body.mesh.t1) p += random.point(0.3);
  body.build();
  return body;
}

CurvedBody randomShapeBody(Random& random, bool with_flats) {
  const char* const kKinds[] = {"sphere", "capsule",  "box",    "ellipsoid",
                                "cone",   "cylinder", "convex", "triangle",
                                "plane",  "halfspace"};
  CurvedBody body{};
  body.kind = CurvedBody::Kind::kShape;
  body.path = randomPath(random);
  body.shape = randomShape(kKinds[random.index(with_flats ? 10 : 8)], random);
  body.build();
  return body;
}

CurvedBody randomOctreeBody(Random& random) {
  CurvedBody body{};
  body.kind = CurvedBody::Kind::kOctree;
  body.path = randomPath(random);
  const auto add = [&body](std::array<int, 3> cell) {
    if (!std::count(body.cells.begin(), body.cells.end(), cell))
      body.cells.push_back(cell);
  };
  const auto key = [&random] { return static_cast<int>(random.index(8)) - 4; };
  for (std::size_t n = 1 + random.index(10); n > 0; --n) add({key(), key(), key()});
  // Eight cells that are pruned into one.
  if (random.index(3) == 0)
    for (int i = 0; i < 8; ++i) add({i & 1, i >> 1 & 1, i >> 2});
  body.build();
  return body;
}

}  // namespace test
}  // namespace fcl
