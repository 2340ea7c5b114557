#!/usr/bin/env bash
# Installs missing packages (Debian), builds in Release, and measures speed and errors of
# queries of shapes; doc/numerics.md explains the report.
#   bash cmake/shapes.sh [OPTION ...]
# The table goes to build/shapes. Without options it also replaces that in doc/results.
# Options are passed to fcl_ccd_shapes: --queries 20.
# Measuring everything takes about ten minutes, mostly for FCL's conservative advancement.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=cmake/dependencies.sh
source cmake/dependencies.sh
fcl_ccd_install_dependencies build
echo "== Building (about ten minutes on two cores the first time)"
cmake --preset release
cmake --build --preset release --target fcl_ccd_shapes
echo "== Measuring (everything takes about ten minutes)"
build/release/test/fcl_ccd_shapes build/shapes "$@"
if [ $# -eq 0 ]; then cp build/shapes/shapes.csv doc/results/; fi
