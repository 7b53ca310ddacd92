#!/usr/bin/env bash
# Runs once, when the image is made: installs the grader, then has it grade a right solution, which
# must get every point.
set -euo pipefail
source=${AUTOGRADER_ROOT:-/autograder}/source
export DEBIAN_FRONTEND=noninteractive
apt-get update
if ! apt-get install --yes --no-install-recommends "$source"/packages/tumble-*.deb; then
  . /etc/os-release
  echo "tumble: the packages are for Debian 12, and this image is ${PRETTY_NAME:-another system}." >&2
  echo "  Choose an image with Debian 12 in the settings of the autograder." >&2
  exit 1
fi
rm -rf /var/lib/apt/lists/*
proof=$(mktemp -d)
mkdir "$proof/submission"
cp "@proof@" "$proof/submission/"
tumble autograde @id@ "$proof/submission" --for gradescope --out "$proof/results.json" --must-pass
rm -rf "$proof"
