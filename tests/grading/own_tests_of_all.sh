#!/bin/bash
# Good tests of a student's own earn all their points in every assignment: hands in each reference with
# such a file, and looks at the score. A minute or two an assignment; not part of ctest.
#   tests/grading/own_tests_of_all.sh BUILD [aN...]
# The file is solutions_private/aN_name/own_tests/aN_name_tests.cpp, or, where there is none, the public
# tests that need neither a scene nor a file, in one. After a change of slips, right solutions or fixtures.
set -euo pipefail
build=$(realpath "$1")
shift
export TUMBLE_ROOT=${TUMBLE_ROOT:-$(realpath "$(dirname "$0")/../..")}
cd "$TUMBLE_ROOT"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0
for solution in solutions_private/a[0-9]*_*/; do
  name=$(basename "$solution") id=${name%%_*}
  if (($# > 0)) && [[ " $* " != *" $id "* ]]; then continue; fi
  mkdir -p "$folder/$id/good"
  cp "$solution$name.cpp" "$folder/$id/good"
  if [ -e "${solution}own_tests/${name}_tests.cpp" ]; then
    cp "${solution}own_tests/${name}_tests.cpp" "$folder/$id/good"
  else
    for tests in "tests/$name"/*_test.cpp; do
      grep -Eq "scene_fixtures.h|find_trees" "$tests" || cat "$tests" >>"$folder/$id/good/${name}_tests.cpp"
    done
  fi
  said=$("$build/bin/tumble" grade "$id" "$folder/$id" --out "$folder/out_$id" --no-media) || true
  if grep -q '^good  *105 of 100' <<<"$said"; then
    echo "$id: 105 of 100"
  else
    failed=1
    printf '%s\n' "$id: not all points" "$said"
    grep -o '[0-9]* tests: [^"\\]*\|does not compile: [^"]*' "$folder/out_$id/good/results.json" || true
  fi
done
exit "$failed"
