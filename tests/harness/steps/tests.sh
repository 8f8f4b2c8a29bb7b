#!/usr/bin/env bash
# unit, property and end-to-end tests of the workspace (cargo test, dev profile)
. tests/harness/lib.sh

log=$OLEO_LOGS/cargo-test.log
# --show-output, because a test that cannot run says "SKIPPED: reason" and returns: it must not count as passed.
cargo test --workspace --locked --no-fail-fast -- --show-output > "$log" 2>&1
status=$?
awk -f tests/harness/libtest.awk "$log" > "$OLEO_LOGS/cargo-test.tally"
while IFS=$'\t' read -r kind name reason; do
    case $kind in
        passed) tally passed "$name" "cargo test" ;;
        failed) fail "$name" "see below" ;;
        skipped) skip "$name" "$reason" ;;
    esac
done < "$OLEO_LOGS/cargo-test.tally"
awk '$1 == "passed" { print "   " $2 " tests passed" }' "$OLEO_LOGS/cargo-test.tally"
if [ $status -ne 0 ]; then
    grep -q '^failed' "$OLEO_LOGS/cargo-test.tally" || fail "cargo test" "did not build or run to its end"
    grep -vE '^(test .* ok|running|     Running|   Compiling|$)' "$log" | grep -vE ' \.\.\. ok$' | tail -n 80 | sed 's/^/           /'
fi
exit 0
