#!/usr/bin/env bash
# ./tumble answers --help from framework/cli/help/, before anything is built. Those files are what the program itself says.
# Usage: help_files.sh TUMBLE FOLDER [--write]     --write makes them; otherwise a difference is an error
set -euo pipefail
tumble=$1 folder=$2 write=${3:-}
export TUMBLE_ROOT=$folder   # nothing in help may depend on the tree
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
"$tumble" --help >"$made/tumble.txt"
for verb in $(sed -n '/^Verbs:/,$p' "$made/tumble.txt" | awk '/^  [a-z]/ { print $1 }'); do
  "$tumble" "$verb" --help >"$made/$verb.txt"
done
if [ "$write" = --write ]; then
  rm -f "$folder"/*.txt && mkdir -p "$folder" && cp "$made"/*.txt "$folder/"
elif ! diff -r "$folder" "$made"; then
  echo "framework/cli/help is not what the program says. Make it anew: tests/cli/help_files.sh build/bin/tumble framework/cli/help --write" >&2
  exit 1
fi
