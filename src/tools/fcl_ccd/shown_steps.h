// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SHOWN_STEPS_H
#define FCL_CCD_SHOWN_STEPS_H

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "frame_list.h"

namespace fcl_ccd {

/// @brief Which moments the options --picture and --paint show. A file whose name has a
/// number is one of many: a step each.
struct ShownMoments {
  std::vector<std::size_t> steps;  ///< numbers; empty: see has()
  std::optional<double> time;      ///< default: that of the step's first contact, or 1

  /// @brief Whether a step is shown in a file. Without --at-step a file of many shows all
  /// steps. A single file then shows the step of the run's first contact.
  bool has(std::size_t number, const std::string& path) const {
    if (steps.empty()) return hasNumber(path);
    return std::find(steps.begin(), steps.end(), number) != steps.end();
  }

  /// @brief Whether a file shows the step of the run's first contact.
  bool isOfFirstContact(const std::string& path) const {
    return steps.empty() && !path.empty() && !hasNumber(path);
  }
};

/// @brief Tells which steps may be that of the run's first contact, while several threads
/// make steps.
class FirstContactGuess {
 public:
  /// @brief Whether no step before this one is known to have a contact. Then the step
  /// may be the one to show.
  /// @param is_last  also the last step is to be shown if no step has a contact.
  bool mayBeFirst(std::size_t step, bool has_contact, bool is_last) {
    if (!has_contact) return is_last && step < first_;
    std::size_t first = first_;
    while (step < first && !first_.compare_exchange_weak(first, step)) {
    }
    return step < first;
  }

 private:
  std::atomic<std::size_t> first_{std::numeric_limits<std::size_t>::max()};
};

}  // namespace fcl_ccd

#endif
