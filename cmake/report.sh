# shellcheck shell=bash
# The parts that the reports have in common. The scripts of the reports source this file. The
# program fcl_ccd_NAME writes the report NAME. The scripts of its tables and pictures are in
# test/benchmark/NAME or test/reproduction/NAME.

# fcl_ccd_build_report NAME [TARGET ...]
#
# Goes to the project's folder. Installs missing packages (Debian). Builds the report's program
# and the TARGETs in Release. Sets `out`, the folder of the tables, and `sources`, the folder of
# the scripts.
fcl_ccd_build_report() {
  local name=$1
  shift
  cd "$(dirname "${BASH_SOURCE[0]}")/.." || return
  # shellcheck source=cmake/dependencies.sh
  source cmake/dependencies.sh
  fcl_ccd_install_dependencies build gnuplot-nox
  echo "== Building (about ten minutes on two cores the first time)"
  cmake --preset release -DFCL_CCD_BUILD_REPRODUCTION=ON
  cmake --build --preset release --target "fcl_ccd_$name" "$@"

  out=build/$name
  # shellcheck disable=SC2034
  sources=$(dirname test/*/"$name"/plot.gp)
}

# fcl_ccd_begin_report NAME [DATA_FOLDER] [OPTION ...]
#
# Builds and measures. `duration` says how long the measurement takes. Sets `is_whole`: whether
# everything was measured.
fcl_ccd_begin_report() {
  local name=$1 data=
  shift
  if [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; then
    data=$(cd "$1" && pwd)
    shift
  fi
  is_whole=false
  if [ -n "$data" ] && [ $# -eq 0 ]; then is_whole=true; fi
  fcl_ccd_build_report "$name"
  # shellcheck disable=SC2154
  echo "== Measuring (everything takes $duration)"
  rm -rf "$out"
  "build/release/test/fcl_ccd_$name" "$out" ${data:+--data "$data"} "$@"
}

# fcl_ccd_end_report PAGE FILE ...
#
# Copies the files of `out` to doc/results if `is_whole`. Prints where the page is.
fcl_ccd_end_report() {
  if $is_whole; then
    mkdir -p doc/results
    (cd "$out" && cp "$@" ../../doc/results/)
    out=doc/results
  else
    echo "Not everything was measured: doc/results stays as it is."
  fi
  echo "Tables and pictures: $out/$1"
}

# fcl_ccd_record_table NAME DURATION [OPTION ...]
#
# For a report that is one table. Goes to the project's folder, installs missing packages
# (Debian), builds in Release and measures. The table goes to build/NAME; without options it
# also replaces that in doc/results.
fcl_ccd_record_table() {
  local name=$1 duration=$2
  shift 2
  cd "$(dirname "${BASH_SOURCE[0]}")/.." || return
  # shellcheck source=cmake/dependencies.sh
  source cmake/dependencies.sh
  fcl_ccd_install_dependencies build
  echo "== Building (about ten minutes on two cores the first time)"
  cmake --preset release
  cmake --build --preset release --target "fcl_ccd_$name"
  echo "== Measuring (everything takes $duration)"
  "build/release/test/fcl_ccd_$name" "build/$name" "$@"
  if [ $# -eq 0 ]; then cp "build/$name/$name.csv" doc/results/; fi
}
