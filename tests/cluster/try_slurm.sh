#!/bin/bash
# Grades a class on a Slurm of one controller and two nodes, all on this machine, and loses a node in the middle:
# the results must be the bytes of a local run. Needs root and Debian's slurm-wlm and munge; not in ctest, because it starts daemons.
#   tests/cluster/try_slurm.sh [SUBMISSIONS [SHARDS]]     default 24 and 8
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
count=${1:-24} shards=${2:-8}
tumble=$root/build/bin/tumble
for program in slurmctld slurmd sbatch munged; do
  command -v $program >/dev/null || { echo "there is no $program: apt-get install slurm-wlm munge"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "needs root, to start a cluster"; exit 77; }

work=$(mktemp -d /tmp/try-slurm-XXXXXX)
export SLURM_CONF=$work/slurm.conf TUMBLE_ROOT=$root TUMBLE_GRADER_KEY=$work/grader.key
started_munge=
stop_all() {
  for file in "$work"/*.pid; do [ -e "$file" ] && kill "$(cat "$file")" 2>/dev/null || true; done
  pkill -f "$work" 2>/dev/null || true
  [ -z "$started_munge" ] || pkill -x munged || true
}
trap stop_all EXIT

start_node() { slurmd -N "$1"; }
if ! pgrep -x munged >/dev/null; then
  mkdir -p /run/munge && chown munge: /run/munge && chmod 755 /run/munge
  [ -s /etc/munge/munge.key ] || { dd if=/dev/urandom of=/etc/munge/munge.key bs=1024 count=1 2>/dev/null; chown munge: /etc/munge/munge.key; chmod 400 /etc/munge/munge.key; }
  su -s /bin/sh munge -c "$(command -v munged)" && started_munge=yes
fi
host=$(hostname -s)
cat >"$SLURM_CONF" <<CONF
ClusterName=try
SlurmctldHost=$host
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CredType=cred/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool-%n
SlurmctldPidFile=$work/controller.pid
SlurmdPidFile=$work/%n.pid
SlurmctldPort=16817
SlurmctldLogFile=$work/controller.log
SlurmdLogFile=$work/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=2,batch_sched_delay=0
SlurmdTimeout=8
KillWait=2
ReturnToService=2
NodeName=n1 NodeHostname=$host Port=17001 CPUs=1 State=UNKNOWN
NodeName=n2 NodeHostname=$host Port=17002 CPUs=1 State=UNKNOWN
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
mkdir -p "$work/state"
slurmctld
start_node n1
start_node n2
for _ in $(seq 30); do [ "$(sinfo -h -t idle -o %D 2>/dev/null || true)" = 2 ] && break; sleep 1; done

"$root/tests/cluster/make_class.sh" "$root" "$work/class" "$count"
seconds() { local from=$SECONDS; "$@" >"$work/printed.txt" 2>&1 || true; echo $((SECONDS - from)); }
echo "local, 2 at a time:   $(seconds "$tumble" grade a1 "$work/class" --out "$work/local" --no-media --jobs 2) s"
echo "Slurm, 2 nodes:       $(seconds "$tumble" grade a1 "$work/class" --out "$work/slurm" --no-media --on slurm --shards "$shards") s"
diff -rq -x times.json "$work/local" "$work/slurm" && echo "the same bytes as a local run"

# A node is lost with what runs on it, and comes back after Slurm has noticed.
"$tumble" grade a1 "$work/class" --out "$work/lost" --no-media --on slurm --shards "$shards" >"$work/lost.txt" 2>&1 &
grader=$!
until [ "$(find "$work/lost/.shards" -name record.json 2>/dev/null | wc -l)" -ge $((count / 4)) ]; do sleep 0.2; done
kill -9 "$(cat "$work/n2.pid")"
pkill -9 -f "slurmstepd.*" || true   # every task dies as on a machine without power
pkill -9 -f -- "--out $work/lost .*--shard [0-9]" || true
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
stop_all
rm -rf "$work"
