#!/bin/bash
# Chains and a sweep on a Slurm of two nodes (slurm_here.sh), and a node lost in the middle: the results must be the bytes
# of a local run. Needs root and Debian's slurm-wlm and munge, and a tree with solutions; not in ctest, because it starts daemons.
#   tests/cluster/try_farm_slurm.sh [CHAINS [SAMPLES]]     default 8 and 2000
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
chains=${1:-8} samples=${2:-2000}
tumble=$root/build/bin/tumble
source "$root/tests/cluster/slurm_here.sh"
export TUMBLE_ROOT=$root

sample=("$tumble" sample ball_into_bin --modules reference --chains "$chains" --samples "$samples")
sweep=("$tumble" sweep bouncing_ball --modules reference --over restitution=0.1:0.9:0.2 --over step_s=1/60,1/240)
# timed WORDS...: seconds on the wall; what it prints goes to printed.txt, its exit code is kept.
timed() { local from=$EPOCHREALTIME; code=0; "$@" >"$work/printed.txt" 2>&1 || code=$?; seconds=$(awk "BEGIN {printf \"%.1f\", $EPOCHREALTIME - $from}"); }
# same A B FILE...: the same bytes in both folders.
same() { local a=$1 b=$2; shift 2; for file in "$@"; do cmp "$work/$a/$file" "$work/$b/$file" || return 1; done; }
files="ball_into_bin/chains.csv ball_into_bin/answers.json"

timed "${sample[@]}" --jobs 1 --out "$work/one"
echo "chains, local, 1 at a time:  $seconds s, exit $code"
timed "${sample[@]}" --jobs 2 --out "$work/two"
echo "chains, local, 2 at a time:  $seconds s, exit $code"
timed "${sample[@]}" --on slurm --out "$work/slurm"
echo "chains, Slurm, 2 nodes:      $seconds s, exit $code"
same one two $files && same one slurm $files && echo "the same bytes"
timed "${sweep[@]}" --jobs 2 --out "$work/sweep-here"
echo "sweep, local, 2 at a time:   $seconds s, exit $code"
timed "${sweep[@]}" --on slurm --shards 4 --out "$work/sweep-slurm"
echo "sweep, Slurm, 4 tasks:       $seconds s, exit $code"
same sweep-here sweep-slurm bouncing_ball/table.csv bouncing_ball/table.json && echo "the same bytes"

# A node is lost with what runs on it, and comes back after Slurm has noticed.
"${sample[@]}" --on slurm --out "$work/lost" >"$work/lost.txt" 2>&1 &
program=$!
until ls "$work"/lost/ball_into_bin/chains/*.part >/dev/null 2>&1; do sleep 0.1; done
lose_node n2
echo "a node is lost after $(ls "$work"/lost/ball_into_bin/chains/*.part | wc -l) of $chains chains"
sleep 15
start_node n2
code=0
wait $program || code=$?
[ "$code" = 0 ] || "${sample[@]}" --on slurm --out "$work/lost" >>"$work/lost.txt" 2>&1 || true
same one lost $files && echo "the same bytes after a node was lost (first exit $code)"
grep -E "missing|run again|taken over" "$work/lost.txt" || true

# The command itself is killed while its job runs, and started again.
"${sample[@]}" --on slurm --out "$work/killed" >/dev/null 2>&1 &
program=$!
until ls "$work"/killed/ball_into_bin/chains/*.part >/dev/null 2>&1; do sleep 0.1; done
kill -9 $program
timed "${sample[@]}" --on slurm --out "$work/killed"
grep -E "of an earlier start" "$work/printed.txt" || true
same one killed $files && echo "the same bytes after the command was killed"
stop_all
rm -rf "$work"
