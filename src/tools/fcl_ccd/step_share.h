// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_STEP_SHARE_H
#define FCL_CCD_STEP_SHARE_H

#include <cstddef>

namespace fcl_ccd {

/// @brief The steps of one process: first, first + stride, ... below end.
struct StepShare {
  std::size_t first{0};
  std::size_t end{0};
  std::size_t stride{1};

  std::size_t size() const { return first < end ? (end - first - 1) / stride + 1 : 0; }
  std::size_t operator[](std::size_t i) const { return first + i * stride; }
  bool has(std::size_t step) const {
    return step >= first && step < end && (step - first) % stride == 0;
  }
};

}  // namespace fcl_ccd

#endif
