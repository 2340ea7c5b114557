// SPDX-License-Identifier: BSD-3-Clause
#include "query_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include "elementary/axis_window.h"
#include "elementary/coplanarity_filter.h"
#include "elementary/exact.h"
#include "exact_oracle.h"
#include "query_generators.h"

namespace fcl {
namespace test {
namespace {

namespace deformable = detail::deformable;
using deformable::Answer;
using deformable::ElementaryResult;
using deformable::FeaturePoints;

/// A request below the distance of doubles is met up to this many units in the last
/// place.
constexpr int kMaxUlps = 4;

bool isNarrow(const ElementaryResult& r, double toc_err) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double ulp = std::nextafter(r.toc_hi, kInfinity) - r.toc_hi;
  return r.toc_hi - r.toc_lo <= std::max(toc_err, kMaxUlps * ulp);
}

/// Collects what is wrong with the answers to one query.
class Judge {
 public:
  explicit Judge(const OracleAnswer& truth) : truth_(truth) {}

  void expect(bool right, const char* who, const char* what) {
    if (right) return;
    out_ << who << ": " << what << "\n";
  }

  /// A final answer with its bracket.
  void expectAnswer(const ElementaryResult& r, double toc_err, const char* who) {
    const bool yes = r.answer == Answer::kYes;
    if (r.answer == Answer::kUnsure || yes != truth_.touch()) {
      out_ << who << " at " << toc_err << ": answers " << static_cast<int>(r.answer)
           << "\n";
      return;
    }
    if (!yes) return;
    std::ostringstream bracket;
    bracket << std::hexfloat << who << " [" << r.toc_lo << ", " << r.toc_hi << "] at "
            << toc_err;
    const std::string name = bracket.str();
    expect(0 <= r.toc_lo && r.toc_lo <= r.toc_hi && r.toc_hi <= 1, name.c_str(),
           "no bracket in [0, 1]");
    expect(truth_.compareTime(r.toc_lo) >= 0, name.c_str(), "too late");
    expect(truth_.compareTime(r.toc_hi) <= 0, name.c_str(), "too early");
    expect(isNarrow(r, toc_err), name.c_str(), "too wide");
    if (truth_.compareTime(0) == 0)
      expect(r.toc_hi == 0, name.c_str(), "contact at 0 not found exactly");
  }

  bool isFirstTimeIn(double lo, double hi) const {
    return truth_.touch() && truth_.compareTime(lo) >= 0 && truth_.compareTime(hi) <= 0;
  }

  std::string verdict(const MovingPair& pair) const {
    if (out_.str().empty()) return {};
    std::ostringstream text;
    text << pair << "\noracle: ";
    if (truth_.touch())
      text << "first contact in [" << static_cast<double>(truth_.lower()) << ", "
           << static_cast<double>(truth_.upper()) << "]\n";
    else
      text << "no contact\n";
    return text.str() + out_.str();
  }

 private:
  const OracleAnswer& truth_;
  std::ostringstream out_;
};

/// A window that begins before the first time and ends after it, if there is one.
void checkWindow(const MovingPair& pair, Random& random, double toc_err, Judge& judge) {
  const FeaturePoints x = pair.points();
  const double a = random.uniform(0, 1), b = random.uniform(0, 1);
  const double lo = random.index(2) ? 0 : std::min(a, b), hi = std::max(a, b);
  const bool touch = judge.isFirstTimeIn(lo, hi);
  if (touch)
    judge.expect(mayBecomeCoplanar(pair.kind, x, lo, hi), "filter on a window",
                 "culls a contact");
  const ElementaryResult r = solveCoplanarity(pair.kind, x, lo, hi, toc_err);
  if (r.answer == Answer::kYes) {
    judge.expect(judge.isFirstTimeIn(0, r.toc_hi), "solver on a window",
                 "invents a contact");
    judge.expect(isNarrow(r, toc_err), "solver on a window", "too wide");
  }
  if (!touch) return;
  judge.expect(r.answer != Answer::kNo, "solver on a window", "culls a contact");
  judge.expect(judge.isFirstTimeIn(r.toc_lo, r.toc_hi), "solver on a window",
               "bracket without the first contact");
}

void checkStages(const MovingPair& pair, double toc_err, Judge& judge) {
  const FeaturePoints x = pair.points();
  double lo = 0, hi = 1;
  const bool touch = judge.isFirstTimeIn(0, 1);
  if (!narrowWindow(pair.kind, x, lo, hi)) {
    judge.expect(!touch, "axis window", "culls a contact");
    return;
  }
  if (touch)
    judge.expect(judge.isFirstTimeIn(lo, hi), "axis window", "cuts the first contact");
  if (!mayBecomeCoplanar(pair.kind, x, lo, hi))
    judge.expect(!touch, "filter", "culls a contact");
  const ElementaryResult r = solveCoplanarity(pair.kind, x, lo, hi, toc_err);
  if (r.answer == Answer::kUnsure) {
    if (touch)
      judge.expect(judge.isFirstTimeIn(r.toc_lo, r.toc_hi), "solver, unsure",
                   "bracket without the first contact");
  } else {
    judge.expectAnswer(r, toc_err, "solver");
  }
}

}  // namespace

std::string disagreement(const MovingPair& pair, std::uint64_t number,
                         CheckTally& tally) {
  constexpr double kTocErrs[] = {1e-3, 1e-6, 1e-12};
  constexpr double kExactTocErrs[] = {1e-3, 1e-6, 1e-12, 1e-300};
  const FeaturePoints x = pair.points();
  const OracleAnswer truth = askOracle(pair.kind, x);
  Judge judge(truth);
  Random random(number);
  for (const double toc_err : kTocErrs) {
    const ElementaryResult r = elementaryTest(pair.kind, x, 0, 1, toc_err);
    judge.expectAnswer(r, toc_err, "elementary test");
    if (toc_err == kTocErrs[0])
      ++tally.decided_by[static_cast<std::size_t>(r.decided_by)];
  }
  const double exact_toc_err = kExactTocErrs[random.index(4)];
  judge.expectAnswer(decideExactly(pair.kind, x, exact_toc_err), exact_toc_err,
                     "exact test");
  const double toc_err = kTocErrs[random.index(3)];
  checkStages(pair, toc_err, judge);
  checkWindow(pair, random, toc_err, judge);

  ++tally.queries;
  tally.contacts += truth.touch();
  tally.contacts_at_start += truth.touch() && truth.compareTime(0) == 0;
  return judge.verdict(pair);
}

MovingPair generatedQuery(std::uint64_t number) {
  static const auto families = [] {
    std::vector<QueryFamily> degenerate, others;
    for (const QueryFamily& family : queryFamilies())
      (family.is_degenerate ? degenerate : others).push_back(family);
    return std::array<std::vector<QueryFamily>, 2>{degenerate, others};
  }();
  const auto& list = families[number % 2];
  Random random(number);
  return list[number / 2 % list.size()].generate(random);
}

}  // namespace test
}  // namespace fcl
