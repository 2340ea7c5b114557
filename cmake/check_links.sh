#!/usr/bin/env bash
# Fails and names the line when a link in README, CONTRIBUTING, CHANGELOG or doc/ leads to a
# file or a heading that does not exist. Links to other sites are not checked.
#   bash cmake/check_links.sh
set -euo pipefail
cd "$(dirname "$0")/.."

# "page#anchor" of each heading, by GitHub's rule: lower case, no punctuation, hyphens for spaces.
headings() {
  awk 'FNR == 1 { in_code = 0 } /^```/ { in_code = !in_code }
       !in_code && /^#+ / { sub(/^#+ /, ""); print FILENAME "#" $0 }' "$@" |
    sed -E 's/\]\([^)]*\)//g' | while IFS='#' read -r page heading; do
      heading=${heading,,}
      heading=${heading//[^a-z0-9 _-]/}
      echo "$page#${heading// /-}"
    done
}

pages=(README.md CONTRIBUTING.md CHANGELOG.md doc/*.md doc/results/*.md)
declare -A has_heading
while IFS= read -r heading; do has_heading[$heading]=1; done < <(headings "${pages[@]}")

failed=0
number=0
while IFS=: read -r page line target; do
  number=$((number + 1))
  file=${target%%#*}
  path=$page
  if [ -n "$file" ]; then
    path=$file
    if [[ $page == */* ]]; then path=${page%/*}/$file; fi
    # doc/../README.md is README.md.
    while [[ $path =~ ^(.*/)?[^/.]+/\.\./(.*)$ ]]; do path=${BASH_REMATCH[1]}${BASH_REMATCH[2]}; done
  fi
  if [ ! -e "$path" ]; then
    echo "$page:$line: $target: there is no such file" >&2
    failed=1
  elif [[ $target == *#* ]] && [ -z "${has_heading[$path#${target#*#}]-}" ]; then
    echo "$page:$line: $target: the page has no such heading" >&2
    failed=1
  fi
done < <(grep -noE '\]\([^) ]+\)' "${pages[@]}" |
  sed -E 's/\]\(([^)]*)\)$/\1/' | grep -vE ':[0-9]+:[a-z]+://')

if [ "$number" -eq 0 ]; then
  echo "No link was found: their form has changed." >&2
  exit 1
fi
if [ $failed -eq 0 ]; then echo "All $number links lead somewhere."; fi
exit $failed
