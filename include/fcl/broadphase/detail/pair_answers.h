// SPDX-License-Identifier: BSD-3-Clause
//
// Tests box pairs in the order of their windows: for the first contact, any or all.
#ifndef FCL_BROADPHASE_DETAIL_PAIR_ANSWERS_H
#define FCL_BROADPHASE_DETAIL_PAIR_ANSWERS_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "fcl/narrowphase/continuous_contact.h"

namespace fcl {
namespace detail {

/// Pairs at the same time keep their order. std::stable_sort() would do it, but in
/// libstdc++ 12 it calls a deprecated function, of which clang 19 warns in the program.
/// @tparam Answer  has the answer of a pair as `result`
template <typename S, typename Answer>
void sortByTime(std::vector<Answer>& pairs) {
  std::vector<std::pair<S, std::size_t>> order;
  for (const Answer& pair : pairs)
    order.emplace_back(pair.result.time_of_contact, order.size());
  std::sort(order.begin(), order.end());
  std::vector<Answer> sorted;
  sorted.reserve(pairs.size());
  for (const auto& place : order) sorted.push_back(std::move(pairs[place.second]));
  pairs = std::move(sorted);
}

/// The bracket of a contact may depend on t_max, by up to toc_err. So if the times of two
/// pairs differ by less, their order may depend on it too. Therefore pairs are tested up
/// to 2 toc_err after the best time. At the end those in this range are tested again, up
/// to the request's t_max. So the answer does not depend on the order of the tests.
/// @return the pair that is first in contact, or none
template <typename Answer, typename S, typename Pair, typename Test>
std::vector<Answer> firstAnswer(const std::vector<Pair>& pairs,
                                const ContinuousContactRequest<S>& asked,
                                const Test& test) {
  struct InContact {
    std::size_t pair;
    bool is_cut;
    Answer tested;
  };
  std::vector<InContact> found;
  ContinuousContactRequest<S> request = asked;
  const S range =
      2 * std::max(asked.toc_err, S(0)) + 64 * std::numeric_limits<S>::epsilon();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    assert(i == 0 || pairs[i - 1].t_lo <= pairs[i].t_lo);
    if (pairs[i].t_lo > static_cast<double>(request.t_max)) break;
    Answer tested;
    if (!test(pairs[i], request, tested)) continue;
    const S latest = tested.result.time_of_contact + range;
    found.push_back({i, request.t_max < asked.t_max, std::move(tested)});
    request.t_max = std::min(request.t_max, latest);
  }
  const S latest = request.t_max;
  request.t_max = asked.t_max;
  std::vector<Answer> first;
  for (InContact& contact : found) {
    if (contact.tested.result.time_of_contact > latest) continue;
    if (contact.is_cut) test(pairs[contact.pair], request, contact.tested);
    if (first.empty())
      first.push_back(std::move(contact.tested));
    else if (contact.tested.result.time_of_contact < first.front().result.time_of_contact)
      first.front() = std::move(contact.tested);
  }
  // The earliest of those that were found is no later than `latest`.
  assert(first.empty() == found.empty());
  return first;
}

/// @brief The pairs in contact that a request asks for, sorted by time.
/// @param pairs  sorted by t_lo
/// @param asked  the test may set its filters
/// @param test  bool test(pair, request, answer): whether a pair is in contact
/// @throws fcl::Exception  a field of the request has no valid value, also without pairs
template <typename Answer, typename S, typename Pair, typename Test>
std::vector<Answer> answersOf(const std::vector<Pair>& pairs,
                              const ContinuousContactRequest<S>& asked,
                              const Test& test) {
  requireValid(asked);
  ContinuousContactRequest<S> request = asked;
  request.filter1 = request.filter2 = ContinuousFilter();
  if (request.query == ContinuousQuery::kFirst)
    return detail::firstAnswer<Answer>(pairs, request, test);
  std::vector<Answer> answers;
  for (const Pair& pair : pairs) {
    Answer tested;
    if (!test(pair, request, tested)) continue;
    answers.push_back(std::move(tested));
    if (request.query == ContinuousQuery::kAny) break;
  }
  detail::sortByTime<S>(answers);
  return answers;
}

}  // namespace detail
}  // namespace fcl

#endif
