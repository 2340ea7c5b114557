// SPDX-License-Identifier: BSD-3-Clause
//
// Candidates of whole scenes: an elementary test of each gives the contacts of the query.
#include "fcl/narrowphase/continuous_candidates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cfenv>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/utility.h"
#include "fcl/narrowphase/continuous_features.h"
#include "moving_mesh.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::Pose;
using detail::deformable::VertexFrames;
using Kind = ContinuousContactKind;
template <typename S>
using Ours = DeformableBVHModel<KDOP<S, 16>>;
template <typename S>
using Plain = BVHModel<OBBRSS<S>>;

/// Kind, side and vertex ids. A face has its ids in ascending order: it is not defined
/// which of several equal faces stands for all of them.
using Name = std::tuple<Kind, bool, std::array<int, 4>>;

template <typename Pair>
Name nameOf(const Pair& pair) {
  std::array<int, 4> v;
  std::copy(pair.vertices.begin(), pair.vertices.begin() + 4, v.begin());
  if (pair.kind == Kind::kVertexFace) std::sort(v.begin() + 1, v.end());
  return {pair.kind, pair.first_on_o1, v};
}

/// One model of a scene and the motion of its vertices.
template <typename S>
struct Body {
  std::shared_ptr<CollisionGeometry<S>> model;
  MovingMesh mesh;
  Transform3<S> beginning = Transform3<S>::Identity();
  Transform3<S> end = Transform3<S>::Identity();

  VertexFrames frames() const {
    VertexFrames frames(mesh.previous(), mesh.current(), mesh.t0.size());
    frames.setPoses(poseOf(beginning), poseOf(end));
    return frames;
  }
  static Pose poseOf(const Transform3<S>& tf) {
    Pose pose;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) pose.rotation[3 * i + k] = double{tf.linear()(i, k)};
      pose.translation[i] = double{tf.translation()[i]};
    }
    return pose;
  }
};

template <typename S>
std::vector<Vector3<double>> roundedTo(const std::vector<Vector3<double>>& points) {
  return std::is_same_v<S, float> ? floatMesh({points, {}}).vertices : points;
}

template <typename Model>
auto makeBody(MovingMesh mesh, bool deforming = true) {
  using S = typename std::decay_t<decltype(*Model::vertices)>::Scalar;
  mesh.t0 = roundedTo<S>(mesh.t0);
  mesh.t1 = deforming ? roundedTo<S>(mesh.t1) : mesh.t0;
  Body<S> body;
  const TestMesh t0{mesh.t0, mesh.triangles}, t1{mesh.t1, mesh.triangles};
  if (deforming)
    body.model = makeModel<Model>(t0, t1);
  else
    body.model = makeModel<Model>(t0);
  body.mesh = std::move(mesh);
  return body;
}

template <typename S>
bool handOut(const Body<S>& a, const Body<S>* b, const ContinuousCandidateSink& sink) {
  return b ? continuousCandidates(a.model.get(), a.beginning, a.end, b->model.get(),
                                  b->beginning, b->end, sink)
           : continuousSelfCandidates(a.model.get(), sink);
}

template <typename S>
std::vector<ContinuousCandidate> candidatesOf(const Body<S>& a, const Body<S>* b) {
  std::vector<ContinuousCandidate> all;
  EXPECT_TRUE(handOut<S>(a, b, [&](const ContinuousCandidate* block, std::size_t count) {
    EXPECT_GE(count, 1U);
    EXPECT_LE(count, 1024U);
    all.insert(all.end(), block, block + count);
    return true;
  }));
  return all;
}

template <typename S>
ContinuousContactResult<S> contactsOf(const Body<S>& a, const Body<S>* b) {
  ContinuousContactRequest<S> request;
  request.enable_contact = false;
  ContinuousContactResult<S> result;
  if (b)
    continuousCollide(a.model.get(), a.beginning, a.end, b->model.get(), b->beginning,
                      b->end, request, result);
  else
    continuousSelfCollide(a.model.get(), request, result);
  return result;
}

ContinuousFeatureTestResult<double> test(const ContinuousCandidate& c,
                                         const VertexFrames& frames1,
                                         const VertexFrames& frames2) {
  const std::size_t split = c.kind == Kind::kVertexFace ? 1 : 2;
  Vector3<double> t0[4], t1[4];
  for (std::size_t i = 0; i < 4; ++i) {
    const auto path =
        ((i < split) == c.first_on_o1 ? frames1
                                      : frames2)[static_cast<std::size_t>(c.vertices[i])];
    t0[i] = Vector3<double>(path.t0[0], path.t0[1], path.t0[2]);
    t1[i] = Vector3<double>(path.t1[0], path.t1[1], path.t1[2]);
  }
  const auto call = c.kind == Kind::kVertexFace ? vertexFace<double> : edgeEdge<double>;
  return call(t0[0], t0[1], t0[2], t0[3], t1[0], t1[1], t1[2], t1[3], 1e-6);
}

bool holds(const MovingMesh& mesh, std::intptr_t triangle, const int* begin,
           const int* end) {
  const Triangle& t = mesh.triangles.at(static_cast<std::size_t>(triangle));
  return std::all_of(begin, end, [&t](int id) {
    const auto v = static_cast<std::size_t>(id);
    return t[0] == v || t[1] == v || t[2] == v;
  });
}

/// Checks the promises of the candidates' documentation. Returns the number of contacts.
/// @param kept_owners  no mesh is rigid without owners: the query sees the same pairs
template <typename S>
std::size_t expectContactsAmongCandidates(const Body<S>& a, const Body<S>* b,
                                          bool kept_owners = true) {
  const Body<S>& other = b ? *b : a;
  const auto candidates = candidatesOf(a, b);
  const auto result = contactsOf(a, b);
  const VertexFrames frames1 = a.frames(), frames2 = other.frames();
  std::map<Name, const ContinuousCandidate*> touching;
  std::set<Name> met;
  for (const ContinuousCandidate& c : candidates) {
    EXPECT_TRUE(met.insert(nameOf(c)).second) << "twice";
    EXPECT_NE(c.kind, Kind::kCrossing);
    EXPECT_LE(0, c.window_lo);
    EXPECT_LE(c.window_lo, c.window_hi);
    EXPECT_LE(c.window_hi, 1);
    const int* v = c.vertices.data();
    const int* split = v + (c.kind == Kind::kVertexFace ? 1 : 2);
    if (!b) {
      EXPECT_EQ(std::find_first_of(v, split, split, v + 4), split) << "shared vertex";
    }
    EXPECT_TRUE(holds(c.first_on_o1 ? a.mesh : other.mesh, c.first_on_o1 ? c.b1 : c.b2, v,
                      split));
    EXPECT_TRUE(holds(c.first_on_o1 ? other.mesh : a.mesh, c.first_on_o1 ? c.b2 : c.b1,
                      split, v + 4));
    const auto found = test(c, frames1, frames2);
    if (!found.is_contact) continue;
    touching[nameOf(c)] = &c;
    EXPECT_LE(found.toc_lo, c.window_hi);
    EXPECT_GE(found.toc_hi, c.window_lo);
  }
  EXPECT_EQ(touching.size(), result.contacts.size());
  for (const auto& contact : result.contacts) {
    const auto found = touching.find(nameOf(contact));
    if (found == touching.end()) {
      ADD_FAILURE() << "a contact that is no candidate";
      continue;
    }
    const ContinuousCandidate& c = *found->second;
    EXPECT_LE(contact.toc_lo, c.window_hi);
    EXPECT_GE(contact.toc_hi, c.window_lo);
    if (!kept_owners) continue;
    EXPECT_TRUE(
        std::equal(c.vertices.begin(), c.vertices.end(), contact.vertices.begin()));
    EXPECT_EQ(c.b1, contact.b1);
    EXPECT_EQ(c.b2, contact.b2);
  }
  if (kept_owners) {
    EXPECT_EQ(candidates.size(), result.counts.feature_pairs - result.counts.box_culled);
  }
  return result.contacts.size();
}

/// A sheet with a border, or triangles between random vertices: edges of many triangles,
/// repeated ids, repeated faces.
MovingMesh someMesh(Random& random, std::uint64_t seed) {
  if (seed % 2) return crumpledSheet(random, 6, 0.3);
  MovingMesh mesh = randomSoup(random, 30, 24, 0.6, 0.3);
  const Triangle t = mesh.triangles.front();
  mesh.triangles.emplace_back(t[2], t[1], t[0]);
  return mesh;
}

template <typename S>
Transform3<S> somePose(Random& random, const Matrix3<S>& rotation) {
  Transform3<S> tf = Transform3<S>::Identity();
  tf.linear() = rotation;
  tf.translation() = random.point(0.3).template cast<S>();
  return tf;
}

template <typename S>
Matrix3<S> someRotation(Random& random) {
  return AngleAxis<S>(static_cast<S>(random.uniform(0, 3)),
                      random.point(1).template cast<S>().normalized())
      .toRotationMatrix();
}

template <typename S>
class ContinuousCandidates : public testing::Test {};
using Scalars = testing::Types<double, float>;
TYPED_TEST_SUITE(ContinuousCandidates, Scalars, );

TYPED_TEST(ContinuousCandidates, OfAModelWithItself) {
  using S = TypeParam;
  std::size_t contacts = 0;
  for (std::uint64_t seed = 100; seed < 124; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const MovingMesh mesh = someMesh(random, seed);
    contacts += expectContactsAmongCandidates<S>(makeBody<Ours<S>>(mesh), nullptr);
    contacts += expectContactsAmongCandidates<S>(makeBody<Plain<S>>(mesh), nullptr);
    // At rest, without owners of its own.
    expectContactsAmongCandidates<S>(makeBody<Plain<S>>(mesh, false), nullptr, false);
    ASSERT_FALSE(this->HasFailure());
  }
  EXPECT_GT(contacts, 1000U);
}

TYPED_TEST(ContinuousCandidates, OfTwoModelsInMotion) {
  using S = TypeParam;
  std::size_t contacts = 0;
  for (std::uint64_t seed = 200; seed < 240; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Body<S> a = makeBody<Ours<S>>(someMesh(random, seed));
    const MovingMesh mesh = someMesh(random, seed / 2);
    Body<S> b = seed % 3 ? makeBody<Plain<S>>(mesh) : makeBody<Ours<S>>(mesh);
    if (seed % 4 == 1)  // translation: the trees stay as they are
      for (Transform3<S>* tf : {&a.beginning, &a.end, &b.beginning, &b.end})
        *tf = somePose<S>(random, Matrix3<S>::Identity());
    if (seed % 4 == 2)  // any motion of vertices on straight lines
      for (Transform3<S>* tf : {&a.beginning, &a.end, &b.beginning, &b.end})
        *tf = somePose<S>(random, someRotation<S>(random));
    contacts += expectContactsAmongCandidates(a, &b);
    contacts += expectContactsAmongCandidates(b, &a);
    ASSERT_FALSE(this->HasFailure());
  }
  EXPECT_GT(contacts, 1000U);
}

TYPED_TEST(ContinuousCandidates, OfRigidModels) {
  using S = TypeParam;
  std::size_t contacts = 0;
  for (std::uint64_t seed = 300; seed < 320; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const MovingMesh mesh_a = someMesh(random, seed), mesh_b = someMesh(random, seed / 2);
    Body<S> a = makeBody<Plain<S>>(mesh_a, false),
            b = seed % 3 ? makeBody<BVHModel<AABB<S>>>(mesh_b, false)
                         : makeBody<Ours<S>>(mesh_b);
    for (Body<S>* body : {&a, &b}) {
      const Matrix3<S> rotation =
          seed % 2 ? someRotation<S>(random) : Matrix3<S>::Identity();
      body->beginning = somePose<S>(random, rotation);
      body->end = somePose<S>(random, rotation);
    }
    contacts += expectContactsAmongCandidates(a, &b, false);
    contacts += expectContactsAmongCandidates(b, &a, false);
    ASSERT_FALSE(this->HasFailure());
  }
  EXPECT_GT(contacts, 500U);
}

/// A scene of many blocks.
Body<double> largeScene() {
  Random random(400);
  return makeBody<Ours<double>>(crumpledSheet(random, 24, 0.2));
}

TEST(ContinuousCandidatesSink, EndsTheQuery) {
  const Body<double> body = largeScene();
  const std::size_t total = candidatesOf<double>(body, nullptr).size();
  ASSERT_GT(total, 5 * 1024U);
  for (const int wanted : {1, 3}) {
    int calls = 0;
    EXPECT_FALSE(handOut<double>(
        body, nullptr,
        [&](const ContinuousCandidate*, std::size_t) { return ++calls < wanted; }));
    EXPECT_EQ(calls, wanted);
  }
  std::size_t seen = 0;
  EXPECT_FALSE(
      handOut<double>(body, nullptr, [&](const ContinuousCandidate*, std::size_t n) {
        return (seen += n) < total;  // the last block ends it too
      }));
  EXPECT_EQ(seen, total);
  const auto far = moved({body.mesh.t0, body.mesh.triangles}, 0, 0, 100);
  const auto other = makeModel<Ours<double>>(far);
  const Transform3<double> here = Transform3<double>::Identity();
  EXPECT_TRUE(continuousCandidates(body.model.get(), here, here, other.get(), here, here,
                                   [](const ContinuousCandidate*, std::size_t) {
                                     ADD_FAILURE() << "nothing to hand out";
                                     return true;
                                   }));
}

TEST(ContinuousCandidatesSink, RunsInTheCallersModeAndMayQuery) {
  const Body<double> body = largeScene();
  const auto expected = candidatesOf<double>(body, nullptr);
  std::vector<ContinuousCandidate> all;
  int mode_in_sink = -1;
  std::fesetround(FE_DOWNWARD);
  handOut<double>(body, nullptr,
                  [&](const ContinuousCandidate* block, std::size_t count) {
                    mode_in_sink = std::fegetround();
                    if (all.empty()) contactsOf<double>(body, nullptr);
                    all.insert(all.end(), block, block + count);
                    return true;
                  });
  const int mode_after = std::fegetround();
  std::fesetround(FE_TONEAREST);
  EXPECT_EQ(mode_in_sink, FE_DOWNWARD);
  EXPECT_EQ(mode_after, FE_DOWNWARD);
  ASSERT_EQ(all.size(), expected.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    ASSERT_EQ(all[i].vertices, expected[i].vertices);
    ASSERT_EQ(all[i].window_lo, expected[i].window_lo);
    ASSERT_EQ(all[i].window_hi, expected[i].window_hi);
  }
}

TEST(ContinuousCandidatesSink, ThrowsToTheCaller) {
  const Body<double> body = largeScene();
  // An exception of the sink is not mistaken for an error of the query.
  EXPECT_THROW(handOut<double>(body, nullptr,
                               [](const ContinuousCandidate*, std::size_t) -> bool {
                                 throw std::domain_error("the caller's own");
                               }),
               std::domain_error);
}

TEST(ContinuousCandidatesErrors, AreThoseOfTheQueries) {
  Random random(401);
  const Body<double> body = makeBody<Ours<double>>(crumpledSheet(random, 3, 0.2));
  const auto* o = body.model.get();
  const auto sphere = std::make_shared<Sphere<double>>(1);
  const CollisionGeometry<double>* none = nullptr;
  const Transform3<double> here = Transform3<double>::Identity();
  const auto sink = [](const ContinuousCandidate*, std::size_t) { return true; };
  const auto refused = [&](const CollisionGeometry<double>* o1,
                           const CollisionGeometry<double>* o2,
                           const Transform3<double>& tf2_end, const char* word) {
    expectRefused([&] { continuousCandidates(o1, here, here, o2, here, tf2_end, sink); },
                  word);
  };
  refused(none, o, here, "o1 is null");
  refused(o, none, here, "o2 is null");
  refused(o, sphere.get(), here, "o2 is not a triangle mesh but a sphere");
  expectRefused([&] { continuousSelfCandidates(none, sink); }, "o is null");
  expectRefused([&] { continuousSelfCandidates(sphere.get(), sink); },
                "not a triangle mesh");
  expectRefused([&] { continuousSelfCandidates(o, ContinuousCandidateSink()); },
                "sink is null");
  expectRefused(
      [&] {
        continuousCandidates(o, here, here, o, here, here, ContinuousCandidateSink());
      },
      "sink is null");

  const TestMesh t0{body.mesh.t0, body.mesh.triangles},
      t1{body.mesh.t1, body.mesh.triangles};
  const auto rigid = makeModel<Plain<double>>(t0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Transform3<double> broken = here;
  broken.translation()[1] = nan;
  refused(o, o, broken, "o2: the transform");
  const Plain<double> empty;
  refused(o, &empty, here, "o2: the model is not built");

  const auto plain = makeModel<Plain<double>>(t0, t1);
  plain->vertices[7][0] = nan;
  refused(o, plain.get(), here, "o2, current frame: vertex 7");
  // Errors that are found during the query.
  rigid->vertices[5][2] = nan;
  expectRefused([&] { continuousSelfCandidates(rigid.get(), sink); },
                "o: vertex 5 is not finite");
  rigid->vertices[5][2] = 0;
  rigid->tri_indices[2][1] = 1000;
  refused(o, rigid.get(), here, "o2: triangle 2 refers to a vertex that is not there");
}

}  // namespace
}  // namespace test
}  // namespace fcl
