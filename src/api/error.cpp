// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"

#include "fcl/common/exception.h"

namespace fcl {
namespace detail {
namespace deformable {

void throwBadInput(const std::string& text) { throw Exception(text); }

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
