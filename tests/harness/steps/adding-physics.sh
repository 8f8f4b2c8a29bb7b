#!/usr/bin/env bash
# docs/adding-physics.md followed in a copy of the checkout: its files and changes apply, and the compiler accepts them
. tests/harness/lib.sh
. tests/harness/walk.sh
walk || exit 0
check "the compiler accepts the new physics" in_copy cargo check --locked -p oleo-diagnose --lib
exit 0
