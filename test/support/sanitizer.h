// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_SANITIZER_H
#define FCL_TEST_SUPPORT_SANITIZER_H

namespace fcl {
namespace test {

/// @brief Whether the address sanitizer is on. gcc and clang tell it in different ways;
/// Eigen defines __has_feature for gcc, as 0.
#if defined(__SANITIZE_ADDRESS__)
constexpr bool kHasAddressSanitizer = true;
#elif defined(__has_feature)
constexpr bool kHasAddressSanitizer = __has_feature(address_sanitizer);
#else
constexpr bool kHasAddressSanitizer = false;
#endif

/// @brief `count` random cases, or an eighth of them under the address sanitizer. It
/// looks for errors in memory, which need fewer cases than wrong answers, and each takes
/// 10 to 20 times as long. An emulated processor takes 20 to 40 times as long: a 64th.
template <typename Count>
constexpr Count rounds(Count count) {
#if defined(FCL_CCD_TEST_FEW_CASES)
  return (count + 63) / 64;
#else
  return kHasAddressSanitizer ? (count + 7) / 8 : count;
#endif
}

/// @brief The same, but an eighth at least, for tests that tell what happens on average.
template <typename Count>
constexpr Count manyRounds(Count count) {
#if defined(FCL_CCD_TEST_FEW_CASES)
  return (count + 7) / 8;
#else
  return rounds(count);
#endif
}

}  // namespace test
}  // namespace fcl

#endif
