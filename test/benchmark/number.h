// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_BENCHMARK_NUMBER_H
#define FCL_BENCHMARK_NUMBER_H

#include <cstdio>
#include <string>

namespace fcl {
namespace test {

/// @brief A number as a field of a table.
inline std::string number(double value, const char* format = "%.3f") {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace test
}  // namespace fcl

#endif
