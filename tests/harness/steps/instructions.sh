#!/usr/bin/env bash
# counts the x86-64 instructions of a controller tick with callgrind
. tests/harness/lib.sh
. tests/harness/cross.sh

need valgrind valgrind || { skip "instructions a tick" "no valgrind"; exit 0; }
check "benchmark builds for the host" host_bench || exit 0

# Counts only between entering and leaving the function, over the whole drive.
instructions_in() {
    local ticks total
    valgrind --tool=callgrind --collect-atstart=no --toggle-collect="*$1*" --callgrind-out-file="$OLEO_LOGS/$2.callgrind" \
        --compress-strings=no --compress-pos=no \
        "$bench_binary" > "$OLEO_LOGS/callgrind.txt" 2>&1 || { cat "$OLEO_LOGS/callgrind.txt"; return 1; }
    ticks=$(awk '$1 == "ticks" { print $2 }' "$OLEO_LOGS/callgrind.txt")
    total=$(awk '/Collected :/ { print $4 }' "$OLEO_LOGS/callgrind.txt")
    [ "${total:-0}" -gt 0 ] || { echo "callgrind saw no call of $1"; return 1; }
    echo "$2: $((total / ticks)) instructions, mean of $ticks"
    awk -v ticks="$ticks" "$by_file" "$OLEO_LOGS/$2.callgrind" | sort -rn | head -n 8
}
# Whose they are, after inlining: "fl=", "fi=", "fe=" name the source file of the cost lines that follow; a line after
# "calls=" is the cost of the callee, counted where it is spent.
# shellcheck disable=SC2016
by_file='/^f[lie]=/ { file = substr($0, 4) }
    /^calls=/ { getline; next }
    /^[0-9]+ [0-9]+$/ { if (!sub(/.*controller\/src\//, "controller/src/", file) && !sub(/.*interface\/src\//, "interface/src/", file)) sub(/.*\/(library|registry\/src\/[^\/]*)\//, "", file); cost[file] += $2 }
    END { for (file in cost) printf "%6d  %s\n", cost[file] / ticks, file }'
for part in "9 controller_tick tick" "1 node_tick node-tick" "1 node_receive receive-six-frames"; do
    read -r lines function title <<< "$part"
    check "counted: $title" instructions_in "$function" "$title" && head -n "$lines" "$log" | sed 's/^/   x86-64 /'
done
exit 0
