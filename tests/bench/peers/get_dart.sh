#!/bin/bash
# DART for the bench of peers. Debian's libdart-dev asks for Boost 1.74, which cannot be installed beside the Boost 1.81 that this
# project builds with: only the library is installed, the headers are unpacked into the build folder.
#   usage: tests/bench/peers/get_dart.sh [BUILD_DIR]      as root
set -euo pipefail
cd "$(dirname "$0")/../../.."
build=${1:-build}
apt-get install -y --no-install-recommends libdart6.12
mkdir -p "$build/dart" && cd "$build/dart"
for package in libdart-dev libdart-external-convhull-3d-dev libdart-external-odelcpsolver-dev libfcl-dev liboctomap-dev libccd-dev; do
  apt-get download "$package"
  dpkg -x "$package"_*.deb root
done
