// SPDX-License-Identifier: BSD-3-Clause
//
// Models that are kept from step to step against models that are built anew, and models
// that several threads query at the same time against one thread. Answers are the same to
// the bit.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "mesh_query.h"
#include "minimise.h"

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

/// The mesh of a step, and how the model gets it.
struct Step {
  MovingMesh mesh;
  /// Whether the topology changes too, with this hint.
  bool is_topology{false};
  std::vector<int> origins;
  Ask ask;
};

/// A model that takes all steps.
struct Sequence {
  /// The question; its first mesh is that of the step.
  MeshCase what;
  std::vector<Step> steps;
};

/// Compares the model with a new one in each step, until they differ.
Outcome checked(const Sequence& sequence) {
  Outcome outcome;
  MeshCase what = sequence.what;
  const auto a = makeFuzzModel(sequence.steps.front().mesh);
  const auto b = what.b ? makeFuzzModel(*what.b) : nullptr;
  for (std::size_t i = 0; i < sequence.steps.size() && outcome.isRight(); ++i) {
    const Step& step = sequence.steps[i];
    what.a = step.mesh;
    if (i > 0 && step.is_topology)
      updateTopology(*a, what.a, step.origins);
    else if (i > 0)
      updateFrames(*a, what.a);
    const MeshAnswer kept = askModels(*a, b.get(), what, step.ask, outcome);
    outcome.contacts += kept.contacts.size();
    expectSame(kept, fresh(what, step.ask, outcome), "kept model", outcome);
  }
  return outcome;
}

/// Steps that no longer fit each other are refused: that is no fault of the model.
bool stillFails(const Sequence& sequence) {
  if (sequence.steps.empty() || sequence.steps.front().mesh.triangles.empty())
    return false;
  try {
    return !checked(sequence).isRight();
  } catch (const std::exception&) {
    return false;
  }
}

/// Removes steps; and triangles, if all steps have the same ones.
void minimiseSequence(Sequence& sequence) {
  minimise(sequence.steps, [&] { return stillFails(sequence); });
  for (std::size_t i = 1; i < sequence.steps.size(); ++i)
    if (sequence.steps[i].is_topology) return;
  std::vector<Triangle> triangles = sequence.steps.front().mesh.triangles;
  const auto give = [&] {
    for (Step& step : sequence.steps) step.mesh.triangles = triangles;
  };
  minimise(triangles, [&] {
    give();
    return stillFails(sequence);
  });
  give();
}

std::string asTest(const Sequence& sequence) {
  std::ostringstream out;
  out << "  // test/unit/test_fcl_topology_change.cpp\n";
  for (std::size_t i = 0; i < sequence.steps.size(); ++i) {
    const Step& step = sequence.steps[i];
    const std::string name = "step_" + std::to_string(i);
    out << asCode(step.mesh, name);
    if (i == 0)
      out << "  auto model = modelOf(" << name << ");\n";
    else if (step.is_topology)
      out << "  model->updateTopology(" << name << ".triangles, {";
    else
      out << "  model->updateFrames(";
    if (i > 0 && step.is_topology) {
      for (const int origin : step.origins) out << origin << ", ";
      out << "}, ";
    }
    if (i > 0)
      out << name << ".previous(), " << name << ".current(), " << name
          << ".t0.size());\n";
  }
  if (sequence.what.b) out << asCode(*sequence.what.b, "other");
  out << "  // Compare with a new model of the last step, min_distance "
      << sequence.what.min_distance << ".\n";
  return out.str();
}

Outcome answered(Sequence sequence) {
  Outcome outcome = checked(sequence);
  if (outcome.isRight() || plantedFault() != PlantedFault::kNone) return outcome;
  minimiseSequence(sequence);
  outcome.complaint = checked(sequence).complaint + asTest(sequence);
  return outcome;
}

/// The model is updated by frames, the reference is built from them.
Outcome keptModels(std::uint64_t seed) {
  constexpr int kLengths[] = {5, 10, 20, 40, 500};
  Random random(seed);
  Sequence sequence;
  const int frames = kLengths[random.index(random.index(16) ? 4 : 5)];
  // Long sequences of large meshes take minutes.
  const std::size_t most = frames > 100 ? 24 : random.index(8) ? 40 : 400;
  MovingMesh mesh = randomFuzzMesh(random, most);
  sequence.what.min_distance = random.index(4) ? 0 : 0.02;
  const double size = std::pow(10, random.uniform(-3, -0.7));
  for (int i = 0; i < frames; ++i) {
    if (i > 0) advance(mesh, random, size);
    Step step{mesh, false, {}, {}};
    if (random.index(4) == 0) step.ask.query = Ask::Query::kFirst;
    sequence.steps.push_back(step);
  }
  return answered(std::move(sequence));
}

/// Tears a corner off, cuts or removes triangles, or adds some.
void changeTopology(MovingMesh& mesh, std::vector<int>& origins, Random& random) {
  origins.resize(mesh.triangles.size());
  for (std::size_t i = 0; i < origins.size(); ++i) origins[i] = static_cast<int>(i);
  for (std::size_t n = 1 + random.index(4); n > 0; --n) {
    const std::size_t i = random.index(mesh.triangles.size());
    Triangle& t = mesh.triangles[i];
    const std::size_t id[3] = {t[0], t[1], t[2]};
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
  Sequence sequence;
  MovingMesh mesh = randomFuzzMesh(random, random.index(8) ? 40 : 300);
  if (random.index(2)) sequence.what.b = randomFuzzMesh(random, 40);
  sequence.what.min_distance = random.index(4) ? 0 : 0.02;
  const double size = std::pow(10, random.uniform(-3, -0.7));
  for (int i = 0; i < kSteps; ++i) {
    Step step;
    step.is_topology = i > 0 && random.index(4) != 0;
    if (step.is_topology) {
      changeTopology(mesh, step.origins, random);
      for (Vec& p : mesh.t1) p += random.point(size);
      // Without a hint.
      if (random.index(8) == 0) step.origins.clear();
    } else if (i > 0) {
      advance(mesh, random, size);
    }
    step.mesh = mesh;
    sequence.steps.push_back(step);
  }
  return answered(std::move(sequence));
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
