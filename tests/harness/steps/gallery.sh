#!/usr/bin/env bash
# diagnoses every campaign of the recordings and draws docs/gallery.md: as recorded, as believed, as found
. tests/harness/lib.sh

recordings=../shared/recordings
[ -d "$recordings/labelled" ] || { must_not_skip "gallery" "$recordings is not there"; exit 0; }
python_packages 'numpy, matplotlib' 'numpy>=1.26' 'matplotlib>=3.8,<4' || {
    skip "gallery" "matplotlib cannot be installed: $(tail -n 1 "$OLEO_LOGS/pip-$OLEO_STEP.log")"
    exit 0
}
check "release build" cargo build "${FEATURES[@]}" --locked --quiet --release || exit 0
folder=$(mktemp -d -p "$CARGO_TARGET_DIR")
PYTHONPATH=$PYTHON_PACKAGES check "gallery" python3 tests/gallery.py "$CARGO_TARGET_DIR/release/oleo" "$recordings" "$folder" docs
sed 's/^/   /' "$log"
rm -r "$folder"
exit 0
