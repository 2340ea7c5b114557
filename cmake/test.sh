#!/usr/bin/env bash
# Installs missing packages (Debian), builds in Release and runs the tests.
#   bash cmake/test.sh           the test suite: 20 to 25 minutes on two cores
#   bash cmake/test.sh --all     also clang with -Werror and sanitizers, clang-tidy, and the
#                                reference (CI runs this; CI=true means the same)
#   bash cmake/test.sh --doors   only a build without vectors and threads, the examples with
#                                engines, every way to link the package (test/consumer) with
#                                gcc and clang and each set of flags, and cmake/arm64.sh
#                                --short: an hour or more
#   bash cmake/test.sh --compilers [COMPILER ...]
#                                only library, program, examples, some tests and two ways to
#                                link, with those of g++ 11 to 14 and clang++ 14, 16 and 19
#                                that the system has packages for, or those given, in C++17
#                                and C++20: about 10 minutes each time
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=cmake/dependencies.sh
source cmake/dependencies.sh

all=false
doors=false
compilers=()
case "${1-}" in
  --all) all=true ;;
  --doors) doors=true ;;
  --compilers)
    for compiler in g++-11 g++-12 g++-13 g++-14 clang++-14 clang++-16 clang++-19; do
      if command -v "$compiler" >/dev/null ||
        apt-cache show "${compiler/clang++/clang}" >/dev/null 2>&1; then
        compilers+=("$compiler")
      fi
    done
    if [ $# -gt 1 ]; then compilers=("${@:2}"); fi
    if [ ${#compilers[@]} -eq 0 ]; then
      echo "There is no compiler. Run apt-get update, or name the compilers" >&2
      exit 1
    fi
    ;;
  "") ;;
  *) echo "usage: bash cmake/test.sh [--all | --doors | --compilers [COMPILER ...]]" >&2; exit 2 ;;
esac
if [ "${CI-}" = true ] && ! $doors && [ ${#compilers[@]} -eq 0 ]; then all=true; fi

# try_compiler COMPILER STANDARD: what a compiler can fail in, without optimisation.
try_compiler() {
  local compiler=$1 standard=$2 dir=build/compilers/$1-c++$2
  local tests=(test_fcl_elementary test_fcl_kernels test_fcl_continuous_contact
    test_fcl_motion_collision test_fcl_ccd_tool)
  echo "== $compiler, C++$standard ($((SECONDS / 60)) min so far)"
  cmake -G Ninja -B "$dir" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_STANDARD="$standard" \
    -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DFCL_CCD_WERROR=ON \
    -DFCL_CCD_BUILD_BENCHMARKS=OFF -DFCL_CCD_BUILD_PYTHON=OFF >"$dir.log" ||
    { cat "$dir.log"; return 1; }
  # The doors install the package, so they need all that is installed.
  cmake --build "$dir" --target fcl_ccd fcl_with_ccd fcl-ccd examples/all fcl_ccd_test_oracle \
    "${tests[@]}"
  local test
  for test in "${tests[@]}"; do "$dir/test/unit/$test" --gtest_brief=1; done
  ctest --test-dir "$dir" -L examples --output-on-failure
  bash test/consumer/run.sh "$dir" "$compiler" "$dir/doors" cmake_target standards
}

if [ ${#compilers[@]} -gt 0 ]; then
  # A package has the name of the compiler without the version of the language.
  fcl_ccd_install_dependencies test "${compilers[@]/clang++/clang}"
  mkdir -p build/compilers
  for compiler in "${compilers[@]}"; do
    for standard in 17 20; do try_compiler "$compiler" "$standard"; done
  done
  exit
fi

if $doors; then
  # With the engines of examples/.
  fcl_ccd_install_dependencies all libompl-dev libbullet-dev libdart-dev \
    libdart-external-ikfast-dev libdart-external-odelcpsolver-dev
elif $all; then
  fcl_ccd_install_dependencies all
else
  fcl_ccd_install_dependencies test
fi
jobs=$(nproc)
if ! $all && ! $doors; then
  echo "== About 20 to 25 minutes on two cores the first time: building takes 10 to 14,"
  echo "   the tests 1.5, and the programs that link the package 7"
fi

step() { echo "== $* ($((SECONDS / 60)) min so far)"; }

# watched COMMAND...: runs it. When it prints nothing for 45 seconds, a line tells what it does:
# which tests run, or what came last.
watched() {
  "$@" 2>&1 | {
    local line="" part last="" rc
    local -A running=()
    while true; do
      IFS= read -r -t 45 part && rc=0 || rc=$?
      line+=$part
      if [ "$rc" -gt 128 ]; then
        echo "   ... still at: ${running[*]:-$last} ($((SECONDS / 60)) min so far)"
        continue
      fi
      if [ -n "$line" ] || [ "$rc" -eq 0 ]; then printf '%s\n' "$line"; fi
      if [ "$rc" -ne 0 ]; then break; fi
      if [[ $line =~ ^\ *Start\ +([0-9]+):\ (.*) ]]; then
        running[${BASH_REMATCH[1]}]=${BASH_REMATCH[2]}
      elif [[ $line =~ Test\ +\#([0-9]+): ]]; then
        unset "running[${BASH_REMATCH[1]}]"
      elif [ -n "$line" ]; then
        last="after ${line:0:100}"
      fi
      line=""
    done
  }
}

build() {
  local preset=$1
  shift
  step "$preset: configure and build"
  cmake --preset "$preset" "$@"
  watched cmake --build --preset "$preset"
}

# The last lines, also when a test has failed.
tell_what_was_skipped() {
  if [ -d "${FCL_CCD_TEST_DATA:-../shared/data}" ]; then return; fi
  echo "Tests of the public data were skipped. doc/data.md says where to download the data."
  echo "This line runs them: FCL_CCD_TEST_DATA=FOLDER bash cmake/test.sh"
}

if $doors; then
  # Without vectors and threads: the tests that compare with scalar code and brute force.
  build plain
  watched ctest --preset plain -j "$jobs"
  build release -DFCL_CCD_BUILD_PYTHON=ON
  watched ctest --preset release -L examples
  for compiler in g++ clang++; do
    watched bash test/consumer/run.sh build/release "$compiler" "build/release/doors_$compiler"
  done
  watched bash cmake/arm64.sh --short
  exit
fi

# The Release run comes last, so that its summary is at the end of the output.
if $all; then
  # lld links the test programs faster than the linker of the system.
  build asan-ubsan -DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=lld
  step "clang-tidy"
  command -v clang-tidy-14 >/dev/null ||
    { echo "clang-tidy-14 is missing. Install the package clang-tidy-14" >&2; exit 1; }
  watched python3 cmake/tidy.py build/asan-ubsan "$jobs"
  step "asan-ubsan: unit tests"
  trap tell_what_was_skipped EXIT
  watched ctest --preset asan-ubsan -j "$jobs"
  step "reference"
  watched doxygen doc/Doxyfile
  watched bash cmake/check_reference.sh
  build release -DFCL_CCD_WERROR=ON -DFCL_CCD_BUILD_REPRODUCTION=ON -DFCL_CCD_BUILD_PYTHON=ON \
    -DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=lld
  watched cmake --build --preset release --target programs
else
  build release -DFCL_CCD_BUILD_PYTHON=ON
fi
step "release: tests"
trap tell_what_was_skipped EXIT
watched ctest --preset release -j "$jobs"
