#!/usr/bin/env bash
# the same over 60,000 ticks: every built-in scenario, and a minute in a bend
. tests/harness/lib.sh
. tests/harness/cross.sh
. tests/harness/emulated-board.sh

emulated_board_builds || exit 0
while read -r scenario; do
    in_the_loop "$scenario"
done < <(for file in hil/scenarios/*.toml; do basename "$file" .toml; done)
in_the_loop step-steer --duration 60
ticks=$(awk '{ sum += $1 } END { print sum + 0 }' "$OLEO_LOGS/emulated-ticks")
enough() { echo "$ticks ticks"; [ "$ticks" -ge 60000 ]; }
check "at least 60,000 ticks" enough
sed 's/^/   /' "$log"
exit 0
