#!/usr/bin/env bash
# Installs what is missing (Debian), builds in Release, and measures the speed of whole
# queries, the library's beside the paper's method; doc/speed.md explains the report.
#   bash cmake/speed.sh [DATA_FOLDER] [OPTION ...]
# Tables, pictures and page go to build/speed. With DATA_FOLDER (scenes/) and no options
# they also replace those in doc/results; without it the generated scenes are measured
# alone. Options are handed to fcl_ccd_speed: --groups smooth,size --repeats 3
# About a quarter of an hour; the largest scene needs 6 GiB of memory.
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
cmake --build --preset release -j "$(nproc)" --target fcl_ccd_speed

out=build/speed
sources=test/benchmark/speed
rm -rf "$out"
build/release/test/fcl_ccd_speed "$out" ${data:+--data "$data"} "$@"
gnuplot -e "folder='$out'" "$sources/plot.gp"
awk -F, -f "$sources/tables.awk" "$out/speed.csv" "$out/speed_sequence.csv" \
  >"$out/speed.md"
if [ -z "$data" ]; then
  echo "Without a data folder: the generated scenes only. doc/results stays as it is."
elif [ $# -eq 0 ]; then
  mkdir -p doc/results
  cp "$out"/speed*.{csv,png,md} doc/results/
  out=doc/results
fi
echo "Tables and pictures: $out/speed.md"
