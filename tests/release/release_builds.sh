#!/usr/bin/env bash
# Usage: release_builds.sh TUMBLE FOLDER
# Releases the tree into FOLDER, then does there what a student does first: build, one check an assignment, commands of the
# README, and all tests, in a tree in which somebody has worked.
set -euo pipefail
tumble=$1 folder=$2
rm -rf "$folder" "$folder.partial"
"$tumble" release "$folder" --no-build
cd "$folder"

# Objects that the main build has made of the same files by the same commands are not made a second time (shared_object.sh).
export TUMBLE_MAIN=$TUMBLE_ROOT TUMBLE_MAIN_BUILD TUMBLE_RELEASED=$folder TUMBLE_SHARED=$folder/build/shared
TUMBLE_MAIN_BUILD=$(dirname "$(dirname "$tumble")")
unset TUMBLE_ROOT TUMBLE_BUILD
mkdir -p "$TUMBLE_SHARED"
ninja -C "$TUMBLE_MAIN_BUILD" -t commands all | grep -F ' -o ' >"$TUMBLE_SHARED/commands"
ninja -C "$TUMBLE_MAIN_BUILD" -t deps >"$TUMBLE_SHARED/deps"
ninja -C "$TUMBLE_MAIN_BUILD" -n all >"$TUMBLE_SHARED/outdated"
find assignments framework models tests handouts -type f | while read -r file; do ! cmp -s "$file" "$TUMBLE_MAIN/$file" || echo "$file"; done >"$TUMBLE_SHARED/same"
cmake -S . -B build -G Ninja -DTUMBLE_CCACHE=OFF -DCMAKE_CXX_COMPILER_LAUNCHER="$TUMBLE_MAIN/tests/release/shared_object.sh" >build/configure.log
fail() { echo "release_builds: $*" >&2; exit 1; }

# expect CODES WORDS...: runs a command that may end with one of these codes; keeps what it said in $said.
expect() {
  local codes=$1 code=0
  shift
  said=$(timeout 900 ./tumble "$@" 2>&1) || code=$?
  case ,$codes, in *,$code,*) ;; *) printf '%s\n' "$said"; fail "'$*' exits with $code, not $codes" ;; esac
  case $said in *"our bug"* | *"=reference"* | *"modules reference"*) printf '%s\n' "$said"; fail "'$*' speaks of what a student does not have" ;; esac
}
says() { case $said in *"$1"*) ;; *) printf '%s\n' "$said"; fail "'$1' is missing above" ;; esac; }

# An untouched stub is "not attempted" throughout.
for folder in assignments/a[0-9]*_*/; do
  assignment=$(basename "$folder") assignment=${assignment%%_*}
  expect 4 check "$assignment"
  printf '%s\n' "$said" | tail -n 3
  ! grep -Eqi '\b(crashed|wrong|fault)\b.*[1-9]' <<<"$(tail -n 1 <<<"$said")" || fail "a stub of $assignment is more than not attempted"
done

# Commands of the README, with nothing written yet: an answer or "not attempted", nothing else.
expect 2 demo && says "instructor's command"
expect 4 run poked_box --sheet out/box.png
expect 4 poke poked_box --pixel 200,250 --force 0,40,0 --duration-s 0.2
expect 0 inspect models/t_handle.3ds
expect 0 explain bouncing_ball
expect 4 run billiards --engine tw --modules student --duration-s 0.2
expect 0,1,4 battery --only chain
expect 4 truths tests/truths

# A student at work: a crash, a loop and a half-written file are named, not met.
stub=assignments/a1_impulse/a1_impulse.cpp
cp "$stub" stub.cpp
first=$(grep -n 'throw NotImplemented("relative_normal_velocity"' stub.cpp | cut -d: -f1)
sed "${first}i\\  for (volatile int i = 0;; i = i + 1) {}" stub.cpp >"$stub"
expect 1 run ball_against_wall --modules a1=student,a2=library && says "out of time" && says "relative_normal_velocity"
sed "${first}i\\  *static_cast<volatile int*>(nullptr) = 1;" stub.cpp >"$stub"
expect 1 run ball_against_wall --modules a1=student,a2=library && says "SIGSEGV" && says "relative_normal_velocity"
{ cat stub.cpp; printf 'static int endless() { for (volatile int i = 0;; i = i + 1) {} }\nint at_load = endless();\n'; } >"$stub"
expect 1 check a1 && says "does not start within"
{ cat stub.cpp; printf 'double f(double a) { if (a > 0) return 1; }\n'; } >"$stub"
expect 4 check a1 && says "control reaches end of non-void function"
expect 4 check a1 && says "control reaches end of non-void function"   # until it is mended
echo 'int half = ;' >>"$stub"
expect 1 check a1 && says "does not compile" && says "a1_impulse.cpp:"
expect 2 run ball_against_wall && says "does not compile"

# The framework's own tests do not ask the student's file. Most are made of the main build's objects, and are run there: twice in a whole
# run alone; by default those that read the tree.
if [ -n "${TUMBLE_TEST_WHOLE:-}" ]; then ./tumble test --whole; else ./tumble test -R '^(house|words|launcher|check_run|needs_file|help_files|scene|core|handouts|rubrics)$'; fi
cp stub.cpp "$stub" && rm stub.cpp
printf '%s\n' "objects of the main build: $(grep -c ^shared "$TUMBLE_SHARED/log"), compiled anew: $(grep -c ^compiled "$TUMBLE_SHARED/log")"
cd / && rm -rf "$folder"
echo "the released tree builds, passes its tests whatever the student's file is, and every stub is not attempted"
