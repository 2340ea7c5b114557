// SPDX-License-Identifier: BSD-3-Clause
//
// Tests box pairs in the order of their windows: for the first contact, any or all.
// Several threads test a block of pairs at a time, whose answers are then taken in order:
// what is taken does not depend on the number of threads.
#ifndef FCL_BROADPHASE_DETAIL_PAIR_ANSWERS_H
#define FCL_BROADPHASE_DETAIL_PAIR_ANSWERS_H

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <exception>
#include <functional>
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
  order.reserve(pairs.size());
  for (const Answer& pair : pairs)
    order.emplace_back(pair.result.time_of_contact, order.size());
  std::sort(order.begin(), order.end());
  std::vector<Answer> sorted;
  sorted.reserve(pairs.size());
  for (const auto& place : order) sorted.push_back(std::move(pairs[place.second]));
  pairs = std::move(sorted);
}

/// @brief Calls visit(0) ... visit(count - 1), each once, in up to num_threads threads
/// (0: as many as the oneTBB task arena around the call has). If calls throw, the
/// exception of the lowest number is thrown at the end.
FCL_EXPORT void visitInThreads(std::size_t count, int num_threads,
                               const std::function<void(std::size_t)>& visit);

/// @brief The answers of pairs, a block of them at a time.
/// @tparam Test  bool test(pair, request, answer): whether a pair is in contact. It may
/// change the request
template <typename Answer, typename S, typename Pair, typename Test>
class PairTests {
 public:
  using Request = ContinuousContactRequest<S>;

  /// What a pair has got. A pair that throws has got nothing.
  struct Tested {
    bool is_collide{false};
    std::exception_ptr error;
    Answer answer;
  };

  /// A filter of the user may not be made for calls in several threads, which come only
  /// for large meshes otherwise: pairs come one after the other then.
  PairTests(const std::vector<Pair>& pairs, const Request& request, const Test& test)
      : pairs_(pairs),
        test_(test),
        num_threads_(request.accepts_triangles ? 1 : request.num_threads),
        most_in_block_(request.query == ContinuousQuery::kAll ? 1024 : 64) {}

  /// The pairs of the next block: one, if there are no threads.
  std::size_t nextBlock(std::size_t first) {
    const std::size_t count = std::min(block_, pairs_.size() - first);
    if (num_threads_ != 1) block_ = std::min(2 * block_, most_in_block_);
    return count;
  }

  /// Tests a block of pairs. Those that begin after the request's t_max are left out.
  std::vector<Tested>& test(std::size_t first, std::size_t count, Request& request) {
    block_tested_.clear();
    block_tested_.resize(count);
    if (count == 1) {
      testOne(pairs_[first], request, block_tested_[0]);
      return block_tested_;
    }
    detail::visitInThreads(count, num_threads_, [&](std::size_t i) {
      Request own = request;
      testOne(pairs_[first + i], own, block_tested_[i]);
    });
    return block_tested_;
  }

 private:
  void testOne(const Pair& pair, Request& request, Tested& tested) const {
    if (pair.t_lo > static_cast<double>(request.t_max)) return;
    try {
      tested.is_collide = test_(pair, request, tested.answer);
    } catch (...) {
      tested.error = std::current_exception();
    }
  }

  const std::vector<Pair>& pairs_;
  const Test& test_;
  const int num_threads_;
  /// So many are tested in vain where one pair ends the query.
  const std::size_t most_in_block_;
  std::size_t block_{1};
  std::vector<Tested> block_tested_;
};

/// @brief Sets the distance of a pair: that of the request, and what its objects add.
/// Without any distance no pair begins nearer than it.
template <typename S>
void addDistance(const ContinuousContactRequest<S>& request, S added,
                 ContinuousContactRequest<S>& asked) {
  asked.min_distance = request.min_distance + added;
  asked.ignore_initially_closer =
      request.ignore_initially_closer && asked.min_distance > 0;
}

/// @brief Pairs in contact, and how many were tested.
template <typename Answer>
struct PairAnswers {
  std::vector<Answer> pairs;
  std::size_t num_tested{0};
};

/// @brief A pair in contact, in a query for the first one.
template <typename Answer>
struct PairInContact {
  std::size_t pair;
  /// Whether it was tested up to an earlier time than the request's t_max.
  bool is_cut;
  Answer tested;
};

/// @brief Tests a pair again up to the request's t_max, if it was not.
/// @return whether it is in contact at t = 0: no other pair is earlier
template <typename Answer, typename S, typename Pair, typename Test>
bool isAtBegin(const Pair& pair, const ContinuousContactRequest<S>& asked,
               const Test& test, PairInContact<Answer>& contact) {
  if (contact.is_cut) {
    ContinuousContactRequest<S> whole = asked;
    test(pair, whole, contact.tested);
    contact.is_cut = false;
  }
  return contact.tested.result.time_of_contact <= 0;
}

/// The bracket of a contact may depend on t_max, by up to toc_err. So if the times of two
/// pairs differ by less, their order may depend on it too. Therefore pairs are tested up
/// to 2 toc_err after the best time. At the end those in this range are tested again, up
/// to the request's t_max. So the answer does not depend on the order of the tests, nor
/// on how many pairs are in a block.
/// @return the pair that is first in contact, or none
template <typename Answer, typename S, typename Pair, typename Test>
PairAnswers<Answer> firstAnswer(const std::vector<Pair>& pairs,
                                const ContinuousContactRequest<S>& asked,
                                const Test& test) {
  std::vector<PairInContact<Answer>> found;
  ContinuousContactRequest<S> request = asked;
  const S range =
      2 * std::max(asked.toc_err, S(0)) + 64 * std::numeric_limits<S>::epsilon();
  PairAnswers<Answer> out;
  PairTests<Answer, S, Pair, Test> tests(pairs, request, test);
  // Nothing is earlier than 0.
  bool is_done = false;
  for (std::size_t first = 0; first < pairs.size() && !is_done;) {
    const std::size_t count = tests.nextBlock(first);
    const bool is_cut = request.t_max < asked.t_max;
    auto& block = tests.test(first, count, request);
    for (std::size_t i = 0; i < count && !is_done; ++i) {
      const Pair& pair = pairs[first + i];
      assert(first + i == 0 || pairs[first + i - 1].t_lo <= pair.t_lo);
      if (pair.t_lo > static_cast<double>(request.t_max)) break;
      ++out.num_tested;
      if (block[i].error) std::rethrow_exception(block[i].error);
      if (!block[i].is_collide) continue;
      const S time = block[i].answer.result.time_of_contact;
      // Another pair of the block made t_max earlier.
      if (time > request.t_max) continue;
      found.push_back({first + i, is_cut, std::move(block[i].answer)});
      is_done = time <= 0 && isAtBegin(pair, asked, test, found.back());
      request.t_max = std::min(request.t_max, time + range);
    }
    first += count;
    if (first < pairs.size() && pairs[first].t_lo > static_cast<double>(request.t_max))
      break;
  }
  const S latest = request.t_max;
  request.t_max = asked.t_max;
  for (PairInContact<Answer>& contact : found) {
    if (contact.tested.result.time_of_contact > latest) continue;
    if (contact.is_cut) test(pairs[contact.pair], request, contact.tested);
    if (out.pairs.empty())
      out.pairs.push_back(std::move(contact.tested));
    else if (contact.tested.result.time_of_contact <
             out.pairs.front().result.time_of_contact)
      out.pairs.front() = std::move(contact.tested);
  }
  // The earliest of those that were found is no later than `latest`.
  assert(out.pairs.empty() == found.empty());
  return out;
}

/// @brief Gives the pairs in contact that a request asks for to `take`, one after the
/// other in the order of the pairs.
/// @param pairs  sorted by t_lo
/// @param asked  the test may set its filters. Its num_threads is for the pairs
/// @param test  as for PairTests; several threads call it if the request has them
/// @param take  bool take(answer): whether the query ends
/// @return the number of pairs that were tested
/// @throws fcl::Exception  a field of the request has no valid value, also without pairs
template <typename Answer, typename S, typename Pair, typename Test, typename Take>
std::size_t giveAnswers(const std::vector<Pair>& pairs,
                        const ContinuousContactRequest<S>& asked, const Test& test,
                        const Take& take) {
  requireValid(asked);
  ContinuousContactRequest<S> request = asked;
  request.filter1 = request.filter2 = ContinuousFilter();
  if (request.query == ContinuousQuery::kFirst) {
    PairAnswers<Answer> answers = detail::firstAnswer<Answer>(pairs, request, test);
    for (Answer& answer : answers.pairs) take(std::move(answer));
    return answers.num_tested;
  }
  PairTests<Answer, S, Pair, Test> tests(pairs, request, test);
  const bool is_any = request.query == ContinuousQuery::kAny;
  std::size_t num_tested = 0;
  for (std::size_t first = 0; first < pairs.size();) {
    const std::size_t count = tests.nextBlock(first);
    for (auto& tested : tests.test(first, count, request)) {
      ++num_tested;
      if (tested.error) std::rethrow_exception(tested.error);
      if (tested.is_collide && (take(std::move(tested.answer)) || is_any))
        return num_tested;
    }
    first += count;
  }
  return num_tested;
}

/// @brief As giveAnswers(): the pairs, sorted by time.
template <typename Answer, typename S, typename Pair, typename Test>
PairAnswers<Answer> answersOf(const std::vector<Pair>& pairs,
                              const ContinuousContactRequest<S>& asked,
                              const Test& test) {
  PairAnswers<Answer> out;
  out.num_tested = detail::giveAnswers<Answer>(pairs, asked, test, [&](Answer&& answer) {
    out.pairs.push_back(std::move(answer));
    return false;
  });
  detail::sortByTime<S>(out.pairs);
  return out;
}

}  // namespace detail
}  // namespace fcl

#endif
