#!/usr/bin/env bash
# What tumble export makes, run with the built tree in a plain folder laid out as each platform lays it out: a right, a wrong, a crashing
# and a hostile submission, an empty one and one that does not compile; what they write is held against the rules of each format, and
# searched for names of hidden tests. tests/containers/platforms.sh does the same in containers, with the packages.
# Usage: autograders_test.sh ROOT BUILD
set -euo pipefail
root=$1 build=$2
fail() { echo "autograders_test: $*" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export TUMBLE_ROOT=$root TUMBLE=$build/bin/tumble
# The packages are stood in for: their bytes are not looked at here.
mkdir "$folder/packages"
for name in course grader; do echo "stands for a package" >"$folder/packages/tumble-${name}_0.1.0+1.gabc_amd64.deb"; done
for platform in gradescope artemis github-classroom autolab; do
  "$TUMBLE" export $platform a1 "$folder/$platform.zip" --packages "$folder/packages" >/dev/null || fail "export $platform"
  "$TUMBLE" export $platform a1 "$folder/again.zip" --packages "$folder/packages" >/dev/null
  cmp -s "$folder/$platform.zip" "$folder/again.zip" || fail "two exports to $platform differ"
done
# shellcheck source=tests/platforms/run_platform.sh
source "$root/tests/platforms/run_platform.sh"
make_submissions "$root" "$folder/submissions"
hidden_names "$root" >"$folder/hidden"
for platform in gradescope artemis github-classroom autolab; do
  mkdir -p "$folder/$platform"
  unpacked "$folder/$platform.zip" "$folder/$platform/source"
  # One format has them all; how a submission ends is the same everywhere.
  kinds='wrong hostile'
  [ -z "${TUMBLE_TEST_WHOLE:-}" ] || kinds+=' right empty'
  [ $platform != gradescope ] || kinds='right wrong hostile empty crashing broken zipped'
  for kind in $kinds; do
    run_platform $platform "$folder/$platform/source" "$folder/submissions/$kind" "$folder/$platform/$kind" ||
      { cat "$folder/$platform/$kind/stderr"; fail "$platform, $kind: ended with an error"; }
    expect_result "$build/bin/validate_platform" $platform "$folder/$platform/$kind" $kind "$folder/hidden"
  done
done
# A fault of the grader leaves no result.
code=0
TUMBLE_SANDBOX=none run_platform gradescope "$folder/gradescope/source" "$folder/submissions/right" "$folder/fault" || code=$?
[ $code != 0 ] && [ ! -e "$folder/fault/results/results.json" ] || fail "without a sandbox there is a result"
echo "what every platform takes runs, and writes what that platform reads"
