// SPDX-License-Identifier: BSD-3-Clause
//
// The former name of continuous_features.h.
#ifndef FCL_NARROWPHASE_CONTINUOUS_FEATURE_TEST_H
#define FCL_NARROWPHASE_CONTINUOUS_FEATURE_TEST_H

#include "fcl/narrowphase/continuous_features.h"

#endif
