#!/usr/bin/env bash
# runs the unit, property and end-to-end tests of the workspace (cargo test, dev profile)
. tests/harness/lib.sh
libtest "cargo test" cargo test --workspace --locked --no-fail-fast -- --show-output
exit 0
