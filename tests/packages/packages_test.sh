#!/usr/bin/env bash
# The two Debian packages, made from the existing build and unpacked in a temporary folder: what they contain, that the one for
# students holds nothing private, and that start and check work from it.
# Usage: packages_test.sh ROOT BUILD
set -euo pipefail
root=$1 build=$2
fail() { echo "packages_test: $*" >&2; exit 1; }
for tool in dpkg-deb dpkg-shlibdeps cpack file; do command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed"; exit 77; }; done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export TUMBLE_ROOT=$root
"$build/bin/tumble" package --out "$folder/made" || fail "tumble package failed"   # it proves that nothing private is in it
course=$(echo "$folder"/made/tumble-course_*.deb) grader=$(echo "$folder"/made/tumble-grader_*.deb)
unset TUMBLE_ROOT

version=$(dpkg-deb -f "$course" Version)
grep -qF "tumble-course (= $version)" <<<"$(dpkg-deb -f "$grader" Depends)" || fail "the grader does not depend on its own course"
for package in 'g++' libeigen3-dev; do grep -qF "$package" <<<"$(dpkg-deb -f "$course" Depends)" || fail "the course does not depend on $package"; done
# Into files: grep -q leaves early, and under pipefail a writer that meets a closed pipe makes a right listing wrong.
dpkg-deb -c "$grader" >"$folder/grader" && dpkg-deb -c "$course" >"$folder/course"
awk '{ print $6 }' "$folder/grader" | grep -vE '^\./(opt/(tumble-grader/.*)?)?$' && fail "the grader has files outside /opt/tumble-grader"
grep -qE '^drwxr-x--- .* \./opt/tumble-grader/$' "$folder/grader" || fail "/opt/tumble-grader is open to everybody"
awk '{ print $6 }' "$folder/course" | grep -E 'solutions_private|/judge_a|_reference|mutants|hidden|\.slip$' && fail "the course has a private file"

mkdir "$folder/root" && dpkg-deb -x "$course" "$folder/root"
# The course depends on every library that the grader needs, so that the grader has to name none itself.
needed() { find "$1" -type f \( -perm -100 -o -name '*.so' \) -exec readelf -d {} + 2>/dev/null | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | sort -u; }
mkdir "$folder/grader_root" && dpkg-deb -x "$grader" "$folder/grader_root"
needed "$folder/root/usr/lib/tumble" >"$folder/course_needs"
needed "$folder/grader_root/opt/tumble-grader" >"$folder/grader_needs"
[ -s "$folder/grader_needs" ] || fail "the grader's programs need no library at all?"
more=$(comm -13 "$folder/course_needs" "$folder/grader_needs")
[ -z "$more" ] || fail "the grader needs libraries that the course does not depend on: $more"
rm -rf "$folder/grader_root"
tumble=$folder/root/usr/bin/tumble
# No symbol of the fast scheduler, which is a solution.
nm -C "$folder/root/usr/lib/tumble/bin/tumble" | grep -F 'tumble::a4::Coordinator' >"$folder/symbols" || true
[ ! -s "$folder/symbols" ] || fail "the course's program holds the private scheduler: $(head -n 2 "$folder/symbols")"
# As after postinst, from the build.
for file in precompiled.h.gch libkernels.a; do
  ln "$build/submission_sdk/$file" "$folder/root/usr/lib/tumble/submission_sdk/" 2>/dev/null ||
    cp "$build/submission_sdk/$file" "$folder/root/usr/lib/tumble/submission_sdk/"
done

cd "$folder"
"$tumble" start a1 work >"$folder/said" || fail "start: $(cat "$folder/said")"
for file in a1_impulse.cpp a1_impulse.h a1_impulse.md README.md tests/response_test.cpp; do [ -s "work/$file" ] || fail "start makes no $file"; done
code=0; "$tumble" start a1 work 2>"$folder/said" || code=$?
[ $code = 2 ] && grep -q 'is there already' "$folder/said" || fail "start replaces a student's file"
cd work
code=0; "$tumble" check a1 >"$folder/said" 2>&1 || code=$?
[ $code = 4 ] || { cat "$folder/said"; fail "check of the stub ends with $code, not 4"; }
cp "$root/solutions_private/a1_impulse/a1_impulse.cpp" .
began=$(date +%s%N)
code=0; "$tumble" check a1 >"$folder/said" 2>&1 || code=$?
[ $code = 0 ] || { cat "$folder/said"; fail "check of a right file ends with $code, not 0"; }
echo "check a1 took $((($(date +%s%N) - began) / 1000000)) ms"
# Tests of one's own, from the handout's example: they pass on the right file, which does not say that they catch anything.
sed -n '/^#include "tests\/a1_impulse/,/^```$/p' "$root/handouts/a1_impulse.md" | sed '/^```/,$d' >mine.cpp
[ -s mine.cpp ] || fail "the handout of a1 has no example of own tests"
code=0; "$tumble" check a1 --my-tests mine.cpp >"$folder/said" 2>&1 || code=$?
[ $code = 0 ] || { cat "$folder/said"; fail "own tests of an installed course end with $code, not 0"; }
grep -qE '/own_tests_a1$' "$folder/grader" || fail "the grader cannot judge own tests"
echo 'int broken(' >>a1_impulse.cpp
code=0; "$tumble" check a1 >"$folder/said" 2>&1 || code=$?
[ $code = 1 ] && grep -q 'does not compile' "$folder/said" || { cat "$folder/said"; fail "a file that does not compile ends with $code"; }
cd .. && code=0; "$tumble" check a1 >"$folder/said" 2>&1 || code=$?
[ $code = 2 ] && grep -q 'tumble start a1' "$folder/said" || fail "check without a file does not say how to begin"

# The words of the verbs, in the manual and in the shell.
zcat "$folder/root/usr/share/man/man1/tumble.1.gz" >"$folder/tumble.1"
for verb in start check run grade; do grep -q "^.SS tumble $verb" "$folder/tumble.1" || fail "the manual has no $verb"; done
share=$folder/root/usr/share
mkdir "$folder/words"
cp "$share/bash-completion/completions/tumble" "$folder/words/tumble.bash"
cp "$share/zsh/vendor-completions/_tumble" "$share/fish/vendor_completions.d/tumble.fish" "$folder/words/"
"$(dirname "$0")/completions_test.sh" "$folder/words" "$share/tumble" || fail "the shells do not complete"
echo "packages are whole, private parts are private, start and check work from them"
