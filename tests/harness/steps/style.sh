#!/usr/bin/env bash
# checks formatting, clippy and documentation without warnings, unused dependencies, and shellcheck
. tests/harness/lib.sh
check "host code is formatted" cargo fmt --all --check -- --color=never
check "firmware is formatted" cargo fmt --manifest-path firmware/Cargo.toml -p oleo-firmware -p oleo-bench --check -- --color=never
check "solvers to be timed are formatted" cargo fmt --manifest-path benches/solvers/Cargo.toml -p oleo-solvers --check -- --color=never
check "fuzz targets are formatted" cargo fmt --manifest-path fuzz/Cargo.toml -p oleo-fuzz --check -- --color=never
check "clippy finds nothing" cargo clippy "${FEATURES[@]}" --workspace --all-targets --locked --keep-going --quiet -- -D warnings
check "clippy finds nothing in the controller as a board has it" \
    cargo clippy --package oleo-controller --no-default-features --all-targets --locked --quiet -- -D warnings
RUSTDOCFLAGS="-D warnings" check "documentation builds without a warning" \
    cargo doc "${FEATURES[@]}" --workspace --no-deps --locked --keep-going --quiet

# cargo-machete looks for each dependency (not those of tests alone) in the sources below a manifest. Two manifests are
# looked at in a copy: the members' sources are below the root's too, and firmware/ is taken for a part of the workspace around it.
copy=$(mktemp -d)
mkdir "$copy/oleo" "$copy/firmware"
cp -r Cargo.toml src "$copy/oleo"
cp -r firmware/Cargo.toml firmware/src firmware/bench "$copy/firmware"
if cargo_tool cargo-machete; then
    for package in "$copy/oleo" interface controller xcp plant-sim hil diagnose report python fmu fmu-import "$copy/firmware" fuzz; do
        check "no unused dependency in $(basename "$package")" cargo machete "$package"
    done
else
    skip "no unused dependency" "no cargo-machete, and none to be installed"
fi
rm -r "$copy"
if need shellcheck shellcheck; then
    check "shellcheck finds nothing" shellcheck -x -P . test .ci/run tests/harness/*.sh tests/harness/steps/*.sh
else
    skip "shellcheck finds nothing" "no shellcheck, and none to be installed"
fi
