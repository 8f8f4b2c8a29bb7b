#!/usr/bin/env bash
# applies the files and changes of docs/adding-physics.md to a copy of the checkout, and compiles it
. tests/harness/lib.sh
. tests/harness/walk.sh
walk || exit 0
check "the compiler accepts the new physics" in_copy cargo check --locked -p oleo-diagnose --lib
exit 0
