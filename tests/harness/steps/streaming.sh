#!/usr/bin/env bash
# shows that long logs are converted in constant memory, and times it beside python-can and cantools
. tests/harness/lib.sh

python_packages 'numpy, can, cantools' 'numpy>=1.26' 'python-can>=4.4,<5' 'cantools>=40,<46' || {
    skip "streaming" "python-can, cantools cannot be installed: $(tail -n 1 "$OLEO_LOGS/pip-$OLEO_STEP.log")"
    exit 0
}
check "release build" cargo build "${FEATURES[@]}" --locked --quiet --release || exit 0
folder=$(mktemp -d -p "$CARGO_TARGET_DIR")
# Millions of frames; 200 million take a quarter of an hour and 6 GB of disk more.
millions=${OLEO_MILLIONS:-2,20}
PYTHONPATH=$PYTHON_PACKAGES check "streaming" python3 tests/streaming.py "$CARGO_TARGET_DIR/release/oleo" "$folder" --millions "$millions"
sed 's/^/   /' "$log"
rm -r "$folder"
exit 0
