#!/usr/bin/env bash
# sends frames over a real SocketCAN interface, and runs tests/vcan.rs (the loop over it in one and in two processes)
. tests/harness/lib.sh
readonly with_vcan=tests/harness/with-vcan.sh

packages iproute2 can-utils
OLEO_VCAN_BY=namespace "$with_vcan" true > /dev/null 2>&1 || packages user-mode-linux busybox-static

# shellcheck disable=SC2016
loopback='candump -n 1 vcan0 > "$0" & sleep 0.3; cansend vcan0 123#DEADBEEF; wait $!; grep "DE AD BE EF" "$0"'
if "$with_vcan" true > "$OLEO_LOGS/vcan.log" 2>&1; then
    check "frames cross vcan0" "$with_vcan" bash -c "$loopback" "$OLEO_LOGS/candump" || exit 0
else
    must_not_skip "vcan" "$(tail -n 1 "$OLEO_LOGS/vcan.log")"
    exit 0
fi

# Where the processor has AMX, the emulated kernel needs a library. Elsewhere it must do no harm.
if ! OLEO_VCAN_BY=namespace "$with_vcan" true > /dev/null 2>&1; then
    # shellcheck disable=SC2016
    check "frames cross vcan0 with the library for AMX" \
        env OLEO_UML_XSTATE=1 "$with_vcan" bash -c "$loopback" "$OLEO_LOGS/candump"
fi

# Built out here, run in there: the emulated kernel has no network and one processor.
cargo test "${FEATURES[@]}" --locked --release --test vcan --no-run > "$OLEO_LOGS/vcan.build.log" 2>&1
binary=$(sed -n 's/.*Executable tests\/vcan.rs (\(.*\))/\1/p' "$OLEO_LOGS/vcan.build.log")
if [ -x "$binary" ]; then
    libtest "vcan tests" "$with_vcan" "$binary" --test-threads=1 --show-output
else
    fail "tests/vcan.rs" "does not build"
    tail -n 40 "$OLEO_LOGS/vcan.build.log"
fi

# The same valve words whatever carries the frames.
oleo=$CARGO_TARGET_DIR/release/oleo
same_on_vcan() {
    local here there
    here=$(tests/harness/hil-hash.sh "$oleo" "$OLEO_LOGS/hil-inproc")
    there=$("$with_vcan" tests/harness/hil-hash.sh "$oleo" "$OLEO_LOGS/hil-vcan" --bus socketcan:vcan0)
    echo "in process $here, on vcan0 $there"
    [ -n "$here" ] && [ "$here" = "$there" ]
}
check "release build" cargo build "${FEATURES[@]}" --locked --quiet --release || exit 0
check "hil on vcan0 commands what hil in process commands" same_on_vcan
sed 's/^/   /' "$log"

# The log of a run, played back by somebody else's tool: the first hundred frames arrive as logged.
# shellcheck disable=SC2016
playback='candump -L -n 100 vcan0 > "$1" & sleep 0.3; canplayer -t -I "$0" vcan0=vcan0; wait; wc -l < "$1"
    diff <(head -n 100 "$0" | cut -d" " -f3) <(cut -d" " -f3 "$1")'
check "canplayer plays the log of hil" "$with_vcan" bash -c "$playback" "$OLEO_LOGS/hil-vcan/candump.log" "$OLEO_LOGS/played.log"
exit 0
