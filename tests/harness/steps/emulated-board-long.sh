#!/usr/bin/env bash
# the same over 60,000 ticks: every built-in scenario, and a minute in a bend
. tests/harness/lib.sh
. tests/harness/cross.sh
. tests/harness/emulated-board.sh

emulated_board_builds || exit 0
# All but those with another strategy than the image's, and the one in which the controller is reset, which the emulator cannot do in step.
while read -r file; do
    in_the_loop "$(basename "$file" .toml)"
done < <(grep -LE '^strategy = "(always|ride)|^kind = "node-restarted"' hil/scenarios/*.toml)
in_the_loop step-steer --duration-s 80
ticks=$(awk '{ sum += $1 } END { print sum + 0 }' "$OLEO_LOGS/emulated-ticks")
enough() { echo "$ticks ticks"; [ "$ticks" -ge 60000 ]; }
check "at least 60,000 ticks" enough
sed 's/^/   /' "$log"
exit 0
