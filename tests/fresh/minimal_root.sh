#!/usr/bin/env bash
# Proves packages.txt complete: makes a minimal Debian 12 root with debootstrap, clones the committed tree into an empty
# folder inside it, and runs the README's two commands there. Needs root, the network and about 5 GB; takes half an hour,
# so it is not part of `./tumble test`.
#   tests/fresh/minimal_root.sh [FOLDER]      FOLDER: where the root is made (default: a new temporary folder, removed at the end)
set -euo pipefail
[ "$(id -u)" = 0 ] || { echo "minimal_root.sh: debootstrap and chroot need root" >&2; exit 2; }
command -v debootstrap >/dev/null || { echo "minimal_root.sh: install debootstrap first" >&2; exit 2; }
source_root=$(git -C "$(dirname "${BASH_SOURCE[0]}")" rev-parse --show-toplevel)
if [ $# -ge 1 ]; then folder=$1; keep=1; else folder=$(mktemp -d); keep=0; fi

leave() { [ "$keep" = 1 ] || rm -rf --one-file-system "$folder" "$folder.debootstrap.log"; }
trap leave EXIT

mirror=${TUMBLE_DEBIAN_MIRROR:-http://deb.debian.org/debian}
echo "== minimal root in $folder"
debootstrap --variant=minbase --include=ca-certificates bookworm "$folder" "$mirror" >"$folder.debootstrap.log" 2>&1 ||
  { tail -n 20 "$folder.debootstrap.log" >&2; exit 1; }
# The host's way to the archive: sources, proxies, names.
ls /etc/apt/sources.list.d/* >/dev/null 2>&1 && rm -f "$folder/etc/apt/sources.list"
cp -r /etc/apt/sources.list /etc/apt/sources.list.d /etc/apt/apt.conf.d "$folder/etc/apt/" 2>/dev/null || true
for file in /etc/resolv.conf /etc/hosts; do [ -f "$file" ] && cp -L "$file" "$folder$file"; done
mkdir -p "$folder/usr/local/share/ca-certificates"
cp -r /usr/local/share/ca-certificates/. "$folder/usr/local/share/ca-certificates/" 2>/dev/null || true

# Runs a command with the folder as its root. A new mount namespace and pivot_root, not chroot: inside a chroot the kernel
# refuses the user namespaces that the grader's sandbox is made of.
inside() {
  unshare --mount --propagation private bash -euc '
    mount --bind "$1" "$1" && cd "$1"
    mount -t proc proc proc && mount --rbind /sys sys && mount --rbind /dev dev
    mkdir -p .host && pivot_root . .host && umount -l /.host && shift
    exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 bash -euc "$1"' inside "$folder" "$1"
}

git clone --quiet "$source_root" "$folder/srv/tumble"
echo "== inside: packages before: $(inside "dpkg-query -f '.\n' -W | wc -l")"
for command in demo test; do
  echo "== ./tumble $command"
  start=$SECONDS
  inside "cd /srv/tumble && ./tumble $command"
  echo "== ./tumble $command: passed in $((SECONDS - start)) s"
done
inside "cd /srv/tumble && tests/check_report.sh out/demo"
echo "== packages.txt is complete: both commands passed in a minimal Debian 12"
