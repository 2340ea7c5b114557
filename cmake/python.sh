#!/usr/bin/env bash
# Installs missing packages (Debian) and builds the Python package: about four minutes on two
# cores. The package is in build/python/python afterwards.
#   bash cmake/python.sh           build, and run an example
#   bash cmake/python.sh --wheel   also make a wheel in build/python, which holds the libraries
#                                  that it needs
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=cmake/dependencies.sh
source cmake/dependencies.sh

wheel=false
case "${1-}" in
  --wheel) wheel=true ;;
  "") ;;
  *) echo "usage: bash cmake/python.sh [--wheel]" >&2; exit 2 ;;
esac

if $wheel; then
  fcl_ccd_install_dependencies python python3-pip python3-setuptools python3-wheel patchelf
else
  fcl_ccd_install_dependencies python
fi
echo "== Building (about four minutes on two cores the first time)"
cmake -B build/python -DCMAKE_BUILD_TYPE=Release -DFCL_CCD_BUILD_PYTHON=ON \
  -DFCL_CCD_BUILD_TOOLS=OFF -DFCL_CCD_BUILD_BENCHMARKS=OFF -DBUILD_TESTING=OFF
cmake --build build/python --target fcl_ccd_python -j "$(nproc)"
if $wheel; then
  echo "== Wheel"
  rm -rf build/python/plain
  FCL_CCD_BUILD_DIR=$PWD/build/python /usr/bin/python3 -m pip wheel --no-index --no-deps \
    --no-build-isolation -w build/python/plain ./python
  rm -f build/python/*.whl
  /usr/bin/python3 cmake/packaging/wheel/bundle.py build/python/plain/*.whl build/python
  ls build/python/*.whl
fi
echo "== Example: python/examples/planner.py"
export PYTHONPATH=$PWD/build/python/python
/usr/bin/python3 python/examples/planner.py
echo "Python finds the package with this line:"
echo "  export PYTHONPATH=$PYTHONPATH"
