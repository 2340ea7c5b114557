// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_IN_ORDER_H
#define FCL_CCD_IN_ORDER_H

#include <cassert>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace fcl_ccd {

/// @brief Makes the results of [begin, end) on several threads, and passes them to one
/// thread in their order.
///
/// `make(i, worker)` runs on the threads 0, 1, ... of `num_workers`; `take(i, result)`
/// and `pause()` run on the caller's thread. After pause() has returned false no new item
/// is begun; items that were begun are finished and taken. An exception of make(i) is
/// thrown after all items before i have been taken. An exception of take() is thrown at
/// once. At most 2 * num_workers results are kept. With one worker there is no other
/// thread. If the system gives fewer threads, those that there are do the work.
template <typename Result, typename Make, typename Take, typename Pause>
class InOrder {
 public:
  InOrder(std::size_t begin, std::size_t end, std::size_t num_workers, Make make,
          Take take, Pause pause)
      : next_(begin),
        taken_(begin),
        end_(end),
        num_workers_(num_workers),
        make_(make),
        take_(take),
        pause_(pause) {}

  void run() {
    if (num_workers_ <= 1) return runHere();
    const Workers workers(*this);
    if (workers.empty()) return runHere();
    std::unique_lock<std::mutex> lock(mutex_);
    while (!isDone()) {
      const auto found = results_.find(taken_);
      if (found == results_.end()) {
        changed_.wait_for(lock, std::chrono::milliseconds(50));
      } else {
        Outcome outcome = std::move(found->second);
        results_.erase(found);
        lock.unlock();
        if (outcome.error) std::rethrow_exception(outcome.error);
        take_(taken_, std::move(*outcome.result));
        lock.lock();
        ++taken_;
        changed_.notify_all();
      }
      lock.unlock();
      const bool go_on = pause_();
      lock.lock();
      if (!go_on) end_ = next_;
    }
  }

 private:
  void runHere() {
    for (; next_ < end_ && pause_(); ++next_) take_(next_, make_(next_, std::size_t{0}));
  }

  struct Outcome {
    std::optional<Result> result;
    std::exception_ptr error;
  };

  /// The threads. They are always joined, also after an exception.
  class Workers {
   public:
    explicit Workers(InOrder& all) : all_(all) {
      threads_.reserve(all_.num_workers_);
      try {
        for (std::size_t i = 0; i < all_.num_workers_; ++i)
          threads_.emplace_back([this, i] { all_.work(i); });
      } catch (const std::system_error&) {
        // The system gives no more threads.
      }
    }
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;
    ~Workers() {
      {
        const std::lock_guard<std::mutex> lock(all_.mutex_);
        all_.end_ = all_.next_;
      }
      all_.changed_.notify_all();
      for (std::thread& thread : threads_) thread.join();
    }

    bool empty() const { return threads_.empty(); }

   private:
    InOrder& all_;
    std::vector<std::thread> threads_;
  };

  bool isDone() const { return taken_ == end_; }

  void work(std::size_t worker) {
    std::unique_lock<std::mutex> lock(mutex_);
    while (true) {
      changed_.wait(lock,
                    [&] { return next_ >= end_ || next_ < taken_ + 2 * num_workers_; });
      if (next_ >= end_) return;
      const std::size_t i = next_++;
      assert(taken_ <= i && i < taken_ + 2 * num_workers_);
      lock.unlock();
      Outcome outcome;
      try {
        outcome.result.emplace(make_(i, worker));
      } catch (...) {
        outcome.error = std::current_exception();
      }
      lock.lock();
      results_.emplace(i, std::move(outcome));
      assert(results_.size() <= 2 * num_workers_);
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::size_t, Outcome> results_;
  std::size_t next_;   ///< the next item to begin
  std::size_t taken_;  ///< all items before it have been taken
  std::size_t end_;
  std::size_t num_workers_;
  Make make_;
  Take take_;
  Pause pause_;
};

template <typename Result, typename Make, typename Take, typename Pause>
void inOrder(std::size_t begin, std::size_t end, std::size_t num_workers, Make make,
             Take take, Pause pause) {
  InOrder<Result, Make, Take, Pause>(begin, end, num_workers, make, take, pause).run();
}

}  // namespace fcl_ccd

#endif
