#!/usr/bin/env bash
# Fails and names the option when the manual page or the bash completion of fcl-ccd has not the
# same options as --help, the column when the completion does not offer it, or package.xml another
# version.
#   bash cmake/check_manual.sh PROGRAM
set -euo pipefail
program=$1
cd "$(dirname "$0")/.."
manual=doc/fcl-ccd.1
completion=src/tools/fcl_ccd/completion.bash

options() { grep -oE '(^|[^a-z-])--[a-z][a-z-]+' | grep -oE -- '--[a-z][a-z-]+' | LC_ALL=C sort -u; }

commands='run candidates queries compare'
help=$({ "$program" --help; for command in $commands; do "$program" "$command" --help; done; } | options)
[ "$(wc -l <<<"$help")" -gt 15 ] || { echo "Few options were found: --help has changed" >&2; exit 1; }

failed=0
compare() { # NAME OPTIONS
  local difference
  if ! difference=$(diff <(echo "$help") <(echo "$2")); then
    echo "$1 differs from --help (<):" >&2
    echo "$difference" >&2
    failed=1
  fi
}
compare "$manual" "$(sed 's/\\-/-/g; s/\\f.//g' "$manual" | options)"
compare "$completion" "$(options <"$completion")"

# What the completion offers for the begin of a word behind another word of a command.
offered() { # COMMAND BEGIN BEFORE
  bash -c "source $completion; COMP_WORDS=(fcl-ccd $1) COMP_CWORD=2
    _fcl_ccd fcl-ccd '$2' '$3'; printf '%s\n' \"\${COMPREPLY[@]}\"" | LC_ALL=C sort -u
}
for command in $commands; do
  for option in $("$program" "$command" --help | grep -oE '^  [^ ].*' | options); do
    grep -qxF -- "$option" <(offered "$command" -- "$command") ||
      { echo "$completion: $command does not offer $option" >&2; failed=1; }
  done
done

# The names of columns, which the program lists when it refuses one.
for command in run candidates queries; do
  columns=$("$program" "$command" x y --columns '?' 2>&1 | sed -n 's/.*The columns are: //p' | tr -d ',') || true
  [ "$(wc -w <<<"$columns")" -ge 9 ] || { echo "$command does not list its columns" >&2; exit 1; }
  words=$(offered "$command" '' --columns)
  for column in $columns; do
    grep -qw -- "$column" <<<"$words" ||
      { echo "$completion: --columns of $command does not offer $column" >&2; failed=1; }
  done
done

version=$(sed -n 's/.*define FCL_CCD_VERSION "\(.*\)"/\1/p' include/fcl/ccd_version.h)
if ! grep -q "<version>$version</version>" package.xml; then
  echo "package.xml: the version is not $version" >&2
  failed=1
fi
exit $failed
