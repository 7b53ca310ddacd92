#!/usr/bin/env bash
# Builds the containers of framework/packaging/Containerfile.* and .devcontainer/ on a Debian 12 made by debootstrap, so that no registry is needed, and runs in
# them what a student and a teaching assistant do. Needs root, the network, podman, runc, debootstrap and 6 GB; takes some minutes, so
# it is not part of `./tumble test`. Make the packages first: ./tumble package
#   tests/packages/try_containers.sh [PACKAGES [ROOT]]     as try_packages.sh
set -euo pipefail
tree=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
packages=$(cd "${1:-$tree/out/packages}" && pwd)
# shellcheck source=tests/packages/bare_root.sh
source "$tree/tests/packages/bare_root.sh"
work=$(mktemp -d)
podman=(podman --runtime runc --cgroup-manager cgroupfs --storage-driver vfs --root "$work/storage" --runroot "$work/run")
trap 'rm -rf --one-file-system "$work"' EXIT
root=${2:-$work/root}
[ $# -ge 2 ] || bare_root "$root"
tar --one-file-system -C "$root" -cf "$work/base.tar" .
"${podman[@]}" import --quiet "$work/base.tar" tumble-base >/dev/null
rm -f "$work/base.tar"
for which in course grader; do
  "${podman[@]}" build --quiet --isolation chroot --network host --build-arg BASE=localhost/tumble-base -t "tumble-$which" -f "$tree/framework/packaging/Containerfile.$which" "$packages" >/dev/null
  echo "built the container of the $which"
done
# What an editor opens the source tree in.
"${podman[@]}" build --quiet --isolation chroot --network host --build-arg BASE=localhost/tumble-base -t tumble-dev -f "$tree/.devcontainer/Containerfile" "$tree" >/dev/null
echo "built the dev container"
limits=(--ulimit nofile=1024:1024 --ulimit nproc=2000:2000)   # of podman's own, some are above what this machine allows
inside() { "${podman[@]}" run --rm --network=none "${limits[@]}" "tumble-$1" bash -euc "$2"; }
inside course 'tumble start a1 a1; cd a1; code=0; tumble check a1 >said || code=$?; tail -n 3 said; test $code = 4; test ! -e /opt/tumble-grader'
inside grader 'tumble doctor || true; mkdir -p s/right; cp /opt/tumble-grader/solutions_private/a1_impulse/a1_impulse.cpp s/right; tumble grade a1 s --no-media --out out; grep -q 100 out/gradebook.csv'
# As an editor does it: the tree is mounted, and its first command is run in it. A copy, because it builds.
mkdir "$work/tree"
git -C "$tree" archive HEAD | tar -C "$work/tree" -xf -
after=$(sed -n 's/.*"postCreateCommand": "\(.*\)",/\1/p' "$tree/.devcontainer/devcontainer.json")
"${podman[@]}" run --rm --network=none "${limits[@]}" -v "$work/tree:/workspaces/tumble" -w /workspaces/tumble tumble-dev bash -euc "$after; code=0; ./tumble check a1 > said || code=\$?; test \$code = 4; clangd --version"
echo "the three containers work"
