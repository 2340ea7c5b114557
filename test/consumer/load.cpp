// SPDX-License-Identifier: BSD-3-Clause
//
//   load LIBRARY FUNCTION
// Loads a library with all that it needs, and calls a function of it that returns 0.
#include <dlfcn.h>

#include <cstdio>
#include <string>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  void* library = dlopen(argv[1], RTLD_NOW);
  if (!library) {
    std::printf("FAILED  %s\n", dlerror());
    return 1;
  }
  const std::string name = argv[2];
  if (name.empty()) return 0;
  // The name as C++ has it: a function without parameters.
  const std::string symbol = "_Z" + std::to_string(name.size()) + name + "v";
  auto* function = reinterpret_cast<int (*)()>(dlsym(library, symbol.c_str()));
  if (!function) {
    std::printf("FAILED  %s\n", dlerror());
    return 1;
  }
  return function();
}
