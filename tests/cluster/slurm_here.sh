# A Slurm of one controller and two nodes, all on this machine, for scripts that try a cluster. Sourced; needs root and
# Debian's slurm-wlm and munge. Sets $work, a folder of its own, and $SLURM_CONF; has start_node, lose_node and stop_all.
# Ends only what it has started: processes whose ids it knows, or whose environment names this $SLURM_CONF.
for program in slurmctld slurmd sbatch munged; do
  command -v $program >/dev/null || { echo "there is no $program: apt-get install slurm-wlm munge"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "needs root, to start a cluster"; exit 77; }

work=$(mktemp -d /tmp/try-slurm-XXXXXX)
export SLURM_CONF=$work/slurm.conf
munge_id=

# ids_with WORD...: processes of this cluster whose environment holds all of these words.
ids_with() {
  local id word found
  for id in $(ls /proc | grep -x '[0-9]*'); do
    [ "$id" != $$ ] || continue
    found=yes
    for word in "SLURM_CONF=$SLURM_CONF" "$@"; do
      grep -qzxF -- "$word" "/proc/$id/environ" 2>/dev/null || { found=; break; }
    done
    [ -z "$found" ] || echo "$id"
  done
}
start_node() { slurmd -N "$1"; }
# Its daemon and every task on it die as on a machine without power.
lose_node() {
  kill -9 "$(cat "$work/$1.pid")"
  local ids
  ids=$(ids_with "SLURMD_NODENAME=$1")
  [ -z "$ids" ] || kill -9 $ids 2>/dev/null || true
}
stop_all() {
  for file in "$work"/*.pid; do [ -e "$file" ] && kill "$(cat "$file")" 2>/dev/null || true; done
  [ -z "$munge_id" ] || kill "$munge_id" 2>/dev/null || true
}
trap stop_all EXIT

if ! pgrep -x munged >/dev/null; then
  mkdir -p /run/munge && chown munge: /run/munge && chmod 755 /run/munge
  [ -s /etc/munge/munge.key ] || { dd if=/dev/urandom of=/etc/munge/munge.key bs=1024 count=1 2>/dev/null; chown munge: /etc/munge/munge.key; chmod 400 /etc/munge/munge.key; }
  su -s /bin/sh munge -c "$(command -v munged)" && munge_id=$(cat /run/munge/munged.pid)
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
