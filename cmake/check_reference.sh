#!/usr/bin/env bash
# Fails when a public function is missing from the reference. Run doxygen first.
#   bash cmake/check_reference.sh [TAG_FILE]
# The script finds functions in the public headers by their form: a declaration outside of
# detail begins at the first column, a public member of DeformableBVHModel and of
# ContinuousCollisionManager at the third.
set -euo pipefail
cd "$(dirname "$0")/.."
tags=${1:-build/doc/fcl_ccd.tag}
[ -f "$tags" ] || { echo "$tags is missing: run doxygen first" >&2; exit 1; }

# Lines "count name": how often a function is declared.
declared=$(
  {
    grep -hoE '^(FCL_EXPORT )?(double|float|bool|ContinuousFeatureTestResult<S>|OctreeCell<S>|std::vector<int>) [a-z][A-Za-z]+\(' \
      include/fcl/narrowphase/*.h include/fcl/geometry/bvh/weld_vertices.h
    sed -n '/DeformableBVHModel .*: public/,/^ private:/p' \
      include/fcl/geometry/bvh/deformable_bvh_model.h |
      grep -oE '^  (int|bool|std::size_t|void) [a-z][A-Za-z]+\('
    sed -n '/^class ContinuousCollisionManager /,/^ private:/p' \
      include/fcl/broadphase/continuous_collision_manager.h |
      grep -oE '^  (bool|std::size_t|void) [a-z][A-Za-z]+\('
  } | sed 's/.* //; s/($//' | LC_ALL=C sort | uniq -c
)
missing=0
total=0
while read -r count name; do
  listed=$(grep -c "<name>$name</name>" "$tags" || true)
  total=$((total + count))
  if [ "$listed" -lt "$count" ]; then
    echo "$name: declared $count times in public headers, $listed times in the reference" >&2
    missing=1
  fi
done <<<"$declared"
if [ "$total" -lt 40 ]; then
  echo "Only $total public functions were found: their form in the headers has changed." >&2
  exit 1
fi
[ $missing -eq 0 ] || exit 1
echo "The reference has all $total public functions."
