// SPDX-License-Identifier: BSD-3-Clause
#include "pair_census.h"

#include <algorithm>
#include <utility>

#include "elementary/coplanarity_filter.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "scene_method.h"
#include "speed_error/plain_solvers.h"

namespace fcl {
namespace test {
namespace {

namespace deformable = detail::deformable;
using deformable::FeaturePoints;
using fcl::ContinuousContactKind;

/// Times are not asked for.
constexpr double kTocErr = 1;

/// Who is told of the pairs: a TouchTest is a plain function.
const PairVisitor* visitor_of_pairs = nullptr;

bool touchAndTell(ContinuousContactKind kind, const FeaturePoints& x,
                  const RelativePair<double>&, const CoplanarityCubic<double>& cubic) {
  const bool is_contact = deformable::elementaryTest(kind, x, 0, 1, kTocErr).answer ==
                          deformable::Answer::kYes;
  (*visitor_of_pairs)({kind, x, is_contact, cubic.hasOneSign()});
  return is_contact;
}

/// The paths of a candidate's vertices.
struct CandidatePaths {
  ContinuousContactKind kind;
  std::array<deformable::VertexPath, 4> x;

  CandidatePaths(const FramePairMesh& frame, const ContinuousCandidate& candidate)
      : kind(candidate.kind == ContinuousContactKind::kVertexFace
                 ? ContinuousContactKind::kVertexFace
                 : ContinuousContactKind::kEdgeEdge) {
    for (std::size_t i = 0; i < 4; ++i) {
      const auto v = static_cast<std::size_t>(candidate.vertices[i]);
      for (int k = 0; k < 3; ++k) {
        x[i].t0[k] = frame.previous[v][k];
        x[i].t1[k] = frame.current[v][k];
      }
    }
  }
  FeaturePoints points() const { return {{&x[0], &x[1], &x[2], &x[3]}}; }
};

}  // namespace

void TestedEdges::add(const FeaturePoints& x) {
  ++pairs;
  for (const int first : {0, 2}) {
    const double *p = x[first].t0, *q = x[first + 1].t0;
    if (std::lexicographical_compare(q, q + 3, p, p + 3)) std::swap(p, q);
    edges.insert({{p[0], p[1], p[2], q[0], q[1], q[2]}});
  }
}

std::vector<PairName> SweptPairs::visit(const FramePairMesh& frame,
                                        const PairVisitor& visitor) {
  if (watch_.isNew(frame)) {
    baseline_.reset();
    baseline_ = makeBaseline(frame, {Technique::kRepresentatives}, touchAndTell);
  }
  visitor_of_pairs = &visitor;
  std::vector<PairName> contacts = std::move(baseline_->step(frame).contacts);
  visitor_of_pairs = nullptr;
  std::sort(contacts.begin(), contacts.end());
  return contacts;
}

CandidateCounts& CandidateCounts::operator+=(const CandidateCounts& other) {
  pairs += other.pairs;
  left_by_plain += other.left_by_plain;
  contacts += other.contacts;
  contacts_left_by_plain += other.contacts_left_by_plain;
  return *this;
}

CandidateCounts MovingPairs::count(const FramePairMesh& frame,
                                   const std::vector<PairName>& contacts,
                                   TestedEdges* edges) {
  if (watch_.isNew(frame)) takeFrame(model_, frame);
  updateFrames(model_, frame);
  CandidateCounts counts;
  const auto look = [&](const ContinuousCandidate& candidate) {
    const CandidatePaths paths(frame, candidate);
    const bool is_left = passesPlainFilter(paths.kind, paths.points());
    const bool is_contact = std::binary_search(
        contacts.begin(), contacts.end(), pairName(candidate.kind, candidate.vertices));
    ++counts.pairs;
    counts.left_by_plain += is_left;
    counts.contacts += is_contact;
    counts.contacts_left_by_plain += is_left && is_contact;
    if (edges && paths.kind == ContinuousContactKind::kEdgeEdge &&
        deformable::mayBecomeCoplanar(paths.kind, paths.points(), candidate.window_lo,
                                      candidate.window_hi))
      edges->add(paths.points());
  };
  continuousSelfCandidates(&model_,
                           [&](const ContinuousCandidate* candidates, std::size_t count) {
                             std::for_each(candidates, candidates + count, look);
                             return true;
                           });
  return counts;
}

void PairSample::add(const MetPair& pair) {
  // Reservoir sampling: of n pairs met, each is among those kept with the same chance.
  const std::size_t place = met_ < most_ ? met_ : random_.index(met_ + 1);
  ++met_;
  if (place >= most_) return;
  if (place == set_.queries.size()) {
    set_.queries.emplace_back();
    set_.truth.emplace_back();
  }
  MovingPair& query = set_.queries[place];
  query.kind = pair.kind;
  for (int i = 0; i < 4; ++i) query.x[static_cast<std::size_t>(i)] = pair.points[i];
  set_.truth[place] = {pair.is_contact, 0, 0};
}

}  // namespace test
}  // namespace fcl
