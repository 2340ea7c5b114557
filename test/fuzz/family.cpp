// SPDX-License-Identifier: BSD-3-Clause
#include "family.h"

#include <algorithm>

#include "mesh_generators.h"

namespace fcl {
namespace test {
namespace {

std::vector<Family>& registered() {
  static std::vector<Family> all;
  return all;
}

PlantedFault& planted() {
  static PlantedFault fault = PlantedFault::kNone;
  return fault;
}

}  // namespace

std::vector<Family> families() {
  // The order in which files are linked says nothing.
  std::vector<Family> all = registered();
  std::sort(all.begin(), all.end(), [](const Family& x, const Family& y) {
    return std::strcmp(x.name, y.name) < 0;
  });
  return all;
}

RegisteredFamily::RegisteredFamily(const char* name, Outcome (*run)(std::uint64_t),
                                   std::uint64_t share) {
  registered().push_back({name, run, share});
}

std::uint64_t caseSeed(std::uint64_t seed, const char* family, std::uint64_t index) {
  std::uint64_t state = seed;
  for (const char* c = family; *c; ++c)
    state = Random(state ^ static_cast<unsigned char>(*c)).next();
  return Random(state ^ Random(index).next()).next();
}

PlantedFault plantedFault() { return planted(); }
void plantFault(PlantedFault fault) { planted() = fault; }

}  // namespace test
}  // namespace fcl
