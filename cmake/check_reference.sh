#!/usr/bin/env bash
# Fails when a public function is missing from the reference. Run doxygen first.
#   bash cmake/check_reference.sh [TAG_FILE]
# ctags reads the public headers, doxygen has read them for the reference, and each function
# of namespace fcl and each public member of its classes must be there as often in both.
set -euo pipefail
cd "$(dirname "$0")/.."
tags=${1:-build/doc/fcl_ccd.tag}
[ -f "$tags" ] || { echo "$tags is missing: run doxygen first" >&2; exit 1; }
command -v ctags >/dev/null || { echo "Install the package universal-ctags" >&2; exit 1; }

# Lines "count scope name". ctags prints equal lines once, so each tells its place. A function
# that is declared and then defined counts once. Members that are defined outside of their class
# have no access there and are left out, as operators are.
declared=$(
  find include -name '*.h' -not -path '*/detail/*' -print0 |
    xargs -0 ctags -x --language-force=C++ --kinds-C++=pf -I FCL_EXPORT,FCL_CCD_FINAL_WITHOUT_RTTI --_xformat='%a %s %N %K %F:%n' |
    { grep -E '^(public fcl::[A-Za-z]+|- fcl) [~A-Za-z0-9_]+ ' || true; } | grep -v ' operator' |
    awk '
      { ++count[$2 " " $3, $4]; names[$2 " " $3] }
      END {
        for (f in names) {
          most = count[f, "prototype"]
          if (count[f, "function"] > most) most = count[f, "function"]
          print most, f
        }
      }'
)

# missing_functions < TAG_FILE: a line for each function that the file has too rarely.
missing_functions() {
  awk '
    NR == FNR { declared[$2 " " $3] = $1; next }
    /<compound / { scope = "" }
    /<name>/ {
      name = $0
      gsub(/ *<\/?name>/, "", name)
      if (scope == "") { scope = name; sub(/ *&lt;.*/, "", scope) } else if (is_function) ++listed[scope " " name]
    }
    /<member / { is_function = /kind="function"/ }
    END {
      for (f in declared)
        if (listed[f] < declared[f])
          print f ": declared " declared[f] " times in public headers, " listed[f] + 0 " times in the reference"
    }' <(echo "$declared") -
}

total=$(awk '{ n += $1 } END { print n }' <<<"$declared")
if [ "$total" -lt 100 ]; then
  echo "ctags found only $total public functions in include/" >&2
  exit 1
fi
missing=$(missing_functions <"$tags")
if [ -n "$missing" ]; then
  echo "$missing" >&2
  exit 1
fi
# The check must be able to fail: without a function, the reference is refused.
for function in continuousCollide refitTopDown lastError; do
  if [ -z "$(sed "s/<name>$function</<name>other</" "$tags" | missing_functions)" ]; then
    echo "The check does not notice that $function is missing." >&2
    exit 1
  fi
done
echo "The reference has all $total public functions."
