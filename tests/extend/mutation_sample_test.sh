#!/usr/bin/env bash
# A few mutations of each reference, drawn by lot: each is caught by a test, or equal_mutations.json says why it makes no difference.
# All of them, in hours: for id in a1 ... : tumble new mutations ID FOLDER && tumble audit ID --mutants FOLDER
# Usage: mutation_sample_test.sh ROOT TUMBLE [COUNT [SEED]]   COUNT mutations of each assignment, default 1, in a whole run 5
set -euo pipefail
root=$1 tumble=$2 count=${3:-$([ -n "${TUMBLE_TEST_WHOLE:-}" ] && echo 5 || echo 1)} seed=${4:-7}
export TUMBLE_ROOT=$root
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0
for solution in "$root"/solutions_private/a[0-9]*_*/; do
  id=$(basename "$solution" | sed 's/_.*//')
  "$tumble" new mutations "$id" "$folder/$id" >"$folder/said" 2>&1 || { cat "$folder/said"; exit 1; }
  # The first column of an audit: the names of the files.
  names=$(cd "$folder/$id" && ls -- *.slip | sed 's/\.slip$//' | shuf -n "$count" --random-source=<(yes "$seed $id") | paste -sd,)
  echo "$id: $names"
  "$tumble" audit "$id" --mutants "$folder/$id" --only "$names" >"$folder/said" 2>&1 || { cat "$folder/said"; failed=1; }
  grep -E '^[0-9]+ of [0-9]+ known-wrong|SURVIVES|makes no difference|do not compile' "$folder/said" || true
done
[ $failed = 0 ] || { echo "mutation_sample_test: a mutation survives: write a test that catches it, or the reason in solutions_private/aN_name/equal_mutations.json" >&2; exit 1; }
