#!/usr/bin/env bash
# Installs what is missing (Debian), builds in Release, and measures speed against error of
# elementary tests, ours beside others; doc/speed_error.md explains the report.
#   bash cmake/speed_error.sh [DATA_FOLDER] [OPTION ...]
# Tables, picture and page go to build/speed_error. With DATA_FOLDER (scenes/, queries/) and
# no options they also replace those in doc/results; without it only the generated queries
# are measured. Options are handed to fcl_ccd_speed_error: --solver NAME=COMMAND.
# About five minutes, nearly all of it the million generated queries.
set -euo pipefail
data=
if [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; then
  data=$(cd "$1" && pwd)
  shift
fi
cd "$(dirname "$0")/.."
# shellcheck source=cmake/dependencies.sh
source cmake/dependencies.sh

fcl_ccd_install_dependencies build gnuplot-nox
cmake --preset release
cmake --build --preset release -j "$(nproc)" --target fcl_ccd_speed_error

out=build/speed_error
sources=test/benchmark/speed_error
build/release/test/fcl_ccd_speed_error "$out" ${data:+--data "$data"} "$@"
gnuplot -e "table='$out/speed_error.csv'; picture='$out/speed_error.png'" \
  "$sources/plot.gp"
awk -F, -f "$sources/tables.awk" "$out/speed_error.csv" "$out/filter_ratio.csv" \
  >"$out/README.md"
if [ -z "$data" ]; then
  echo "Without a data folder: the generated queries only. doc/results stays as it is."
elif [ $# -eq 0 ]; then
  mkdir -p doc/results
  cp "$out"/{speed_error.csv,filter_ratio.csv,speed_error.png,README.md} doc/results/
  out=doc/results
fi
echo "Tables and picture: $out/README.md"
