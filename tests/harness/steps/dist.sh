#!/usr/bin/env bash
# builds the program to give on, and checks its size, its valve words and its instructions
. tests/harness/lib.sh

readonly MOST_BYTES=15000000
check "dist build" cargo build --profile dist --features dist --locked --quiet &&
    check "release build" cargo build "${FEATURES[@]}" --locked --quiet --release || exit 0
readonly dist=$CARGO_TARGET_DIR/dist/oleo release=$CARGO_TARGET_DIR/release/oleo

small() {
    local bytes
    bytes=$(stat -c %s "$dist")
    echo "$bytes bytes"
    [ "$bytes" -lt "$MOST_BYTES" ]
}
check "smaller than $MOST_BYTES bytes" small && sed 's/^/   /' "$log"

same() {
    local ours theirs
    ours=$(tests/harness/hil-hash.sh "$dist" "$OLEO_LOGS/dist") theirs=$(tests/harness/hil-hash.sh "$release" "$OLEO_LOGS/release")
    echo "'$ours' against '$theirs'"
    [ -n "$ours" ] && [ "$ours" = "$theirs" ]
}
check "the same valve words" same

need valgrind valgrind || { skip "instructions of oleo hil" "no valgrind"; exit 0; }
instructions() { # PROGRAM
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$1" hil --duration-s 2 --no-out 2>&1 | awk '/Collected :/ { print $4 }'
}
no_slower() {
    local ours theirs
    ours=$(instructions "$dist") theirs=$(instructions "$release")
    echo "${ours:-none} instructions for 2 s of oleo hil, release ${theirs:-none}"
    [ "${ours:-0}" -gt 0 ] && [ "$ours" -le "$theirs" ]
}
check "no more instructions" no_slower && sed 's/^/   /' "$log"
exit 0
