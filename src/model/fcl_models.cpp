// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's models, with what builds their trees: the one place where they are compiled.
#include "model/model_instances.h"

namespace fcl {
FCL_CCD_FOR_VOLUMES(FCL_CCD_INSTANTIATE_FCL)
}  // namespace fcl
