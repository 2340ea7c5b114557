#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
#
# bash cmake/check_includes.sh [SOURCE_FOLDER]
#
# The folders of src/ are the stages of the pipeline. This script fails and names the file when
#  - a file lies in none of them,
#  - a file includes one of a folder that comes later in the order below,
#  - a file of a folder before model/ includes a header of FCL, or a public one that is not plain,
#  - a public header includes an internal one,
#  - there are more headers for users than `max_headers`, which grows only with the API: all
#    public ones but those of detail/ (the traversal node counts, programs include it) and
#    those that stand for an old name and only include another one,
#  - files include each other in a circle (x.h and x.cpp count as one file).
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

order=(base numerics mesh elementary kernels tree self_culling query
  paths shapes bodies advance curved broadphase model prepare api)

# Prints a line "file included" for each include, but not for those of other libraries.
includes() {
  find "$@" \( -name '*.h' -o -name '*.cpp' \) -exec \
    grep -HE "^[[:space:]]*#[[:space:]]*include[[:space:]]*(\"|<(fcl|$(tr ' ' '|' <<<"${order[*]}"))/)" {} + |
    sed -E 's/:[[:space:]]*#[[:space:]]*include[[:space:]]*["<]/ /; s/[">].*//' | LC_ALL=C sort
}

# What files before model/ may include of the public headers: numbers, and an interface. They
# include nothing of FCL.
is_plain() {
  [[ $1 =~ ^fcl/(narrowphase/stage_counts|narrowphase/continuous_contact_kind|math/motion/bounded_motion)\.h$ ]]
}

failed=0
[ "$(includes src include | wc -l)" -gt 100 ] || { echo "Few includes were found" >&2; exit 1; }
complain() {
  echo "$1" >&2
  failed=1
}

for file in $(find src -maxdepth 1 \( -name '*.h' -o -name '*.cpp' \)); do
  complain "$file: move it to a folder of src/"
done
for folder in src/*/; do
  folder=$(basename "$folder")
  [[ " ${order[*]} tools " == *" $folder "* ]] ||
    complain "src/$folder: add it to the order of folders in cmake/check_includes.sh"
done

declare -A rank
for i in "${!order[@]}"; do rank[${order[i]}]=$i; done

while read -r file included; do
  folder=${file#src/} folder=${folder%%/*}
  target=${included%%/*}
  [[ /$included/ != */../* ]] || complain "$file: includes $included; name the folder without .."
  if [[ $target == fcl ]]; then
    ((${rank[$folder]} >= ${rank[model]})) || is_plain "$included" ||
      complain "$file: includes $included, which only model/, prepare/ and api/ may include"
  elif [[ -n ${rank[$target]+is} ]]; then
    [[ -e src/$included ]] || complain "$file: includes $included, which does not exist"
    ((rank[$target] <= rank[$folder])) ||
      complain "$file: includes $included, from a folder that comes later"
  elif [[ $target != hwy ]]; then
    complain "$file: includes $included; name the file with its folder below src/"
  fi
done < <(includes "${order[@]/#/src/}")

while read -r file included; do
  [[ $included == fcl/* ]] ||
    complain "$file: includes $included; a public header may include public headers only"
done < <(includes include)

# Whether a header has an #include, and else only comments and its guard.
is_forwarding() {
  grep -q '^#include ' "$1" && ! grep -qvE '^($|//|#(ifndef|define|include|endif)( |$))' "$1"
}

max_headers=24
num_headers=0
for header in $(find include -name '*.h'); do
  [[ $header != */detail/* || $header == */detail/traversal/* ]] || continue
  is_forwarding "$header" || num_headers=$((num_headers + 1))
done
((num_headers <= max_headers)) ||
  complain "include/: $num_headers headers for users, $max_headers are allowed"

circle=$(includes "${order[@]/#/src/}" include |
  sed -E 's/^(src|include)\///; s/\.(h|cpp)( |$)/\2/g' | awk '$1 != $2' |
  tsort 2>&1 >/dev/null | sed 's/^tsort: //; s/^-: input.*/a circle:/') ||
  complain "Files include each other:
$circle"

exit $failed
