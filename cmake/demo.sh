#!/usr/bin/env bash
# Installs what is missing (Debian), builds in Release and runs the demo; its output goes
# to build/demo. Options are handed to the demo.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=cmake/dependencies.sh
source cmake/dependencies.sh

fcl_ccd_install_dependencies build
cmake --preset release
cmake --build --preset release -j "$(nproc)" --target fcl_ccd_demo
build/release/test/fcl_ccd_demo build/demo "$@"
