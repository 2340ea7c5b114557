// SPDX-License-Identifier: BSD-3-Clause
#include "approach_cases.h"

#include <octomap/octomap.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/octree/octree.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/narrowphase/continuous_distance.h"
#include "fcl/narrowphase/distance.h"
#include "feature_distance.h"
#include "moving_objects.h"
#include "posed_shape.h"

namespace fcl {
namespace test {
namespace {

using V = Vector3<double>;
using Pose = Transform3<double>;
using Request = ContinuousDistanceRequest<double>;
using Result = ContinuousDistanceResult<double>;

/// A triangle, an edge or a point of a mesh, by its vertices.
using Piece = std::vector<std::size_t>;

/// A random object on a random motion, as the library sees it and by formulas.
struct Moving {
  std::string kind;
  std::shared_ptr<CollisionGeometry<double>> geometry;
  ReferenceMotion reference;
  std::shared_ptr<MotionBase<double>> motion;
  /// Of a mesh: its vertices at both ends in its frame, and its parts by their numbers.
  std::vector<V> t0, t1;
  std::vector<Piece> pieces;
  /// A shape, or the cells of an octree, and where they are in its frame.
  std::vector<PosedShape> shapes;
  std::vector<V> centers;

  bool isMesh() const { return shapes.empty(); }

  Pose poseAt(double t) const {
    const RealPose at = reference.at(t);
    Pose pose = Pose::Identity();
    pose.linear() = at.rotation.cast<double>();
    pose.translation() = at.translation.cast<double>();
    return pose;
  }
  /// The shape or the cells in their places.
  std::vector<PosedShape> shapesAt(double t) const {
    std::vector<PosedShape> out = shapes;
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i].pose = poseAt(t);
      out[i].pose.translate(centers[i]);
    }
    return out;
  }
  std::vector<V> verticesAt(double t) const {
    const RealPose pose = reference.at(t);
    std::vector<V> out;
    for (std::size_t i = 0; i < t0.size(); ++i)
      out.push_back((pose * V((1 - t) * t0[i] + t * t1[i])).cast<double>());
    return out;
  }
};

void setMesh(Random& random, Moving& object) {
  const bool deforms = object.kind != "rigid", has_free = object.kind == "free";
  TestMesh mesh =
      random.index(2)
          ? makeUvSphere(4, 3, random.uniform(0.2, 0.5))
          : makeBox(V(random.uniform(0.1, 0.4), random.uniform(0.1, 0.4), 0.2), 1);
  for (V& p : mesh.vertices) p += random.point(0.05);
  std::vector<FreeEdge> edges;
  std::vector<std::size_t> points;
  if (has_free) {
    if (random.index(2)) mesh.triangles.clear();
    const std::size_t first = mesh.vertices.size();
    for (int i = 0; i < 5; ++i) mesh.vertices.push_back(random.point(0.5));
    edges = {{first, first + 1}, {first + 1, first + 2}};
    points = {first + 3, first + 4};
  }
  object.t0 = object.t1 = mesh.vertices;
  if (deforms)
    for (V& p : object.t1) p += random.point(0.2);
  for (const Triangle& t : mesh.triangles) object.pieces.push_back({t[0], t[1], t[2]});
  for (const auto& e : edges) object.pieces.push_back({e[0], e[1]});
  for (const std::size_t p : points) object.pieces.push_back({p});
  if (!deforms) {
    auto model = std::make_shared<BVHModel<OBBRSS<double>>>();
    model->beginModel();
    model->addSubModel(mesh.vertices, mesh.triangles);
    model->endModel();
    object.geometry = model;
    return;
  }
  auto model = std::make_shared<DeformableBVHModel<KDOP<double, 16>>>();
  model->beginModel();
  if (has_free)
    model->addSubModel(mesh.vertices, mesh.triangles, edges, points);
  else
    model->addSubModel(mesh.vertices, mesh.triangles);
  model->endModel();
  model->updateFrames(object.t0[0].data(), object.t1[0].data(), object.t0.size());
  object.geometry = model;
}

void setOctree(Random& random, Moving& object) {
  constexpr double kResolution = 0.25;
  auto map = std::make_shared<octomap::OcTree>(kResolution);
  for (int i = 0; i < 4; ++i) {
    const V p = random.point(0.5);
    map->updateNode(octomap::point3d(float(p[0]), float(p[1]), float(p[2])), true);
  }
  map->updateInnerOccupancy();
  object.geometry = std::make_shared<OcTree<double>>(map);
  for (auto leaf = map->begin_leafs(); leaf != map->end_leafs(); ++leaf) {
    PosedShape cell;
    cell.kind = "box";
    const double half = leaf.getSize() / 2;
    cell.size = V(half, half, half);
    for (int i = 0; i < 8; ++i)
      cell.points.push_back(half * V(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    cell.geometry = std::make_shared<Box<double>>(2 * half, 2 * half, 2 * half);
    object.shapes.push_back(cell);
    object.centers.emplace_back(leaf.getX(), leaf.getY(), leaf.getZ());
  }
}

Moving randomObject(Random& random, const std::string& kind) {
  Moving object;
  object.kind = kind;
  if (kind == "rigid" || kind == "deforming" || kind == "free")
    setMesh(random, object);
  else if (kind == "octree")
    setOctree(random, object);
  else
    object.shapes.push_back(randomShape(kind, random));
  object.centers.resize(object.shapes.size(), V::Zero());
  if (!object.geometry) object.geometry = object.shapes.front().geometry;
  object.reference = randomMotion(random, 1);
  // FCL's screw is a little off its end at small angles.
  if (object.reference.kind == ReferenceMotion::Kind::kScrew &&
      object.reference.angle < 0.1)
    object.reference.turn(randomDirection(random), 1);
  object.motion = toFcl(object.reference);
  return object;
}

bool doCross(const std::vector<V>& edge, const std::vector<V>& face) {
  const V &p = edge[0], &q = edge[1], &a = face[0], &b = face[1], &c = face[2];
  const auto volume = [](const V& x, const V& y, const V& z, const V& w) {
    return (y - x).cross(z - x).dot(w - x);
  };
  if ((volume(a, b, c, p) > 0) == (volume(a, b, c, q) > 0)) return false;
  const bool side = volume(p, q, a, b) > 0;
  return (volume(p, q, b, c) > 0) == side && (volume(p, q, c, a) > 0) == side;
}

/// Of two triangles, edges or points.
double pieceDistance(const std::vector<V>& a, const std::vector<V>& b) {
  double least = HUGE_VAL;
  const auto edgesOf = [](const std::vector<V>& x) {
    std::vector<std::vector<V>> edges;
    if (x.size() == 1) return std::vector<std::vector<V>>{{x[0], x[0]}};
    for (std::size_t k = 0; k < (x.size() == 3 ? 3U : 1U); ++k)
      edges.push_back({x[k], x[(k + 1) % x.size()]});
    return edges;
  };
  for (const auto& e : edgesOf(a))
    for (const auto& f : edgesOf(b))
      least = std::min(least, distanceOfEdges(e[0], e[1], f[0], f[1]));
  for (const bool swapped : {false, true}) {
    const auto &x = swapped ? b : a, &y = swapped ? a : b;
    if (y.size() != 3) continue;
    for (const V& p : x) least = std::min(least, distanceToFace(p, y[0], y[1], y[2]));
    for (const auto& e : edgesOf(x))
      if (doCross(e, y)) return 0;
  }
  return least;
}

std::vector<V> placed(const Piece& piece, const std::vector<V>& vertices) {
  std::vector<V> out;
  for (const std::size_t id : piece) out.push_back(vertices[id]);
  return out;
}

double meshDistance(const Moving& a, const Moving& b, double t) {
  const std::vector<V> x = a.verticesAt(t), y = b.verticesAt(t);
  double least = HUGE_VAL;
  for (const Piece& p : a.pieces)
    for (const Piece& q : b.pieces)
      least = std::min(least, pieceDistance(placed(p, x), placed(q, y)));
  return least;
}

/// What FCL measures: a shape, a cell, or a model of the triangles at a time.
struct Measured {
  std::shared_ptr<CollisionGeometry<double>> geometry;
  Pose pose;
};

std::vector<Measured> measuredOf(const Moving& object, double t) {
  std::vector<Measured> out;
  for (const PosedShape& shape : object.shapesAt(t))
    out.push_back({shape.geometry, shape.pose});
  if (!object.isMesh()) return out;
  // A free edge or point is a thin triangle.
  auto model = std::make_shared<BVHModel<OBBRSS<double>>>();
  const std::vector<V> x = object.verticesAt(t);
  model->beginModel();
  for (const Piece& p : object.pieces)
    model->addTriangle(x[p[0]], x[p[std::min<std::size_t>(1, p.size() - 1)]],
                       x[p.back()]);
  model->endModel();
  return {{model, Pose::Identity()}};
}

/// Of a plane or a halfspace and another object: the height of its lowest point.
double flatDistance(const Moving& flat, const Moving& other, double t) {
  const PosedShape at = flat.shapesAt(t).front();
  const V n = at.pose.linear() * at.normal;
  const double offset = at.offset + n.dot(at.pose.translation());
  double lowest = HUGE_VAL, highest = -HUGE_VAL;
  const auto take = [&](const V& low, const V& high) {
    lowest = std::min(lowest, n.dot(low) - offset);
    highest = std::max(highest, n.dot(high) - offset);
  };
  double least = HUGE_VAL;
  const auto close = [&] {
    const double above = at.kind == "plane" ? std::max(lowest, -highest) : lowest;
    least = std::min(least, std::max(above, 0.));
    lowest = HUGE_VAL;
    highest = -HUGE_VAL;
  };
  for (const PosedShape& shape : other.shapesAt(t)) {
    take(shape.support(-n), shape.support(n));
    close();
  }
  const std::vector<V> x = other.verticesAt(t);
  for (const Piece& piece : other.pieces) {
    for (const V& p : placed(piece, x)) take(p, p);
    close();
  }
  return least;
}

bool isFlat(const Moving& object) {
  return object.kind == "plane" || object.kind == "halfspace";
}

bool isRounded(const Moving& object) {
  return object.kind == "sphere" || object.kind == "capsule";
}

/// Of a sphere or a capsule and a mesh. FCL's distance of a sphere from a triangle
/// without area is 0.
double roundedDistance(const Moving& rounded, const Moving& mesh, double t) {
  const PosedShape shape = rounded.shapesAt(t).front();
  std::vector<V> core;
  for (const V& p : shape.points) core.push_back(shape.pose * p);
  const std::vector<V> x = mesh.verticesAt(t);
  double least = HUGE_VAL;
  for (const Piece& piece : mesh.pieces)
    least = std::min(least, pieceDistance(core, placed(piece, x)) - shape.radius);
  return std::max(least, 0.);
}

double distanceAt(const Moving& a, const Moving& b, double t) {
  if (a.isMesh() && b.isMesh()) return meshDistance(a, b, t);
  if (isRounded(a) && b.isMesh()) return roundedDistance(a, b, t);
  if (isRounded(b) && a.isMesh()) return roundedDistance(b, a, t);
  if (isFlat(a)) return flatDistance(a, b, t);
  if (isFlat(b)) return flatDistance(b, a, t);
  double least = HUGE_VAL;
  for (const Measured& x : measuredOf(a, t))
    for (const Measured& y : measuredOf(b, t)) {
      DistanceResult<double> result;
      fcl::distance(x.geometry.get(), x.pose, y.geometry.get(), y.pose,
                    DistanceRequest<double>(), result);
      least = std::min(least, std::max(result.min_distance, 0.));
    }
  return least;
}

/// How far a point is from the part of an object that is named.
double outside(const Moving& object, std::intptr_t part, const V& p, double t) {
  if (object.isMesh())
    return pieceDistance({p}, placed(object.pieces.at(static_cast<std::size_t>(part)),
                                     object.verticesAt(t)));
  double least = HUGE_VAL;
  for (const PosedShape& shape : object.shapesAt(t))
    least = std::min(least, shape.outside(p));
  return least;
}

Result ask(const Moving& a, const Moving& b, const Request& request) {
  Result result;
  continuousDistance(a.geometry.get(), a.motion.get(), b.geometry.get(), b.motion.get(),
                     request, result);
  return result;
}

Request randomRequest(Random& random) {
  constexpr double kErrors[] = {1e-1, 1e-2, 1e-3, 1e-5};
  Request request;
  request.rel_err = random.index(3) ? kErrors[random.index(4)] : 0;
  request.abs_err = random.index(3) && request.rel_err > 0 ? 0 : kErrors[random.index(4)];
  if (!random.index(4)) request.t_max = random.uniform(0, 1);
  if (!random.index(4)) request.max_distance = random.uniform(0.01, 1);
  return request;
}

/// A sample of FCL's distance may be off by this, one of the formulas by rounding.
double errorOfSamples(const Moving& a, const Moving& b) {
  const bool is_exact = (a.isMesh() && b.isMesh()) || isFlat(a) || isFlat(b);
  return is_exact ? 1e-11 : 1e-5;
}

std::string wrongBracket(const Moving& a, const Moving& b, const Request& request,
                         const Result& found, int samples, ApproachTally& tally) {
  constexpr double kRounding = 1e-11;
  const double wanted =
      std::max(request.abs_err, request.rel_err * found.distance_hi) + kRounding;
  for (int i = 0; i <= samples; ++i) {
    const double t = request.t_max * i / samples;
    if (distanceAt(a, b, t) < found.distance_lo - errorOfSamples(a, b))
      return "a sample is below distance_lo, at " + std::to_string(t);
  }
  if (found.is_cut_off) {
    if (found.distance_lo != request.max_distance) return "cut off at another distance";
    if (!(found.distance_hi > request.max_distance)) return "cut off too early";
  } else if (!(found.distance_hi - found.distance_lo <= wanted)) {
    return "the bracket is too wide";
  } else {
    tally.widest =
        std::max(tally.widest, (found.distance_hi - found.distance_lo) / wanted);
  }
  if (!(found.distance_hi < HUGE_VAL)) return {};
  const V &p = found.nearest_points[0], &q = found.nearest_points[1];
  if (!((p - q).norm() <= found.distance_hi + kRounding))
    return "the points are further apart than distance_hi";
  if (outside(a, found.b1, p, found.time) > 1e-9) return "the first point is outside";
  if (outside(b, found.b2, q, found.time) > 1e-9) return "the second point is outside";
  return {};
}

std::string kindFor(Random& random) {
  const char* const kinds[] = {"rigid",     "deforming", "free",     "rigid",
                               "sphere",    "capsule",   "box",      "ellipsoid",
                               "cone",      "cylinder",  "convex",   "plane",
                               "halfspace", "octree",    "deforming"};
  return kinds[random.index(sizeof(kinds) / sizeof(kinds[0]))];
}

}  // namespace

std::string approachDisagreement(std::uint64_t number, int samples,
                                 ApproachTally& tally) {
  Random random(number);
  const Moving a = randomObject(random, kindFor(random));
  Moving b = randomObject(random, kindFor(random));
  while (isFlat(a) && isFlat(b)) b = randomObject(random, kindFor(random));
  Request request = randomRequest(random);
  const Result found = ask(a, b, request);
  ++tally.cases;
  ++tally.kinds[a.kind + "-" + b.kind];
  ContinuousContactRequest<double> contact_request;
  contact_request.query = ContinuousQuery::kFirst;
  contact_request.t_max = request.t_max;
  ContinuousContactResult<double> contact;
  continuousCollide(a.geometry.get(), a.motion.get(), b.geometry.get(), b.motion.get(),
                    contact_request, contact);
  const bool is_contact = contact.is_collide;
  if (found.is_collide != is_contact) return "is_collide is wrong";
  tally.contacts += is_contact;
  tally.cut_off += found.is_cut_off;
  if (is_contact) {
    if (found.distance_hi != 0 || found.time != contact.time_of_contact)
      return "a contact has another time or a distance";
  } else {
    const std::string wrong = wrongBracket(a, b, request, found, samples, tally);
    if (!wrong.empty()) return wrong;
  }
  request.num_threads = 2;
  const Result threads = ask(a, b, request);
  if (threads.distance_lo != found.distance_lo ||
      threads.distance_hi != found.distance_hi || threads.time != found.time)
    return "two threads give another answer";
  const Result swapped = ask(b, a, request);
  if (swapped.is_collide != found.is_collide ||
      swapped.distance_lo > found.distance_hi + 1e-11 ||
      found.distance_lo > swapped.distance_hi + 1e-11)
    return "the swapped pair has another answer";
  return {};
}

}  // namespace test
}  // namespace fcl
