#!/usr/bin/env bash
# extra: runs each fuzz target for OLEO_FUZZ_S (30) seconds with cargo-fuzz on a nightly compiler
. tests/harness/lib.sh
readonly seconds=${OLEO_FUZZ_S:-30}

cargo_tool cargo-fuzz
if ! cargo +nightly fuzz --version > /dev/null 2>&1; then
    skip "fuzzing" "no cargo-fuzz or no nightly toolchain"
    exit 0
fi
for target in fuzz/fuzz_targets/*.rs; do
    name=$(basename "$target" .rs)
    check "fuzz $name for $seconds s" \
        cargo +nightly fuzz run "$name" -- -max_total_time="$seconds" -rss_limit_mb=4096 -timeout=10
done
exit 0
