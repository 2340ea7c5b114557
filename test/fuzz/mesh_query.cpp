// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_query.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/continuous_collision.h"

namespace fcl {
namespace test {
namespace {

using Result = ContinuousContactResult<double>;

void require(int code, const FuzzModel& model) {
  if (code != BVH_OK) throw std::runtime_error(model.lastError());
}

ContactId idOf(const ContinuousContact<double>& c, bool is_self) {
  const bool is_edge = c.kind == ContinuousContactKind::kEdgeEdge;
  const auto& v = c.vertices;
  std::array<int, 2> first{v[0], is_edge ? v[1] : -1};
  std::array<int, 3> second{v[1], v[2], v[3]};
  if (is_edge) second = {v[2], v[3], -1};
  return contactId(static_cast<int>(c.kind), c.first_on_o1, is_self, first, second);
}

ContinuousContactRequest<double> requestOf(const MeshCase& what, const Ask& ask) {
  ContinuousContactRequest<double> request;
  request.query = ask.query == Ask::Query::kAll     ? ContinuousQuery::kAll
                  : ask.query == Ask::Query::kFirst ? ContinuousQuery::kFirst
                                                    : ContinuousQuery::kAny;
  request.toc_err = what.toc_err;
  request.min_distance = what.min_distance;
  request.ignore_initially_closer = what.ignores_initially_closer;
  request.t_max = what.t_max;
  request.num_threads = ask.num_threads;
  request.enable_contact = false;
  if (ask.num_max_contacts) request.num_max_contacts = ask.num_max_contacts;
  return request;
}

}  // namespace

std::shared_ptr<FuzzModel> makeFuzzModel(const MovingMesh& mesh) {
  auto model = std::make_shared<FuzzModel>();
  require(model->beginModel(), *model);
  require(model->addSubModel(mesh.t0, mesh.triangles), *model);
  require(model->endModel(FclTree::kSkip), *model);
  updateFrames(*model, mesh);
  return model;
}

void updateFrames(FuzzModel& model, const MovingMesh& mesh) {
  require(model.updateFrames(mesh.previous(), mesh.current(), mesh.t0.size()), model);
}

void updateTopology(FuzzModel& model, const MovingMesh& mesh,
                    const std::vector<int>& origins) {
  require(model.updateTopology(mesh.triangles, origins, mesh.previous(), mesh.current(),
                               mesh.t0.size()),
          model);
}

MeshAnswer askUnplanted(const FuzzModel& a, const FuzzModel* b, const MeshCase& what,
                        const Ask& ask, Outcome& outcome) {
  const auto request = requestOf(what, ask);
  const Transform3<double> origin = Transform3<double>::Identity();
  Result result;
  outcome.timed([&] {
    return b ? continuousCollide(&a, origin, origin, b, origin, origin, request, result)
             : continuousSelfCollide(&a, request, result);
  });
  MeshAnswer answer{result.is_collide,
                    result.initially_crossing,
                    result.contacts_cut,
                    result.time_of_contact,
                    {}};
  for (const auto& c : result.contacts) {
    answer.contacts.push_back({idOf(c, !b), c.toc_lo, c.toc_hi});
    for (const int id : answer.contacts.back().id)
      outcome.addToDigest(static_cast<std::uint64_t>(id));
    outcome.addToDigest(c.toc_lo);
    outcome.addToDigest(c.toc_hi);
  }
  return answer;
}

MeshAnswer askModels(const FuzzModel& a, const FuzzModel* b, const MeshCase& what,
                     const Ask& ask, Outcome& outcome) {
  MeshAnswer answer = askUnplanted(a, b, what, ask, outcome);
  applyPlantedFault(answer.contacts);
  return answer;
}

MeshAnswer askCase(const MeshCase& mesh_case, const Ask& ask, Outcome& outcome) {
  const auto a = makeFuzzModel(mesh_case.a);
  if (!mesh_case.b) return askModels(*a, nullptr, mesh_case, ask, outcome);
  return askModels(*a, makeFuzzModel(*mesh_case.b).get(), mesh_case, ask, outcome);
}

void expectSameContacts(std::vector<NamedBracket> found, std::vector<NamedBracket> truth,
                        bool with_times, const char* tells, Outcome& outcome) {
  std::sort(found.begin(), found.end());
  std::sort(truth.begin(), truth.end());
  const auto tell = [tells](const char* what, const NamedBracket& c) {
    std::ostringstream out;
    out << tells << ": " << what << " " << nameOf(c.id) << std::hexfloat << " at ["
        << c.toc_lo << ", " << c.toc_hi << "]\n";
    return out.str();
  };
  auto x = found.begin();
  auto y = truth.begin();
  while (x != found.end() || y != truth.end()) {
    if (y == truth.end() || (x != found.end() && x->id < y->id)) {
      outcome.blame(&Outcome::invented, tell("invented", *x++));
    } else if (x == found.end() || y->id < x->id) {
      outcome.blame(&Outcome::missed, tell("missed", *y++));
    } else {
      // Brackets of one time have a part in common.
      const bool is_late = with_times ? x->toc_lo > y->toc_lo : x->toc_lo > y->toc_hi;
      const bool is_other = with_times ? !(*x == *y) : x->toc_hi < y->toc_lo;
      if (is_late)
        outcome.blame(&Outcome::late, tell("late", *x));
      else if (is_other)
        outcome.blame(&Outcome::early, tell("early", *x));
      ++x;
      ++y;
    }
  }
}

}  // namespace test
}  // namespace fcl
