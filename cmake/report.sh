# shellcheck shell=bash
# What the reports of speed have in common. Sourced by speed.sh and speed_error.sh; a
# report NAME is what the program fcl_ccd_NAME writes, tables and pictures are made by
# test/benchmark/NAME.

# fcl_ccd_begin_report NAME [DATA_FOLDER] [OPTION ...]
#
# Installs what is missing (Debian), builds in Release and measures. Goes to the project's
# folder. Sets `out`, where the tables are, and `sources`.
fcl_ccd_begin_report() {
  local name=$1
  shift
  data=
  if [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; then
    data=$(cd "$1" && pwd)
    shift
  fi
  has_options=$#
  cd "$(dirname "${BASH_SOURCE[0]}")/.." || return
  # shellcheck source=cmake/dependencies.sh
  source cmake/dependencies.sh
  fcl_ccd_install_dependencies build gnuplot-nox
  cmake --preset release
  cmake --build --preset release -j "$(nproc)" --target "fcl_ccd_$name"

  out=build/$name
  # shellcheck disable=SC2034
  sources=test/benchmark/$name
  rm -rf "$out"
  "build/release/test/fcl_ccd_$name" "$out" ${data:+--data "$data"} "$@"
}

# fcl_ccd_end_report PAGE FILE ...
#
# Copies the files of `out` to doc/results where everything was measured, and says where
# the page is.
fcl_ccd_end_report() {
  if [ -z "$data" ]; then
    echo "Without a data folder: what is generated only. doc/results stays as it is."
  elif [ "$has_options" -eq 0 ]; then
    mkdir -p doc/results
    (cd "$out" && cp "$@" ../../doc/results/)
    out=doc/results
  fi
  echo "Tables and pictures: $out/$1"
}
