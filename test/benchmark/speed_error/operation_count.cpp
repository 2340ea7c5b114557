// SPDX-License-Identifier: BSD-3-Clause
#include "operation_count.h"

#include <cstdint>

#include "interval_newton.h"

namespace fcl {
namespace test {
namespace {

struct Totals {
  std::uint64_t additions, multiplications, divisions;
} totals;

/// A double that counts what is done with it.
struct CountedNumber {
  double value;

  CountedNumber() = default;
  explicit CountedNumber(double v) : value(v) {}
};

using Number = CountedNumber;
Number operator+(Number a, Number b) {
  ++totals.additions;
  return Number(a.value + b.value);
}
Number operator-(Number a, Number b) {
  ++totals.additions;
  return Number(a.value - b.value);
}
Number operator*(Number a, Number b) {
  ++totals.multiplications;
  return Number(a.value * b.value);
}
Number operator/(Number a, Number b) {
  ++totals.divisions;
  return Number(a.value / b.value);
}
bool operator<(Number a, Number b) { return a.value < b.value; }
bool operator>(Number a, Number b) { return a.value > b.value; }
bool operator<=(Number a, Number b) { return a.value <= b.value; }
bool operator==(Number a, Number b) { return a.value == b.value; }

template <typename Method>
OperationCount averageOver(const QuerySet& set, Method&& method) {
  totals = {};
  for (const MovingPair& query : set.queries) method(query);
  const double n = static_cast<double>(set.queries.size());
  return {static_cast<double>(totals.additions) / n,
          static_cast<double>(totals.multiplications) / n,
          static_cast<double>(totals.divisions) / n};
}

}  // namespace

OperationCount operationsOfFilter(const QuerySet& set) {
  return averageOver(set, [](const MovingPair& query) {
    const RelativePair<Number> pair(query.kind, query.points());
    return CoplanarityCubic<Number>(pair).hasOneSign();
  });
}

OperationCount operationsOfIntervalNewton(const QuerySet& set, double resolution) {
  return averageOver(set, [resolution](const MovingPair& query) {
    const RelativePair<Number> pair(query.kind, query.points());
    return firstTimeByIntervalNewton(pair, CoplanarityCubic<Number>(pair),
                                     Number(resolution), Number(resolution));
  });
}

}  // namespace test
}  // namespace fcl
