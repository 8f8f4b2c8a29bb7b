#!/usr/bin/env bash
# reads logs that python-can and asammdf write (candump, ASC, MDF 4, another CAN database)
. tests/harness/lib.sh
readonly python=$CARGO_TARGET_DIR/test-python

have() { PYTHONPATH=$python python3 -c 'import asammdf, can, cantools' 2> /dev/null; }
if ! have; then
    echo "   installing python-can, asammdf and cantools"
    python3 -m pip install --quiet --target "$python" 'python-can>=4.4,<5' 'asammdf>=8,<9' 'cantools>=40,<46' > "$OLEO_LOGS/pip-logs.log" 2>&1
fi
have || { skip "logs of other programs" "python-can, asammdf or cantools is not to be had: $(tail -n 1 "$OLEO_LOGS/pip-logs.log")"; exit 0; }
check "release build" cargo build --locked --quiet --release || exit 0
folder=$(mktemp -d)
PYTHONPATH=$python check "logs of other programs" python3 tests/logs_as_people_have_them.py "$CARGO_TARGET_DIR/release/oleo" "$folder"
tail -n 2 "$log" | sed 's/^/   /'
rm -r "$folder"
exit 0
