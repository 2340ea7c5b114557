// SPDX-License-Identifier: BSD-3-Clause
//
//   load LIBRARY FUNCTION
// Loads a library with all that it needs, and calls a function of it that returns 0.
//   load LIBRARY "" NAME
// Loads a library, and prints which one has a name that is found in it.
#include <dlfcn.h>

#include <cstdio>
#include <string>

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) return 2;
  void* library = dlopen(argv[1], RTLD_NOW);
  if (!library) {
    std::printf("FAILED  %s\n", dlerror());
    return 1;
  }
  if (argc == 4) {
    Dl_info found;
    if (!dladdr(dlsym(library, argv[3]), &found)) return 1;
    std::printf("%s\n", found.dli_fname);
    return 0;
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
