#!/bin/bash
# Takes effects out, one after the other: in a copy of the tree without the folder framework/effects/NAME (and its line, if it has one), the program is built, and the tests
# that do not know the effect are built and run. Hours for all; not part of ctest.
#   usage: tests/bench/effects_apart.sh [NAME...]       default: every effect.  PROGRAMS="test_scene test_links": which test programs; KEEP=1: copies stay
# What knows an effect: a source that includes one of its headers, also through a test's own header, that has its key in a scene's words, or that names a scene
# which cannot be read without it. Such a test source is emptied in the copy; of the stability battery such a theme has no cases.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
cd "$root"
list=framework/effects/CMakeLists.txt
programs=${PROGRAMS:-test_house test_scene test_dynamics test_water test_engines test_links test_persistent_contacts test_processes test_start test_impacts test_run_watch test_judge test_render test_player test_cost test_timewarp}
effects=("$@")
[ ${#effects[@]} -gt 0 ] || mapfile -t effects < <(sed -n 's/^add_subdirectory(\(.*\))$/\1/p' "$list")
for effect in "${effects[@]}"; do [ -d "framework/effects/$effect" ] || { echo "effects_apart.sh: no effect '$effect'" >&2; exit 2; }; done

# The folders that cannot do without one of those named: their sources include its headers.
standing_on() {
  local all=" $* " changed=1 folder name
  while [ $changed = 1 ]; do
    changed=0
    for folder in framework/effects/*/; do
      name=$(basename "$folder")
      [[ $all == *" $name "* ]] && continue
      for taken in $all; do
        if grep -rqsF "\"framework/effects/$taken/" "$folder"; then all="$all$name "; changed=1; break; fi
      done
    done
  done
  echo "$all"
}

# Sources of tests that know one of the effects or scenes, by words to look for, one a line.
knowing() {
  local words=$1 copy=$2 before=-1 known
  while :; do
    known=$(cd "$copy" && grep -rlF -f "$words" tests solutions_private --include=*.cpp --include=*.h 2>/dev/null | grep -vE '^(tests/bench|solutions_private/.*/(mutants|alternatives)/)' | sort -u)
    for header in $(grep '\.h$' <<< "$known"); do grep -qxF "\"$header\"" "$words" || echo "\"$header\"" >> "$words"; done
    [ "$(wc -l <<< "$known")" = "$before" ] && break
    before=$(wc -l <<< "$known")
  done
  grep '\.cpp$' <<< "$known" || true
}

# A theme of the battery keeps its name and has no cases; another source is empty.
empty_source() {
  local file=$1
  if [[ $file == tests/stability/* ]] && themes=$(grep -oE '^void add_[a-z_]+\(std::vector<Case>&' "$file"); then
    { echo '#include "tests/stability/cases.h"'; echo "namespace tumble::testing {"; sed 's/$/) {}/' <<< "$themes"; echo "}"; } > "$file.new"
    sed -i "s/namespace tumble::testing {/$(grep -m1 -oE '^namespace tumble[a-z_:]* \{' "$file")/" "$file.new"
    mv "$file.new" "$file"
  elif [[ $file != tests/stability/* && $file != tests/fuzz/* && $file != tests/support/* ]]; then
    : > "$file"
  fi
}

failed=0
for effect in "${effects[@]}"; do
  copy=$(mktemp -d "${TMPDIR:-/tmp}/without_$effect.XXXX")
  git ls-files -z | xargs -0 cp --parents -t "$copy"
  taken=$(standing_on "$effect")
  words=$copy/known.txt
  for one in $taken; do
    echo "\"framework/effects/$one/" >> "$words"
    sed -n '/"properties"/{n;s/^ *\("[a-z0-9_]*"\):.*/\1/p}' "framework/effects/$one/schema.json" | head -1 >> "$words"
    rm -r "$copy/framework/effects/$one"
    sed -i "/^add_subdirectory($one)$/d" "$copy/$list"
  done
  for file in $(knowing "$words" "$copy"); do (cd "$copy" && empty_source "$file"); done
  export CCACHE_BASEDIR=$copy CCACHE_NOHASHDIR=1
  verdict=right
  if ! (cd "$copy" && cmake -S . -B build -G Ninja > known.log 2>&1 && ninja -C build tumble >> known.log 2>&1); then
    verdict="does not build: $copy/known.log"
  else
    # Scenes that cannot be read without it, and the tests that name them, go too.
    : > "$words"
    for scene in "$copy"/assignments/*/scenes/*.json; do
      (cd "$copy" && build/bin/tumble explain "$scene" > /dev/null 2>&1) || { echo "\"$(basename "$scene" .json)\"" >> "$words"; rm "$scene"; }
    done
    scenes=$(wc -l < "$words")
    if [ -s "$words" ]; then for file in $(knowing "$words" "$copy"); do (cd "$copy" && empty_source "$file"); done; fi
    for program in $programs; do
      if ! (cd "$copy" && ninja -C build "$program" >> known.log 2>&1); then verdict="$program does not build: $copy/known.log"; break; fi
      if ! (cd "$copy" && build/bin/$program --gtest_brief=1 > "$program.log" 2>&1); then verdict="$program fails: $copy/$program.log"; break; fi
    done
  fi
  printf 'without %-40s %s\n' "$(echo $taken)${scenes:+, $scenes scenes}" "$verdict"
  if [ "$verdict" = right ]; then [ -n "${KEEP:-}" ] || rm -rf "$copy"; else failed=1; fi
done
exit $failed
