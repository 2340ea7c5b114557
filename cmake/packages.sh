#!/usr/bin/env bash
# Installs missing packages (Debian) and makes Debian packages in build/packages.
#   bash cmake/packages.sh             builds the project first
#   bash cmake/packages.sh BUILD OUT   packs the finished build in the folder BUILD into OUT
# Then: sudo apt-get install ./build/packages/*.deb
set -euo pipefail
if [ $# -eq 2 ]; then
  mkdir -p "$2"
  given=("$(cd "$1" && pwd)" "$(cd "$2" && pwd)")
fi
cd "$(dirname "$0")/.."
project=$PWD
# shellcheck source=cmake/dependencies.sh
source cmake/dependencies.sh

case $# in
  0)
    fcl_ccd_install_dependencies build pybind11-dev python3-dev python3-numpy \
      dpkg-dev debhelper dh-python lintian
    build=$project/build/packages/build
    out=$project/build/packages
    rm -f "$out"/*.deb
    cmake -B "$build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr \
      -DCMAKE_INSTALL_DOCDIR=share/doc/libfcl-ccd-dev -DCMAKE_SKIP_INSTALL_RPATH=ON \
      -DFCL_CCD_DOORS=nested -DFCL_CCD_BUILD_PYTHON=ON \
      -DFCL_CCD_BUILD_BENCHMARKS=OFF -DBUILD_TESTING=OFF
    cmake --build "$build" -j "$(nproc)"
    ;;
  2)
    build=${given[0]} out=${given[1]}
    ;;
  *) echo "usage: bash cmake/packages.sh [BUILD OUT]" >&2; exit 2 ;;
esac

version=$(sed -n 's/.*define FCL_CCD_VERSION "\(.*\)".*/\1/p' include/fcl/ccd_version.h)
date=$(sed -n "s/^## \[$version\] - //p" CHANGELOG.md)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/source"
cp -r cmake/packaging/debian "$work/source/debian"
sed -i "s/@VERSION@/$version/; s/@SOVERSION@/${version%.*}/; s/@DATE@/$(date -R -u -d "$date")/" \
  "$work"/source/debian/{control,rules,changelog,library.lintian-overrides}
mv "$work/source/debian/library.lintian-overrides" \
  "$work/source/debian/libfcl-ccd${version%.*}.lintian-overrides"
(
  cd "$work/source"
  export FCL_CCD_BUILD_DIR=$build
  # What is needed to build was there when the project was built.
  dpkg-buildpackage --build=binary --no-check-builddeps --no-sign
)
mv "$work"/*.deb "$out"
# The project has no address for mail until it is published.
if [ $# -eq 0 ]; then
  lintian --fail-on error --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog \
    "$out"/*.deb
fi
echo "The packages are in $out:"
(cd "$out" && ls -- *.deb)
