#!/usr/bin/env bash
# docs/adding-physics.md followed in a copy of the checkout: the new physics builds, keeps every rule, and is found
. tests/harness/lib.sh
readonly copy=$CARGO_TARGET_DIR/adding-physics
walk=false
if need patch patch; then
    rm -rf -- "$copy/diagnose" "$copy/plant-sim"
    check "the page's files and changes apply" python3 tests/harness/walk.py docs/adding-physics.md "$copy" && walk=true
else
    skip "the page's files and changes apply" "no patch to be had"
fi
# The target folder is shared, so only what the page changes is built again.
inside() { (cd "$copy" && "$@"); }
if $walk; then
    check "the new term keeps every rule of terms" inside cargo test --locked -p oleo-plant-sim --lib strut::terms
    check "the new effect keeps every rule of effects and is found" inside cargo test --locked -p oleo-diagnose --lib effect::
fi
exit 0
