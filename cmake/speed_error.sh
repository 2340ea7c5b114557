#!/usr/bin/env bash
# Installs missing packages (Debian), builds in Release, and measures speed against error of
# elementary tests, ours and others; doc/speed_error.md explains the report.
#   bash cmake/speed_error.sh [DATA_FOLDER] [OPTION ...]
# Tables, picture and page go to build/speed_error. With DATA_FOLDER (scenes/, queries/) and
# no options they also replace those in doc/results. Without DATA_FOLDER only the generated
# queries are measured. Options are passed to fcl_ccd_speed_error: --solver NAME=COMMAND.
# Measuring everything takes about five minutes, mostly for the million generated queries.
set -euo pipefail
# shellcheck source=cmake/report.sh
source "$(dirname "$0")/report.sh"
# shellcheck disable=SC2034
duration='five minutes'
fcl_ccd_begin_report speed_error "$@"
gnuplot -e "table='$out/speed_error.csv'; picture='$out/speed_error.png'" \
  "$sources/plot.gp"
awk -F, -f "$sources/tables.awk" "$out/speed_error.csv" "$out/filter_ratio.csv" \
  >"$out/speed_error.md"
fcl_ccd_end_report speed_error.md speed_error.csv filter_ratio.csv speed_error.png
