#!/bin/bash
# A class overnight: grades N submissions of a1, made from its slips, and says how many a minute, how
# much memory, and what kills do.
#   tests/bench/class_overnight.sh BUILD N JOBS KILLS [FOLDER]
# With KILLS > 0 the grading is ended by SIGKILL that many times, at random moments, and started
# again; then it is compared, byte for byte, with a grading that was not killed.
# Needs what grade needs (./tumble grade --help builds it), and `./tumble audit a1` once: it leaves the
# texts of the slips in BUILD/audit/a1/slips.
set -euo pipefail
build=$(realpath "$1") n=$2 jobs=$3 kills=$4
folder=${5:-$(mktemp -d /tmp/class_overnight.XXXXXX)}
slips=("$build"/audit/a1/slips/*.cpp)
[ -e "${slips[0]}" ] || { echo "No slips in $build/audit/a1/slips: run ./tumble audit a1 first." >&2; exit 2; }
export TUMBLE_ROOT=${TUMBLE_ROOT:-$(realpath "$(dirname "$0")/../..")}
export TUMBLE_GRADER_KEY=$folder/grader.key
mkdir -p "$folder/in"
for ((i = 0; i < n; ++i)); do
  name=$(printf 's%04d' "$i")
  mkdir -p "$folder/in/$name"
  { cat "${slips[i % ${#slips[@]}]}"; echo "// student $i"; } > "$folder/in/$name/a1_impulse.cpp"
done

grade() {
  local TIMEFORMAT='%U %S'
  { time "$build/bin/tumble" grade a1 "$folder/in" --out "$folder/$1" --no-media --jobs "$jobs" > "$folder/$1.txt" 2> "$folder/$1.log"; } 2> "$folder/$1.cpu"
}

# The memory of the grading's first process, in KiB, every second: its largest value.
watch_memory() {
  local most=0 now
  while now=$(awk '/^VmRSS/ {print $2}' "/proc/$1/status" 2> /dev/null) && [ -n "$now" ]; do
    ((now > most)) && most=$now
    echo "$most" > "$folder/memory"
    sleep 1
  done
}

began=$(date +%s.%N)
grade calm & pid=$!
sleep 0.5
watch_memory "$(pgrep -P "$pid" -x tumble | head -1)" &
wait "$pid" || true
seconds=$(echo "$(date +%s.%N) - $began" | bc)
echo "$n submissions, $jobs at a time: $(printf '%.0f' "$seconds") s, $(echo "scale=1; 60 * $n / $seconds" | bc) a minute, $(echo "scale=1; 60 * $n / $seconds / $jobs" | bc) a minute and job; memory of the grader at most $(cat "$folder/memory") KiB"
awk -v n="$n" '{c = $1 + $2; printf "CPU time of all processes: %.1f s, %.2f s a submission: %.1f submissions a minute on a core of its own\n", c, c / n, 60 * n / c}' "$folder/calm.cpu"

for ((kill = 1; kill <= kills; ++kill)); do
  grade killed & pid=$!
  # Between 3 s and twice an even share of the whole, so that the last moments are reached too.
  sleep "$(awk -v s="$seconds" -v k="$kills" -v r="$RANDOM" 'BEGIN {print 3 + r / 32767 * 2 * s / k}')"
  child=$(pgrep -P "$pid" -x tumble | head -1) || true
  [ -z "$child" ] || kill -KILL "$child"
  wait "$pid" 2> /dev/null || true
  echo "kill $kill: $(find "$folder/killed" -name results.json -not -path '*/.making-*' | wc -l) of $n have results"
done
if ((kills > 0)); then
  grade killed || true
  diff -r -x times.json -x .tumble-lock "$folder/calm" "$folder/killed" || { echo "different bytes" >&2; exit 1; }
  echo "after $kills kills: the same bytes as without"
fi
"$build/bin/tumble" ledger verify "$folder/calm"
