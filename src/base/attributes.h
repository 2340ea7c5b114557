// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_BASE_ATTRIBUTES_H
#define FCL_CCD_BASE_ATTRIBUTES_H

/// A function that is rarely called from a place that must stay short.
#if defined(__GNUC__) || defined(__clang__)
#define FCL_CCD_NOINLINE __attribute__((noinline))
#elif defined(_MSC_VER)
#define FCL_CCD_NOINLINE __declspec(noinline)
#else
#define FCL_CCD_NOINLINE
#endif

#endif
