#!/usr/bin/env bash
# Installs missing packages (Debian), builds in Release, and measures speed and errors of
# queries of shapes; doc/numerics.md explains the report.
#   bash cmake/shapes.sh [OPTION ...]
# The table goes to build/shapes. Without options it also replaces that in doc/results.
# Options are passed to fcl_ccd_shapes: --queries 20.
# Measuring everything takes about ten minutes, mostly for FCL's conservative advancement.
set -euo pipefail
# shellcheck source=cmake/report.sh
source "$(dirname "$0")/report.sh"
fcl_ccd_record_table shapes 'about ten minutes' "$@"
