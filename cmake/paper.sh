#!/usr/bin/env bash
# Installs missing packages (Debian), builds in Release, simulates the scenes of the paper's
# evaluation and runs its experiments on them; doc/reproduction.md explains the report.
# Both kinds of frames are measured: proposed motions, and steps whose contacts were answered.
#   bash cmake/paper.sh                            # everything: three to four hours
#   bash cmake/paper.sh --short                    # small scenes: minutes
#   bash cmake/paper.sh --scenes balls alphabets   # some of the scenes
# Frames go to build/scenes, or build/scenes_short. They are kept and not simulated again.
# Tables, pictures and page go to build/paper. When everything is measured they also replace
# those in doc/results. Other options are passed to fcl_ccd_paper.
set -euo pipefail
# shellcheck source=cmake/report.sh
source "$(dirname "$0")/report.sh"

is_whole=true
is_short=false
scenes=(cloth flamenco princess balls alphabets lion)
options=()
while [ $# -gt 0 ]; do
  is_whole=false
  case $1 in
    --short) is_short=true ;;
    --scenes)
      scenes=()
      while [ $# -gt 1 ] && [ "${2#-}" = "$2" ]; do
        scenes+=("$2")
        shift
      done
      ;;
    *) options+=("$1") ;;
  esac
  shift
done
frames=build/scenes
if $is_short; then
  frames=build/scenes_short
  case " ${options[*]-} " in
    *" --every "* | *" --every="*) ;;
    *) options+=(--every 3) ;;
  esac
fi

# A hundredth of the lion is as large as a tenth of the others. A tenth of the letters would be
# too few to break. frames.csv is written last: a scene without it is not complete.
fcl_ccd_simulate() {
  local scene=$1 scale=1
  # A run of an earlier version has no answered frames.
  if [ -f "$frames/$scene/frames.csv" ] && [ -f "$frames/$scene/0001_accepted.ply" ]; then return; fi
  case $is_short-$scene in
    true-lion) scale=0.01 ;;
    true-alphabets) scale=0.3 ;;
    true-*) scale=0.1 ;;
  esac
  rm -f "$frames/$scene/frames.csv"
  build/release/test/reproduction/fcl_ccd_scenes "$frames" --meshes --scenes "$scene" \
    --scale "$scale" --threads "$(nproc)"
}

fcl_ccd_build_report paper fcl_ccd_scenes
echo "== Simulating the scenes that $frames lacks (everything: an hour and a half; --short: minutes)"
for scene in "${scenes[@]}"; do fcl_ccd_simulate "$scene"; done
echo "== Measuring (everything: two hours; --short: minutes)"
rm -rf "$out"
simulations=("${scenes[@]/#/$frames/}")
results=()
for kind in proposed answered; do
  part=$out/$kind
  build/release/test/reproduction/fcl_ccd_paper "$part" --kind $kind --frames "$frames" \
    --scenes "${scenes[@]}" "${options[@]}"
  gnuplot -e "folder='$part'; scripts='$sources'" "$sources/plot.gp"
  awk 'FNR == 1 { n = split(FILENAME, part, "/"); if (NR == 1) print "scene," $0; next }
    { print part[n - 1] "," $0 }' "${simulations[@]/%//frames.csv}" >"$part/paper_frames.csv"
  tables=("$part"/{paper_scenes,paper_frames,table1,figure6,figure8,figure9,figure10,filter}.csv
    "$part"/paper_topologies.csv)
  # Results of both kinds are beside each other.
  prefix=${kind/proposed/}
  prefix=${prefix:+${prefix}_}
  awk -F, -v kind=$kind -v prefix="$prefix" -f "$sources/tables.awk" "${tables[@]}" >"$part/paper.md"
  if [ $kind = answered ]; then rm "$part/paper_frames.csv"; fi
  for file in paper.md {table1,figure6,figure8,figure9,figure10}.{csv,png} filter.csv \
    paper_{scenes,frames,topologies}.csv; do
    if [ -f "$part/$file" ]; then
      mv "$part/$file" "$out/$prefix$file"
      results+=("$prefix$file")
    fi
  done
done
fcl_ccd_end_report "${results[@]}"
