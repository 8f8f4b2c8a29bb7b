#!/usr/bin/env bash
# extra: tests the physics of docs/adding-physics.md by the rules of terms and effects, and finds it (minutes of building)
. tests/harness/lib.sh
. tests/harness/walk.sh
walk || exit 0
check "the new term keeps every rule of terms" in_copy cargo test --locked -p oleo-plant-sim --lib strut::terms
check "the new effect keeps every rule of effects and is found" in_copy cargo test --locked -p oleo-diagnose --lib effect::
exit 0
