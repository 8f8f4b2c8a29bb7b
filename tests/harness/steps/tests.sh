#!/usr/bin/env bash
# runs the unit, property and end-to-end tests of the workspace (cargo test, dev profile)
. tests/harness/lib.sh
# Without the examples, which clippy compiles.
libtest "cargo test" cargo test "${FEATURES[@]}" --workspace --locked --no-fail-fast --lib --bins --tests -- --show-output
libtest "documentation" cargo test "${FEATURES[@]}" --workspace --locked --no-fail-fast --doc
# What the first command builds, which lacks the readers of other programs' logs and says so. Building it is most of the work, so it is not optimised.
CARGO_PROFILE_DEV_OPT_LEVEL=0 libtest "without features" cargo test --workspace --locked --test convert -- --show-output
# The board's image holds one strategy.
libtest "controller as a board has it" cargo test --package oleo-controller --no-default-features --locked --lib --tests -- --show-output
exit 0
