#!/usr/bin/env bash
# Run a command where Slurm takes jobs: a controller and a node of its own on this machine, for this command only.
#
#     tests/harness/with-slurm.sh COMMAND [ARGUMENT...]
#
# COMMAND finds sbatch, squeue and scancel on its PATH. Slurm is Debian's, unpacked into a folder (SLURM_FOLDER, kept for the next
# time): nothing is installed, no service is started, and the daemons end with the command. There is no munge, cgroup or database.
# Needs root, because a node starts each job as its owner. 77 says "no Slurm to be had here" (reason on stderr).
set -u

readonly SKIP=77
readonly FOLDER=${SLURM_FOLDER:-${TMPDIR:-/tmp}/oleo-slurm}
readonly PACKAGES=(slurmctld slurmd slurm-client slurm-wlm-basic-plugins libhwloc15 libjson-c5 liblua5.1-0 libmunge2 libnuma1
    libyaml-0-2 libdbus-1-3 liblz4-1 libpam0g libreadline8)

[ $# -gt 0 ] || { sed -n '2,/^set/{/^#/s/^# \{0,1\}//p}' "$0"; exit 2; }
skip() { echo "with-slurm: $1" >&2; exit "$SKIP"; }

[ "$(id -u)" -eq 0 ] || skip "Slurm's node starts jobs as their owner, which only root may do"
command -v apt-get dpkg > /dev/null || skip "Slurm is taken from Debian's packages, and this is no Debian"
if [ ! -x "$FOLDER/usr/sbin/slurmctld-wlm" ]; then
    mkdir -p "$FOLDER.packages" || exit 1
    (
        cd "$FOLDER.packages" || exit 1
        apt-get download -qq "${PACKAGES[@]}" || { apt-get update -qq; apt-get download -qq "${PACKAGES[@]}"; }
    ) > "$FOLDER.packages/log" 2>&1 < /dev/null || skip "no packages of Slurm: $(tail -n 1 "$FOLDER.packages/log")"
    for package in "$FOLDER.packages"/*.deb; do
        dpkg -x "$package" "$FOLDER.new" || skip "$package cannot be unpacked"
    done
    mv "$FOLDER.new" "$FOLDER" && rm -r "$FOLDER.packages"
fi
plugins=$(find "$FOLDER/usr/lib" -type d -name slurm-wlm | head -n 1)
[ -n "$plugins" ] || skip "$FOLDER has no plugins of Slurm; remove it"

# State, logs and sockets of this run. Short, because a path of a socket may not be long.
work=$(mktemp -d /tmp/oleo-slurm.XXXXXX) || exit 1
daemons=()
stop() {
    # Jobs of a command that failed would outlive the daemons.
    [ -z "${ready:-}" ] || scancel --quiet --user="$(id -un)" 2> /dev/null
    [ ${#daemons[@]} -eq 0 ] || kill "${daemons[@]}" 2> /dev/null
    wait 2> /dev/null
    rm -rf "$work"
}
trap stop EXIT
trap 'exit 130' INT TERM

# Two ports that nobody has.
ports=$(python3 -c 'import socket
sockets = [socket.socket() for _ in range(2)]
for s in sockets: s.bind(("127.0.0.1", 0))
print(*(s.getsockname()[1] for s in sockets))') || skip "no free port"
host=$(hostname -s)
cat > "$work/slurm.conf" <<CONF
ClusterName=oleo
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=${ports% *}
SlurmdPort=${ports#* }
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_min_interval=0,batch_sched_delay=1,bf_interval=5
ReturnToService=2
PluginDir=$plugins
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
mkdir "$work/state" "$work/spool"
export SLURM_CONF=$work/slurm.conf
libraries=$plugins:$(dirname "$plugins"):${LD_LIBRARY_PATH:-}
# The tools of Slurm only; what the jobs run has the libraries of this machine.
mkdir "$work/bin"
for tool in sbatch squeue scancel sinfo scontrol; do
    printf '#!/bin/sh\nLD_LIBRARY_PATH=%q exec %q "$@"\n' "$libraries" "$FOLDER/usr/bin/$tool" > "$work/bin/$tool"
    chmod +x "$work/bin/$tool"
done
export PATH=$work/bin:$PATH

LD_LIBRARY_PATH=$libraries "$FOLDER/usr/sbin/slurmctld-wlm" -D > "$work/slurmctld.out" 2>&1 < /dev/null &
daemons+=($!)
LD_LIBRARY_PATH=$libraries "$FOLDER/usr/sbin/slurmd-wlm" -D -d "$FOLDER/usr/sbin/slurmstepd-wlm" > "$work/slurmd.out" 2>&1 < /dev/null &
daemons+=($!)
for _ in $(seq 150); do
    [ "$(sinfo --noheader --format=%T 2> /dev/null)" = idle ] && ready=1 && break
    sleep 0.2
done
if [ -z "${ready:-}" ]; then
    tail -n 5 "$work"/*.out "$work"/*.log >&2
    skip "Slurm did not start: $(tail -qn 1 "$work"/slurm*.out "$work"/slurm*.log 2> /dev/null | tail -n 1)"
fi
"$@"
