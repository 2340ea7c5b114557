// SPDX-License-Identifier: BSD-3-Clause
#include "stop_signal.h"

#include <atomic>
#include <csignal>
#include <initializer_list>

namespace fcl_ccd {
namespace {

std::atomic<int> received{0};
static_assert(std::atomic<int>::is_always_lock_free, "used in a signal handler");

extern "C" void requestStop(int signal_number) { received = signal_number; }

}  // namespace

void catchStopSignals() {
  for (const int signal_number : {SIGPIPE, SIGXFSZ}) std::signal(signal_number, SIG_IGN);
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction previous {};
    sigaction(signal_number, nullptr, &previous);
    if (previous.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = requestStop;
    // SA_RESETHAND: a second signal is not caught.
    action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
    sigaction(signal_number, &action, nullptr);
  }
}

int stopSignal() { return received; }

}  // namespace fcl_ccd
