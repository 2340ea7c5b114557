// SPDX-License-Identifier: BSD-3-Clause
//
// Answers in C++ for the tests of the Python package. Reads commands from stdin and
// prints each answer as numbers, one line an element. Floating-point numbers are
// hexadecimal, so that nothing is rounded. test_answers.py writes the commands.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcl/geometry/bvh/deformable_bvh_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/motion/bounded_motion.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/joint_chain.h>
#include <fcl/math/motion/screw_motion.h>
#include <fcl/math/motion/spline_motion.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/math/motion/twist_motion.h>
#include <fcl/math/motion/waypoint_motion.h>
#include <fcl/narrowphase/continuous_candidates.h>
#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/continuous_features.h>

namespace {

using fcl::Transform3d;
using fcl::Vector3d;
using Geometry = fcl::CollisionGeometry<double>;
using Request = fcl::ContinuousContactRequestd;
using Result = fcl::ContinuousContactResultd;

std::string readWord() {
  std::string word;
  if (!(std::cin >> word)) throw std::runtime_error("the input ends in a command");
  return word;
}
double readNumber() { return std::stod(readWord()); }
int readInt() { return std::stoi(readWord()); }

Vector3d readVector() {
  Vector3d v;
  for (int k = 0; k < 3; ++k) v[k] = readNumber();
  return v;
}

std::vector<Vector3d> readVectors(int count) {
  std::vector<Vector3d> vectors;
  for (int i = 0; i < count; ++i) vectors.push_back(readVector());
  return vectors;
}

std::vector<fcl::Triangle> readTriangles(int count) {
  std::vector<fcl::Triangle> triangles;
  for (int i = 0; i < count; ++i) {
    const int a = readInt(), b = readInt(), c = readInt();
    triangles.emplace_back(a, b, c);
  }
  return triangles;
}

Transform3d readPose() {
  Transform3d tf = Transform3d::Identity();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) tf.matrix()(row, column) = readNumber();
  return tf;
}

void requireOk(int code) {
  if (code != fcl::BVH_OK) throw std::runtime_error("a model refuses its input");
}

template <typename Model>
std::unique_ptr<Model> build(const std::vector<Vector3d>& vertices,
                             const std::vector<fcl::Triangle>& triangles) {
  auto model = std::make_unique<Model>();
  requireOk(model->beginModel());
  requireOk(model->addSubModel(vertices, triangles));
  requireOk(model->endModel());
  return model;
}

std::unique_ptr<Geometry> readDeformable() {
  const int num_vertices = readInt(), num_triangles = readInt();
  const auto previous = readVectors(num_vertices), current = readVectors(num_vertices);
  auto model = build<fcl::DeformableBVHModel<>>(previous, readTriangles(num_triangles));
  requireOk(model->updateFrames(previous[0].data(), current[0].data(), previous.size()));
  return model;
}

std::unique_ptr<Geometry> readRigid() {
  const int num_vertices = readInt(), num_triangles = readInt();
  const auto vertices = readVectors(num_vertices);
  return build<fcl::BVHModel<fcl::OBBRSSd>>(vertices, readTriangles(num_triangles));
}

/// A shape whose constructor takes as many numbers.
template <typename Shape, std::size_t... i>
std::unique_ptr<Geometry> readNumbers(std::index_sequence<i...>) {
  double x[sizeof...(i)];
  for (double& number : x) number = readNumber();
  return std::make_unique<Shape>(x[i]...);
}

template <typename Shape, std::size_t count>
std::unique_ptr<Geometry> readShape() {
  return readNumbers<Shape>(std::make_index_sequence<count>());
}

template <typename Flat>
std::unique_ptr<Geometry> readFlat() {
  const Vector3d normal = readVector();
  return std::make_unique<Flat>(normal, readNumber());
}

/// A tetrahedron, whose faces are always the same.
std::unique_ptr<Geometry> readTetrahedron() {
  return std::make_unique<fcl::Convexd>(
      std::make_shared<const std::vector<Vector3d>>(readVectors(4)), 4,
      std::make_shared<const std::vector<int>>(
          std::vector<int>{3, 0, 2, 1, 3, 0, 1, 3, 3, 1, 2, 3, 3, 0, 3, 2}));
}

std::unique_ptr<Geometry> readTriangle() {
  const auto corners = readVectors(3);
  return std::make_unique<fcl::TriangleP<double>>(corners[0], corners[1], corners[2]);
}

std::unique_ptr<Geometry> readOctree() {
  const double resolution = readNumber();
  const auto map = std::make_shared<octomap::OcTree>(resolution);
  for (const Vector3d& x : readVectors(readInt()))
    map->setNodeValue(octomap::point3d(static_cast<float>(x[0]), static_cast<float>(x[1]),
                                       static_cast<float>(x[2])),
                      map->getClampingThresMaxLog());
  map->prune();
  return std::make_unique<fcl::OcTree<double>>(map);
}

using Reader = std::unique_ptr<Geometry> (*)();
const std::map<std::string, Reader> kGeometries = {
    {"deformable", &readDeformable},
    {"rigid", &readRigid},
    {"OcTree", &readOctree},
    {"Box", &readShape<fcl::Boxd, 3>},
    {"Sphere", &readShape<fcl::Sphered, 1>},
    {"Capsule", &readShape<fcl::Capsuled, 2>},
    {"Ellipsoid", &readShape<fcl::Ellipsoidd, 3>},
    {"Cone", &readShape<fcl::Coned, 2>},
    {"Cylinder", &readShape<fcl::Cylinderd, 2>},
    {"Convex", &readTetrahedron},
    {"Plane", &readFlat<fcl::Planed>},
    {"Halfspace", &readFlat<fcl::Halfspaced>},
    {"TriangleP", &readTriangle},
};

std::vector<std::uint32_t> readBits() {
  std::vector<std::uint32_t> bits(static_cast<std::size_t>(readInt()));
  for (auto& b : bits) b = static_cast<std::uint32_t>(std::stoul(readWord()));
  return bits;
}

fcl::ContinuousFilter readFilter() {
  fcl::ContinuousFilter filter;
  filter.group = static_cast<std::uint32_t>(std::stoul(readWord()));
  filter.mask = static_cast<std::uint32_t>(std::stoul(readWord()));
  filter.triangle_groups = readBits();
  filter.triangle_masks = readBits();
  return filter;
}

Request readRequest() {
  Request request;
  const std::string query = readWord();
  request.query = query == "all"     ? fcl::ContinuousQuery::kAll
                  : query == "first" ? fcl::ContinuousQuery::kFirst
                                     : fcl::ContinuousQuery::kAny;
  request.toc_err = readNumber();
  request.t_max = readNumber();
  request.num_max_contacts = static_cast<std::size_t>(std::stoull(readWord()));
  request.min_distance = readNumber();
  request.ignore_initially_closer = readInt() != 0;
  request.min_approach_speed = readNumber();
  request.enable_contact = readInt() != 0;
  request.enable_crossings = readInt() != 0;
  request.filter1 = readFilter();
  request.filter2 = readFilter();
  if (readInt() != 0)
    request.accepts_triangles = [](std::intptr_t b1, std::intptr_t b2) {
      return (b1 + b2) % 3 != 0;
    };
  return request;
}

/// Swings about z by the angle a sin(t) while it falls by b t^2. The test has the same
/// functions in Python.
class Swing : public fcl::MotionBased, public fcl::BoundedMotion {
 public:
  Swing(double a, double b) : a_(a), b_(b) {}

  Placement placementAt(double t) const override {
    const double angle = a_ * std::sin(t), c = std::cos(angle), s = std::sin(angle);
    return {{c, -s, 0, s, c, 0, 0, 0, 1}, {0, 0, -b_ * t * t}};
  }
  Placement rateAt(double t) const override {
    const double angle = a_ * std::sin(t), speed = a_ * std::cos(t);
    const double c = speed * std::cos(angle), s = speed * std::sin(angle);
    return {{-s, -c, 0, c, -s, 0, 0, 0, 0}, {0, 0, -2 * b_ * t}};
  }
  double accelerationBound(const double (&center)[3], double radius, double,
                           double) const override {
    const double square =
        center[0] * center[0] + center[1] * center[1] + center[2] * center[2];
    return (a_ + a_ * a_) * (std::sqrt(square) + radius) + 2 * b_;
  }
  double angularSpeedBound(double, double) const override { return a_; }

  // What only FCL would ask for.
  bool integrate(double) const override { throw std::logic_error("FCL follows it"); }
  double computeMotionBound(const fcl::BVMotionBoundVisitor<double>&) const override {
    throw std::logic_error("FCL follows it");
  }
  double computeMotionBound(
      const fcl::TriangleMotionBoundVisitor<double>&) const override {
    throw std::logic_error("FCL follows it");
  }
  void getCurrentTransform(Transform3d&) const override {
    throw std::logic_error("FCL follows it");
  }
  void getTaylorModel(fcl::TMatrix3<double>&, fcl::TVector3<double>&) const override {
    throw std::logic_error("FCL follows it");
  }

 private:
  double a_, b_;
};

/// The joints with their values, the base, and the link.
std::unique_ptr<fcl::MotionBased> readLink(bool is_linear) {
  fcl::JointChain chain;
  const int count = readInt();
  for (int i = 0; i < count; ++i) {
    const std::string kind = readWord();
    const Transform3d origin = readPose();
    const Vector3d axis = readVector();
    const int parent = readInt();
    if (kind == "revolute") chain.addRevolute(origin, axis, parent);
    if (kind == "prismatic") chain.addPrismatic(origin, axis, parent);
    if (kind == "fixed") chain.addFixed(origin, parent);
  }
  std::vector<std::vector<double>> values(static_cast<std::size_t>(chain.numValues()));
  for (auto& of : values) {
    of.resize(static_cast<std::size_t>(readInt()));
    for (double& x : of) x = readNumber();
  }
  const Transform3d base = readPose();
  std::vector<double> begin, end;
  if (is_linear)
    for (const auto& of : values) {
      begin.push_back(of[0]);
      end.push_back(of[1]);
    }
  const auto motion = is_linear ? fcl::ChainMotion(chain, begin, end, base)
                                : fcl::ChainMotion::polynomial(chain, values, base);
  return std::make_unique<fcl::LinkMotion<double>>(motion, readInt());
}

std::unique_ptr<fcl::MotionBased> readMotion() {
  const std::string kind = readWord();
  if (kind == "link" || kind == "polynomial") return readLink(kind == "link");
  if (kind == "swing") {
    const double a = readNumber();
    return std::make_unique<Swing>(a, readNumber());
  }
  if (kind == "spline") {
    const auto t = readVectors(4), r = readVectors(4);
    return std::make_unique<fcl::SplineMotion<double>>(t[0], t[1], t[2], t[3], r[0], r[1],
                                                       r[2], r[3]);
  }
  if (kind == "twist") {
    const Transform3d pose = readPose();
    const Vector3d linear = readVector(), angular = readVector(),
                   reference = readVector();
    const auto path =
        readInt() ? fcl::ReferencePath::kScrew : fcl::ReferencePath::kStraight;
    return std::make_unique<fcl::TwistMotion<double>>(pose, linear, angular, path,
                                                      reference);
  }
  if (kind == "waypoints") {
    fcl::aligned_vector<Transform3d> poses(static_cast<std::size_t>(readInt()));
    std::vector<double> times;
    for (Transform3d& pose : poses) pose = readPose();
    for (std::size_t i = 0; i < poses.size(); ++i) times.push_back(readNumber());
    return std::make_unique<fcl::WaypointMotion<double>>(poses, times);
  }
  const Transform3d begin = readPose(), end = readPose();
  if (kind == "screw") return std::make_unique<fcl::ScrewMotion<double>>(begin, end);
  if (kind == "linear")
    return std::make_unique<fcl::InterpMotion<double>>(begin, end, readVector());
  if (kind == "translation")
    return std::make_unique<fcl::TranslationMotion<double>>(begin, end);
  throw std::runtime_error("no such motion: " + kind);
}

void print(const Transform3d& tf) {
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      std::printf("%a ", tf.matrix()(row, column));
  std::printf("\n");
}

/// FCL's own motions between two poses, as they interpolate, at t = 0.5.
void printHalfway() {
  const Transform3d begin = readPose(), end = readPose();
  const fcl::ScrewMotion<double> screw(begin, end);
  const fcl::InterpMotion<double> turn(begin.linear(), begin.translation(), end.linear(),
                                       end.translation(), Vector3d::Zero());
  const fcl::MotionBase<double>* const motions[] = {&screw, &turn};
  for (const auto* motion : motions) {
    Transform3d tf;
    motion->integrate(0.5);
    motion->getCurrentTransform(tf);
    print(tf);
  }
}

void print(const fcl::ContinuousContactd& c) {
  std::printf("%d %ld %ld", static_cast<int>(c.kind), static_cast<long>(c.b1),
              static_cast<long>(c.b2));
  std::printf(" %d %d", c.part1, c.part2);
  for (const int v : c.vertices) std::printf(" %d", v);
  std::printf(" %d %d %a %a", c.first_on_o1, c.within_tolerance, c.toc_lo, c.toc_hi);
  for (int k = 0; k < 3; ++k) std::printf(" %a", c.pos[k]);
  for (int k = 0; k < 3; ++k) std::printf(" %a", c.normal[k]);
  std::printf(" %a", c.penetration_depth);
  std::printf("\n");
}

void print(const Result& result) {
  std::printf("%d %a %d %d %zu %zu\n", result.is_collide, result.time_of_contact,
              result.contacts_cut, result.initially_crossing, result.contacts.size(),
              result.crossings.size());
  print(result.contact_tf1);
  print(result.contact_tf2);
  for (const auto& contact : result.contacts) print(contact);
  if (result.initially_crossing) print(result.crossing);
  for (const auto& crossing : result.crossings) print(crossing);
}

bool print(const fcl::ContinuousCandidate* candidates, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto& c = candidates[i];
    std::printf("%d %d", static_cast<int>(c.kind), c.first_on_o1);
    for (const int v : c.vertices) std::printf(" %d", v);
    std::printf(" %ld %ld %a %a\n", static_cast<long>(c.b1), static_cast<long>(c.b2),
                c.window_lo, c.window_hi);
  }
  return true;
}

const fcl::ContinuousCandidateSink kPrint = [](const fcl::ContinuousCandidate* candidates,
                                               std::size_t count) {
  return print(candidates, count);
};

/// @param kind  "vf", "ee", "ve" or "vv"
void answerFeatures(const std::string& kind) {
  using namespace fcl;
  const int num_points = kind == "vv" ? 2 : kind == "ve" ? 3 : 4;
  const int count = readInt();
  const double toc_err = readNumber(), d = readNumber();
  for (int i = 0; i < count; ++i) {
    const auto a = readVectors(num_points), b = readVectors(num_points);
    ContinuousFeatureTestResultd result;
    if (kind == "vv")
      result = vertexVertexWithin(a[0], a[1], b[0], b[1], toc_err, d);
    else if (kind == "ve")
      result = vertexEdgeWithin(a[0], a[1], a[2], b[0], b[1], b[2], toc_err, d);
    else if (d == 0)
      result = (kind == "vf" ? vertexFace<double>
                             : edgeEdge<double>)(a[0], a[1], a[2], a[3], b[0], b[1], b[2],
                                                 b[3], toc_err);
    else
      result = (kind == "vf" ? vertexFaceWithin<double>
                             : edgeEdgeWithin<double>)(a[0], a[1], a[2], a[3], b[0], b[1],
                                                       b[2], b[3], toc_err, d);
    std::printf("%d %a %a\n", result.is_contact, result.toc_lo, result.toc_hi);
  }
}

/// Prints the least processor time of some calls, in seconds.
template <typename Call>
void printTime(int repeats, const Call& call) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repeats; ++i) {
    const std::clock_t start = std::clock();
    call();
    least = std::min(least, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  std::printf("%a\n", least);
  std::fflush(stdout);
}

/// Times a step of a mesh: update and self-query, with a result of its own.
void timeStep() {
  const int repeats = readInt(), num_vertices = readInt(), num_triangles = readInt();
  const auto previous = readVectors(num_vertices), current = readVectors(num_vertices);
  auto model = build<fcl::DeformableBVHModel<>>(previous, readTriangles(num_triangles));
  const Request request = readRequest();
  printTime(repeats, [&] {
    requireOk(
        model->updateFrames(previous[0].data(), current[0].data(), previous.size()));
    Result result;
    fcl::continuousSelfCollide(model.get(), request, result);
  });
}

/// Times a loop over vertexFace(): arrays in, an array of answers out. The input has a
/// part of the queries, which come several times.
void timeVertexFace() {
  const int repeats = readInt(), num_different = readInt(), times = readInt();
  std::vector<Vector3d> queries = readVectors(8 * num_different);
  queries.reserve(queries.size() * static_cast<std::size_t>(times));
  const std::size_t part = queries.size();
  for (int i = 1; i < times; ++i)
    for (std::size_t k = 0; k < part; ++k) queries.push_back(queries[k]);
  printTime(repeats, [&] {
    std::vector<fcl::ContinuousFeatureTestResultd> results;
    results.reserve(queries.size() / 8);
    for (std::size_t i = 0; i < queries.size(); i += 8) {
      const Vector3d* x = &queries[i];
      results.push_back(
          fcl::vertexFace<double>(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], 1e-4));
    }
  });
}

class Commands {
 public:
  void run(const std::string& command) {
    const auto geometry = kGeometries.find(command);
    if (geometry != kGeometries.end()) {
      geometries_.push_back(geometry->second());
    } else if (command == "self") {
      const Geometry* o = readGeometry();
      fcl::continuousSelfCollide(o, readRequest(), result_);
      print(result_);
    } else if (command == "poses" || command == "motions") {
      answerPair(command == "motions");
    } else if (command == "self_candidates") {
      const Geometry* o = readGeometry();
      const double distance = readNumber();
      fcl::continuousSelfCandidates(o, kPrint, distance);
    } else if (command == "candidates") {
      const Geometry *o1 = readGeometry(), *o2 = readGeometry();
      Transform3d tf[4];
      for (auto& t : tf) t = readPose();
      fcl::continuousCandidates(o1, tf[0], tf[1], o2, tf[2], tf[3], kPrint, readNumber());
    } else if (command == "halfway") {
      printHalfway();
    } else if (command == "time_step") {
      timeStep();
    } else if (command == "time_vf") {
      timeVertexFace();
    } else if (command == "vf" || command == "ee" || command == "ve" || command == "vv") {
      answerFeatures(command);
    } else {
      throw std::runtime_error("no such command: " + command);
    }
    std::printf("end\n");
  }

 private:
  const Geometry* readGeometry() {
    return geometries_.at(static_cast<std::size_t>(readInt())).get();
  }

  void answerPair(bool with_motions) {
    const Geometry *o1 = readGeometry(), *o2 = readGeometry();
    if (with_motions) {
      const auto motion1 = readMotion(), motion2 = readMotion();
      fcl::continuousCollide(o1, motion1.get(), o2, motion2.get(), readRequest(),
                             result_);
    } else {
      Transform3d tf[4];
      for (auto& t : tf) t = readPose();
      fcl::continuousCollide(o1, tf[0], tf[1], o2, tf[2], tf[3], readRequest(), result_);
    }
    print(result_);
  }

  std::vector<std::unique_ptr<Geometry>> geometries_;
  Result result_;
};

}  // namespace

int main() {
  try {
    Commands commands;
    std::string command;
    while (std::cin >> command) commands.run(command);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
