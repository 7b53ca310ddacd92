#!/usr/bin/env bash
# apt install of the packages on a bare Debian 12, then what a student and a teaching assistant do first, measured. Needs root, the
# network, debootstrap and 2 GB; takes some minutes, so it is not part of `./tumble test`. Make the packages first: ./tumble package
#   tests/packages/try_packages.sh [PACKAGES [ROOT]]     PACKAGES: the folder with them (out/packages); ROOT: a bare root, used up
set -euo pipefail
tree=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
packages=$(cd "${1:-$tree/out/packages}" && pwd)
# shellcheck source=tests/packages/bare_root.sh
source "$tree/tests/packages/bare_root.sh"
if [ $# -ge 2 ]; then root=$2; else
  root=$(mktemp -d)
  trap 'rm -rf --one-file-system "$root"' EXIT
  bare_root "$root"
fi

# A new mount namespace and pivot_root, not chroot: inside a chroot the kernel refuses the namespaces that a sandbox is made of.
inside() {
  unshare --mount --propagation private bash -euc '
    mount --bind "$1" "$1" && cd "$1"
    mount -t proc proc proc && mount --rbind /sys sys && mount --rbind /dev dev
    mkdir -p .host && pivot_root . .host && umount -l /.host && shift
    exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive bash -euc "$1"' inside "$root" "$1"
}
# timed WORDS SCRIPT [CODE]: runs the script inside and says how long it took.
timed() {
  local began code=0
  began=$(date +%s%N)
  inside "$2" >"$root/said" 2>&1 || code=$?
  [ "$code" = "${3:-0}" ] || { tail -n 40 "$root/said"; echo "try_packages: $1 ended with $code, not ${3:-0}" >&2; exit 1; }
  printf '%-42s %6.1f s\n' "$1" "$(awk -v a="$began" -v b="$(date +%s%N)" 'BEGIN { print (b - a) * 1e-9 }')"
}

mkdir -p "$root/srv/packages" && cp "$packages"/*.deb "$root/srv/packages/"
timed "apt update" "apt-get update"
timed "apt install tumble-course" "apt-get install --yes --no-install-recommends /srv/packages/tumble-course_*.deb; useradd --create-home student"
as_student() { echo "cd /home/student && setpriv --reuid student --regid student --clear-groups env HOME=/home/student bash -euc '$1'"; }
timed "tumble start a1 a1" "$(as_student 'tumble start a1 a1')"
timed "first tumble check a1 (a stub)" "$(as_student 'cd a1 && tumble check a1')" 4
timed "second tumble check a1" "$(as_student 'cd a1 && tumble check a1')" 4
for id in $(cd "$tree/assignments" && ls -d a[0-9]*_*/ | sed 's/_.*//'); do [ "$id" = a1 ] || timed "start and check $id" "$(as_student "tumble start $id $id >/dev/null; cd $id && tumble check $id")" 4; done
timed "another file, in the sandbox" "$(as_student 'cp a1/a1_impulse.cpp other.cpp; cd a1; tumble check a1 ../other.cpp')" 4
timed "own tests, without their packages" "$(as_student 'cd a1; echo "TEST(Mine, Runs) {}" > mine.cpp; tumble check a1 --my-tests mine.cpp 2>&1 | tee /dev/stderr | grep -q "apt install libgtest-dev" && exit 2')" 2
timed "apt install what they need" "apt-get install --yes --no-install-recommends libgtest-dev libfmt-dev libssl-dev"
timed "own tests" "$(as_student 'cd a1; tumble check a1 --my-tests mine.cpp')"
timed "tumble inspect t_handle" "$(as_student 'tumble inspect t_handle')"
timed "tumble grade, which the course has not" "$(as_student 'mkdir -p s/ada; cp a1/a1_impulse.cpp s/ada; tumble grade a1 s')" 2

if ls "$packages"/tumble-grader_*.deb >/dev/null 2>&1; then
  timed "apt install tumble-grader" "apt-get install --yes --no-install-recommends /srv/packages/tumble-grader_*.deb"
  timed "a student reads nothing of it" "$(as_student 'ls /opt/tumble-grader; cat /opt/tumble-grader/tree.txt')" 2
  timed "the student's check goes on" "$(as_student 'cd a1 && tumble check a1')" 4
  timed "tumble grade a1, a right file and a stub" "mkdir -p /root/s/right /root/s/stub; cp /opt/tumble-grader/solutions_private/a1_impulse/a1_impulse.cpp /root/s/right
    cp /usr/share/tumble/assignments/a1_impulse/a1_impulse.cpp /root/s/stub; cd /root; tumble grade a1 s --no-media --out out; cat out/gradebook.csv; grep -q 100 out/gradebook.csv"
  timed "apt remove leaves nothing" "apt-get remove --yes tumble-course; test ! -e /usr/lib/tumble; test ! -e /opt/tumble-grader"
fi
echo "the packages work on a bare Debian 12"
