// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_TEST_SUPPORT_SHARED_DATA_H
#define FCL_TEST_SUPPORT_SHARED_DATA_H

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <system_error>

namespace fcl {
namespace test {

/// @brief The message of a test that is skipped because these data are missing.
constexpr const char* kNoSharedData =
    "the public data are not here; doc/data.md says where they come from, and "
    "FCL_CCD_TEST_DATA=FOLDER tells the tests where they are";

/// @brief The path of a file or folder of the public data, which are outside of the
/// project: in $FCL_CCD_TEST_DATA, or next to the project. If it does not exist, prints
/// this and returns nothing; with CI=true the test fails.
inline std::optional<std::string> sharedData(const std::string& relative) {
  const char* root = std::getenv("FCL_CCD_TEST_DATA");
  const std::string path =
      (root && *root ? std::string(root)
                     : std::string(FCL_CCD_SOURCE_DIR) + "/../shared/data") +
      "/" + relative;
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return path;
  const char* ci = std::getenv("CI");
  EXPECT_FALSE(ci && std::string(ci) == "true") << path << " is not there";
  std::cout << "not there, so not tested: " << path << "\n";
  return std::nullopt;
}

}  // namespace test
}  // namespace fcl

#endif
