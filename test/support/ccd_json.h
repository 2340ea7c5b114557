// SPDX-License-Identifier: BSD-3-Clause
//
// Tests of the program that read its JSON.
#ifndef FCL_TEST_SUPPORT_CCD_JSON_H
#define FCL_TEST_SUPPORT_CCD_JSON_H

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "ccd_tool.h"

namespace fcl {
namespace test {

class CcdJsonTest : public CcdToolTest {
 protected:
  nlohmann::json json(const std::string& name) const {
    return nlohmann::json::parse(readText(path(name)));
  }
};

inline std::set<std::string> keysOf(const nlohmann::json& object) {
  std::set<std::string> keys;
  for (const auto& item : object.items()) keys.insert(item.key());
  return keys;
}

}  // namespace test
}  // namespace fcl

#endif
