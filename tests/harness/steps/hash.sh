#!/usr/bin/env bash
# checks that the valve words are the same in debug and release, on one and two threads, and in a second run
. tests/harness/lib.sh

# The debug build is that of the tests, so that it is not made twice.
check "debug build" cargo test "${FEATURES[@]}" --workspace --lib --bins --tests --no-run --locked --quiet && check "release build" cargo build "${FEATURES[@]}" --locked --quiet --release || exit 0

run() { tests/harness/hil-hash.sh "$CARGO_TARGET_DIR/$2/oleo" "$OLEO_LOGS/hil-$1"; }
same() { if [ -z "$1" ] || [ "$1" != "$2" ]; then echo "'$1' against '$2'"; return 1; fi; }

reference=$(run release release)
echo "   command_hash ${reference:-none: no summary.json}"
check "debug = release" same "$reference" "$(run debug debug)"
check "second run = first" same "$reference" "$(run again release)"
check "one thread = two threads" same "$(RAYON_NUM_THREADS=1 run one release)" "$(RAYON_NUM_THREADS=2 run two release)"
exit 0
