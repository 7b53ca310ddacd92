#!/bin/bash
# What an effect costs that a scene does not ask for: instructions of a run, as the engines are and built without the effect.
# Fails where the ratio is above 1.01.
#   usage: tests/bench/absent_effects.sh [BUILD_DIR [EFFECT...]]      a configured one; default: every effect. Needs valgrind (apt-get install valgrind; a bench only, not in packages.txt)
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${1:-build}
shift $(($# > 0 ? 1 : 0))
limit=1.01
command -v valgrind > /dev/null || { echo "absent_effects.sh: valgrind is missing: apt-get install valgrind" >&2; exit 2; }
effects=("$@")
targets=(bench_all_effects "${effects[@]/#/bench_without_}")
if [ ${#effects[@]} = 0 ]; then
  mapfile -t effects < <(ninja -C "$build" -t targets all | sed -n 's/^bench_without_\([a-z_]*\): phony$/\1/p')
  targets=(bench_absent_effects)
fi
ninja -C "$build" "${targets[@]}" > /dev/null || { echo "absent_effects.sh: ninja -C $build ${targets[*]} failed" >&2; exit 2; }

# Only the run is counted, not reading modules and writing words.
instructions() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null --collect-atstart=no --toggle-collect='tumble::engines::run_scene*' "$@" 2>&1 > /dev/null |
    awk '/Collected/ { print $NF }'
}

failed=0
printf '%-12s %16s %16s %10s   %s\n' effect 'instructions' 'built without' ratio 'calls where asked for: as it is, without'
for effect in "${effects[@]}"; do
  with=$(instructions "$build/bin/bench_all_effects" cost $effect)
  without=$(instructions "$build/bin/bench_without_$effect" cost $effect)
  # Left out it must be: asked for it, the one calls it and the other does not.
  calls=$("$build/bin/bench_all_effects" calls $effect)
  none=$("$build/bin/bench_without_$effect" calls $effect)
  ratio=$(awk "BEGIN { printf \"%.5f\", $with / $without }")
  verdict=right
  if awk "BEGIN { exit !($ratio > $limit) }" || [ "$calls" = 0 ] || [ "$none" != 0 ]; then verdict=WRONG; failed=1; fi
  printf '%-12s %16d %16d %10s   %s, %s   %s\n' $effect "$with" "$without" "$ratio" "$calls" "$none" $verdict
done
[ $failed = 0 ] && echo "an effect that is not asked for costs at most 1 % more instructions than one that is not there" || echo "an effect costs more than 1 %, or was not left out" >&2
exit $failed
