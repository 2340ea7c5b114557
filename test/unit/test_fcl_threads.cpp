// SPDX-License-Identifier: BSD-3-Clause
//
// Threads change how long a build, an update and a query take, and nothing else.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cfenv>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <set>
#include <string>
#include <thread>
#include <vector>
#ifdef __SSE__
#include <xmmintrin.h>
#endif
#ifdef FCL_CCD_USE_TBB
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#include <tbb/task_scheduler_observer.h>
#endif

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "sanitizer.h"
#include "test_models.h"
#include "tree/moving_kdop_tree.h"

namespace fcl {
namespace test {
namespace {

using Model = DeformableBVHModel<KDOP<double, 16>>;
using Plain = BVHModel<OBBRSS<double>>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Geometry = CollisionGeometry<double>;
using Pose = Transform3<double>;

constexpr ContinuousQuery kQueries[] = {ContinuousQuery::kAll, ContinuousQuery::kFirst,
                                        ContinuousQuery::kAny};
constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();

/// One mesh with itself, or two of which the first may move.
struct NamedScene {
  std::string name;
  std::shared_ptr<const Geometry> o1, o2;
  Pose end = Pose::Identity();
  bool may_repeat = false;

  Result run(const Request& request) const {
    Result result;
    if (!o2) {
      continuousSelfCollide(o1.get(), request, result);
    } else {
      const Pose begin = Pose::Identity();
      continuousCollide(o1.get(), begin, end, o2.get(), begin, begin, request, result);
    }
    return result;
  }
};

Request requestOf(ContinuousQuery query, std::size_t max_contacts, double toc_err,
                  int threads) {
  Request request;
  request.query = query;
  request.num_max_contacts = max_contacts;
  request.toc_err = toc_err;
  request.num_threads = threads;
  return request;
}

Pose translation(double x, double y, double z) {
  Pose tf = Pose::Identity();
  tf.translation() = Vector3<double>(x, y, z);
  return tf;
}

/// Scenes with few and many contacts, at different times and all at the same one, with
/// and without surfaces that cross at the start.
const std::vector<NamedScene>& scenes() {
  static const std::vector<NamedScene> all = [] {
    std::vector<NamedScene> out;
    const TestMesh sheet = bentSheet(16), tangle = shaken(sheet, 0.08, 9);
    out.push_back({"crumpling", makeModel<Model>(sheet, tangle), nullptr});
    out.push_back(
        {"crossing", makeModel<Model>(tangle, shaken(sheet, 0.08, 10)), nullptr});
    out.push_back({"plain crumpling", makeModel<Plain>(sheet, tangle), nullptr});
    const TestMesh above = moved(sheet, 0.03, 0.02, 0.4),
                   below = moved(sheet, 0, 0, -0.4);
    const auto falling = makeModel<Model>(shaken(above, 0.01, 1), shaken(below, 0.02, 2));
    const auto still = makeModel<Model>(sheet, shaken(sheet, 0.01, 3));
    out.push_back({"sheets", falling, still});
    // All touch at once, along the axes of the boxes.
    const TestMesh flat = makeSheet(14, 14), ball = makeIcosphere(2, 0.5);
    out.push_back({"flat on flat",
                   makeModel<Model>(moved(flat, 0, 0, 1), moved(flat, 0, 0, -1)),
                   makeModel<Model>(flat, flat)});
    out.push_back({"rigid flat on flat", makeModel<Plain>(moved(flat, 0, 0, 1)),
                   makeModel<Plain>(flat), translation(0, 0, -2), true});
    out.push_back({"rigid balls", makeModel<Plain>(ball),
                   makeModel<Plain>(moved(ball, 0, 0, 1.2)), translation(0.1, 0, 1),
                   true});
    out.push_back({"rigid and deforming", makeModel<Plain>(moved(ball, 0.5, 0.5, 1)),
                   still, translation(0, 0.1, -1), true});
    const TestMesh soup = makeTetrahedronSoup(60, 1, 0.3, 5);
    out.push_back({"crossing soups", makeModel<Model>(soup, shaken(soup, 0.2, 6)),
                   makeModel<Model>(makeTetrahedronSoup(60, 1, 0.3, 7))});
    Pose turned = translation(0.1, 0, 0);
    turned.linear() = AngleAxis<double>(0.3, Vector3<double>::UnitY()).toRotationMatrix();
    out.push_back({"turning sheet", falling, still, turned});
    out.push_back({"plain turning sheet",
                   makeModel<Plain>(shaken(above, 0.01, 1), shaken(below, 0.02, 2)),
                   still, turned});
    out.push_back({"apart", falling, makeModel<Plain>(moved(sheet, 9, 0, 0))});
    return out;
  }();
  return all;
}

void expectSame(const Result& x, const Result& y) {
  expectIdentical(x, y);
  EXPECT_EQ(nameOf(x.crossing), nameOf(y.crossing));
  EXPECT_EQ(x.crossing.b1, y.crossing.b1);
  EXPECT_EQ(x.crossing.b2, y.crossing.b2);
}

TEST(FCL_THREADS, scenesHaveWhatTheyShould) {
  std::size_t contacts = 0, crossing = 0;
  for (const NamedScene& scene : scenes()) {
    const Result all = scene.run(requestOf(ContinuousQuery::kAll, kNoLimit, 1e-4, 1));
    if (scene.name != "apart") {
      EXPECT_GT(all.contacts.size(), 30U) << scene.name;
    }
    contacts += all.contacts.size();
    crossing += all.initially_crossing;
  }
  EXPECT_GT(contacts, 2000U);
  EXPECT_GE(crossing, 2U);
  EXPECT_LT(crossing, scenes().size() / 2);
}

/// Some tolerances, or one of them under the address sanitizer.
std::vector<double> tolerances(std::vector<double> all) {
  if (kHasAddressSanitizer) return {1e-4};
  return all;
}

/// Some limits of contacts, or one of them under the address sanitizer.
std::vector<std::size_t> limits(std::vector<std::size_t> all) {
  if (kHasAddressSanitizer) return {5};
  return all;
}

/// Some numbers of threads, or one of them under the address sanitizer.
std::vector<int> numbersOfThreads(std::vector<int> all) {
  if (kHasAddressSanitizer) return {4};
  return all;
}

TEST(FCL_THREADS, sameAnswerWithAnyNumber) {
  for (const NamedScene& scene : scenes())
    for (const ContinuousQuery query : kQueries)
      for (const std::size_t max_contacts : {std::size_t{3}, kNoLimit})
        for (const double toc_err : tolerances({1e-2, 1e-4})) {
          const auto request = [&](int threads) {
            return requestOf(query, max_contacts, toc_err, threads);
          };
          SCOPED_TRACE(scene.name + ", query " + std::to_string(static_cast<int>(query)) +
                       ", at most " + std::to_string(max_contacts) + ", toc_err " +
                       std::to_string(toc_err));
          const Result one = scene.run(request(1));
          for (const int threads : numbersOfThreads({2, 4, 0})) {
            SCOPED_TRACE(std::to_string(threads) + " threads");
            const Result several = scene.run(request(threads));
            expectSame(several, one);
            if (query == ContinuousQuery::kAll && max_contacts == kNoLimit) {
              EXPECT_EQ(several.counts.feature_pairs, one.counts.feature_pairs);
              EXPECT_EQ(several.counts.exact_tests, one.counts.exact_tests);
              EXPECT_EQ(several.counts.node_pairs, one.counts.node_pairs);
            }
            ASSERT_FALSE(HasFailure());
          }
        }
}

/// Expects that the contacts are some of all, with brackets inside of theirs (for a pair
/// that is met repeatedly, another bracket may be kept), and that the time is the same to
/// the bit.
void expectFirstOf(const Result& first, const Result& all, bool may_repeat) {
  EXPECT_EQ(first.time_of_contact, all.time_of_contact);
  ASSERT_EQ(first.contacts.empty(), all.contacts.empty());
  for (const auto& contact : first.contacts) {
    const auto same =
        std::find_if(all.contacts.begin(), all.contacts.end(),
                     [&](const auto& other) { return nameOf(other) == nameOf(contact); });
    ASSERT_NE(same, all.contacts.end());
    if (may_repeat) continue;
    EXPECT_GE(contact.toc_lo, same->toc_lo);
    EXPECT_LE(contact.toc_hi, same->toc_hi);
  }
}

// A first-contact query returns some of all contacts, for any number of kept contacts and
// of threads.
TEST(FCL_THREADS, firstIsTheBeginningOfAll) {
  for (const NamedScene& scene : scenes())
    for (const double toc_err : tolerances({0.3, 1e-2, 1e-4, 1e-9})) {
      SCOPED_TRACE(scene.name + ", toc_err " + std::to_string(toc_err));
      const Result whole =
          scene.run(requestOf(ContinuousQuery::kFirst, kNoLimit, toc_err, 1));
      expectFirstOf(whole,
                    scene.run(requestOf(ContinuousQuery::kAll, kNoLimit, toc_err, 1)),
                    scene.may_repeat);
      for (const std::size_t max_contacts : limits({1, 5, kNoLimit}))
        for (const int threads : numbersOfThreads({1, 0})) {
          Result expected = whole;
          expected.contacts_cut = whole.contacts.size() > max_contacts;
          if (expected.contacts_cut) expected.contacts.resize(max_contacts);
          // The answer may have another crossing, and other triangles of an unprepared
          // mesh.
          expectIdentical(scene.run(requestOf(ContinuousQuery::kFirst, max_contacts,
                                              toc_err, threads)),
                          expected, !scene.may_repeat);
          ASSERT_FALSE(HasFailure()) << max_contacts << ", " << threads;
        }
    }
}

// The earliest contacts, up to the limit, are the beginning of all.
TEST(FCL_THREADS, fewAreTheBeginningOfAll) {
  for (const NamedScene& scene : scenes())
    for (const double toc_err : tolerances({0.3, 1e-4})) {
      SCOPED_TRACE(scene.name + ", toc_err " + std::to_string(toc_err));
      const Result all =
          scene.run(requestOf(ContinuousQuery::kAll, kNoLimit, toc_err, 1));
      for (const std::size_t max_contacts : {1, 2, 30}) {
        Result expected = all;
        expected.contacts_cut = all.contacts.size() > max_contacts;
        if (expected.contacts_cut) expected.contacts.resize(max_contacts);
        expectSame(scene.run(requestOf(ContinuousQuery::kAll, max_contacts, toc_err, 0)),
                   expected);
        ASSERT_FALSE(HasFailure()) << max_contacts;
      }
    }
}

TEST(FCL_THREADS, refusesANegativeNumber) {
  const NamedScene& scene = scenes().front();
  for (const int threads : {-1, std::numeric_limits<int>::min()})
    expectRefused(
        [&] { scene.run(requestOf(ContinuousQuery::kAll, kNoLimit, 1e-4, threads)); },
        "num_threads");
  const Result many = scene.run(
      requestOf(ContinuousQuery::kAll, kNoLimit, 1e-4, std::numeric_limits<int>::max()));
  expectSame(many, scene.run(requestOf(ContinuousQuery::kAll, kNoLimit, 1e-4, 1)));
}

// Queries of several threads on the same models.
TEST(FCL_THREADS, manyCallersOnTheSameModels) {
  std::vector<Result> expected;
  for (const NamedScene& scene : scenes())
    for (const ContinuousQuery query : kQueries)
      expected.push_back(scene.run(requestOf(query, kNoLimit, 1e-4, 1)));
  std::vector<std::vector<Result>> results(4);
  std::vector<std::thread> callers;
  for (std::size_t i = 0; i < results.size(); ++i)
    callers.emplace_back([&, i] {
      for (const NamedScene& scene : scenes())
        for (const ContinuousQuery query : kQueries)
          results[i].push_back(
              scene.run(requestOf(query, kNoLimit, 1e-4, static_cast<int>(i) % 3)));
    });
  for (std::thread& caller : callers) caller.join();
  for (const std::vector<Result>& mine : results) {
    ASSERT_EQ(mine.size(), expected.size());
    for (std::size_t i = 0; i < mine.size(); ++i) expectSame(mine[i], expected[i]);
  }
}

// The error of a query: the first vertex that is not finite, the same one for any number
// of threads.
TEST(FCL_THREADS, exceptionsComeThrough) {
  const TestMesh flat = makeSheet(24, 24);
  const auto rigid = makeModel<Plain>(moved(flat, 0, 0, 1));
  for (const int v : {77, 200, 333, 500})
    rigid->vertices[v][2] = std::numeric_limits<double>::quiet_NaN();
  const NamedScene scene{"broken", rigid, makeModel<Plain>(flat), translation(0, 0, -2)};
  const auto messageOf = [&](int threads) {
    try {
      scene.run(requestOf(ContinuousQuery::kAll, kNoLimit, 1e-4, threads));
    } catch (const Exception& error) {
      return std::string(error.what());
    }
    return std::string("nothing thrown");
  };
  const std::string message = messageOf(1);
  EXPECT_EQ(message.rfind("o1: vertex ", 0), 0u) << message;
  for (int i = 0; i < 5; ++i)
    for (const int threads : {2, 4, 0}) EXPECT_EQ(messageOf(threads), message) << threads;
  for (const int v : {77, 200, 333, 500}) rigid->vertices[v][2] = 1;
  EXPECT_EQ(messageOf(0), "nothing thrown");
}

/// The end of a query: an answer or an error.
struct Outcome {
  Result result;
  std::string error;

  Outcome(const NamedScene& scene, const Request& request) {
    try {
      result = scene.run(request);
    } catch (const Exception& thrown) {
      error = thrown.what();
    }
  }
};

/// A wavy sheet that comes down on another, with boxes that meet long before they touch.
struct Approach {
  /// The gap between them at one end, and the amount by which it is wider at the other.
  double gap, slope;
  double way;
  /// The height of two vertices of the lower sheet.
  double spike;

  TestMesh upper() const { return sheet(gap, slope); }
  TestMesh lower() const {
    TestMesh mesh = sheet(0, 0);
    Random random(31);
    for (Vector3<double>& p : mesh.vertices) p += random.point(0.003);
    for (int i = 0; i < 2; ++i)
      mesh.vertices[random.index(mesh.vertices.size())].z() += spike;
    return mesh;
  }

 private:
  static TestMesh sheet(double height, double slope) {
    return makeSheet(32, 32, [=](double u, double v) {
      return Vector3<double>(
          u, v, height + slope * u + 0.2 * std::sin(12 * v) * std::cos(12 * u));
    });
  }
};

// Whether a query meets a vertex that is not finite before it has its answer. In the
// first scene few tasks have an answer to kAny. In the second scene errors come earlier
// and later than the first contact.
TEST(FCL_THREADS, errorsWithAnyNumber) {
  const std::pair<ContinuousQuery, std::size_t> kinds[] = {
      {ContinuousQuery::kAll, kNoLimit}, {ContinuousQuery::kAll, 1},
      {ContinuousQuery::kAll, 20},       {ContinuousQuery::kFirst, kNoLimit},
      {ContinuousQuery::kFirst, 2},      {ContinuousQuery::kAny, kNoLimit}};
  for (const Approach& approach : {Approach{0.05, 0, 0.03, 0.05}, {0.2, 0.4, 1, 0}}) {
    const TestMesh upper = approach.upper();
    const auto lower = makeModel<Plain>(approach.lower());
    int failed = 0, answered = 0;
    for (const auto& [query, max_contacts] : kinds)
      for (std::uint64_t seed = 1; seed <= (kHasAddressSanitizer ? 4 : 8); ++seed) {
        const auto rigid = makeModel<Plain>(upper);
        Random random(seed);
        for (int i = 0; i < 2; ++i)
          rigid->vertices[random.index(upper.vertices.size())][1] =
              std::numeric_limits<double>::quiet_NaN();
        const NamedScene scene{"broken", rigid, lower, translation(0, 0, -approach.way)};
        const Outcome one(scene, requestOf(query, max_contacts, 1e-4, 1));
        ++(one.error.empty() ? answered : failed);
        for (int i = 0; i < rounds(3); ++i)
          for (const int threads : numbersOfThreads({2, 4})) {
            SCOPED_TRACE("query " + std::to_string(static_cast<int>(query)) + ", seed " +
                         std::to_string(seed) + ", " + std::to_string(threads) +
                         " threads");
            const Outcome several(scene, requestOf(query, max_contacts, 1e-4, threads));
            ASSERT_EQ(several.error, one.error);
            expectSame(several.result, one.result);
            if (HasFailure()) return;
          }
      }
    EXPECT_GT(failed, kHasAddressSanitizer ? 4 : 8);
    EXPECT_GT(answered, 1);
  }
}

// A query for the first contact fails if a vertex may be in it, but not if its triangles
// come near only later. So does a query for all contacts of which one is kept.
TEST(FCL_THREADS, firstContactBeforeAnError) {
  const TestMesh upper = moved(bentSheet(16), 0, 0, 1);
  const auto lower = makeModel<Plain>(makeSheet(16, 16));
  const auto rigid = makeModel<Plain>(upper);
  const NamedScene scene{"broken", rigid, lower, translation(0, 0, -1.5)};
  const Request request = requestOf(ContinuousQuery::kFirst, kNoLimit, 1e-4, 1);
  const double toc = scene.run(request).time_of_contact;
  const auto lowest =
      std::min_element(upper.vertices.begin(), upper.vertices.end(),
                       [](const auto& x, const auto& y) { return x.z() < y.z(); });
  const std::size_t stride = kHasAddressSanitizer ? 9 : 3;
  for (std::size_t v = 0; v < upper.vertices.size(); v += stride) {
    const double height = upper.vertices[v].z() - lowest->z();
    if (height > 0 && height < 0.15) continue;
    const Vector3<double> place = rigid->vertices[v];
    rigid->vertices[v][1] = std::numeric_limits<double>::quiet_NaN();
    const Outcome outcome(scene, request),
        earliest(scene, requestOf(ContinuousQuery::kAll, 1, 1e-4, 1)),
        all(scene, requestOf(ContinuousQuery::kAll, kNoLimit, 1e-4, 1));
    rigid->vertices[v] = place;
    const std::string error =
        "o1: vertex " + std::to_string(v) + " is not finite. Correct it";
    EXPECT_EQ(all.error, error);
    if (height == 0) {
      EXPECT_EQ(outcome.error, error);
      EXPECT_EQ(earliest.error, error);
    } else {
      EXPECT_EQ(outcome.error, "");
      EXPECT_EQ(outcome.result.time_of_contact, toc);
      EXPECT_EQ(earliest.error, "");
      EXPECT_EQ(earliest.result.time_of_contact, toc);
    }
  }
}

// The same with triangles whose boxes still overlap at the end of the step.
TEST(FCL_THREADS, earliestContactsBeforeAnError) {
  TestMesh wall, upper;
  wall.vertices = {{-4, 0, 0}, {4, 0, 0}, {0, 0, -2}};
  wall.triangles = {Triangle(0, 1, 2)};
  for (int i = 0; i < 40; ++i) {
    const double x = 0.05 * i - 1, z = i == 0 ? 0.5 : 0.6 + 0.005 * i;
    const auto n = upper.vertices.size();
    upper.vertices.insert(upper.vertices.end(),
                          {{x, -0.02, z}, {x + 0.03, -0.02, z}, {x, 0.03, z}});
    upper.triangles.emplace_back(n, n + 1, n + 2);
  }
  const auto rigid = makeModel<Plain>(upper);
  const NamedScene scene{"broken", rigid, makeModel<Plain>(wall), translation(0, 0, -1)};
  const double toc =
      scene.run(requestOf(ContinuousQuery::kFirst, 1, 1e-4, 1)).time_of_contact;
  EXPECT_NEAR(toc, 0.5, 1e-4);
  // Triangle i meets the wall at its height.
  for (const int i : {3, 20, 39}) {
    const Vector3<double> place = rigid->vertices[3 * i];
    rigid->vertices[3 * i][1] = std::numeric_limits<double>::quiet_NaN();
    for (const int threads : {1, 2, 4})
      for (const std::size_t kept : {std::size_t{1}, std::size_t{4}, kNoLimit}) {
        SCOPED_TRACE(std::to_string(i) + ", " + std::to_string(threads) + ", " +
                     std::to_string(kept));
        const Outcome outcome(scene,
                              requestOf(ContinuousQuery::kAll, kept, 1e-4, threads));
        if (kept == kNoLimit) {
          EXPECT_EQ(outcome.error,
                    "o1: vertex " + std::to_string(3 * i) + " is not finite. Correct it");
        } else {
          EXPECT_EQ(outcome.error, "");
          EXPECT_EQ(outcome.result.contacts.size(), kept);
          EXPECT_EQ(outcome.result.time_of_contact, toc);
        }
      }
    rigid->vertices[3 * i] = place;
  }
}

// The caller's floating-point mode does not change the answer, and is the same after the
// call, even if a pose is smaller than the mode can represent.
TEST(FCL_THREADS, callersFloatingPointMode) {
  std::vector<NamedScene> all = scenes();
  TestMesh face, tip;
  face.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  tip.vertices = {{0, 0, -1e-310}, {0.1, 0, -1}, {0, 0.1, -1}};
  face.triangles = tip.triangles = {Triangle(0, 1, 2)};
  all.push_back({"tiny motion", makeModel<Plain>(tip), makeModel<Plain>(face),
                 translation(0, 0, 2e-310)});
  all.push_back({"tiny motion of a deformable model", makeModel<Model>(tip),
                 makeModel<Model>(face), translation(0, 0, 2e-310)});
  for (const NamedScene& scene : all)
    for (const int threads : numbersOfThreads({1, 4, 0})) {
      SCOPED_TRACE(scene.name + ", " + std::to_string(threads) + " threads");
      const Request request = requestOf(ContinuousQuery::kAll, kNoLimit, 1e-4, threads);
      const Result normal = scene.run(request);
      // This does not include the geometry of a contact.
      std::fesetround(FE_UPWARD);
      const Result up = scene.run(request);
      const int after = std::fegetround();
      std::fesetround(FE_TONEAREST);
      EXPECT_EQ(after, FE_UPWARD);
      expectIdentical(up, normal, false);
#ifdef __SSE__
      const unsigned csr = _mm_getcsr();
      _mm_setcsr(csr | 0x8040);  // flush to zero, denormals are zero
      const Result flushed = scene.run(request);
      const unsigned csr_after = _mm_getcsr();
      _mm_setcsr(csr);
      EXPECT_EQ(csr_after & 0xffc0, (csr | 0x8040) & 0xffc0);  // all but sticky flags
      expectIdentical(flushed, normal, false);
#endif
      ASSERT_FALSE(HasFailure());
    }
}

/// A mesh in two frames, large enough for many tasks.
struct Step {
  std::string name;
  TestMesh from, to;

  std::shared_ptr<Model> model(int num_threads) const {
    auto model = std::make_shared<Model>();
    EXPECT_EQ(model->setNumThreads(num_threads), BVH_OK);
    EXPECT_EQ(model->numThreads(), num_threads);
    model->beginModel();
    model->addSubModel(from.vertices, from.triangles);
    EXPECT_EQ(model->endModel(FclTree::kSkip), BVH_OK);
    return model;
  }
  int update(Model& model) const {
    return model.updateFrames(from.vertices[0].data(), to.vertices[0].data(),
                              from.vertices.size());
  }
};

const std::vector<Step>& steps() {
  static const std::vector<Step> all = [] {
    std::vector<Step> out;
    const TestMesh sheet = bentSheet(130);
    out.push_back({"sheet", sheet, shaken(sheet, 0.004, 21)});
    TestMesh mixed = sheet;
    Random random(22);
    for (std::size_t i = mixed.triangles.size(); i > 1; --i)
      std::swap(mixed.triangles[i - 1], mixed.triangles[random.index(i)]);
    out.push_back({"mixed sheet at rest", mixed, mixed});
    // Triangles around a vertex without an order, some with a vertex twice.
    TestMesh tangle = sheet;
    for (Triangle& t : tangle.triangles) {
      std::size_t& v = t[static_cast<int>(random.index(3))];
      v = std::min(v + random.index(4), tangle.vertices.size() - 9);
    }
    out.push_back({"tangle", tangle, shaken(tangle, 0.001, 24)});
    const TestMesh soup = makeTetrahedronSoup(3000, 1, 0.05, 25);
    out.push_back({"soup", soup, shaken(soup, 0.01, 26)});
    out.push_back({"few", bentSheet(2), shaken(bentSheet(2), 0.2, 27)});
    return out;
  }();
  return all;
}

template <typename T>
bool areSame(const T& x, const T& y) {
  return std::memcmp(&x, &y, sizeof(T)) == 0;
}

/// Expects the same structure and boxes, to the bit.
void expectSameModel(const Model& x, const Model& y) {
  const auto &a = x.movingTree(), &b = y.movingTree();
  EXPECT_TRUE(areSame(a.origin(0), b.origin(0)));
  EXPECT_TRUE(areSame(a.origin(1), b.origin(1)));
  EXPECT_EQ(a.largestCoordinate(), b.largestCoordinate());
  ASSERT_EQ(a.numNodes(), b.numNodes());
  for (int i = 0; i < static_cast<int>(a.numNodes()); ++i) {
    const auto &p = a.node(i), &q = b.node(i);
    ASSERT_TRUE(areSame(p.t0, q.t0) && areSame(p.t1, q.t1) &&
                areSame(p.places, q.places) && areSame(p.child, q.child) &&
                p.count == q.count)
        << "node " << i;
  }
  ASSERT_EQ(a.triangles().size(), b.triangles().size());
  for (std::size_t i = 0; i < a.triangles().size(); ++i)
    ASSERT_TRUE(areSame(a.triangles()[i], b.triangles()[i])) << "triangle " << i;
  ASSERT_EQ(a.vertices().size(), b.vertices().size());
  ASSERT_EQ(a.fans().size(), b.fans().size());
  for (std::size_t i = 0; i < a.vertices().size(); ++i) {
    ASSERT_TRUE(areSame(a.vertices()[i], b.vertices()[i])) << "vertex " << i;
    const auto fan_a = a.fans()[i], fan_b = b.fans()[i];
    ASSERT_TRUE(std::equal(fan_a.spokes, fan_a.spokes + fan_a.count, fan_b.spokes,
                           fan_b.spokes + fan_b.count))
        << "vertex " << i;
    ASSERT_EQ(fan_a.is_closed, fan_b.is_closed) << "vertex " << i;
  }
  EXPECT_TRUE(x.aabb_local.min_ == y.aabb_local.min_);
  EXPECT_TRUE(x.aabb_local.max_ == y.aabb_local.max_);
  EXPECT_EQ(x.aabb_radius, y.aabb_radius);
  EXPECT_EQ(x.isDeforming(), y.isDeforming());
}

TEST(FCL_THREADS, sameModelWithAnyNumber) {
  for (const Step& step : steps()) {
    const auto one = step.model(1), still = step.model(1);
    ASSERT_EQ(step.update(*one), BVH_OK);
    const NamedScene scene{step.name, one, nullptr};
    const Request request = requestOf(ContinuousQuery::kAll, kNoLimit, 1e-4, 1);
    const Result expected = scene.run(request);
    for (const int threads : {2, 3, 4, 0, std::numeric_limits<int>::max()}) {
      SCOPED_TRACE(step.name + ", " + std::to_string(threads) + " threads");
      const auto several = step.model(threads);
      expectSameModel(*several, *still);
      ASSERT_EQ(step.update(*several), BVH_OK);
      expectSameModel(*several, *one);
      ASSERT_EQ(step.update(*several), BVH_OK);
      expectSameModel(*several, *one);
      ASSERT_FALSE(HasFailure());
      if (threads == 2)
        expectSame(NamedScene{step.name, several, nullptr}.run(request), expected);
    }
  }
}

TEST(FCL_THREADS, modelRefusesANegativeNumber) {
  const auto model = steps().back().model(2);
  for (const int threads : {-1, std::numeric_limits<int>::min()}) {
    EXPECT_EQ(model->setNumThreads(threads), BVH_ERR_INCORRECT_DATA);
    EXPECT_EQ(model->lastError(),
              std::to_string(threads) + " is not a number of threads. Give 0 or more");
    EXPECT_EQ(model->numThreads(), 2);
  }
  EXPECT_EQ(model->setNumThreads(0), BVH_OK);
  EXPECT_EQ(model->lastError(), "");
}

// The error names the first of several vertices, whichever thread finds one.
TEST(FCL_THREADS, firstVertexThatIsNotFinite) {
  Step step = steps().front();
  for (const int threads : {1, 2, 4, 0}) {
    const auto model = step.model(threads);
    TestMesh& to = step.to;
    for (const std::size_t first : {16000U, 9001U, 8192U, 8191U, 5000U, 0U}) {
      to.vertices[first][first % 3] = std::numeric_limits<double>::quiet_NaN();
      EXPECT_EQ(step.update(*model), BVH_ERR_INCORRECT_DATA);
      EXPECT_EQ(model->lastError(), "vertex " + std::to_string(first) +
                                        " of the current frame is not finite");
    }
    to = steps().front().to;
    EXPECT_EQ(step.update(*model), BVH_OK);
  }
}

TEST(FCL_THREADS, modelInCallersFloatingPointMode) {
  for (const Step& step : steps())
    for (const int threads : {1, 4}) {
      SCOPED_TRACE(step.name + ", " + std::to_string(threads) + " threads");
      const auto normal = step.model(threads);
      ASSERT_EQ(step.update(*normal), BVH_OK);
      std::fesetround(FE_UPWARD);
      const auto up = step.model(threads);
      const int code = step.update(*up), after = std::fegetround();
      std::fesetround(FE_TONEAREST);
      EXPECT_EQ(code, BVH_OK);
      EXPECT_EQ(after, FE_UPWARD);
      expectSameModel(*up, *normal);
      ASSERT_FALSE(HasFailure());
    }
}

#ifdef FCL_CCD_USE_TBB

/// Ends oneTBB's workers with the tests: one that still rests in an arena when the
/// process ends keeps what oneTBB has made for a watcher of that arena (a leak to
/// sanitizers).
class Workers : public ::testing::Environment {
 public:
  void SetUp() override { handle_ = tbb::task_scheduler_handle(tbb::attach{}); }
  void TearDown() override { EXPECT_TRUE(tbb::finalize(handle_, std::nothrow)); }

 private:
  tbb::task_scheduler_handle handle_;
};

const ::testing::Environment* const kWorkers =
    ::testing::AddGlobalTestEnvironment(new Workers);

/// The threads that work in an arena.
class Watcher : public tbb::task_scheduler_observer {
 public:
  explicit Watcher(tbb::task_arena& arena) : tbb::task_scheduler_observer(arena) {
    observe(true);
  }
  ~Watcher() override { observe(false); }
  void on_scheduler_entry(bool) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    threads_.insert(std::this_thread::get_id());
    most_ = std::max(most_, ++now_);
  }
  void on_scheduler_exit(bool) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    --now_;
  }
  /// All threads that worked there, and the largest number at the same time.
  std::set<std::thread::id> threads() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return threads_;
  }
  int most() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return most_;
  }

 private:
  std::mutex mutex_;
  std::set<std::thread::id> threads_;
  int now_{0}, most_{0};
};

/// Runs every scene and query in an arena.
void runAll(tbb::task_arena& arena, int num_threads) {
  for (const NamedScene& scene : scenes())
    for (const ContinuousQuery query : kQueries) {
      Result result;
      const Request request = requestOf(query, kNoLimit, 1e-4, num_threads);
      arena.execute([&] { result = scene.run(request); });
      expectSame(result, scene.run(requestOf(query, kNoLimit, 1e-4, 1)));
    }
}

/// The threads that enter an arena of this size during the queries.
std::set<std::thread::id> threadsOfQuery(int arena_threads, int num_threads) {
  tbb::task_arena arena(arena_threads);
  Watcher watcher(arena);
  runAll(arena, num_threads);
  return watcher.threads();
}

/// The same while models are built and updated.
std::set<std::thread::id> threadsOfModels(int arena_threads, int num_threads) {
  tbb::task_arena arena(arena_threads);
  Watcher watcher(arena);
  arena.execute([&] {
    for (const Step& step : steps()) {
      const auto model = step.model(num_threads);
      EXPECT_EQ(step.update(*model), BVH_OK);
    }
  });
  return watcher.threads();
}

/// Does something until two threads were seen. On a machine that is busy a worker may
/// come late.
/// @param seen  the number of threads that were seen so far
template <typename Seen, typename Do>
void repeatUntilTwo(const Seen& seen, const Do& act) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  do {
    act();
  } while (seen() < 2 && std::chrono::steady_clock::now() < end);
}

std::set<std::thread::id> justThisOne() { return {std::this_thread::get_id()}; }

TEST(FCL_THREADS, oneThreadMakesNoTasks) {
  EXPECT_EQ(threadsOfQuery(4, 1), justThisOne());
  EXPECT_EQ(threadsOfModels(4, 1), justThisOne());
}

TEST(FCL_THREADS, arenaOfOneIsRespected) {
  for (const int threads : numbersOfThreads({0, 1, 2, 4})) {
    EXPECT_EQ(threadsOfQuery(1, threads), justThisOne()) << threads;
    EXPECT_EQ(threadsOfModels(1, threads), justThisOne()) << threads;
  }
}

TEST(FCL_THREADS, modelsUseThreads) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core";
  std::size_t most = 0;
  repeatUntilTwo([&] { return most; },
                 [&] { most = std::max(most, threadsOfModels(2, 0).size()); });
  EXPECT_EQ(most, 2U);
}

// With so few vertices, everything but the tree is one task.
TEST(FCL_THREADS, updatesOfTreesUseThreads) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core";
  const TestMesh sheet = bentSheet(80);
  const Step step{"sheet", sheet, shaken(sheet, 0.004, 28)};
  const auto model = step.model(1);
  EXPECT_EQ(model->setNumThreads(2), BVH_OK);
  tbb::task_arena arena(2);
  Watcher watcher(arena);
  repeatUntilTwo([&] { return watcher.most(); },
                 [&] { arena.execute([&] { EXPECT_EQ(step.update(*model), BVH_OK); }); });
  EXPECT_EQ(watcher.most(), 2);
}

TEST(FCL_THREADS, arenaOfTwoIsRespected) {
  tbb::task_arena arena(2);
  Watcher watcher(arena);
  repeatUntilTwo([&] { return watcher.most(); }, [&] { runAll(arena, 0); });
  EXPECT_LE(watcher.most(), 2);
  if (std::thread::hardware_concurrency() > 1) {
    EXPECT_EQ(watcher.most(), 2) << "threads are not used at all";
  }
}

// A thread that waits in a query does not run other tasks of the caller, which may need
// what the caller holds.
TEST(FCL_THREADS, callersOtherTasksWait) {
  const NamedScene& scene = scenes().front();
  const Request request = requestOf(ContinuousQuery::kAll, kNoLimit, 1e-4, 0);
  tbb::task_arena arena(4);
  std::mutex mutex;
  int done = 0;
  thread_local bool is_querying = false;
  std::atomic<bool> nested{false};
  arena.execute([&] {
    tbb::task_group group;
    for (int i = 0; i < 24; ++i)
      group.run([&] {
        if (is_querying) {
          nested = true;
          return;
        }
        const std::lock_guard<std::mutex> lock(mutex);
        is_querying = true;
        scene.run(request);
        is_querying = false;
        ++done;
      });
    group.wait();
  });
  EXPECT_FALSE(nested);
  EXPECT_EQ(done, 24);
}

// This test is the last one: after many arenas within an arena, oneTBB 2021.8 may send no
// worker to others for a while, and other tests wait for workers.
TEST(FCL_THREADS, twoThreadsInAnArenaOfFour) {
  tbb::task_arena arena(4);
  Watcher watcher(arena);
  runAll(arena, 2);
  arena.execute([&] {
    for (const Step& step : steps()) {
      const auto one = step.model(1), two = step.model(2);
      EXPECT_EQ(step.update(*one), BVH_OK);
      EXPECT_EQ(step.update(*two), BVH_OK);
      expectSameModel(*two, *one);
    }
  });
  EXPECT_EQ(watcher.threads(), justThisOne()) << "they have an arena of their own";
}

#endif  // FCL_CCD_USE_TBB

}  // namespace
}  // namespace test
}  // namespace fcl
