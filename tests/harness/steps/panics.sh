#!/usr/bin/env bash
# links the firmware only if no panic is reachable in it, and checks that a deliberate panic does not link
. tests/harness/lib.sh
. tests/harness/cross.sh

cross_find || { must_not_skip "no panic is reachable" "$cross_how"; exit 0; }
check "no panic is reachable in the image" cross_cargo build --release --features panic-never
check "no panic is reachable in the image for the emulated board" cross_cargo build --release --features panic-never,slcan

# A proof that cannot fail is none: with one deliberate panic behind a received frame the same build must not link.
refuses() {
    local said
    said=$(cross_cargo build --release --features panic-never,deliberate-panic 2>&1)
    grep -m 1 -o 'error(panic-never): .*' <<< "$said" && return 0
    tail -n 20 <<< "$said"
    return 1
}
check "a deliberate panic is found" refuses
exit 0
