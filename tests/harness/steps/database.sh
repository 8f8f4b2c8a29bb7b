#!/usr/bin/env bash
# reads the CAN database with an independent reader (cantools)
. tests/harness/lib.sh

python_packages 'cantools, e2e' 'cantools>=40,<46' autosar-e2e || {
    skip "DBC read by cantools" "cantools, e2e cannot be installed: $(tail -n 1 "$OLEO_LOGS/pip-$OLEO_STEP.log")"
    exit 0
}
PYTHONPATH=$PYTHON_PACKAGES check "DBC read by cantools" python3 tests/can_database.py
tail -n 1 "$log" | sed 's/^/   /'
exit 0
