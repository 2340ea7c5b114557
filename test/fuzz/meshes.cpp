// SPDX-License-Identifier: BSD-3-Clause
//
// Queries of deforming meshes, with themselves and with each other, against all pairs of
// features.
#include <algorithm>
#include <functional>
#include <sstream>

#include "mesh_query.h"
#include "mesh_reference.h"

namespace fcl {
namespace test {
namespace {

bool isIn(const std::vector<NamedBracket>& sorted, const ContactId& id) {
  return std::binary_search(
      sorted.begin(), sorted.end(), NamedBracket{id, 0, 0},
      [](const NamedBracket& x, const NamedBracket& y) { return x.id < y.id; });
}

void expectNamed(const MeshAnswer& answer, const MeshTruth& truth, const char* query,
                 Outcome& outcome) {
  for (const NamedBracket& c : answer.contacts)
    if (!isIn(truth.contacts, c.id))
      outcome.blame(&Outcome::invented,
                    std::string(query) + ": invented " + nameOf(c.id) + "\n");
}

void expectCollide(const MeshAnswer& answer, const MeshTruth& truth, const char* query,
                   Outcome& outcome) {
  const bool meets = truth.is_crossing || !truth.contacts.empty();
  if (answer.is_collide != meets)
    outcome.blame(meets ? &Outcome::missed : &Outcome::invented,
                  std::string(query) + (meets ? ": no collision\n" : ": a collision\n"));
}

void expectAll(const MeshCase& what, const MeshTruth& truth, Outcome& outcome) {
  const MeshAnswer all = askCase(what, {}, outcome);
  expectSameContacts(all.contacts, truth.contacts, what.min_distance > 0, "all", outcome);
  expectCollide(all, truth, "all", outcome);
  if (all.is_crossing != truth.is_crossing)
    outcome.blame(truth.is_crossing ? &Outcome::missed : &Outcome::invented,
                  "all: another crossing at t = 0\n");
}

void expectFirst(const MeshCase& what, const MeshTruth& truth, Outcome& outcome) {
  Ask ask;
  ask.query = Ask::Query::kFirst;
  const MeshAnswer first = askCase(what, ask, outcome);
  expectCollide(first, truth, "first", outcome);
  expectNamed(first, truth, "first", outcome);
  double lo = 1, hi = 1;
  for (const NamedBracket& c : truth.contacts) {
    lo = std::min(lo, c.toc_lo);
    hi = std::min(hi, c.toc_hi);
  }
  if (truth.is_crossing) lo = hi = 0;
  if (first.time > hi) outcome.blame(&Outcome::late, "first: late\n");
  if (first.time < lo - what.toc_err) outcome.blame(&Outcome::early, "first: early\n");
  if (truth.is_crossing) return;
  std::vector<NamedBracket> sorted = first.contacts;
  std::sort(sorted.begin(), sorted.end());
  for (const NamedBracket& c : truth.contacts) {
    // No other contact can be before it.
    const bool is_certain =
        c.toc_hi == hi && std::all_of(truth.contacts.begin(), truth.contacts.end(),
                                      [&c](const NamedBracket& o) {
                                        return o.id == c.id || o.toc_lo > c.toc_hi;
                                      });
    if (is_certain && !isIn(sorted, c.id))
      outcome.blame(&Outcome::missed, "first: missed " + nameOf(c.id) + "\n");
  }
}

void expectAny(const MeshCase& what, const MeshTruth& truth, Outcome& outcome) {
  Ask ask;
  ask.query = Ask::Query::kAny;
  const MeshAnswer any = askCase(what, ask, outcome);
  expectCollide(any, truth, "any", outcome);
  expectNamed(any, truth, "any", outcome);
  if (any.contacts.size() > 1) outcome.blame(&Outcome::invented, "any: two contacts\n");
}

/// The earliest ones: none that is left out is certainly before one that is kept.
void expectEarliest(const MeshCase& what, const MeshTruth& truth, Outcome& outcome) {
  Ask ask;
  ask.num_max_contacts = 1 + truth.contacts.size() / 3;
  const MeshAnswer few = askCase(what, ask, outcome);
  expectCollide(few, truth, "earliest", outcome);
  expectNamed(few, truth, "earliest", outcome);
  if (few.contacts.size() != std::min(ask.num_max_contacts, truth.contacts.size()) ||
      few.is_cut != (truth.contacts.size() > ask.num_max_contacts))
    outcome.blame(&Outcome::missed, "earliest: another number of contacts\n");
  double last = 0;
  for (const NamedBracket& c : few.contacts) last = std::max(last, c.toc_lo);
  std::vector<NamedBracket> sorted = few.contacts;
  std::sort(sorted.begin(), sorted.end());
  for (const NamedBracket& c : truth.contacts)
    if (c.toc_hi < last && !isIn(sorted, c.id))
      outcome.blame(&Outcome::missed, "earliest: missed " + nameOf(c.id) + "\n");
}

Outcome checked(const MeshCase& what) {
  Outcome outcome;
  const MeshTruth truth = bruteForce(what);
  outcome.contacts = truth.contacts.size();
  expectAll(what, truth, outcome);
  expectFirst(what, truth, outcome);
  expectAny(what, truth, outcome);
  expectEarliest(what, truth, outcome);
  return outcome;
}

std::string minimised(MeshCase what) {
  minimise(what, [](const MeshCase& smaller) { return !checked(smaller).isRight(); });
  const MeshTruth truth = bruteForce(what);
  std::ostringstream expected;
  expected << "  EXPECT_EQ(result.contacts.size(), " << truth.contacts.size()
           << "U);\n  EXPECT_EQ(result.initially_crossing, " << std::boolalpha
           << truth.is_crossing << ");\n";
  return checked(what).complaint + asTest(what, expected.str());
}

Outcome meshes(std::uint64_t seed) {
  Random random(seed);
  const MeshCase what = randomMeshCase(random);
  Outcome outcome = checked(what);
  if (!outcome.isRight() && plantedFault() == PlantedFault::kNone)
    outcome.complaint = minimised(what);
  return outcome;
}

const RegisteredFamily kMeshes("meshes", meshes, 4);

}  // namespace
}  // namespace test
}  // namespace fcl
