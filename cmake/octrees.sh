#!/usr/bin/env bash
# Installs missing packages (Debian), builds in Release, and measures speed and errors of
# queries of a mesh and an octree; doc/broad_phase.md explains the report.
#   bash cmake/octrees.sh [OPTION ...]
# The table goes to build/octrees. Without options it also replaces that in doc/results.
# Options are passed to fcl_ccd_octrees: --queries 20.
set -euo pipefail
# shellcheck source=cmake/report.sh
source "$(dirname "$0")/report.sh"
fcl_ccd_record_table octrees 'about two minutes' "$@"
