// SPDX-License-Identifier: BSD-3-Clause
//
//   fcl_ccd_cables [SIDE [LENGTH [RUNS]]]
//
// Speed and errors of bundles of SIDE x SIDE cables (100) with LENGTH segments each (10),
// packed as closely as can be: processor time of one thread a segment, the least of RUNS
// (9). The errors are those of a small bundle of the same kind, against all pairs of
// segments tested one by one. doc/thickness.md has figures.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "mesh_generators.h"
#include "query/distance_contact.h"

namespace {

using namespace fcl::test;
using namespace fcl::detail::deformable;
using Model = fcl::DeformableBVHModel<>;
using Vector = fcl::Vector3<double>;
using Result = fcl::ContinuousContactResult<double>;

/// Cables one unit apart, which move by up to `step` along each axis.
struct Bundle {
  std::vector<Vector> t0, t1;
  std::vector<fcl::FreeEdge> edges;

  /// @param connected  whether segments of a cable share vertices, and neighbours begin
  /// half a segment later; if not, there are gaps between them
  Bundle(int side, int length, bool connected) {
    constexpr double kSegment = 2, kGap = 2, kPart = 0.9;
    const double step = connected ? 0.1 : 0.01;
    Random random(39);
    const auto add = [&](int i, int j, double z) {
      t0.push_back(Vector(i + 0.5 * (j % 2), std::sqrt(0.75) * j, z));
      t0.back() += random.point(step).cwiseProduct(Vector(1, 1, 0));
      t1.push_back(t0.back() + random.point(step));
    };
    for (int i = 0; i < side; ++i)
      for (int j = 0; j < side; ++j)
        for (int k = 0; k < length + (connected ? 1 : 0); ++k) {
          if (connected) {
            add(i, j, kSegment * (k + 0.5 * ((i + j) % 2)));
          } else {
            add(i, j, (kSegment + kGap) * k);
            add(i, j, (kSegment + kGap) * k + kPart * kSegment);
          }
          if (!connected || k > 0) edges.push_back({t0.size() - 2, t0.size() - 1});
        }
  }
};

Model modelOf(const Bundle& bundle) {
  Model model;
  model.beginModel(0, static_cast<int>(bundle.t0.size()));
  model.addSubModel(bundle.t0, {}, bundle.edges);
  model.endModel(fcl::FclTree::kSkip);
  model.updateFrames(bundle.t0[0].data(), bundle.t1[0].data(), bundle.t0.size());
  return model;
}

fcl::ContinuousContactRequest<double> requestAt(double distance) {
  fcl::ContinuousContactRequest<double> request;
  request.min_distance = distance;
  return request;
}

/// Kind and vertices of a contact.
using Name = std::tuple<int, int, int, int, int>;

template <typename Contact>
Name nameOf(const Contact& c) {
  const auto id = [&c](std::size_t i) { return static_cast<int>(c.vertices[i]); };
  return {static_cast<int>(c.kind), id(0), id(1), id(2), id(3)};
}

/// The times of the contacts of all pairs of segments.
std::map<Name, double> bruteForce(const Bundle& bundle, double distance,
                                  std::size_t& near) {
  std::map<Name, double> out;
  near = 0;
  for (std::size_t i = 0; i < bundle.edges.size(); ++i)
    for (std::size_t j = i + 1; j < bundle.edges.size(); ++j) {
      const fcl::FreeEdge &a = bundle.edges[i], &b = bundle.edges[j];
      if (a[1] == b[0]) continue;
      const std::size_t ids[4] = {a[0], a[1], b[0], b[1]};
      VertexPath x[4];
      FeatureIds pair{fcl::ContinuousContactKind::kEdgeEdge, true, {}, {}};
      for (int k = 0; k < 4; ++k) {
        pair.vertices[k] = static_cast<std::uint32_t>(ids[k]);
        std::copy_n(bundle.t0[ids[k]].data(), 3, x[k].t0);
        std::copy_n(bundle.t1[ids[k]].data(), 3, x[k].t1);
      }
      DistanceRequest request;
      request.distance = distance;
      request.toc_err = requestAt(distance).toc_err;
      const DistanceContact found =
          advanceToDistance(pair.kind, {{&x[0], &x[1], &x[2], &x[3]}}, request);
      if (!found.is_contact) continue;
      ++near;
      const FeatureContact contact = contactOf(pair, found, true);
      const auto at = out.emplace(nameOf(contact), contact.toc_lo).first;
      at->second = std::min(at->second, contact.toc_lo);
    }
  return out;
}

void printErrors(bool connected, double distance) {
  const Bundle bundle(6, 6, connected);
  std::size_t near;
  const std::map<Name, double> truth = bruteForce(bundle, distance, near);
  Result result;
  const Model model = modelOf(bundle);
  fcl::continuousSelfCollide(&model, requestAt(distance), result);
  std::size_t found = 0, late = 0;
  for (const auto& contact : result.contacts) {
    const auto at = truth.find(nameOf(contact));
    if (at == truth.end()) continue;
    ++found;
    late += contact.toc_lo > at->second;
  }
  std::printf(
      "errors of %zu segments, %zu pairs within d: %zu missed, %zu invented, %zu late\n",
      bundle.edges.size(), near, truth.size() - found, result.contacts.size() - found,
      late);
}

double now() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e9 * double(time.tv_sec) + double(time.tv_nsec);
}

template <typename Work>
double leastOf(int runs, Work&& work) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < runs; ++i) {
    const double start = now();
    work();
    least = std::min(least, now() - start);
  }
  return least;
}

void printSpeed(int side, int length, bool connected, double distance, int runs) {
  const Bundle bundle(side, length, connected);
  Model model = modelOf(bundle);
  const auto each = [&](double x) {
    return x / static_cast<double>(bundle.edges.size());
  };
  const double update = leastOf(runs, [&] {
    model.updateFrames(bundle.t0[0].data(), bundle.t1[0].data(), bundle.t0.size());
  });
  std::size_t pairs = 0;
  const double candidates = leastOf(runs, [&] {
    pairs = 0;
    fcl::continuousSelfCandidates(
        &model,
        [&pairs](const fcl::ContinuousCandidate*, std::size_t count) {
          pairs += count;
          return true;
        },
        distance);
  });
  const auto query = [&](double d, bool ignores) {
    auto request = requestAt(d);
    request.ignore_initially_closer = ignores;
    Result result;
    const double time = leastOf(runs, [&] {
      result = Result();
      fcl::continuousSelfCollide(&model, request, result);
    });
    return std::make_pair(each(time), each(static_cast<double>(result.contacts.size())));
  };
  const auto touching = query(0, false), near = query(distance, false),
             nearer = query(distance, true);
  std::printf(
      "%zu segments, d = %g, %.2f candidates each. ns a segment: update %.0f, candidates "
      "%.0f, touching %.0f, contacts at d %.0f (%.2f each), without those that begin "
      "nearer %.0f (%.2f each)\n",
      bundle.edges.size(), distance, each(static_cast<double>(pairs)), each(update),
      each(candidates), touching.first, near.first, near.second, nearer.first,
      nearer.second);
}

}  // namespace

int main(int argc, char** argv) {
  const int side = argc > 1 ? std::atoi(argv[1]) : 100,
            length = argc > 2 ? std::atoi(argv[2]) : 10,
            runs = argc > 3 ? std::atoi(argv[3]) : 9;
  constexpr double kDistance = 1.05;
  for (const bool connected : {false, true}) {
    std::printf("%s\n", connected ? "connected" : "separate");
    printErrors(connected, kDistance);
    printSpeed(side, length, connected, kDistance, runs);
  }
  return 0;
}
