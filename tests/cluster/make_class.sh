#!/bin/bash
# A class of a1 whose files all differ: of four, two right, one stub, one that does not compile.
#   tests/cluster/make_class.sh ROOT FOLDER COUNT
set -euo pipefail
root=$1 folder=$2 count=$3
for i in $(seq "$count"); do
  name=$(printf 'student_%06d' "$i")
  mkdir -p "$folder/$name"
  case $((i % 4)) in
    0) file=$root/assignments/a1_impulse/a1_impulse.cpp ;;
    1 | 2) file=$root/solutions_private/a1_impulse/a1_impulse.cpp ;;
    3) file=/dev/null ;;
  esac
  { cat "$file"; [ $((i % 4)) != 3 ] || echo 'int x = ;'; echo "// $name"; } >"$folder/$name/a1_impulse.cpp"
done
