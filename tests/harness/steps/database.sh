#!/usr/bin/env bash
# reads the CAN database with an independent reader (cantools)
. tests/harness/lib.sh
readonly python=$CARGO_TARGET_DIR/test-python

have() { PYTHONPATH=$python python3 -c 'import cantools, e2e' 2> /dev/null; }
if ! have; then
    echo "   installing cantools and autosar-e2e"
    python3 -m pip install --quiet --target "$python" 'cantools>=40,<46' autosar-e2e > "$OLEO_LOGS/pip.log" 2>&1
fi
have || { skip "DBC read by cantools" "cantools or autosar-e2e is not to be had: $(tail -n 1 "$OLEO_LOGS/pip.log")"; exit 0; }
PYTHONPATH=$python check "DBC read by cantools" python3 tests/can_database.py
tail -n 1 "$log" | sed 's/^/   /'
exit 0
