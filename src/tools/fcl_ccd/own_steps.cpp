// SPDX-License-Identifier: BSD-3-Clause
#include "own_steps.h"

#include <exception>
#include <utility>

#include "in_order.h"
#include "run_command.h"
#include "stop_signal.h"

namespace fcl_ccd {
namespace {

/// Steps that wait for other ranks: a block is taken while the next one is made.
constexpr std::size_t kMostWaiting = 2 * StepShare::kBlock;

}  // namespace

OwnSteps::OwnSteps(StepMaker& maker) : maker_(maker), thread_([this] { run(); }) {}

OwnSteps::~OwnSteps() {
  stop();
  thread_.join();
}

std::optional<StepOutcome> OwnSteps::next(std::chrono::milliseconds time) {
  std::unique_lock<std::mutex> lock(mutex_);
  if (!changed_.wait_for(lock, time, [this] { return !outcomes_.empty(); }))
    return std::nullopt;
  StepOutcome outcome = std::move(outcomes_.front());
  outcomes_.pop_front();
  changed_.notify_all();
  return outcome;
}

void OwnSteps::stop() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
}

void OwnSteps::run() { put(makeAll()); }

StepOutcome OwnSteps::makeAll() {
  try {
    inOrder<StepRecord>(
        0, maker_.share().size(), maker_.numJobs(),
        [&](std::size_t i, std::size_t worker) { return maker_.make(i, worker); },
        [&](std::size_t, StepRecord record) {
          put({std::move(record), 0, ""});
        },
        [&] { return !stopped_ && stopSignal() == 0; });
  } catch (const std::exception& error) {
    return {std::nullopt, kBadFrame, error.what()};
  }
  return stopSignal() == 0 ? StepOutcome() : endBySignal();
}

void OwnSteps::put(StepOutcome outcome) {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [&] { return stopped_ || outcomes_.size() < kMostWaiting; });
  outcomes_.push_back(std::move(outcome));
  changed_.notify_all();
}

}  // namespace fcl_ccd
