#!/usr/bin/env bash
# x86-64 instructions of a controller tick, counted by callgrind
. tests/harness/lib.sh
. tests/harness/cross.sh

need valgrind valgrind || { skip "instructions a tick" "no valgrind"; exit 0; }
check "benchmark builds for the host" host_bench || exit 0

# Counts only between entering and leaving the function, over the whole drive.
instructions_in() {
    local ticks total
    valgrind --tool=callgrind --collect-atstart=no --toggle-collect="*$1*" --callgrind-out-file=/dev/null \
        "$bench_binary" > "$OLEO_LOGS/callgrind.txt" 2>&1 || { cat "$OLEO_LOGS/callgrind.txt"; return 1; }
    ticks=$(awk '$1 == "ticks" { print $2 }' "$OLEO_LOGS/callgrind.txt")
    total=$(awk '/Collected :/ { print $4 }' "$OLEO_LOGS/callgrind.txt")
    [ "${total:-0}" -gt 0 ] || { echo "callgrind saw no call of $1"; return 1; }
    echo "$2: $((total / ticks)) instructions, mean of $ticks"
}
for part in "controller_tick tick" "node_tick node-tick" "node_receive receive-six-frames"; do
    read -r function title <<< "$part"
    check "counted: $title" instructions_in "$function" "$title" && sed 's/^/   x86-64 /' "$log"
done
exit 0
