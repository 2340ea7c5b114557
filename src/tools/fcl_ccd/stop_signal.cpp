// SPDX-License-Identifier: BSD-3-Clause
#include "stop_signal.h"

#include <time.h>

#include <atomic>
#include <csignal>
#include <cstdint>
#include <initializer_list>

namespace fcl_ccd {
namespace {

std::atomic<int> received{0};
std::atomic<std::int64_t> received_at{0};  ///< nanoseconds of a clock; 0: not received
static_assert(std::atomic<int>::is_always_lock_free &&
                  std::atomic<std::int64_t>::is_always_lock_free,
              "used in a signal handler");

/// Signals within this time of the first one are one with it.
constexpr std::int64_t kOneSignal = 500'000'000;

// All that is called here may be called in a signal handler (POSIX, 2.4.3).
extern "C" void requestStop(int signal_number) {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  const std::int64_t now =
      std::int64_t{time.tv_sec} * 1'000'000'000 + std::int64_t{time.tv_nsec};
  std::int64_t first = 0;
  if (received_at.compare_exchange_strong(first, now)) {
    received = signal_number;
  } else if (now - first >= kOneSignal) {
    std::signal(signal_number, SIG_DFL);
    std::raise(signal_number);  // ends the program when this function returns
  }
}

}  // namespace

void catchStopSignals() {
  for (const int signal_number : {SIGPIPE, SIGXFSZ}) std::signal(signal_number, SIG_IGN);
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction previous {};
    sigaction(signal_number, nullptr, &previous);
    if (previous.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = requestStop;
    action.sa_flags = SA_RESTART;
    sigaction(signal_number, &action, nullptr);
  }
}

int stopSignal() { return received; }

}  // namespace fcl_ccd
