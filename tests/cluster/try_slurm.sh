#!/bin/bash
# Grades a class on a Slurm of two nodes (slurm_here.sh), and loses a node in the middle:
# the results must be the bytes of a local run. Needs root and Debian's slurm-wlm and munge; not in ctest, because it starts daemons.
#   tests/cluster/try_slurm.sh [SUBMISSIONS [SHARDS]]     default 24 and 8
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
count=${1:-24} shards=${2:-8}
tumble=$root/build/bin/tumble
source "$root/tests/cluster/slurm_here.sh"
export TUMBLE_ROOT=$root TUMBLE_GRADER_KEY=$work/grader.key
stop_rest() {
  stop_all
  pkill -f "$work" 2>/dev/null || true
}
trap stop_rest EXIT

"$root/tests/cluster/make_class.sh" "$root" "$work/class" "$count"
seconds() { local from=$SECONDS; "$@" >"$work/printed.txt" 2>&1 || true; echo $((SECONDS - from)); }
echo "local, 2 at a time:   $(seconds "$tumble" grade a1 "$work/class" --out "$work/local" --no-media --jobs 2) s"
echo "Slurm, 2 nodes:       $(seconds "$tumble" grade a1 "$work/class" --out "$work/slurm" --no-media --on slurm --shards "$shards") s"
diff -rq -x times.json "$work/local" "$work/slurm" && echo "the same bytes as a local run"

# A node is lost with what runs on it, and comes back after Slurm has noticed.
"$tumble" grade a1 "$work/class" --out "$work/lost" --no-media --on slurm --shards "$shards" >"$work/lost.txt" 2>&1 &
grader=$!
until [ "$(find "$work/lost/.shards" -name record.json 2>/dev/null | wc -l)" -ge $((count / 4)) ]; do sleep 0.2; done
lose_node n2
sleep 20
start_node n2
wait $grader || true
diff -rq -x times.json "$work/local" "$work/lost" && echo "the same bytes after a node was lost"
grep -c "run again" "$work/lost.txt" | sed 's/$/ rounds were submitted again by tumble; the others were requeued by Slurm/' || true

# The command itself is killed while its job runs, and started again: it waits for the job, or takes over what it did.
"$tumble" grade a1 "$work/class" --out "$work/killed" --no-media --on slurm --shards "$shards" >/dev/null 2>&1 &
grader=$!
until [ "$(find "$work/killed/.shards" -name record.json 2>/dev/null | wc -l)" -ge 2 ]; do sleep 0.2; done
kill -9 $grader
"$tumble" grade a1 "$work/class" --out "$work/killed" --no-media --on slurm --shards "$shards" >"$work/killed.txt" 2>&1 || true
grep -q "of an earlier start" "$work/killed.txt" && echo "started again: waited for the job of the earlier start"
diff -rq -x times.json "$work/local" "$work/killed" && echo "the same bytes after the command was killed"
stop_rest
rm -rf "$work"
