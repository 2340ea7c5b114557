#!/usr/bin/env bash
# Installs missing packages (Debian), builds in Release, and measures speed and errors of
# queries of close surfaces that slide; doc/where_the_time_goes.md explains the report.
#   bash cmake/sliding.sh [OPTION ...]
# The table goes to build/sliding. Without options it also replaces that in doc/results.
# Options are passed to fcl_ccd_sliding: --scene cylinder.
set -euo pipefail
# shellcheck source=cmake/report.sh
source "$(dirname "$0")/report.sh"
fcl_ccd_record_table sliding 'about six minutes' "$@"
