#!/usr/bin/env bash
# Installs missing packages (Debian), builds in Release and runs the demo: about 5 minutes on
# two cores. The demo writes to build/demo. Options are passed to it; --help lists them.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=cmake/dependencies.sh
source cmake/dependencies.sh

fcl_ccd_install_dependencies build
echo "== Building library and demo (about four minutes on two cores the first time)"
cmake --preset release
cmake --build --preset release --target fcl_ccd_demo
echo "== Demo (half a minute)"
build/release/test/fcl_ccd_demo build/demo "$@"
