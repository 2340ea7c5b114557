// SPDX-License-Identifier: BSD-3-Clause
#include "methods.h"

#include "elementary/axis_window.h"
#include "elementary/coplanarity_filter.h"
#include "plain_solvers.h"

namespace fcl {
namespace test {
namespace {

namespace deformable = detail::deformable;
using deformable::Answer;
using deformable::ElementaryResult;

MethodAnswer withoutStages(const SolverAnswer& answer) {
  return {answer.contact, answer.toc, 0};
}

/// What a user has who takes no answer for a contact, as every conservative caller must.
MethodAnswer withStages(const ElementaryResult& result) {
  return {result.answer != Answer::kNo, result.toc_lo,
          static_cast<int>(result.decided_by)};
}

MethodAnswer fclStock(const MovingPair& query, double) {
  return withoutStages(solveByFcl(query.kind, query.points()));
}

MethodAnswer cubic(const MovingPair& query, double inside_tol) {
  return withoutStages(solveCubic(query.kind, query.points(), inside_tol));
}

MethodAnswer intervalNewton(const MovingPair& query, double resolution) {
  return withoutStages(
      solveByIntervalNewton(query.kind, query.points(), resolution, false));
}

MethodAnswer filteredIntervalNewton(const MovingPair& query, double resolution) {
  return withoutStages(
      solveByIntervalNewton(query.kind, query.points(), resolution, true));
}

MethodAnswer certifiedStages(const MovingPair& query, double toc_err) {
  const deformable::FeaturePoints x = query.points();
  double lo = 0, hi = 1;
  if (!deformable::narrowWindow(query.kind, x, lo, hi))
    return {false, 0, static_cast<int>(deformable::DecidedBy::kBox)};
  if (!deformable::mayBecomeCoplanar(query.kind, x, lo, hi))
    return {false, 0, static_cast<int>(deformable::DecidedBy::kFilter)};
  return withStages(deformable::solveCoplanarity(query.kind, x, lo, hi, toc_err));
}

MethodAnswer wholeTest(const MovingPair& query, double toc_err) {
  return withStages(
      deformable::elementaryTest(query.kind, query.points(), 0, 1, toc_err));
}

MethodAnswer plainFilter(const MovingPair& query, double) {
  return {passesPlainFilter(query.kind, query.points()), 0, 0};
}

MethodAnswer certifiedFilter(const MovingPair& query, double) {
  return {deformable::mayBecomeCoplanar(query.kind, query.points(), 0, 1), 0, 0};
}

MethodAnswer windowedFilter(const MovingPair& query, double) {
  const deformable::FeaturePoints x = query.points();
  double lo = 0, hi = 1;
  return {deformable::narrowWindow(query.kind, x, lo, hi) &&
              deformable::mayBecomeCoplanar(query.kind, x, lo, hi),
          0, 0};
}

}  // namespace

std::vector<Method> allMethods() {
  return {{"fcl-stock", "", 0, false, fclStock},
          {"cubic", "1e-6", 1e-6, false, cubic},
          {"cubic", "1e-8", 1e-8, false, cubic},
          {"cubic", "1e-10", 1e-10, false, cubic},
          {"interval-newton", "1e-3", 1e-3, false, intervalNewton},
          {"interval-newton", "1e-6", 1e-6, false, intervalNewton},
          {"interval-newton", "1e-9", 1e-9, false, intervalNewton},
          {"filter+interval-newton", "1e-3", 1e-3, false, filteredIntervalNewton},
          {"filter+interval-newton", "1e-6", 1e-6, false, filteredIntervalNewton},
          {"filter+interval-newton", "1e-9", 1e-9, false, filteredIntervalNewton},
          {"ours-without-exact", "1e-3", 1e-3, true, certifiedStages},
          {"ours-without-exact", "1e-6", 1e-6, true, certifiedStages},
          {"ours", "1e-3", 1e-3, true, wholeTest},
          {"ours", "1e-6", 1e-6, true, wholeTest},
          {"ours", "1e-9", 1e-9, true, wholeTest},
          {"ours", "1e-12", 1e-12, true, wholeTest}};
}

std::vector<Method> filters() {
  return {{"plain", "", 0, false, plainFilter},
          {"certified", "", 0, false, certifiedFilter},
          {"boxes+certified", "", 0, false, windowedFilter}};
}

}  // namespace test
}  // namespace fcl
