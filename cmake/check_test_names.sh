#!/usr/bin/env bash
# A name of a test is plain ASCII, no longer than 100 characters, has no address or bytes of an
# object, and is there once. It reads what CMake wrote for ctest, but not in the folders of the
# doors (test/consumer/run.sh), which have builds of this project of their own.
#   check_test_names.sh BUILD_DIR
set -euo pipefail
cd "$1"
export LC_ALL=C

names=$(find . \( -path ./test/consumer -o -path './doors*' \) -prune -o \( -name CTestTestfile.cmake -o -name '*_tests.cmake' \) -exec cat {} + |
  sed -nE -e 's/^ *add_test\(\[=*\[//; t guarded' -e 's/^ *add_test\("?([^" )]+).*/\1/p; b' \
    -e ':guarded; s/\]=*\].*//p' | sort)
if [ "$(wc -l <<<"$names")" -lt 20 ]; then
  echo "Names of tests are not found in $1" >&2
  exit 1
fi

status=0
# complain WHAT: if there is input, the names that are wrong.
complain() {
  local wrong
  wrong=$(cat)
  if [ -z "$wrong" ]; then return; fi
  echo "$1:" >&2
  head -5 <<<"$wrong" | cut -c1-200 >&2
  status=1
}
complain "Names with other characters than printable ASCII" < <(grep '[^ -~]' <<<"$names")
complain "Names longer than 100 characters" < <(grep -E '.{101}' <<<"$names")
complain "Names with an address or the bytes of an object" < <(grep -E '0x[0-9a-f]{6}|-byte' <<<"$names")
complain "Names of more than one test" < <(uniq -d <<<"$names")
exit $status
