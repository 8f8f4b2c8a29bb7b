#!/usr/bin/env bash
# runs the controller on an emulated Cortex-M4F, compares its valve words with those of the host, and counts instructions
. tests/harness/lib.sh
. tests/harness/cross.sh

cross_find || { must_not_skip "controller on an emulated board" "$cross_how"; exit 0; }
need qemu-system-arm qemu-system-arm || { must_not_skip "controller on an emulated board" "no qemu-system-arm"; exit 0; }
check "benchmark builds for the board" cross_cargo build --release -p oleo-bench || exit 0
check "benchmark builds for the host" host_bench || exit 0

# One instruction is one nanosecond of the board's clock, so its timers count instructions, the same in every run.
emulate() {
    timeout 300 qemu-system-arm -M mps2-an386 -nographic -monitor none -serial none -icount shift=0 \
        -semihosting-config enable=on,target=native -kernel "$FIRMWARE_TARGET/$BOARD/release/oleo-bench"
}
check "drive on the emulated board" emulate || exit 0
sed 's/^/   /' "$log"
cp "$log" "$OLEO_LOGS/board.txt"
check "drive on the host" "$bench_binary" || exit 0
same_words() { diff <(grep -E '^(ticks|valve|mode|handling)' "$OLEO_LOGS/board.txt") <(grep -E '^(ticks|valve|mode|handling)' "$1"); }
host_log=$log
check "valve words on board and host are the same" same_words "$host_log"
exit 0
