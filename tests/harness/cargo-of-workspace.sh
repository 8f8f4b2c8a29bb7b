#!/usr/bin/env bash
# The cargo that maturin is given by the tests (CARGO). Of one package alone, cargo would build all libraries below it again, because that package asks
# for fewer features of them than the workspace does. So all of the workspace is built, as `cargo test` has built it, and maturin takes its library from
# what cargo says of it.
. tests/harness/lib.sh
[ "${1:-}" = rustc ] || exec cargo "$@"
exec cargo build "${FEATURES[@]}" --workspace --lib --bins --tests --locked --message-format json-render-diagnostics
