// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_STOP_SIGNAL_H
#define FCL_CCD_STOP_SIGNAL_H

namespace fcl_ccd {

/// @brief After this call the first SIGINT, SIGTERM or SIGHUP asks the program to stop,
/// and another one ends it if it comes half a second after the first or later. Signals
/// that follow the first one at once count as one with it: timeout(1) sends SIGTERM to
/// the program and then to its group, which the program belongs to. A signal that was
/// ignored stays ignored. SIGPIPE and SIGXFSZ become errors of writing.
void catchStopSignals();

/// @brief The signal that asked the program to stop, or 0.
int stopSignal();

}  // namespace fcl_ccd

#endif
