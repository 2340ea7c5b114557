// SPDX-License-Identifier: BSD-3-Clause
//
// Queries that ask for contacts, of pairs and of one mesh with itself: what they list,
// what they refuse, and that threads can run them at the same time.
#include "fcl/narrowphase/continuous_contact.h"

#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/utility.h"
#include "fcl/math/motion/translation_motion.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Model = DeformableBVHModel<KDOP<double, 16>>;
using Plain = BVHModel<OBBRSS<double>>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using BaseRequest = ContinuousCollisionRequest<double>;
using BaseResult = ContinuousCollisionResult<double>;
using Kind = ContinuousContactKind;
using Pose = Transform3<double>;

const TestMesh kSheet = bentSheet(8), kA0 = shaken(kSheet, 0.02, 1),
               kA1 = shaken(kSheet, 0.15, 2),
               kB0 = shaken(moved(kSheet, 0.03, 0.02, 0.1), 0.02, 3),
               kB1 = shaken(moved(kSheet, -0.05, 0.06, -0.1), 0.15, 4);

Request preciseRequest() {
  Request request;
  request.toc_err = 1e-11;
  return request;
}

struct Step {
  const TestMesh* t0;
  const TestMesh* t1;
  Vector3<double> at(int v, double t) const {
    const auto i = static_cast<std::size_t>(v);
    return (1 - t) * t0->vertices[i] + t * t1->vertices[i];
  }
  Vector3<double> velocity(int v) const {
    const auto i = static_cast<std::size_t>(v);
    return t1->vertices[i] - t0->vertices[i];
  }
};

/// Weights of point p in the triangle or, without c, on the segment.
std::vector<double> weightsOf(const Vector3<double>& p, const Vector3<double>& a,
                              const Vector3<double>& b, const Vector3<double>* c) {
  const Vector3<double> e = b - a;
  if (!c) {
    const double s = (p - a).dot(e) / e.squaredNorm();
    return {1 - s, s};
  }
  const Vector3<double> f = *c - a, n = e.cross(f);
  const double v = (p - a).cross(f).dot(n) / n.squaredNorm(),
               w = e.cross(p - a).dot(n) / n.squaredNorm();
  return {1 - v - w, v, w};
}

/// A feature by ids: the distance of p from it, and the velocity of its point at p.
struct FeatureAt {
  double distance;
  double outside;  // distance of the weights from [0, 1]
  Vector3<double> velocity;
};

FeatureAt featureAt(const Step& mesh, const std::vector<int>& ids, double t,
                    const Vector3<double>& p) {
  if (ids.size() == 1) return {(mesh.at(ids[0], t) - p).norm(), 0, mesh.velocity(ids[0])};
  std::vector<Vector3<double>> x;
  for (const int id : ids) x.push_back(mesh.at(id, t));
  const auto weights = weightsOf(p, x[0], x[1], ids.size() == 3 ? &x[2] : nullptr);
  FeatureAt out{0, 0, Vector3<double>::Zero()};
  Vector3<double> q = Vector3<double>::Zero();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    q += weights[i] * x[i];
    out.velocity += weights[i] * mesh.velocity(ids[i]);
    out.outside = std::max({out.outside, -weights[i], weights[i] - 1});
  }
  out.distance = (q - p).norm();
  return out;
}

bool holds(const TestMesh& mesh, std::intptr_t triangle, const std::vector<int>& ids) {
  if (triangle < 0 || triangle >= static_cast<std::intptr_t>(mesh.triangles.size()))
    return false;
  const Triangle& t = mesh.triangles[static_cast<std::size_t>(triangle)];
  return std::all_of(ids.begin(), ids.end(), [&t](int id) {
    const auto v = static_cast<std::size_t>(id);
    return t[0] == v || t[1] == v || t[2] == v;
  });
}

/// Checks the promises of ContinuousContact's documentation.
void expectSound(const ContinuousContact<double>& c, const Step& mesh1,
                 const Step& mesh2) {
  const bool vf = c.kind == Kind::kVertexFace;
  ASSERT_TRUE(vf || c.kind == Kind::kEdgeEdge);
  const std::size_t split = vf ? 1 : 2;
  std::vector<int> first(c.vertices.begin(), c.vertices.begin() + split),
      second(c.vertices.begin() + split, c.vertices.begin() + 4);
  EXPECT_EQ(c.vertices[4], -1);
  EXPECT_EQ(c.numVertices(), 4);
  EXPECT_TRUE(vf || c.first_on_o1);
  if (!c.first_on_o1) std::swap(first, second);
  EXPECT_TRUE(holds(*mesh1.t0, c.b1, first));
  EXPECT_TRUE(holds(*mesh2.t0, c.b2, second));
  EXPECT_GE(c.toc_lo, 0);
  EXPECT_LE(c.toc_lo, c.toc_hi);
  EXPECT_LE(c.toc_hi, 1);
  EXPECT_LE(c.toc_hi - c.toc_lo, 1e-11);
  const FeatureAt on1 = featureAt(mesh1, first, c.toc_lo, c.pos),
                  on2 = featureAt(mesh2, second, c.toc_lo, c.pos);
  EXPECT_LE(on1.distance, 1e-8);
  EXPECT_LE(on2.distance, 1e-8);
  EXPECT_LE(on1.outside, 1e-6);
  EXPECT_LE(on2.outside, 1e-6);
  EXPECT_NEAR(c.normal.norm(), 1, 1e-9);
  const auto expectAcross = [&c](const Step& mesh, const std::vector<int>& ids) {
    for (std::size_t i = 1; i < ids.size(); ++i) {
      const Vector3<double> edge =
          (mesh.at(ids[i], c.toc_lo) - mesh.at(ids[0], c.toc_lo)).normalized();
      EXPECT_NEAR(edge.dot(c.normal), 0, 1e-6);
    }
  };
  expectAcross(mesh1, first);
  expectAcross(mesh2, second);
  EXPECT_LE((on2.velocity - on1.velocity).dot(c.normal), 1e-6);
}

void expectSorted(const std::vector<ContinuousContact<double>>& contacts) {
  for (std::size_t i = 1; i < contacts.size(); ++i) {
    const auto &x = contacts[i - 1], &y = contacts[i];
    EXPECT_TRUE(x.toc_lo < y.toc_lo || (x.toc_lo == y.toc_lo && nameOf(x) != nameOf(y)));
  }
}

TEST(ContinuousContacts, ArePairsAsDocumented) {
  const auto a = makeModel<Model>(kA0, kA1);
  const auto b = makeModel<Plain>(kB0, kB1);
  const Result result = pairContacts<double>(*a, *b, preciseRequest());
  ASSERT_GT(result.contacts.size(), 100u);
  std::size_t kinds[3] = {0, 0, 0};
  for (const auto& c : result.contacts) {
    expectSound(c, {&kA0, &kA1}, {&kB0, &kB1});
    EXPECT_EQ(c.o1, a.get());
    EXPECT_EQ(c.o2, b.get());
    ++kinds[c.kind == Kind::kEdgeEdge ? 2 : c.first_on_o1];
  }
  for (const std::size_t count : kinds) EXPECT_GT(count, 5u);
  expectSorted(result.contacts);
  EXPECT_EQ(result.counts.contacts, result.contacts.size());
  EXPECT_EQ(result.time_of_contact,
            result.initially_crossing ? 0 : result.contacts.front().toc_lo);
  // With the objects exchanged: the same features, with opposite normals.
  const Result back = pairContacts<double>(*b, *a, preciseRequest());
  EXPECT_EQ(back.contacts.size(), result.contacts.size());
  for (const auto& c : back.contacts) expectSound(c, {&kB0, &kB1}, {&kA0, &kA1});
}

TEST(ContinuousContacts, AreSelfContactsAsDocumented) {
  const TestMesh crumpled = shaken(kSheet, 0.3, 9);
  const auto model = makeModel<Model>(kA0, crumpled);
  const Result result = selfContacts<double>(*model, preciseRequest());
  ASSERT_GT(result.contacts.size(), 50u);
  for (const auto& c : result.contacts) {
    expectSound(c, {&kA0, &crumpled}, {&kA0, &crumpled});
    EXPECT_TRUE(c.first_on_o1);
    EXPECT_EQ(c.o1, model.get());
    EXPECT_EQ(c.o2, model.get());
  }
  expectSorted(result.contacts);
  expectSameContacts(selfContacts<double>(*makeModel<Plain>(kA0, crumpled)), result);
  expectIdentical(selfContacts<double>(*model, preciseRequest()), result);
}

TEST(ContinuousContacts, SelfQueriesOfStillModels) {
  EXPECT_FALSE(selfContacts<double>(*makeModel<Model>(kSheet)).is_collide);
  EXPECT_FALSE(selfContacts<double>(*makeModel<Plain>(kSheet)).is_collide);
  EXPECT_EQ(selfContacts<double>(*makeModel<Plain>(kSheet)).time_of_contact, 1);
  const TestMesh tangle = shaken(kSheet, 0.3, 9);
  const Result own = selfContacts<double>(*makeModel<Model>(tangle)),
               plain = selfContacts<double>(*makeModel<Plain>(tangle));
  EXPECT_TRUE(own.is_collide && own.initially_crossing);
  EXPECT_TRUE(plain.is_collide && plain.initially_crossing);
  EXPECT_EQ(own.time_of_contact, 0);
}

TEST(ContinuousContacts, TheEarliestAreKept) {
  const auto a = makeModel<Model>(kA0, kA1), b = makeModel<Model>(kB0, kB1);
  const Result all = pairContacts<double>(*a, *b);
  for (const std::size_t count :
       {std::size_t{1}, std::size_t{5}, all.contacts.size() - 1, all.contacts.size()}) {
    Request request;
    request.num_max_contacts = count;
    const Result some = pairContacts<double>(*a, *b, request);
    EXPECT_EQ(some.contacts_cut, count < all.contacts.size());
    ASSERT_EQ(some.contacts.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(nameOf(some.contacts[i]), nameOf(all.contacts[i]));
      EXPECT_EQ(some.contacts[i].toc_lo, all.contacts[i].toc_lo);
    }
    EXPECT_EQ(some.time_of_contact, all.time_of_contact);
  }
}

TEST(ContinuousContacts, FirstAndAny) {
  // Bent sheets that pass through each other, apart at the start.
  const TestMesh far = moved(kSheet, 0.03, 0.02, 0.5), near = shaken(far, 0.02, 5);
  const auto a = makeModel<Model>(kSheet, shaken(kSheet, 0.1, 6)),
             b = makeModel<Model>(near, moved(near, 0, 0, -1));
  const Result all = pairContacts<double>(*a, *b);
  ASSERT_FALSE(all.initially_crossing);
  ASSERT_GT(all.contacts.size(), 100u);
  Request request;
  request.query = ContinuousQuery::kFirst;
  const Result first = pairContacts<double>(*a, *b, request);
  ASSERT_FALSE(first.contacts.empty());
  EXPECT_LT(first.contacts.size(), all.contacts.size());
  EXPECT_LE(first.contacts[0].toc_lo, all.contacts[0].toc_hi);
  EXPECT_LE(all.contacts[0].toc_lo, first.contacts[0].toc_hi);
  EXPECT_EQ(first.time_of_contact, first.contacts[0].toc_lo);
  ContinuousCollisionResult<double> plain_result;
  const Pose here = Pose::Identity();
  const double toc =
      continuousCollide(a.get(), here, here, b.get(), here, here,
                        ContinuousCollisionRequest<double>(), plain_result);
  EXPECT_LE(toc, all.contacts[0].toc_hi);
  EXPECT_GE(toc, all.contacts[0].toc_lo - 1e-4);
  request.query = ContinuousQuery::kAny;
  const Result any = pairContacts<double>(*a, *b, request);
  EXPECT_TRUE(any.is_collide);
  EXPECT_EQ(any.contacts.size(), 1u);
  const Result none = pairContacts<double>(
      *a, *makeModel<Model>(moved(near, 0, 0, 3), moved(near, 0, 0, 2)), request);
  EXPECT_FALSE(none.is_collide);
  EXPECT_TRUE(none.contacts.empty());
  EXPECT_EQ(none.time_of_contact, 1);
}

TEST(ContinuousContacts, GeometryOnlyOnDemand) {
  const auto a = makeModel<Model>(kA0, kA1), b = makeModel<Model>(kB0, kB1);
  Request request;
  request.enable_contact = false;
  const Result bare = pairContacts<double>(*a, *b, request);
  for (const auto& c : bare.contacts) {
    EXPECT_TRUE(c.pos.isZero(0));
    EXPECT_TRUE(c.normal.isZero(0));
  }
  expectIdentical(bare, pairContacts<double>(*a, *b), false);
}

TEST(ContinuousContacts, CrossingAtTheStart) {
  TestMesh face, needle;
  face.vertices = {{-4, -4, 0}, {4, -4, 0}, {0, 4, 0}};
  needle.vertices = {{0, 0, -1}, {0.25, 0, 1}, {0.25, 0.125, 1}};
  face.triangles = needle.triangles = {Triangle(0, 1, 2)};
  const auto a = makeModel<Plain>(face);
  const auto b = makeModel<Model>(needle, moved(needle, 0.1, 0, 0));
  for (const bool swapped : {false, true}) {
    const Result result =
        swapped ? pairContacts<double>(*b, *a) : pairContacts<double>(*a, *b);
    EXPECT_TRUE(result.is_collide);
    EXPECT_TRUE(result.initially_crossing);
    EXPECT_TRUE(result.contacts.empty());
    EXPECT_EQ(result.time_of_contact, 0);
    const auto& c = result.crossing;
    EXPECT_EQ(c.kind, Kind::kCrossing);
    EXPECT_EQ(c.numVertices(), 5);
    EXPECT_EQ(c.first_on_o1, swapped);
    EXPECT_EQ(c.b1, 0);
    EXPECT_EQ(c.b2, 0);
    EXPECT_EQ(c.o1, swapped ? static_cast<const void*>(b.get()) : a.get());
    EXPECT_EQ(c.toc_hi, 0);
    EXPECT_NEAR(std::abs(c.normal.z()), 1, 1e-12);
    const auto vertex = [&](std::size_t i) {
      return needle.vertices[static_cast<std::size_t>(c.vertices[i])];
    };
    EXPECT_LT(vertex(0).z() * vertex(1).z(), 0);
    EXPECT_NEAR((c.pos - 0.5 * (vertex(0) + vertex(1))).norm(), 0, 1e-12);
  }
}

std::shared_ptr<Model> deformableOf(const TestMesh& mesh) {
  const auto model = std::make_shared<Model>();
  model->beginModel();
  model->addSubModel(mesh.vertices, mesh.triangles);
  EXPECT_EQ(model->endModel(), BVH_OK);
  return model;
}

// Two objects that share a geometry have the same answer as two with a geometry each.
TEST(ContinuousContacts, OneModelInTwoPoses) {
  TestMesh one;
  one.vertices = {{-1, -1, -0.1}, {1, -1, 0.1}, {0, 1, 0}};
  one.triangles = {Triangle(0, 1, 2)};
  std::size_t contacts = 0;
  for (const TestMesh& mesh :
       {one, makeTetrahedronSoup(2, 0.5, 0.6, 7), makeTriangleSoup(300, 1, 0.2, 8)}) {
    const auto model = deformableOf(mesh), copy = deformableOf(mesh);
    Pose from = Pose::Identity(), to = Pose::Identity();
    from.translation() = Vector3<double>(0.05, 0.02, 3);
    to.translation() = Vector3<double>(0.01, -0.03, -3);
    const auto ask = [&](const Model& other, ContinuousQuery query, int num_threads) {
      Request request;
      request.query = query;
      request.num_threads = num_threads;
      Result result;
      continuousCollide(model.get(), Pose::Identity(), Pose::Identity(), &other, from, to,
                        request, result);
      return result;
    };
    const auto candidates = [&](const Model& other) {
      std::size_t count = 0;
      continuousCandidates(model.get(), Pose::Identity(), Pose::Identity(), &other, from,
                           to, [&](const ContinuousCandidate*, std::size_t n) {
                             count += n;
                             return true;
                           });
      return count;
    };
    for (const int num_threads : {1, 2})
      for (const ContinuousQuery query :
           {ContinuousQuery::kAll, ContinuousQuery::kFirst, ContinuousQuery::kAny}) {
        const Result shared = ask(*model, query, num_threads),
                     own = ask(*copy, query, num_threads);
        EXPECT_TRUE(own.is_collide);
        EXPECT_EQ(shared.is_collide, own.is_collide);
        EXPECT_EQ(shared.time_of_contact, own.time_of_contact);
        ASSERT_EQ(shared.contacts.size(), own.contacts.size());
        for (std::size_t i = 0; i < own.contacts.size(); ++i) {
          EXPECT_EQ(shared.contacts[i].vertices, own.contacts[i].vertices);
          EXPECT_EQ(shared.contacts[i].toc_lo, own.contacts[i].toc_lo);
        }
        contacts += own.contacts.size();
      }
    EXPECT_EQ(candidates(*model), candidates(*copy));
  }
  EXPECT_GT(contacts, 1000U);
}

// A rotation that went through a quaternion is the same rotation.
TEST(ContinuousContacts, RotationsThatDifferByRounding) {
  Random random(31);
  TestMesh one;
  one.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  one.triangles = {Triangle(0, 1, 2)};
  const auto floor = makeModel<Plain>(one), bullet = makeModel<Plain>(one);
  int differing = 0;
  for (int i = 0; i < 50; ++i) {
    Pose from = Pose::Identity(), to = Pose::Identity();
    from.linear() = AngleAxis<double>(random.uniform(0, 3), random.point(1).normalized())
                        .toRotationMatrix();
    to.linear() = Quaternion<double>(from.linear()).toRotationMatrix();
    differing += from.linear() != to.linear();
    // So fast that ten samples do not find it.
    from.translation() = Vector3<double>(0, 0, 50);
    to.translation() = Vector3<double>(0, 0, -71);
    BaseResult base;
    continuousCollide(floor.get(), Pose::Identity(), Pose::Identity(), bullet.get(), from,
                      to, BaseRequest(), base);
    EXPECT_TRUE(base.is_collide);
    Result result;
    continuousCollide(floor.get(), Pose::Identity(), Pose::Identity(), bullet.get(), from,
                      to, Request(), result);
    EXPECT_EQ(result.time_of_contact, base.time_of_contact);
    EXPECT_FALSE(result.contacts.empty());
    std::size_t count = 0;
    continuousCandidates(floor.get(), Pose::Identity(), Pose::Identity(), bullet.get(),
                         from, to, [&](const ContinuousCandidate*, std::size_t n) {
                           count += n;
                           return true;
                         });
    EXPECT_GE(count, result.contacts.size());
  }
  EXPECT_GT(differing, 20);
}

// The place where an edge passes through a face, in meshes of all sizes, also if the edge
// hardly leaves the face.
TEST(ContinuousContacts, CrossingsLieOnTheirEdge) {
  Random random(32);
  int crossings = 0;
  for (int i = 0; i < 600; ++i) {
    const double size = std::pow(10., random.uniform(-110, 110)),
                 flat = std::pow(10., random.uniform(-17, 0));
    const auto turn =
        AngleAxis<double>(random.uniform(0, 3), random.point(1).normalized());
    TestMesh mesh;
    for (const Vector3<double>& p :
         {Vector3<double>(-1, -1, 0), Vector3<double>(1, -1, 0), Vector3<double>(0, 1, 0),
          Vector3<double>(-0.2, 0, -flat), Vector3<double>(0.2, 0.1, flat),
          Vector3<double>(0, 9, 9)})
      mesh.vertices.push_back(size * (turn * p));
    mesh.triangles = {Triangle(0, 1, 2), Triangle(3, 4, 5)};
    const auto model = deformableOf(mesh);
    Result result;
    continuousSelfCollide(model.get(), Request(), result);
    if (!result.initially_crossing) continue;
    ++crossings;
    const auto& c = result.crossing;
    const auto at = [&](std::size_t k) {
      return mesh.vertices[static_cast<std::size_t>(c.vertices[k])];
    };
    const Vector3<double> edge = (at(1) - at(0)) / size, place = (c.pos - at(0)) / size;
    EXPECT_NEAR(c.normal.norm(), 1, 1e-12);
    const double s = place.dot(edge) / edge.squaredNorm();
    EXPECT_GE(s, -1e-9);
    EXPECT_LE(s, 1 + 1e-9);
    EXPECT_LT((place - s * edge).norm(), 1e-9);
  }
  EXPECT_GT(crossings, 300);
}

TEST(ContinuousContacts, FloatIsDoubleOfTheFloats) {
  ContinuousContactRequest<float> request_f;
  Request request_d;
  request_f.toc_err = 0x1p-13f;
  request_d.toc_err = 0x1p-13;
  const auto af = makeModel<DeformableBVHModel<KDOP<float, 16>>>(kA0, kA1),
             bf = makeModel<DeformableBVHModel<KDOP<float, 16>>>(kB0, kB1);
  const auto ad = makeModel<Model>(kA0, kA1), bd = makeModel<Model>(kB0, kB1);
  const auto pair_f = pairContacts<float>(*af, *bf, request_f);
  const auto pair_d = pairContacts<double>(*ad, *bd, request_d);
  expectIdentical(pair_f, pair_d, false);
  EXPECT_LE(static_cast<double>(pair_f.time_of_contact), pair_d.time_of_contact);
  expectIdentical(selfContacts<float>(*af, request_f),
                  selfContacts<double>(*ad, request_d), false);
}

// FCL answers such pairs. In float its query between transforms does not compile.
TEST(ContinuousContacts, TransformsInFloatAreRefusedWhereFclAnswers) {
  struct OwnGeometry : CollisionGeometry<float> {
    void computeLocalAABB() override {}
  };
  const auto own = std::make_shared<OwnGeometry>();
  const auto mesh = makeModel<BVHModel<AABB<float>>>(kSheet),
             cloud = std::make_shared<BVHModel<AABB<float>>>();
  cloud->beginModel();
  cloud->addSubModel(pointsAs<float>(kSheet.vertices));
  cloud->endModel();
  const std::string way_out =
      ", not a triangle mesh, a shape or an octree, so FCL answers this pair. In float "
      "FCL has no query between transforms. Give TranslationMotion or SplineMotion "
      "objects in their place, or use double";
  const Transform3<float> here = Transform3<float>::Identity();
  const CollisionObject<float> object(mesh, here), own_object(own, here);
  for (const CCDMotionType type : {CCDM_TRANS, CCDM_LINEAR, CCDM_SCREW, CCDM_SPLINE}) {
    ContinuousCollisionRequest<float> request;
    request.ccd_motion_type = type;
    ContinuousCollisionResult<float> result;
    expectRefused(
        [&] {
          continuousCollide(cloud.get(), here, here, mesh.get(), here, here, request,
                            result);
        },
        "o1 is a point cloud" + way_out);
    expectRefused(
        [&] { continuousCollide(&object, here, &own_object, here, request, result); },
        "o2 is a geometry that is none of FCL's" + way_out);
  }
}

TEST(ContinuousContacts, UnusableInputIsRefusedByName) {
  const auto mesh = makeModel<Model>(kA0, kA1);
  const auto sphere = std::make_shared<Sphere<double>>(1);
  const Pose here = Pose::Identity();
  const TranslationMotion<double> motion(here, here);
  Result result;
  const auto* o = mesh.get();
  const CollisionGeometry<double>* none = nullptr;
  const Request request;
  const auto refused = [&](const char* word, const CollisionGeometry<double>* o1,
                           const MotionBase<double>* motion1,
                           const CollisionGeometry<double>* o2,
                           const MotionBase<double>* motion2, const Request& asked) {
    expectRefused([&] { continuousCollide(o1, motion1, o2, motion2, asked, result); },
                  word);
  };
  refused("o1", none, &motion, o, &motion, request);
  refused("o2", o, &motion, none, &motion, request);
  refused("motion1", o, nullptr, o, &motion, request);
  refused("motion2", o, &motion, o, nullptr, request);
  struct OwnGeometry : CollisionGeometry<double> {
    void computeLocalAABB() override {}
  };
  const OwnGeometry own;
  refused(
      "o2 is a geometry that is none of FCL's, not a triangle mesh, a shape or an octree",
      o, &motion, &own, &motion, request);
  struct GeometryOfNoType : OwnGeometry {
    NODE_TYPE getNodeType() const override { return NODE_COUNT; }
  };
  const GeometryOfNoType of_no_type;
  refused("o2 is a geometry of node type 20, which FCL has not", o, &motion, &of_no_type,
          &motion, request);
  Plain cloud;
  cloud.beginModel();
  cloud.addSubModel(kSheet.vertices);
  cloud.endModel();
  refused("o1 is a point cloud, not", &cloud, &motion, o, &motion, request);
  expectRefused([&] { continuousSelfCollide(&cloud, request, result); },
                "o is not a triangle mesh but a point cloud");
  expectRefused([&] { continuousSelfCollide(none, request, result); }, "o is null");
  expectRefused([&] { continuousSelfCollide(sphere.get(), request, result); },
                "o is not a triangle mesh but a sphere");
  const CollisionObject<double>* no_object = nullptr;
  expectRefused(
      [&] { continuousCollide(no_object, here, no_object, here, request, result); },
      "o1");
  const auto wrong = makeModel<BVHModel<AABB<double>>>(bentSheet(2));
  wrong->tri_indices[3][1] = 1000;
  expectRefused([&] { continuousSelfCollide(wrong.get(), request, result); },
                "triangle 3 refers to a vertex that is not there");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double toc_err : {-1., nan}) {
    Request bad;
    bad.toc_err = toc_err;
    refused("toc_err", o, &motion, o, &motion, bad);
    expectRefused([&] { continuousSelfCollide(o, bad, result); }, "toc_err");
  }
  Request bad;
  bad.num_max_contacts = 0;
  refused("num_max_contacts", o, &motion, o, &motion, bad);
  for (const double value : {nan, std::numeric_limits<double>::infinity()}) {
    Pose broken = here;
    broken.translation()[1] = value;
    expectRefused(
        [&] { continuousCollide(o, here, here, o, broken, here, request, result); },
        "o2: the transform");
    expectRefused(
        [&] { continuousCollide(o, here, broken, o, here, here, request, result); },
        "o1: the transform");
    // Also if the rotation may change.
    const auto rigid = makeModel<Plain>(kSheet);
    Pose twisted = here;
    twisted.linear()(1, 2) = value;
    BaseResult base;
    const TranslationMotion<double> turned(twisted, here);
    const CollisionGeometry<double>* const meshes[] = {o, rigid.get()};
    for (const auto* mesh : meshes) {
      expectRefused(
          [&] {
            continuousCollide(mesh, here, here, o, here, twisted, BaseRequest(), base);
          },
          "o2: the transform");
      expectRefused(
          [&] { continuousCollide(mesh, &turned, o, &motion, BaseRequest(), base); },
          "o1: the transform");
      expectRefused(
          [&] {
            continuousCandidates(mesh, here, twisted, o, here, here,
                                 [](const auto*, std::size_t) { return true; });
          },
          "o1: the transform");
    }
  }
  const auto plain = makeModel<Plain>(kA0, kA1);
  plain->vertices[7][0] = nan;
  expectRefused([&] { pairContacts<double>(*plain, *mesh); },
                "o1, current frame: vertex 7");
  plain->vertices[7][0] = 0;
  plain->prev_vertices[5][2] = nan;
  expectRefused([&] { selfContacts<double>(*plain); }, "o, previous frame: vertex 5");
  expectRefused([&] { pairContacts<double>(*mesh, Plain()); }, "o2");
}

// Finite coordinates and a finite pose whose product is not finite.
TEST(ContinuousContacts, VerticesPosedOutOfRangeAreRefused) {
  constexpr double kLarge = 1.6e308;
  TestMesh large = kA0;
  for (Vector3<double>& p : large.vertices) p *= 1e-6 * kLarge;
  large.vertices[5] = Vector3<double>(kLarge, kLarge, 0);
  Pose turned = Pose::Identity();
  turned.linear() = AngleAxis<double>(0.5, Vector3<double>::UnitZ()).toRotationMatrix();
  const Pose here = Pose::Identity();
  const auto check = [&](const CollisionGeometry<double>& o1,
                         const CollisionGeometry<double>& o2) {
    for (const ContinuousQuery query :
         {ContinuousQuery::kAll, ContinuousQuery::kFirst, ContinuousQuery::kAny})
      for (const bool late : {false, true}) {
        Request request;
        request.query = query;
        Result result;
        expectRefused(
            [&] {
              continuousCollide(&o1, late ? here : turned, late ? turned : here, &o2,
                                here, here, request, result);
            },
            "o1: vertex 5, posed, is not finite");
      }
  };
  const TestMesh next = moved(large, 0, 0, 1e300);
  check(*makeModel<Model>(large, next), *makeModel<Model>(kA0, kA1));
  check(*makeModel<BVHModel<AABB<double>>>(large, next), *makeModel<Model>(kA0, kA1));
}

// A translation computes nothing anew, but the error is found before the query.
TEST(ContinuousContacts, VerticesMovedOutOfRangeAreRefused) {
  constexpr double kLarge = 1.6e308;
  const Pose here = Pose::Identity();
  TestMesh large;
  large.vertices = {{0, 0, 0}, {1, 0, 0}, {0, kLarge, 0}};
  large.triangles = {Triangle(0, 1, 2)};
  const auto o1 = makeModel<Model>(large, moved(large, 1, 0, 0)),
             o2 = makeModel<Model>(moved(large, 0, 0, -1), moved(large, 0, 0, 1));
  for (const ContinuousQuery query :
       {ContinuousQuery::kAll, ContinuousQuery::kFirst, ContinuousQuery::kAny})
    for (const bool late : {false, true})
      for (const double y : {kLarge, -kLarge, 1., -1.}) {
        Pose away = here;
        away.translation()[1] = y;
        Request request;
        request.query = query;
        Result result;
        const auto collide = [&] {
          continuousCollide(o1.get(), late ? here : away, late ? away : here, o2.get(),
                            here, here, request, result);
          continuousCandidates(o1.get(), late ? here : away, late ? away : here, o2.get(),
                               here, here,
                               [](const auto*, std::size_t) { return false; });
        };
        if (y == kLarge)
          expectRefused(collide, "o1: vertex 2, posed, is not finite");
        else
          EXPECT_NO_THROW(collide());
      }
}

template <typename Request, typename Result, typename = void>
struct Compiles : std::false_type {};
template <typename Request, typename Result>
struct Compiles<
    Request, Result,
    std::void_t<decltype(continuousCollide(
        std::declval<const CollisionGeometry<double>*>(), std::declval<const Pose&>(),
        std::declval<const Pose&>(), std::declval<const CollisionGeometry<double>*>(),
        std::declval<const Pose&>(), std::declval<const Pose&>(),
        std::declval<const Request&>(), std::declval<Result&>()))>> : std::true_type {};
static_assert(Compiles<BaseRequest, BaseResult>::value, "FCL's call");
static_assert(Compiles<Request, Result>::value, "the call for contacts");
static_assert(!Compiles<Request, BaseResult>::value, "would lose the contacts");
static_assert(!Compiles<BaseRequest, Result>::value, "would leave the contacts empty");

struct OwnRequest : Request {};
struct OwnResult : Result {};
static_assert(Compiles<OwnRequest, OwnResult>::value, "the caller's own types");
static_assert(Compiles<OwnRequest, Result>::value, "one of them");
static_assert(!Compiles<OwnRequest, BaseResult>::value, "would lose the contacts");
static_assert(!Compiles<BaseRequest, OwnResult>::value, "would leave the contacts empty");

// The type of the result selects the request.
TEST(ContinuousContacts, RequestsInBraces) {
  const auto a = makeModel<Model>(kA0, kA1), b = makeModel<Model>(kB0, kB1);
  const Pose pose = Pose::Identity();
  BaseResult base;
  Result result;
  EXPECT_EQ(
      continuousCollide(a.get(), pose, pose, b.get(), pose, pose, {}, base),
      continuousCollide(a.get(), pose, pose, b.get(), pose, pose, BaseRequest(), base));
  EXPECT_EQ(
      continuousCollide(a.get(), pose, pose, b.get(), pose, pose, {100, 1e-5}, base),
      continuousCollide(a.get(), pose, pose, b.get(), pose, pose, BaseRequest(100, 1e-5),
                        base));
  EXPECT_TRUE(base.is_collide);
  continuousCollide(a.get(), pose, pose, b.get(), pose, pose, {}, result);
  EXPECT_FALSE(result.contacts.empty());
  EXPECT_EQ(continuousSelfCollide(a.get(), {}, base),
            continuousSelfCollide(a.get(), {}, result));
}

TEST(ContinuousContacts, QueriesRunSideBySide) {
  const auto a = makeModel<Model>(kA0, kA1), b = makeModel<Model>(kB0, kB1);
  const auto plain = makeModel<Plain>(kB0, kB1), rigid = makeModel<Plain>(kSheet);
  Pose end = Pose::Identity();
  end.translation() = Vector3<double>(0.02, 0.01, -0.1);
  const TranslationMotion<double> motion(Pose::Identity(), end);
  const auto answer = [&](int i) {
    const CollisionGeometry<double>* others[3] = {b.get(), plain.get(), rigid.get()};
    Result result;
    if (i == 3)
      continuousSelfCollide(a.get(), Request(), result);
    else
      continuousCollide(a.get(), &motion, others[i], &motion, Request(), result);
    return result;
  };
  std::vector<Result> expected;
  for (int i = 0; i < 4; ++i) expected.push_back(answer(i));
  std::vector<std::thread> threads;
  for (int n = 0; n < 4; ++n)
    threads.emplace_back([&, n] {
      for (int i = 0; i < 12; ++i)
        expectIdentical(answer((i + n) % 4),
                        expected[static_cast<std::size_t>((i + n) % 4)]);
    });
  for (auto& thread : threads) thread.join();
}

}  // namespace
}  // namespace test
}  // namespace fcl
