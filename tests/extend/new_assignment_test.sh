#!/usr/bin/env bash
# What an instructor does first, in a copy of this tree: a new assignment, an effect, one that asks a function of the assignment, a scene,
# a slip and a test are made, the copy is configured, and the new check program is built and run. Every stub is "not attempted", and no list of ids had to be changed for that.
# Usage: new_assignment_test.sh ROOT TUMBLE_NEW CHECK_POINTS
set -euo pipefail
root=$1 new=$2 check_points=$3
fail() { echo "new_assignment_test: $*" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
copy=$folder/tree
mkdir "$copy"
tar -C "$root" --exclude=./build --exclude='./build-*' --exclude=./out --exclude=./.git -cf - . | tar -C "$copy" -xf -

cat >"$folder/functions.h" <<'END'
#include "framework/dynamics/body.h"

// What came of a trial.
struct Trial {
  int count;
  double mean;
};

// The mean of two numbers.
// eq: m = (a + b) / 2
double mean_of(double a, double b);

// Momentum of a body.
// eq: p = m v
Vector3d momentum_of(const Body& body);

// Lift of a plate.
// eq: L = c A v
Vector3d lift_of_plate(const Vector3d& velocity_world, double area);

// Counts trials.
Trial count_trials(const std::function<double(double)>& f, const std::vector<double>& at);
END
export TUMBLE_ROOT=$copy
"$new" new assignment a99 trial --functions "$folder/functions.h" >"$folder/said" || fail "new assignment: $(cat "$folder/said")"
"$new" new test a99 MeanOf.IsSymmetric >"$folder/said" || fail "new test: $(cat "$folder/said")"
"$new" new slip a99 half_forgotten --function momentum_of >"$folder/said" || fail "new slip: $(cat "$folder/said")"
"$new" new scene a99 trial_at_rest >"$folder/said" || fail "new scene: $(cat "$folder/said")"
"$new" new effect low_wind >"$folder/said" || fail "new effect: $(cat "$folder/said")"
"$new" new effect low_lift --function a99.lift_of_plate >"$folder/said" || fail "new effect that asks: $(cat "$folder/said")"
"$check_points" "$copy" a99_trial || fail "the points of a new assignment do not fit"

cmake -S "$copy" -B "$folder/build" -G Ninja >"$folder/configure.log" 2>&1 || fail "does not configure: $(tail -n 20 "$folder/configure.log")"
grep -q '"a99", "a99_trial", "Trial"' "$folder/build/generated/assignment_names.cpp" || fail "the assignment is in no list of names"
grep -q 'a99::register_module' "$folder/build/generated/register_assignments.cpp" || fail "the assignment is not registered"
for effect in low_wind low_lift; do
  grep -q "${effect}_effect" "$folder/build/generated/effects/all_effects.cpp" || fail "the effect $effect is in no list of effects"
done
# The law of the effect that asks: its effect, its test, and the assignment that sets it are right C++. (The engines would take minutes.)
read -r -a libraries <<<"$(grep -o -m 1 -e '-isystem [^ ]*eigen3' "$folder/build/build.ninja")"
for file in framework/effects/low_lift/low_lift_effect.cpp tests/effects/low_lift_test.cpp assignments/a99_trial/a99_binding.cpp; do
  g++ -std=c++20 -Wall -Wextra -fsyntax-only -I"$copy" "${libraries[@]}" "$copy/$file" >"$folder/said" 2>&1 || fail "$file is not right: $(tail -n 20 "$folder/said")"
done
# No old file is changed: the binding that sets the law is the new assignment's.
changed=$(cd "$root" && find . -path ./build -prune -o -path './build-*' -prune -o -path ./out -prune -o -path ./.git -prune -o -type f -print0 |
  while IFS= read -r -d '' file; do cmp -s "$file" "$copy/$file" || echo "$file"; done)
[ -z "$changed" ] || fail "old files were changed: $changed"
for target in check_a99 judge_a99 worker_a99 a99_reference check_a99_reference check_a99_loaded check_a99_sandboxed; do
  ninja -C "$folder/build" -t query $target >/dev/null || fail "there is no target $target"
done

ninja -C "$folder/build" -j 2 check_a99 >"$folder/build.log" 2>&1 || fail "does not build: $(tail -n 40 "$folder/build.log")"
code=0
"$folder/build/bin/check_a99" >"$folder/said" 2>&1 || code=$?
[ $code = 4 ] || fail "check_a99 exits with $code, not 4 for \"not attempted\": $(cat "$folder/said")"
[ "$(grep -c 'not attempted' "$folder/said")" -ge 5 ] || fail "not every stub is \"not attempted\": $(cat "$folder/said")"
! grep -Eq '^ *(wrong|crashed|right|fault)' "$folder/said" || fail "a stub is more than not attempted: $(cat "$folder/said")"
# Taken out in part it says what is left to be removed, before anything else goes wrong; taken out as framework/EXTEND.md says, it is gone.
rm -r "$copy/assignments/a99_trial" "$copy/framework/effects/low_lift" "$copy/tests/effects/low_lift_test.cpp"
! cmake "$folder/build" >"$folder/said" 2>&1 || fail "half an assignment configures"
grep -q 'solutions_private/a99_trial is there, and assignments/a99_trial is not' "$folder/said" || fail "half an assignment is not named: $(tail -n 20 "$folder/said")"
rm -r "$copy/solutions_private/a99_trial" "$copy/tests/a99_trial" "$copy/handouts/a99_trial.md"
cmake "$folder/build" >"$folder/said" 2>&1 || fail "without the assignment it does not configure: $(tail -n 20 "$folder/said")"
! grep -q a99 "$folder/build/generated/assignment_names.cpp" || fail "the assignment is still in a list of names"
echo "a new assignment is found, builds, and every stub of it is \"not attempted\""
