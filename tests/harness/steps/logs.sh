#!/usr/bin/env bash
# reads logs that python-can and asammdf write (candump, ASC, BLF, MDF 4, another CAN database); other programs read MDF 4, MCAP and Parquet and follow a live run
. tests/harness/lib.sh

python_packages 'asammdf, can, cantools, pyarrow' 'python-can>=4.4,<5' 'asammdf>=8,<9' 'cantools>=40,<46' 'pyarrow>=16,<25' || {
    skip "logs of other programs" "asammdf, can, cantools cannot be installed: $(tail -n 1 "$OLEO_LOGS/pip-$OLEO_STEP.log")"
    exit 0
}
check "release build" cargo build "${FEATURES[@]}" --locked --quiet --release || exit 0
folder=$(mktemp -d)
PYTHONPATH=$PYTHON_PACKAGES check "logs of other programs" python3 tests/logs_as_people_have_them.py "$CARGO_TARGET_DIR/release/oleo" "$folder"
tail -n 2 "$log" | sed 's/^/   /'
rm -r "$folder"

python_packages 'mcap, websockets, jsonschema' 'mcap>=1.2,<2' 'websockets>=12,<17' 'jsonschema>=4.20,<5' || {
    skip "messages for viewers" "mcap, websockets, jsonschema cannot be installed: $(tail -n 1 "$OLEO_LOGS/pip-$OLEO_STEP.log")"
    exit 0
}
folder=$(mktemp -d)
PYTHONPATH=$PYTHON_PACKAGES check "messages for viewers" python3 tests/messages.py "$CARGO_TARGET_DIR/release/oleo" "$folder"
tail -n 1 "$log" | sed 's/^/   /'
rm -r "$folder"
exit 0
