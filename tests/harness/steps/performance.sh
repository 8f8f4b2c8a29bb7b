#!/usr/bin/env bash
# counts instructions and operations of strut, campaign, loop and vehicle: the figures of docs/performance.md
. tests/harness/lib.sh

need valgrind valgrind || { skip "figures of performance" "no valgrind"; exit 0; }
need binutils objdump || { skip "figures of performance" "no objdump"; exit 0; }
check "release build" cargo build "${FEATURES[@]}" --locked --quiet --release &&
    check "examples build" cargo build --locked --quiet --release -p oleo-plant-sim --example strut_step --example campaign --example processor_limits || exit 0
# Without the recordings beside the checkout the rows of campaigns are left out.
check "figures of performance" python3 tests/performance.py "$CARGO_TARGET_DIR/release" ../shared/recordings/labelled/labelled-01
sed 's/^/   /' "$log"
exit 0
