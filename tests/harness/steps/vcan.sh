#!/usr/bin/env bash
# real SocketCAN: tests/vcan.rs, and the closed loop over vcan0 in one and in two processes
. tests/harness/lib.sh
readonly with_vcan=tests/harness/with-vcan.sh

packages iproute2 can-utils > /dev/null
OLEO_VCAN_BY=namespace $with_vcan true > /dev/null 2>&1 || packages user-mode-linux busybox-static

check "frames cross vcan0" $with_vcan bash -c '
    candump -n 1 vcan0 & sleep 0.3; cansend vcan0 123#DEADBEEF; wait $!' || exit 0
grep -q 'DE AD BE EF' "$log" || fail "frames cross vcan0" "candump did not print the frame"

binary() { cargo test --locked --test vcan --no-run 2>&1 | sed -n 's/.*Executable tests\/vcan.rs (\(.*\))/\1/p'; }
test_binary=$(binary)
if [ -x "$test_binary" ]; then
    $with_vcan "$test_binary" --test-threads=1 --show-output > "$OLEO_LOGS/vcan-tests.log" 2>&1
    status=$?
    { echo "     Running vcan"; cat "$OLEO_LOGS/vcan-tests.log"; } | awk -f tests/harness/libtest.awk > "$OLEO_LOGS/vcan.tally"
    while IFS=$'\t' read -r kind name reason; do
        case $kind in
            passed) tally passed "$name" "tests/vcan.rs"; echo "   $name tests of tests/vcan.rs passed" ;;
            *) "${kind%ed}" "$name" "${reason:-see below}" 2> /dev/null || fail "$name" "${reason:-see below}" ;;
        esac
    done < "$OLEO_LOGS/vcan.tally"
    [ $status -eq 0 ] || { grep -q '^failed' "$OLEO_LOGS/vcan.tally" || fail tests/vcan.rs "status $status"; tail -n 60 "$OLEO_LOGS/vcan-tests.log"; }
else
    fail "tests/vcan.rs" "does not build"
fi
exit 0
