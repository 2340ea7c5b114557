// SPDX-License-Identifier: BSD-3-Clause
//
//   fcl_ccd_digests [ROUNDS]
// Prints a line for each kind of query: its name, the number of contacts, and a hash of
// all bits of the answers. On every machine, and for every instruction set, the lines are
// the same. So the inputs are made with operations that IEEE 754 defines: no sine, no
// function of the mathematics library but the square root.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/octree/octree.h"
#include "fcl/math/bv/AABB.h"
#include "fcl/math/motion/interp_motion.h"
#include "fcl/math/motion/spline_motion.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "fcl/narrowphase/continuous_features.h"
#include "fcl/narrowphase/safe_displacements.h"
#include "mesh_generators.h"
#include "model/model_instances.h"
#include "moving_objects.h"
#include "query_generators.h"

namespace fcl {
namespace test {
namespace {

using Point = Vector3<double>;
using Pose = Transform3<double>;
using Model = DeformableBVHModel<KDOP<double, 16>>;
/// Its tree is made by comparisons. libfcl makes those of OBBs and RSSs, with roundings
/// of its own: they are an input like the vertices, and may differ from machine to
/// machine.
using Rigid = BVHModel<AABB<double>>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Geometry = CollisionGeometry<double>;

/// @brief FNV-1a over the bits of numbers.
class Digest {
 public:
  explicit Digest(const char* kind) : kind_(kind) {}
  Digest(const Digest&) = delete;
  Digest& operator=(const Digest&) = delete;
  ~Digest() {
    std::printf("%-32s %8zu %016llx\n", kind_, contacts_,
                static_cast<unsigned long long>(hash_));
  }

  void add(double x) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof(bits));
    for (int i = 0; i < 64; i += 8) hash_ = (hash_ ^ (bits >> i & 255)) * 0x100000001b3U;
  }
  void add(const Point& p) {
    for (int k = 0; k < 3; ++k) add(p[k]);
  }
  void addContact(const ContinuousContact<double>& c) {
    ++contacts_;
    add(static_cast<double>(c.kind));
    for (const std::intptr_t b : {c.b1, c.b2}) add(static_cast<double>(b));
    for (const int v : c.vertices) add(v);
    for (const double x : {c.toc_lo, c.toc_hi}) add(x);
    add(c.pos);
    add(c.normal);
  }
  void add(const Result& result) {
    add(result.is_collide ? result.time_of_contact : 2);
    add(result.initially_crossing ? 1 : 0);
    for (const auto& c : result.contacts) addContact(c);
  }
  void add(const ContinuousFeatureTestResult<double>& r) {
    contacts_ += r.is_contact ? 1 : 0;
    add(r.toc_lo);
    add(r.toc_hi);
  }

 private:
  const char* kind_;
  std::size_t contacts_{0};
  std::uint64_t hash_{0xcbf29ce484222325U};
};

/// @brief A rotation of a random unit quaternion, by products and sums that are written
/// out: those of Eigen's vectors depend on the machine.
Matrix3<double> rotation(Random& random) {
  double q[4], square;
  do {
    square = 0;
    for (double& x : q) {
      x = random.uniform(-1, 1);
      square += x * x;
    }
  } while (square < .1 || square > 1);
  const double s = 2 / square, w = q[0], x = q[1], y = q[2], z = q[3];
  Matrix3<double> m;
  m << 1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y),
      s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x),
      s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y);
  return m;
}

BoundedThrow flight(Random& random, double distance) {
  const Point from = random.point(distance), velocity = random.point(2);
  return {from, velocity, random.point(1)};
}

Pose pose(Random& random, double distance) {
  Pose tf = Pose::Identity();
  tf.linear() = rotation(random);
  tf.translation() = random.point(distance);
  return tf;
}

template <typename Made>
std::shared_ptr<Made> make(const TestMesh& mesh) {
  auto model = std::make_shared<Made>();
  model->beginModel(static_cast<int>(mesh.triangles.size()),
                    static_cast<int>(mesh.vertices.size()));
  model->addSubModel(mesh.vertices, mesh.triangles);
  model->endModel();
  return model;
}

TestMesh shakenMesh(TestMesh mesh, Random& random, double by, const Point& move) {
  for (Point& p : mesh.vertices) {
    const Point shake = random.point(by);
    for (int k = 0; k < 3; ++k) p[k] = p[k] + shake[k] + move[k];
  }
  return mesh;
}

std::shared_ptr<Model> deforming(const TestMesh& from, const TestMesh& to) {
  auto model = make<Model>(from);
  model->beginUpdateModel();
  model->updateSubModel(to.vertices);
  model->endUpdateModel();
  return model;
}

void elementary(int rounds) {
  Random random(1);
  Digest touch("elementary"), near("elementary, at a distance");
  for (int i = 0; i < 200 * rounds; ++i) {
    for (const QueryFamily& family : queryFamilies()) {
      const MovingPair pair = family.generate(random);
      Point begin[4], end[4];
      for (int k = 0; k < 4; ++k)
        for (int c = 0; c < 3; ++c) {
          begin[k][c] = pair.x[static_cast<std::size_t>(k)].t0[c];
          end[k][c] = pair.x[static_cast<std::size_t>(k)].t1[c];
        }
      const auto all = [&](auto test, auto... distance) {
        return test(begin[0], begin[1], begin[2], begin[3], end[0], end[1], end[2],
                    end[3], 1e-6, distance...);
      };
      const bool is_vf = i % 2 == 0;
      touch.add(is_vf ? all(vertexFace<double>) : all(edgeEdge<double>));
      near.add(is_vf ? all(vertexFaceWithin<double>, .01)
                     : all(edgeEdgeWithin<double>, .01));
    }
  }
}

void meshes(int rounds) {
  Random random(2);
  Digest self("self-collision"), distance("self-collision, at a distance"),
      pairs("two meshes"), safe("safe displacements");
  const TestMesh sheet = makeSheet(20, 20), ball = makeIcosphere(3, .4);
  for (int i = 0; i < rounds; ++i) {
    const TestMesh cloth0 = shakenMesh(sheet, random, .01, Point::Zero());
    const TestMesh cloth1 = shakenMesh(sheet, random, .08, Point::Zero());
    const TestMesh ball0 = shakenMesh(ball, random, .01, Point(.5, .5, 1));
    const TestMesh ball1 = shakenMesh(ball, random, .02, Point(.5, .5, -1));
    const auto cloth = deforming(cloth0, cloth1), body = deforming(ball0, ball1);
    Request request;
    Result result;
    continuousSelfCollide(cloth.get(), request, result);
    self.add(result);
    result = Result();
    const Pose still = Pose::Identity();
    continuousCollide(cloth.get(), still, still, body.get(), still, still, request,
                      result);
    pairs.add(result);
    request.min_distance = .005;
    result = Result();
    continuousSelfCollide(cloth.get(), request, result);
    distance.add(result);
    for (const double bound : safeSelfDisplacements(cloth.get(), .05)) safe.add(bound);
  }
}

/// @brief A sheet with cables and points, all of which move.
void cables(int rounds) {
  Random random(3);
  Digest digest("cables and points");
  const TestMesh sheet = makeSheet(8, 8);
  for (int i = 0; i < rounds; ++i) {
    Model model;
    model.beginModel();
    model.addSubModel(shakenMesh(sheet, random, .02, Point::Zero()).vertices,
                      sheet.triangles);
    std::vector<Point> frame = shakenMesh(sheet, random, .1, Point::Zero()).vertices;
    for (int k = 0; k < 20; ++k) {
      const Point begin = random.point(1);
      model.addEdge(begin, random.point(1));
      model.addPoint(random.point(1));
      for (int n = 0; n < 3; ++n) frame.push_back(random.point(1));
    }
    model.endModel();
    model.beginUpdateModel();
    model.updateSubModel(frame);
    model.endUpdateModel();
    Request request;
    request.min_distance = .01;
    Result result;
    continuousSelfCollide(&model, request, result);
    digest.add(result);
  }
}

std::vector<std::shared_ptr<Geometry>> shapes() {
  auto box = makeBox({.3, .2, .1}, 1);
  auto faces = std::make_shared<std::vector<int>>();
  for (const Triangle& t : box.triangles)
    for (const std::size_t v : {t[0], t[1], t[2]}) {
      if (v == t[0]) faces->push_back(3);
      faces->push_back(static_cast<int>(v));
    }
  return {std::make_shared<Sphere<double>>(.3),
          std::make_shared<Box<double>>(.5, .3, .4),
          std::make_shared<Capsule<double>>(.2, .5),
          std::make_shared<Cylinder<double>>(.25, .5),
          std::make_shared<Cone<double>>(.3, .6),
          std::make_shared<Ellipsoid<double>>(.3, .2, .4),
          std::make_shared<Convex<double>>(
              std::make_shared<const std::vector<Point>>(box.vertices),
              static_cast<int>(box.triangles.size()), faces),
          std::make_shared<TriangleP<double>>(Point(0, 0, 0), Point(.5, 0, 0),
                                              Point(0, .5, .1)),
          std::make_shared<Halfspace<double>>(Point(.36, .48, .8), -.2),
          std::make_shared<Plane<double>>(Point(.6, 0, .8), .1)};
}

std::shared_ptr<Geometry> octree(Random& random) {
  auto tree = std::make_shared<octomap::OcTree>(.1);
  for (int i = 0; i < 60; ++i) {
    const Point p = random.point(.5);
    tree->updateNode(octomap::point3d(static_cast<float>(p[0]), static_cast<float>(p[1]),
                                      static_cast<float>(p[2])),
                     true);
  }
  return std::make_shared<OcTree<double>>(
      std::shared_ptr<const octomap::OcTree>(std::move(tree)));
}

/// @brief Every two of the objects that turn between two transforms.
void turning(int rounds) {
  Random random(4);
  Digest straight("shapes, straight"), linear("shapes, turning"), screw("shapes, screw"),
      mesh("meshes that turn"), deforms("meshes that turn and deform"),
      mesh_shape("a mesh and a shape that turn"), cells("octrees that turn"),
      first("first contacts of turning meshes");
  const auto all = shapes();
  const auto ball = make<Rigid>(makeIcosphere(2, .3)),
             box = make<Rigid>(makeBox({.3, .2, .25}, 3));
  const auto map = octree(random);
  const auto ask = [&](Digest& digest, const Geometry& a, const Geometry& b,
                       CCDMotionType type, ContinuousQuery query) {
    Request request;
    request.ccd_motion_type = type;
    request.query = query;
    Result result;
    const Pose a0 = pose(random, 1), b0 = pose(random, 1);
    Pose a1 = pose(random, 1), b1 = pose(random, 1);
    if (type == CCDM_TRANS) {
      a1.linear() = a0.linear();
      b1.linear() = b0.linear();
    }
    continuousCollide(&a, a0, a1, &b, b0, b1, request, result);
    digest.add(result);
  };
  for (int i = 0; i < rounds; ++i) {
    for (std::size_t a = 0; a < all.size(); ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        ask(straight, *all[a], *all[b], CCDM_TRANS, ContinuousQuery::kAll);
        ask(linear, *all[a], *all[b], CCDM_LINEAR, ContinuousQuery::kAll);
        ask(screw, *all[a], *all[b], CCDM_SCREW, ContinuousQuery::kAll);
      }
      ask(mesh_shape, *ball, *all[a], CCDM_LINEAR, ContinuousQuery::kAll);
      ask(mesh_shape, *all[a], *box, CCDM_SCREW, ContinuousQuery::kFirst);
      ask(cells, *map, *all[a], CCDM_LINEAR, ContinuousQuery::kAll);
    }
    ask(mesh, *ball, *box, CCDM_LINEAR, ContinuousQuery::kAll);
    ask(mesh, *box, *ball, CCDM_SCREW, ContinuousQuery::kAll);
    const TestMesh from = makeIcosphere(2, .3);
    const auto soft = deforming(from, shakenMesh(from, random, .02, Point(.05, .02, 0)));
    ask(deforms, *soft, *box, CCDM_LINEAR, ContinuousQuery::kAll);
    ask(deforms, *soft, *soft, CCDM_SCREW, ContinuousQuery::kAll);
    for (int k = 0; k < 10; ++k)
      ask(first, *ball, *box, CCDM_LINEAR, ContinuousQuery::kFirst);
    ask(cells, *map, *ball, CCDM_SCREW, ContinuousQuery::kFirst);
  }
}

/// @brief Objects whose paths are read without a function of libfcl: splines and motions
/// of a program. The axis of a ScrewMotion or an InterpMotion is libfcl's number.
void motionObjects(int rounds) {
  Random random(5);
  Digest spline("splines"), thrown("motions of a program"), scene("many objects");
  const auto all = shapes();
  const auto ball = make<Rigid>(makeIcosphere(2, .3));
  const auto ask = [&](Digest& digest, const Geometry& o1, const MotionBase<double>& m1,
                       const Geometry& o2, const MotionBase<double>& m2) {
    Result result;
    continuousCollide(&o1, &m1, &o2, &m2, Request(), result);
    digest.add(result);
  };
  for (int i = 0; i < rounds; ++i) {
    for (const auto& shape : all) {
      Point t[8];
      for (Point& p : t) p = random.point(1);
      const SplineMotion<double> path(t[0], t[1], t[2], t[3], t[4], t[5], t[6], t[7]);
      const TranslationMotion<double> still(Matrix3<double>::Identity(), Point::Zero(),
                                            Point::Zero());
      const BoundedThrow path_of_throw = flight(random, 1);
      ask(thrown, *ball, path_of_throw, *shape, still);
      ask(thrown, *shape, path_of_throw, *ball, still);
      if (shape->getNodeType() == GEOM_PLANE || shape->getNodeType() == GEOM_HALFSPACE)
        continue;
      ask(spline, *ball, path, *shape, still);
      ask(spline, *shape, path, *ball, still);
    }
    ContinuousCollisionManager<double> manager;
    std::vector<std::unique_ptr<ContinuousCollisionObject<double>>> objects;
    for (int k = 0; k < 40; ++k) {
      std::shared_ptr<Geometry> geometry = ball;
      if (k % 3 != 0) geometry = all[random.index(all.size() - 2)];
      objects.push_back(
          makeObject(geometry, std::make_shared<BoundedThrow>(flight(random, 2))));
      manager.registerObject(objects.back().get());
    }
    manager.setup();
    ContinuousManagerResult<double> found;
    manager.collide(Request(), found);
    for (const auto& pair : found.pairs) scene.add(pair.result);
  }
}

}  // namespace
}  // namespace test
}  // namespace fcl

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 4;
  fcl::test::elementary(rounds);
  fcl::test::meshes(rounds);
  fcl::test::cables(rounds);
  fcl::test::turning(rounds);
  fcl::test::motionObjects(rounds);
}
