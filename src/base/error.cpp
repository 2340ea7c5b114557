// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"

#include <stdexcept>

namespace fcl {
namespace detail {
namespace deformable {

void throwBadInput(const std::string& text) { throw std::invalid_argument(text); }

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
