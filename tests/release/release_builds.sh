#!/usr/bin/env bash
# Usage: release_builds.sh TUMBLE FOLDER
# Releases the tree into FOLDER, then does there what a student does first: build, all tests, one check an assignment.
set -euo pipefail
tumble=$1 folder=$2
rm -rf "$folder" "$folder.partial"
"$tumble" release "$folder"
cd "$folder"
unset TUMBLE_ROOT TUMBLE_BUILD
./tumble test

for assignment in a1 a2 a3 a4; do
  set +e
  verdicts=$(./tumble check "$assignment")
  code=$?
  set -e
  printf '%s\n' "$verdicts" | tail -n 3
  # Exit code 4: nothing is wrong, something is not attempted.
  if [ $code != 4 ] || grep -Eqi '\b(crashed|wrong|fault)\b.*[1-9]' <<<"$(tail -n 1 <<<"$verdicts")"; then
    printf '%s\n' "$verdicts"
    echo "an untouched stub of $assignment must be \"not attempted\" throughout (exit code $code, expected 4)"
    exit 1
  fi
done
rm -rf "$folder"
echo "the released tree builds, passes its tests, and every stub is not attempted"
