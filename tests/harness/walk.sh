#!/usr/bin/env bash
# What the two steps that follow docs/adding-physics.md share. The target folder is shared with the checkout, so only what
# the page changes is built again.
readonly copy=$CARGO_TARGET_DIR/adding-physics

# Make the copy and apply the page to it. False where that cannot be done.
walk() {
    if ! need patch patch; then
        skip "the page's files and changes apply" "no patch to be had"
        return 1
    fi
    rm -rf -- "$copy"
    check "the page's files and changes apply" python3 tests/harness/walk.py docs/adding-physics.md "$copy"
}

# Run a command in the copy. What cargo has built there it would take for the checkout's own, because the packages have the same names and
# places in their workspaces: the next test of the checkout would run a binary of the copy. So it must forget them.
in_copy() {
    (cd "$copy" && "$@")
    local status=$? built
    find "$CARGO_TARGET_DIR/debug/.fingerprint" -name 'dep-*' -print0 | xargs -0 grep -la "${copy##*/}/" | while read -r built; do
        rm -rf -- "$(dirname "$built")"
    done
    return $status
}
