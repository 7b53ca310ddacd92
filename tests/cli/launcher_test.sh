#!/usr/bin/env bash
# ./tumble in a tree that was never built: what needs no build is answered at once, with the right exit code, and leaves
# nothing behind. A build shows how far it is: one line rewritten on a terminal, plain lines without one.
# Usage: launcher_test.sh ROOT
set -euo pipefail
root=$1
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree/framework/cli" "$tree/assignments"
cp "$root/tumble" "$tree/"
cp -r "$root/framework/cli/help" "$root/framework/cli/needs.txt" "$tree/framework/cli/"
for folder in "$root"/assignments/a*/; do mkdir -p "$tree/assignments/$(basename "$folder")"; done
ids=$(cd "$root/assignments" && echo a*/ | grep -o 'a[0-9]*_' | tr -d _ | sort -V | xargs)
fail() { echo "launcher_test: $*" >&2; exit 1; }

# said CODE WORDS...: runs the launcher, expects the exit code, keeps what it printed in $out and $err.
said() {
  local code=$1 got=0
  shift
  timeout 10 "$tree/tumble" "$@" >"$tree/out" 2>"$tree/err" || got=$?
  out=$(cat "$tree/out") err=$(cat "$tree/err")
  rm -f "$tree/out" "$tree/err"
  [ "$got" = "$code" ] || fail "'$*' exits with $got, not $code: $out $err"
  [ ! -e "$tree/build" ] || fail "'$*' began to build"
}
holds() { case $1 in *"$2"*) ;; *) fail "'$2' is missing in: $1" ;; esac; }

said 0 && holds "$out" "Verbs:"
said 0 --help && holds "$out" "check"
said 0 check --help && holds "$out" "TEST"
said 0 run pong_1 --help && holds "$out" "--modules"
said 0 help && holds "$out" "Verbs:"
said 0 help inspect && holds "$out" "--density"
said 2 help inspekt && holds "$err" "Did you mean 'inspect'?"
said 2 chek a1 && holds "$err" "Did you mean 'check'?"
said 2 simulate && holds "$err" "there is no such verb" && holds "$err" "Known: "
said 2 check && holds "$err" "which assignment?"
said 2 check a11 && holds "$err" "there is no such assignment" && holds "$err" "Did you mean 'a1'?"
said 2 watch a9
# In a starter tree, which has no solutions, an instructor's command says whose it is.
for verb in demo grade audit release; do said 2 $verb a1 && holds "$err" "instructor's command"; done

# Progress, on a build made of steps that sleep.
export TUMBLE_BUILD=$tree/steps
mkdir -p "$TUMBLE_BUILD/bin"
printf '#!/bin/sh\necho ran\n' >"$TUMBLE_BUILD/bin/tumble_inspect" && chmod +x "$TUMBLE_BUILD/bin/tumble_inspect"
: >"$tree/packages.txt" && cp "$tree/packages.txt" "$TUMBLE_BUILD/.packages"
steps() {
  { printf 'rule slow\n  command = sleep 0.5 && touch $out\n'
    for i in $(seq 40); do echo "build s$i: slow"; done
    printf 'build tumble_inspect: phony'; printf ' s%s' $(seq 40); printf '\n'; } >"$TUMBLE_BUILD/build.ninja"
  rm -f "$TUMBLE_BUILD"/s*
}
steps && "$tree/tumble" inspect box >"$tree/out" 2>"$tree/err"
holds "$(cat "$tree/out")" "ran"
holds "$(cat "$tree/err")" "building: "
holds "$(cat "$tree/err")" " of 40 steps"
LC_ALL=C grep -q '[[:cntrl:]]' "$tree/err" && fail "control characters without a terminal"
if command -v script >/dev/null; then
  steps && script -qec "'$tree/tumble' inspect box" /dev/null >"$tree/out" </dev/null
  holds "$(cat "$tree/out")" $'\r\033[Ktumble: building: '
  holds "$(cat "$tree/out")" "s left"
fi

# What is built for which words: a target says its name.
asked() { # VERB WORDS...: prints the targets that the launcher asked for, in their order
  { printf 'rule say\n  command = echo $out >>$$TUMBLE_BUILD/asked\n'
    for target in tumble tumble_check tumble_inspect tumble_pages sandbox_init submission_sdk $(for id in $ids; do echo check_${id}_first_ready check_${id}_ready check_${id}_sandboxed worker_$id judge_$id ${id}_reference; done); do echo "build $target: say"; done
  } >"$TUMBLE_BUILD/build.ninja"
  rm -f "$TUMBLE_BUILD"/asked "$TUMBLE_BUILD"/.ninja_*
  for program in tumble tumble_check tumble_inspect tumble_pages; do printf '#!/bin/sh\n' >"$TUMBLE_BUILD/bin/$program" && chmod +x "$TUMBLE_BUILD/bin/$program"; done
  "$tree/tumble" "$@" >/dev/null 2>"$tree/err" || fail "'$*' fails: $(cat "$tree/err")"
  asked=$(sort "$TUMBLE_BUILD/asked" | xargs)
}
asked check a2 && [ "$asked" = "check_a2_ready tumble_check" ] || fail "check a2 builds $asked"
asked check a2 'Rk4*' && [ "$asked" = "check_a2_ready tumble_check" ] || fail "check a2 of some tests builds $asked"
echo "a2 $tree/library.a" >"$TUMBLE_BUILD/first_checks.txt"
asked check a2 --all && [ "$asked" = "check_a2_first_ready check_a2_ready tumble_check tumble_check" ] || fail "check a2 before its library is there builds $asked"
asked check a2 'Rk4*' && [ "$asked" = "check_a2_ready tumble_check" ] || fail "check a2 of some tests, without the library, builds $asked"
asked check a1 && [ "$asked" = "check_a1_ready tumble_check" ] || fail "check a1, which needs no library, builds $asked"
: >"$tree/library.a"
asked check a2 && [ "$asked" = "check_a2_ready tumble_check" ] || fail "check a2 with its library builds $asked"
asked watch a1 my/file.cpp && [ "$asked" = "check_a1_ready check_a1_sandboxed tumble_check" ] || fail "watch of a file builds $asked"
asked inspect box && [ "$asked" = "tumble_inspect" ] || fail "inspect builds $asked"
asked handouts && [ "$asked" = "tumble_pages" ] || fail "handouts, without solutions, builds $asked"
asked run pong_1 && [ "$asked" = "sandbox_init submission_sdk tumble $(for id in $ids; do echo worker_$id; done | sort | xargs)" ] || fail "run builds $asked"
mkdir -p "$tree/solutions_private/a1_impulse" "$tree/solutions_private/a2_integration"
asked audit a2 && [ "$asked" = "a1_reference a2_reference judge_a2 sandbox_init submission_sdk tumble worker_a1 worker_a2" ] || fail "audit a2 builds $asked"
echo "the launcher answers without building, and builds with a word"
