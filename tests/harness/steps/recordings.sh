#!/usr/bin/env bash
# runs tests/recordings.rs and tests/diagnose_real.rs in release on the recordings beside the checkout, if there are any
. tests/harness/lib.sh
readonly folder=../shared/recordings

libtest "bad recordings" cargo test "${FEATURES[@]}" --locked --release --test diagnose_bad_recordings -- --show-output
libtest "dampers and drives" cargo test "${FEATURES[@]}" --locked --release --test diagnose_mechanisms

if [ ! -d $folder ]; then
    must_not_skip "recordings" "no folder $folder beside this checkout"
    exit 0
fi
echo "   $(find $folder -name '*.csv' | wc -l) recordings, $(find $folder -name model.toml | wc -l) models"
libtest "recordings" cargo test "${FEATURES[@]}" --locked --release --test recordings -- --show-output
libtest "real hardware" cargo test "${FEATURES[@]}" --locked --release --test diagnose_real -- --show-output
exit 0
