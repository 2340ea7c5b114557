#!/usr/bin/env bash
# Installs missing packages (Debian), builds in Release, and measures speed against error of
# elementary tests at a distance, ours and others; doc/thickness.md explains the report.
#   bash cmake/distances.sh [OPTION ...]
# The table goes to build/distances. Without options it also replaces that in doc/results.
# Options are passed to fcl_ccd_distances: --queries 100.
# Measuring everything takes about a minute, mostly for the inclusion test.
set -euo pipefail
# shellcheck source=cmake/report.sh
source "$(dirname "$0")/report.sh"
fcl_ccd_record_table distances 'about a minute' "$@"
