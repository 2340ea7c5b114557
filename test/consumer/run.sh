#!/usr/bin/env bash
# Builds and runs a program for each door. A door is a way in which a program finds and links
# this package.
#   run.sh BUILD_DIR COMPILER WORK_DIR [DOOR ...]
# BUILD_DIR is the folder of a finished build of this project; it is installed into WORK_DIR.
# Without DOORs all are run, which takes a quarter of an hour with each compiler. With
# FCL_CCD_PREFIX this prefix is used, which the door `install` of another WORK_DIR has made: so
# ctest runs doors side by side, each in a WORK_DIR of its own.
set -euo pipefail
source_dir=$(cd "$(dirname "$0")" && pwd)
build_dir=$1
export CXX=$2
work=$3
shift 3
project_dir=$(cd "$source_dir/../.." && pwd)
python=${PYTHON:-/usr/bin/python3}

# As on a machine where nobody has set it: Python writes what it compiles.
unset PYTHONDONTWRITEBYTECODE

step() { echo "== $*"; }
fail() {
  echo "$*" >&2
  exit 1
}

all_doors=(
  install package stock_gone shared_prefix stock
  cmake_target cmake_variables pkg_config plain_flags lfcl dlopen find_library system_prefix
  both_folders
  python_package python_extension uninstall deb
  spaces standards cxx14_message two_consumers examples lto eigen_names no_rtti no_rtti_float
  flags_cxx11 flags_cxx11_avx flags_baseline flags_v3 flags_native flags_native_O0
  add_subdirectory add_subdirectory_native add_subdirectory_static add_subdirectory_plain
)
doors=("$@")
if [ $# -eq 0 ]; then doors=("${all_doors[@]}"); fi

rm -rf "$work"
mkdir -p "$work"
work=$(cd "$work" && pwd)
prefix=${FCL_CCD_PREFIX-}
if [ -z "$prefix" ]; then
  step "install, then move the prefix"
  cmake --install "$build_dir" --prefix "$work/installed" >/dev/null
  mv "$work/installed" "$work/prefix"
  prefix=$work/prefix
fi
lib=$(cd "$prefix" && dirname lib*/pkgconfig)
config=$lib/cmake/fcl_ccd/fcl_ccd-config.cmake
recorded='^set(_fcl_ccd_stock_dir "\(.*\)")$'
stock_dir=$(sed -n "s|$recorded|\1|p" "$prefix/$config")

# The flags of Eigen, libccd and octomap in a makefile that is written by hand.
read -ra around <<<"$(pkg-config --cflags eigen3 ccd octomap)"
run_with() { LD_LIBRARY_PATH=$1/$lib "${@:2}"; }

# configure_and_run NAME PREFIX [OPTION ...]: the consumer's program through CMake.
configure_and_run() { run_through_cmake app "$@"; }

# expect_extended NAME PREFIX [OPTION ...]: the smaller program, where only the prefix differs.
expect_extended() { run_through_cmake stock_or_not "$@"; }

run_through_cmake() {
  local program=$1 name=$2 where=$3
  shift 3
  cmake -S "$source_dir" -B "$work/$name" -DCMAKE_PREFIX_PATH="$where" "$@" \
    >"$work/$name.log"
  cmake --build "$work/$name" --target "$program" >>"$work/$name.log"
  "$work/$name/$program"
}

package() {
  cmake -S "$source_dir/package" -B "$work/$1" -DFCL_CCD_PREFIX="$2" "${@:3}" >/dev/null
}

door_install() { [ -f "$prefix/$lib/libfcl.a" ]; }

door_package() { # the properties of the CMake package, also when configured a second time
  package package "$prefix" -DCMAKE_PREFIX_PATH="$prefix"
  package package "$prefix"
}

door_stock_gone() { # the same when stock FCL has moved
  # A second copy of the package is on the path and must not be taken for stock FCL.
  cp -r "$prefix" "$work/prefix2"
  sed -i "s|$recorded|set(_fcl_ccd_stock_dir /gone)|" "$work/prefix2/$config"
  package package2 "$work/prefix2" "-DCMAKE_PREFIX_PATH=$work/prefix2;$prefix"
  package package2 "$work/prefix2"
}

# A prefix that has stock FCL, as /usr and those of package managers: no file of stock FCL changes,
# and both packages are found.
door_shared_prefix() {
  local shared=$work/shared file files before libs
  mapfile -t files < <(dpkg -L libfcl-dev libfcl0.7 | while read -r file; do
    if [ -n "$file" ] && [ ! -d "$file" ]; then echo "$file"; fi
  done)
  mkdir -p "$shared"
  tar -C / -cf - "${files[@]#/}" | tar -C "$shared" -xf - --strip-components=1
  before=$(stock_files "$shared")
  cmake --install "$build_dir" --prefix "$shared" >"$work/shared.log"
  grep -q "$shared/lib/fcl-ccd" "$work/shared.log" || fail "The installation does not name the doors"
  [ "$before" = "$(stock_files "$shared" | LC_ALL=C comm -12 - <(echo "$before"))" ] ||
    fail "A file of stock FCL was changed"
  # The package that has a name of its own.
  expect_extended shared_own "$shared" -DCONSUMER_FINDS=fcl_ccd
  grep -q "extended by fcl_ccd .* $shared/" "$work/shared_own.log" || fail "Not the shared prefix"
  PKG_CONFIG_PATH=$shared/$lib/pkgconfig pkg-config --cflags --libs fcl_ccd >"$work/shared_flags"
  read -ra libs <"$work/shared_flags"
  "$CXX" -std=c++17 "$source_dir/stock_or_not.cpp" -o "$work/shared_pc" "${libs[@]}"
  run_with "$shared" "$work/shared_pc" extended
  # The doors with FCL's names.
  local doors=$shared/lib/fcl-ccd
  expect_extended shared_doors "$doors"
  PKG_CONFIG_PATH=$doors/lib/pkgconfig pkg-config --cflags --libs fcl >"$work/shared_flags"
  read -ra libs <"$work/shared_flags"
  "$CXX" -std=c++17 "$source_dir/stock_or_not.cpp" -o "$work/shared_door_pc" "${libs[@]}"
  run_with "$shared" "$work/shared_door_pc" extended
  "$CXX" -std=c++17 -I"$doors/include" "${around[@]}" "$source_dir/stock_or_not.cpp" \
    -o "$work/shared_lfcl" -L"$doors/lib" -lfcl -lccd
  LD_LIBRARY_PATH=$doors/lib "$work/shared_lfcl" extended
  cmake -S "$source_dir/find_library" -B "$work/shared_find" -DCMAKE_PREFIX_PATH="$doors" >/dev/null
  cmake --build "$work/shared_find" >/dev/null
  "$work/shared_find/app"
  # What has no flag is stock FCL.
  "$CXX" -std=c++17 -isystem "$shared/include" "${around[@]}" "$source_dir/stock_or_not.cpp" \
    -o "$work/shared_plain" -lfcl -lccd
  "$work/shared_plain" stock
}
stock_files() { (cd "$1" && find . -type f -exec sha256sum {} + | LC_ALL=C sort); }

door_stock() { # control: with stock FCL alone the program fails
  cmake -S "$source_dir" -B "$work/stock" -Dfcl_DIR="$stock_dir" >/dev/null
  cmake --build "$work/stock" --target app >/dev/null
  if "$work/stock/app" >"$work/stock/output"; then
    fail "app succeeded with stock FCL, so it does not test this package"
  fi
}

door_cmake_target() { # find_package and the target fcl
  # Some distributions link in this way by default: the linker drops a library without calls.
  LDFLAGS=-Wl,--as-needed configure_and_run cmake_target "$prefix"
  cmake --build "$work/cmake_target" --target deforming >>"$work/cmake_target.log"
  "$work/cmake_target/deforming"
  grep -q "extended by fcl_ccd .* $prefix/$lib" "$work/cmake_target.log" ||
    fail "CMake does not print which FCL it uses"
}

door_cmake_variables() { # find_package, FCL_INCLUDE_DIRS and FCL_LIBRARIES
  configure_and_run cmake_variables "$prefix" -DCONSUMER_USES_VARIABLES=ON
}

door_pkg_config() {
  export PKG_CONFIG_PATH=$prefix/$lib/pkgconfig
  local cflags libs
  read -ra cflags <<<"$(pkg-config --cflags fcl)"
  read -ra libs <<<"$(pkg-config --libs fcl)"
  unset PKG_CONFIG_PATH
  # The standard is the one of stock FCL's fcl.pc.
  "$CXX" -std=c++11 "${cflags[@]}" "$source_dir"/{main,fcl_header}.cpp -o "$work/pc_app" \
    -Wl,--as-needed "${libs[@]}"
  run_with "$prefix" "$work/pc_app"
  # The names of this package need C++17. fcl.pc does not set it, the program does.
  "$CXX" -std=c++17 "${cflags[@]}" "$source_dir/deforming.cpp" -o "$work/pc_deforming" \
    "${libs[@]}"
  run_with "$prefix" "$work/pc_deforming"
}

# object NAME SOURCE FLAGS...: compiles a source once for all doors, and prints the path of the
# object. Doors that run side by side wait for each other.
object() {
  local objects out source=$2
  objects=$prefix-objects/$(basename "$CXX")
  out=$objects/$1.o
  shift 2
  mkdir -p "$objects"
  (
    flock 9
    if [ ! -f "$out" ]; then
      "$CXX" "$@" -fPIC -I"$prefix/include" "${around[@]}" -c "$source_dir/$source" \
        -o "$out.new"
      mv "$out.new" "$out"
    fi
  ) 9>"$out.lock"
  echo "$out"
}

# by_hand NAME PREFIX LIBRARIES...: linked with flags written out, and run.
by_hand() {
  local name=$1 where=$2
  shift 2
  "$CXX" "$(object main main.cpp -std=c++17)" "$(object header fcl_header.cpp -std=c++17)" \
    -o "$work/${name}_app" -L"$where/$lib" "$@" -lccd
  run_with "$where" "$work/${name}_app"
  "$CXX" "$(object deforming deforming.cpp -std=c++17)" -o "$work/${name}_deforming" \
    -L"$where/$lib" "$@" -lccd
  run_with "$where" "$work/${name}_deforming"
}

door_plain_flags() { by_hand plain "$prefix" -lfcl_ccd -lfcl; }

door_lfcl() { # the flag -lfcl; also the library's path, other linkers, and a plugin
  by_hand lfcl "$prefix" -lfcl
  "$CXX" "$(object deforming deforming.cpp -std=c++17)" -o "$work/lfcl_path" \
    "$prefix/$lib/libfcl.a" -lccd
  run_with "$prefix" "$work/lfcl_path"
  local linker
  for linker in lld gold; do
    if command -v "ld.$linker" >/dev/null; then
      by_hand "lfcl_$linker" "$prefix" -fuse-ld=$linker -lfcl
    fi
  done
  # A plugin, for example a Python extension, may have undefined symbols. They must be found
  # when it is loaded.
  "$CXX" -shared "$(object plugin deforming.cpp -std=c++17 -Dmain=run_deforming)" \
    -o "$work/plugin.so" -L"$prefix/$lib" -lfcl
  "$CXX" -std=c++17 "$source_dir/load.cpp" -o "$work/load" -ldl
  run_with "$prefix" "$work/load" "$work/plugin.so" run_deforming
}

door_dlopen() { # a program that loads "libfcl.so" at run time gets FCL's own functions
  "$CXX" -std=c++17 "$source_dir/load.cpp" -o "$work/load" -ldl
  run_with "$prefix" "$work/load" libfcl.so ""
  local name='_ZN3fcl3BoxIdEC1Eddd' library
  library=$(run_with "$prefix" "$work/load" libfcl.so "" "$name")
  [[ $library == */libfcl.so.0.7* ]] || fail "libfcl.so gives $name of $library"
}

door_find_library() { # CMake's find_path and find_library; the program has no other path
  cmake -S "$source_dir/find_library" -B "$work/find_library" \
    -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
  cmake --build "$work/find_library" >/dev/null
  "$work/find_library/app"
  "$work/find_library/app_to_file"
}

door_both_folders() { # the folder of the headers and the link to it, both named, in both orders
  local folders
  for folders in "$prefix/include/fcl_ccd $prefix/include" "$prefix/include $prefix/include/fcl_ccd"; do
    "$CXX" -std=c++17 -fsyntax-only $(printf -- '-isystem %s ' $folders) "${around[@]}" \
      "$source_dir/main.cpp"
    "$CXX" -std=c++17 -fsyntax-only $(printf -- '-I%s ' $folders) "${around[@]}" \
      "$source_dir/deforming.cpp"
  done
}

# Where the compiler looks for headers by itself, but the linker looks for stock FCL first.
# There g++ -lfcl is stock FCL, headers and library; what names the prefix is this package.
door_system_prefix() {
  local root=$work/system_root libs
  if [ -e /usr/local/include/fcl/config.h ]; then
    # There the doors have a prefix of their own: door_shared_prefix.
    echo "Stock FCL is in /usr/local, so this door cannot be tried on this machine"
    return
  fi
  DESTDIR=$root cmake --install "$build_dir" --prefix /usr/local >"$work/system_prefix.log"
  local system=$root/usr/local
  [ ! -e "$system/include/fcl" ] || fail "g++ finds headers in /usr/local/include"
  "$CXX" -std=c++17 -isystem "$system/include" "${around[@]}" "$source_dir/stock_or_not.cpp" \
    -o "$work/system_plain" -lfcl -lccd
  "$work/system_plain" stock
  PKG_CONFIG_PATH=$system/$lib/pkgconfig pkg-config --cflags --libs fcl >"$work/system_flags"
  read -ra libs <"$work/system_flags"
  "$CXX" -std=c++17 "$source_dir/stock_or_not.cpp" -o "$work/system_pc" "${libs[@]}"
  run_with "$system" "$work/system_pc" extended
  expect_extended system_cmake "$system"
}

door_python_package() { # the Python package in the prefix
  local module
  module=$(find "$prefix" -path '*/fcl_ccd/_core*.so')
  [ -n "$module" ] || fail "The prefix has no Python package. Build with FCL_CCD_BUILD_PYTHON=ON"
  # -B: other doors copy the prefix.
  PYTHONPATH=$(dirname "$(dirname "$module")") "$python" -B \
    "$project_dir/python/examples/planner.py"
}

door_python_extension() { # a Python module of the program that binds FCL's names, with -lfcl
  local name includes
  read -ra includes <<<"$("${python}-config" --includes)"
  name=fcl_extension$("${python}-config" --extension-suffix)
  mkdir -p "$work/python" "$work/python_stock"
  "$CXX" -std=c++17 -O1 -shared -fPIC "${includes[@]}" -I"$prefix/include" "${around[@]}" \
    "$source_dir/python_extension.cpp" -o "$work/python/$name" -L"$prefix/$lib" -lfcl
  PYTHONPATH=$work/python run_with "$prefix" "$python" "$source_dir/python_extension.py"
  # Control: the same source with stock FCL.
  "$CXX" -std=c++17 -O1 -shared -fPIC "${includes[@]}" "${around[@]}" \
    "$source_dir/python_extension.cpp" -o "$work/python_stock/$name" -lfcl
  if PYTHONPATH=$work/python_stock "$python" "$source_dir/python_extension.py"; then
    fail "The Python module succeeds with stock FCL, so it does not test this package"
  fi
}

door_uninstall() { # nothing is left; the file of another program is
  local gone=$work/gone component
  for component in library dev python; do
    cmake --install "$build_dir" --prefix "$gone" --component "$component" >/dev/null
  done
  [ -f "$gone/$lib/libfcl.a" ] || fail "The components library and dev install no library"
  touch "$gone/$lib/libother.so"
  PYTHONPATH=$(dirname "$(dirname "$(find "$gone" -path '*/fcl_ccd/_core*.so')")") "$python" \
    -c "import fcl_ccd"
  for component in library dev python; do
    cmake -DMANIFEST="$build_dir/install_manifest_$component.txt" \
      -P "$project_dir/cmake/uninstall.cmake"
  done
  [ "$(find "$gone" -type f -o -type l)" = "$gone/$lib/libother.so" ]
}

door_deb() { # Debian packages: no file of stock FCL, used beside it; cmake/bare.sh installs them
  local root=$work/deb_root deb=$work/deb own theirs package name
  bash "$project_dir/cmake/packages.sh" "$build_dir" "$deb" >"$work/deb.log" 2>&1 ||
    { cat "$work/deb.log"; fail "packages.sh failed"; }
  own=$(for package in "$deb"/*.deb; do dpkg-deb --fsys-tarfile "$package" | tar -t; done |
    grep -v '/$' | sed 's|^\./|/|' | LC_ALL=C sort)
  [ -z "$(uniq -d <<<"$own")" ] || fail "Two packages have the same file"
  theirs=$(dpkg -L libfcl-dev libfcl0.7 | LC_ALL=C sort -u)
  [ -z "$(LC_ALL=C comm -12 <(echo "$own") <(echo "$theirs"))" ] || fail "A file is stock FCL's"

  mkdir -p "$root"
  for package in "$deb"/*.deb; do
    dpkg-deb -x "$package" "$root"
    name=$(dpkg-deb -f "$package" Package)
    for file in copyright changelog.gz; do
      [ -f "$root/usr/share/doc/$name/$file" ] || fail "$name has no $file"
    done
  done
  [ -f "$root/usr/share/man/man1/fcl-ccd.1.gz" ] || fail "The manual page is not compressed"
  "$root/usr/bin/fcl-ccd" --version
  configure_and_run deb_program "$root/usr/lib/fcl-ccd"
  PYTHONPATH=$root/usr/lib/python3/dist-packages "$python" -B -c \
    "import fcl_ccd; print(fcl_ccd.__file__)"
  for file in _page.html _page.js viewer.min.js viewer.min.js.LICENSE; do
    [ -f "$root/usr/lib/python3/dist-packages/fcl_ccd/$file" ] || fail "The Python package has no $file"
  done
  # The package compiles its modules and removes what Python has compiled.
  dpkg-deb -e "$deb"/python3-fcl-ccd_*.deb "$work/deb_python"
  grep -q py3compile "$work/deb_python/postinst"
  grep -q py3clean "$work/deb_python/prerm"
  dpkg-deb -e "$deb"/libfcl-ccd[0-9]*.deb "$work/deb_library"
  grep -q ldconfig "$work/deb_library/triggers"
}

door_spaces() { # a prefix with spaces in its path
  cp -r "$prefix" "$work/a prefix"
  configure_and_run spaces "$work/a prefix"
  by_hand spaces_by_hand "$work/a prefix" -lfcl
}

door_standards() { # FCL's names from C++11 on, all names from C++17 on
  local standard
  for standard in 11 20; do
    "$CXX" -std=c++$standard -Wall -Wextra -Wpedantic -Werror -I"$prefix/include" \
      -isystem /usr/include/eigen3 "$source_dir"/{main,fcl_header}.cpp \
      -o "$work/app_$standard" -L"$prefix/$lib" -lfcl -lccd
    run_with "$prefix" "$work/app_$standard" >/dev/null
  done
  "$CXX" -std=c++20 -Wall -Wextra -Wpedantic -Werror -I"$prefix/include" \
    -isystem /usr/include/eigen3 "$source_dir/deforming.cpp" -o "$work/deforming_20" \
    -L"$prefix/$lib" -lfcl -lccd
  run_with "$prefix" "$work/deforming_20"
}

door_cxx14_message() { # in C++14 the names of this package say that they need C++17
  if "$CXX" -std=c++14 -fsyntax-only -I"$prefix/include" "${around[@]}" \
    "$source_dir/deforming.cpp" 2>"$work/cxx14"; then
    fail "DeformableBVHModel compiles as C++14, so the message is not needed"
  fi
  grep -q "needs C++17" "$work/cxx14" || fail "The error message does not name C++17"
}

door_two_consumers() { # two parts of a program that each call find_package(fcl)
  cmake -S "$source_dir/two_consumers" -B "$work/two" -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
  cmake --build "$work/two" >/dev/null
  "$work/two/first/first"
  "$work/two/second/second"
}

door_examples() { # the examples on their own
  cmake -S "$project_dir/examples" -B "$work/examples" -DCMAKE_PREFIX_PATH="$prefix" \
    >"$work/examples.log"
  cmake --build "$work/examples" >>"$work/examples.log"
  ctest --test-dir "$work/examples" --output-on-failure
}

# Functions of our names in Eigen's namespace, which the compiler also looks in if a call does
# not name a namespace. DART has one, make_aligned_shared().
door_eigen_names() {
  local names
  names=$(grep -rhoE '^[A-Za-z][^=;]*\b[a-z][A-Za-z]+\(' "$prefix/include/fcl_ccd" |
    grep -oE '[a-z][A-Za-z]+\($' | tr -d '(' | grep -vE '^(sizeof|test|size|clear|update)$' | sort -u)
  {
    echo '#include <memory>'
    echo 'namespace Eigen {'
    echo 'template <typename T, typename... A> std::shared_ptr<T> make_aligned_shared(A&&...);'
    for name in $names; do
      echo "template <typename... A> void $name(A&&...) = delete;"
      echo "template <typename T, typename... A> T $name(A&&...) = delete;"
    done
    echo '}'
  } >"$work/eigen_names.h"
  # FCL's own templates in float have such calls.
  "$CXX" -std=c++17 -DFCL_CCD_ONLY_DOUBLE -fsyntax-only -include "$work/eigen_names.h" \
    -I"$prefix/include" "${around[@]}" "$source_dir/every_overload.cpp"
  "$CXX" -std=c++11 -fsyntax-only -include "$work/eigen_names.h" -I"$prefix/include" \
    "${around[@]}" "$source_dir/main.cpp"
}

# no_rtti STANDARD [FLAG ...]: a program without RTTI.
no_rtti() {
  local standard=$1
  "$CXX" -std=c++"$standard" -fno-rtti "${@:2}" -I"$prefix/include" "${around[@]}" \
    "$source_dir/no_rtti.cpp" -o "$work/no_rtti_$standard" -L"$prefix/$lib" -lfcl -lccd
  run_with "$prefix" "$work/no_rtti_$standard"
}

door_no_rtti() {
  no_rtti 11 -DONLY_DOUBLE
  no_rtti 17 -DONLY_DOUBLE
}
door_no_rtti_float() { no_rtti 17; } # FCL's templates in float take a compiler a minute

door_lto() {
  "$CXX" -std=c++17 -O2 -flto -I"$prefix/include" "${around[@]}" \
    "$source_dir"/{main,fcl_header}.cpp -o "$work/lto_app" -L"$prefix/$lib" -lfcl -lccd
  run_with "$prefix" "$work/lto_app"
}

# every_overload NAME FLAGS...: in a program compiled with FLAGS.
every_overload() {
  local name=$1
  shift
  "$CXX" -std=c++17 "$@" -I"$prefix/include" "${around[@]}" \
    "$source_dir/every_overload.cpp" -o "$work/flags_$name" -L"$prefix/$lib" -lfcl -lccd
  run_with "$prefix" "$work/flags_$name"
}

door_flags_cxx11() { # FCL's names in C++11, where new does not align memory as types ask
  "$CXX" -std=c++11 -O1 -march=native -I"$prefix/include" "${around[@]}" \
    "$source_dir/rotation.cpp" -o "$work/flags_cxx11" -L"$prefix/$lib" -lfcl -lccd
  run_with "$prefix" "$work/flags_cxx11"
}
# Objects of std::make_shared have half of the alignment that Eigen wants with AVX.
door_flags_cxx11_avx() {
  grep -qw avx /proc/cpuinfo || return 0
  "$CXX" -std=c++11 -O1 -mavx -I"$prefix/include" "${around[@]}" \
    "$source_dir/unaligned.cpp" -o "$work/flags_cxx11_avx" -L"$prefix/$lib" -lfcl -lccd
  run_with "$prefix" "$work/flags_cxx11_avx"
}
door_flags_baseline() { # with and without assertions, as the next doors
  every_overload baseline -O1
  every_overload baseline_ndebug -O1 -DNDEBUG
}
door_flags_v3() {
  every_overload v3 -O1 -march=x86-64-v3
  every_overload v3_ndebug -O1 -DNDEBUG -march=x86-64-v3
}
door_flags_native() {
  every_overload native -O1 -march=native
  every_overload native_ndebug -O1 -DNDEBUG -march=native
}
# CI has time for this one of them only. It checks Eigen's assertions and the answers.
door_flags_native_O0() { every_overload native_O0 -O0 -march=native; }

# subproject NAME OPTION...: a part of a larger build that has its own flags.
subproject() {
  local name=$1 program
  shift
  cmake -S "$source_dir/subproject" -B "$work/$name" -DFCL_CCD_SOURCE_DIR="$project_dir" \
    "$@" >/dev/null
  cmake --build "$work/$name" -j "$(nproc)" >"$work/$name.log"
  for program in with_fcl with_fcl_ccd app; do "$work/$name/$program"; done
}

door_add_subdirectory() { subproject sub -DCMAKE_BUILD_TYPE=Debug; }
door_add_subdirectory_native() {
  subproject sub_native -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS=-march=native \
    -DCMAKE_CXX_FLAGS_RELEASE=-O1
}

# static_subproject NAME OPTION...: with BUILD_SHARED_LIBS=OFF, and installed from there.
static_subproject() {
  local name=$1 libs installed=$work/$1_prefix
  subproject "$@" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 \
    -DBUILD_SHARED_LIBS=OFF -DFCL_CCD_INSTALL=ON
  cmake --install "$work/$name" --prefix "$installed" >/dev/null
  [ -f "$installed/$lib/libfcl_ccd.a" ] || fail "no static library"
  configure_and_run "${name}_cmake" "$installed"
  by_hand "${name}_lfcl" "$installed" -lfcl
  PKG_CONFIG_PATH=$installed/$lib/pkgconfig pkg-config --libs fcl >"$work/${name}_libs"
  read -ra libs <"$work/${name}_libs"
  by_hand "${name}_pc" "$installed" "${libs[@]}"
}

door_add_subdirectory_static() { static_subproject static; }
door_add_subdirectory_plain() { # without Highway and oneTBB, in a project that joins its files
  static_subproject plain -DFCL_CCD_USE_HIGHWAY=OFF -DFCL_CCD_USE_TBB=OFF -DCMAKE_UNITY_BUILD=ON
}

for door in "${doors[@]}"; do
  step "$door"
  "door_$door"
done
