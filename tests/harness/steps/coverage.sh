#!/usr/bin/env bash
# extra: lines of the controller that its own tests run; each that they do not must be explained
. tests/harness/lib.sh

rustup component add llvm-tools > "$OLEO_LOGS/llvm-tools.log" 2>&1
cargo_tool cargo-llvm-cov || { skip "coverage" "no cargo-llvm-cov, and none to be installed"; exit 0; }
report=$OLEO_LOGS/coverage.lcov
check "tests run with coverage" cargo llvm-cov --package oleo-controller --lib --tests --lcov --output-path "$report" || exit 0
check "no uncovered line without an explanation" python3 tests/harness/coverage.py "$report"
sed 's/^/   /' "$log"
exit 0
