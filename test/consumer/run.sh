#!/usr/bin/env bash
# Installs the built package in a prefix of its own and builds the consumer against it,
# through find_package and through pkg-config.
#   run.sh BUILD_DIR COMPILER WORK_DIR
set -euo pipefail
source_dir=$(cd "$(dirname "$0")" && pwd)
build_dir=$1
export CXX=$2
work=$3

step() { echo "== $*"; }

rm -rf "$work"
mkdir -p "$work"
step "install, then move the prefix"
cmake --install "$build_dir" --prefix "$work/installed" >/dev/null
mv "$work/installed" "$work/prefix"
prefix=$(cd "$work/prefix" && pwd)
lib=$(cd "$prefix" && dirname lib*/pkgconfig)
config=$lib/cmake/fcl/fcl-config.cmake

step "what the package says of itself, also when configured again"
package() { cmake -S "$source_dir/package" -B "$work/$1" -DFCL_CCD_PREFIX="$2" "${@:3}" >/dev/null; }
package package "$prefix" -DCMAKE_PREFIX_PATH="$prefix"
package package "$prefix"

step "the same when stock FCL is no longer where it was"
# A second copy of the package lies on the path and must not pass for stock FCL.
recorded='^set(_fcl_ccd_stock_dir "\(.*\)")$'
stock_dir=$(sed -n "s|$recorded|\1|p" "$prefix/$config")
cp -r "$prefix" "$work/prefix2"
sed -i "s|$recorded|set(_fcl_ccd_stock_dir /gone)|" "$work/prefix2/$config"
package package2 "$work/prefix2" "-DCMAKE_PREFIX_PATH=$work/prefix2;$prefix"
package package2 "$work/prefix2"

step "a prefix that has stock FCL is left as it is"
mkdir -p "$work/dest/taken/include/fcl"
touch "$work/dest/taken/include/fcl/config.h"
if DESTDIR=$work/dest cmake --install "$build_dir" --prefix /taken >/dev/null 2>&1; then
  echo "installed over stock FCL" >&2
  exit 1
fi
[ "$(find "$work/dest" -type f)" = "$work/dest/taken/include/fcl/config.h" ]

step "control: with stock FCL alone the program fails"
cmake -S "$source_dir" -B "$work/stock" -Dfcl_DIR="$stock_dir" >/dev/null
cmake --build "$work/stock" --target app
if "$work/stock/app" >"$work/stock/output"; then
  echo "app succeeded with stock FCL: it tests nothing" >&2
  exit 1
fi

step "find_package"
# As some distributions link by default: a library that nothing needs is dropped.
LDFLAGS=-Wl,--as-needed cmake -S "$source_dir" -B "$work/cmake" \
  -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$work/cmake" --target app deforming
"$work/cmake/app"
"$work/cmake/deforming"

step "pkg-config"
export PKG_CONFIG_PATH=$prefix/$lib/pkgconfig
read -ra cflags <<<"$(pkg-config --cflags fcl)"
read -ra libs <<<"$(pkg-config --libs fcl)"
# With the standard that stock FCL's fcl.pc asks for.
"$CXX" -std=c++11 "${cflags[@]}" "$source_dir"/{main,fcl_header}.cpp -o "$work/pc_app" \
  -Wl,--as-needed "${libs[@]}"
LD_LIBRARY_PATH=$prefix/$lib "$work/pc_app"
# What FCL does not have needs C++17, which fcl.pc leaves to the program.
"$CXX" -std=c++17 "${cflags[@]}" "$source_dir/deforming.cpp" -o "$work/pc_deforming" \
  "${libs[@]}"
LD_LIBRARY_PATH=$prefix/$lib "$work/pc_deforming"
