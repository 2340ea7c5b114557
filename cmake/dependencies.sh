# shellcheck shell=bash
# Installs the Debian packages that the project needs and the system does not have. test.sh,
# demo.sh and report.sh source this file.

# fcl_ccd_install_dependencies build|python|test|all [PACKAGE ...]
fcl_ccd_install_dependencies() {
  # These are for the build and the tests. pkg-config: a test builds with fcl.pc.
  local packages=(
    g++ cmake ninja-build make pkg-config
    libfcl-dev libeigen3-dev libboost-dev libhwy-dev libtbb-dev
    libcli11-dev nlohmann-json3-dev libcgal-dev
    libgtest-dev libpng-dev zlib1g-dev libgmp-dev libmpfr-dev
  )
  # These are for the Python package. python: it and the library, and nothing else.
  local python_packages=(pybind11-dev python3-dev python3-numpy)
  if [ "$1" = python ]; then
    packages=(
      g++ cmake make libfcl-dev libeigen3-dev libboost-dev libhwy-dev libtbb-dev
      "${python_packages[@]}"
    )
  elif [ "$1" != build ]; then
    # A test makes Debian packages.
    packages+=("${python_packages[@]}" python3-pytest dpkg-dev debhelper dh-python file)
    # fcl-ccd splits its steps over the ranks of mpirun, which a test does.
    packages+=(libopenmpi-dev openmpi-bin)
  fi
  # These are for the tests of the Python package that a user can do without.
  if [ "$1" = all ]; then
    packages+=(mypy patchelf python3-matplotlib python3-pandas python3-pip python3-setuptools
      python3-wheel)
    # A test runs the notebook of the examples.
    packages+=(python3-nbclient python3-ipykernel)
  fi
  # A test opens the page of a run in a browser.
  if [ "$1" = all ]; then packages+=(chromium chromium-driver); fi
  # These are for the second compiler and its sanitizers, the style checks and the reference.
  if [ "$1" = all ]; then
    packages+=(clang libclang-rt-dev lld clang-format-14 clang-tidy-14 doxygen universal-ctags)
  fi
  packages+=("${@:2}")

  # On another system CMake names the packages that it cannot find.
  command -v dpkg-query >/dev/null || return 0

  local package missing=()
  for package in "${packages[@]}"; do
    if ! dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q ' installed$'; then
      missing+=("$package")
    fi
  done
  if [ ${#missing[@]} -eq 0 ]; then return 0; fi

  local as_root=()
  local install=(apt-get install -y --no-install-recommends "${missing[@]}")
  if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo -n)
    if ! sudo -n true 2>/dev/null; then
      echo "Packages are missing. Install them with this line, then run the script again:" >&2
      echo "  sudo apt-get update && sudo ${install[*]}" >&2
      exit 1
    fi
  fi
  echo "== Installing ${#missing[@]} packages (one to five minutes): ${missing[*]}"
  "${as_root[@]}" apt-get update
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive "${install[@]}"
}
