#!/usr/bin/env bash
# checks formatting, clippy without warnings, and shellcheck
. tests/harness/lib.sh
check "host code is formatted" cargo fmt --all --check -- --color=never
check "firmware is formatted" cargo fmt --manifest-path firmware/Cargo.toml -p oleo-firmware -p oleo-bench --check -- --color=never
check "fuzz targets are formatted" cargo fmt --manifest-path fuzz/Cargo.toml -p oleo-fuzz --check -- --color=never
check "clippy finds nothing" cargo clippy --workspace --all-targets --locked --keep-going --quiet -- -D warnings
if need shellcheck shellcheck; then
    check "shellcheck finds nothing" shellcheck -x -P . test .ci/run tests/harness/*.sh tests/harness/steps/*.sh
else
    skip "shellcheck finds nothing" "no shellcheck, and none to be installed"
fi
