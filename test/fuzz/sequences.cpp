// SPDX-License-Identifier: BSD-3-Clause
//
// Models that are kept from step to step against models that are built anew, and models
// that several threads query at the same time against one thread. Answers are the same to
// the bit.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <thread>

#include "mesh_query.h"

namespace fcl {
namespace test {
namespace {

using Vec = Vector3<double>;

/// Blames all differences of two answers.
void expectSame(const MeshAnswer& found, const MeshAnswer& truth, const char* tells,
                Outcome& outcome) {
  expectSameContacts(found.contacts, truth.contacts, true, tells, outcome);
  if (found.is_crossing != truth.is_crossing)
    outcome.blame(&Outcome::missed, std::string(tells) + ": another crossing\n");
  if (found.time != truth.time)
    outcome.blame(found.time > truth.time ? &Outcome::late : &Outcome::early,
                  std::string(tells) + ": another time\n");
  if (outcome.isRight() && !(found == truth))
    outcome.blame(&Outcome::early, std::string(tells) + ": another order\n");
}

/// The answer of models that are new, without a planted fault.
MeshAnswer fresh(const MeshCase& what, const Ask& ask, Outcome& outcome) {
  const auto a = makeFuzzModel(what.a);
  const auto b = what.b ? makeFuzzModel(*what.b) : nullptr;
  return askUnplanted(*a, b.get(), what, ask, outcome);
}

/// The next frame: waves, a common motion, and now and then a part that flies away.
void advance(MovingMesh& mesh, Random& random, double size) {
  mesh.t0 = mesh.t1;
  const Vec way = random.point(0.3 * size);
  const bool flies = random.index(20) == 0;
  const std::size_t first = random.index(mesh.t1.size());
  for (std::size_t i = 0; i < mesh.t1.size(); ++i) {
    Vec& p = mesh.t1[i];
    p += way + random.point(size);
    if (flies && i >= first) p += Vec(1, 0.5, 0);
    // Points come back, so that the mesh stays dense.
    p *= 0.98;
  }
}

std::string stepText(int step, std::uint64_t seed, const MeshCase& what) {
  std::ostringstream out;
  out << "step " << step << " of the sequence with Random random(" << seed
      << "U), test/fuzz/sequences.cpp; a new model of its frames:\n"
      << asTest(what, "");
  return out.str();
}

/// The model is updated by frames, the reference is built from them.
Outcome keptModels(std::uint64_t seed) {
  constexpr int kLengths[] = {5, 10, 20, 40, 500};
  Random random(seed);
  Outcome outcome;
  MeshCase what;
  what.a = randomFuzzMesh(random, random.index(8) ? 40 : 400);
  what.min_distance = random.index(4) ? 0 : 0.02;
  const int frames = kLengths[random.index(random.index(16) ? 4 : 5)];
  const double size = std::pow(10, random.uniform(-3, -0.7));
  const auto model = makeFuzzModel(what.a);
  Ask ask;
  for (int step = 0; step < frames && outcome.isRight(); ++step) {
    if (step > 0) {
      advance(what.a, random, size);
      updateFrames(*model, what.a);
    }
    ask.query = random.index(4) ? Ask::Query::kAll : Ask::Query::kFirst;
    const MeshAnswer kept = askModels(*model, nullptr, what, ask, outcome);
    outcome.contacts += kept.contacts.size();
    expectSame(kept, fresh(what, ask, outcome), "kept model", outcome);
    if (!outcome.isRight()) outcome.complaint += stepText(step, seed, what);
  }
  return outcome;
}

/// Tears a corner off, cuts or removes triangles, or adds some.
void changeTopology(MovingMesh& mesh, std::vector<int>& origins, Random& random) {
  origins.resize(mesh.triangles.size());
  for (std::size_t i = 0; i < origins.size(); ++i) origins[i] = static_cast<int>(i);
  for (std::size_t n = 1 + random.index(4); n > 0; --n) {
    const std::size_t i = random.index(mesh.triangles.size());
    Triangle& t = mesh.triangles[i];
    std::size_t id[3] = {t[0], t[1], t[2]};
    const std::size_t k = random.index(3), kind = random.index(5);
    if (kind < 2) {
      // A new vertex: at the corner, or in the middle of the triangle.
      Vec p = mesh.t1[id[k]];
      if (kind == 1) p = (mesh.t1[id[0]] + mesh.t1[id[1]] + mesh.t1[id[2]]) / 3;
      const std::size_t m = mesh.t1.size();
      mesh.t1.push_back(p);
      const std::size_t a = id[(k + 1) % 3], b = id[(k + 2) % 3], c = id[k];
      t = Triangle(a, b, m);
      if (kind == 1) {
        mesh.triangles.emplace_back(b, c, m);
        mesh.triangles.emplace_back(c, a, m);
        origins.insert(origins.end(), 2, origins[i]);
      }
    } else if (kind == 2 && mesh.triangles.size() > 3) {
      mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(i));
      origins.erase(origins.begin() + static_cast<std::ptrdiff_t>(i));
    } else if (kind == 3) {
      mesh.triangles.emplace_back(id[0], random.index(mesh.t1.size()),
                                  random.index(mesh.t1.size()));
      origins.push_back(-1);
    } else {
      // A hint that says nothing, or something wrong.
      origins[i] = static_cast<int>(random.index(2)) - 1;
    }
  }
  mesh.t0 = mesh.t1;
}

Outcome topologies(std::uint64_t seed) {
  constexpr int kSteps = 20;
  Random random(seed);
  Outcome outcome;
  MeshCase what;
  what.a = randomFuzzMesh(random, random.index(8) ? 40 : 300);
  if (random.index(2)) what.b = randomFuzzMesh(random, 40);
  what.min_distance = random.index(4) ? 0 : 0.02;
  const double size = std::pow(10, random.uniform(-3, -0.7));
  const auto a = makeFuzzModel(what.a);
  const auto b = what.b ? makeFuzzModel(*what.b) : nullptr;
  std::vector<int> origins;
  for (int step = 0; step < kSteps && outcome.isRight(); ++step) {
    if (step > 0 && random.index(4) != 0) {
      what.a.t0 = what.a.t1;
      changeTopology(what.a, origins, random);
      for (Vec& p : what.a.t1) p += random.point(size);
      if (random.index(8) == 0) origins.clear();
      updateTopology(*a, what.a, origins);
    } else if (step > 0) {
      advance(what.a, random, size);
      updateFrames(*a, what.a);
    }
    const MeshAnswer kept = askModels(*a, b.get(), what, {}, outcome);
    outcome.contacts += kept.contacts.size();
    expectSame(kept, fresh(what, {}, outcome), "changed model", outcome);
    if (!outcome.isRight()) outcome.complaint += stepText(step, seed, what);
  }
  return outcome;
}

/// Two to four threads ask all kinds of queries of the same models.
Outcome sharedModels(std::uint64_t seed) {
  constexpr int kRounds = 3;
  Random random(seed);
  const MeshCase what = randomMeshCase(random);
  const auto a = makeFuzzModel(what.a);
  const auto b = what.b ? makeFuzzModel(*what.b) : nullptr;
  Outcome outcome;
  Ask asks[3];
  asks[1].query = Ask::Query::kFirst;
  asks[2].query = Ask::Query::kAny;
  std::vector<MeshAnswer> truth;
  for (const Ask& ask : asks) truth.push_back(fresh(what, ask, outcome));
  outcome.contacts = truth[0].contacts.size();
  std::vector<Outcome> found(2 + random.index(3));
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < found.size(); ++i)
    threads.emplace_back([&, i] {
      for (std::size_t n = 0; n < 3 * kRounds; ++n) {
        const std::size_t k = (n + i) % 3;
        Ask ask = asks[k];
        ask.num_threads = n % 2 ? 2 : 1;
        expectSame(askModels(*a, b.get(), what, ask, found[i]), truth[k],
                   "several threads", found[i]);
      }
    });
  for (std::thread& thread : threads) thread.join();
  for (const Outcome& one : found) {
    outcome.missed += one.missed;
    outcome.late += one.late;
    outcome.invented += one.invented;
    outcome.early += one.early;
    outcome.slowest_us = std::max(outcome.slowest_us, one.slowest_us);
    if (!one.isRight()) outcome.complaint = one.complaint + asTest(what, "");
  }
  return outcome;
}

const RegisteredFamily kKept("kept-models", keptModels);
const RegisteredFamily kTopologies("topologies", topologies);
const RegisteredFamily kShared("shared-models", sharedModels);

}  // namespace
}  // namespace test
}  // namespace fcl
