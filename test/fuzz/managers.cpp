// SPDX-License-Identifier: BSD-3-Clause
//
// The continuous manager on random scenes of objects of all kinds that come, go and move,
// with filters and thicknesses, against the queries of all pairs.
#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "family.h"
#include "manager_scenes.h"
#include "minimise.h"

namespace fcl {
namespace test {
namespace {

using Object = ContinuousCollisionObject<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
using Answer = ContinuousManagerResult<double>;
using Pair = std::pair<const Object*, const Object*>;

struct PairTruth {
  Result all;
  /// The time of a query for the first contact of this pair.
  double first;
};
using Truth = std::map<Pair, PairTruth>;

/// A distance is for straight paths.
Request randomRequest(Random& random, bool is_straight) {
  Request request;
  if (is_straight && random.index(2) == 0) request.min_distance = .05;
  if (random.index(4) == 0) request.t_max = .6;
  if (random.index(2) == 0) request.num_threads = 2;
  return request;
}

Result askPair(const ManagerScene& scene, const Object* a, const Object* b,
               Request request) {
  request.num_threads = 1;
  request.filter1 = scene.filterOf(a);
  request.filter2 = scene.filterOf(b);
  request.min_distance += scene.distanceOf(a, b);
  Result result;
  if (a == b) {
    // A mesh is tested with itself whatever its own group and mask are.
    request.filter1.group = ContinuousFilter().group;
    request.filter1.mask = ContinuousFilter().mask;
    continuousSelfCollide(a->collisionGeometry().get(), request, result);
  } else {
    fcl::collide(a, b, request, result);
  }
  return result;
}

Truth bruteForce(const ManagerScene& scene, const std::vector<Object*>& objects,
                 Request request) {
  Truth truth;
  const auto add = [&](const Object* a, const Object* b) {
    request.query = ContinuousQuery::kAll;
    Result all = askPair(scene, a, b, request);
    if (!all.is_collide) return;
    request.query = ContinuousQuery::kFirst;
    truth[{a, b}] = {std::move(all), askPair(scene, a, b, request).time_of_contact};
  };
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i] == scene.objects[0]) add(objects[i], objects[i]);
    for (std::size_t k = i + 1; k < objects.size(); ++k) add(objects[i], objects[k]);
  }
  return truth;
}

Answer askManager(const ManagerScene& scene, Request request, ContinuousQuery query,
                  Outcome& outcome) {
  request.query = query;
  Answer answer;
  outcome.timed([&] {
    scene.manager.collide(request, answer);
    return 0;
  });
  for (const auto& pair : answer.pairs) outcome.addToDigest(pair.result.time_of_contact);
  if (plantedFault() == PlantedFault::kDropped && !answer.pairs.empty())
    answer.pairs.pop_back();
  if (plantedFault() == PlantedFault::kLate) {
    answer.time_of_contact += 0.01;
    for (auto& pair : answer.pairs) pair.result.time_of_contact += 0.01;
  }
  return answer;
}

/// Blames a time that is not the same to the bit.
void expectTime(double time, double truth, const char* query, Outcome& outcome) {
  if (time == truth) return;
  outcome.blame(time > truth ? &Outcome::late : &Outcome::early,
                std::string(query) + ": another time\n");
}

bool sameContacts(const Result& x, const Result& y) {
  return x.initially_crossing == y.initially_crossing &&
         std::equal(x.contacts.begin(), x.contacts.end(), y.contacts.begin(),
                    y.contacts.end(), [](const auto& a, const auto& b) {
                      return nameOf(a) == nameOf(b) && a.b1 == b.b1 && a.b2 == b.b2 &&
                             a.toc_lo == b.toc_lo && a.toc_hi == b.toc_hi;
                    });
}

void expectAll(const Answer& answer, const Truth& truth, Outcome& outcome) {
  std::set<Pair> found;
  double time = 0;
  for (const auto& pair : answer.pairs) {
    const auto expected = truth.find({pair.o1, pair.o2});
    if (expected == truth.end() || !found.insert({pair.o1, pair.o2}).second) {
      outcome.blame(&Outcome::invented, "all: a pair that is not in contact\n");
      continue;
    }
    const Result& all = expected->second.all;
    expectTime(pair.result.time_of_contact, all.time_of_contact, "all", outcome);
    if (!sameContacts(pair.result, all))
      outcome.blame(&Outcome::missed, "all: other contacts of a pair\n");
    if (pair.result.time_of_contact < time)
      outcome.blame(&Outcome::early, "all: pairs are not in order\n");
    time = pair.result.time_of_contact;
  }
  for (const auto& entry : truth)
    if (found.count(entry.first) == 0)
      outcome.blame(&Outcome::missed, "all: a pair is missing\n");
}

void expectFirst(const Answer& answer, const Truth& truth, Outcome& outcome) {
  double first = 1;
  for (const auto& entry : truth) first = std::min(first, entry.second.first);
  expectTime(answer.time_of_contact, first, "first", outcome);
  if (answer.pairs.size() != (truth.empty() ? 0U : 1U))
    outcome.blame(truth.empty() ? &Outcome::invented : &Outcome::missed,
                  "first: another number of pairs\n");
  for (const auto& pair : answer.pairs) {
    const auto expected = truth.find({pair.o1, pair.o2});
    if (expected == truth.end() || expected->second.first != first)
      outcome.blame(&Outcome::invented, "first: a pair that is not the first\n");
  }
}

void expectAny(const Answer& answer, const Truth& truth, Outcome& outcome) {
  if (answer.is_collide == truth.empty() ||
      answer.pairs.size() != (truth.empty() ? 0U : 1U))
    outcome.blame(truth.empty() ? &Outcome::invented : &Outcome::missed,
                  "any: another decision\n");
  for (const auto& pair : answer.pairs)
    if (truth.count({pair.o1, pair.o2}) == 0)
      outcome.blame(&Outcome::invented, "any: a pair that is not in contact\n");
}

void expectAnswers(const ManagerScene& scene, const std::vector<Object*>& objects,
                   const Request& request, Outcome& outcome) {
  const Truth truth = bruteForce(scene, objects, request);
  outcome.contacts += truth.size();
  const auto ask = [&](ContinuousQuery query) {
    return askManager(scene, request, query, outcome);
  };
  expectAll(ask(ContinuousQuery::kAll), truth, outcome);
  expectFirst(ask(ContinuousQuery::kFirst), truth, outcome);
  expectAny(ask(ContinuousQuery::kAny), truth, outcome);
}

/// The objects that are left when no further one can be taken out of the manager.
std::string fewestObjects(ManagerScene& scene, const Request& request) {
  std::vector<Object*> left = scene.objects;
  std::vector<Object*> in_manager = left;
  minimise(left, [&] {
    // In their order: the first object of a pair is the one that came first.
    for (Object* object : in_manager) scene.manager.unregisterObject(object);
    in_manager = left;
    for (Object* object : left) {
      scene.manager.registerObject(object);
      scene.manager.setFilter(object, scene.filterOf(object));
      if (scene.thickness.count(object))
        scene.manager.setThickness(object, scene.thickness[object]);
      if (object == scene.objects[0]) scene.manager.setSelfCollision(object, true);
    }
    Outcome outcome;
    expectAnswers(scene, left, request, outcome);
    return !outcome.isRight();
  });
  std::ostringstream out;
  out << "objects that are left, by number and node type:";
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    if (std::count(left.begin(), left.end(), scene.objects[i]))
      out << " " << i << " (" << scene.objects[i]->collisionGeometry()->getNodeType()
          << ")";
  return out.str() + "\n";
}

Outcome managers(std::uint64_t seed) {
  constexpr std::size_t kCounts[] = {2, 4, 8, 8, 16, 16, 30};
  constexpr int kSteps = 3;
  Random random(seed);
  const std::size_t count = 2 + random.index(kCounts[random.index(7)]),
                    flats = random.index(4) == 0 ? 15 : 0;
  const double spacing = random.index(2) ? 1 : 0.6;
  const bool is_thick = random.index(2);
  ManagerScene scene(random, count, flats, spacing);
  if (is_thick) scene.addThickness(false);
  Outcome outcome;
  for (int step = 0; step < kSteps && outcome.isRight(); ++step) {
    if (step > 0) scene.change();
    const Request request = randomRequest(random, scene.is_straight);
    expectAnswers(scene, scene.objects, request, outcome);
    if (outcome.isRight() || plantedFault() != PlantedFault::kNone) continue;
    std::ostringstream test;
    test << "  // test/unit/test_fcl_manager_scenes.cpp\n  // draw as managers() of "
            "test/fuzz/managers.cpp does, up to step "
         << step << "\n  Random random(" << seed << "U);\n";
    outcome.complaint += fewestObjects(scene, request) + test.str();
  }
  return outcome;
}

const RegisteredFamily kManagers("managers", managers);

}  // namespace
}  // namespace test
}  // namespace fcl
