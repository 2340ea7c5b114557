#!/usr/bin/env bash
# Installs missing packages (Debian), builds in Release, and measures speed and errors of
# queries of two meshes of which one turns, or both; doc/numerics.md explains the report.
#   bash cmake/motions.sh [OPTION ...]
# Table, picture and page go to build/motions. Without options they also replace those in
# doc/results. Options are passed to fcl_ccd_motions: --queries 20.
# Measuring everything takes about ten minutes, mostly for FCL's conservative advancement.
set -euo pipefail
# shellcheck source=cmake/report.sh
source "$(dirname "$0")/report.sh"
fcl_ccd_build_report motions
is_whole=false
# shellcheck disable=SC2034
if [ $# -eq 0 ]; then is_whole=true; fi
echo "== Measuring (everything takes about ten minutes)"
# shellcheck disable=SC2154
rm -rf "$out"
build/release/test/fcl_ccd_motions "$out" "$@"
# shellcheck disable=SC2154
gnuplot -e "table='$out/motions.csv'; picture='$out/motions.png'" "$sources/plot.gp"
awk -F, -f "$sources/tables.awk" "$out/motions.csv" >"$out/motions.md"
fcl_ccd_end_report motions.md motions.csv motions.png
