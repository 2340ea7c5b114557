// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <stdexcept>
#include <string>
#include <thread>
#include <tuple>
#if defined(FCL_CCD_USE_HIGHWAY)
#include <hwy/targets.h>
#endif

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "machine.h"
#include "rows.h"
#include "swept_query.h"
#include "timing.h"

namespace fcl {
namespace test {
namespace {

using Model = DeformableBVHModel<>;
using Result = ContinuousContactResult<double>;

void expect(int code, const Model& model) {
  if (code != BVH_OK) throw std::runtime_error(model.lastError());
}

void build(const FramePairMesh& mesh, int threads, Model& model) {
  expect(model.setNumThreads(threads), model);
  expect(model.beginModel(static_cast<int>(mesh.triangles.size()),
                          static_cast<int>(mesh.previous.size())),
         model);
  expect(model.addSubModel(mesh.previous, mesh.triangles), model);
  expect(model.endModel(FclTree::kSkip), model);
}

void update(const std::vector<Vector3<double>>& previous,
            const std::vector<Vector3<double>>& current, Model& model) {
  expect(model.updateFrames(previous[0].data(), current[0].data(), previous.size(),
                            FclTree::kSkip),
         model);
}

ContinuousContactRequest<double> makeRequest(ContinuousQuery query, int threads) {
  ContinuousContactRequest<double> request;
  request.query = query;
  request.enable_contact = false;
  request.num_threads = threads;
  return request;
}

/// Wall time of the query. The library's own times say where it went; what they leave out
/// (sorting, handing over) counts as test.
void query(const Model& a, const Model* b, ContinuousQuery kind, int threads,
           Result& result, StepTimes& times) {
  const auto request = makeRequest(kind, threads);
  const Transform3<double> origin = Transform3<double>::Identity();
  const double ms = millisecondsOf([&] {
    if (b)
      continuousCollide(&a, origin, origin, b, origin, origin, request, result);
    else
      continuousSelfCollide(&a, request, result);
  });
  const StageTimes& own = result.times;
  const double sum = own.traverse + own.test, share = sum > 0 ? own.traverse / sum : 0;
  times.traverse = std::min(1e3 * own.traverse, ms * share);
  times.test = ms - times.traverse;
}

const char* nameOf(ContinuousQuery query) {
  return query == ContinuousQuery::kAll     ? "all"
         : query == ContinuousQuery::kFirst ? "first"
                                            : "any";
}

/// Of all contacts: names and time brackets. Which other contacts a first-contact query
/// meets on its way, or which proof comes first, is left to the query.
std::uint64_t hashOf(const Result& result, ContinuousQuery query) {
  Hash hash;
  hash.add(std::uint64_t{result.is_collide});
  if (query == ContinuousQuery::kAny) return hash.value();
  hash.add(result.time_of_contact);
  hash.add(std::uint64_t{result.initially_crossing});
  if (query == ContinuousQuery::kFirst) return hash.value();
  std::vector<const ContinuousContact<double>*> sorted;
  for (const auto& contact : result.contacts) sorted.push_back(&contact);
  std::sort(sorted.begin(), sorted.end(), [](const auto* x, const auto* y) {
    return std::tie(x->kind, x->first_on_o1, x->vertices) <
           std::tie(y->kind, y->first_on_o1, y->vertices);
  });
  for (const auto* contact : sorted) {
    hash.add(static_cast<std::uint64_t>(contact->kind));
    hash.add(std::uint64_t{contact->first_on_o1});
    for (const int v : contact->vertices) hash.add(static_cast<std::uint64_t>(v));
    hash.add(contact->toc_lo);
    hash.add(contact->toc_hi);
  }
  return hash.value();
}

std::vector<PairName> namesOf(const Result& result) {
  std::vector<PairName> names;
  names.reserve(result.contacts.size());
  for (const auto& contact : result.contacts) names.push_back(pairName(contact));
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

int allThreads() {
#if defined(FCL_CCD_USE_TBB)
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
#else
  return 1;
#endif
}

void useScalarKernels() {
#if defined(FCL_CCD_USE_HIGHWAY)
  hwy::SetSupportedTargetsForTest(HWY_EMU128 | HWY_SCALAR);
#endif
}

Row libraryRow(const std::string& scene, std::size_t triangles, ContinuousQuery query,
               int threads) {
  return {scene,       triangles,        nameOf(query), "moving",
          "certified", libraryKernels(), threads};
}

Row measureLibrary(const SpeedScene& scene, ContinuousQuery kind, int threads,
                   const Effort& effort, const std::vector<PairName>* truth,
                   std::vector<PairName>* found) {
  Row row = libraryRow(scene.name, scene.a.triangles.size() + scene.b.triangles.size(),
                       kind, threads);
  resetPeakMemory();
  Model a, b;
  const bool self = scene.isSelf();
  measureBuild(effort, row, [&] {
    a = Model();
    b = Model();
    return millisecondsOf([&] {
      build(scene.a, threads, a);
      if (!self) build(scene.b, threads, b);
    });
  });
  Result result;
  measureStep(effort, row, [&](StepTimes& times) {
    times.update = millisecondsOf([&] {
      update(scene.a.previous, scene.a.current, a);
      if (!self) update(scene.b.previous, scene.b.current, b);
    });
    query(a, self ? nullptr : &b, kind, threads, result, times);
  });
  row.peak_mb = peakMegabytes();
  row.contacts = result.contacts.size();
  row.hash = hashOf(result, kind);
  if (!self || (!truth && !found)) return row;
  std::vector<PairName> names = namesOf(result);
  if (truth) {
    const Errors errors = errorsOf(names, *truth);
    if (kind == ContinuousQuery::kAll) row.missed = errors.missed;
    row.extra = errors.extra;
  }
  if (found) *found = std::move(names);
  return row;
}

Row measureSwept(const SpeedScene& scene, const Effort& effort,
                 const std::vector<PairName>& truth) {
  Row row = libraryRow(scene.name, scene.a.triangles.size(), ContinuousQuery::kAll, 1);
  row.boxes = "swept";
  resetPeakMemory();
  Model model;
  measureBuild(effort, row, [&] {
    model = Model();
    return millisecondsOf([&] { build(scene.a, 1, model); });
  });
  std::vector<PairName> found;
  measureStep(effort, row, [&](StepTimes& times) {
    times.update =
        millisecondsOf([&] { update(scene.a.previous, scene.a.current, model); });
    SweptContacts contacts = sweptSelfContacts(model, true);
    times.traverse = contacts.ms_traverse;
    times.test = contacts.ms_test;
    found = std::move(contacts.pairs);
  });
  row.peak_mb = peakMegabytes();
  setContacts(found, truth, row);
  return row;
}

std::vector<SequenceRow> measureSequence(const std::string& name,
                                         const FrameSequence& sequence,
                                         const Effort& effort) {
  std::vector<SequenceRow> rows(sequence.frames.size() - 1);
  const auto step = [&](std::size_t i, Model& model, Result& result, StepTimes& least) {
    StepTimes times;
    times.update = millisecondsOf(
        [&] { update(sequence.frames[i], sequence.frames[i + 1], model); });
    query(model, nullptr, ContinuousQuery::kAll, 1, result, times);
    if (least.total() == 0 || times.total() < least.total()) least = times;
  };
  const auto built = [](const FramePairMesh& mesh, Model& model, double& least) {
    const double ms = millisecondsOf([&] { build(mesh, 1, model); });
    if (least == 0 || ms < least) least = ms;
  };
  repeat(effort, [&] {
    // One after the other, as in a simulation: each finds in the cache what it has left.
    Model kept;
    built(sequence.pair(0), kept, rows[0].kept_build);
    Result result;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      SequenceRow& row = rows[i];
      const std::size_t restructurings = kept.numRestructurings();
      step(i, kept, result, row.kept);
      row.sequence = name;
      row.frame = i;
      row.kept_build = rows[0].kept_build;
      row.contacts = result.contacts.size();
      row.hash = hashOf(namesOf(result)).value();
      row.is_restructured = kept.numRestructurings() > restructurings;
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      Model fresh;
      built(sequence.pair(i), fresh, rows[i].fresh_build);
      step(i, fresh, result, rows[i].fresh);
      if (hashOf(namesOf(result)).value() != rows[i].hash)
        throw std::logic_error(name + ": the tree changes the answer");
    }
  });
  return rows;
}

}  // namespace test
}  // namespace fcl
