#!/usr/bin/env bash
# Fails and names the line when a link in README, CONTRIBUTING, CHANGELOG or doc/ leads to a
# file or a heading that does not exist. Links to other sites are not checked.
#   bash cmake/check_links.sh
set -euo pipefail
cd "$(dirname "$0")/.."

# The anchors of a page, by GitHub's rule: lower case, no punctuation, hyphens for spaces.
anchors() {
  awk '/^```/ { in_code = !in_code } !in_code && /^#+ /' "$1" |
    sed -E 's/^#+ //; s/\]\([^)]*\)//g' | tr '[:upper:]' '[:lower:]' |
    sed -E 's/[^a-z0-9 _-]//g; s/ /-/g'
}

failed=0
number=0
while IFS=: read -r page line target; do
  number=$((number + 1))
  file=${target%%#*}
  path=$page
  if [ -n "$file" ]; then path=$(dirname "$page")/$file; fi
  if [ ! -e "$path" ]; then
    echo "$page:$line: $target: there is no such file" >&2
    failed=1
  elif [[ $target == *#* ]] && ! grep -qxF -- "${target#*#}" <(anchors "$path"); then
    echo "$page:$line: $target: the page has no such heading" >&2
    failed=1
  fi
done < <(grep -noE '\]\([^) ]+\)' README.md CONTRIBUTING.md CHANGELOG.md doc/*.md doc/results/*.md |
  sed -E 's/\]\(([^)]*)\)$/\1/' | grep -vE ':[0-9]+:[a-z]+://')

if [ "$number" -eq 0 ]; then
  echo "No link was found: their form has changed." >&2
  exit 1
fi
if [ $failed -eq 0 ]; then echo "All $number links lead somewhere."; fi
exit $failed
