#!/usr/bin/env bash
# Fails when a C++ file of the project is not formatted as .clang-format says.
#   bash cmake/format.sh [CLANG_FORMAT]   check
#   bash cmake/format.sh --fix            rewrite
set -euo pipefail
cd "$(dirname "$0")/.."

# All files of the source folders, also those that git does not know yet.
files() { find examples include python src test \( -name '*.h' -o -name '*.cpp' \) -print0; }

if [ "${1-}" = --fix ]; then
  files | xargs -0 clang-format-14 -i
else
  files | xargs -0 "${1:-clang-format-14}" --dry-run -Werror
fi
