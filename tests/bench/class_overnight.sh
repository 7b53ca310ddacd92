#!/bin/bash
# A class overnight: grades N submissions of a1, made from its slips, and says how many a minute, how
# much memory, and what kills do.
#   tests/bench/class_overnight.sh BUILD N JOBS KILLS [CALM [FOLDER]]
# First the first CALM submissions (default: all N) are graded without a kill: submissions a minute.
# With KILLS > 0 all N are graded then; that grading is ended by SIGKILL so many times, at random
# moments, and started again. What it leaves is compared, byte for byte, with the calm grading; a
# submission that the calm one has not, with another of the same slip.
# With EVERY=50 in the environment only each fiftieth is made from a slip, and the others do not compile: a
# class of 1,000 in minutes, to see kills and memory, and nothing of speed.
# Needs what grade needs (./tumble grade --help builds it), and `./tumble audit a1` once: it leaves the
# texts of the slips in BUILD/audit/a1/slips. Hours, for N = 1000.
set -euo pipefail
build=$(realpath "$1") n=$2 jobs=$3 kills=$4 calm=${5:-$2} every=${EVERY:-1}
folder=${6:-$(mktemp -d /tmp/class_overnight.XXXXXX)}
slips=("$build"/audit/a1/slips/*.cpp)
[ -e "${slips[0]}" ] || { echo "No slips in $build/audit/a1/slips: run ./tumble audit a1 first." >&2; exit 2; }
export TUMBLE_ROOT=${TUMBLE_ROOT:-$(realpath "$(dirname "$0")/../..")}
export TUMBLE_GRADER_KEY=$folder/grader.key
tumble=$build/bin/tumble

name_of() { printf 's%05d' "$1"; }
# The first submission that differs from this one in the name of the student only.
first_like() { echo $(($1 % every == 0 ? $1 % (every * ${#slips[@]}) : 1)); }
# make_class FOLDER COUNT: the same files for the same number.
make_class() {
  local i to
  for ((i = 0; i < $2; ++i)); do
    to=$1/$(name_of "$i")
    mkdir -p "$to"
    if ((i % every == 0)); then cat "${slips[i / every % ${#slips[@]}]}"; else echo 'int x = ;'; fi > "$to/a1_impulse.cpp"
    echo "// student $i" >> "$to/a1_impulse.cpp"
  done
}

# read_done: $finished is how many submissions the log on descriptor 9 calls finished. It reads what is new
# in the log without starting a process: what this script costs is not the grading's.
read_done() {
  local line
  while read -r line <&9; do
    if [[ $line =~ ^\[([0-9]+)/ ]]; then finished=${BASH_REMATCH[1]}; fi
  done
}

# watch_memory PID OUT: every five seconds "finished KiB", the largest memory so far of the grading's first
# process.
watch_memory() {
  local finished=0 name value most
  exec 9< "$folder/$2.log"
  while most=; do
    while read -r name value; do [ "$name" != VmHWM: ] || most=${value% kB}; done 2> /dev/null < "/proc/$1/status" || return 0
    [ -n "$most" ] || return 0
    read_done
    echo "$finished ${most// /}" >> "$folder/$2.memory"
    sleep 5
  done
}

# The largest memory until so many were finished.
say_memory() {
  local part
  for part in 4 2 1; do
    awk -v want=$((n / part)) '$1 + 0 <= want && $2 > most {most = $2} END {printf "memory of the grader until %d of the class: at most %.1f MiB\n", want, most / 1024}' "$folder/$1.memory"
  done
}

# start IN OUT: grades in the background; its process is $pid.
start() {
  : > "$folder/$2.log"
  "$tumble" grade a1 "$folder/$1" --out "$folder/$2" --no-media --jobs "$jobs" > "$folder/$2.txt" 2>> "$folder/$2.log" &
  pid=$!
  watch_memory "$pid" "$2" &
}

make_class "$folder/in" "$n"
make_class "$folder/first" "$calm"
began=$(date +%s.%N)
TIMEFORMAT='%U %S'
{ time { start first calm; wait "$pid" || true; }; } 2> "$folder/calm.cpu"
seconds=$(echo "$(date +%s.%N) - $began" | bc)
echo "$calm submissions, $jobs at a time: $(printf '%.0f' "$seconds") s, $(echo "scale=1; 60 * $calm / $seconds" | bc) a minute"
awk -v n="$calm" '{c = $1 + $2; printf "CPU time of all processes: %.1f s, %.2f s a submission: %.1f submissions a minute on a core of its own\n", c, c / n, 60 * n / c}' "$folder/calm.cpu"
"$tumble" ledger verify "$folder/calm"
((kills > 0)) || exit 0

# The last kill comes when everything is graded, while pages of the class are written.
mapfile -t moments < <(for ((k = 1; k < kills; ++k)); do echo $((RANDOM * 32768 % n + RANDOM % n)); done | awk -v n="$n" '{print $1 % n}' | sort -n; echo "$n")
for ((k = 0; k < kills; ++k)); do
  start in killed
  exec 9< "$folder/killed.log"
  finished=0
  until ((finished >= moments[k])) || ! kill -0 "$pid" 2> /dev/null; do sleep 0.2; read_done; done
  ((moments[k] == n)) || sleep "$((RANDOM % 8)).$((RANDOM % 10))"
  kill -KILL "$pid" 2> /dev/null || true
  wait "$pid" 2> /dev/null || true
  echo "kill $((k + 1)) after ${moments[k]}: $(find "$folder/killed" -name results.json -not -path '*/.making-*' | wc -l) of $n have results"
done
start in killed
wait "$pid" || true
say_memory killed

same_bytes() {
  local i name like
  ((calm < n)) || { diff -r -x times.json -x .tumble-lock "$folder/calm" "$folder/killed"; return; }
  for ((i = 0; i < n; ++i)); do
    name=$(name_of "$i") like=$(name_of "$(first_like "$i")")
    if ((i < calm)); then
      diff -r "$folder/calm/$name" "$folder/killed/$name" || return 1
    else
      cmp "$folder/killed/$name/results.json" "$folder/killed/$like/results.json" || return 1
    fi
  done
}
same_bytes || { echo "different bytes" >&2; exit 1; }
left=$(find "$folder/killed" -name '.making-*' -o -name '.*.draft*' | wc -l)
((left == 0)) || { echo "$left unfinished files" >&2; exit 1; }
said=$("$tumble" ledger verify "$folder/killed")
echo "$said"
[[ $said == *" $n entries of $n submissions fit together"* ]] || { echo "something was graded twice with another result" >&2; exit 1; }
echo "after $kills kills: the same bytes as without, an entry each, nothing unfinished"
