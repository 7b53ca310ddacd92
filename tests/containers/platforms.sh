#!/usr/bin/env bash
# What tumble export makes, in containers laid out as Gradescope, Artemis, GitHub Classroom and Autolab lay them out: prepared as the
# platform prepares them, then a right, a wrong, a crashing and a hostile submission, an empty one, one that does not compile and a zip
# are graded without a network, and what a student would read is held against the rules of the format and searched for hidden tests.
# Needs root, the network, podman, runc, debootstrap, zip, unzip and 3 GB; takes some minutes, so it is not part of `./tumble test`
# (tests/platforms/autograders_test.sh is). Make the packages and the validator first: ./tumble package; ninja -C build validate_platform
#   tests/containers/platforms.sh [PACKAGES [ROOT]]     PACKAGES: the folder with them (out/packages); ROOT: a bare Debian 12, used up
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=${TUMBLE_BUILD:-$root/build}
packages=$(cd "${1:-$root/out/packages}" && pwd)
# shellcheck source=tests/packages/bare_root.sh
source "$root/tests/packages/bare_root.sh"
# shellcheck source=tests/platforms/run_platform.sh
source "$root/tests/platforms/run_platform.sh"
folder=$(mktemp -d -p "${TUMBLE_SCRATCH:-/var/tmp}")
podman=(podman --runtime runc --cgroup-manager cgroupfs --storage-driver vfs --root "$folder/storage" --runroot "$folder/run")
trap 'rm -rf --one-file-system "$folder"' EXIT
fail() { echo "platforms.sh: $*" >&2; exit 1; }

make_submissions "$root" "$folder/submissions"
hidden_names "$root" >"$folder/hidden"
export TUMBLE_ROOT=$root
for platform in gradescope artemis github-classroom autolab; do
  "$build/bin/tumble" export $platform a1 "$folder/$platform.zip" --packages "$packages" >/dev/null
  unpacked "$folder/$platform.zip" "$folder/$platform/source"
done

# One root for all, in which each step of a platform is a container of its own: podman build would do the same in a process group
# that it shares with the host, where two graders may take one user id for their runs.
bare=${2:-$folder/root}
[ $# -ge 2 ] || bare_root "$bare"
# in_container NETWORK [PODMAN'S WORDS] -- WORDS: with podman's own confinement
in_container() {
  local network=$1 words=()
  shift
  while [ "$1" != -- ]; do words+=("$1"); shift; done
  shift
  "${podman[@]}" run --rm --network="$network" --ulimit nofile=1024:1024 --ulimit nproc=2000:2000 "${words[@]}" --rootfs "$bare" "$@"
}
# What each platform does once, before the first submission.
prepare() {
  case $1 in
    github-classroom) in_container host --volume "$folder/$1/source:/repository:ro" -- \
      bash -c 'cd /repository && apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends ./.github/tumble/tumble-course_*.deb' ;;
    gradescope) in_container host --volume "$folder/$1/source:/autograder/source" -- /autograder/source/setup.sh ;;
    artemis) ;;   # the same packages, by Containerfile.grader: try_containers.sh builds it
    autolab) in_container none -- bash -c 'useradd --create-home autograde && usermod --append --groups tumble-graders autograde' ;;
  esac >"$folder/prepared" 2>&1 || { tail -n 20 "$folder/prepared"; fail "$1: its preparation failed"; }
  echo "prepared $1"
}

place_of() { case $1 in gradescope) echo /autograder ;; artemis) echo /var/tmp/testing-dir ;; github-classroom) echo /__w/repository ;; autolab) echo /home/autograde/autolab ;; esac; }
# Autolab's autodriver runs make as a user of its own; the others are root of their container.
as_user() { [ "$1" = autolab ] && echo "setpriv --reuid autograde --regid autograde --init-groups" || true; }
for platform in github-classroom gradescope artemis autolab; do
  prepare $platform
  for kind in right wrong crashing hostile empty broken zipped; do
    out=$folder/$platform/$kind
    mkdir -p "$out" && chmod 777 "$out"
    # shellcheck disable=SC2046
    in_container none --volume "$folder/$platform/source:/source:ro" --volume "$folder/submissions/$kind:/handed_in:ro" --volume "$out:/out" \
      --volume "$root/tests/platforms/run_platform.sh:/run_platform.sh:ro" -- \
      $(as_user $platform) bash -uc 'source /run_platform.sh; code=0; run_platform "$1" /source /handed_in "$2" || code=$?
        cp -r "$2/student" "$2/stderr" /out/; [ ! -d "$2/results" ] || cp "$2/results/stdout" /out/ 2>/dev/null; exit $code' container $platform "$(place_of $platform)" ||
      { cat "$out/stderr" 2>/dev/null; fail "$platform, $kind: ended with an error"; }
    expect_result "$build/bin/validate_platform" $platform "$out" $kind "$folder/hidden" || fail "$platform, $kind"
  done
done
# Where nobody else reads, the instructor does.
grep -q '(hidden)' "$folder/gradescope/wrong/stdout" || fail "instructors find no story of a hidden test on Gradescope"
echo "every platform's container grades, and writes what that platform reads"
