// SPDX-License-Identifier: BSD-3-Clause
//
// Queries with min_distance, against all pairs of features tested one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "elementary/approach_speed.h"
#include "elementary/distance_advance.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "moving_mesh.h"
#include "query/deformable_query.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using detail::deformable::advanceToApproach;
using detail::deformable::advanceToDistance;
using detail::deformable::DistanceContact;
using detail::deformable::DistanceRequest;
using detail::deformable::PointIds;
using detail::deformable::QueryOptions;
using detail::deformable::querySelf;
using detail::deformable::VertexPath;
using Model = DeformableBVHModel<OBBRSS<double>>;
using RigidModel = BVHModel<OBBRSS<double>>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Contact = ContinuousContact<double>;
using Kind = ContinuousContactKind;

std::shared_ptr<Model> modelOf(const MovingMesh& mesh) {
  auto model = makeModel<Model>(TestMesh{mesh.t0, mesh.triangles});
  EXPECT_EQ(model->updateFrames(mesh.previous(), mesh.current(), mesh.t0.size(),
                                FclTree::kSkip),
            BVH_OK);
  return model;
}

/// A kind and, for both features, whether it is of o1, and its vertices in order.
using Feature = std::pair<int, std::vector<int>>;
struct Name {
  int kind;
  Feature first, second;
  bool operator<(const Name& o) const {
    return std::tie(kind, first, second) < std::tie(o.kind, o.first, o.second);
  }
  bool operator==(const Name& o) const {
    return std::tie(kind, first, second) == std::tie(o.kind, o.first, o.second);
  }
};
using Bracket = std::pair<double, double>;
using Contacts = std::map<Name, Bracket>;

Feature feature(bool on_o1, std::vector<int> ids) {
  std::sort(ids.begin(), ids.end());
  return {on_o1 ? 1 : 2, ids};
}

Name nameOf(Kind kind, Feature first, Feature second) {
  // Features of one kind are in the order of their names.
  if (first.second.size() == second.second.size() && second < first)
    std::swap(first, second);
  return {static_cast<int>(kind), std::move(first), std::move(second)};
}

Name nameOf(const Contact& c, bool is_self) {
  const int first = c.kind == Kind::kEdgeEdge ? 2 : 1, all = c.numVertices();
  const auto ids = c.vertices.begin();
  for (int i = all; i < 5; ++i) EXPECT_EQ(c.vertices[static_cast<std::size_t>(i)], -1);
  return nameOf(c.kind, feature(c.first_on_o1, {ids, ids + first}),
                feature(is_self || !c.first_on_o1, {ids + first, ids + all}));
}

Contacts contactsOf(const Result& result, bool is_self) {
  Contacts found;
  for (const Contact& c : result.contacts)
    EXPECT_TRUE(found.emplace(nameOf(c, is_self), Bracket{c.toc_lo, c.toc_hi}).second);
  return found;
}

/// All pairs of features of two meshes, or of one with itself, tested one by one.
class BruteForce {
 public:
  BruteForce(const MovingMesh& a, const MovingMesh& b, const DistanceRequest& request,
             double min_approach_speed)
      : mesh_{&a, &b}, request_(request), min_approach_speed_(min_approach_speed) {}

  Contacts find() {
    const bool is_self = mesh_[0] == mesh_[1];
    testVerticesAndFaces(0, 1);
    if (!is_self) testVerticesAndFaces(1, 0);
    const auto a = uniqueEdges(mesh_[0]->triangles), b = uniqueEdges(mesh_[1]->triangles);
    for (std::size_t i = 0; i < a.size(); ++i)
      for (std::size_t j = is_self ? i + 1 : 0; j < b.size(); ++j)
        test(Kind::kEdgeEdge, 0, {a[i][0], a[i][1], b[j][0], b[j][1]});
    return std::move(found_);
  }

 private:
  void testVerticesAndFaces(int vertices, int faces) {
    std::set<int> used;
    for (const Triangle& t : mesh_[vertices]->triangles)
      for (int k = 0; k < 3; ++k) used.insert(static_cast<int>(t[k]));
    for (const int v : used)
      for (const Triangle& t : mesh_[faces]->triangles)
        test(Kind::kVertexFace, vertices,
             {v, static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  }

  void test(Kind kind, int side, const std::array<int, 4>& id) {
    const std::size_t num_first = kind == Kind::kVertexFace ? 1 : 2;
    const bool is_self = mesh_[0] == mesh_[1];
    VertexPath x[4];
    PointIds ids;
    for (std::size_t i = 0; i < 4; ++i) {
      ids.id[i] = static_cast<std::uint32_t>(id[i]);
      const bool is_first = i < num_first;
      for (std::size_t j = num_first; is_self && is_first && j < 4; ++j)
        if (id[i] == id[j]) return;
      const MovingMesh& mesh = *mesh_[is_first ? side : 1 - side];
      for (int k = 0; k < 3; ++k) {
        x[i].t0[k] = mesh.t0[static_cast<std::size_t>(id[i])][k];
        x[i].t1[k] = mesh.t1[static_cast<std::size_t>(id[i])][k];
      }
    }
    const DistanceContact c = advanceToApproach(kind, {{&x[0], &x[1], &x[2], &x[3]}},
                                                request_, min_approach_speed_, ids);
    if (!c.is_contact) return;
    Feature parts[2];
    for (std::size_t i = 0; i < 4 && c.points[i] >= 0; ++i) {
      const auto point = static_cast<std::size_t>(c.points[i]);
      const bool is_first = point < num_first;
      // The vertex of a vertex and an edge comes first.
      const std::size_t place =
          c.kind == Kind::kVertexEdge ? std::min<std::size_t>(i, 1) : !is_first;
      parts[place].first = is_self || (is_first ? side : 1 - side) == 0 ? 1 : 2;
      parts[place].second.push_back(id[point]);
    }
    for (Feature& part : parts) std::sort(part.second.begin(), part.second.end());
    const Bracket bracket{c.toc_lo, c.toc_hi};
    const auto [at, is_new] = found_.emplace(nameOf(c.kind, parts[0], parts[1]), bracket);
    if (!is_new) at->second = std::min(at->second, bracket);
  }

  const MovingMesh* mesh_[2];
  DistanceRequest request_;
  double min_approach_speed_;
  Contacts found_;
};

Contacts bruteForce(const MovingMesh& a, const MovingMesh& b, const Request& request) {
  DistanceRequest distance;
  distance.distance = request.min_distance;
  distance.toc_err = request.toc_err;
  distance.t_max = request.t_max;
  distance.ignores_initially_closer = request.ignore_initially_closer;
  return BruteForce(a, b, distance, request.min_approach_speed).find();
}

Request requestAt(double distance) {
  Request request;
  request.toc_err = 1e-6;
  request.min_distance = distance;
  return request;
}

MovingMesh moved(MovingMesh mesh, const Vector3<double>& by) {
  for (auto* frame : {&mesh.t0, &mesh.t1})
    for (auto& p : *frame) p += by;
  return mesh;
}

/// Kinds that were found, so that a test knows what it has seen.
struct Seen {
  std::set<int> kinds;
  std::size_t at_start{0}, later{0};
  void add(const Contacts& contacts) {
    for (const auto& [name, bracket] : contacts) {
      kinds.insert(name.kind);
      ++(bracket.first == 0 ? at_start : later);
    }
  }
};

TEST(FCL_MIN_DISTANCE, selfAgainstAllPairs) {
  Random random(81);
  Seen seen;
  for (int i = 0; i < 12; ++i) {
    const MovingMesh mesh = crumpledSheet(random, 3 + i % 3, i % 2 ? 0.3 : 0.05);
    const auto model = modelOf(mesh);
    for (const double distance : {0.003, 0.04, 0.2})
      for (const bool ignores : {false, true}) {
        SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(distance));
        Request request = requestAt(distance);
        request.ignore_initially_closer = ignores;
        request.min_approach_speed = i % 3 ? 0 : 0.1;
        const Result result = selfContacts<double>(*model, request);
        const Contacts found = contactsOf(result, true);
        ASSERT_EQ(found, bruteForce(mesh, mesh, request));
        EXPECT_EQ(result.counts.feature_pairs,
                  result.counts.box_culled + result.counts.filter_culled +
                      result.counts.solver_culled + result.counts.contacts);
        seen.add(found);
      }
  }
  EXPECT_EQ(seen.kinds.size(), 4U);
  EXPECT_GT(seen.at_start, 500U);
  EXPECT_GT(seen.later, 500U);
}

/// Smooth sheets, most pairs of which are left out by a proof; they are bent, squeezed
/// and sheared, so that triangles get low.
TEST(FCL_MIN_DISTANCE, smoothSheetsAgainstAllPairs) {
  Random random(87);
  constexpr int kSide = 13, kLarge = 40, kRounds = kHasAddressSanitizer ? 2 : 8;
  const auto sheet = [&](double squeeze, double shear, double wave, int side) {
    return makeSheet(side, side, [=](double u, double v) {
      return Vector3<double>(squeeze * u + shear * v, v,
                             wave * std::sin(7 * u) * std::cos(5 * v));
    });
  };
  // Pairs of triangles that a query meets, with and without the proof.
  const auto trianglePairs = [](const MovingMesh& mesh, double distance, bool proves) {
    const PreparedMovingMesh prepared(mesh);
    QueryOptions options;
    options.min_distance = distance;
    options.leaves_out_regions = proves;
    return querySelf(prepared.instance(), options).counts.triangle_pairs;
  };
  std::size_t contacts = 0, left_out = 0;
  for (int i = 0; i < kRounds; ++i) {
    const TestMesh from = sheet(1, 0, 0.02, kSide),
                   to = sheet(random.uniform(0.2, 1), random.uniform(-1, 1),
                              random.uniform(0, 0.06), kSide);
    const MovingMesh mesh{from.vertices, to.vertices, from.triangles};
    const auto model = modelOf(mesh);
    for (const double share : {0.02, 0.2, 0.6, 1.2}) {
      SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(share));
      Request request = requestAt(share / kSide);
      request.ignore_initially_closer = i % 2;
      const Result result = selfContacts<double>(*model, request);
      ASSERT_EQ(contactsOf(result, true), bruteForce(mesh, mesh, request));
      contacts += result.contacts.size();
      const auto whole = trianglePairs(mesh, request.min_distance, false);
      EXPECT_LE(result.counts.triangle_pairs, whole);
      left_out += result.counts.triangle_pairs < whole;
    }
  }
  EXPECT_GT(contacts, 625U * kRounds);
  EXPECT_GT(left_out, 3U * kRounds / 4);
  const TestMesh from = sheet(1, 0, 0.02, kLarge), to = sheet(0.9, 0.1, 0.03, kLarge);
  const MovingMesh large{from.vertices, to.vertices, from.triangles};
  const double low = 0.1 / kLarge, high = 1.5 / kLarge;
  EXPECT_LT(4 * trianglePairs(large, low, true), trianglePairs(large, low, false));
  // Nothing is apart by more than the heights of its triangles.
  EXPECT_EQ(trianglePairs(large, high, true), trianglePairs(large, high, false));
}

/// Some triangles twice, with their vertices in another order too. Each pair of features
/// is one contact.
TEST(FCL_MIN_DISTANCE, duplicateTrianglesAgainstAllPairs) {
  Random random(88);
  Seen seen;
  for (int i = 0; i < 8; ++i) {
    MovingMesh mesh = crumpledSheet(random, 4, 0.2);
    const std::size_t count = mesh.triangles.size();
    for (std::size_t k = 0; k < count / 3; ++k) {
      const Triangle t = mesh.triangles[random.index(count)];
      mesh.triangles.push_back(random.index(2) ? t : Triangle(t[1], t[0], t[2]));
    }
    const auto model = modelOf(mesh);
    for (const double distance : {0.01, 0.1}) {
      SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(distance));
      Request request = requestAt(distance);
      request.ignore_initially_closer = i % 2;
      const Contacts found = contactsOf(selfContacts<double>(*model, request), true);
      ASSERT_EQ(found, bruteForce(mesh, mesh, request));
      seen.add(found);
    }
  }
  EXPECT_EQ(seen.kinds.size(), 4U);
  EXPECT_GT(seen.later, 100U);
}

/// Where corners of a triangle coincide, two of its edges have the same nearest point.
/// Which one a contact names does not depend on the corner at which the triangle begins.
TEST(FCL_MIN_DISTANCE, coincidentCorners) {
  Random random(90);
  Seen seen;
  for (int i = 0; i < 8; ++i) {
    MovingMesh mesh = crumpledSheet(random, 4, 0.3);
    for (std::size_t k = 0; k < mesh.triangles.size(); k += 4)
      for (auto* frame : {&mesh.t0, &mesh.t1})
        (*frame)[mesh.id(k, 0)] = (*frame)[mesh.id(k, 1)];
    MovingMesh turned = mesh;
    for (Triangle& t : turned.triangles)
      t = random.index(2) ? Triangle(t[1], t[2], t[0]) : Triangle(t[2], t[1], t[0]);
    std::reverse(turned.triangles.begin(), turned.triangles.end());
    for (const double distance : {0.01, 0.1, 0.3}) {
      SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(distance));
      Request request = requestAt(distance);
      request.ignore_initially_closer = i % 2;
      const Contacts truth = bruteForce(mesh, mesh, request);
      for (const MovingMesh* given : {&mesh, &turned})
        ASSERT_EQ(contactsOf(selfContacts<double>(*modelOf(*given), request), true),
                  truth);
      seen.add(truth);
    }
  }
  EXPECT_EQ(seen.kinds.size(), 4U);
  EXPECT_GT(seen.later, 500U);
}

/// Two balls in one mesh that come near each other. Each is left out with itself as long
/// as its triangles are high.
TEST(FCL_MIN_DISTANCE, bodiesAgainstAllPairs) {
  Random random(89);
  std::size_t contacts = 0;
  for (int i = 0; i < 4; ++i) {
    MovingMesh mesh = still(makeIcosphere(1, 0.5));
    append(mesh, still(makeIcosphere(1, 0.4)));
    const std::size_t half = mesh.t0.size() / 2;
    const Vector3<double> from(1.2, random.uniform(-0.3, 0.3), 0.1),
        to(random.uniform(0.7, 0.95), random.uniform(-0.3, 0.3), 0);
    for (std::size_t k = half; k < mesh.t0.size(); ++k) {
      mesh.t0[k] += from;
      mesh.t1[k] = 0.9 * mesh.t1[k] + to;
    }
    const auto model = modelOf(mesh);
    for (const double distance : {0.01, 0.15, 0.4}) {
      SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(distance));
      Request request = requestAt(distance);
      request.ignore_initially_closer = i % 2;
      const Result result = selfContacts<double>(*model, request);
      ASSERT_EQ(contactsOf(result, true), bruteForce(mesh, mesh, request));
      contacts += result.contacts.size();
    }
  }
  EXPECT_GT(contacts, 1000U);
}

TEST(FCL_MIN_DISTANCE, pairsAgainstAllPairs) {
  Random random(82);
  Seen seen;
  for (int i = 0; i < 12; ++i) {
    const MovingMesh a = crumpledSheet(random, 4, 0.2),
                     b = moved(crumpledSheet(random, 3, 0.2), {0.1, 0.2, 0.15});
    const auto model_a = modelOf(a), model_b = modelOf(b);
    for (const double distance : {0.002, 0.03, 0.1, 0.5}) {
      SCOPED_TRACE(std::to_string(i) + " at " + std::to_string(distance));
      Request request = requestAt(distance);
      request.ignore_initially_closer = i % 3 == 0;
      request.min_approach_speed = i % 4 ? 0 : 0.1;
      request.t_max = i % 2 ? 1 : 0.3;
      const Contacts truth = bruteForce(a, b, request);
      const Contacts found = contactsOf(pairContacts(*model_a, *model_b, request), false);
      ASSERT_EQ(found, truth);
      seen.add(found);
      // The other way round each contact is the same.
      Contacts turned;
      for (const auto& [name, bracket] :
           contactsOf(pairContacts(*model_b, *model_a, request), false)) {
        Name other = name;
        for (Feature* f : {&other.first, &other.second}) f->first = 3 - f->first;
        turned[nameOf(static_cast<Kind>(other.kind), other.first, other.second)] =
            bracket;
      }
      ASSERT_EQ(turned, truth);
    }
  }
  EXPECT_EQ(seen.kinds.size(), 4U);
  EXPECT_GT(seen.later, 500U);
}

/// Rigid meshes, whose features have no owners, and a translation between two poses.
TEST(FCL_MIN_DISTANCE, rigidMeshes) {
  const TestMesh ball = makeIcosphere(1, 0.5), box = makeBox({0.5, 0.5, 0.5}, 2);
  const Vector3<double> from(-1.2, 0.3, 0.1), to(0.2, -0.1, 0.3);
  MovingMesh moving{ball.vertices, ball.vertices, ball.triangles};
  for (auto& p : moving.t0) p += from;
  for (auto& p : moving.t1) p += to;
  const MovingMesh still{box.vertices, box.vertices, box.triangles};
  const auto rigid_ball = makeModel<RigidModel>(ball),
             rigid_box = makeModel<RigidModel>(box);
  for (const double distance : {0.01, 0.1, 0.3}) {
    const Request request = requestAt(distance);
    Result result;
    const Transform3<double> tf = Transform3<double>::Identity();
    Transform3<double> beg = tf, end = tf;
    beg.translation() = from;
    end.translation() = to;
    continuousCollide(rigid_ball.get(), beg, end, rigid_box.get(), tf, tf, request,
                      result);
    const Contacts found = contactsOf(result, false),
                   truth = bruteForce(moving, still, request);
    // Which of the repeated tests of a feature's pairs decides may differ by rounding.
    ASSERT_EQ(found.size(), truth.size());
    for (auto x = found.begin(), y = truth.begin(); x != found.end(); ++x, ++y) {
      ASSERT_TRUE(x->first == y->first);
      ASSERT_NEAR(x->second.first, y->second.first, 1e-12);
    }
    EXPECT_FALSE(found.empty());
  }
}

TEST(FCL_MIN_DISTANCE, firstAnyAndFewContacts) {
  Random random(83);
  for (int i = 0; i < 20; ++i) {
    const MovingMesh mesh = crumpledSheet(random, 6, 0.4);
    const auto model = modelOf(mesh);
    Request request = requestAt(std::pow(10, random.uniform(-3, -1)));
    request.ignore_initially_closer = i % 2;
    const Result all = selfContacts<double>(*model, request);
    ASSERT_FALSE(all.contacts.empty());
    EXPECT_EQ(all.time_of_contact, all.contacts.front().toc_lo);

    request.query = ContinuousQuery::kFirst;
    const Result first = selfContacts<double>(*model, request);
    EXPECT_EQ(first.time_of_contact, all.time_of_contact);
    double first_hi = 1;
    for (const Contact& c : all.contacts) first_hi = std::min(first_hi, c.toc_hi);
    Contacts expected = contactsOf(all, true);
    for (auto c = expected.begin(); c != expected.end();)
      c = c->second.first <= first_hi ? std::next(c) : expected.erase(c);
    EXPECT_EQ(contactsOf(first, true), expected);
    request.num_max_contacts = 1 + random.index(first.contacts.size());
    const Result few_first = selfContacts<double>(*model, request);
    ASSERT_EQ(few_first.contacts.size(), request.num_max_contacts);
    EXPECT_EQ(few_first.contacts_cut, few_first.contacts.size() < first.contacts.size());
    for (std::size_t k = 0; k < few_first.contacts.size(); ++k)
      EXPECT_TRUE(nameOf(few_first.contacts[k], true) == nameOf(first.contacts[k], true));
    request.num_max_contacts = 1000000;

    request.query = ContinuousQuery::kAny;
    EXPECT_TRUE(selfContacts<double>(*model, request).is_collide);

    request.query = ContinuousQuery::kAll;
    request.num_max_contacts = 1 + random.index(all.contacts.size());
    const Result few = selfContacts<double>(*model, request);
    ASSERT_EQ(few.contacts.size(), request.num_max_contacts);
    EXPECT_EQ(few.contacts_cut, few.contacts.size() < all.contacts.size());
    for (std::size_t k = 0; k < few.contacts.size(); ++k)
      EXPECT_TRUE(nameOf(few.contacts[k], true) == nameOf(all.contacts[k], true));
    EXPECT_EQ(few.time_of_contact, all.time_of_contact);

    request.num_max_contacts = 1000000;
    request.t_max = 0.5 * all.time_of_contact;
    if (request.t_max == 0) continue;
    const Result none = selfContacts<double>(*model, request);
    EXPECT_TRUE(none.contacts.empty());
    EXPECT_EQ(none.time_of_contact, 1);
  }
}

/// Expects the first contacts of `all` in lists of one to three.
template <typename Query>
void expectFirstFew(Request request, Query&& query) {
  request.query = ContinuousQuery::kFirst;
  const Result all = query(request);
  ASSERT_GT(all.contacts.size(), 100U);
  EXPECT_EQ(all.time_of_contact, 0);
  for (request.num_max_contacts = 1; request.num_max_contacts < 4;
       ++request.num_max_contacts)
    for (request.num_threads = 1; request.num_threads <= 4; request.num_threads += 3) {
      const Result few = query(request);
      EXPECT_TRUE(few.contacts_cut);
      EXPECT_EQ(few.initially_crossing, all.initially_crossing);
      ASSERT_EQ(few.contacts.size(), request.num_max_contacts);
      for (std::size_t k = 0; k < few.contacts.size(); ++k) {
        const Contact &x = few.contacts[k], &y = all.contacts[k];
        EXPECT_TRUE(nameOf(x, true) == nameOf(y, true));
        EXPECT_EQ(x.first_on_o1, y.first_on_o1);
        EXPECT_EQ(x.b1, y.b1);
        EXPECT_EQ(x.b2, y.b2);
        EXPECT_EQ(x.toc_hi, y.toc_hi);
      }
      // Most triangles have no vertex that comes before those in the list.
      if (request.num_threads == 1) {
        EXPECT_LT(4 * few.counts.feature_pairs, all.counts.feature_pairs);
      }
    }
}

// Triangles are left out whose contacts at t = 0 the list has no place for.
TEST(FCL_MIN_DISTANCE, fewOfManyContactsAtStart) {
  Random random(87);
  for (int i = 0; i < rounds(4); ++i) {
    SCOPED_TRACE(i);
    const MovingMesh sheet = crumpledSheet(random, 60, 0.01),
                     other = moved(crumpledSheet(random, 60, 0.01), {0.01, 0.02, 0.01});
    MovingMesh both = sheet;
    append(both, other);
    const auto a = modelOf(sheet), b = modelOf(other), ab = modelOf(both);
    expectFirstFew(requestAt(0.02),
                   [&](const Request& r) { return selfContacts<double>(*ab, r); });
    expectFirstFew(requestAt(0.02),
                   [&](const Request& r) { return pairContacts(*a, *b, r); });
  }
}

/// Expects the contacts at t = 0 of all contacts, if only the first ones are wanted. Adds
/// their numbers by kind.
template <typename Query>
void expectContactsAtStart(Request request, Query&& query, std::map<Kind, int>& found) {
  const Result all = query(request);
  request.query = ContinuousQuery::kFirst;
  const Result first = query(request);
  std::size_t k = 0;
  for (; k < all.contacts.size() && all.contacts[k].toc_lo == 0; ++k) {
    ASSERT_LT(k, first.contacts.size());
    const Contact &x = first.contacts[k], &y = all.contacts[k];
    ASSERT_EQ(x.kind, y.kind);
    ASSERT_EQ(x.vertices, y.vertices);
    ASSERT_EQ(x.first_on_o1, y.first_on_o1);
    ASSERT_EQ(x.b1, y.b1);
    ASSERT_EQ(x.b2, y.b2);
    ASSERT_EQ(x.toc_lo, 0);
    ASSERT_EQ(x.toc_hi, 0);
    ++found[x.kind];
  }
  EXPECT_EQ(first.contacts.size(), k);
}

// A query for the first contact, which knows one at t = 0, decides pairs by their
// distance then. Points of two sheets coincide, or have equal coordinates.
TEST(FCL_MIN_DISTANCE, contactsAtStartAreThoseOfAllContacts) {
  Random random(91);
  std::map<Kind, int> found;
  for (const Vector3<double>& offset :
       {Vector3<double>(0.01, 0.02, 0.01), Vector3<double>(0, 0, 0.01),
        Vector3<double>(0, 0, 0)}) {
    const MovingMesh sheet = crumpledSheet(random, 12, 0.05),
                     other = moved(sheet, offset);
    MovingMesh both = sheet;
    append(both, other);
    const auto a = modelOf(sheet), b = modelOf(other), ab = modelOf(both);
    const Request request = requestAt(0.02);
    expectContactsAtStart(
        request, [&](const Request& r) { return selfContacts<double>(*ab, r); }, found);
    expectContactsAtStart(
        request, [&](const Request& r) { return pairContacts(*a, *b, r); }, found);
  }
  for (const Kind kind :
       {Kind::kVertexFace, Kind::kEdgeEdge, Kind::kVertexEdge, Kind::kVertexVertex})
    EXPECT_GT(found[kind], 100);
}

/// Two crumpled sheets, whose vertices are mostly nearer to the other sheet than 0.06.
/// Some vertices of the second one are as far above faces of the first one as `gaps`, 0
/// for those that touch.
MovingMesh touchingSheets(Random& random, const std::vector<double>& gaps) {
  MovingMesh mesh = crumpledSheet(random, 10, 0.01);
  const MovingMesh other = moved(crumpledSheet(random, 10, 0.01), {0.01, 0.02, 0.02});
  const std::size_t first = mesh.t0.size(), faces = mesh.triangles.size();
  append(mesh, other);
  for (const double gap : gaps) {
    const Triangle& t = mesh.triangles[random.index(faces)];
    const Vector3<double> p[] = {mesh.t0[t[0]], mesh.t0[t[1]], mesh.t0[t[2]]};
    const std::size_t v = first + random.index(other.t0.size());
    // A corner of the face exactly, or above its middle.
    const bool is_corner = random.index(2) == 0;
    const Vector3<double> n = (p[1] - p[0]).cross(p[2] - p[0]).normalized(),
                          at = is_corner ? p[0] : (p[0] + p[1] + p[2]) / 3;
    mesh.t1[v] += at + gap * n - mesh.t0[v];
    mesh.t0[v] = at + gap * n;
  }
  return mesh;
}

// What is nearer at t = 0 and ignored is left out where only t = 0 matters, and nothing
// that touches then, or nearly.
TEST(FCL_MIN_DISTANCE, touchingAmongIgnored) {
  Random random(88);
  std::size_t at_start = 0, later = 0;
  for (int i = 0; i < (kHasAddressSanitizer ? 4 : 16); ++i) {
    SCOPED_TRACE(i);
    // 1e-6 and 2e-6 are about where rounding may hide a distance.
    std::vector<double> gaps = {1e-11, 1e-9, 1e-7, 1e-6, 2e-6, 1e-5};
    if (i % 4 != 3) gaps.insert(gaps.end(), {0, 0, 0, 1e-17, 1e-15, 1e-13});
    const MovingMesh mesh = touchingSheets(random, gaps);
    const auto model = modelOf(mesh);
    Request request = requestAt(0.06);
    request.ignore_initially_closer = true;
    const Contacts truth = bruteForce(mesh, mesh, request);
    request.query = ContinuousQuery::kFirst;
    const Result first = selfContacts<double>(*model, request);
    double first_hi = 1;
    for (const auto& [name, bracket] : truth)
      first_hi = std::min(first_hi, bracket.second);
    Contacts expected;
    for (const auto& [name, bracket] : truth)
      if (bracket.first <= first_hi) expected.emplace(name, bracket);
    ASSERT_EQ(contactsOf(first, true), expected);
    (first_hi == 0 ? at_start : later) += first.contacts.size();
    request.num_threads = 4;
    EXPECT_EQ(contactsOf(selfContacts<double>(*model, request), true), expected);
    if (first_hi > 0) continue;
    // The same pairs, all of which matter.
    request.ignore_initially_closer = false;
    request.num_threads = 1;
    const Result all = selfContacts<double>(*model, request);
    EXPECT_LT(2 * first.counts.feature_pairs, all.counts.feature_pairs);
  }
  EXPECT_GT(at_start, kHasAddressSanitizer ? 5U : 20U);
  EXPECT_GT(later, 0U);
}

// Pairs of triangles that come nearer from the start on, each from its own distance. All
// are in contact after 2e-9 of the time that they need to meet.
TEST(FCL_MIN_DISTANCE, soonestOfManyIgnored) {
  Random random(89);
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE(i);
    MovingMesh mesh;
    for (int k = 0; k < 30; ++k) {
      const auto sheet = makeSheet(1, 1);
      const Vector3<double> at(2. * (k % 6), 2. * (k / 6), 0);
      const double height = std::pow(10, random.uniform(-3, -1.2)),
                   way = std::pow(10, random.uniform(-2, 0));
      append(mesh, moved({sheet.vertices, sheet.vertices, sheet.triangles}, at));
      MovingMesh above = moved({sheet.vertices, sheet.vertices, sheet.triangles},
                               at + Vector3<double>(0.1, 0.05, height));
      for (auto& p : above.t1) p[2] -= way;
      append(mesh, above);
    }
    const auto model = modelOf(mesh);
    Request request = requestAt(0.1);
    request.ignore_initially_closer = true;
    double soonest = 1;
    for (const auto& [name, bracket] : bruteForce(mesh, mesh, request))
      soonest = std::min(soonest, bracket.first);
    ASSERT_GT(soonest, 0);
    ASSERT_LT(soonest, 1e-9);
    request.query = ContinuousQuery::kFirst;
    EXPECT_EQ(selfContacts<double>(*model, request).time_of_contact, soonest);
  }
}

// A distance does not make edges and faces meet.
TEST(FCL_MIN_DISTANCE, crossingsHaveNoDistance) {
  const auto sheet = makeSheet(10, 10);
  MovingMesh mesh{sheet.vertices, sheet.vertices, sheet.triangles};
  append(mesh, moved({sheet.vertices, sheet.vertices, sheet.triangles}, {0, 0, 0.05}));
  const Result result = selfContacts<double>(*modelOf(mesh), requestAt(0.06));
  EXPECT_GT(result.contacts.size(), 100U);
  EXPECT_EQ(result.counts.crossing_tests, 0U);
}

void expectSameWithFourThreads(const Model& model, Request request, std::size_t least) {
  for (const bool ignores : {false, true}) {
    request.ignore_initially_closer = ignores;
    request.num_threads = 1;
    const Result one = selfContacts<double>(model, request);
    request.num_threads = 4;
    const Result four = selfContacts<double>(model, request);
    ASSERT_EQ(one.contacts.size(), four.contacts.size());
    ASSERT_GE(one.contacts.size(), least);
    EXPECT_EQ(one.initially_crossing, four.initially_crossing);
    EXPECT_EQ(one.counts.triangle_pairs, four.counts.triangle_pairs);
    EXPECT_EQ(one.counts.feature_pairs, four.counts.feature_pairs);
    EXPECT_EQ(one.counts.box_culled, four.counts.box_culled);
    EXPECT_EQ(one.counts.filter_culled, four.counts.filter_culled);
    for (std::size_t i = 0; i < one.contacts.size(); ++i) {
      const Contact &x = one.contacts[i], &y = four.contacts[i];
      EXPECT_TRUE(nameOf(x, true) == nameOf(y, true));
      EXPECT_EQ(x.toc_lo, y.toc_lo);
      EXPECT_EQ(x.toc_hi, y.toc_hi);
      EXPECT_EQ(x.b1, y.b1);
      EXPECT_EQ(x.b2, y.b2);
      EXPECT_EQ(x.pos, y.pos);
      EXPECT_EQ(x.normal, y.normal);
    }
  }
}

TEST(FCL_MIN_DISTANCE, threadsDoNotMatter) {
  Random random(84);
  expectSameWithFourThreads(*modelOf(crumpledSheet(random, 24, 0.03)), requestAt(0.01),
                            100);
  // Regions and a body that are left out, and a sheet that comes near them.
  const auto sheet = [](double height) {
    return makeSheet(40, 40, [=](double u, double v) {
      return Vector3<double>(u, v, height + 0.05 * std::sin(5 * u));
    });
  };
  MovingMesh mesh{sheet(0).vertices, sheet(0).vertices, sheet(0).triangles};
  append(mesh, {sheet(0.4).vertices, sheet(0.02).vertices, sheet(0).triangles});
  append(mesh, moved(still(makeIcosphere(3, 0.3)), {0.5, 0.5, -0.4}));
  expectSameWithFourThreads(*modelOf(mesh), requestAt(0.025), 1000);
  // Sheets that cross at t = 0.
  append(mesh, moved(still(sheet(0)), {0.3, 0, 0}));
  const auto crossing = modelOf(mesh);
  EXPECT_TRUE(selfContacts<double>(*crossing, requestAt(0.025)).initially_crossing);
  expectSameWithFourThreads(*crossing, requestAt(0.025), 1000);
}

bool holds(const Triangle& t, int v) {
  for (int k = 0; k < 3; ++k)
    if (static_cast<int>(t[k]) == v) return true;
  return false;
}

/// The named triangles hold the features and are accepted; the middle is as far from both
/// features as half of the distance.
TEST(FCL_MIN_DISTANCE, trianglesFiltersAndGeometry) {
  Random random(85);
  const MovingMesh a = crumpledSheet(random, 6, 0.1),
                   b = moved(crumpledSheet(random, 5, 0.1), {0.05, 0.02, 0.2});
  const auto model_a = modelOf(a), model_b = modelOf(b);
  Request request = requestAt(0.05);
  const std::size_t unfiltered =
      pairContacts(*model_a, *model_b, request).contacts.size();
  request.accepts_triangles = [](std::intptr_t x, std::intptr_t y) {
    return (x + y) % 7 < 2;
  };
  const Result result = pairContacts(*model_a, *model_b, request);
  EXPECT_LT(result.contacts.size(), unfiltered);
  EXPECT_GT(result.contacts.size(), 20U);
  EXPECT_GT(result.counts.mask_culled, 0U);
  for (const Contact& c : result.contacts) {
    EXPECT_TRUE(request.accepts_triangles(c.b1, c.b2));
    const Triangle &t1 = a.triangles[static_cast<std::size_t>(c.b1)],
                   &t2 = b.triangles[static_cast<std::size_t>(c.b2)];
    const int first = c.kind == Kind::kEdgeEdge ? 2 : 1;
    std::vector<Vector3<double>> points;
    for (int i = 0; i < c.numVertices(); ++i) {
      const bool on_o1 = (i < first) == c.first_on_o1;
      const auto id = static_cast<std::size_t>(c.vertices[static_cast<std::size_t>(i)]);
      EXPECT_TRUE(holds(on_o1 ? t1 : t2, static_cast<int>(id)));
      const MovingMesh& mesh = on_o1 ? a : b;
      points.push_back((1 - c.toc_lo) * mesh.t0[id] + c.toc_lo * mesh.t1[id]);
    }
    EXPECT_NEAR(c.normal.norm(), 1, 1e-12);
    if (c.toc_lo == 0) continue;
    // All of o1's feature lies behind the plane through the middle, o2's in front.
    for (int i = 0; i < c.numVertices(); ++i) {
      const bool on_o1 = (i < first) == c.first_on_o1;
      const double along =
          c.normal.dot(points[static_cast<std::size_t>(i)] - c.pos) * (on_o1 ? -1 : 1);
      EXPECT_GE(along, 0.5 * request.min_distance - 1e-9);
    }
  }
  request.filter1.mask = 0;
  EXPECT_FALSE(pairContacts(*model_a, *model_b, request).is_collide);
}

TEST(FCL_MIN_DISTANCE, aPlateAboveAPlate) {
  const auto low = makeModel<Model>(makeSheet(3, 3));
  MovingMesh high{makeSheet(2, 2).vertices, {}, makeSheet(2, 2).triangles};
  for (auto& p : high.t0) p = 0.5 * p + Vector3<double>(0.2, 0.3, 1);
  high.t1 = high.t0;
  for (auto& p : high.t1) p -= Vector3<double>(0, 0, 0.9);
  const auto model = modelOf(high);
  Request request = requestAt(0.25);
  const Result result = pairContacts(*low, *model, request);
  EXPECT_LE(result.time_of_contact, 0.75 / 0.9);
  EXPECT_GE(result.time_of_contact, 0.75 / 0.9 - 1e-12);
  // o1 is below.
  EXPECT_LE((result.contacts.front().normal - Vector3<double>(0, 0, 1)).norm(), 1e-12);
  EXPECT_NEAR(result.contacts.front().pos[2], 0.125, 1e-12);
  // They never touch, and at the poses of the contact a discrete query finds nothing.
  request.min_distance = 0;
  EXPECT_FALSE(pairContacts(*low, *model, request).is_collide);
  // Already nearer.
  request.min_distance = 1.5;
  const Result at_start = pairContacts(*low, *model, request);
  EXPECT_EQ(at_start.time_of_contact, 0);
  request.ignore_initially_closer = true;
  const Result nearer = pairContacts(*low, *model, request);
  EXPECT_TRUE(nearer.is_collide);
  EXPECT_GT(nearer.time_of_contact, 0);
  EXPECT_LT(nearer.time_of_contact, 1e-7);
}

/// Candidates: every pair that comes within d, each once; with equal frames the pairs
/// that are near.
TEST(FCL_MIN_DISTANCE, candidatesAreAllThatComeNear) {
  Random random(86);
  std::size_t all_near = 0;
  for (int i = 0; i < 8; ++i) {
    MovingMesh mesh = crumpledSheet(random, 5, 0.1);
    if (i % 2) mesh.t1 = mesh.t0;
    const auto model = modelOf(mesh);
    const double distance = std::pow(10, random.uniform(-1.3, -0.6));
    std::set<Name> candidates;
    std::size_t count = 0;
    EXPECT_TRUE(continuousSelfCandidates(
        model.get(),
        [&](const ContinuousCandidate* block, std::size_t size) {
          for (std::size_t k = 0; k < size; ++k) {
            const int first = block[k].kind == Kind::kVertexFace ? 1 : 2;
            const auto ids = block[k].vertices.begin();
            candidates.insert(nameOf(block[k].kind, feature(true, {ids, ids + first}),
                                     feature(true, {ids + first, ids + 4})));
          }
          count += size;
          return true;
        },
        distance));
    EXPECT_EQ(candidates.size(), count);
    std::size_t near = 0;
    const auto edges = uniqueEdges(mesh.triangles);
    const auto expectIfNear = [&](Kind kind, std::array<int, 4> id) {
      VertexPath x[4];
      for (std::size_t k = 0; k < 4; ++k)
        for (int c = 0; c < 3; ++c) {
          x[k].t0[c] = mesh.t0[static_cast<std::size_t>(id[k])][c];
          x[k].t1[c] = mesh.t1[static_cast<std::size_t>(id[k])][c];
        }
      DistanceRequest request;
      request.distance = distance;
      if (!advanceToDistance(kind, {{&x[0], &x[1], &x[2], &x[3]}}, request).is_contact)
        return;
      ++near;
      const auto first = id.begin() + (kind == Kind::kVertexFace ? 1 : 2);
      EXPECT_EQ(candidates.count(nameOf(kind, feature(true, {id.begin(), first}),
                                        feature(true, {first, id.end()}))),
                1U);
    };
    for (int v = 0; v < static_cast<int>(mesh.t0.size()); ++v)
      for (const Triangle& t : mesh.triangles)
        if (!holds(t, v))
          expectIfNear(Kind::kVertexFace,
                       {v, static_cast<int>(t[0]), static_cast<int>(t[1]),
                        static_cast<int>(t[2])});
    for (std::size_t e = 0; e < edges.size(); ++e)
      for (std::size_t f = e + 1; f < edges.size(); ++f)
        if (edges[e][0] != edges[f][0] && edges[e][0] != edges[f][1] &&
            edges[e][1] != edges[f][0] && edges[e][1] != edges[f][1])
          expectIfNear(Kind::kEdgeEdge,
                       {edges[e][0], edges[e][1], edges[f][0], edges[f][1]});
    all_near += near;
    // And not all pairs there are.
    EXPECT_LT(count, edges.size() * edges.size() / 2);
  }
  EXPECT_GT(all_near, 200U);
}

TEST(FCL_MIN_DISTANCE, whatCannotBeAskedIsRefused) {
  const auto model = makeModel<Model>(makeSheet(2, 2));
  Result result;
  for (const double d : {-1., std::numeric_limits<double>::infinity(),
                         std::numeric_limits<double>::quiet_NaN()}) {
    expectRefused([&] { continuousSelfCollide(model.get(), requestAt(d), result); },
                  "request.min_distance is negative or not finite");
    expectRefused(
        [&] {
          continuousSelfCandidates(
              model.get(), [](const ContinuousCandidate*, std::size_t) { return true; },
              d);
        },
        "min_distance is negative or not finite");
  }
  Request request;
  request.ignore_initially_closer = true;
  expectRefused([&] { continuousSelfCollide(model.get(), request, result); },
                "request.min_distance, which is 0");
}

TEST(FCL_MIN_DISTANCE, inFloat) {
  const auto low = makeModel<DeformableBVHModel<OBBRSS<float>>>(makeSheet(3, 3));
  TestMesh high = makeSheet(2, 2);
  for (auto& p : high.vertices) p += Vector3<double>(0.25, 0.25, 1);
  TestMesh later = high;
  for (auto& p : later.vertices) p -= Vector3<double>(0, 0, 1);
  const auto model = makeModel<DeformableBVHModel<OBBRSS<float>>>(high, later);
  ContinuousContactRequest<float> request;
  request.min_distance = 0.25F;
  const auto result = pairContacts<float>(*low, *model, request);
  EXPECT_TRUE(result.is_collide);
  EXPECT_LE(result.time_of_contact, 0.75F);
  EXPECT_GE(result.time_of_contact, 0.7499F);
}

}  // namespace
}  // namespace test
}  // namespace fcl
