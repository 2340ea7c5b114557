// SPDX-License-Identifier: BSD-3-Clause
//
// Another name of continuous_features.h. New programs include that one.
#ifndef FCL_NARROWPHASE_CONTINUOUS_FEATURE_TEST_H
#define FCL_NARROWPHASE_CONTINUOUS_FEATURE_TEST_H

#include "fcl/narrowphase/continuous_features.h"

#endif
