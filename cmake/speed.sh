#!/usr/bin/env bash
# Installs missing packages (Debian), builds in Release, and measures the speed of whole
# queries, of the library and of the paper's method; doc/speed.md explains the report.
#   bash cmake/speed.sh [DATA_FOLDER] [OPTION ...]
# Tables, pictures and page go to build/speed. With DATA_FOLDER (scenes/) and no options
# they also replace those in doc/results. Without DATA_FOLDER only the generated scenes are
# measured. Options are passed to fcl_ccd_speed: --groups smooth,size --repeats 3
# Measuring everything takes a quarter of an hour. The largest scene needs 6 GiB of memory.
set -euo pipefail
# shellcheck source=cmake/report.sh
source "$(dirname "$0")/report.sh"
# shellcheck disable=SC2034
duration='a quarter of an hour'
fcl_ccd_begin_report speed "$@"
gnuplot -e "folder='$out'" "$sources/plot.gp"
awk -F, -f "$sources/tables.awk" "$out"/speed{,_baselines,_options,_sequence}.csv >"$out/speed.md"
fcl_ccd_end_report speed.md speed{,_baselines,_options,_sequence}.csv \
  speed_{size,stages,ablation,sequence}.png
