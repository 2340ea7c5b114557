#!/usr/bin/env bash
# Fails when README.md is too long, or its code differs from the example.
#   bash cmake/check_readme.sh words     at most 700 words outside of code and tables
#   bash cmake/check_readme.sh example   the C++ block equals the code between the marks in
#                                        examples/first_contact.cpp
set -euo pipefail
cd "$(dirname "$0")/.."

most_words=700
example=examples/first_contact.cpp

# README without code, tables, pictures, comments and the addresses of links.
prose() {
  awk '/^```/ { in_code = !in_code; next } !in_code && !/^\|/' README.md |
    sed -E 's/<!--.*-->//g; s/!\[[^]]*\]\([^)]*\)//g; s/\]\([^)]*\)/]/g'
}

readme_code() { awk '/^```cpp$/ { on = 1; next } /^```$/ { on = 0 } on' README.md; }

# The parts between the marks, without their indentation, separated by empty lines.
example_code() {
  awk '/\[README begin\]/ { if (parts++) print ""; match($0, /^ */); indent = RLENGTH; on = 1; next }
    /\[README end\]/ { on = 0 } on { print substr($0, indent + 1) }' "$example"
}

case "${1-}" in
  words)
    words=$(prose | wc -w)
    echo "README.md has $words words of prose; $most_words are allowed."
    if [ "$words" -gt "$most_words" ]; then
      echo "Move what most readers do not need to a page of doc/." >&2
      exit 1
    fi
    ;;
  example)
    if [ -z "$(readme_code)" ] || ! diff <(example_code) <(readme_code); then
      echo "The C++ block of README.md (>) differs from $example (<) between its marks." >&2
      exit 1
    fi
    echo "README.md shows the code of $example."
    ;;
  *)
    echo "usage: bash cmake/check_readme.sh words | example" >&2
    exit 2
    ;;
esac
