// SPDX-License-Identifier: BSD-3-Clause
//
// The options of a request that leave out contacts or add data, compared with all
// contacts. The bracket of the first contact, by which a simulation advances.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "elementary/predicates.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "moving_mesh.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Model = DeformableBVHModel<OBBRSS<double>>;
using RigidModel = BVHModel<OBBRSS<double>>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Contact = ContinuousContact<double>;

constexpr ContinuousQuery kQueries[] = {ContinuousQuery::kAll, ContinuousQuery::kFirst,
                                        ContinuousQuery::kAny};

Transform3<double> at(double x, double y, double z) {
  return Transform3<double>(Eigen::Translation3d(x, y, z));
}

TestMesh triangleOver(double height) {
  return {{{0.25, 0.25, height}, {0.5, 0.25, height}, {0.25, 0.5, height}},
          {Triangle(0, 1, 2)}};
}

/// An update without FCL's own tree, as in a simulation.
std::shared_ptr<Model> modelOf(const MovingMesh& mesh) {
  auto model = makeModel<Model>(TestMesh{mesh.t0, mesh.triangles});
  EXPECT_EQ(model->updateFrames(mesh.previous(), mesh.current(), mesh.t0.size(),
                                FclTree::kSkip),
            BVH_OK);
  return model;
}

// ---- The first contact

void expectTight(double lo, double hi, double toc_err) {
  EXPECT_LE(hi - lo, toc_err);
  EXPECT_LE(hi - lo, hi / 8);
  EXPECT_GT(lo, 0);
}

/// A triangle that falls on a plate, with the gap and the length of the fall.
TEST(FCL_LEADING_CONTACT, staysClearOfZero) {
  const auto plate = makeModel<Model>(makeSheet(2, 2));
  for (const auto& [gap, way] : {std::array<double, 2>{1, 2},
                                 {1, 1e5},
                                 {1e-6, 1},
                                 {1e-9, 1e3},
                                 {0.5, 1e12},
                                 {1e-30, 1e-3},
                                 {1e-300, 1}}) {
    SCOPED_TRACE("gap " + std::to_string(gap) + ", way " + std::to_string(way));
    const double from = gap, to = gap - way, time = from / (from - to);
    const auto cloth = makeModel<Model>(triangleOver(from), triangleOver(to));
    Request request;
    request.toc_err = 1e-4;
    for (const ContinuousQuery query : kQueries) {
      request.query = query;
      const Result result = pairContacts(*cloth, *plate, request);
      ASSERT_TRUE(result.is_collide);
      EXPECT_LE(result.time_of_contact, time * (1 + 1e-15));
      EXPECT_GE(result.time_of_contact, 0.875 * time);
      const Contact& first = result.contacts.front();
      EXPECT_LE(first.toc_lo, result.time_of_contact);
      EXPECT_GE(first.toc_hi, time * (1 - 1e-15));
      if (query == ContinuousQuery::kAll) continue;
      EXPECT_EQ(result.time_of_contact, first.toc_lo);
      expectTight(first.toc_lo, first.toc_hi, request.toc_err);
    }
    // The calls of FCL's programs, for a mesh that deforms and for one that is moved.
    const Transform3<double> still = Transform3<double>::Identity();
    ContinuousCollisionResult<double> plain;
    continuousCollide(cloth.get(), still, still, plate.get(), still, still,
                      ContinuousCollisionRequest<double>(), plain);
    EXPECT_LE(plain.time_of_contact, time * (1 + 1e-15));
    EXPECT_GE(plain.time_of_contact, 0.875 * time);
    const auto rigid = makeModel<RigidModel>(triangleOver(0));
    continuousCollide(rigid.get(), at(0, 0, from), at(0, 0, to), plate.get(), still,
                      still, ContinuousCollisionRequest<double>(), plain);
    EXPECT_LE(plain.time_of_contact, time * (1 + 1e-15));
    EXPECT_GE(plain.time_of_contact, 0.875 * time);
  }
}

TEST(FCL_LEADING_CONTACT, isZeroForWhatTouchesAtTheStart) {
  const auto plate = makeModel<Model>(makeSheet(2, 2));
  const auto cloth = makeModel<Model>(triangleOver(0), triangleOver(-1));
  for (const ContinuousQuery query : kQueries) {
    Request request;
    request.query = query;
    const Result result = pairContacts(*cloth, *plate, request);
    ASSERT_FALSE(result.contacts.empty());
    EXPECT_EQ(result.contacts.front().toc_lo, 0);
    EXPECT_EQ(result.contacts.front().toc_hi, 0);
  }
}

/// Each advance by the time of contact leaves at most an eighth of the distance.
TEST(FCL_LEADING_CONTACT, letsASimulationAdvance) {
  const auto plate = makeModel<Model>(makeSheet(4, 4));
  TestMesh ball = moved(makeIcosphere(1, 0.2), 0.5, 0.5, 0.7);
  int steps = 0;
  double gap = 0.5;
  for (; gap > 1e-12 && steps < 40; ++steps) {
    const TestMesh next = moved(ball, 0, 0, -1e6);
    Request request;
    request.query = ContinuousQuery::kFirst;
    request.toc_err = 1e-3;
    const Result result = pairContacts(*makeModel<Model>(ball, next), *plate, request);
    ASSERT_TRUE(result.is_collide);
    ASSERT_GT(result.time_of_contact, 0);
    ball = moved(ball, 0, 0, -1e6 * result.time_of_contact);
    gap = std::numeric_limits<double>::max();
    for (const auto& p : ball.vertices) gap = std::min(gap, p[2]);
    ASSERT_GE(gap, -1e-15);
  }
  EXPECT_LE(steps, 14);
}

/// Contacts of sheets with the brackets of a coarse tolerance, and the earliest few of
/// them. Whatever is dropped, the time is that of the first contact of all.
TEST(FCL_LEADING_CONTACT, isTheFirstOfAllWithACoarseTolerance) {
  int collisions = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto model = modelOf(crumpledSheet(random, 4, seed % 2 ? 0.4 : 30));
    Request request;
    request.toc_err = 0;
    const Result exact = selfContacts(*model, request);
    if (exact.contacts.empty() || exact.initially_crossing) continue;
    ++collisions;
    const Contact& first = exact.contacts.front();
    request.toc_err = 0.5;
    for (const ContinuousQuery query : {ContinuousQuery::kAll, ContinuousQuery::kFirst})
      for (const std::size_t most : {std::size_t{1}, std::size_t{2}, std::size_t{1000}}) {
        request.query = query;
        request.num_max_contacts = most;
        const Result result = selfContacts(*model, request);
        EXPECT_LE(result.time_of_contact, first.toc_hi);
        EXPECT_GE(result.time_of_contact, 0.875 * first.toc_lo);
        if (query == ContinuousQuery::kFirst && first.toc_lo > 0)
          expectTight(result.contacts.front().toc_lo, result.contacts.front().toc_hi,
                      0.5);
        EXPECT_TRUE(std::is_sorted(
            result.contacts.begin(), result.contacts.end(),
            [](const Contact& x, const Contact& y) { return x.toc_lo < y.toc_lo; }));
        for (const Contact& contact : result.contacts) {
          const auto same = std::find_if(
              exact.contacts.begin(), exact.contacts.end(),
              [&](const Contact& c) { return nameOf(c) == nameOf(contact); });
          ASSERT_NE(same, exact.contacts.end());
          EXPECT_LE(contact.toc_lo, same->toc_hi);
          EXPECT_GE(contact.toc_hi, same->toc_lo);
        }
      }
  }
  EXPECT_GE(collisions, 20);
}

/// Only contacts that touch at t = 0 have the time 0, whatever else begins in [0,
/// toc_err].
TEST(FCL_LEADING_CONTACT, onlyWhatTouchesAtTheStartBeginsThere) {
  int at_start = 0, later = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    MovingMesh mesh = randomSoup(random, 30, 40, 1, 2);
    if (seed % 2 == 0)
      for (auto& p : mesh.t0)
        for (int k = 0; k < 3; ++k) p[k] = std::round(2 * p[k]) / 2;
    Request request;
    request.toc_err = 0.5;
    request.query = ContinuousQuery::kFirst;
    const Result result = selfContacts(*modelOf(mesh), request);
    for (const Contact& contact : result.contacts) {
      EXPECT_EQ(contact.toc_lo == 0, contact.toc_hi == 0);
      ++(contact.toc_lo == 0 ? at_start : later);
    }
  }
  EXPECT_GE(at_start, 50);
  EXPECT_GE(later, 10);
}

TEST(FCL_LEADING_CONTACT, doesNotDependOnThreads) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto model = modelOf(crumpledSheet(random, 24, 0.05));
    for (const ContinuousQuery query : kQueries) {
      Request request;
      request.query = query;
      request.toc_err = 0.2;
      const Result alone = selfContacts(*model, request);
      request.num_threads = 4;
      for (int i = 0; i < 4; ++i) expectIdentical(alone, selfContacts(*model, request));
    }
  }
}

// ---- t_max

TEST(FCL_CONTACT_OPTIONS, tMaxCountsATouchAtItself) {
  const auto plate = makeModel<Model>(makeSheet(2, 2));
  const double last = 0.25, before = std::nextafter(last, 0.);
  // Reaches the plate at exactly 1/4: flat, with a corner, or along edges.
  std::vector<TestMesh> falling{triangleOver(0.25)};
  falling.push_back(falling[0]);
  falling.back().vertices[0][2] = falling.back().vertices[1][2] = 0.75;
  falling.push_back(falling[0]);
  falling.back().vertices[2][2] = 0.5;
  for (const TestMesh& mesh : falling) {
    const auto cloth = makeModel<Model>(mesh, moved(mesh, 0, 0, -1));
    for (const ContinuousQuery query : kQueries) {
      Request request;
      request.query = query;
      request.t_max = last;
      const Result result = pairContacts(*cloth, *plate, request);
      ASSERT_TRUE(result.is_collide);
      EXPECT_LE(result.time_of_contact, last);
      for (const Contact& contact : result.contacts) EXPECT_LE(contact.toc_hi, last);
      request.t_max = before;
      const Result none = pairContacts(*cloth, *plate, request);
      EXPECT_FALSE(none.is_collide);
      EXPECT_TRUE(none.contacts.empty());
      EXPECT_EQ(none.time_of_contact, 1);
    }
  }
}

/// The contacts until t_max are those contacts of the whole step that begin no later.
TEST(FCL_CONTACT_OPTIONS, tMaxLeavesTheEarlierContacts) {
  std::size_t some = 0, all = 0;
  for (std::uint64_t seed = 0; seed < rounds(20U); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto model = modelOf(randomSoup(random, 40, 60, 1, 1));
    Request request;
    request.toc_err = 0;
    const Result whole = selfContacts(*model, request);
    for (const double t_max : {0., 1e-3, 0.1, random.uniform(0, 1), 1.}) {
      request.t_max = t_max;
      for (const double toc_err : {0., 1e-4}) {
        request.toc_err = toc_err;
        const Result part = selfContacts(*model, request);
        std::vector<Contact> expected;
        for (const Contact& contact : whole.contacts) {
          ASSERT_TRUE(contact.toc_hi <= t_max || contact.toc_lo > t_max);
          if (contact.toc_hi <= t_max) expected.push_back(contact);
        }
        EXPECT_EQ(namesOf(part.contacts), namesOf(expected));
        EXPECT_EQ(part.initially_crossing, whole.initially_crossing);
        some += part.contacts.size();
        all += whole.contacts.size();
      }
    }
  }
  EXPECT_GE(some, rounds(300U));
  EXPECT_GE(all, 2 * some);
}

TEST(FCL_CONTACT_OPTIONS, tMaxOfATurningMesh) {
  const auto plate = makeModel<RigidModel>(makeSheet(2, 2));
  const auto rod = makeModel<RigidModel>(moved(triangleOver(0), 0.1, 0, 0));
  const Transform3<double> still = Transform3<double>::Identity();
  Transform3<double> begin = at(0.2, 0.2, 0.3), end = begin;
  end.linear() = Eigen::AngleAxisd(1.5, Vector3<double>::UnitY()).toRotationMatrix();
  Request request;
  request.ccd_motion_type = CCDM_LINEAR;
  Result result;
  const double time = continuousCollide(rod.get(), begin, end, plate.get(), still, still,
                                        request, result);
  ASSERT_TRUE(result.is_collide);
  for (const ContinuousQuery query : kQueries) {
    request.query = query;
    request.t_max = time - 1e-6;
    EXPECT_EQ(continuousCollide(rod.get(), begin, end, plate.get(), still, still, request,
                                result),
              1);
    EXPECT_FALSE(result.is_collide);
    request.t_max = time + 1e-6;
    EXPECT_NEAR(continuousCollide(rod.get(), begin, end, plate.get(), still, still,
                                  request, result),
                time, 1e-9);
    for (const Contact& contact : result.contacts) EXPECT_LE(contact.toc_hi, time + 1e-6);
  }
}

TEST(FCL_CONTACT_OPTIONS, refusesWhatMeansNothing) {
  const auto model = makeModel<Model>(makeSheet(2, 2));
  const auto refused = [&](const std::string& word, const auto& change) {
    Request request;
    change(request);
    Result result;
    result.contacts.resize(3);
    expectRefused([&] { continuousSelfCollide(model.get(), request, result); }, word);
    EXPECT_EQ(result.contacts.size(), 3U);
  };
  for (const double t_max : {-0.1, 1.5, std::nan(""), HUGE_VAL})
    refused("t_max", [&](Request& r) { r.t_max = t_max; });
  refused("enable_crossings", [](Request& r) {
    r.enable_crossings = true;
    r.query = ContinuousQuery::kAny;
  });
  refused("filter1.triangle_groups has 3 entries",
          [](Request& r) { r.filter1.triangle_groups.resize(3); });
  refused("filter1.triangle_masks has 9 entries",
          [](Request& r) { r.filter1.triangle_masks.resize(9); });
}

// ---- Filters

using Accept = std::function<bool(std::intptr_t, std::intptr_t)>;

bool holds(const Triangle& triangle, const std::vector<int>& ids) {
  return std::all_of(ids.begin(), ids.end(), [&](int id) {
    const auto v = static_cast<std::size_t>(id);
    return v == triangle[0] || v == triangle[1] || v == triangle[2];
  });
}

/// Whether any two triangles that hold the features of a contact are accepted, and
/// whether those that it names are such two.
struct Judgement {
  bool accepted{false};
  bool named{false};

  Judgement(const Contact& contact, const std::vector<Triangle>& triangles1,
            const std::vector<Triangle>& triangles2, const Accept& accept) {
    const int num_first = contact.kind == ContinuousContactKind::kVertexFace ? 1 : 2;
    const auto& v = contact.vertices;
    std::vector<int> first(v.begin(), v.begin() + num_first),
        second(v.begin() + num_first, v.begin() + contact.numVertices());
    if (!contact.first_on_o1) std::swap(first, second);
    for (std::size_t i = 0; i < triangles1.size(); ++i)
      for (std::size_t j = 0; j < triangles2.size(); ++j) {
        const auto b1 = static_cast<std::intptr_t>(i), b2 = static_cast<std::intptr_t>(j);
        if (!holds(triangles1[i], first) || !holds(triangles2[j], second) ||
            !accept(b1, b2))
          continue;
        accepted = true;
        named |= contact.b1 == b1 && contact.b2 == b2;
      }
  }
};

/// @param filtered  the answer to a request with filters that accept what `accept` does
void expectFiltered(const Result& whole, const Result& filtered,
                    const std::vector<Triangle>& triangles1,
                    const std::vector<Triangle>& triangles2, const Accept& accept) {
  const auto kept = [&](const std::vector<Contact>& contacts) {
    std::vector<Contact> out;
    for (const Contact& contact : contacts)
      if (Judgement(contact, triangles1, triangles2, accept).accepted)
        out.push_back(contact);
    return out;
  };
  EXPECT_EQ(namesOf(filtered.contacts), namesOf(kept(whole.contacts)));
  EXPECT_EQ(namesOf(filtered.crossings), namesOf(kept(whole.crossings)));
  for (const auto* contacts : {&filtered.contacts, &filtered.crossings})
    for (const Contact& contact : *contacts)
      EXPECT_TRUE(Judgement(contact, triangles1, triangles2, accept).named);
}

struct RandomFilters {
  ContinuousFilter filter[2];

  RandomFilters(Random& random, std::size_t size1, std::size_t size2) {
    const std::size_t size[2] = {size1, size2};
    for (std::size_t k = 0; k < 2; ++k) {
      filter[k].group = std::uint32_t{1} << random.index(3);
      filter[k].mask = static_cast<std::uint32_t>(random.index(8));
      for (std::size_t i = 0; i < size[k]; ++i) {
        filter[k].triangle_groups.push_back(std::uint32_t{1} << random.index(3));
        filter[k].triangle_masks.push_back(static_cast<std::uint32_t>(random.index(8)));
      }
      if (random.index(3) == 0) filter[k].triangle_groups.clear();
      if (random.index(3) == 0) filter[k].triangle_masks.clear();
    }
    if (random.index(3) == 0)
      for (std::size_t k = 0; k < 2; ++k) selectSome(random, size[k], filter[k]);
  }

  /// A few triangles that follow each other meet all others, which do not meet: whole
  /// parts of a tree are left out.
  static void selectSome(Random& random, std::size_t size, ContinuousFilter& filter) {
    if (size == 0) return;
    filter.triangle_groups.assign(size, 1);
    filter.triangle_masks.assign(size, 2);
    const std::size_t count = 1 + size / 8, first = random.index(size - count + 1);
    for (std::size_t i = first; i < first + count; ++i)
      filter.triangle_groups[i] = filter.triangle_masks[i] = 3;
  }

  static bool accept(const ContinuousFilter& x, std::intptr_t i,
                     const ContinuousFilter& y, std::intptr_t j) {
    const auto bits = [](const std::vector<std::uint32_t>& entries, std::uint32_t all,
                         std::intptr_t k) {
      return entries.empty() ? all : entries[static_cast<std::size_t>(k)];
    };
    return (bits(x.triangle_groups, x.group, i) & bits(y.triangle_masks, y.mask, j)) &&
           (bits(y.triangle_groups, y.group, j) & bits(x.triangle_masks, x.mask, i));
  }
};

Request allWithCrossings() {
  Request request;
  request.enable_crossings = true;
  return request;
}

TEST(FCL_CONTACT_OPTIONS, filtersInASelfCollision) {
  std::size_t kept = 0, left_out = 0;
  for (std::uint64_t seed = 0; seed < (kHasAddressSanitizer ? 4U : 60U); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const MovingMesh mesh =
        seed % 2 ? crumpledSheet(random, 6, 0.4) : randomSoup(random, 40, 50, 1, 0.5);
    const auto model = modelOf(mesh);
    Request request = allWithCrossings();
    const Result whole = selfContacts(*model, request);
    const RandomFilters filters(random, mesh.triangles.size(), 0);
    const ContinuousFilter& marks = filters.filter[0];
    request.filter1 = marks;
    const auto by_marks = [&](std::intptr_t i, std::intptr_t j) {
      return RandomFilters::accept(marks, i, marks, j);
    };
    for (const int threads : {1, 3}) {
      request.num_threads = threads;
      expectFiltered(whole, selfContacts(*model, request), mesh.triangles, mesh.triangles,
                     by_marks);
    }
    request.accepts_triangles = [](std::intptr_t i, std::intptr_t j) {
      return (i + j) % 3 != 0;
    };
    const Result both = selfContacts(*model, request);
    expectFiltered(whole, both, mesh.triangles, mesh.triangles,
                   [&](std::intptr_t i, std::intptr_t j) {
                     return by_marks(i, j) && (i + j) % 3 != 0;
                   });
    kept += both.contacts.size();
    left_out += whole.contacts.size() - both.contacts.size();
    // The first of the remaining contacts.
    request.query = ContinuousQuery::kFirst;
    const Result first = selfContacts(*model, request);
    EXPECT_EQ(first.is_collide, both.is_collide);
    if (!both.initially_crossing) {
      EXPECT_EQ(first.time_of_contact, both.time_of_contact);
    }
  }
  EXPECT_GE(kept, kHasAddressSanitizer ? 31U : 500U);
  EXPECT_GE(left_out, kHasAddressSanitizer ? 31U : 500U);
}

/// Meshes that deform, rigid ones, and one that turns, on either side.
TEST(FCL_CONTACT_OPTIONS, filtersBetweenTwoMeshes) {
  std::size_t kept = 0, left_out = 0;
  for (std::uint64_t seed = 0; seed < 48; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const MovingMesh a = crumpledSheet(random, 4, 0.3), b = crumpledSheet(random, 4, 0.3);
    const auto geometry = [](const MovingMesh& mesh,
                             bool deforms) -> std::shared_ptr<CollisionGeometry<double>> {
      if (deforms) return modelOf(mesh);
      return makeModel<RigidModel>(TestMesh{mesh.t0, mesh.triangles});
    };
    const auto o1 = geometry(a, seed & 1), o2 = geometry(b, seed & 2);
    const Transform3<double> still = Transform3<double>::Identity();
    const Transform3<double> begin = at(0.1, 0.05, 0.2);
    Transform3<double> end = at(0, 0.1, -0.2);
    if (seed % 3 == 0)
      end.linear() = Eigen::AngleAxisd(1, Vector3<double>::UnitX()).toRotationMatrix();
    Request request = allWithCrossings();
    request.ccd_motion_type = CCDM_LINEAR;
    const auto ask = [&] {
      Result result;
      continuousCollide(o1.get(), begin, end, o2.get(), still, still, request, result);
      return result;
    };
    const Result whole = ask();
    const RandomFilters filters(random, a.triangles.size(), b.triangles.size());
    request.filter1 = filters.filter[0];
    request.filter2 = filters.filter[1];
    request.accepts_triangles = [](std::intptr_t i, std::intptr_t j) {
      return (2 * i + j) % 5 != 0;
    };
    const Result filtered = ask();
    expectFiltered(
        whole, filtered, a.triangles, b.triangles, [&](std::intptr_t i, std::intptr_t j) {
          return RandomFilters::accept(filters.filter[0], i, filters.filter[1], j) &&
                 request.accepts_triangles(i, j);
        });
    kept += filtered.contacts.size();
    left_out += whole.contacts.size() - filtered.contacts.size();
  }
  EXPECT_GE(kept, 300U);
  EXPECT_GE(left_out, 300U);
}

TEST(FCL_CONTACT_OPTIONS, objectsThatDoNotMeetAreNotTested) {
  const auto plate = makeModel<Model>(makeSheet(2, 2));
  const auto cloth = makeModel<Model>(triangleOver(0.5), triangleOver(-0.5));
  Request request;
  EXPECT_TRUE(pairContacts(*cloth, *plate, request).is_collide);
  request.filter1.group = 2;
  request.filter2.mask = ~std::uint32_t{2};
  const Result none = pairContacts(*cloth, *plate, request);
  EXPECT_FALSE(none.is_collide);
  EXPECT_EQ(none.counts.node_pairs, 0U);
}

// ---- Crossings

using Crossing = std::array<std::vector<std::size_t>, 2>;

/// All edges of x through faces of y at t = 0, once each.
std::set<Crossing> crossingsOf(const MovingMesh& x, const MovingMesh& y, bool is_self) {
  std::set<Crossing> out;
  const auto sorted = [](std::vector<std::size_t> ids) {
    std::sort(ids.begin(), ids.end());
    return ids;
  };
  const auto point = [](const Vector3<double>& p) -> const double(&)[3] {
    return reinterpret_cast<const double(&)[3]>(*p.data());
  };
  for (const Triangle& t : x.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      for (const Triangle& face : y.triangles) {
        const std::size_t p = t[static_cast<int>(k)],
                          q = t[static_cast<int>((k + 1) % 3)];
        const auto has = [&](std::size_t id) {
          return id == face[0] || id == face[1] || id == face[2];
        };
        if (p == q || (is_self && (has(p) || has(q)))) continue;
        if (detail::deformable::isCrossing(point(x.t0[p]), point(x.t0[q]),
                                           point(y.t0[face[0]]), point(y.t0[face[1]]),
                                           point(y.t0[face[2]])))
          out.insert({sorted({p, q}), sorted({face[0], face[1], face[2]})});
      }
  return out;
}

/// The crossings of edges of o1 (or o2) in an answer. Each must be there once.
std::set<Crossing> crossingsIn(const Result& result, bool first_on_o1) {
  std::set<Crossing> out;
  for (const Contact& c : result.crossings) {
    EXPECT_EQ(c.kind, ContinuousContactKind::kCrossing);
    if (c.first_on_o1 != first_on_o1) continue;
    Crossing crossing;
    for (std::size_t i = 0; i < 5; ++i)
      crossing[i < 2 ? 0 : 1].push_back(static_cast<std::size_t>(c.vertices[i]));
    for (auto& ids : crossing) std::sort(ids.begin(), ids.end());
    EXPECT_TRUE(out.insert(crossing).second) << "listed twice";
  }
  return out;
}

TEST(FCL_CONTACT_OPTIONS, allCrossingsOfAMeshWithItself) {
  std::size_t count = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const MovingMesh mesh = randomSoup(random, 40, 60, 1, 0.3);
    const auto model = modelOf(mesh);
    const std::set<Crossing> expected = crossingsOf(mesh, mesh, true);
    count += expected.size();
    for (const ContinuousQuery query : {ContinuousQuery::kAll, ContinuousQuery::kFirst})
      for (const int threads : {1, 3}) {
        Request request = allWithCrossings();
        request.query = query;
        request.num_threads = threads;
        const Result result = selfContacts(*model, request);
        EXPECT_EQ(crossingsIn(result, true), expected);
        EXPECT_EQ(result.initially_crossing, !expected.empty());
        EXPECT_TRUE(crossingsIn(result, false).empty());
      }
    Request one;
    EXPECT_TRUE(selfContacts(*model, one).crossings.empty());
  }
  EXPECT_GE(count, 500U);
}

TEST(FCL_CONTACT_OPTIONS, allCrossingsOfTwoMeshes) {
  std::size_t count = 0;
  const Transform3<double> still = Transform3<double>::Identity();
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const MovingMesh a = crumpledSheet(random, 4, 0.1), b = crumpledSheet(random, 4, 0.1);
    const std::set<Crossing> of_a = crossingsOf(a, b, false),
                             of_b = crossingsOf(b, a, false);
    count += of_a.size() + of_b.size();
    const auto rigid = makeModel<RigidModel>(TestMesh{a.t0, a.triangles});
    const auto moving = modelOf(a), other = modelOf(b);
    Transform3<double> turned = still;
    turned.linear() = Eigen::AngleAxisd(0.5, Vector3<double>::UnitZ()).toRotationMatrix();
    for (const CollisionGeometry<double>* o1 :
         {static_cast<const CollisionGeometry<double>*>(rigid.get()),
          static_cast<const CollisionGeometry<double>*>(moving.get())})
      for (const Transform3<double>& end : {still, turned}) {
        Request request = allWithCrossings();
        request.ccd_motion_type = CCDM_LINEAR;
        Result result;
        continuousCollide(o1, still, end, other.get(), still, still, request, result);
        EXPECT_EQ(crossingsIn(result, true), of_a);
        EXPECT_EQ(crossingsIn(result, false), of_b);
      }
  }
  EXPECT_GE(count, 500U);
}

}  // namespace
}  // namespace test
}  // namespace fcl
