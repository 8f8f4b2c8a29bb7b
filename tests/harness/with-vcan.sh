#!/usr/bin/env bash
# Run a command where the CAN interface vcan0 exists, whatever the machine's kernel offers.
#
#     tests/harness/with-vcan.sh COMMAND [ARGUMENT...]
#
# The first of these that works:
#   1. a new network namespace of the host's kernel, where it has vcan (gone again with the command);
#   2. User-Mode Linux: a Linux kernel as an ordinary process, with the host's files as its own.
# Neither needs the other's privileges, and neither leaves anything behind. In both there is no other network:
# build and fetch before. COMMAND sees the environment and working directory it was called with, and
# OLEO_VCAN=vcan0. Its output and exit status are passed on; 77 says "no vcan to be had here" (reason on stderr).
# OLEO_VCAN_TIMEOUT_S (600) ends a command that hangs, with status 124. OLEO_VCAN_BY=namespace|uml takes that way only.
set -u

readonly SKIP=77
readonly timeout_s=${OLEO_VCAN_TIMEOUT_S:-600}
readonly by=${OLEO_VCAN_BY:-any}

[ $# -gt 0 ] || { sed -n '2,/^set/{/^#/s/^# \{0,1\}//p}' "$0"; exit 2; }

# --- 1. the host's kernel -------------------------------------------------------------------------------
# Creating the link asks the kernel to load the module by itself; a user namespace gives an ordinary user the right.
readonly make_link='ip link add dev vcan0 type vcan && ip link set vcan0 up'
namespace=(unshare --net)
[ "$(id -u)" -eq 0 ] || namespace=(unshare --user --map-root-user --net)
if [ "$by" != uml ] && "${namespace[@]}" sh -c "$make_link" >/dev/null 2>&1; then
    OLEO_VCAN=vcan0 exec timeout --kill-after=5 "$timeout_s" \
        "${namespace[@]}" sh -c "$make_link && ip link set lo up && exec \"\$@\"" sh "$@"
fi
[ "$by" != namespace ] || { echo "with-vcan: this kernel has no vcan, or no right to create one" >&2; exit "$SKIP"; }

# --- 2. User-Mode Linux ---------------------------------------------------------------------------------
for tool in linux.uml busybox ip; do
    command -v "$tool" >/dev/null && continue
    echo "with-vcan: this kernel has no vcan and there is no $tool:" \
         "apt-get install user-mode-linux busybox-static iproute2" >&2
    exit "$SKIP"
done

# One folder for all that passes between here and there, on a file system both see under the same name.
work=$(mktemp -d "${TMPDIR:-/tmp}/oleo-vcan.XXXXXX") || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM

modules=$(find /usr/lib/uml/modules -maxdepth 1 -mindepth 1 | sort | tail -n 1)
export -p | grep -vE '^declare -[a-z]*r' > "$work/environment"
{ printf 'cd %q || exit 126\n' "$PWD"; printf 'exec'; printf ' %q' "$@"; printf '\n'; } > "$work/command"

# The first process of that kernel. Not run by busybox, which starts its own commands through /proc/self/exe: before
# proc is mounted that is the host's, where "self" is User-Mode Linux. `status` is written last: without it the
# kernel did not get there.
cat > "$work/init" <<INIT
#!/bin/bash
export PATH=/usr/sbin:/usr/bin:/sbin:/bin
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t devtmpfs dev /dev
mkdir -p /dev/pts /dev/shm
ln -s /proc/self/fd /dev/fd; ln -s fd/0 /dev/stdin; ln -s fd/1 /dev/stdout; ln -s fd/2 /dev/stderr
mount -t devpts devpts /dev/pts
mount -t tmpfs tmpfs /dev/shm
{
    for module in net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan; do
        busybox insmod $modules/kernel/\$module.ko
    done
    ip link set lo up; $make_link
} > $work/setup 2>&1 && {
    touch $work/ready
    ( . $work/environment; export OLEO_VCAN=vcan0; . $work/command ) < /dev/null > $work/stdout 2> $work/stderr
    echo \$? > $work/status
}
busybox poweroff -f
INIT
chmod +x "$work/init"
mkdir "$work/uml"; : > "$work/stdout"; : > "$work/stderr"

# The guest's memory is a file it must be able to map executable: in RAM where there is room for it.
memory=$work
free_mib=$(df --output=avail --block-size=1M /dev/shm 2>/dev/null | tail -n 1)
if [ "${free_mib:-0}" -gt 1100 ] && ! findmnt -no OPTIONS /dev/shm | grep -q noexec; then memory=/dev/shm; fi
# On processors with AMX the kernel needs a library at its side (see there). OLEO_UML_XSTATE=1 takes it along anywhere.
preload=
if [ -n "${OLEO_UML_XSTATE:-}" ] || grep -qw amx_tile /proc/cpuinfo; then
    preload=$work/uml_xstate.so
    if ! cc -shared -fPIC -O2 -o "$preload" "$(dirname "$0")/uml_xstate.c" 2> "$work/cc"; then
        echo "with-vcan: this processor has AMX, and there is no C compiler for User-Mode Linux's cure: $(head -n 1 "$work/cc")" >&2
        exit "$SKIP"
    fi
fi
# `setsid` makes the kernel and all its processes one group, so that a hang ends whole.
LD_PRELOAD=$preload TMPDIR=$memory setsid linux.uml mem=1G root=/dev/root rootfstype=hostfs rootflags=/ rw "init=$work/init" "uml_dir=$work/uml/" \
    con=null con0=null,fd:1 quiet < /dev/null > "$work/console" 2>&1 &
kernel=$!
trap 'kill -KILL -- "-$kernel" 2>/dev/null; exit 130' INT TERM
for ((tenths = 0; tenths < timeout_s * 10; tenths++)); do
    kill -0 "$kernel" 2>/dev/null || break
    sleep 0.1
done
late=no
kill -0 "$kernel" 2>/dev/null && { late=yes; kill -KILL -- "-$kernel"; }
wait "$kernel" 2>/dev/null

cat "$work/stdout"
cat "$work/stderr" >&2
if [ "$late" = yes ]; then
    echo "with-vcan: not done within $timeout_s s, ended" >&2
    exit 124
elif [ -s "$work/status" ]; then
    exit "$(cat "$work/status")"
elif [ -e "$work/ready" ]; then
    echo "with-vcan: the emulated kernel ended before the command did:" >&2
    tail -n 20 "$work/console" >&2
    exit 1
fi
echo "with-vcan: User-Mode Linux did not give a vcan0:" >&2
tail -n 5 "$work/setup" "$work/console" >&2 2>/dev/null
exit "$SKIP"
