#!/usr/bin/env bash
# What tumble export makes, in containers laid out as Gradescope, Artemis, GitHub Classroom and Autolab lay them out: the image is made as
# the platform makes it, then a right, a wrong, a crashing and a hostile submission, an empty one, one that does not compile and a zip
# are graded without a network, and what a student would read is held against the rules of the format and searched for hidden tests.
# Needs root, the network, podman, runc, debootstrap, zip, unzip and 8 GB; takes some minutes, so it is not part of `./tumble test`
# (tests/platforms/autograders_test.sh is). Make the packages and the validator first: ./tumble package; ninja -C build validate_platform
#   tests/containers/platforms.sh [PACKAGES [ROOT]]     PACKAGES: the folder with them (out/packages); ROOT: a bare Debian 12
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
trap '"${podman[@]}" rmi --all --force >/dev/null 2>&1 || true; rm -rf --one-file-system "$folder"' EXIT
fail() { echo "platforms.sh: $*" >&2; exit 1; }

make_submissions "$root" "$folder/submissions"
hidden_names "$root" >"$folder/hidden"
export TUMBLE_ROOT=$root
for platform in gradescope artemis github-classroom autolab; do
  "$build/bin/tumble" export $platform a1 "$folder/$platform.zip" --packages "$packages" >/dev/null
  unpacked "$folder/$platform.zip" "$folder/$platform/source"
done

bare=${2:-$folder/root}
[ $# -ge 2 ] || bare_root "$bare"
tar --one-file-system -C "$bare" -cf "$folder/base.tar" .
"${podman[@]}" import --quiet "$folder/base.tar" tumble-base >/dev/null
rm -f "$folder/base.tar"
image_of() { "${podman[@]}" build --quiet --isolation chroot --network host --build-arg BASE="localhost/$3" -t "tumble-$1" -f "$2" "${4:-$folder/empty}" >/dev/null; }
mkdir "$folder/empty"
# Each image begins with what the packages depend on, fetched once.
{
  echo "ARG BASE"; echo "FROM \${BASE}"
  echo "RUN apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends g++ libeigen3-dev bubblewrap make $(
    dpkg-deb -f "$packages"/tumble-course_*.deb Depends | tr ',' '\n' | sed 's/|.*//; s/(.*//; s/ //g' | xargs)"
} >"$folder/Containerfile"
image_of ready "$folder/Containerfile" tumble-base

# The images, as each platform makes them.
cat >"$folder/Containerfile" <<'END'
ARG BASE
FROM ${BASE}
COPY . /autograder/source
RUN /autograder/source/setup.sh
END
image_of gradescope "$folder/Containerfile" tumble-ready "$folder/gradescope/source"
image_of artemis "$folder/artemis/source/image/Containerfile" tumble-ready "$folder/artemis/source/image"
cat >"$folder/Containerfile" <<'END'
ARG BASE
FROM ${BASE}
COPY . /repository
RUN cd /repository && apt-get update && apt-get install --yes --no-install-recommends ./.github/tumble/tumble-course_*.deb
END
image_of github-classroom "$folder/Containerfile" tumble-ready "$folder/github-classroom/source"
image_of autolab-grader "$folder/autolab/source/image/Containerfile" tumble-ready "$folder/autolab/source/image"
cat >"$folder/Containerfile" <<'END'
ARG BASE
FROM ${BASE}
RUN useradd --create-home autograde && usermod --append --groups tumble-graders autograde
END
image_of autolab "$folder/Containerfile" tumble-autolab-grader
echo "made the four images"

place_of() { case $1 in gradescope) echo /autograder ;; artemis) echo /var/tmp/testing-dir ;; github-classroom) echo /__w/repository ;; autolab) echo /home/autograde/autolab ;; esac; }
# Autolab's autodriver runs make as a user of its own; the others are root of their container.
as_user() { [ "$1" = autolab ] && echo "setpriv --reuid autograde --regid autograde --init-groups" || true; }
for platform in gradescope artemis github-classroom autolab; do
  for kind in right wrong crashing hostile empty broken zipped; do
    out=$folder/$platform/$kind
    mkdir -p "$out" && chmod 777 "$out"
    # shellcheck disable=SC2046
    "${podman[@]}" run --rm --network=none --ulimit nofile=1024:1024 --ulimit nproc=2000:2000 \
      --volume "$folder/$platform/source:/source:ro" --volume "$folder/submissions/$kind:/handed_in:ro" --volume "$out:/out" \
      --volume "$root/tests/platforms/run_platform.sh:/run_platform.sh:ro" "localhost/tumble-$platform" \
      $(as_user $platform) bash -uc 'source /run_platform.sh; code=0; run_platform "$1" /source /handed_in "$2" || code=$?
        cp -r "$2/student" "$2/stderr" /out/; [ ! -d "$2/results" ] || cp "$2/results/stdout" /out/ 2>/dev/null; exit $code' container $platform "$(place_of $platform)" ||
      { cat "$out/stderr" 2>/dev/null; fail "$platform, $kind: ended with an error"; }
    expect_result "$build/bin/validate_platform" $platform "$out" $kind "$folder/hidden" || fail "$platform, $kind"
  done
done
# Where nobody else reads, the instructor does.
grep -q '(hidden)' "$folder/gradescope/wrong/stdout" || fail "instructors find no story of a hidden test on Gradescope"
echo "every platform's container grades, and writes what that platform reads"
