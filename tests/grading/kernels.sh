#!/usr/bin/env bash
# kernels.cpp with what is compiled once for all submissions, and with Eigen's own: the same numbers to the bit.
#   kernels.sh SUBMISSION_SDK EIGEN_INCLUDE FLAGS
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
sdk=$1 work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
compile=(g++ $3 -Wall -Wextra -Werror -isystem "$2")
"${compile[@]}" -include "$sdk/precompiled.h" kernels.cpp "$sdk/libkernels.a" -o "$work/once"
"${compile[@]}" -DTUMBLE_NO_KERNELS kernels.cpp -o "$work/own"
"$work/once" > "$work/once.txt"
"$work/own" > "$work/own.txt"
lines=$(wc -l < "$work/own.txt")
[ "$lines" -gt 400 ] || { echo "only $lines lines were printed"; exit 1; }
if ! cmp -s "$work/once.txt" "$work/own.txt"; then
  echo "what is compiled once differs from Eigen's own:"
  diff "$work/own.txt" "$work/once.txt" | cut -c1-160 | head -20
  exit 1
fi
echo "$lines results, the same to the bit"
