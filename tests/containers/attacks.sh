#!/usr/bin/env bash
# Runs the attacks on the grader in a real container, confined as podman does by default: as root, or rootless by an
# ordinary user. There bubblewrap cannot make its namespaces, so the sandbox is the one by Landlock; the first lines say so.
# Needs podman, runc and, to make the image, debootstrap and root; takes some minutes, so it is not part of `./tumble test`.
#   tests/containers/attacks.sh make IMAGE.tar          as root: a Debian 12 with a compiler and what the tests are linked with
#   tests/containers/attacks.sh run IMAGE.tar [FILTER]  as root or as an ordinary user; FILTER as GoogleTest takes it
# The tree is seen inside at its own path, read-only; build test_attacks before.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=${TUMBLE_BUILD:-$root/build}
packages=g++,libeigen3-dev,libseccomp2,libssl3,libfmt9,libassimp5,procps,bubblewrap

make_image() {
  [ "$(id -u)" = 0 ] || { echo "attacks.sh: debootstrap needs root" >&2; exit 2; }
  local folder
  folder=$(mktemp -d)
  # shellcheck disable=SC2064
  trap "rm -rf --one-file-system '$folder'" EXIT
  debootstrap --variant=minbase --include="$packages" bookworm "$folder" "${TUMBLE_DEBIAN_MIRROR:-http://deb.debian.org/debian}" >"$1.log" 2>&1 ||
    { tail -n 20 "$1.log" >&2; exit 1; }
  rm -f "$folder"/var/cache/apt/archives/*.deb
  chmod 755 "$folder"   # mktemp's 700 would be that of the image's root: a run's user id could enter nothing
  tar --one-file-system -C "$folder" -cf "$1" .
}

run_attacks() {
  local image filter=${2:-*} podman=(podman --runtime runc --cgroup-manager cgroupfs)
  # An ordinary user has neither the overlay file system nor a session in every container.
  [ "$(id -u)" = 0 ] || podman+=(--storage-driver vfs)
  image=$("${podman[@]}" import --quiet "$1")
  "${podman[@]}" run --rm --network=none --ulimit nofile=1024:1024 --ulimit nproc=2000:2000 \
    --volume "$root:$root:ro" --workdir /tmp "$image" \
    sh -c 'echo "user $(id -u), map $(tr -s " " </proc/self/uid_map)"; grep -E "Seccomp:|CapEff|NoNewPrivs" /proc/self/status
           "$1" --gtest_filter="$2"' container "$build/bin/test_attacks" "$filter"
}

case ${1:-} in
  make) make_image "${2:?the image file}" ;;
  run) run_attacks "${2:?the image file}" "${3:-*}" ;;
  *) sed -n '2,8p' "${BASH_SOURCE[0]}"; exit 2 ;;
esac
