#!/usr/bin/env bash
# Installs missing packages (Debian), builds in Release, and runs random cases of all families
# against their references on all cores; doc/fuzz.md explains the table.
#   bash cmake/fuzz.sh [--minutes N] [--seed S] [--families a,b] [--append]
# Without --minutes it takes 10 minutes. Without --seed each day has a seed of its own.
# --append adds the rows to doc/results/fuzz.csv. The same cases are then answered with each
# instruction set of the processor, which has to change no bit.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=cmake/dependencies.sh
source cmake/dependencies.sh

minutes=10
seed=$(date +%Y%m%d)
families=()
append=false
while [ $# -gt 0 ]; do
  case $1 in
    --minutes) minutes=$2; shift ;;
    --seed) seed=$2; shift ;;
    --families) families=(--families "$2"); shift ;;
    --append) append=true ;;
    *) echo "unknown option $1" >&2; exit 2 ;;
  esac
  shift
done

fcl_ccd_install_dependencies build
cmake --preset release
cmake --build --preset release --target fcl_ccd_fuzz
fuzz=build/release/test/fcl_ccd_fuzz
out=build/fuzz
mkdir -p "$out"

status=0
"$fuzz" --minutes "$minutes" --seed "$seed" "${families[@]}" --csv "$out/fuzz.csv" || status=1

# digests SET: the hashes of the answers with an instruction set. Fails where there is no further
# set, for which the program returns 2.
digests() {
  local code=0
  "$fuzz" --instruction-set "$1" --cases 20 --seed "$seed" "${families[@]}" \
    --digests "$out/digests" >"$out/table" || code=$?
  if [ "$code" -eq 2 ]; then return 1; fi
  if [ "$code" -ne 0 ]; then
    cat "$out/table" >&2
    status=1
  fi
  sort "$out/digests"
}
digests 0 >"$out/best"
for ((set = 1; ; ++set)); do
  if ! digests "$set" >"$out/lower"; then break; fi
  if ! diff "$out/best" "$out/lower" >"$out/differences"; then
    echo "Instruction set $set answers otherwise (family, number, --case, digest):"
    head -10 "$out/differences"
    status=1
  fi
done
echo "$set instruction sets were compared"

if $append; then
  table=doc/results/fuzz.csv
  [ -e "$table" ] || echo "commit,date,seed,$(head -1 "$out/fuzz.csv")" >"$table"
  tail -n +2 "$out/fuzz.csv" |
    sed "s/^/$(git rev-parse --short HEAD),$(date +%F),$seed,/" >>"$table"
fi
exit $status
