// SPDX-License-Identifier: BSD-3-Clause
#include "errors.h"

namespace fcl {
namespace test {

Errors errorsOf(const std::vector<PairName>& found, const std::vector<PairName>& truth) {
  std::size_t right = 0;
  for (auto f = found.begin(), t = truth.begin(); f != found.end() && t != truth.end();) {
    right += *f == *t;
    if (*f < *t)
      ++f;
    else if (*t < *f)
      ++t;
    else
      ++f, ++t;
  }
  return {truth.size() - right, found.size() - right};
}

}  // namespace test
}  // namespace fcl
