#!/usr/bin/env bash
# What the build makes of the 3D view where npm fails or is missing: an empty script, and a stamp
# if no later build need try again.
#   test_bundle.sh FOLDER
set -euo pipefail
sources=$(cd "$(dirname "$0")/../../src/tools/viewer" && pwd)
rm -rf "$1"

bundle() { # FOLDER NAME NPM
  local folder=$1/$2
  mkdir -p "$folder"
  cmake -DNPM="$3" -DSOURCES="$sources" -DOUT="$folder/viewer.min.js" -DSTAMP="$folder/stamp" \
    -DWORK="$folder/work" -P "$sources/bundle.cmake" 2>"$folder/stderr.txt"
  [ -f "$folder/viewer.min.js" ] && [ ! -s "$folder/viewer.min.js" ]
  grep -q "without the 3D view" "$folder/viewer.min.js.LICENSE"
}

bundle "$1" missing ""
[ -f "$1/missing/stamp" ]
[ ! -s "$1/missing/stderr.txt" ]

bundle "$1" failed "$(type -P false)"
[ ! -e "$1/failed/stamp" ]
grep -q "The next build tries" "$1/failed/stderr.txt"
# A second failure leaves the script as it is, of which other files are made.
touch -d 2020-01-01 "$1/failed/viewer.min.js"
touch "$1/failed/stamp"
bundle "$1" failed "$(type -P false)"
[ ! -e "$1/failed/stamp" ]
[ "$(date -r "$1/failed/viewer.min.js" +%Y)" = 2020 ]
