#!/usr/bin/env bash
# the firmware links only if no panic is reachable in it, and the proof can fail
. tests/harness/lib.sh
. tests/harness/cross.sh

cross_find || { skip "no panic is reachable" "$cross_how"; exit 0; }
check "no panic is reachable in the image" cross_cargo build --release --features panic-never

# A proof that cannot fail is none: with one deliberate panic behind a received byte the same build must not link.
refuses() { ! cross_cargo build --release --features panic-never,deliberate-panic; }
check "a deliberate panic is found" refuses
grep -q 'error(panic-never)' "$log" || fail "a deliberate panic is found" "the build failed for another reason"
exit 0
