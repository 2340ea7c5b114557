// SPDX-License-Identifier: BSD-3-Clause
//
// Mesh cases in other forms, whose contacts follow from those of the first form. Nothing
// but the library's answers is compared, so that faults of the brute force stay out.
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "mesh_forms.h"
#include "mesh_query.h"

namespace fcl {
namespace test {
namespace {

using Contacts = std::vector<NamedBracket>;

Contacts contactsOf(const MeshCase& what, Outcome& outcome, int num_threads = 1) {
  Ask ask;
  ask.num_threads = num_threads;
  return askCase(what, ask, outcome).contacts;
}

/// Times that say nothing: only the pairs are compared.
Contacts withoutTimes(Contacts contacts) {
  for (NamedBracket& c : contacts) c.toc_lo = c.toc_hi = 0;
  return contacts;
}

void expectReversed(const MeshCase& what, const Contacts& truth, Outcome& outcome) {
  const MeshCase back =
      changed(what, [](MovingMesh& mesh) { std::swap(mesh.t0, mesh.t1); });
  expectSameContacts(withoutTimes(contactsOf(back, outcome)), withoutTimes(truth), true,
                     "time reversed", outcome);
}

void expectSwapped(const MeshCase& what, const Contacts& truth, Outcome& outcome) {
  if (!what.b) return;
  MeshCase other = what;
  std::swap(other.a, *other.b);
  Contacts found = contactsOf(other, outcome);
  for (NamedBracket& c : found) {
    ContactId& id = c.id;
    const bool is_edges = id[3] >= 0;
    if (is_edges) {
      std::swap(id[2], id[4]);
      std::swap(id[3], id[5]);
    } else {
      id[1] = !id[1];
    }
  }
  expectSameContacts(found, truth, false, "objects swapped", outcome);
}

void expectMoved(const MeshCase& what, const Contacts& truth, Random& random,
                 Outcome& outcome) {
  const double far = std::ldexp(1, static_cast<int>(random.index(30)));
  const Vector3<double> shift(far, -2 * far, 0.5);
  expectSameContacts(contactsOf(mappedScene(what,
                                            [&](const Vector3<double>& p) {
                                              return Vector3<double>(p + shift);
                                            }),
                                outcome),
                     truth, false, "moved", outcome);
}

void expectScaled(const MeshCase& what, const Contacts& truth, Random& random,
                  Outcome& outcome) {
  const double scale = std::ldexp(1, static_cast<int>(random.index(121)) - 60);
  const MeshCase other = mappedScene(
      what, [scale](const Vector3<double>& p) { return Vector3<double>(scale * p); });
  expectSameContacts(contactsOf(other, outcome), truth, true, "scaled", outcome);
}

/// A half of the step: 0 or 1.
MovingMesh half(const MovingMesh& mesh, int which) {
  MovingMesh out = mesh;
  auto& middle = which == 0 ? out.t1 : out.t0;
  for (std::size_t i = 0; i < middle.size(); ++i)
    middle[i] = (mesh.t0[i] + mesh.t1[i]) / 2;
  return out;
}

void expectHalves(const MeshCase& what, const Contacts& truth, Outcome& outcome) {
  Contacts all;
  for (const int which : {0, 1}) {
    const MeshCase part =
        changed(what, [which](MovingMesh& mesh) { mesh = half(mesh, which); });
    for (NamedBracket c : contactsOf(part, outcome)) {
      c.toc_lo = (c.toc_lo + which) / 2;
      c.toc_hi = (c.toc_hi + which) / 2;
      all.push_back(c);
    }
  }
  // Of the two times of a pair the first one counts.
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end(),
                        [](const NamedBracket& x, const NamedBracket& y) {
                          return x.id == y.id;
                        }),
            all.end());
  expectSameContacts(all, truth, false, "cut at 1/2", outcome);
}

/// Whether a triangle has a feature: a face, as it is sorted in a ContactId, or an edge
/// or a vertex with -1 after its last id.
bool hasFeature(const MovingMesh& mesh, const std::array<int, 3>& feature) {
  return std::any_of(
      mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
        std::array<int, 3> ids = {static_cast<int>(t[0]), static_cast<int>(t[1]),
                                  static_cast<int>(t[2])};
        std::sort(ids.begin(), ids.end());
        if (feature[2] >= 0) return ids == feature;
        return std::all_of(feature.begin(), feature.end(), [&ids](int id) {
          return id < 0 || std::count(ids.begin(), ids.end(), id) > 0;
        });
      });
}

void expectSubset(const MeshCase& what, const Contacts& truth, Random& random,
                  Outcome& outcome) {
  const MeshCase part = changed(what, [&random](MovingMesh& mesh) {
    for (std::size_t n = mesh.triangles.size() / 2; n > 0; --n)
      mesh.triangles.erase(
          mesh.triangles.begin() +
          static_cast<std::ptrdiff_t>(random.index(mesh.triangles.size())));
  });
  const Contacts found = contactsOf(part, outcome);
  Contacts same;
  for (const NamedBracket& c : truth)
    if (hasFeature(c.id[1] != 0 ? part.a : part.other(), {c.id[2], c.id[3], -1}) &&
        hasFeature(c.id[1] != 0 ? part.other() : part.a, {c.id[4], c.id[5], c.id[6]}))
      same.push_back(c);
  expectSameContacts(found, same, false, "subset of triangles", outcome);
}

void expectPermuted(const MeshCase& what, const Contacts& truth, Random& random,
                    Outcome& outcome) {
  MeshCase other = changed(what, [&random](MovingMesh& mesh) {
    shuffle(mesh.triangles, random);
    for (Triangle& t : mesh.triangles)
      if (random.index(2)) t = Triangle(t[1], t[0], t[2]);
  });
  const std::vector<int> a = renumber(other.a, random),
                         b = other.b ? renumber(*other.b, random) : a;
  Contacts found = contactsOf(other, outcome);
  for (NamedBracket& c : found) {
    const bool is_edges = c.id[3] >= 0, first_on_o1 = c.id[1];
    const auto old = [&](std::size_t i) {
      const auto& ids = (i < 4) == first_on_o1 ? a : b;
      return c.id[i] < 0 ? -1 : ids[static_cast<std::size_t>(c.id[i])];
    };
    c.id = contactId(c.id[0], is_edges || first_on_o1, !what.b, {old(2), old(3)},
                     {old(4), old(5), old(6)});
  }
  expectSameContacts(found, truth, false, "permuted", outcome);
}

void expectThreads(const MeshCase& what, const Contacts& truth, Outcome& outcome) {
  for (const int threads : {2, 8}) {
    const Contacts found = contactsOf(what, outcome, threads);
    expectSameContacts(found, truth, true, "threads", outcome);
    if (outcome.isRight() && !(found == truth))
      outcome.blame(&Outcome::early, "threads: another order\n");
  }
}

/// A planted fault is in all answers. Those that are compared as they are would not show
/// it, and are left out then.
Outcome checked(const MeshCase& what, std::uint64_t seed) {
  Random random(seed ^ 0x1b873593);
  Outcome outcome;
  const PlantedFault planted = plantedFault();
  const Contacts truth = contactsOf(what, outcome);
  outcome.contacts = truth.size();
  if (planted == PlantedFault::kNone) {
    expectThreads(what, truth, outcome);
    expectPermuted(what, truth, random, outcome);
    expectSubset(what, truth, random, outcome);
  }
  expectReversed(what, truth, outcome);
  expectSwapped(what, truth, outcome);
  expectScaled(what, truth, random, outcome);
  expectMoved(what, truth, random, outcome);
  expectHalves(what, truth, outcome);
  return outcome;
}

Outcome meshRules(std::uint64_t seed) {
  Random random(seed);
  // Coordinates that sums, halves and products with powers of two leave exact, and the
  // plain question: whether features touch.
  MeshCase what;
  do what = randomMeshCase(random);
  while (!what.is_on_grid);
  what.min_distance = 0;
  what.ignores_initially_closer = false;
  what.t_max = 1;
  Outcome outcome = checked(what, seed);
  if (outcome.isRight() || plantedFault() != PlantedFault::kNone) return outcome;
  minimise(what,
           [seed](const MeshCase& smaller) { return !checked(smaller, seed).isRight(); });
  outcome.complaint = checked(what, seed).complaint + asTest(what, "");
  return outcome;
}

const RegisteredFamily kMeshRules("mesh-rules", meshRules);

}  // namespace
}  // namespace test
}  // namespace fcl
