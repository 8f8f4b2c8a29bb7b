#!/usr/bin/env bash
# extra: diagnoses the ten blind campaigns and compares effects and places with those of docs/results.md (5 minutes)
. tests/harness/lib.sh
readonly folder=../shared/recordings/blind expected=tests/golden/blind-effects.txt

if [ ! -d $folder ]; then
    must_not_skip "blind campaigns" "no folder $folder beside this checkout"
    exit 0
fi
check "release build" cargo build "${FEATURES[@]}" --locked --quiet --release || exit 0

# The numbers are left out: their last digits are those of the build.
effects='import json, sys; print(*sorted("@".join((effect["id"], effect["place"])) for effect in json.load(sys.stdin)["effects"]))'
diagnosed() {
    local found
    found=$("$CARGO_TARGET_DIR/release/oleo" diagnose "$folder/$1" --no-out --format json | python3 -c "$effects") || return 1
    echo "$1: found '$found', expected '$2'"
    [ "$found" = "$2" ]
}
while read -r campaign effects_expected; do
    check "$campaign" diagnosed "$campaign" "$effects_expected"
done < "$expected"
exit 0
