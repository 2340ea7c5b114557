// SPDX-License-Identifier: BSD-3-Clause
//
// Pairs of features that touch. The reference is the decision by integers,
// decideExactly(), which the stages before it do not use. Every 16th pair goes to the
// oracle, which shares no code with the library.
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include "elementary/axis_window.h"
#include "elementary/coplanarity_filter.h"
#include "elementary/exact.h"
#include "family.h"
#include "oracle/query_check.h"
#include "pair_as_test.h"

namespace fcl {
namespace test {
namespace {

using namespace detail::deformable;
using fcl::ContinuousContactKind;

/// The two features are on two sides of a plane of constant x, y or z in both frames.
bool areApartAlongAnAxis(const MovingPair& pair) {
  const std::size_t split = pair.kind == ContinuousContactKind::kVertexFace ? 1 : 2;
  for (int k = 0; k < 3; ++k) {
    bool is_below = true, is_above = true;
    for (std::size_t i = 0; i < split; ++i)
      for (std::size_t j = split; j < 4; ++j) {
        const VertexPath &p = pair.x[i], &q = pair.x[j];
        is_below = is_below && p.t0[k] < q.t0[k] && p.t1[k] < q.t1[k];
        is_above = is_above && p.t0[k] > q.t0[k] && p.t1[k] > q.t1[k];
      }
    if (is_below || is_above) return true;
  }
  return false;
}

/// A request below the distance of doubles is met up to 4 units in the last place.
double widest(double toc_hi, double toc_err) {
  const double ulp =
      std::nextafter(toc_hi, std::numeric_limits<double>::infinity()) - toc_hi;
  return std::max(toc_err, 4 * ulp);
}

void expectStages(const MovingPair& pair, const ElementaryResult& truth,
                  Outcome& outcome) {
  const FeaturePoints x = pair.points();
  double lo = 0, hi = 1;
  const bool is_open = narrowWindow(pair.kind, x, lo, hi);
  if (!is_open || lo > truth.toc_hi || hi < truth.toc_lo)
    outcome.blame(&Outcome::missed, "the axis window cuts the first contact\n");
  else if (!mayBecomeCoplanar(pair.kind, x, lo, hi))
    outcome.blame(&Outcome::missed, "the coplanarity filter culls a contact\n");
}

void expectBracket(const ElementaryResult& found, const ElementaryResult& truth,
                   double toc_err, Outcome& outcome) {
  if (found.toc_lo > truth.toc_hi) outcome.blame(&Outcome::late, "late\n");
  if (found.toc_hi < truth.toc_lo ||
      found.toc_hi - found.toc_lo > widest(found.toc_hi, toc_err) ||
      (truth.toc_hi == 0 && found.toc_hi > 0))
    outcome.blame(&Outcome::early, "a bracket that is too early or too wide\n");
}

/// The first contact of a pair, by integers.
ElementaryResult truthOf(const MovingPair& pair) {
  if (areApartAlongAnAxis(pair)) return {Answer::kNo, 0, 0, DecidedBy::kExact};
  return decideExactly(pair.kind, pair.points(), 1e-12);
}

void expectTruth(const MovingPair& pair, const ElementaryResult& truth, double toc_err,
                 Outcome& outcome) {
  const FeaturePoints x = pair.points();
  std::vector<ElementaryResult> found{
      outcome.timed([&] { return elementaryTest(pair.kind, x, 0, 1, toc_err); })};
  if (found[0].answer == Answer::kNo) found.clear();
  applyPlantedFault(found);
  const bool touches = truth.answer == Answer::kYes;
  outcome.contacts += touches;
  if (touches) {
    if (found.empty())
      outcome.blame(&Outcome::missed, "missed\n");
    else
      expectBracket(found[0], truth, toc_err, outcome);
    expectStages(pair, truth, outcome);
  } else if (!found.empty()) {
    outcome.blame(&Outcome::invented, "invented\n");
  }
  outcome.addToDigest(found.empty() ? 2 : found[0].toc_lo);
}

std::string expectationOf(const ElementaryResult& truth) {
  const bool touches = truth.answer == Answer::kYes;
  std::ostringstream out;
  out << std::hexfloat
      << "  EXPECT_EQ(result.answer, Answer::" << (touches ? "kYes" : "kNo") << ");\n";
  if (touches)
    out << "  EXPECT_LE(result.toc_lo, " << truth.toc_hi
        << ");\n  EXPECT_GE(result.toc_hi, " << truth.toc_lo << ");\n";
  return out.str();
}

/// Whether a power of two up to 2^8 changes no digit of the coordinates.
bool canBeScaled(const MovingPair& pair) {
  bool can = true;
  mapped(pair, [&can](double c) {
    can = can && (c == 0 || (std::abs(c) > 0x1p-1000 && std::abs(c) < 0x1p1000));
    return c;
  });
  return can;
}

/// The same pair in another form: features, vertices and axes in another order, axes
/// mirrored, coordinates times a power of two. Its first contact is at the same time.
MovingPair variantOf(const MovingPair& pair, bool can_be_scaled, Random& random) {
  MovingPair out = pair;
  const bool vf = pair.kind == ContinuousContactKind::kVertexFace;
  if (vf) {
    std::swap(out.x[1], out.x[1 + random.index(3)]);
    if (random.index(2)) std::swap(out.x[2], out.x[3]);
  } else {
    if (random.index(2)) std::swap(out.x[0], out.x[1]);
    if (random.index(2)) std::swap(out.x[2], out.x[3]);
    if (random.index(2)) {
      std::swap(out.x[0], out.x[2]);
      std::swap(out.x[1], out.x[3]);
    }
  }
  const std::size_t first = random.index(3), signs = random.index(8);
  const bool is_turned = random.index(2);
  const double scale =
      can_be_scaled ? std::ldexp(1, static_cast<int>(random.index(17)) - 8) : 1;
  for (VertexPath& p : out.x)
    for (auto* frame : {&p.t0, &p.t1}) {
      const double old[3] = {(*frame)[0], (*frame)[1], (*frame)[2]};
      for (std::size_t k = 0; k < 3; ++k)
        (*frame)[k] = (signs >> k & 1 ? -scale : scale) *
                      old[(first + (is_turned ? 3 - k : k)) % 3];
    }
  return out;
}

Outcome touching(std::uint64_t seed) {
  constexpr double kTocErrs[] = {1e-3, 1e-6, 1e-12};
  // One decision by integers serves all of them.
  constexpr std::uint64_t kVariants = 16;
  Outcome outcome;
  outcome.cases = kVariants;
  const MovingPair pair = generatedQuery(seed);
  Random random(seed ^ 0x7f4a7c15);
  const ElementaryResult truth = truthOf(pair);
  const bool can_be_scaled = canBeScaled(pair);
  MovingPair variant = pair;
  for (std::uint64_t i = 0; i < kVariants; ++i) {
    const double toc_err = kTocErrs[random.index(3)];
    expectTruth(variant, truth, toc_err, outcome);
    if (!outcome.isRight()) {
      outcome.complaint += asTest(variant, toc_err, expectationOf(truth));
      return outcome;
    }
    variant = variantOf(pair, can_be_scaled, random);
  }
  if (random.index(16) != 0) return outcome;
  CheckTally tally;
  const std::string text = disagreement(pair, seed, tally);
  if (!text.empty())
    outcome.blame(&Outcome::missed, text + asTest(pair, kTocErrs[0], ""));
  return outcome;
}

const RegisteredFamily kTouching("elementary", touching, 50);

}  // namespace
}  // namespace test
}  // namespace fcl
