// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TOOLS_JSON_H
#define FCL_CCD_TOOLS_JSON_H

#include <nlohmann/json.hpp>

namespace fcl_ccd {

/// @brief JSON whose objects keep the order in which their parts were added, so that a
/// file lists them as its documentation does.
using Json = nlohmann::ordered_json;

}  // namespace fcl_ccd

#endif
