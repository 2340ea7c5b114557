#!/usr/bin/env bash
# Fails when a C++ file of the project is not formatted as .clang-format says.
#   bash cmake/format.sh [CLANG_FORMAT]   check
#   bash cmake/format.sh --fix            rewrite
set -euo pipefail
cd "$(dirname "$0")/.."

# Everything in the source folders, so that files new to git are checked as well.
files() { find examples include src test \( -name '*.h' -o -name '*.cpp' \) -print0; }

if [ "${1-}" = --fix ]; then
  files | xargs -0 clang-format-14 -i
else
  files | xargs -0 "${1:-clang-format-14}" --dry-run -Werror
fi
