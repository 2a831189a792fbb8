#!/usr/bin/env bash
# The job file on a real Slurm: a slurmctld and two slurmd on this machine, all of their files in a temporary folder.
# An array of three tasks writes the parts of a sequence file, one task is killed and requeued, the dependent job joins
# the parts, and the result is compared with what one process writes.
#
#     scripts/slurm-test.sh POINTREEL
#
# Needs root, and the Debian packages slurmctld, slurmd, slurm-client and munge. Not a part of `make test`.
set -euo pipefail

program=$(readlink -f "${1:?name the pointreel program}")
here=$(cd "$(dirname "$0")" && pwd)
for tool in slurmctld slurmd sbatch scontrol munged; do
    command -v "$tool" >/dev/null || {
        echo "$tool is missing: apt-get install slurmctld slurmd slurm-client munge" >&2
        exit 1
    }
done
folder=$(mktemp -d)
pids=()
stop() {
    for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
    wait 2>/dev/null || true
    [ -n "${KEEP:-}" ] || rm -rf "$folder"
}
trap stop EXIT
fail() {
    echo "FAILED: $*" >&2
    tail -n 20 "$folder"/*.log "$folder"/slurm-*.out 2>/dev/null >&2 || true
    exit 1
}

# Who talks to whom is told by a key of this test.
dd if=/dev/urandom of="$folder/munge.key" bs=128 count=1 status=none
chmod 400 "$folder/munge.key"
chmod 755 "$folder"
munged --foreground --force --num-threads=2 --key-file="$folder/munge.key" --socket="$folder/munge.socket" \
    --pid-file="$folder/munge.pid" --seed-file="$folder/munge.seed" --log-file="$folder/munged.log" &
pids+=($!)

host=$(hostname -s)
cat > "$folder/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=26817
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CryptoType=crypto/munge
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool.%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.%n.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=2,requeue_delay=1
MinJobAge=600
KillWait=2
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=26818 CPUs=2 RealMemory=2000 State=UNKNOWN
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=26819 CPUs=2 RealMemory=2000 State=UNKNOWN
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
mkdir "$folder/state" "$folder/spool.n1" "$folder/spool.n2"
export SLURM_CONF=$folder/slurm.conf
slurmctld -D -f "$SLURM_CONF" >"$folder/controller.log" 2>&1 &
pids+=($!)
for node in n1 n2; do
    slurmd -D -N "$node" -f "$SLURM_CONF" >"$folder/daemon.$node.log" 2>&1 &
    pids+=($!)
done
for _ in $(seq 60); do
    [ "$(sinfo -h -N -t idle 2>/dev/null | wc -l)" = 2 ] && break
    sleep 1
done
[ "$(sinfo -h -N -t idle | wc -l)" = 2 ] || fail "the nodes are not idle: $(sinfo -N)"
echo "slurmctld $(slurmctld -V) with nodes n1 and n2"

# The program with a wait, so that there is time to kill it: a task that begins its second group is interrupted.
mkdir "$folder/bin"
cat > "$folder/bin/pointreel" <<WRAP
#!/bin/sh
echo "start \$(date +%s) \${SLURM_ARRAY_TASK_ID:-join} \${SLURM_RESTART_COUNT:-0} \$*" >> "$folder/runs"
if [ "\${SLURM_ARRAY_TASK_ID:-}" = 2 ] && [ ! -e "$folder/slowed" ]; then
    # Slow in the first run of the first array: killed while it works.
    touch "$folder/slowed"
    "$program" "\$@" --keyframes 1 &
    child=\$!
    sleep 0.2; kill -STOP \$child; sleep 600; exit 1
fi
case "\$*" in *--join*) exec "$program" "\$@" ;; esac
exec "$program" "\$@" --keyframes 1
WRAP
chmod 755 "$folder/bin/pointreel"
export PATH=$folder/bin:$PATH
cd "$folder"
input=${INPUT:-demo:}
echo "one process"
"$program" convert "$input" "$folder/whole.reel" --keyframes 1

echo "three tasks, of which one is killed and requeued"
said=$(TASKS=3 SBATCH_OPTIONS="--mem=500 --cpus-per-task=1" "$here/convert-array.sbatch" "$input" "$folder/walk.reel")
echo "$said"
array=$(echo "$said" | sed 's/array job \([0-9]*\) .*/\1/')
join=$(echo "$said" | sed 's/.*, job \([0-9]*\) .*/\1/')
state() { scontrol show job "$1" 2>/dev/null | grep -o 'JobState=[A-Z_]*' | head -1 | cut -d= -f2; }
wait_for() { # JOB STATE SECONDS
    for _ in $(seq "$3"); do
        [ "$(state "$1")" = "$2" ] && return
        sleep 1
    done
    fail "job $1 is $(state "$1"), not $2: $(squeue)"
}
for _ in $(seq 60); do grep -q " 2 0 convert" "$folder/runs" 2>/dev/null && break; sleep 1; done
sleep 4
[ "$(state "$join")" = PENDING ] || fail "the join runs before all tasks are done"
[ ! -e "$folder/walk.part-2-of-3.reel" ] || fail "a part that is not whole has its name"
scontrol requeue "${array}_2"
sleep 3
# Slurm waits two minutes before it runs a requeued job again.
scontrol update JobId="${array}_2" StartTime=now || true
wait_for "$join" COMPLETED 300
grep -q " 2 1 convert" "$folder/runs" || fail "task 2 was not run again"
cmp "$folder/whole.reel" "$folder/walk.reel" || fail "the joined file is not what one process writes"

echo "a task that fails: nothing is joined"
rm "$folder/walk.reel" "$folder"/walk.part-*
said=$(TASKS=3 SBATCH_OPTIONS="--mem=500 --cpus-per-task=1" "$here/convert-array.sbatch" "$folder/missing.ply" \
    "$folder/walk.reel")
join=$(echo "$said" | sed 's/.*, job \([0-9]*\) .*/\1/')
wait_for "$join" CANCELLED 120
[ ! -e "$folder/walk.reel" ] || fail "a file was joined although a task failed"
echo "OK"
