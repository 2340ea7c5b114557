// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz_run.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <iterator>
#include <mutex>
#include <thread>

namespace fcl {
namespace test {
namespace {

constexpr std::size_t kMostComplaints = 5;

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

void add(const Outcome& outcome, Outcome& sum) {
  sum.cases += outcome.cases;
  sum.contacts += outcome.contacts;
  sum.missed += outcome.missed;
  sum.late += outcome.late;
  sum.invented += outcome.invented;
  sum.early += outcome.early;
  sum.exceptions += outcome.exceptions;
  sum.slowest_us = std::max(sum.slowest_us, outcome.slowest_us);
}

/// An exception is a fault: no case has unusable input.
Outcome ran(const Family& family, std::uint64_t seed) {
  currentCase() = {family.name, seed};
  try {
    return family.run(seed);
  } catch (const std::exception& error) {
    Outcome outcome;
    outcome.blame(&Outcome::exceptions, std::string("exception: ") + error.what() + "\n");
    return outcome;
  }
}

/// Hands out numbers of cases, and collects what threads found.
class Cases {
 public:
  Cases(const Family& family, const RunOptions& options, std::FILE* digests)
      : family_(family),
        options_(options),
        digests_(digests),
        row_{family.name, {}, 0, {}} {
    row_.sum.cases = 0;
  }

  void run() {
    Outcome sum;
    sum.cases = 0;
    // Blocks, so that short cases do not wait for each other.
    constexpr std::uint64_t kBlock = 16;
    for (std::uint64_t first = next_.fetch_add(kBlock); isWanted(first);
         first = next_.fetch_add(kBlock))
      for (std::uint64_t i = first; i < first + kBlock && isWanted(i); ++i) one(i, sum);
    const std::lock_guard<std::mutex> lock(mutex_);
    add(sum, row_.sum);
  }

  FamilyRow finished() {
    row_.seconds = secondsSince(begin_);
    while (row_.complaints.size() > kMostComplaints)
      row_.complaints.erase(std::prev(row_.complaints.end()));
    return std::move(row_);
  }

 private:
  bool isWanted(std::uint64_t i) const {
    if (options_.only) return i == 0;
    if (options_.seconds > 0) return secondsSince(begin_) < options_.seconds;
    return i < options_.cases * family_.share;
  }

  void one(std::uint64_t i, Outcome& sum) {
    const std::uint64_t seed =
        options_.only ? *options_.only : caseSeed(options_.seed, family_.name, i);
    const Outcome outcome = ran(family_, seed);
    add(outcome, sum);
    if (outcome.isRight() && !digests_) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (digests_)
      std::fprintf(digests_, "%s,%llu,0x%llx,%llx\n", family_.name,
                   static_cast<unsigned long long>(i),
                   static_cast<unsigned long long>(seed),
                   static_cast<unsigned long long>(outcome.digest));
    if (!outcome.isRight()) row_.complaints[seed] = outcome.complaint;
  }

  const Family& family_;
  const RunOptions& options_;
  std::FILE* digests_;
  FamilyRow row_;
  Clock::time_point begin_{Clock::now()};
  std::atomic<std::uint64_t> next_{0};
  std::mutex mutex_;
};

}  // namespace

FamilyRow runFamily(const Family& family, const RunOptions& options, std::FILE* digests) {
  Cases cases(family, options, digests);
  const unsigned wanted = options.threads
                              ? options.threads
                              : std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < wanted; ++i) threads.emplace_back([&cases] { cases.run(); });
  for (std::thread& thread : threads) thread.join();
  return cases.finished();
}

CurrentCase& currentCase() {
  static thread_local CurrentCase current;
  return current;
}

}  // namespace test
}  // namespace fcl
