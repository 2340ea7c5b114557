// SPDX-License-Identifier: BSD-3-Clause
//
// Free edges and free points, beside triangles and alone, against all pairs of features.
#include <algorithm>
#include <sstream>

#include "family.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "free_features.h"
#include "minimise.h"

namespace fcl {
namespace test {
namespace {

using Model = DeformableBVHModel<KDOP<double, 16>>;
using Result = ContinuousContactResult<double>;

struct CableCase {
  FreeBody a, b;
  bool is_self;
  double distance;
};

Result ask(const CableCase& what, Outcome& outcome) {
  ContinuousContactRequest<double> request;
  request.toc_err = 1e-6;
  request.min_distance = what.distance;
  const auto a = freeModelOf<Model>(what.a);
  Result result = outcome.timed([&] {
    return what.is_self ? selfContacts<double>(*a, request)
                        : pairContacts<double>(*a, *freeModelOf<Model>(what.b), request);
  });
  for (const auto& c : result.contacts) outcome.addToDigest(c.toc_lo);
  applyPlantedFault(result.contacts);
  return result;
}

Outcome checked(const CableCase& what) {
  Outcome outcome;
  detail::deformable::DistanceRequest request{};
  request.distance = what.distance;
  request.toc_err = 1e-6;
  const NamedContacts truth =
      AllPairs(what.a, what.is_self ? what.a : what.b, request).find();
  const NamedContacts found = namedContacts(ask(what, outcome), what.is_self);
  outcome.contacts = truth.size();
  for (const auto& [name, bracket] : truth) {
    const auto at = found.find(name);
    // With a distance the times are equal to the bit, without they have a part in common.
    if (at == found.end())
      outcome.blame(&Outcome::missed, "missed\n");
    else if (at->second.first > (what.distance > 0 ? bracket.first : bracket.second))
      outcome.blame(&Outcome::late, "late\n");
    else if (what.distance > 0 ? at->second != bracket
                               : at->second.second < bracket.first)
      outcome.blame(&Outcome::early, "another time\n");
  }
  for (const auto& entry : found)
    if (truth.count(entry.first) == 0) outcome.blame(&Outcome::invented, "invented\n");
  return outcome;
}

void write(std::ostream& out, const FreeBody& body, const char* name) {
  out << "  FreeBody " << name << ";\n" << std::hexfloat;
  const auto points = [&](const char* frame, const std::vector<Vector3<double>>& at) {
    out << "  " << name << "." << frame << " = {";
    for (const auto& p : at) out << "{" << p[0] << ", " << p[1] << ", " << p[2] << "}, ";
    out << "};\n";
  };
  points("t0", body.t0);
  points("t1", body.t1);
  out << "  " << name << ".triangles = {";
  for (const Triangle& t : body.triangles)
    out << "Triangle(" << t[0] << ", " << t[1] << ", " << t[2] << "), ";
  out << "};\n  " << name << ".edges = {";
  for (const FreeEdge& e : body.edges) out << "{" << e[0] << ", " << e[1] << "}, ";
  out << "};\n  " << name << ".points = {";
  for (const std::size_t p : body.points) out << p << ", ";
  out << "};\n";
}

void minimiseCase(CableCase& what) {
  for (FreeBody* body : {&what.a, &what.b}) {
    if (body == &what.b && what.is_self) continue;
    const auto still_fails = [&] {
      if (body->triangles.empty() && body->edges.empty() && body->points.empty())
        return false;
      return !checked(what).isRight();
    };
    minimise(body->triangles, still_fails);
    minimise(body->edges, still_fails);
    minimise(body->points, still_fails);
  }
}

Outcome cables(std::uint64_t seed) {
  Random random(seed);
  const auto body = [&random] {
    return randomBody(random, kBodySizes[random.index(7)], random.uniform(0, 0.6));
  };
  CableCase what{body(), body(), random.index(2) == 0, kDistances[random.index(4)]};
  Outcome outcome = checked(what);
  if (outcome.isRight() || plantedFault() != PlantedFault::kNone) return outcome;
  minimiseCase(what);
  std::ostringstream test;
  test << "  // test/unit/test_fcl_free_features.cpp\n";
  write(test, what.a, "a");
  if (!what.is_self) write(test, what.b, "b");
  test << "  // at the distance " << what.distance << "\n";
  outcome.complaint = checked(what).complaint + test.str();
  return outcome;
}

const RegisteredFamily kCables("cables", cables, 4);

}  // namespace
}  // namespace test
}  // namespace fcl
