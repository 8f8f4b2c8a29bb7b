#!/usr/bin/env bash
# the CAN database as an independent reader (cantools) sees it
. tests/harness/lib.sh
readonly python=$CARGO_TARGET_DIR/test-python

if ! PYTHONPATH=$python python3 -c 'import cantools' 2> /dev/null; then
    echo "   installing cantools"
    python3 -m pip install --quiet --target "$python" 'cantools>=40,<46' > "$OLEO_LOGS/pip.log" 2>&1 ||
        { skip "DBC read by cantools" "cantools cannot be installed: $(tail -n 1 "$OLEO_LOGS/pip.log")"; exit 0; }
fi
PYTHONPATH=$python check "DBC read by cantools" python3 tests/can_database.py
tail -n 1 "$log" | sed 's/^/   /'
exit 0
