# SPDX-License-Identifier: BSD-3-Clause

# A toolchain file of CMake: from a Debian system for arm64 (aarch64). Programs for arm64 run in
# qemu. FCL_CCD_SYSROOT is a folder with Debian's packages for arm64; cmake/arm64.sh makes one.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_SYSROOT ${FCL_CCD_SYSROOT})
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES FCL_CCD_SYSROOT)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static -L ${CMAKE_SYSROOT})
