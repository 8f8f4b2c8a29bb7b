#!/usr/bin/env bash
# holds the summaries of all commands against their JSON Schemas, with an independent validator (jsonschema)
. tests/harness/lib.sh
readonly python=$CARGO_TARGET_DIR/test-python

have() { PYTHONPATH=$python python3 -c 'import jsonschema' 2> /dev/null; }
if ! have; then
    echo "   installing jsonschema"
    python3 -m pip install --quiet --target "$python" 'jsonschema>=4.20,<5' > "$OLEO_LOGS/pip-schemas.log" 2>&1
fi
have || { skip "summaries against schemas" "jsonschema is not to be had: $(tail -n 1 "$OLEO_LOGS/pip-schemas.log")"; exit 0; }
check "release build" cargo build --locked --quiet --release || exit 0
folder=$(mktemp -d)
PYTHONPATH=$python check "summaries against schemas" python3 tests/schemas.py "$CARGO_TARGET_DIR/release/oleo" "$folder"
tail -n 1 "$log" | sed 's/^/   /'
rm -r "$folder"
exit 0
