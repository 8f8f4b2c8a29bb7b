#!/usr/bin/env bash
# holds the summaries of all commands against their JSON Schemas, with an independent validator (jsonschema)
. tests/harness/lib.sh

python_packages 'jsonschema' 'jsonschema>=4.20,<5' || {
    skip "summaries against schemas" "jsonschema cannot be installed: $(tail -n 1 "$OLEO_LOGS/pip-$OLEO_STEP.log")"
    exit 0
}
check "release build" cargo build "${FEATURES[@]}" --locked --quiet --release || exit 0
folder=$(mktemp -d)
PYTHONPATH=$PYTHON_PACKAGES check "summaries against schemas" python3 tests/schemas.py "$CARGO_TARGET_DIR/release/oleo" "$folder"
tail -n 1 "$log" | sed 's/^/   /'
rm -r "$folder"
exit 0
