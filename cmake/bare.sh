#!/usr/bin/env bash
# Follows the README as a new user does, in a bare Debian system in a folder: the two commands
# of "Try it", the lines of "Install and link", and the Debian packages. It needs root and the
# package mmdebstrap; the system stays as it is.
#   bash cmake/bare.sh [bookworm | trixie] [demo | test | library | packages ...]
# Without names of parts all are run. The system and the log of each part are in build/bare.
set -euo pipefail
cd "$(dirname "$0")/.."
suite=${1:-bookworm}
if [ $# -gt 0 ]; then shift; fi
parts=("$@")
if [ $# -eq 0 ]; then parts=(demo test library packages); fi
if [ "$(id -u)" -ne 0 ] || ! command -v mmdebstrap >/dev/null; then
  echo "bare.sh needs root and mmdebstrap. Run: sudo apt-get install mmdebstrap" >&2
  exit 1
fi
if [ -n "$(git status --porcelain)" ]; then
  echo "bare.sh tries the last commit. Commit your changes first" >&2
  exit 1
fi
root=$PWD/build/bare/$suite
mkdir -p build/bare

if [ ! -d "$root" ]; then
  echo "== A bare system: $suite (two minutes)"
  rm -rf "$root.new"
  mmdebstrap --variant=minbase --include=ca-certificates,git "$suite" "$root.new" \
    http://deb.debian.org/debian
  mv "$root.new" "$root"
fi
rm -rf "$root/root/fcl-ccd"
git clone --quiet . "$root/root/fcl-ccd"

# inside COMMAND: in the system, with nothing of this machine but its network. The mounts end
# with the command.
inside() {
  local kept=(HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin) name
  for name in http_proxy https_proxy no_proxy; do
    if [ -n "${!name-}" ]; then kept+=("$name=${!name}"); fi
  done
  unshare --mount --pid --fork bash -c '
    set -e
    root=$1
    shift
    mount -t proc proc "$root/proc"
    mount --rbind /dev "$root/dev"
    mount -t tmpfs tmpfs "$root/dev/shm"
    cp /etc/resolv.conf "$root/etc/resolv.conf"
    exec chroot "$root" env -i "$@"' bash "$root" "${kept[@]}" \
    bash -euc "cd /root/fcl-ccd; $1"
}

# A block of shell commands of the README, by its number, as a user copies it.
block() {
  awk -v wanted="$1" '/^```sh/ {n++; inside = 1; next} /^```/ {inside = 0}
    inside && n == wanted' README.md
}

# The block of another language, of which README has one.
code_in() { awk -v begin="^\`\`\`$1\$" '/^```/ {inside = 0} inside; $0 ~ begin {inside = 1}' README.md; }

# What a program of a user is, with the packages installed.
program='printf "%s\n" "cmake_minimum_required(VERSION 3.22)" "project(user CXX)" \
    "set(CMAKE_CXX_STANDARD 17)" "find_package(fcl_ccd REQUIRED)" \
    "add_executable(user /root/fcl-ccd/examples/first_contact.cpp)" \
    "target_link_libraries(user fcl)" >/root/user/CMakeLists.txt'

for part in "${parts[@]}"; do
  echo "== $suite: $part"
  case $part in
    demo) command="bash cmake/demo.sh" ;;
    test) command="bash cmake/test.sh" ;;
    library)
      command="apt-get update
        $(block 2 | sed -e '/^git clone/d' -e 's/sudo apt-get install/apt-get install -y/')
        cmake --build build/examples
        ctest --test-dir build/examples --output-on-failure
        cd /root/first
        $(block 3)"
      mkdir -p "$root/root/first"
      code_in cpp >"$root/root/first/first_contact.cpp"
      code_in cmake >"$root/root/first/CMakeLists.txt"
      ;;
    packages)
      command="bash cmake/packages.sh
        apt-get install -y ./build/packages/*.deb
        fcl-ccd --version
        /usr/bin/python3 -c 'import fcl_ccd; print(fcl_ccd.__file__)'
        mkdir -p /root/user; $program
        cmake -S /root/user -B /root/user/build; cmake --build /root/user/build
        /root/user/build/user
        apt-get purge -y 'libfcl-ccd*' fcl-ccd python3-fcl-ccd
        [ -z \"\$(find / -xdev -path /root -prune -o -name '*fcl[-_]ccd*' -print)\" ]"
      ;;
    *) echo "There is no part $part" >&2; exit 2 ;;
  esac
  begin=$SECONDS
  if ! inside "$command" >"$root-$part.log" 2>&1; then
    tail -n 30 "$root-$part.log"
    echo "$suite: $part failed. The log is $root-$part.log" >&2
    exit 1
  fi
  echo "   passed in $(((SECONDS - begin) / 60)) min $(((SECONDS - begin) % 60)) s"
done
