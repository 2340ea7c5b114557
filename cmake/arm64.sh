#!/usr/bin/env bash
# Compiles the project for arm64 (aarch64) on another machine, runs the tests in qemu, and
# compares the answers with those of this machine. The system stays as it is, but for the
# compiler, qemu and mmdebstrap, which it installs (Debian).
#   bash cmake/arm64.sh           library, program, Python module, unit tests, digests of answers
#   bash cmake/arm64.sh --short   library, and the tests and digests that tell most
# The tests have fewer random cases there, since qemu takes 20 to 40 times as long.
# Debian's packages for arm64 and the build are in build/arm64.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=cmake/dependencies.sh
source cmake/dependencies.sh

short=false
case "${1-}" in
  --short) short=true ;;
  "") ;;
  *) echo "usage: bash cmake/arm64.sh [--short]" >&2; exit 2 ;;
esac
fcl_ccd_install_dependencies build g++-aarch64-linux-gnu qemu-user-static mmdebstrap
jobs=$(nproc)
sysroot=$PWD/build/arm64/sysroot
build=$PWD/build/arm64/build
step() { echo "== $* ($((SECONDS / 60)) min so far)"; }

if [ ! -d "$sysroot" ]; then
  step "Debian's packages for arm64, unpacked and not installed (a minute)"
  # shellcheck source=/dev/null
  suite=$(. /etc/os-release && echo "${VERSION_CODENAME:-bookworm}")
  mkdir -p build/arm64
  rm -rf "$sysroot.new"
  packages=libfcl-dev,libeigen3-dev,libboost-dev,libhwy-dev,libtbb-dev,libcli11-dev
  packages+=,nlohmann-json3-dev,libcgal-dev,libgtest-dev,libpng-dev,zlib1g-dev,libgmp-dev
  packages+=,libmpfr-dev,python3-dev,pybind11-dev
  mmdebstrap --quiet --variant=extract --architectures=arm64 --include="$packages" "$suite" \
    "$sysroot.new" http://deb.debian.org/debian
  # libccd's package names a library of the system by its path.
  sed -i 's|"/usr/lib/aarch64-linux-gnu/libm.so"|"m"|' \
    "$sysroot.new"/usr/lib/aarch64-linux-gnu/ccd/*.cmake
  mv "$sysroot.new" "$sysroot"
fi

step "configure and build"
python_include=$(basename "$(find "$sysroot/usr/include" -maxdepth 1 -name 'python3.*' | head -1)")
module=${python_include#python}
cmake -G Ninja -B "$build" -DCMAKE_BUILD_TYPE=Release -DFCL_CCD_WERROR=ON \
  -DCMAKE_TOOLCHAIN_FILE="$PWD/cmake/arm64_toolchain.cmake" -DFCL_CCD_SYSROOT="$sysroot" \
  -DCMAKE_CXX_FLAGS=-DFCL_CCD_TEST_FEW_CASES \
  -DFCL_CCD_BUILD_MPI=OFF -DFCL_CCD_BUILD_PYTHON="$($short && echo OFF || echo ON)" \
  -DPYBIND11_FINDPYTHON=ON -DPython_EXECUTABLE=/usr/bin/python3 \
  -DPython_INCLUDE_DIR="$sysroot/usr/include/$python_include" \
  -DPYTHON_MODULE_EXTENSION=".cpython-${module/./}-aarch64-linux-gnu.so"
tests=(test_fcl_elementary test_fcl_kernels test_fcl_motion_kernels test_fcl_exact)
if $short; then
  cmake --build "$build" --target fcl_ccd fcl_ccd_digests "${tests[@]}"
else
  cmake --build "$build" --target all fcl_ccd_digests
fi

step "unit tests in qemu"
if $short; then
  for test in "${tests[@]}"; do
    qemu-aarch64-static -L "$sysroot" "$build/test/unit/$test" --gtest_brief=1
  done
else
  # What tests call by its path.
  for program in src/tools/fcl_ccd/fcl-ccd test/fcl_ccd_speed test/fcl_ccd_speed_error \
    test/fcl_ccd_distances; do
    if [ "$(head -c 2 "$build/$program")" = '#!' ]; then continue; fi
    mv "$build/$program" "$build/$program.arm64"
    printf '#!/bin/sh\nexec qemu-aarch64-static -L "%s" "$0.arm64" "$@"\n' "$sysroot" \
      >"$build/$program"
    chmod +x "$build/$program"
  done
  ctest --test-dir "$build" -L unit -j "$jobs" --output-on-failure
fi

step "the same answers as on this machine"
cmake --preset release
cmake --build --preset release --target fcl_ccd_digests
build/release/test/fcl_ccd_digests >"$build/digests_here"
qemu-aarch64-static -L "$sysroot" "$build/test/fcl_ccd_digests" >"$build/digests"
cat "$build/digests_here"
diff "$build/digests_here" "$build/digests" || {
  echo "The answers on arm64 differ from those of this machine" >&2
  exit 1
}
