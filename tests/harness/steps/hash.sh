#!/usr/bin/env bash
# the same valve words in debug and release, on one and two threads, and again
. tests/harness/lib.sh

cargo build --locked --quiet > "$OLEO_LOGS/hash.debug.log" 2>&1 || fail "debug build" "see $OLEO_LOGS/hash.debug.log"
cargo build --locked --quiet --release > "$OLEO_LOGS/hash.release.log" 2>&1 || fail "release build" "see $OLEO_LOGS/hash.release.log"

# command_hash of a run of the default scenario: run_hash NAME PROFILE [ENVIRONMENT...]
run_hash() {
    local out=$OLEO_LOGS/hil-$1 profile=$2
    shift 2
    env "$@" "$CARGO_TARGET_DIR/$profile/oleo" hil --out "$out" > "$out.log" 2>&1 < /dev/null
    sed -n 's/.*"command_hash": *"\{0,1\}\([0-9a-zA-Z]*\).*/\1/p' "$out/summary.json"
}
same() { if [ -z "$1" ] || [ "$1" != "$2" ]; then echo "'$1' against '$2'"; return 1; fi; }

reference=$(run_hash release release)
echo "   command_hash ${reference:-none: no summary.json}"
check "debug = release" same "$reference" "$(run_hash debug debug)"
check "second run = first" same "$reference" "$(run_hash again release)"
check "one thread = two threads" same "$(run_hash one release RAYON_NUM_THREADS=1)" "$(run_hash two release RAYON_NUM_THREADS=2)"
[ -f tests/golden/belgian.hash ] && check "as recorded in tests/golden" same "$reference" "$(tr -d '[:space:]' < tests/golden/belgian.hash)"
exit 0
